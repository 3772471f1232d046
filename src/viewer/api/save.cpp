#include "viewer/api/save.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>

#include "base/text.hpp"
#include "cube/csv_fields.hpp"
#include "files/atomic_file.hpp"
#include "viewer/api/plain_names.hpp"

namespace kiloband::viewer {
namespace {

/// What stands behind a cube's name in its files; of an ENVI cube those that it has. Auxiliary planes are not saved, but would be removed as
/// those of the cube that was there.
std::vector<std::string> endings(const std::string& extension) {
  if (extension == ".hdr") return {".hdr", ".img", ".var.hdr", ".var.img", ".aux.hdr", ".aux.img"};
  return {extension};
}

std::string stem_of(const std::filesystem::path& file) {
  const std::string name = file.filename().string();
  return name.substr(0, name.size() - file.extension().string().size());
}

void scale_row(const PixelSource& pixels, bool squared, std::span<float> row) {
  const std::size_t bands = pixels.bands().size();
  for (std::size_t i = 0; i < row.size(); ++i) {
    const double unit = pixels.units()[i % bands];
    row[i] = static_cast<float>(row[i] * (squared ? unit * unit : unit));
  }
}

CubeInfo info_of(const ImageView& seen, const std::filesystem::path& file) {
  CubeInfo info;
  info.width = seen.full_width;
  info.height = seen.full_height;
  info.bands = seen.pixels.bands();
  info.variance = seen.pixels.has_variances();
  info.quantity = file.extension() == ".exr" ? Quantity::kDensity : Quantity::kIntegral;
  info.replicates = seen.pixels.replicates();
  info.samples_per_pixel = seen.stamp.samples;
  info.metadata = seen.metadata();
  return info;
}

}  // namespace

std::filesystem::path new_file(const std::filesystem::path& folder, const std::string& name,
                               const std::string& format) {
  check_plain_name(name, "the file's name");
  static const std::map<std::string, std::string> kEndings{
      {"exr", ".exr"}, {"envi", ".hdr"}, {"png", ".png"}};
  const auto ending = kEndings.find(format);
  if (ending == kEndings.end()) throw InputError("format: must be exr, envi or png");
  for (const std::string& end : endings(ending->second)) {
    std::error_code ignored;
    if (std::filesystem::symlink_status(folder / (name + end), ignored).type() !=
        std::filesystem::file_type::not_found)
      throw InputError(fmt::format("{} is there already: choose another name", quote_text(name + end)));
  }
  return folder / (name + ending->second);
}

std::vector<std::string> files_of(const std::filesystem::path& file) {
  std::vector<std::string> names;
  std::error_code ignored;
  for (const std::string& end : endings(file.extension().string())) {
    const std::string name = stem_of(file) + end;
    if (std::filesystem::exists(file.parent_path() / name, ignored)) names.push_back(name);
  }
  return names;
}

void save_cube(const std::filesystem::path& file, const ImageView& seen) {
  const PixelSource& pixels = seen.pixels;
  if (pixels.width() != seen.full_width || pixels.height() != seen.full_height)
    throw InputError("the image is shown at a reduced size: save it when it is whole");
  const CubeInfo info = info_of(seen, file);
  const std::size_t row = pixels.width() * pixels.bands().size();
  constexpr uint32_t kRows = 32;
  const auto writer = create_cube_writer(file, info, kRows);
  std::vector<float> means(kRows * row), variances(info.variance ? kRows * row : 0);
  for (uint32_t y = 0; y < info.height; y += kRows) {
    const uint32_t rows = std::min(kRows, info.height - y);
    for (uint32_t i = 0; i < rows; ++i) {
      const std::span<float> mean = std::span(means).subspan(i * row, row);
      pixels.means(y + i, mean);
      scale_row(pixels, false, mean);
      if (!info.variance) continue;
      const std::span<float> variance = std::span(variances).subspan(i * row, row);
      pixels.variances(y + i, variance);
      scale_row(pixels, true, variance);
    }
    const std::size_t size = rows * row;
    writer->write_rows(
        {y, rows, std::span(means).first(size), std::span(variances).first(info.variance ? size : 0), {}});
  }
  writer->finish();
}

void save_picture(const std::filesystem::path& file, const std::string& png) {
  write_file_atomically(file, png);
}

std::string curves_csv(const std::vector<Band>& bands, const std::vector<Selection>& places,
                       const std::vector<Curve>& curves) {
  const bool named = std::ranges::any_of(bands, [](const Band& band) { return !band.channel.name.empty(); });
  std::string csv = named ? "name,min_nm,max_nm" : "min_nm,max_nm";
  for (const Selection& place : places) {
    std::string name = place.text;
    replace_all(name, ",", "_");
    csv += fmt::format(",mean_{0},standard_error_{0}", name);
  }
  csv += '\n';
  for (std::size_t k = 0; k < bands.size(); ++k) {
    const Channel& channel = bands[k].channel;
    if (named) csv += csv_text(channel.name) + ",";
    csv += csv_bound(channel, channel.min_nm) + "," + csv_bound(channel, channel.max_nm);
    for (const Curve& curve : curves)
      csv += fmt::format(",{},{}", format_number(curve.mean[k]), format_number(curve.standard_error[k]));
    csv += '\n';
  }
  return csv;
}

}  // namespace kiloband::viewer
