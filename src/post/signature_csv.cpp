// Tables of signatures (signature.hpp).
#include <cmath>

#include "cube/csv_fields.hpp"
#include "files/atomic_file.hpp"
#include "post/signature.hpp"

namespace kiloband {
namespace {

/// "value" or, in tables with errors, "value,error"; what is not known is empty.
std::string figure_text(const Figure& figure, bool errors) {
  std::string text = "," + format_number(figure.value);
  if (errors) text += "," + (std::isnan(figure.error) ? std::string() : format_number(figure.error));
  return text;
}

std::string header_text(bool background, bool errors) {
  std::string text = "mask,pixels,distance_m,area_m2,channel,min_nm,max_nm";
  for (const char* name : {"radiance", "intensity", "background", "contrast_intensity", "contrast"}) {
    if (!background && name == std::string("background")) break;
    text += std::string(",") + name;
    if (errors) text += std::string(",") + name + "_error";
  }
  return text + "\n";
}

}  // namespace

void write_signatures(const CubeInfo& info, const std::vector<Signature>& signatures, bool errors,
                      const std::filesystem::path& out) {
  const bool background = !signatures.empty() && signatures.front().has_background;
  const std::vector<std::string> names = unique_band_names(info.bands);
  std::string text = header_text(background, errors);
  for (const Signature& s : signatures) {
    const std::string prefix = csv_text(s.label) + "," + std::to_string(s.pixels) + "," +
                               (s.distance_m > 0 ? format_number(s.distance_m) : "") + "," +
                               format_number(s.area_m2) + ",";
    for (std::size_t k = 0; k < names.size(); ++k) {
      const Channel& c = info.bands[k].channel;
      const BandSignature& band = s.bands[k];
      text += prefix + csv_text(names[k]) + "," + csv_bound(c, c.min_nm) + "," + csv_bound(c, c.max_nm) +
              figure_text(band.radiance, errors) + figure_text(band.intensity, errors);
      if (background)
        text += figure_text(band.background, errors) + figure_text(band.contrast_intensity, errors) +
                figure_text(band.contrast, errors);
      text += "\n";
    }
  }
  write_file_atomically(out, text);
}

}  // namespace kiloband
