#include "base/gauss_legendre.hpp"

#include <boost/math/special_functions/legendre.hpp>

namespace kiloband {

GaussLegendre gauss_legendre(int n) {
  const std::vector<double> roots = boost::math::legendre_p_zeros<double>(n);  // the ones that are >= 0
  GaussLegendre rule;
  for (std::size_t i = roots.size(); i-- > 0;) {
    if (roots[i] > 0) rule.nodes.push_back(-roots[i]);
  }
  rule.nodes.insert(rule.nodes.end(), roots.begin(), roots.end());
  for (const double x : rule.nodes) {
    const double derivative = boost::math::legendre_p_prime(n, x);
    rule.weights.push_back(2 / ((1 - x * x) * derivative * derivative));
  }
  return rule;
}

}  // namespace kiloband
