// What the SIMD kernels of deferred evaluation work on: a path resolved to pointers into dense rows.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "shared/records.h"
#include "src_cpu/lanes/isa.hpp"

namespace kiloband::cpu {

/// Rows are padded to this many channels: the most that one pass holds in registers (4 AVX-512 vectors).
inline constexpr std::size_t kRowPadding = 64;
/// Lanes of the widest vector.
inline constexpr std::size_t kMaxLanes = 16;

/// A bilinear lookup in a texture of colours:
///   value(lambda) = (constant + sum_i weight_i S((a_i y + b_i) y + c_i)) * factor,   y = lambda - KB_TEXTURE_CENTRE_NM.
/// Texels that are spectrally flat are summed in `constant`; weights include the texels' scales.
struct ColourTerms {
  static constexpr uint32_t kMost = 4;
  uint32_t count = 0;            // even: a last term may have weight 0
  float coefficients[kMost][3];  // a, b, c
  float weights[kMost];
  float constant = 0;
  const float* factor = nullptr;  // dense row, or null for 1
};

/// Where a lookup is interpolated: each cell of wavelengths that narrow channels are in has a polynomial of degree 7 in the place t in
/// it, -1 to 1, through values at Chebyshev's nodes. A channel wider than kNarrowNm is alone: fewer than some 30 in a cell do not earn
/// its nodes. So is any where the cell's polynomial would not be accurate, see smooth_cells() of evaluator_colours-inl.hpp.
struct ColourCells {
  static constexpr std::size_t kNodes = 8, kMost = 19;
  static constexpr double kFirstNm = 355, kWidthNm = 25, kNarrowNm = 0.81;  // 0.8, however it is rounded
  static constexpr int32_t kAlone = kMost;
  std::size_t count = 0;           // cells that have channels
  const float* nodes = nullptr;    // [kNodes][count], nm from KB_TEXTURE_CENTRE_NM
  const float* centres = nullptr;  // [count], the same
  const int32_t* cell = nullptr;   // of channels: < count, or kAlone
  const float* place = nullptr;    // of channels: t
};

/// Wavelengths of lookups, nm from KB_TEXTURE_CENTRE_NM, by channel; padded with the last one. From `distinct` on all are the same, and in one cell or alone:
/// beyond 830 nm, where a colour says nothing, its spectrum goes on as it is there.
struct ColourOffsets {
  const float* nm;
  std::size_t distinct;
  const ColourCells* cells = nullptr;  // null: all channels are alone
};

/// Fresnel reflectance at a fixed angle. Quantities of cancellation are stored as sums of two floats:
/// conductor (nk != null, see DenseSpectra::conductor()): T = n^2 - 1 - k^2;  dielectric: E = e^2 - 1, e = transmitted over incident index.
struct FresnelTerms {
  const float* high = nullptr;
  const float* low = nullptr;
  const float* nk = nullptr;
  enum class Of : uint8_t { kBoundary, kPaneReflectance, kPaneTransmittance };
  Of of = Of::kBoundary;  // panes: KB_MATERIAL_THIN
  float cosine = 1;       // absolute
  float cosine2_high = 1, cosine2_low = 0;
  float sine2 = 0;
};

/// A pair of directions on two sides of a rough boundary (shared/rough_transmission.h): wi in the upper half
/// of the local frame, wo in the lower one.
struct TransmissionTerms {
  const float* index_less_one = nullptr;  // row of d = e - 1
  const float* index_factor = nullptr;    // row of e / (e^2 - 1)^2
  float sx = 0, sy = 0, sz = 0;           // wi + wo: the half vector is this + d wo, without cancellation
  float ox = 0, oy = 0, oz = -1;
  float cosine = -1, one_plus_cosine = 0;  // of wi and wo
  float inverse_alpha_u = 1, inverse_alpha_v = 1;
  float norm = 1;  // 2 (1 + 1 / cosine^2) / (pi alpha_u alpha_v)
  bool ggx = false;
};

/// What scenes with gas do to tau, L and the third register q; see KbPathVertex.
struct GasVertex {
  enum class Of : uint8_t { kMedium, kDeferredLight };  // the latter: q = emit_weight tau a emit
  Of of = Of::kMedium;
  uint32_t flags = 0;                         // KB_VERTEX_EMIT, _NEE, _SCATTER, _DEFER
  const float *a = nullptr, *emit = nullptr;  // dense rows
  float emit_weight = 0, nee0 = 0, scatter0 = 0;
  std::span<const KbPlumeCell>
      cells;                        // a plume's: the first has no column and the temperature of the near end
  float reference_k = 0;            // plume: where emit is Planck's law
  const float* second_k = nullptr;  // plume: row of hc / (k lambda), K
};

/// A path is a sum of terms  scalar * product of reflectances * emission.  Its scalars are multiplied once per
/// path, so that a channel has the product P, the light S in units of one emission row, and the radiance L:
enum class StepKind : uint32_t {
  kReflect,  // P *= row; S += weight P
  kAdd,      // S += weight P
  kLight,    // L += S row; S = 0
  kSample,   // L += weight P row light
  kScale,    // P *= weight
  kGas,      // tau = weight P; what the vertex does to tau, L and q; P = tau
  kKeepOne   // P = 0 but for one channel. S is 0
};

struct PathStep {
  StepKind kind;
  float weight;
  const float* row;
  union {
    const float* light;
    const GasVertex* gas;
    std::size_t survivor;
  };
};

/// Weights of derived channels by group of kRowPadding channels, and the accumulators of one path.
struct DerivedPlan {
  struct Entry {
    uint32_t derived;
    const float* weights;  // of the group's channels, kRowPadding floats
  };
  std::size_t count = 0;                  // derived channels
  const uint32_t* group_first = nullptr;  // entries of group g: group_first[g] .. group_first[g + 1]
  const Entry* entries = nullptr;
  float* accumulators = nullptr;  // count * kMaxLanes floats, aligned
};

struct PathProgram {
  const PathStep* steps = nullptr;
  std::size_t step_count = 0;
  const float* light = nullptr;  // emission row of S after the last step; null: S is 0
  std::size_t channels = 0;
  const DerivedPlan* derived = nullptr;  // null: none
  bool gas = false;                      // has vertices of gas
  /// Of derived channels in the film's row. What is before may be written: `channels`, or padded.
  std::size_t derived_offset = 0;
  const float* next_film = nullptr;  // row of the following path, to be fetched ahead; never read
};

/// A RegularTable, or its values as floats.
template <class Number>
struct TableView {
  const Number* values;
  std::size_t size;  // at least 2
  double min_nm, step_nm;
  bool extrapolate;
};
using FloatTable = TableView<float>;
using DoubleTable = TableView<double>;

/// The kernels of one instruction set.
struct EvaluatorKernels {
  /// Adds the path's channel values to film[0 .. channels) and its derived ones to film[derived_offset ..).
  void (*evaluate_path)(const PathProgram& path, float* film);
  /// out[i] = table(lambda_nm[i]) for i < count rounded up to the lanes of a vector; positions in double.
  void (*sample_table)(const FloatTable& table, const double* lambda_nm, std::size_t count, float* out);
  /// out[i] = table(lambda_nm[i]) * factor[i] (null: 1) for i < count rounded up to kMaxLanes, in double, with
  /// the bits of RegularTable.
  void (*sample_exact)(const DoubleTable& table, const double* lambda_nm, const double* factor,
                       std::size_t count, float* out);
  /// out[i] = table(lambda_nm[i]) for i < count rounded up to kMaxLanes, with the bits of RegularTable.
  void (*sample_double)(const DoubleTable& table, const double* lambda_nm, std::size_t count, double* out);
  /// out[i] = sum over r < rows of weights[r] * row[r][i], i < count.
  /// Nothing is read or written beyond count.
  void (*weighted_sum)(const float* const* row, const float* weights, std::size_t rows, std::size_t count,
                       float* out);
  /// out[i] = first[i] * values[index[i]] + second[i] * values[index[i] + 1],
  /// i < count rounded up to the lanes of a vector.
  void (*mix_bands)(const float* values, const int32_t* index, const float* first, const float* second,
                    std::size_t count, float* out);
  /// out[k] = a[k] F(terms) of channel k, begin <= k < end rounded up to the lanes of a vector.
  void (*fresnel_row)(const FresnelTerms& terms, const float* a, std::size_t begin, std::size_t end,
                      float* out);
  /// The same with T of a rough boundary.
  void (*transmission_row)(const TransmissionTerms& terms, const float* a, std::size_t begin, std::size_t end,
                           float* out);
  /// The same with a / (1 - a + a escape): what KB_KIND_NONLINEAR makes of S_b.
  void (*internal_row)(float escape, const float* a, std::size_t begin, std::size_t end, float* out);
  /// The same with B(w0, w1) of KB_KIND_TINTED.
  void (*tinted_row)(float w0, float w1, const float* a, std::size_t begin, std::size_t end, float* out);
  /// out[i] = terms(offsets.nm[i]), or the polynomial of its cell, for i < count rounded up to the lanes of a vector. All arrays begin at
  /// the same channel. out may be the terms' factor.
  void (*colour_row)(const ColourTerms& terms, const ColourOffsets& offsets, std::size_t count, float* out);
};

/// isa: resolved, not kAuto.
const EvaluatorKernels& evaluator_kernels(Isa isa);

}  // namespace kiloband::cpu
