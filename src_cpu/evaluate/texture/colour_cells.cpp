#include "src_cpu/evaluate/texture/colour_cells.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "shared/records.h"
#include "src_cpu/evaluate/rows.hpp"

namespace kiloband::cpu {
namespace {

constexpr double kHalfWidth = ColourCells::kWidthNm / 2;

std::size_t cell_of(double offset_nm) {
  const double position =
      (offset_nm + double{KB_TEXTURE_CENTRE_NM} - ColourCells::kFirstNm) / ColourCells::kWidthNm;
  return std::min(static_cast<std::size_t>(position), ColourCells::kMost - 1);
}

/// nm from KB_TEXTURE_CENTRE_NM.
double centre_of(std::size_t cell) {
  return ColourCells::kFirstNm + (static_cast<double>(cell) + 0.5) * ColourCells::kWidthNm -
         double{KB_TEXTURE_CENTRE_NM};
}

/// Of Chebyshev's polynomial of degree kNodes.
double node_place(std::size_t node) {
  return std::cos((2 * static_cast<double>(node) + 1) * std::numbers::pi / (2 * ColourCells::kNodes));
}

}  // namespace

ColourCellRows::ColourCellRows(const ChannelList& channels, std::size_t padded)
    : nodes_(aligned_zeros<float>(ColourCells::kNodes * ColourCells::kMost + kMaxLanes)),
      centres_(aligned_zeros<float>(ColourCells::kMost + kMaxLanes)),
      places_(aligned_zeros<float>(padded)),
      cells_of_(aligned_zeros<int32_t>(padded)) {
  for (const Channel& channel : channels) narrow_.push_back(channel.width_nm() <= ColourCells::kNarrowNm);
  narrow_.resize(padded, !narrow_.empty() && narrow_.back());
  cells_ = {0, nodes_.get(), centres_.get(), cells_of_.get(), places_.get()};
}

const ColourCells* ColourCellRows::place(const float* offsets_nm) {
  std::array<int32_t, ColourCells::kMost> row;
  row.fill(ColourCells::kAlone);
  for (std::size_t k = 0; k < narrow_.size(); ++k)
    if (narrow_[k]) row[cell_of(offsets_nm[k])] = 0;
  std::vector<double> centres;
  for (std::size_t cell = 0; cell < row.size(); ++cell) {
    if (row[cell] == ColourCells::kAlone) continue;
    row[cell] = static_cast<int32_t>(centres.size());
    centres.push_back(centre_of(cell));
  }
  if (centres.empty()) return nullptr;
  for (std::size_t k = 0; k < narrow_.size(); ++k) {
    const std::size_t cell = cell_of(offsets_nm[k]);
    cells_of_[k] = narrow_[k] ? row[cell] : ColourCells::kAlone;
    places_[k] = static_cast<float>((offsets_nm[k] - centre_of(cell)) / kHalfWidth);
  }
  cells_.count = centres.size();
  for (std::size_t c = 0; c < centres.size(); ++c) {
    centres_[c] = static_cast<float>(centres[c]);
    for (std::size_t n = 0; n < ColourCells::kNodes; ++n)
      nodes_[n * centres.size() + c] = static_cast<float>(centres[c] + kHalfWidth * node_place(n));
  }
  return &cells_;
}

}  // namespace kiloband::cpu
