// Gauss-Legendre quadrature.
#pragma once

#include <vector>

namespace kiloband {

/// Integrates polynomials of degree 2 n - 1 over [-1, 1] exactly: sum of weights[i] f(nodes[i]).
struct GaussLegendre {
  std::vector<double> nodes, weights;  // ascending nodes; the weights' sum is 2
};

/// The rule of n >= 1 nodes. Nodes are the roots of the Legendre polynomial P_n (Boost.Math), weights
/// 2 / ((1 - x^2) P_n'(x)^2).
GaussLegendre gauss_legendre(int n);

}  // namespace kiloband
