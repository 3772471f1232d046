// One unit's difference in every channel, its variance, and the rows of numbers that both come from.
//
// N samples of a unit are dealt to R replicates of n_r samples. With the replicate means m_r
//     m = sum n_r m_r / N,   V = sum n_r (m_r - m)^2 / (N (R - 1)),
// as film/statistics.hpp has it, V with R - 1 degrees of freedom. Two sides: D = m_A - m_B,
// V = V_A + V_B with
//     dof = V^2 / (V_A^2 / (R_A - 1) + V_B^2 / (R_B - 1))        (Welch 1947).
// Where few replicates agree by chance, t is large and dof takes the other side's replicates for theirs: a
// side of 3 replicates against 32 raised 14 times the false alarms at 1e-3, 10^6 times at 1e-9 (16 against
// 16: 12 times, 32 against 32: 2.5 times, at the worst ratio of variances). So dof is a guide to which
// channel is worst, and p is that of Behrens and Fisher, which no ratio of variances exceeds (Robinson, Ann.
// Statist. 4, 1976; computed for levels down to 1e-12, sides of 3 to 256 replicates: at most 1.0 times the
// level). It asks for a t that is larger by 2 % at 1e-5 and by 3 % at 1e-9 where 32 replicates scatter as 32
// others. Pairs of equal seed: the same of the differences m_A,r - m_B,r. A known truth: D = m - truth. The
// rows e_r = sqrt(n_r / (N (R - 1))) (m_r - m) of both sides have V as their sum of squares in each channel,
// and their correlation between channels is that of D: max_t.hpp draws from them.
//
// Noise may be discrete: a pixel across the edge of a lamp is a number of hits. Replicates that agree there
// by chance say nothing of their variance, while t takes it for 0.
//  * One side agrees: its share of the variance is unknown. p is that of the worst share, Student's with the
//    fewer degrees of freedom. (2 replicates against 32: both may hit where 9 in 10 of the others miss.)
//  * Both sides agree, on different values: p is not below the probability of that. With the probabilities
//    p_x of the values and R_A, R_B replicates
//        sum_x p_x^R_A sum_{y != x} p_y^R_B <= sum_x p_x p_x^(R_A - 1) (1 - p_x)^R_B
//                                           <= max_p p^(R_A - 1) (1 - p)^R_B,
//    the same with the sides exchanged: 4 against 4 replicates 0.0084, 8 against 8 3e-5, 2 against 32 5e-4.
//    Pairs, and a truth in the middle of the noise, have signs: 2^(1 - R). What is below kNoChance counts
//    as 0.
#pragma once

#include <span>
#include <vector>

#include "stats/comparison/replicate_image.hpp"

namespace kiloband::stats {

/// Rows that sum to zero when weighted with `root` (of the rows' weights, normalised).
struct RowGroup {
  std::vector<double> root;  // [row]
};

struct Contrast {
  std::size_t channels = 0;
  bool valid = false;              // both sides have two replicates at least
  std::vector<double> a, b;        // [channel] the two means; b is the truth if there is one
  std::vector<double> difference;  // [channel] a - b
  std::vector<double> variance;    // [channel] of the difference
  std::vector<double> dof;         // [channel]
  std::vector<double> share;       // [channel] of A in the variance; empty: Student's law with dof
  double dof_a = 0, dof_b = 0;     // of the sides, with shares
  // [channel] p of a difference is not smaller: that replicates agree by chance; 0 where they do not, or
  // empty
  std::vector<double> agreement;
  std::vector<double> slack;  // [channel] a difference that counts as none: rounding, uncertainty of a truth
  std::vector<double> rows;   // [row][channel]; empty where only variances are known
  std::vector<RowGroup> groups;  // in the order of the rows

  /// (|D| - slack) / sqrt(V) with the sign of D, 0 within the slack. Without any variance 0 or infinite.
  double t(std::size_t channel) const;
  /// P of t if the means are equal.
  double p(std::size_t channel) const;
  /// Below this p of a difference cannot be, as far as agreement goes.
  double least_p(std::size_t channel) const { return agreement.empty() ? 0 : agreement[channel]; }
  /// Neither side varies.
  bool constant(std::size_t channel) const { return variance[channel] == 0; }
};

/// A truth per channel of a unit and how far off it may be itself.
struct TruthValues {
  std::vector<double> value, bound;  // [channel]; bound may be empty
};

inline constexpr double kNoChance = 1e-9;

/// The largest probability with which the replicates of either side agree on a value of their own although
/// both sides have one distribution; 0 if below kNoChance, and for infinitely many. b = 0: of differences
/// with a symmetric distribution.
double chance_agreement(double replicates_a, double replicates_b);

/// The next channel of two sides with these variances of their means; its slack, dof_a and dof_b are known.
void add_variances(double va, double vb, Contrast& contrast);

/// rounding: relative to the larger mean; what float arithmetic may change in one of the two.
Contrast independent_contrast(const UnitSample& a, const UnitSample& b, double rounding);
/// throws std::logic_error  different numbers of replicates
Contrast paired_contrast(const UnitSample& a, const UnitSample& b, double rounding);
Contrast truth_contrast(const UnitSample& a, const TruthValues& truth, double rounding);

/// Number of contributions that differ from zero, as far as replicate means tell: if a share f of them is not
/// zero and contributions come at random (Poisson), there were -R ln(1 - f);
/// infinite if no replicate is zero.
double contributions(const UnitSample& sample, std::size_t channel);

}  // namespace kiloband::stats
