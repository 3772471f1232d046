#include "app/compare/compare_input.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>

#include "base/error.hpp"
#include "cube/cube_layout.hpp"
#include "files/output_target.hpp"
#include "post/replicated_cube.hpp"

namespace kiloband {
namespace {

std::string exact_band_text(const Band& band) {
  if (band.derived) return fmt::format("the response '{}'", band.channel.name);
  return fmt::format("{:.10g}-{:.10g} nm", band.channel.min_nm, band.channel.max_nm);
}

/// Edges that were computed along different ways, or from centres in a text file,
/// differ in their last digits.
bool same_band(const Band& a, const Band& b) {
  if (a.derived != b.derived) return false;
  if (a.derived) return a.channel.name == b.channel.name;
  const double allowed = 1e-3 * (a.channel.max_nm - a.channel.min_nm);
  return std::abs(a.channel.min_nm - b.channel.min_nm) <= allowed &&
         std::abs(a.channel.max_nm - b.channel.max_nm) <= allowed;
}

/// From the quantity of a cube to the wanted one; derived bands are what they are.
double factor_of(const CubeInfo& info, std::size_t band, Quantity wanted) {
  const Band& b = info.bands[band];
  if (b.derived || info.quantity == wanted) return 1;
  const double width = b.channel.max_nm - b.channel.min_nm;
  return wanted == Quantity::kIntegral ? width : 1 / width;
}

/// A variance that a file has as a float, with what it may hide: the smallest floats are coarse, and where a
/// program has them rounded to 0 any below the smallest normal one is 0. Where such an error is below the
/// rounding of the mean a variance of 0 is taken as it is.
double variance_with_hidden(float variance, float mean) {
  using Limits = std::numeric_limits<float>;
  if (!(variance >= 0 && variance < Limits::min())) return variance;
  const double rounding = double{Limits::epsilon()} * mean,
               hidden = variance > 0 ? Limits::denorm_min() : Limits::min();
  return variance + (hidden > rounding * rounding ? hidden : 0);
}

bool is_missing(const std::vector<float>& values, std::size_t pixel, std::size_t channels) {
  const auto first = values.begin() + static_cast<std::ptrdiff_t>(pixel * channels);
  return std::all_of(first, first + static_cast<std::ptrdiff_t>(channels),
                     [](float v) { return std::isnan(v); });
}

}  // namespace

std::vector<std::string> split_files(const std::string& text) {
  std::error_code error;  // a list may be longer than a file name can be: what cannot be looked at is no file
  if (std::filesystem::exists(text, error)) return {text};
  std::vector<std::string> files;
  for (std::size_t first = 0; first <= text.size();) {
    const std::size_t comma = std::min(text.find(',', first), text.size());
    files.push_back(text.substr(first, comma - first));
    first = comma + 1;
  }
  return files;
}

void check_same_shape(const std::string& name_a, const CubeInfo& a, const std::string& name_b,
                      const CubeInfo& b) {
  if (a.width != b.width || a.height != b.height)
    throw InputError(fmt::format("{} has {}x{} pixels, {} has {}x{}", name_a, a.width, a.height, name_b,
                                 b.width, b.height));
  if (a.bands.size() != b.bands.size())
    throw InputError(
        fmt::format("{} has {} channels, {} has {}", name_a, a.bands.size(), name_b, b.bands.size()));
  for (std::size_t i = 0; i < a.bands.size(); ++i) {
    if (!same_band(a.bands[i], b.bands[i]))
      throw InputError(fmt::format("channel {}: {} has {}, {} has {}", i, name_a, exact_band_text(a.bands[i]),
                                   name_b, exact_band_text(b.bands[i])));
  }
}

CompareSide::CompareSide(const SideOptions& options, const DiagnosticSink& sink)
    : name_(options.name), files_(options.files) {
  const std::vector<std::string> files = split_files(options.files);
  if (files.size() > 1 && std::ranges::count(files, std::string()) > 0)
    throw InputError(fmt::format("{} '{}': a name in the list is empty", name_, options.files));
  if (files.size() == 1) {
    open_single(options, sink);
    return;
  }
  const std::string letter = options.name == "A" ? "a" : "b";
  if (options.variance || options.dof || options.exact)
    throw InputError(fmt::format("{}: --variance-{}, --dof-{}{} are for a single cube, these are {} renders",
                                 name_, letter, letter, letter == "b" ? ", --b-exact" : "", files.size()));
  open_renders(files, sink);
}

namespace {

/// throws InputError  two of them are one file: of other programs' renders there is no seed that tells
void check_different_files(const std::vector<std::string>& files) {
  std::map<std::string, std::string> names;
  for (const std::string& file : files) {
    const auto identity = output_identity(file);
    if (!identity) continue;
    const auto [found, is_new] = names.emplace(*identity, file);
    if (!is_new)
      throw InputError(
          fmt::format("{} and {} are one file: they are not independent renders", found->second, file));
  }
}

}  // namespace

void CompareSide::open_renders(const std::vector<std::string>& files, const DiagnosticSink& sink) {
  source_ = ErrorSource::kRenders;
  check_different_files(files);
  for (const std::string& file : files) {
    cubes_.push_back(open_cube(file, sink));
    const CubeInfo& info = cubes_.back()->info();
    const std::string seed = metadata_of(info, "seed");
    check_same_shape(files.front(), this->info(), file, info);
    for (std::size_t other = 0; other + 1 < cubes_.size(); ++other) {
      if (!seed.empty() && seed == metadata_of(cubes_[other]->info(), "seed"))
        throw InputError(fmt::format("{} and {} have the same seed {}: they are not independent renders",
                                     files[other], file, seed));
    }
    samples_.push_back(info.samples_per_pixel);
  }
  samples_known_ = std::ranges::count(samples_, uint64_t{0}) == 0;
  if (!samples_known_) std::ranges::fill(samples_, uint64_t{1});
}

void CompareSide::open_single(const SideOptions& options, const DiagnosticSink& sink) {
  if (options.exact && (options.variance || options.dof))
    throw InputError("--b-exact: B then has no errors, which --variance-b and --dof-b would describe");
  ReplicatedCube cube = open_replicated_cube(options.files, sink);
  if (options.exact || options.variance || !cube.has_errors()) {
    source_ = options.exact ? ErrorSource::kExact : ErrorSource::kVariance;
    cubes_.push_back(std::move(cube.mean));
    samples_ = {1};
    if (!options.exact) open_variance(options, sink);
    return;
  }
  if (options.dof)
    throw InputError(fmt::format("{}: has replicates, which have their own degrees of freedom", files_));
  source_ = ErrorSource::kReplicates;
  cubes_ = std::move(cube.replicates);
  for (const double n : cube.samples) samples_.push_back(static_cast<uint64_t>(n));
  const auto [least, most] = std::ranges::minmax(samples_);
  samples_known_ =
      info().samples_per_pixel > 0 && most - least <= 1;  // pixels of interrupted renders have some more
}

namespace {

/// What the cube states. Renders that ended early used to state the replicates that were wanted: no more than there are samples can have
/// any.
double degrees_of_freedom(const CubeInfo& info) {
  uint64_t replicates = info.replicates;
  if (replicates >= 2 && info.samples_per_pixel > 0)
    replicates = std::min(replicates, std::max<uint64_t>(info.samples_per_pixel, 2));
  return replicates >= 2 ? static_cast<double>(replicates - 1) : std::numeric_limits<double>::infinity();
}

}  // namespace

void CompareSide::open_variance(const SideOptions& options, const DiagnosticSink& sink) {
  if (options.variance) {
    variance_ = open_cube(*options.variance, sink);
    check_same_shape(files_, info(), *options.variance, variance_->info());
  } else if (!info().variance) {
    throw InputError(fmt::format(
        "{}: has neither variances nor replicates: render with --variance or --keep-replicates, give several "
        "renders as FILE,FILE,...{}",
        files_, name_ == "B" ? ", or --b-exact if B is the truth" : ""));
  }
  dof_ = options.dof.value_or(degrees_of_freedom(info()));
}

std::string CompareSide::describe() const {
  switch (source_) {
    case ErrorSource::kRenders:
      return fmt::format("{} independent renders", cubes_.size());
    case ErrorSource::kReplicates:
      return fmt::format("{}, {} replicates", files_, cubes_.size());
    case ErrorSource::kExact:
      return fmt::format("{}, taken as exact", files_);
    case ErrorSource::kVariance:
      break;
  }
  if (std::isinf(dof_)) return fmt::format("{}, variances (degrees of freedom unknown: normal law)", files_);
  return fmt::format("{}, variances with {:.6g} degrees of freedom", files_, dof_);
}

std::vector<float> CompareSide::read_mean(CubeReader& cube, uint32_t y0, uint32_t rows,
                                          Quantity quantity) const {
  const std::size_t channels = info().bands.size();
  std::vector<float> values(std::size_t{rows} * info().width * channels);
  cube.read_rows(y0, rows, values, {});
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double factor = factor_of(cube.info(), i % channels, quantity);
    if (factor != 1) values[i] = static_cast<float>(values[i] * factor);
  }
  return values;
}

stats::ReplicateImage CompareSide::read_replicates(uint32_t y0, uint32_t rows, Quantity quantity) const {
  const auto replicates = static_cast<uint32_t>(cubes_.size());
  stats::ReplicateImage image{info().width, rows, info().bands.size(), replicates, {}, {}};
  for (std::size_t r = 0; r < cubes_.size(); ++r) {
    const std::vector<float> values = read_mean(*cubes_[r], y0, rows, quantity);
    image.means.insert(image.means.end(), values.begin(), values.end());
    image.samples.insert(image.samples.end(), image.pixels(), samples_[r]);
  }
  for (std::size_t p = 0; p < image.pixels(); ++p) {
    std::size_t reached = cubes_.size();  // replicates up to the last that has values
    while (reached > 0 && is_missing(image.means, (reached - 1) * image.pixels() + p, image.channels))
      --reached;
    if (source_ == ErrorSource::kRenders && reached > 0) reached = cubes_.size();
    for (std::size_t r = reached; r < cubes_.size(); ++r) image.samples[r * image.pixels() + p] = 0;
  }
  return image;
}

bool CompareSide::states_samples() const {
  if (!samples_known_ || source_ != ErrorSource::kReplicates) return samples_known_;
  const CubeInfo& shape = info();
  std::vector<float> last(std::size_t{shape.width} * shape.bands.size());
  for (uint32_t y = 0; y < shape.height; ++y) {
    cubes_.back()->read_rows(y, 1, last, {});
    for (std::size_t x = 0; x < shape.width; ++x) {
      if (is_missing(last, x, shape.bands.size())) return false;
    }
  }
  return true;
}

stats::MomentImage CompareSide::read_moments(uint32_t y0, uint32_t rows, Quantity quantity) const {
  stats::MomentImage image{info().width, rows, info().bands.size(), dof_, {}, {}};
  image.mean = read_mean(*cubes_.front(), y0, rows, quantity);
  image.variance.assign(image.mean.size(), 0);
  if (source_ == ErrorSource::kExact) {
    image.dof = std::numeric_limits<double>::infinity();
    return image;
  }
  std::vector<float> unused(image.mean.size()), variance(image.mean.size());
  if (variance_)
    variance_->read_rows(y0, rows, variance, {});
  else
    cubes_.front()->read_rows(y0, rows, unused, variance);
  const CubeInfo& info_of_variance = variance_ ? variance_->info() : info();
  for (std::size_t i = 0; i < variance.size(); ++i) {
    const double factor = factor_of(info_of_variance, i % image.channels, quantity);
    image.variance[i] = variance_with_hidden(variance[i], image.mean[i]) * factor * factor;
  }
  return image;
}

}  // namespace kiloband
