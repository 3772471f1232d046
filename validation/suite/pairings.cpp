// Which configurations of a case are compared with which.
#include <algorithm>

#include "validation/suite/case.hpp"

namespace kiloband::validation {
namespace {

constexpr WavelengthMode kShared = WavelengthMode::kShared, kPerPath = WavelengthMode::kPerPath;
constexpr SamplerType kSobol = SamplerType::kSobol, kIndependent = SamplerType::kIndependent;

/// The modes of a backend beside its default.
std::vector<Configuration> modes(const std::string& backend, Effort effort) {
  if (effort == Effort::kQuick) return {{backend, kPerPath, kIndependent}};
  return {{backend, kPerPath, kSobol},
          {backend, kShared, kIndependent},
          {backend, kPerPath, kIndependent},
          {backend, kShared, kSobol, RoughDispersion::kDegrade}};
}

/// Against a closed form every way to render stands for itself.
std::vector<Pairing> closed_form_pairings(const std::vector<std::string>& backends, Effort effort) {
  std::vector<Pairing> pairings;
  for (const std::string& backend : backends) {
    pairings.push_back({Pairing::Kind::kClosedForm, {backend}, {}});
    const bool every_mode = effort == Effort::kThorough || backend == backends.front();
    if (!every_mode) continue;
    for (const Configuration& mode : modes(backend, effort))
      pairings.push_back({Pairing::Kind::kClosedForm, mode, {}});
  }
  return pairings;
}

}  // namespace

/// Everything is held against the first backend in its default mode (the CPU, if it takes part). Other
/// backends are the same estimator: their variances count too. Other modes have the same means only. Equal
/// seeds follow the same paths: their differences show biases far below the noise.
std::vector<Pairing> pairings_of(const Case& c, const std::vector<std::string>& backends, Effort effort) {
  if (c.closed_form) return closed_form_pairings(backends, effort);
  const Configuration reference{backends.front()};
  std::vector<Pairing> pairings;
  for (std::size_t i = 1; i < backends.size(); ++i) {
    pairings.push_back({Pairing::Kind::kIndependent, reference, {backends[i]}, true});
    if (i == 1 || effort != Effort::kQuick)
      pairings.push_back({Pairing::Kind::kPaired, reference, {backends[i]}});
  }
  for (const Configuration& mode : modes(reference.backend, effort))
    pairings.push_back({Pairing::Kind::kIndependent, reference, mode});
  if (effort == Effort::kQuick) return pairings;
  for (std::size_t i = 1; i < backends.size(); ++i) {
    if (effort != Effort::kThorough && i > 1) break;
    for (Configuration mode : modes(reference.backend, effort)) {
      Configuration other = mode;
      other.backend = backends[i];
      pairings.push_back({Pairing::Kind::kIndependent, mode, other, true});
    }
  }
  return pairings;
}

}  // namespace kiloband::validation
