// Channel names and spectrum strings of the spectral OpenEXR layout
// (Fichet, Pacanowski, Wilkie 2021, JCGT 10(3)).
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cube/cube_io.hpp"

namespace kiloband {

/// What a spectral channel's name says: S<0-3>.<value><prefix><unit>
/// or T.<value><prefix><unit>, decimal comma.
struct SpectralName {
  char kind = 'S';       // 'S' emissive, 'T' reflective
  int stokes = 0;        // 0 for T
  double value = 0;      // as written, in `unit`
  double centre_nm = 0;  // vacuum wavelength
};

/// Nothing for other names ("R", "depth.Z", "var.S0.550,000000nm", "S0.550,000000nm_2").
std::optional<SpectralName> parse_spectral_name(std::string_view name);

/// "S0.550,000000nm": six decimals, as the layout's reference implementation writes them.
std::string spectral_name(double centre_nm);

/// EXR channel names of bands, unique: spectral_name(centre), or "response.NAME" for derived bands. Equal
/// names get the suffix "_2", "_3" ... in band order; a suffixed name is outside the layout's grammar, so
/// that other readers ignore such a channel instead of taking it for another wavelength.
std::vector<std::string> exr_band_names(const std::vector<Band>& bands);

/// The box [min, max] as a spectrum string: "545nm:1;555nm:1;".
std::string sensitivity_text(const Channel& channel);

/// The wavelengths that a spectrum string covers, and whether its values are all equal (a box).
struct Sensitivity {
  double min_nm = 0, max_nm = 0;
  bool box = true;
};
/// Nothing where the text is no ascending spectrum of at least two wavelengths.
std::optional<Sensitivity> parse_sensitivity(std::string_view text);

}  // namespace kiloband
