// What rounding, resampling filters and changes of colour space leave in images of light:
// values just below 0.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace kiloband {

/// The part of the mean down to which a negative value is taken as 0.
inline constexpr double kSlightlyNegative = 0.01;

/// The values of an image, or of one of its bands, seen one by one. Negative ones are slightly so if none
/// lies below -kSlightlyNegative times the mean, in which negative values count as 0: against the mean and
/// not the maximum, because a sun in the picture would excuse anything.
class NegativeValues {
 public:
  /// value  finite;  index  its place in the image
  void add(float value, std::size_t index) {
    ++count_;
    if (value >= 0) {
      sum_ += value;
      return;
    }
    ++negative_;
    if (value < lowest_) lowest_ = value, lowest_index_ = index;
  }

  uint64_t negative() const { return negative_; }
  /// 0 if none is negative.
  float lowest() const { return lowest_; }
  std::size_t lowest_index() const { return lowest_index_; }
  bool acceptable() const { return lowest_ >= least(); }
  /// "must be finite and >= 0 (down to -0.005, 1 % of the mean, is taken as 0)"; without the part in brackets
  /// where the mean is 0.
  std::string rule() const;

 private:
  double least() const { return count_ == 0 ? 0 : -kSlightlyNegative * sum_ / static_cast<double>(count_); }

  double sum_ = 0;  // of the values that are not negative
  uint64_t count_ = 0, negative_ = 0;
  float lowest_ = 0;
  std::size_t lowest_index_ = 0;
};

}  // namespace kiloband
