// Tails and quantiles that the tests need (Boost.Math).
#pragma once

namespace kiloband::stats {

/// P(|T| >= |t|), Student's t; dof may be infinite (normal). 0 for infinite t.
double student_p(double t, double dof);
/// t with P(T >= t) = p, 0 < p < 1.
double student_upper(double p, double dof);
/// P(|sqrt(share) T_a + sqrt(1 - share) T_b| >= |t|) of independent Student's T_a, T_b: Behrens and Fisher's
/// law of a difference over its estimated error, of which side A has the share `share` (contrast.hpp).
double behrens_fisher_p(double t, double share, double dof_a, double dof_b);
/// delta with P(T >= t) = p for the noncentral T = (Z + delta) / sqrt(X / dof), X of chi^2 with dof degrees
/// of freedom; dof may be infinite. t > 0, p >= 0.5.
double noncentral_shift(double t, double dof, double p);
/// P(sqrt(n) D >= x) of Kolmogorov's D for large n.
double kolmogorov_p(double x);

/// P(the smallest of `tests` p-values <= p) if they are independent (Sidak 1967); an upper bound for
/// two-sided normal tests of any correlation. Exact for tiny p.
double sidak(double p, double tests);

}  // namespace kiloband::stats
