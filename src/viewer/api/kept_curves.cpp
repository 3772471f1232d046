#include "viewer/api/kept_curves.hpp"

#include <utility>

namespace kiloband::viewer {
namespace {

constexpr std::size_t kMostCurves = 64;

/// A pixel's is read as fast as it is found.
bool is_worth_keeping(const Selection& selection) {
  return selection.x1 > selection.x0 || selection.y1 > selection.y0;
}

}  // namespace

void KeptCurves::find(const std::vector<Selection>& selections, std::vector<Curve>& curves,
                      std::vector<std::size_t>& missing) {
  const std::lock_guard lock(mutex_);
  for (std::size_t i = 0; i < selections.size(); ++i) {
    const auto kept = curves_.find(selections[i].text);
    if (kept == curves_.end())
      missing.push_back(i);
    else
      curves[i] = kept->second;
  }
}

void KeptCurves::keep(const std::vector<Selection>& selections, const std::vector<Curve>& curves) {
  const std::lock_guard lock(mutex_);
  for (std::size_t i = 0; i < selections.size(); ++i) {
    if (!is_worth_keeping(selections[i])) continue;
    if (curves_.size() >= kMostCurves) curves_.clear();
    curves_.insert_or_assign(selections[i].text, curves[i]);
  }
}

std::vector<Curve> KeptCurves::read(const ImageView& image, const std::vector<Selection>& selections,
                                    unsigned threads) {
  std::vector<Curve> curves(selections.size());
  std::vector<std::size_t> missing;
  find(selections, curves, missing);
  if (missing.empty()) return curves;
  std::vector<Selection> to_read;
  for (const std::size_t i : missing) to_read.push_back(selections[i]);
  std::vector<Curve> read = read_curves(image.pixels, to_read, image.full_width, image.full_height, threads);
  keep(to_read, read);
  for (std::size_t j = 0; j < missing.size(); ++j) curves[missing[j]] = std::move(read[j]);
  return curves;
}

}  // namespace kiloband::viewer
