// Spectra from files: .spd and two-column text, refractiveindex.info YAML, ECOSTRESS text, response tables.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/diagnostics.hpp"
#include "spectral/files/value_scale.hpp"
#include "spectral/spectrum.hpp"

namespace kiloband {

/// Reads "lambda value" per line (nm; '#' comments; commas or blanks between; further columns ignored, with a note
/// or, where no header names them, a warning), at least two lines,
/// ascending or descending; an ECOSTRESS file (recognised by its header: X Units, Y Units; Latin-1;
/// micrometres; percent) or a CSV with a header line. Units that the file states, in its header or in
/// comments, are converted: of wavelengths (spectrum_units.hpp) and of values (value_scale.hpp); what it
/// leaves open is noted. kAbsorption: in 1/m unless the file states another inverse length (in the column's
/// name, or in a comment behind "abscoeff" or "absorption") or was written by RADIS, whose unit is 1/cm.
/// throws InputError  "file:line: ..." (not a number, not finite, duplicate wavelength, order changes, no
///                    data ...), units that the kind cannot have
Spectrum read_spectrum_file(const std::filesystem::path& file, ValueKind kind = ValueKind::kPlain,
                            const DiagnosticSink& sink = {});

/// n and k of a material; k is absent where the file gives none.
struct OpticalConstants {
  Spectrum n;
  std::optional<Spectrum> k;
};

/// Reads a refractiveindex.info YAML file (.yml, .yaml) (tabulated n, k, nk, and dispersion formulas 1 to 9,
/// which are tabulated finely over their stated range with interpolation error < 1e-6), or a two- or
/// three-column text file (lambda, n[, k], or the columns that a header names n and k; units as in read_spectrum_file). Rows of a YAML table with the
/// same wavelength (rounding in the database) are averaged with a warning. Outside their ranges n and k are
/// 0, as for any spectrum.
/// throws InputError  "file:line: ..." or "file: ..."; n must be positive, k at least 0
OpticalConstants read_optical_constants(const std::filesystem::path& file, const DiagnosticSink& sink = {});

/// A sensor response file: CSV with a header "wavelength_nm,NAME,NAME..." and one row per wavelength, or
/// columns without a header (the file's stem is the name, "stem_1", "stem_2" ... if there are several), or a
/// MODIS table of band, detector, wavelength and response ("band31_detector1" ...).
/// Units as in read_spectrum_file.
/// throws InputError  "file:line: ..." as read_spectrum_file; names that are empty or repeated
std::vector<std::pair<std::string, Spectrum>> read_response_file(const std::filesystem::path& file,
                                                                 const DiagnosticSink& sink = {});

}  // namespace kiloband
