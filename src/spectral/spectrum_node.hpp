// What a Spectrum points to: one immutable node per kind.
// Only the .cpp files of this folder include this header.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "spectral/spectrum.hpp"

namespace kiloband {

/// The smallest and largest value of something.
struct ValueBounds {
  double min;
  double max;
};

/// Intervals [min_nm, max_nm] that methods get are ascending and finite (checked by Spectrum).
class Spectrum::Node {
 public:
  using Pointer = std::shared_ptr<const Node>;

  virtual ~Node() = default;
  virtual double value(double lambda_nm) const = 0;
  virtual void evaluate(std::span<const double> lambda_nm, std::span<double> out) const;

  /// Contains all values on the interval; converges to the true bounds as the interval shrinks between two
  /// breaks. Cheap, and exact for single spectra.
  virtual ValueBounds enclosure(double min_nm, double max_nm) const = 0;
  /// Contains all values, and is not wider than Spectrum::max_over promises.
  virtual ValueBounds bounds(double min_nm, double max_nm) const { return enclosure(min_nm, max_nm); }
  virtual double integral(double min_nm, double max_nm) const = 0;

  /// Appends the points inside the open interval where the function has a kink, a jump, an extremum or its
  /// steepest slope, in any order: between them it is smooth and tame.
  virtual void append_breaks(double min_nm, double max_nm, std::vector<double>& out) const = 0;
  /// The breaks with both ends, ascending and distinct.
  std::vector<double> breaks(double min_nm, double max_nm) const;

  virtual Pointer scaled(double factor) const = 0;
  /// Null where extrapolating changes nothing.
  virtual Pointer extrapolated() const { return nullptr; }

  virtual bool is_constant() const { return false; }
  virtual std::optional<PlanckParameters> planck_parameters() const { return std::nullopt; }
  virtual std::optional<Range> data_range() const { return std::nullopt; }
  virtual bool extrapolates() const { return false; }
  /// The range outside of which the function is 0, or keeps the value of that end if it extrapolates.
  virtual std::optional<Range> varying_range() const { return std::nullopt; }
  virtual std::span<const double> knots_nm() const { return {}; }
  virtual std::span<const double> knot_values() const { return {}; }
};

class ConstantNode final : public Spectrum::Node {
 public:
  explicit ConstantNode(double value) : value_(value) {}
  double value(double) const override { return value_; }
  ValueBounds enclosure(double, double) const override { return {value_, value_}; }
  double integral(double min_nm, double max_nm) const override { return value_ * (max_nm - min_nm); }
  void append_breaks(double, double, std::vector<double>&) const override {}
  Pointer scaled(double factor) const override { return std::make_shared<ConstantNode>(value_ * factor); }
  bool is_constant() const override { return true; }

 private:
  double value_;
};

class TableNode final : public Spectrum::Node {
 public:
  /// The data have been checked (Spectrum::tabulated).
  TableNode(std::vector<double> lambda_nm, std::vector<double> values, bool extrapolate);
  double value(double lambda_nm) const override;
  void evaluate(std::span<const double> lambda_nm, std::span<double> out) const override;
  ValueBounds enclosure(double min_nm, double max_nm) const override;
  double integral(double min_nm, double max_nm) const override;
  void append_breaks(double min_nm, double max_nm, std::vector<double>& out) const override;
  Pointer scaled(double factor) const override;
  Pointer extrapolated() const override;
  std::optional<Spectrum::Range> data_range() const override {
    return {{lambda_nm_.front(), lambda_nm_.back()}};
  }
  bool extrapolates() const override { return extrapolate_; }
  std::optional<Spectrum::Range> varying_range() const override { return data_range(); }
  std::span<const double> knots_nm() const override { return lambda_nm_; }
  std::span<const double> knot_values() const override { return values_; }

 private:
  double inside(std::size_t segment, double lambda_nm) const;
  double outside(double lambda_nm) const;

  std::vector<double> lambda_nm_;
  std::vector<double> values_;
  bool extrapolate_;
};

class SigmoidNode final : public Spectrum::Node {
 public:
  SigmoidNode(const std::array<double, 3>& c, double scale) : c_(c), scale_(scale) {}
  double value(double lambda_nm) const override;
  ValueBounds enclosure(double min_nm, double max_nm) const override;
  double integral(double min_nm, double max_nm) const override;
  void append_breaks(double min_nm, double max_nm, std::vector<double>& out) const override;
  Pointer scaled(double factor) const override { return std::make_shared<SigmoidNode>(c_, scale_ * factor); }
  bool is_constant() const override { return c_[0] == 0 && c_[1] == 0; }
  std::optional<Spectrum::Range> data_range() const override;
  bool extrapolates() const override { return true; }
  std::optional<Spectrum::Range> varying_range() const override { return data_range(); }

 private:
  std::array<double, 3> c_;
  double scale_;
};

class PlanckNode final : public Spectrum::Node {
 public:
  PlanckNode(double temperature_k, double scale, std::optional<Spectrum::Range> range)
      : temperature_k_(temperature_k), scale_(scale), range_(range) {}
  std::optional<Spectrum::PlanckParameters> planck_parameters() const override {
    return {{temperature_k_, scale_, range_}};
  }
  double value(double lambda_nm) const override;
  ValueBounds enclosure(double min_nm, double max_nm) const override;
  double integral(double min_nm, double max_nm) const override;
  void append_breaks(double min_nm, double max_nm, std::vector<double>& out) const override;
  Pointer scaled(double factor) const override;
  std::optional<Spectrum::Range> data_range() const override { return range_; }
  std::optional<Spectrum::Range> varying_range() const override { return range_; }

 private:
  /// The part of the interval where the spectrum is not 0; empty if none.
  std::optional<Spectrum::Range> inside(double min_nm, double max_nm) const;
  double peak_nm() const;

  double temperature_k_;
  double scale_;
  std::optional<Spectrum::Range> range_;
};

/// The product of two or more nodes that are not products themselves.
class ProductNode final : public Spectrum::Node {
 public:
  explicit ProductNode(std::vector<Pointer> factors) : factors_(std::move(factors)) {}
  double value(double lambda_nm) const override;
  void evaluate(std::span<const double> lambda_nm, std::span<double> out) const override;
  ValueBounds enclosure(double min_nm, double max_nm) const override;
  ValueBounds bounds(double min_nm, double max_nm) const override;
  double integral(double min_nm, double max_nm) const override;
  void append_breaks(double min_nm, double max_nm, std::vector<double>& out) const override;
  Pointer scaled(double factor) const override;
  Pointer extrapolated() const override;
  bool is_constant() const override;
  std::optional<Spectrum::Range> data_range() const override;
  bool extrapolates() const override;
  std::optional<Spectrum::Range> varying_range() const override;
  const std::vector<Pointer>& factors() const { return factors_; }

 private:
  bool is_cut_off() const;

  std::vector<Pointer> factors_;
};

}  // namespace kiloband
