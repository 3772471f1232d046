#include "spectral/quadrature.hpp"

#include <array>
#include <cmath>
#include <queue>
#include <vector>

namespace kiloband {
namespace {

// Nodes of the 15-point Kronrod rule on [-1, 1], positive half;
// the odd ones (index 1, 3, 5, 7) are the Gauss nodes.
constexpr std::array<double, 8> kNodes = {
    0.991455371120812639206854697526329, 0.949107912342758524526189684047851,
    0.864864423359769072789712788640926, 0.741531185599394439863864773280788,
    0.586087235467691130294144322058447, 0.405845151377397166906606412076961,
    0.207784955007898467600689403773245, 0.0};
constexpr std::array<double, 8> kKronrod = {
    0.022935322010529224963732008058970, 0.063092092629978553290700663189204,
    0.104790010322250183839876322541518, 0.140653259715525918745189590510238,
    0.169004726639267902826583426598550, 0.190350578064785409913256402421014,
    0.204432940075298892414161999234649, 0.209482141084727828012999174891714};
constexpr std::array<double, 4> kGauss = {
    0.129484966168869693270611432679082, 0.279705391489276667901467771423780,
    0.381830050505118944950369775488975, 0.417959183673469387755102040816327};

struct Piece {
  double a, b;
  double value, magnitude, error;  // integrals of f and |f|, estimated error
  bool operator<(const Piece& other) const { return error < other.error; }
};

Piece measure(const std::function<double(double)>& f, double a, double b) {
  const double centre = 0.5 * (a + b), half = 0.5 * (b - a);
  Piece piece{a, b, 0, 0, 0};
  double gauss = 0;
  for (int i = 0; i < 8; ++i) {
    const double left = f(centre - half * kNodes[i]);
    const double right = i == 7 ? 0 : f(centre + half * kNodes[i]);
    piece.value += kKronrod[i] * (left + right);
    piece.magnitude += kKronrod[i] * (std::abs(left) + std::abs(right));
    if (i % 2 == 1) gauss += kGauss[i / 2] * (left + right);
  }
  piece.error = half * std::abs(piece.value - gauss);
  piece.value *= half;
  piece.magnitude *= half;
  return piece;
}

}  // namespace

double integrate(const std::function<double(double)>& f, std::span<const double> breaks,
                 double relative_tolerance) {
  constexpr int kMaxSplits = 4000;  // bounds the time for functions that are not smooth after all
  std::priority_queue<Piece> pieces;
  double value = 0, magnitude = 0, error = 0;
  const auto add = [&](const Piece& piece, double sign) {
    value += sign * piece.value;
    magnitude += sign * piece.magnitude;
    error += sign * piece.error;
  };
  for (std::size_t i = 0; i + 1 < breaks.size(); ++i) {
    const Piece piece = measure(f, breaks[i], breaks[i + 1]);
    pieces.push(piece);
    add(piece, 1);
  }
  for (int split = 0; split < kMaxSplits && error > relative_tolerance * magnitude; ++split) {
    const Piece worst = pieces.top();
    const double middle = 0.5 * (worst.a + worst.b);
    if (!(worst.a < middle && middle < worst.b)) break;
    pieces.pop();
    add(worst, -1);
    for (const Piece& half : {measure(f, worst.a, middle), measure(f, middle, worst.b)}) {
      pieces.push(half);
      add(half, 1);
    }
  }
  return value;
}

}  // namespace kiloband
