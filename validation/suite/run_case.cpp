#include "validation/suite/run_case.hpp"

#include <algorithm>
#include <functional>
#include <map>
#include <optional>

#include "base/error.hpp"
#include "base/hash.hpp"

namespace kiloband::validation {
namespace {

/// A seed per attempt and side: sides must be independent of each other. FNV-1a of what it belongs to.
uint64_t seed_of(uint64_t run_seed, const std::string& case_name, const std::string& side, int attempt) {
  const uint64_t start = kFnvBasis<uint64_t> ^ run_seed * 0x9e3779b97f4a7c15u;
  const uint64_t hash = fnv1a(case_name + "\n" + side, start);
  return attempt == 0 ? hash : stats::repeat_seed(hash);
}

/// Degradation gives all of a path's weight to one channel of K: a pixel whose rare path was not met has
/// neither the right mean nor a warning, and the other estimator has met it
/// (as against a truth, stats/comparison/comparison.hpp).
bool has_fine_scales(const Pairing& pairing) {
  return pairing.a.rough_dispersion == pairing.b.rough_dispersion;
}

class CaseRun {
 public:
  CaseRun(const Case& c, const CaseSettings& settings, const Watch& watch)
      : case_(c), settings_(settings), watch_(watch), scene_(load(c.scene)) {
    result_.what = c;
    result_.channels = scene_->channels;
    result_.width = scene_->film.crop_width;
    result_.height = scene_->film.crop_height;
    result_.triangles = scene_->triangles.size();
    if (c.closed_form) truth_ = read_closed_form(c.scene.file, scene_->channels.size());
  }

  CaseResult run() {
    std::vector<Pairing> pairings = pairings_of(case_, settings_.backends, settings_.effort);
    for (Pairing& pairing : pairings) pairing.a.specialised = pairing.b.specialised = settings_.specialised;
    planned_ = pairings.size();
    result_.passed = true;
    for (const Pairing& pairing : pairings) {
      std::optional<PairingResult> result = run(pairing);
      result_.interrupted = !result;
      if (!result) break;
      result_.pairings.push_back(std::move(*result));
      result_.passed = result_.passed && result_.pairings.back().passed;
      ++done_;
    }
    return std::move(result_);
  }

 private:
  /// Equal seeds follow from equal names of the side: pairs of equal seed share one.
  /// `stopped`: not to be kept.
  const Rendering& side(const Configuration& configuration, const std::string& seed_name, int attempt) {
    const std::string key = configuration.label() + "\n" + seed_name + "\n" + std::to_string(attempt);
    if (const auto found = renderings_.find(key); found != renderings_.end()) return found->second;
    Sampling sampling;
    sampling.seed = seed_of(settings_.seed, case_.name, seed_name, attempt);
    sampling.replicates = settings_.replicates;
    sampling.samples = samples(attempt);
    Watch watch = watch_;
    watch.progress = [this](double fraction) { report(fraction); };
    Rendering rendering = render(scene_, configuration, sampling, watch);
    if (result_.images.empty() && !rendering.stopped)
      result_.images.push_back({configuration.label(), rendering.image});
    return renderings_.emplace(key, std::move(rendering)).first->second;
  }

  uint32_t samples(int attempt) const {
    const uint32_t first = case_.samples.at(settings_.effort);
    return attempt == 0 ? first : first * static_cast<uint32_t>(stats::kRepeatSamples);
  }

  void report(double fraction) const {
    if (watch_.progress)
      watch_.progress((static_cast<double>(done_) + 0.9 * fraction) / static_cast<double>(planned_));
  }

  /// Nothing where the run was stopped before the verdict.
  std::optional<PairingResult> run(const Pairing& pairing) {
    PairingResult result;
    result.pairing = pairing;
    for (stats::Stage stage = stats::Stage::kRepeat; stage == stats::Stage::kRepeat;) {
      if (watch_.stopped() || !attempt(pairing, result)) return std::nullopt;
      if (result.invalid_samples > 0 || result.comparison.non_finite > 0) break;
      stage = stats::next_stage(result.passed, result.attempts - 1);
    }
    if (!result.passed) keep_images(pairing, result.attempts - 1);
    return result;
  }

  /// False: it was stopped, and the result says nothing.
  bool attempt(const Pairing& pairing, PairingResult& result) {
    const int repetition = result.attempts++;
    const bool closed = pairing.kind == Pairing::Kind::kClosedForm,
               paired = pairing.kind == Pairing::Kind::kPaired;
    result.samples = samples(repetition);
    result.level =
        stats::case_level(repetition == 0 ? settings_.rule.first : settings_.rule.again, settings_.family);
    stats::ComparisonOptions options;
    options.alpha = result.level;
    options.variances = pairing.variances;
    options.fine_scales = !closed && has_fine_scales(pairing);
    options.seed = seed_of(settings_.seed, case_.name, "comparison", repetition);
    const Rendering& a = side(pairing.a, "first", repetition);
    if (a.stopped) return false;
    result.seconds_a = a.seconds;
    result.invalid_samples = a.invalid_samples;
    if (closed) {
      result.comparison = compare_truth(a.image, truth(), options);
    } else {
      const Rendering& b = side(pairing.b, paired ? "first" : second_name(pairing), repetition);
      if (b.stopped) return false;
      result.seconds_b = b.seconds;
      result.invalid_samples += b.invalid_samples;
      result.comparison =
          paired ? compare_paired(a.image, b.image, options) : compare_independent(a.image, b.image, options);
    }
    const bool black = std::ranges::all_of(result.comparison.image_a, [](double mean) { return mean == 0; });
    if (black) result.comparison.notes.emplace_back("black in every channel: nothing was compared");
    result.passed = result.comparison.passed && result.invalid_samples == 0 && !black;
    if (repetition == 0) result.first_p = result.comparison.decisive().p;
    return true;
  }

  static std::string second_name(const Pairing& pairing) { return "second " + pairing.b.label(); }

  stats::Truth truth() const {
    stats::Truth truth{truth_.values, {}, false};
    for (const double value : truth_.values) truth.bound.push_back(std::abs(value) * truth_.relative_bound);
    return truth;
  }

  /// A side is an image of its own for each of its seeds.
  void keep_images(const Pairing& pairing, int attempt) {
    const std::string times = attempt > 0 ? " repeated" : "";
    keep_image(pairing.a.label() + times + " (failed)", side(pairing.a, "first", attempt));
    if (pairing.kind == Pairing::Kind::kClosedForm) return;
    const bool paired = pairing.kind == Pairing::Kind::kPaired;
    keep_image(pairing.b.label() + (paired ? " equal seeds" : "") + times + " (failed)",
               side(pairing.b, paired ? "first" : second_name(pairing), attempt));
  }

  void keep_image(const std::string& label, const Rendering& rendering) {
    if (std::ranges::find(result_.images, label, &SideImage::label) == result_.images.end())
      result_.images.push_back({label, rendering.image});
  }

  const Case& case_;
  const CaseSettings& settings_;
  const Watch& watch_;
  std::shared_ptr<const FlatScene> scene_;
  ClosedForm truth_;
  CaseResult result_;
  std::size_t planned_ = 1, done_ = 0;
  std::map<std::string, Rendering> renderings_;
};

}  // namespace

CaseResult run_case(const Case& c, const CaseSettings& settings, const Watch& watch) {
  try {
    return CaseRun(c, settings, watch).run();
  } catch (const std::exception& error) {
    CaseResult result;
    result.what = c;
    result.error = error.what();
    return result;
  }
}

}  // namespace kiloband::validation
