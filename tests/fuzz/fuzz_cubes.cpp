// Targets: cubes on disk. What can be read is converted, looked at through sensors,
// and written and read again.
#include <algorithm>

#include "post/camera_geometry.hpp"
#include "post/convert.hpp"
#include "post/picture.hpp"
#include "post/sensor_cube.hpp"
#include "post/signature.hpp"
#include "tests/fuzz/flat_scene_check.hpp"
#include "tests/fuzz/fuzz_target.hpp"

namespace kiloband::fuzz {
namespace {

constexpr std::size_t kLargestRow = 1u << 22;    // values of a row that is read
constexpr std::size_t kLargestWhole = 1u << 16;  // values of a cube that is converted
constexpr uint32_t kMostRows = 64;

std::size_t values_per_row(const CubeInfo& info) {
  return std::size_t{info.width} * std::max<std::size_t>(info.bands.size() + info.aux.size(), 1);
}

void read_rows(CubeReader& cube) {
  const CubeInfo& info = cube.info();
  constexpr uint32_t kStrip = 3;
  for (uint32_t y = 0; y < std::min(info.height, kMostRows); y += kStrip) {
    const uint32_t rows = std::min(kStrip, info.height - y);
    const std::size_t pixels = std::size_t{rows} * info.width;
    std::vector<float> mean(pixels * info.bands.size()), variance(info.variance ? mean.size() : 0),
        aux(pixels * info.aux.size());
    cube.read_rows(y, rows, mean, variance);
    cube.read_aux(y, rows, aux);
  }
}

void promise_same(const CubeInfo& a, const CubeInfo& b) {
  promise(a.width == b.width && a.height == b.height, "written and read: another size");
  promise(a.bands.size() == b.bands.size(), "written and read: another number of bands");
  promise(a.aux == b.aux, "written and read: other auxiliary images");
  promise(a.variance == b.variance, "written and read: variances");
}

/// A cube that was written can be read, whatever its source said.
void write_and_read(const std::filesystem::path& file, const char* name, Quantity quantity) {
  const std::filesystem::path out = scratch_folder() / name;
  const auto source = open_cube(file);
  if (!accept_or_refuse([&] { write_cube(*source, out, quantity); })) return;
  try {
    const auto again = open_cube(out);
    promise_same(source->info(), again->info());
    read_rows(*again);
  } catch (const InputError& error) {
    promise(false, error.what());
  }
}

void select(const std::filesystem::path& file, const CubeInfo& info) {
  CubeSelection corner;
  corner.crop =
      PixelRect{info.width / 2, info.height / 2, info.width - info.width / 2, info.height - info.height / 2};
  corner.bands = {info.bands.size() - 1};
  corner.quantity = info.quantity == Quantity::kIntegral ? Quantity::kDensity : Quantity::kIntegral;
  accept_or_refuse([&] { read_rows(*select_from_cube(open_cube(file), corner)); });
  ChannelList plain;
  for (const Band& band : info.bands)
    if (!band.derived) plain.push_back(band.channel);
  if (plain.empty()) return;
  CubeSelection coarse;
  coarse.range = {plain.front().min_nm, plain.front().max_nm};
  coarse.rebin = ChannelList{hull(plain)};
  accept_or_refuse([&] { read_rows(*select_from_cube(open_cube(file), coarse)); });
  coarse.range.reset();
  accept_or_refuse([&] { read_rows(*select_from_cube(open_cube(file), coarse)); });
}

void see(const std::filesystem::path& file) {
  accept_or_refuse([&] {
    const auto cube = open_cube(file);
    report_responses(*cube, xyz_responses(), {});
    read_rows(*apply_responses(open_cube(file), xyz_responses()));
  });
  for (const PictureColours colours :
       {PictureColours::kNatural, PictureColours::kFalse, PictureColours::kSensor})
    accept_or_refuse([&] { auto_exposure(make_picture(*open_cube(file), colours)); });
}

void measure(const std::filesystem::path& file, const CubeInfo& info) {
  accept_or_refuse([&] {
    const auto camera = camera_of_cube(info, file.string());
    if (!camera) return;
    SignatureMask mask{"corner", PixelMask::of_rectangle(info.width, info.height, {0, 0, 1, 1}), {}, 10};
    mask.surroundings = mask.pixels.grown(1);
    ReplicatedCube cube = open_replicated_cube(file);
    write_signatures(info, measure_signatures(cube, nullptr, {mask}, *camera), false,
                     scratch_folder() / "signature.csv");
  });
}

/// As texture, lamp and environment of scenes.
void render(const std::filesystem::path& file) {
  const std::string name = "<string name='filename' value='" + file.filename().string() + "'/>";
  const std::string bitmap =
      "type='spectral_bitmap'>" + name + "<boolean name='extrapolate' value='true'/></texture>";
  const ChannelList channels{{500, 520, ""}, {520, 600, ""}};
  for (const std::string& elements :
       {"<shape type='rectangle'><bsdf type='diffuse'><texture name='reflectance' " + bitmap +
            "</bsdf></shape>" + "<emitter type='constant'/>",
        "<shape type='rectangle'><emitter type='area'><texture name='radiance' " + bitmap +
            "</emitter></shape>",
        "<shape type='sphere'/><emitter type='spectral_envmap'>" + name + "</emitter>"})
    accept_or_refuse([&] { flatten_and_check(elements, channels); });
}

void use(const std::filesystem::path& file) {
  CubeInfo info;
  const bool readable = accept_or_refuse([&] {
    const auto cube = open_cube(file);
    info = cube->info();
    if (values_per_row(info) <= kLargestRow) read_rows(*cube);
  });
  if (!readable || values_per_row(info) * info.height > kLargestWhole) return;
  select(file, info);
  see(file);
  measure(file, info);
  write_and_read(file, "again.exr", Quantity::kDensity);
  write_and_read(file, "again.hdr", Quantity::kIntegral);
}

/// The files of an ENVI cube one after the other, between lines "----": the header and the data of the
/// values, of the variances, of the auxiliary images.
/// Lengths are not part of the format so that mutations leave it whole.
/// returns the header of the values
std::filesystem::path write_envi_files(std::string_view bytes) {
  constexpr std::string_view kBetween = "\n----\n";
  for (const char* name :
       {"cube.hdr", "cube.img", "cube.var.hdr", "cube.var.img", "cube.aux.hdr", "cube.aux.img"}) {
    const std::size_t end = bytes.find(kBetween);
    scratch_file(name, bytes.substr(0, end));
    bytes = end == std::string_view::npos ? std::string_view{} : bytes.substr(end + kBetween.size());
  }
  return scratch_folder() / "cube.hdr";
}

}  // namespace

void exr_cube(std::string_view bytes) {
  use(scratch_file("cube.exr", bytes));
}

void envi_cube(std::string_view bytes) {
  use(write_envi_files(bytes));
}

/// ENVI cubes as scenes use them.
void spectral_image(std::string_view bytes) {
  render(write_envi_files(bytes));
}

/// What a cube's metadata say of the camera.
void camera(std::string_view bytes) {
  CubeInfo info;
  info.width = info.height = 2;
  info.metadata[kCameraKey] = std::string(bytes);
  accept_or_refuse([&] {
    const auto found = camera_of_cube(info, "cube");
    found->pixel_weight(1, 1);
    CubeInfo again = info;
    again.metadata[kCameraKey] = found->to_text();
    promise(camera_of_cube(again, "cube")->to_text() == found->to_text(),
            "another camera after writing and reading");
    crop_camera(info, 1, 1);
    camera_of_cube(info, "cube");
  });
}

}  // namespace kiloband::fuzz
