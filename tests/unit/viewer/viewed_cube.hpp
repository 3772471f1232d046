// A small cube behind an Api.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "cube/cube_io.hpp"
#include "tests/support/temporary_folder.hpp"
#include "viewer/api/api.hpp"
#include "viewer/api/stored_image.hpp"

namespace kiloband::test {

/// 3 x 2 pixels, channels of 500-510 and 600-620 nm; pages may save.
class ViewedCube {
 public:
  explicit ViewedCube(const std::optional<std::string>& token = {}) {
    CubeInfo info;
    info.width = 3;
    info.height = 2;
    info.bands = {{{500, 510, ""}}, {{600, 620, ""}}};
    info.variance = true;
    info.samples_per_pixel = 16;
    info.replicates = 5;
    for (int pixel = 0; pixel < 6; ++pixel)
      for (int k = 0; k < 2; ++k) values_.push_back(static_cast<float>(10 * pixel + k + 1));
    const std::vector<float> variances(values_.size(), 4.0f);
    const auto writer = create_cube_writer(folder_ / "cube.hdr", info, 2);
    writer->write_rows({0, 2, values_, variances, {}});
    writer->finish();
    std::filesystem::create_directory(output());
    image_ = viewer::open_stored_image(folder_ / "cube.hdr", std::size_t{1} << 20, 2, {});
    viewer::ApiSettings settings;
    settings.output_dir = output();
    settings.access.token = token;
    api_ = std::make_unique<viewer::Api>(*image_, settings);
  }

  viewer::Api& api() { return *api_; }
  std::filesystem::path output() const { return folder_ / "output"; }
  const std::vector<float>& values() const { return values_; }  // [y][x][band], integrals

 private:
  TemporaryFolder folder_;
  std::vector<float> values_;
  std::unique_ptr<viewer::ViewedImage> image_;
  std::unique_ptr<viewer::Api> api_;
};

}  // namespace kiloband::test
