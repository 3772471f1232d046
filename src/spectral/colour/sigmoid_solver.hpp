// The least-squares problem behind rgb.hpp: which sigmoid has a given colour under D65.
#pragma once

#include <array>
#include <vector>

namespace kiloband {

using Vec3 = std::array<double, 3>;
using Mat3 = std::array<Vec3, 3>;  // [row][column]

/// Quadrature of S(u) D65 CMF over 360-830 nm. A sigmoid is given by q with v(u) = q0 u^2 + q1 u + q2, where
/// u in [-1, 1] stands for the wavelength: the three are then of like size, which powers of nanometres are
/// not. Colours are linear sRGB relative to the white of S = 1, so that greys have q0 = q1 = 0 exactly.
/// Without that division white would be (1.000095, 0.999982, 0.999906).
template <class Real>
class ColourQuadrature {
 public:
  /// points_per_cell  Gauss-Legendre points between neighbouring entries of the CIE's 5 nm tables: 1 (fast)
  /// or 3 (accurate)
  explicit ColourQuadrature(int points_per_cell);

  /// The colour of a sigmoid and its derivatives: jacobian[k][j] = d rgb_k / d q_j.
  void evaluate(const Vec3& q, Vec3& rgb, Mat3& jacobian) const;

 private:
  /// Points are worked on in groups that fit a vector register; the last group is padded with weights 0.
  static constexpr std::size_t kLanes = 16 / sizeof(Real);
  void add_point(double lambda_nm, double weight);

  std::vector<Real> u_;
  std::array<std::vector<Real>, 3> weights_;
};
extern template class ColourQuadrature<float>;
extern template class ColourQuadrature<double>;

/// Damped Gauss-Newton (Levenberg-Marquardt) on the CIELAB difference, from q on.
/// goal     stop when no component of linear sRGB is off by more
/// returns  the largest difference of a component of linear sRGB that is left
template <class Real>
double fit_sigmoid(const ColourQuadrature<Real>& quadrature, const Vec3& rgb, Vec3& q, double goal,
                   int max_iterations);

/// One plain Newton step on linear sRGB, starting from the colour `have` with derivatives `jacobian` at q.
/// False where the matrix is singular or the step is not finite; q is unchanged then.
bool newton_step(const Vec3& rgb, const Vec3& have, const Mat3& jacobian, Vec3& q);

/// v of a flat sigmoid S = value, value in [0, 1], limited to +-kLargestSigmoid.
double flat_sigmoid(double value);
/// At v = -1e5 S is 2.5e-11, and 1 - S at +1e5: 0 and 1 to single precision.
inline constexpr double kLargestSigmoid = 1e5;

/// Bound of the polynomial's coefficients in u: steeper edges change no colour by 1e-5,
/// and cost digits in single precision.
inline constexpr double kLargestPolynomial = 2000;

/// From the polynomial in u to the one in nm from the middle of the colour matching functions, and to the one in nm.
Vec3 to_centred_nanometres(const Vec3& q);
Vec3 to_nanometres(const Vec3& q);

}  // namespace kiloband
