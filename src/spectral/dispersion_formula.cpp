#include "spectral/dispersion_formula.hpp"

#include <cmath>
#include <stdexcept>

#include "base/error.hpp"
#include "spectral/files/text_table.hpp"
#include "spectral/tabulate.hpp"

namespace kiloband {
namespace {

constexpr double kLargestIndex = 1e5;  // as metals at 1 mm, by far

/// Coefficients with the database's numbering: C(1) is the first; missing ones are 0.
class Coefficients {
 public:
  explicit Coefficients(const std::vector<double>& values) : values_(values) {}
  double operator()(std::size_t i) const { return i <= values_.size() ? values_[i - 1] : 0; }
  /// Sum over the pairs (C_i, C_i+1), i = first, first + 2 ..., as far as given.
  /// A pair with C_i = 0 adds nothing.
  template <class Term>
  double sum_pairs(std::size_t first, Term term) const {
    double sum = 0;
    for (std::size_t i = first; i <= values_.size(); i += 2)
      if ((*this)(i) != 0) sum += term((*this)(i), (*this)(i + 1));
    return sum;
  }

 private:
  const std::vector<double>& values_;
};

/// Formula 4: two resonances C_i l^C_i+1 / (l^2 - C_i+2^C_i+3) and powers. Without its first coefficient a
/// resonance is absent.
double general_square(const Coefficients& c, double l) {
  double square = c(1);
  for (const std::size_t i : {2u, 6u})
    if (c(i) != 0) square += c(i) * std::pow(l, c(i + 1)) / (l * l - std::pow(c(i + 2), c(i + 3)));
  return square + c.sum_pairs(10, [&](double a, double b) { return a * std::pow(l, b); });
}

/// Formula 8 gives the Lorentz-Lorenz ratio (n^2 - 1) / (n^2 + 2).
double index_of_ratio(double ratio) {
  return std::sqrt((1 + 2 * ratio) / (1 - ratio));
}

}  // namespace

double dispersion_formula(int number, const std::vector<double>& coefficients, double l) {
  const Coefficients c(coefficients);
  const double square = l * l;
  const auto power = [&](double a, double b) { return a * std::pow(l, b); };
  switch (number) {
    case 1:
      return std::sqrt(1 + c(1) +
                       c.sum_pairs(2, [&](double a, double b) { return a * square / (square - b * b); }));
    case 2:
      return std::sqrt(1 + c(1) +
                       c.sum_pairs(2, [&](double a, double b) { return a * square / (square - b); }));
    case 3:
      return std::sqrt(c(1) + c.sum_pairs(2, power));
    case 4:
      return std::sqrt(general_square(c, l));
    case 5:
      return c(1) + c.sum_pairs(2, power);
    case 6:
      return 1 + c(1) + c.sum_pairs(2, [&](double a, double b) { return a / (b - 1 / square); });
    case 7: {
      const double r = 1 / (square - 0.028);
      return c(1) + c(2) * r + c(3) * r * r + c(4) * square + c(5) * square * square +
             c(6) * square * square * square;
    }
    case 8:
      return index_of_ratio(c(1) + c(2) * square / (square - c(3)) + c(4) * square);
    case 9:
      return std::sqrt(c(1) + c(2) / (square - c(3)) + c(4) * (l - c(5)) / ((l - c(5)) * (l - c(5)) + c(6)));
    default:
      throw std::logic_error("dispersion_formula: number must be 1 to 9");
  }
}

std::size_t max_coefficients(int number) {
  switch (number) {
    case 5:
    case 6:
      return 11;
    case 7:
    case 9:
      return 6;
    case 8:
      return 4;
    default:
      return 17;
  }
}

Spectrum tabulate_formula(const std::string& where, int number, const std::vector<double>& coefficients,
                          double min_um, double max_um) {
  const auto index = [&](double lambda_um) {
    const double n = dispersion_formula(number, coefficients, lambda_um);
    if (!std::isfinite(n) || n <= 0)
      throw InputError(where + ": formula " + std::to_string(number) + " gives n = " + format_number(n) +
                       " at " + format_number(lambda_um) + " um: must be positive and finite");
    if (n > kLargestIndex)
      throw InputError(where + ": formula " + std::to_string(number) + " gives n = " + format_number(n) +
                       " at " + format_number(lambda_um) + " um: must be <= " + format_number(kLargestIndex));
    return n;
  };
  return tabulate_function(index, min_um, max_um, {.absolute = 1e-6}, [&](double lambda_um) {
    throw InputError(where + ": formula " + std::to_string(number) + " varies too fast at " +
                     format_number(lambda_um) + " um");
  });
}

}  // namespace kiloband
