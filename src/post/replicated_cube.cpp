#include "post/replicated_cube.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

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
  const uint64_t samples =
      whole.replicate_samples.empty() ? whole.samples_per_pixel : whole.replicate_samples[replicate];
  const bool same_render = metadata_of(whole, "seed") == metadata_of(part, "seed") &&
                           metadata_of(whole, "scene") == metadata_of(part, "scene") &&
                           part.samples_per_pixel == samples;
  if (!same_bands || !same_size || !same_render ||
      metadata_of(part, "replicate") != std::to_string(replicate))
    throw InputError(file.string() + ": is no replicate of this cube (of another render?): remove it");
}

/// The middle row: [x][band].
std::vector<float> middle_row(CubeReader& cube) {
  std::vector<float> row(cube.info().bands.size() * cube.info().width);
  cube.read_rows(cube.info().height / 2, 1, row, {});
  return row;
}

double sum_of(const std::vector<float>& row) {
  return std::accumulate(row.begin(), row.end(), 0.0);
}

/// Whether the cube's row is the replicates' mean, near enough; so it is where pixels have no samples.
bool is_mean(const std::vector<float>& mean, const std::vector<std::vector<float>>& rows,
             const std::vector<double>& samples) {
  std::vector<double> sums;
  double sum = 0, total = 0;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    sums.push_back(sum_of(rows[r]));
    sum += samples[r] * sums[r];
    total += samples[r];
  }
  const double allowed = 1e-5 * std::abs(sum_of(mean)) + 0.5 * replicate_error(sums, samples);
  return !(std::abs(sum_of(mean) - sum / total) > allowed);
}

/// Whether every value lies among the replicates': so does a mean with any weights.
bool is_among(const std::vector<float>& mean, const std::vector<std::vector<float>>& rows) {
  for (std::size_t i = 0; i < mean.size(); ++i) {
    float low = std::numeric_limits<float>::infinity(), high = -low;
    for (const auto& row : rows)
      if (!std::isnan(row[i])) low = std::min(low, row[i]), high = std::max(high, row[i]);
    const float rounding = 1e-5f * std::abs(mean[i]);
    if (mean[i] < low - rounding || mean[i] > high + rounding) return false;
  }
  return true;
}

/// Replicates of a scene that was changed since have the same header; their mean is another. In an interrupted render pixels have more
/// samples of a replicate than its header can state.
void check_mean(const ReplicatedCube& cube, const fs::path& file) {
  std::vector<std::vector<float>> rows;
  for (const auto& replicate : cube.replicates) rows.push_back(middle_row(*replicate));
  const std::vector<float> mean = middle_row(*cube.mean);
  const bool stated = !cube.mean->info().replicate_samples.empty();
  const auto [least, most] = std::ranges::minmax(cube.samples);
  if (stated && most - least > 1 ? is_among(mean, rows) : is_mean(mean, rows, cube.samples)) return;
  throw InputError(replicate_path(file, 0).string() +
                   " ...: the replicates' mean is not this cube's (of another render" +
                   (stated ? "?): remove them" : ", or of an interrupted one?): move them elsewhere"));
}

/// Cubes that do not state their replicates' samples are of a time when interrupted renders stated what was wanted: replicates
/// that lack pixels of the last row, which is rendered last, do not count.
uint32_t least_replicates(const ReplicatedCube& cube) {
  const CubeInfo& info = cube.mean->info();
  if (!info.replicate_samples.empty()) return info.replicates;
  const auto has_all = [&](const std::unique_ptr<CubeReader>& replicate) {
    std::vector<float> row(info.bands.size() * info.width);
    replicate->read_rows(info.height - 1, 1, row, {});
    return std::ranges::none_of(row, [](float value) { return std::isnan(value); });
  };
  const auto count = std::ranges::count_if(cube.replicates, has_all);
  return static_cast<uint32_t>(std::max<std::ptrdiff_t>(count, 1));
}

/// Adds the variance of the mean over replicates.
class VarianceCube : public CubeReader {
 public:
  explicit VarianceCube(ReplicatedCube cube) : cube_(std::move(cube)), info_(cube_.mean->info()) {
    info_.variance = true;
    info_.replicates = cube_.least_replicates;
    info_.replicate_samples.clear();
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

std::size_t count_values(std::span<const double> values) {
  return static_cast<std::size_t>(std::ranges::count_if(values, [](double v) { return !std::isnan(v); }));
}

double replicate_error(std::span<const double> values, std::span<const double> samples) {
  const auto counts = [&](std::size_t r) { return !std::isnan(values[r]) && samples[r] > 0; };
  double sum = 0, total = 0, squares = 0;
  std::size_t count = 0;
  for (std::size_t r = 0; r < values.size(); ++r) {
    if (!counts(r)) continue;
    sum += samples[r] * values[r];
    total += samples[r];
    ++count;
  }
  if (count < 2) return std::numeric_limits<double>::quiet_NaN();
  for (std::size_t r = 0; r < values.size(); ++r)
    if (counts(r)) squares += samples[r] * (values[r] - sum / total) * (values[r] - sum / total);
  return std::sqrt(squares / (total * static_cast<double>(count - 1)));
}

ReplicatedCube ReplicatedCube::transformed(
    const std::function<std::unique_ptr<CubeReader>(std::unique_ptr<CubeReader>)>& change) && {
  ReplicatedCube result{change(std::move(mean)), {}, std::move(samples), least_replicates};
  for (auto& replicate : replicates) result.replicates.push_back(change(std::move(replicate)));
  return result;
}

ReplicatedCube open_replicated_cube(const fs::path& file, const DiagnosticSink& sink) {
  ReplicatedCube cube{open_cube(file, sink), {}, {}, 0};
  const CubeInfo& info = cube.mean->info();
  const std::vector<uint64_t>& stated = info.replicate_samples;
  const uint32_t replicates = stated.empty() ? info.replicates : static_cast<uint32_t>(stated.size());
  std::error_code unknown;  // a name that is too long for a replicate has none
  if (replicates < 2 || !fs::exists(replicate_path(file, 0), unknown)) return cube;
  const ReplicatePlan plan{info.samples_per_pixel, replicates};
  for (uint32_t r = 0; r < replicates; ++r) {
    const fs::path path = replicate_path(file, r);
    if (!fs::exists(path, unknown))
      throw InputError(path.string() + ": is missing: the cube has " + std::to_string(replicates) +
                       " replicates");
    cube.replicates.push_back(open_cube(path));
    check_replicate(info, cube.replicates.back()->info(), r, path);
    cube.samples.push_back(stated.empty() ? std::max(1.0, static_cast<double>(plan.size(r)))
                                          : static_cast<double>(stated[r]));
  }
  check_mean(cube, file);
  cube.least_replicates = least_replicates(cube);
  return cube;
}

std::unique_ptr<CubeReader> with_replicate_variance(ReplicatedCube cube) {
  if (!cube.has_errors()) return std::move(cube.mean);
  return std::make_unique<VarianceCube>(std::move(cube));
}

}  // namespace kiloband
