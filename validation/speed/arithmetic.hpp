// Numbers from repetitions: centres with their uncertainty, errors against a reference that has one itself, efficiency.
#pragma once

#include <vector>

namespace kiloband::speed {

/// A number and its uncertainty; NaN where there is none.
struct Estimate {
  double value, error;
};

/// The median, and half of the distance from the smallest to the largest. One value: error NaN; none: both are.
Estimate median_of(std::vector<double> values);

/// The mean and its standard error, s / sqrt(n). One value: error NaN; none: both are.
Estimate mean_of(const std::vector<double>& values);

/// What is left of mean squared differences from a reference when the reference's own variance is taken away:
/// E|x - r|^2 = E|x - E x|^2 + bias^2 + var(r) where x and r are independent.
/// squares    of each repetition; all against one reference
/// reference  its variance, with the standard error of that
/// The value may be negative: then the reference does not resolve the error.
Estimate without_reference(const std::vector<double>& squares, const Estimate& reference);

/// sqrt of a square, with the error by its derivative; NaN where the square is not above 0.
Estimate root_of(const Estimate& square);

/// 1 / (error^2 x seconds): images of relative error 1 per second; it does not depend on the number of samples where
/// the error falls as 1 / sqrt(time). First-order uncertainty. NaN where the square is not above 0.
Estimate efficiency_of(const Estimate& square, const Estimate& seconds);

/// a / b with first-order uncertainty, of independent a and b.
Estimate ratio_of(const Estimate& a, const Estimate& b);

}  // namespace kiloband::speed
