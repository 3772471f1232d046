#include "post/replicated_cube.hpp"

#include <cmath>
#include <limits>

#include "cube/cube_layout.hpp"
#include "cube/cube_text.hpp"
#include "film/statistics.hpp"

namespace kiloband {
namespace {

namespace fs = std::filesystem;

/// A replicate must be of the same picture: a later render under the same name may have left old ones.
void check_replicate(const CubeInfo& whole, const CubeInfo& part, uint32_t replicate, const fs::path& file) {
  const bool same_bands = whole.bands.size() == part.bands.size();
  const bool same_size = whole.width == part.width && whole.height == part.height;
  const bool same_render = metadata_of(whole, "seed") == metadata_of(part, "seed") &&
                           metadata_of(whole, "scene") == metadata_of(part, "scene") &&
                           whole.samples_per_pixel == part.samples_per_pixel;
  if (!same_bands || !same_size || !same_render ||
      metadata_of(part, "replicate") != std::to_string(replicate))
    throw InputError(file.string() + ": is no replicate of this cube (of another render?): remove it");
}

/// Sum over bands and pixels of the middle row.
double middle_row(CubeReader& cube) {
  std::vector<float> row(cube.info().bands.size() * cube.info().width);
  cube.read_rows(cube.info().height / 2, 1, row, {});
  double sum = 0;
  for (const float value : row) sum += value;
  return sum;
}

/// Replicates of a scene that was changed since have the same header; their mean is another.
void check_mean(const ReplicatedCube& cube, const fs::path& file) {
  std::vector<double> sums;
  double sum = 0, total = 0;
  for (std::size_t r = 0; r < cube.replicates.size(); ++r) {
    sums.push_back(middle_row(*cube.replicates[r]));
    sum += cube.samples[r] * sums[r];
    total += cube.samples[r];
  }
  const double mean = middle_row(*cube.mean);
  const double allowed = 1e-5 * std::abs(mean) + 0.5 * replicate_error(sums, cube.samples);
  if (std::abs(mean - sum / total) > allowed)  // false where pixels have no samples
    throw InputError(replicate_path(file, 0).string() +
                     " ...: the replicates' mean is not this cube's (of another render?): remove them");
}

/// Adds the variance of the mean over replicates.
class VarianceCube : public CubeReader {
 public:
  explicit VarianceCube(ReplicatedCube cube) : cube_(std::move(cube)), info_(cube_.mean->info()) {
    info_.variance = true;
    info_.replicates = static_cast<uint32_t>(cube_.replicates.size());
  }

  const CubeInfo& info() const override { return info_; }

  std::size_t floats_held() const override {
    std::size_t sum = CubeReader::floats_held() + cube_.mean->floats_held();
    for (const auto& replicate : cube_.replicates) sum += replicate->floats_held();
    return sum;
  }

  void read_rows(uint32_t y0, uint32_t rows, std::span<float> mean, std::span<float> variance) override {
    cube_.mean->read_rows(y0, rows, mean, {});
    if (variance.empty()) return;
    values_.resize(cube_.replicates.size());
    for (std::size_t r = 0; r < values_.size(); ++r) {
      values_[r].resize(mean.size());
      cube_.replicates[r]->read_rows(y0, rows, values_[r], {});
    }
    std::vector<double> of_replicates(values_.size());
    for (std::size_t i = 0; i < variance.size(); ++i) {
      for (std::size_t r = 0; r < values_.size(); ++r) of_replicates[r] = values_[r][i];
      const double error = replicate_error(of_replicates, cube_.samples);
      variance[i] = static_cast<float>(error * error);
    }
  }

  void read_aux(uint32_t y0, uint32_t rows, std::span<float> aux) override {
    cube_.mean->read_aux(y0, rows, aux);
  }

 private:
  ReplicatedCube cube_;
  CubeInfo info_;
  std::vector<std::vector<float>> values_;
};

}  // namespace

fs::path replicate_path(const fs::path& file, uint32_t replicate) {
  const std::string number = std::to_string(replicate);
  fs::path path = file;
  return path.replace_extension((number.size() < 2 ? ".r0" : ".r") + number + file.extension().string());
}

double replicate_error(std::span<const double> values, std::span<const double> samples) {
  double sum = 0, total = 0;
  for (std::size_t r = 0; r < values.size(); ++r) {
    sum += samples[r] * values[r];
    total += samples[r];
  }
  if (values.size() < 2) return std::numeric_limits<double>::quiet_NaN();
  double squares = 0;
  for (std::size_t r = 0; r < values.size(); ++r)
    squares += samples[r] * (values[r] - sum / total) * (values[r] - sum / total);
  return std::sqrt(squares / (total * static_cast<double>(values.size() - 1)));
}

ReplicatedCube ReplicatedCube::transformed(
    const std::function<std::unique_ptr<CubeReader>(std::unique_ptr<CubeReader>)>& change) && {
  ReplicatedCube result{change(std::move(mean)), {}, std::move(samples)};
  for (auto& replicate : replicates) result.replicates.push_back(change(std::move(replicate)));
  return result;
}

ReplicatedCube open_replicated_cube(const fs::path& file, const DiagnosticSink& sink) {
  ReplicatedCube cube{open_cube(file, sink), {}, {}};
  const CubeInfo& info = cube.mean->info();
  std::error_code unknown;  // a name that is too long for a replicate has none
  if (info.replicates < 2 || !fs::exists(replicate_path(file, 0), unknown)) return cube;
  const ReplicatePlan plan{info.samples_per_pixel, info.replicates};
  for (uint32_t r = 0; r < info.replicates; ++r) {
    const fs::path path = replicate_path(file, r);
    if (!fs::exists(path, unknown))
      throw InputError(path.string() + ": is missing: the cube has " + std::to_string(info.replicates) +
                       " replicates");
    cube.replicates.push_back(open_cube(path));
    check_replicate(info, cube.replicates.back()->info(), r, path);
    cube.samples.push_back(std::max(1.0, static_cast<double>(plan.size(r))));
  }
  check_mean(cube, file);
  return cube;
}

std::unique_ptr<CubeReader> with_replicate_variance(ReplicatedCube cube) {
  if (!cube.has_errors()) return std::move(cube.mean);
  return std::make_unique<VarianceCube>(std::move(cube));
}

}  // namespace kiloband
