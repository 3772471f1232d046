// Writes the headers of ENVI cubes.
#include <algorithm>
#include <cmath>
#include <functional>

#include "cube/band_lists.hpp"
#include "cube/cube_text.hpp"
#include "cube/envi/envi_header.hpp"

namespace kiloband {
namespace {

constexpr std::string_view kEnviListSpecial = ",{}";

/// "key = {a, b, ...}" in lines of eight, since some readers limit the length of a line.
void add_list(std::string& text, std::string_view key, std::size_t size,
              const std::function<std::string(std::size_t)>& entry) {
  constexpr std::size_t kPerLine = 8;
  text += std::string(key) + " = {";
  for (std::size_t k = 0; k < size; ++k) {
    if (size > kPerLine && k % kPerLine == 0) text += "\n ";
    text += entry(k) + (k + 1 < size ? ", " : "");
  }
  text += "}\n";
}

void add(std::string& text, std::string_view key, const std::string& value) {
  text += std::string(key) + " = " + value + "\n";
}

/// What the numbers are, for people who open the header in an editor.
std::string describe(const CubeInfo& info, EnviContent content) {
  if (content == EnviContent::kAux) return "auxiliary planes of a cube by kiloband";
  const std::string quantity = info.quantity == Quantity::kIntegral
                                   ? "band radiance (integral over the band) in W m^-2 sr^-1"
                                   : "mean spectral radiance of the band in W m^-2 sr^-1 nm^-1";
  const bool derived =
      std::any_of(info.bands.begin(), info.bands.end(), [](const Band& b) { return b.derived; });
  std::string text = content == EnviContent::kVariance ? "variance of the mean (NaN: none) of " : "";
  text += quantity;
  if (derived) text += "; derived bands in units of their responses";
  return text + "; written by kiloband";
}

/// Bands (1-based) that a viewer shows as red, green and blue.
void add_default_bands(std::string& text, const std::vector<Band>& bands) {
  double low = INFINITY, high = 0;
  for (const Band& band : bands)
    if (!band.derived) low = std::min(low, band.channel.min_nm), high = std::max(high, band.channel.max_nm);
  if (!(low < high)) return;
  const bool visible = low < 500 && high > 600;
  const double shown[] = {visible ? 640 : low + (high - low) * 5 / 6, visible ? 550 : 0.5 * (low + high),
                          visible ? 460 : low + (high - low) / 6};
  add_list(text, "default bands", 3, [&](std::size_t c) {
    std::size_t best = 0;
    double distance = INFINITY;
    for (std::size_t k = 0; k < bands.size(); ++k) {
      const double d = bands[k].derived ? INFINITY : std::abs(bands[k].channel.centre_nm() - shown[c]);
      if (d < distance) distance = d, best = k;
    }
    return std::to_string(best + 1);
  });
}

/// Standard keys for every ENVI reader, then ours with the exact bounds and the scene's own names.
void add_bands(std::string& text, const CubeInfo& info) {
  const auto& bands = info.bands;
  const std::vector<std::string> names = unique_band_names(bands);
  const auto list = [&](std::string_view key, auto entry) { add_list(text, key, bands.size(), entry); };
  const auto channel = [&](std::size_t k) -> const Channel& { return bands[k].channel; };
  add(text, "wavelength units", "Nanometers");
  list("wavelength", [&](std::size_t k) { return format_number(channel(k).centre_nm()); });
  list("fwhm", [&](std::size_t k) { return format_number(channel(k).width_nm()); });
  list("band names", [&](std::size_t k) { return encode_text(names[k], kEnviListSpecial); });
  add_default_bands(text, bands);
  list(kEnviMinKey, [&](std::size_t k) { return format_number(channel(k).min_nm); });
  list(kEnviMaxKey, [&](std::size_t k) { return format_number(channel(k).max_nm); });
  if (std::any_of(bands.begin(), bands.end(), [](const Band& b) { return b.derived; }))
    list(kEnviDerivedKey, [&](std::size_t k) { return std::string(bands[k].derived ? "1" : "0"); });
  if (std::any_of(bands.begin(), bands.end(), [](const Band& b) { return !b.channel.name.empty(); }))
    list(kEnviNamesKey, [&](std::size_t k) { return encode_text(channel(k).name, kEnviListSpecial); });
}

/// Entries whose names are taken (or begin with the prefix themselves) get the prefix.
void add_metadata(std::string& text, const CubeInfo& info) {
  for (const auto& [key, value] : info.metadata) {
    const bool taken = key.starts_with(kEnviMetaPrefix) || is_reserved_envi_key(lowered(key));
    const bool list = is_list(value);  // other programs know it by its braces
    const std::string encoded =
        list ? "{" + encode_text(value.substr(1, value.size() - 2), "{}") + "}" : encode_text(value, "{}");
    add(text, (taken ? std::string(kEnviMetaPrefix) : "") + encode_text(key, "={};"), encoded);
  }
}

}  // namespace

std::string envi_header_text(const CubeInfo& info, EnviContent content) {
  const bool aux = content == EnviContent::kAux;
  std::string text = "ENVI\n";
  text += "description = {" + describe(info, content) + "}\n";
  add(text, "samples", std::to_string(info.width));
  add(text, "lines", std::to_string(info.height));
  add(text, "bands", std::to_string(aux ? info.aux.size() : info.bands.size()));
  add(text, "header offset", "0");
  add(text, "file type", "ENVI Standard");
  add(text, "data type", "4");
  add(text, "interleave", "bsq");
  add(text, "byte order", "0");
  if (content == EnviContent::kVariance) add(text, "data ignore value", "nan");
  if (aux)
    add_list(text, "band names", info.aux.size(),
             [&](std::size_t k) { return encode_text(info.aux[k], kEnviListSpecial); });
  else
    add_bands(text, info);
  add(text, kEnviLayoutKey, "1");
  add(text, kEnviQuantityKey, info.quantity == Quantity::kIntegral ? "integral" : "density");
  if (content == EnviContent::kVariance) add(text, kEnviContentKey, "variance");
  if (content != EnviContent::kValues) return text;
  if (info.samples_per_pixel > 0) add(text, kEnviSamplesKey, std::to_string(info.samples_per_pixel));
  if (info.replicates > 0) add(text, kEnviReplicatesKey, std::to_string(info.replicates));
  if (!info.replicate_samples.empty())
    add_list(text, kEnviReplicateSamplesKey, info.replicate_samples.size(),
             [&](std::size_t r) { return std::to_string(info.replicate_samples[r]); });
  if (info.variance) add(text, kEnviVarianceKey, "1");
  if (!info.aux.empty()) add(text, kEnviAuxKey, "1");
  add_metadata(text, info);
  return text;
}

}  // namespace kiloband
