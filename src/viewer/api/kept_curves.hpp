// Curves of rectangles, kept: a page asks for those of all its pins at every step of the mouse.
#pragma once

#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "viewer/api/selections.hpp"
#include "viewer/api/viewed_image.hpp"

namespace kiloband::viewer {

/// Of one image that never changes. Thread-safe.
class KeptCurves {
 public:
  /// As read_curves()
  std::vector<Curve> read(const ImageView& image, const std::vector<Selection>& selections, unsigned threads);

 private:
  void find(const std::vector<Selection>& selections, std::vector<Curve>& curves,
            std::vector<std::size_t>& missing);
  void keep(const std::vector<Selection>& selections, const std::vector<Curve>& curves);

  std::mutex mutex_;
  std::map<std::string, Curve> curves_;  // by Selection::text
};

}  // namespace kiloband::viewer
