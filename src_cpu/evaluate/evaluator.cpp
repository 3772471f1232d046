#include "src_cpu/evaluate/evaluator.hpp"

#include <stdexcept>

#include "src_cpu/evaluate/derived_rows.hpp"
#include "src_cpu/evaluate/evaluator_program.hpp"

namespace kiloband::cpu {

namespace {

/// So many paths ahead texels are asked for: what is in flight fits into the first cache.
constexpr std::size_t kFetchAhead = 6;

/// Few channels leave half of the widest vectors empty: narrower ones do the same operations on each channel.
const EvaluatorKernels& kernels_for_channels(Isa isa, std::size_t channels) {
  const bool narrow = isa == Isa::kAvx512 && channels <= kMaxLanes / 2 && is_available(Isa::kAvx2);
  return evaluator_kernels(narrow ? Isa::kAvx2 : isa);
}

}  // namespace

struct Evaluator::Impl {
  Impl(const FlatScene& scene, const DerivedChannels& derived_channels, Isa isa)
      : derived(derived_channels),
        kernels(evaluator_kernels(resolve_isa(isa))),
        path_kernels(kernels_for_channels(resolve_isa(isa), scene.channels.size())),
        has_textures(!scene.textures.empty()),
        derived_offset(pad_channels(scene.channels.size())),
        spectra(scene, kernels),
        derived_rows(scene, derived, kernels),
        builder(scene, kernels, path_kernels) {
    const std::size_t groups = (derived_offset + pad_channels(derived_rows.count())) / kRowPadding;
    stride = (groups | 1) * kRowPadding;
  }

  static float* row_of(const SavedPath& path, const SumRows& rows) {
    if (path.pixel >= rows.pixels.size()) throw std::logic_error("saved path: pixel beyond the sums");
    return rows.pixels[path.pixel];
  }

  std::span<const KbPathVertex> entries_of(const PathBuffer& paths, std::size_t p) const {
    const SavedPath& path = paths.paths[p];
    if (std::size_t{path.first} + path.count > paths.entries.size())
      throw std::logic_error("saved path: entries beyond the buffer");
    return std::span(paths.entries).subspan(path.first, path.count);
  }

  /// One path at the offset of `spectra`, all channels: with blocks of channels as the outer loop over
  /// resolved paths, 0.084 instead of 0.066 ns per channel and vertex were measured
  /// (AVX-512, K = 512, 1024 pixels). Nor do tiles earn it in which the rows of many textures and metals fit into the
  /// first cache: 128 to 512 channels for 16 to 64 paths at a time, rows of vertices made by tile too, took 1.02 to
  /// 1.11 times as long (metals_and_lamps, K = 512 and 1024).
  void add(const PathBuffer& paths, std::size_t p, const SumRows& rows) {
    const std::span<const KbPathVertex> entries = entries_of(paths, p);
    if (entries.empty()) return;
    if (has_textures && p + kFetchAhead < paths.paths.size())
      builder.fetch_texels(entries_of(paths, p + kFetchAhead));
    PathProgram program = builder.build(entries, spectra);
    program.derived = derived_rows.plan(spectra);
    program.derived_offset = rows.packed ? program.channels : derived_offset;
    if (p + 1 < paths.paths.size()) program.next_film = row_of(paths.paths[p + 1], rows);
    path_kernels.evaluate_path(program, row_of(paths.paths[p], rows));
  }

  const DerivedChannels derived;
  const EvaluatorKernels &kernels, &path_kernels;
  const bool has_textures;
  std::size_t derived_offset, stride = 0;
  DenseSpectra spectra;
  DerivedRows derived_rows;
  ProgramBuilder builder;
};

Evaluator::Evaluator(const FlatScene& scene, const DerivedChannels& derived, Isa isa)
    : impl_(std::make_unique<Impl>(scene, derived, isa)) {}
Evaluator::~Evaluator() = default;
Evaluator::Evaluator(Evaluator&&) noexcept = default;

std::size_t Evaluator::stride() const {
  return impl_->stride;
}
std::size_t Evaluator::derived_offset() const {
  return impl_->derived_offset;
}
double Evaluator::derived_scale(std::size_t d) const {
  return impl_->derived_rows.scale(d);
}

void Evaluator::add_shared(const PathBuffer& paths, double mu, const SumRows& rows) {
  // Rows of the same offset are kept from call to call.
  if (impl_->spectra.fast() || impl_->spectra.mu() != mu) impl_->spectra.begin(mu, false);
  for (std::size_t p = 0; p < paths.paths.size(); ++p) impl_->add(paths, p, rows);
}

void Evaluator::add_per_path(const PathBuffer& paths, std::span<const float> mu, const SumRows& rows) {
  if (mu.size() != paths.paths.size()) throw std::logic_error("add_per_path: one offset per path is needed");
  for (std::size_t p = 0; p < paths.paths.size(); ++p) {
    impl_->spectra.begin(mu[p], true);
    impl_->add(paths, p, rows);
  }
}

}  // namespace kiloband::cpu
