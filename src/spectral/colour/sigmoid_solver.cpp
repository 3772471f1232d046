#include "spectral/colour/sigmoid_solver.hpp"

#include <algorithm>
#include <cmath>

#include "spectral/colour/colour.hpp"

namespace kiloband {
namespace {

constexpr double kCentreNm = 0.5 * (kCieMinNm + kCieMaxNm);
constexpr double kHalfNm = 0.5 * (kCieMaxNm - kCieMinNm);
constexpr double kCellNm = 5;

double determinant(const Mat3& m) {
  return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
         m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
         m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
}

/// Cramer's rule; the result is not finite where the matrix is singular.
Vec3 solve(const Mat3& m, const Vec3& b) {
  const double scale = 1 / determinant(m);
  Vec3 x;
  for (int j = 0; j < 3; ++j) {
    Mat3 replaced = m;
    for (int i = 0; i < 3; ++i) replaced[i][j] = b[i];
    x[j] = determinant(replaced) * scale;
  }
  return x;
}

bool is_finite(const Vec3& v) {
  return std::isfinite(v[0]) && std::isfinite(v[1]) && std::isfinite(v[2]);
}

double largest_difference(const Vec3& a, const Vec3& b) {
  return std::max({std::abs(a[0] - b[0]), std::abs(a[1] - b[1]), std::abs(a[2] - b[2])});
}

/// Linear sRGB to XYZ, each relative to white: rows sum to 1, so that grey stays grey.
Mat3 relative_xyz_matrix() {
  Mat3 to_rgb;
  for (int j = 0; j < 3; ++j) {
    Vec3 unit{};
    unit[j] = 1;
    const Vec3 column = xyz_to_linear_srgb(unit);
    for (int i = 0; i < 3; ++i) to_rgb[i][j] = column[i];
  }
  Mat3 result;
  for (int j = 0; j < 3; ++j) {
    Vec3 unit{};
    unit[j] = 1;
    const Vec3 column = solve(to_rgb, unit);
    for (int i = 0; i < 3; ++i) result[i][j] = column[i];
  }
  for (Vec3& row : result) {
    const double sum = row[0] + row[1] + row[2];
    for (double& element : row) element /= sum;
  }
  return result;
}

/// CIELAB's f and its derivative.
double lab_f(double t, double& derivative) {
  constexpr double kDelta = 6.0 / 29.0;
  if (t <= kDelta * kDelta * kDelta) {
    derivative = 1 / (3 * kDelta * kDelta);
    return t * derivative + 4.0 / 29.0;
  }
  const double root = std::cbrt(t);
  derivative = 1 / (3 * root * root);
  return root;
}

/// L* a* b* of a colour; with derivatives by the components of rgb.
Vec3 lab(const Vec3& rgb, Mat3& derivative) {
  static const Mat3 kToXyz = relative_xyz_matrix();
  Vec3 f;
  Mat3 df;
  for (int i = 0; i < 3; ++i) {
    double slope = 0;
    f[i] = lab_f(kToXyz[i][0] * rgb[0] + kToXyz[i][1] * rgb[1] + kToXyz[i][2] * rgb[2], slope);
    for (int j = 0; j < 3; ++j) df[i][j] = slope * kToXyz[i][j];
  }
  for (int j = 0; j < 3; ++j) {
    derivative[0][j] = 116 * df[1][j];
    derivative[1][j] = 500 * (df[0][j] - df[1][j]);
    derivative[2][j] = 200 * (df[1][j] - df[2][j]);
  }
  return {116 * f[1] - 16, 500 * (f[0] - f[1]), 200 * (f[1] - f[2])};
}

Mat3 multiply(const Mat3& a, const Mat3& b) {
  Mat3 result{};
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      for (int k = 0; k < 3; ++k) result[i][j] += a[i][k] * b[k][j];
  return result;
}

/// What a fit knows about its current q.
struct State {
  Vec3 q, rgb, residual;  // residual in CIELAB
  Mat3 jacobian;          // of the residual by q
  double cost;
};

template <class Real>
State examine(const ColourQuadrature<Real>& quadrature, const Vec3& q, const Vec3& target_lab) {
  State state{q, {}, {}, {}, 0};
  Mat3 by_q, by_rgb;
  quadrature.evaluate(q, state.rgb, by_q);
  const Vec3 have = lab(state.rgb, by_rgb);
  state.jacobian = multiply(by_rgb, by_q);
  for (int i = 0; i < 3; ++i) {
    state.residual[i] = have[i] - target_lab[i];
    state.cost += state.residual[i] * state.residual[i];
  }
  return state;
}

/// Step of Levenberg and Marquardt: (J^T J + damping diag(J^T J)) step = -J^T r.
Vec3 damped_step(const State& state, double damping) {
  Mat3 normal{};
  Vec3 right{};
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k) {
      for (int j = 0; j < 3; ++j) normal[i][j] += state.jacobian[k][i] * state.jacobian[k][j];
      right[i] -= state.jacobian[k][i] * state.residual[k];
    }
  for (int i = 0; i < 3; ++i) normal[i][i] *= 1 + damping;
  return solve(normal, right);
}

}  // namespace

template <class Real>
ColourQuadrature<Real>::ColourQuadrature(int points_per_cell) {
  const int cells = static_cast<int>((kCieMaxNm - kCieMinNm) / kCellNm);
  for (int cell = 0; cell < cells; ++cell) {
    const double centre_nm = kCieMinNm + kCellNm * (cell + 0.5);
    const double offset_nm =
        0.5 * kCellNm * std::sqrt(0.6);  // Gauss-Legendre with 3 points: 0 and +-sqrt(3/5)
    if (points_per_cell == 1) {
      add_point(centre_nm, 1);
      continue;
    }
    add_point(centre_nm - offset_nm, 5.0 / 18);
    add_point(centre_nm, 8.0 / 18);
    add_point(centre_nm + offset_nm, 5.0 / 18);
  }
  for (std::vector<Real>& weights : weights_) {
    double white = 0;
    for (const Real weight : weights) white += static_cast<double>(weight);
    for (Real& weight : weights) weight = static_cast<Real>(static_cast<double>(weight) / white);
  }
  const std::size_t padded = (u_.size() + kLanes - 1) / kLanes * kLanes;
  u_.resize(padded, 0);
  for (std::vector<Real>& weights : weights_) weights.resize(padded, 0);
}

template <class Real>
void ColourQuadrature<Real>::add_point(double lambda_nm, double weight) {
  const double power = weight * illuminant_d65()(lambda_nm);
  const Vec3 rgb = xyz_to_linear_srgb(
      {power * cie_x()(lambda_nm), power * cie_y()(lambda_nm), power * cie_z()(lambda_nm)});
  u_.push_back(static_cast<Real>((lambda_nm - kCentreNm) / kHalfNm));
  for (int k = 0; k < 3; ++k) weights_[k].push_back(static_cast<Real>(rgb[k]));
}

// S = 1/2 + v / (2 sqrt(1 + v^2)), dS/dv = 1 / (2 (1 + v^2)^(3/2)).
// The inner loops run over the lanes of a register.
template <class Real>
void ColourQuadrature<Real>::evaluate(const Vec3& q, Vec3& rgb, Mat3& jacobian) const {
  const Real q0 = static_cast<Real>(q[0]), q1 = static_cast<Real>(q[1]), q2 = static_cast<Real>(q[2]);
  Real sums[3][4][kLanes] = {};  // of S and of its derivatives by q2, q1, q0
  for (std::size_t at = 0; at < u_.size(); at += kLanes) {
    Real s[kLanes], d[kLanes], d_u[kLanes], d_uu[kLanes];
    for (std::size_t i = 0; i < kLanes; ++i) {
      const Real u = u_[at + i];
      const Real v = (q0 * u + q1) * u + q2;
      const Real inverse = 1 / std::sqrt(1 + v * v);
      s[i] = Real(0.5) + Real(0.5) * v * inverse;
      d[i] = Real(0.5) * inverse * inverse * inverse;
      d_u[i] = d[i] * u;
      d_uu[i] = d_u[i] * u;
    }
    for (int k = 0; k < 3; ++k)
      for (std::size_t i = 0; i < kLanes; ++i) {
        const Real w = weights_[k][at + i];
        sums[k][0][i] += w * s[i];
        sums[k][1][i] += w * d[i];
        sums[k][2][i] += w * d_u[i];
        sums[k][3][i] += w * d_uu[i];
      }
  }
  for (int k = 0; k < 3; ++k) {
    double total[4] = {};
    for (int t = 0; t < 4; ++t)
      for (std::size_t i = 0; i < kLanes; ++i) total[t] += static_cast<double>(sums[k][t][i]);
    rgb[k] = total[0];
    jacobian[k] = {total[3], total[2], total[1]};
  }
}

template class ColourQuadrature<float>;
template class ColourQuadrature<double>;

template <class Real>
double fit_sigmoid(const ColourQuadrature<Real>& quadrature, const Vec3& rgb, Vec3& q, double goal,
                   int max_iterations) {
  Mat3 unused;
  const Vec3 target = lab(rgb, unused);
  State state = examine(quadrature, q, target);
  double damping = 1e-4;
  for (int i = 0; i < max_iterations && largest_difference(state.rgb, rgb) > goal; ++i) {
    const Vec3 step = damped_step(state, damping);
    const Vec3 next_q = {state.q[0] + step[0], state.q[1] + step[1], state.q[2] + step[2]};
    const double size = std::max({std::abs(next_q[0]), std::abs(next_q[1]), std::abs(next_q[2])});
    const State next =
        is_finite(step) && size <= kLargestPolynomial ? examine(quadrature, next_q, target) : state;
    if (next.cost < state.cost) {
      state = next;
      damping = std::max(1e-12, 0.1 * damping);
    } else {
      damping *= 8;
      if (damping > 1e12) break;
    }
  }
  q = state.q;
  return largest_difference(state.rgb, rgb);
}

template double fit_sigmoid(const ColourQuadrature<float>&, const Vec3&, Vec3&, double, int);
template double fit_sigmoid(const ColourQuadrature<double>&, const Vec3&, Vec3&, double, int);

bool newton_step(const Vec3& rgb, const Vec3& have, const Mat3& jacobian, Vec3& q) {
  const Vec3 step = solve(jacobian, {rgb[0] - have[0], rgb[1] - have[1], rgb[2] - have[2]});
  const Vec3 next = {q[0] + step[0], q[1] + step[1], q[2] + step[2]};
  if (!is_finite(next)) return false;
  q = next;
  return true;
}

double flat_sigmoid(double value) {
  const double spread = 2 * std::sqrt(value * (1 - value));
  if (!(spread > 0)) return value < 0.5 ? -kLargestSigmoid : kLargestSigmoid;
  return std::clamp((2 * value - 1) / spread, -kLargestSigmoid, kLargestSigmoid);
}

Vec3 to_centred_nanometres(const Vec3& q) {
  return {q[0] / (kHalfNm * kHalfNm), q[1] / kHalfNm, q[2]};
}

Vec3 to_nanometres(const Vec3& q) {
  const auto [a, b, c] = to_centred_nanometres(q);
  return {a, b - 2 * a * kCentreNm, (a * kCentreNm - b) * kCentreNm + c};
}

}  // namespace kiloband
