// The selected part of a cube (convert.hpp).
#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "cube/band_lists.hpp"
#include "cube/cube_layout.hpp"
#include "cube/cube_text.hpp"
#include "cube/georeference.hpp"
#include "post/camera_geometry.hpp"
#include "post/convert.hpp"
#include "post/convert_bands.hpp"
#include "post/convert_rebin.hpp"

namespace kiloband {
namespace {

/// The bands of the source that a band of the result is the sum of: one, or several after re-binning.
struct Recipe {
  Band band;
  std::vector<std::size_t> sources;
};

bool lies_inside(const Channel& c, const WavelengthRange& range) {
  return c.min_nm >= range.min_nm - edge_tolerance(range.min_nm) &&
         c.max_nm <= range.max_nm + edge_tolerance(range.max_nm);
}

/// Steps 1 and 2 of CubeSelection: indices, then the wavelength range.
std::vector<Recipe> select_bands(const NamedBands& source, const CubeSelection& selection) {
  const std::vector<Band>& bands = source.bands;
  std::vector<Recipe> chosen;
  const auto take = [&](std::size_t k) {
    const auto& range = selection.range;
    if (range && (bands[k].derived || !lies_inside(bands[k].channel, *range))) return;
    chosen.push_back({bands[k], {k}});
  };
  for (const std::size_t k : selection.bands)
    if (k >= bands.size())
      throw InputError("band index " + std::to_string(k) + ": the cube has " + std::to_string(bands.size()) +
                       " bands, counted from 0");
  for (const std::size_t k : selection.bands.empty() ? source.order : selection.bands) take(k);
  if (chosen.empty())
    throw InputError("no band lies inside " + format_short(selection.range->min_nm) + "-" +
                     format_short(selection.range->max_nm) + " nm");
  return chosen;
}

/// Step 3: each coarse channel as the union of selected bands.
std::vector<Recipe> rebin(const std::vector<Recipe>& fine, const ChannelList& coarse) {
  if (coarse.empty()) throw InputError("re-binning: no channels are given");
  std::vector<Band> bands;
  for (const Recipe& recipe : fine) bands.push_back(recipe.band);
  std::vector<Recipe> result;
  for (std::size_t m = 0; m < coarse.size(); ++m) {
    Recipe recipe{{coarse[m], false}, {}};
    for (const std::size_t k : bands_of_channel(bands, coarse[m], "re-binning: channel " + std::to_string(m)))
      recipe.sources.push_back(fine[k].sources.front());
    result.push_back(std::move(recipe));
  }
  return result;
}

PixelRect choose_crop(const CubeInfo& info, const std::optional<PixelRect>& wanted) {
  const PixelRect rect = wanted.value_or(PixelRect{0, 0, info.width, info.height});
  check_region(info, rect);
  return rect;
}

/// Reads whole rows of the source and picks from them;
/// the scratch buffers are as large as the rows asked for.
class SelectedCube : public CubeReader {
 public:
  /// bands  those of the source, with the wavelengths that they were given
  SelectedCube(std::unique_ptr<CubeReader> source, std::vector<Band> bands, std::vector<Recipe> recipes,
               PixelRect crop, Quantity quantity, const DiagnosticSink& sink)
      : source_(std::move(source)),
        bands_(std::move(bands)),
        recipes_(std::move(recipes)),
        crop_(crop),
        info_(source_->info()),
        conversion_(bands_, source_->info().quantity, quantity) {
    info_.width = crop.width;
    info_.height = crop.height;
    info_.quantity = quantity;
    info_.bands.clear();
    for (const Recipe& recipe : recipes_) info_.bands.push_back(recipe.band);
    const bool singles =
        std::any_of(recipes_.begin(), recipes_.end(), [](const Recipe& r) { return r.sources.size() == 1; });
    info_.variance = info_.variance && singles;
    pick_band_lists(info_.metadata, bands_.size(), singles_only());
    info_.replicate_samples.clear();  // no replicates stand beside what is written
    crop_camera(info_, crop.x0, crop.y0);
    crop_georeference(info_, crop.x0, crop.y0, sink);
  }

  const CubeInfo& info() const override { return info_; }

  std::size_t floats_held() const override { return CubeReader::floats_held() + source_->floats_held(); }

  void read_rows(uint32_t y0, uint32_t rows, std::span<float> mean, std::span<float> variance) override {
    check_read(info_, y0, rows, mean.size(), info_.bands.size());
    check_read(info_, y0, rows, variance.size(),
               variance.empty() || !info_.variance ? 0 : info_.bands.size());
    const std::size_t bands = source_->info().bands.size(), floats = source_floats(rows, bands);
    mean_.resize(floats);
    variance_.resize(variance.empty() ? 0 : floats);
    source_->read_rows(crop_.y0 + y0, rows, mean_, variance_);
    for_pixels(rows, [&](std::size_t from, std::size_t to) {
      const float* values = mean_.data() + from * bands;
      for (std::size_t k = 0; k < recipes_.size(); ++k)
        mean[to * recipes_.size() + k] = value(recipes_[k], values);
      if (variance.empty()) return;
      const float* variances = variance_.data() + from * bands;
      for (std::size_t k = 0; k < recipes_.size(); ++k)
        variance[to * recipes_.size() + k] = variance_of(recipes_[k], variances);
    });
  }

  void read_aux(uint32_t y0, uint32_t rows, std::span<float> aux) override {
    check_read(info_, y0, rows, aux.size(), info_.aux.size());
    const std::size_t planes = info_.aux.size();
    if (planes == 0) return;
    mean_.resize(source_floats(rows, planes));
    source_->read_aux(crop_.y0 + y0, rows, mean_);
    for_pixels(rows, [&](std::size_t from, std::size_t to) {
      std::copy_n(mean_.data() + from * planes, planes, aux.data() + to * planes);
    });
  }

 private:
  /// The source's bands where each of ours is one of them, or nothing.
  std::vector<std::size_t> singles_only() const {
    std::vector<std::size_t> sources;
    for (const Recipe& recipe : recipes_) {
      if (recipe.sources.size() != 1) return {};
      sources.push_back(recipe.sources[0]);
    }
    return sources;
  }

  std::size_t source_floats(uint32_t rows, std::size_t planes) const {
    return std::size_t{rows} * source_->info().width * planes;
  }

  /// action(pixel in the source's rows, pixel in the result's rows)
  template <class Action>
  void for_pixels(uint32_t rows, Action action) const {
    for (uint32_t y = 0; y < rows; ++y)
      for (uint32_t x = 0; x < crop_.width; ++x)
        action(std::size_t{y} * source_->info().width + crop_.x0 + x, std::size_t{y} * crop_.width + x);
  }

  /// One band keeps its bits (or is converted once); several are added as integrals in double precision.
  float value(const Recipe& recipe, const float* values) const {
    if (recipe.sources.size() == 1) return conversion_.value(recipe.sources[0], values[recipe.sources[0]]);
    const Quantity from = source_->info().quantity;
    double integral = 0;
    for (const std::size_t k : recipe.sources)
      integral += values[k] * (from == Quantity::kDensity ? bands_[k].channel.width_nm() : 1.0);
    return static_cast<float>(info_.quantity == Quantity::kDensity ? integral / recipe.band.channel.width_nm()
                                                                   : integral);
  }

  float variance_of(const Recipe& recipe, const float* variances) const {
    if (recipe.sources.size() != 1) return std::numeric_limits<float>::quiet_NaN();
    return conversion_.variance(recipe.sources[0], variances[recipe.sources[0]]);
  }

  std::unique_ptr<CubeReader> source_;
  std::vector<Band> bands_;
  std::vector<Recipe> recipes_;
  PixelRect crop_;
  CubeInfo info_;
  QuantityConversion conversion_;
  std::vector<float> mean_, variance_;
};

/// Says once how many channels lose their error bars and what to do about it.
void note_lost_variances(const std::vector<Recipe>& recipes, const DiagnosticSink& sink) {
  const auto sums =
      std::count_if(recipes.begin(), recipes.end(), [](const Recipe& r) { return r.sources.size() > 1; });
  if (sums > 0)
    note(sink, {},
         std::to_string(sums) + " of " + std::to_string(recipes.size()) +
             " channels are sums of channels and have no standard error: channels share paths, so their "
             "errors are "
             "correlated; give coarse channels before the render to get error bars");
}

}  // namespace

void check_region(const CubeInfo& info, const PixelRect& region) {
  const uint64_t right = uint64_t{region.x0} + region.width, bottom = uint64_t{region.y0} + region.height;
  if (region.width > 0 && region.height > 0 && right <= info.width && bottom <= info.height) return;
  throw InputError("region " + std::to_string(region.x0) + "," + std::to_string(region.y0) + "," +
                   std::to_string(region.width) + "," + std::to_string(region.height) +
                   ": must lie in the image of " + std::to_string(info.width) + "x" +
                   std::to_string(info.height) + " pixels");
}

std::vector<std::size_t> parse_band_indices(std::string_view text, std::size_t count) {
  const auto fail = [&](const std::string& why) {
    throw InputError("band indices '" + printable(text) + "': " + why);
  };
  std::vector<std::size_t> indices;
  std::set<std::size_t> seen;
  for (const std::string_view part : split(text, ',')) {
    const std::size_t dash = part.find('-');
    const auto first = parse_unsigned(part.substr(0, dash));
    const auto last = dash == std::string_view::npos ? first : parse_unsigned(part.substr(dash + 1));
    if (!first || !last || *first > *last) fail("must be a list such as 0-9,20");
    if (*last >= count) fail("the cube has " + std::to_string(count) + " bands, counted from 0");
    for (std::size_t k = *first; k <= *last; ++k) {
      if (!seen.insert(k).second) fail("band " + std::to_string(k) + " is given twice");
      indices.push_back(k);
    }
  }
  return indices;
}

namespace {

std::unique_ptr<CubeReader> select(std::unique_ptr<CubeReader> source, const CubeSelection& selection,
                                   bool replicated, const DiagnosticSink& sink) {
  const CubeInfo& info = source->info();
  const PixelRect crop = choose_crop(info, selection.crop);
  NamedBands bands = give_wavelengths(info.bands, selection.wavelengths);
  std::vector<Recipe> recipes = select_bands(bands, selection);
  if (selection.rebin) {
    const auto derived =
        std::count_if(recipes.begin(), recipes.end(), [](const Recipe& r) { return r.band.derived; });
    if (derived > 0) note(sink, {}, std::to_string(derived) + " derived bands are dropped by re-binning");
    recipes = rebin(recipes, *selection.rebin);
    if (info.variance && !replicated) note_lost_variances(recipes, sink);
  }
  const Quantity quantity = selection.quantity.value_or(info.quantity);
  return std::make_unique<SelectedCube>(std::move(source), std::move(bands.bands), std::move(recipes), crop,
                                        quantity, sink);
}

}  // namespace

std::unique_ptr<CubeReader> select_from_cube(std::unique_ptr<CubeReader> source,
                                             const CubeSelection& selection, const DiagnosticSink& sink) {
  return select(std::move(source), selection, false, sink);
}

ReplicatedCube select_from_cube(ReplicatedCube source, const CubeSelection& selection,
                                const DiagnosticSink& sink) {
  ReplicatedCube result{select(std::move(source.mean), selection, source.has_errors(), sink),
                        {},
                        std::move(source.samples),
                        source.least_replicates};
  for (auto& replicate : source.replicates)
    result.replicates.push_back(select(std::move(replicate), selection, true, {}));
  return result;
}

}  // namespace kiloband
