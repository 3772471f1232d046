// The two sides of `kiloband compare`: cubes of any origin, with what they say about their errors.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/diagnostics.hpp"
#include "cube/cube_io.hpp"
#include "stats/comparison/moment_comparison.hpp"

namespace kiloband {

/// Where a side's errors come from.
enum class ErrorSource {
  kRenders,     // several independent renders
  kReplicates,  // the replicates beside a cube
  kVariance,    // variances in the cube or beside it
  kExact        // none: the cube is the truth
};

struct SideOptions {
  std::string name;                     // "A" or "B"
  std::string files;                    // FILE or FILE,FILE,...
  std::optional<std::string> variance;  // a cube of variances of the mean
  std::optional<double> dof;            // of variances
  bool exact = false;
};

/// The files of SideOptions::files. A file whose name has a comma is one file.
std::vector<std::string> split_files(const std::string& text);

/// Opens a side and hands out strips of it, all values in one quantity.
class CompareSide {
 public:
  /// throws InputError  files that cannot be read or do not belong together; no errors to test with
  CompareSide(const SideOptions& options, const DiagnosticSink& sink);

  const CubeInfo& info() const { return cubes_.front()->info(); }
  ErrorSource source() const { return source_; }
  bool has_replicates() const {
    return source_ == ErrorSource::kRenders || source_ == ErrorSource::kReplicates;
  }
  uint32_t replicates() const { return has_replicates() ? static_cast<uint32_t>(cubes_.size()) : 0; }
  /// Whether the cubes say how many samples each replicate (or render) has in every pixel. An interrupted
  /// render says how many samples a pixel has at least, not how they are dealt to replicates.
  bool states_samples() const;
  /// "room.hdr, 16 replicates"
  std::string describe() const;

  /// Samples are 0 in pixels without any values, and where a replicate and all after it have none: the render
  /// was interrupted. NaN anywhere else counts as samples that are not finite: kiloband leaves invalid
  /// samples out of a mean, and several renders are complete ones. A truth is one replicate.
  stats::ReplicateImage read_replicates(uint32_t y0, uint32_t rows, Quantity quantity) const;
  /// Of one cube.
  stats::MomentImage read_moments(uint32_t y0, uint32_t rows, Quantity quantity) const;

 private:
  void open_renders(const std::vector<std::string>& files, const DiagnosticSink& sink);
  void open_single(const SideOptions& options, const DiagnosticSink& sink);
  void open_variance(const SideOptions& options, const DiagnosticSink& sink);
  std::vector<float> read_mean(CubeReader& cube, uint32_t y0, uint32_t rows, Quantity quantity) const;

  std::string name_, files_;
  ErrorSource source_ = ErrorSource::kVariance;
  std::vector<std::unique_ptr<CubeReader>> cubes_;  // replicates, renders, or one cube
  std::unique_ptr<CubeReader> variance_;            // a cube of its own, or none: the cube's planes
  std::vector<uint64_t> samples_;                   // of each of cubes_; 1 where unknown
  bool samples_known_ = false;
  double dof_ = 0;
};

/// throws InputError  other sizes or channels: says which
void check_same_shape(const std::string& name_a, const CubeInfo& a, const std::string& name_b,
                      const CubeInfo& b);

}  // namespace kiloband
