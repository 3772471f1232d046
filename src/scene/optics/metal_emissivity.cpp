#include "scene/optics/metal_emissivity.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "base/deal_ranges.hpp"

namespace kiloband {
namespace {

constexpr std::size_t kMostWavelengths = 4096;
constexpr std::size_t kProbes = 24;
constexpr int kCells = 512;  // of the table of facet cosines

/// The error that interpolation may have.
double allowed(double emissivity) {
  return std::min(1e-4, std::max(1e-3 * emissivity, 1e-6));
}

double cell_cosine(int i) {
  const double t = static_cast<double>(i) / kCells;
  return t * t;
}

/// Largest error of a metal's absorptance between neighbours of `count` + 1 regular wavelengths,
/// in allowed errors.
double tabulation_error(const MetalSpectra& s, const Channel& range, std::size_t count) {
  const auto lambda = [&](double i) {
    return range.min_nm + i / static_cast<double>(count) * range.width_nm();
  };
  double worst = 0;
  for (std::size_t i = 0; i < count; ++i) {
    for (const double cosine : {1.0, 0.2, 0.03}) {
      const auto value = [&](double at) {
        const double x = lambda(static_cast<double>(i) + at);
        const double tint = s.tint(x);
        return 1 - tint + tint * metal_absorptance(cosine, s.n(x), s.k(x));
      };
      const double low = value(0), high = value(1);
      for (const double t : {0.25, 0.5, 0.75}) {
        const double exact = value(t);
        worst = std::max(worst, std::abs((1 - t) * low + t * high - exact) / (0.1 * allowed(exact)));
      }
    }
  }
  return worst;
}

/// Numbers of wavelengths: the fewest powers of two whose tables are good for a tenth
/// of what directions may be off by.
std::size_t count_cells(const MetalSpectra& spectra, const Channel& range) {
  std::size_t cells = 1;
  while (cells < kMostWavelengths && tabulation_error(spectra, range, cells) > 1) cells *= 2;
  return cells;
}

std::size_t place_of(const std::vector<double>& values, bool largest) {
  const auto found = largest ? std::ranges::max_element(values) : std::ranges::min_element(values);
  return static_cast<std::size_t>(found - values.begin());
}

}  // namespace

/// For one direction: how much of the lobe meets facets at which cosine, E included.
class MetalEmissivity::Directions {
 public:
  explicit Directions(const std::optional<Facets>& facets) : facets_(facets) {}

  bool rough() const { return facets_.has_value(); }
  bool anisotropic() const { return facets_ && facets_->alpha_u != facets_->alpha_v; }

  /// Computes the weights of directions that are not known, on all threads: some milliseconds each. Refinement asks for the same ones again
  /// and again: all are kept.
  void prepare(const std::vector<double>& cosines, const std::vector<double>& places) {
    std::vector<std::pair<std::pair<double, double>, std::vector<double>*>> missing;
    for (const double s : places)
      for (const double cosine : cosines) {
        const auto [place, is_new] = known_.try_emplace({cosine, s});
        if (is_new) missing.emplace_back(place->first, &place->second);
      }
    deal_items(missing.size(), [&](std::size_t i) {
      *missing[i].second = integrate(missing[i].first.first, missing[i].first.second);
    });
  }

  /// Weights of the cell cosines, of a direction that was prepared; their sum is E.
  const std::vector<double>& weights(double cosine, double s) const { return known_.at({cosine, s}); }

  static std::vector<double> absorptances(double n, double k) {
    std::vector<double> a;
    for (int i = 0; i <= kCells; ++i) a.push_back(metal_absorptance(cell_cosine(i), n, k));
    return a;
  }

  /// The formula of the header. albedo: E; absorbed: a; normal: A0
  static double emissivity(double albedo, double absorbed, double normal) {
    const double mean = absorbed / albedo;
    return mean + normal * (1 - albedo) * (1 - mean);
  }

  static double emissivity(const std::vector<double>& weights, const std::vector<double>& absorptances) {
    double albedo = 0, absorbed = 0;
    for (int i = 0; i <= kCells; ++i) albedo += weights[i], absorbed += weights[i] * absorptances[i];
    return emissivity(albedo, absorbed, absorptances[kCells]);
  }

 private:
  /// Linear deposition: the absorptance is smooth over a cell.
  std::vector<double> integrate(double cosine, double s) const {
    glm::dvec2 azimuth(std::sqrt((1 - s) / facets_->alpha_u), std::sqrt(s / facets_->alpha_v));
    azimuth = glm::normalize(azimuth);
    const double sine = std::sqrt((1 - cosine) * (1 + cosine));
    const glm::dvec3 v(sine * azimuth.x, sine * azimuth.y, cosine);
    std::vector<double> weights(kCells + 1, 0.0);
    for (const VisibleFacet& f : visible_facets(*facets_, v)) {
      const double c = std::clamp(glm::dot(v, f.normal), 0.0, 1.0);
      const double weight = f.weight * facets_->masking(2 * c * f.normal - v);
      const int i = std::min(static_cast<int>(std::sqrt(c) * kCells), kCells - 1);
      const double t = (c - cell_cosine(i)) / (cell_cosine(i + 1) - cell_cosine(i));
      weights[i] += (1 - t) * weight;
      weights[i + 1] += t * weight;
    }
    return weights;
  }

  std::optional<Facets> facets_;
  std::map<std::pair<double, double>, std::vector<double>> known_;  // weights by cosine and s
};

MetalEmissivity::MetalEmissivity(const MetalSpectra& spectra, const std::optional<Facets>& facets,
                                 const Channel& range)
    : directions_(std::make_unique<Directions>(facets)) {
  const std::size_t cells = count_cells(spectra, range);
  for (std::size_t i = 0; i <= cells; ++i) {
    const double t = static_cast<double>(i) / static_cast<double>(cells);
    lambda_nm_.push_back((1 - t) * range.min_nm + t * range.max_nm);
    n_.push_back(spectra.n(lambda_nm_.back()));
    k_.push_back(spectra.k(lambda_nm_.back()));
    tint_.push_back(spectra.tint(lambda_nm_.back()));
  }
  for (std::size_t i = 0; i < kProbes; ++i) probes_.push_back(i * cells / (kProbes - 1));
  for (const bool largest : {false, true})
    for (const auto* values : {&n_, &k_}) probes_.push_back(place_of(*values, largest));
  std::ranges::sort(probes_);
  probes_.erase(std::unique(probes_.begin(), probes_.end()), probes_.end());
  if (directions_->rough())
    for (const std::size_t i : probes_) absorptances_.push_back(Directions::absorptances(n_[i], k_[i]));

  choose_nodes_s();
  cosines_ = {0};
  const double starts[] = {0, 0.01, 0.1, 0.4, 1};
  for (int i = 0; i < 4; ++i) {
    refine(starts[i], starts[i + 1], 0);
    cosines_.push_back(starts[i + 1]);
  }
}

MetalEmissivity::~MetalEmissivity() = default;

/// The emissivities at the probes.
std::vector<double> MetalEmissivity::at(double cosine, double s) const {
  std::vector<double> values;
  if (!directions_->rough()) {
    for (const std::size_t i : probes_)
      values.push_back(1 - tint_[i] + tint_[i] * metal_absorptance(cosine, n_[i], k_[i]));
    return values;
  }
  const std::vector<double>& weights = directions_->weights(cosine, s);
  for (std::size_t p = 0; p < probes_.size(); ++p) {
    const double tint = tint_[probes_[p]];
    values.push_back(1 - tint + tint * Directions::emissivity(weights, absorptances_[p]));
  }
  return values;
}

/// Adds nodes between two cosines until the line between neighbours is good enough.
/// Returns whether any was needed.
bool MetalEmissivity::refine(double from, double to, int depth) {
  constexpr int kDeepest = 12;
  constexpr double kSmallest = 1e-3;  // no node for the sake of directions closer to grazing
  if (depth >= kDeepest || to <= kSmallest) return false;
  bool good = true;
  const double middle = 0.5 * (from + to), quarters[] = {0.5 * (from + middle), middle, 0.5 * (middle + to)};
  const std::vector<double> places =
      directions_->anisotropic() ? std::vector<double>{0.0, 0.5, 1.0} : std::vector<double>{0.0};
  if (directions_->rough()) directions_->prepare({from, quarters[0], quarters[1], quarters[2], to}, places);
  for (const double s : places) {
    const std::vector<double> low = at(from, s), high = at(to, s);
    for (int quarter = 1; quarter <= 3; ++quarter) {
      const double t = 0.25 * quarter;
      const std::vector<double> exact = at(quarters[quarter - 1], s);
      for (std::size_t i = 0; i < exact.size(); ++i)
        good = good && std::abs((1 - t) * low[i] + t * high[i] - exact[i]) <= allowed(exact[i]);
    }
  }
  if (good) return false;
  refine(from, middle, depth + 1);
  cosines_.push_back(middle);
  refine(middle, to, depth + 1);
  return true;
}

void MetalEmissivity::choose_nodes_s() {
  if (!directions_->anisotropic()) return;
  constexpr uint32_t kMost = 17;
  for (nodes_s_ = 3; nodes_s_ < kMost; nodes_s_ = 2 * nodes_s_ - 1) {
    bool good = true;
    const double step = 1.0 / (nodes_s_ - 1);
    const std::vector<double> cosines{0.05, 0.1, 0.25, 0.5, 0.8};
    std::vector<double> places;
    for (uint32_t j = 0; j + 1 < nodes_s_; ++j) places.insert(places.end(), {j * step, (j + 0.5) * step});
    places.push_back((nodes_s_ - 1) * step);
    directions_->prepare(cosines, places);
    for (const double cosine : cosines) {
      for (uint32_t j = 0; j + 1 < nodes_s_; ++j) {
        const std::vector<double> low = at(cosine, j * step), high = at(cosine, (j + 1) * step);
        const std::vector<double> exact = at(cosine, (j + 0.5) * step);
        for (std::size_t i = 0; i < exact.size(); ++i)
          good = good && std::abs(0.5 * (low[i] + high[i]) - exact[i]) <= allowed(exact[i]);
      }
    }
    if (good) return;
  }
}

RegularTable MetalEmissivity::tabulate(const std::vector<double>& values) const {
  RegularTable table;
  table.min_nm = lambda_nm_.front();
  table.step_nm = (lambda_nm_.back() - lambda_nm_.front()) / static_cast<double>(lambda_nm_.size() - 1);
  table.values = values;
  table.extrapolate = true;
  return table;
}

/// By s, then cosine.
std::vector<const std::vector<double>*> MetalEmissivity::weights_of_rows() const {
  std::vector<const std::vector<double>*> weights;
  std::vector<double> places;
  for (uint32_t j = 0; j < nodes_s_; ++j)
    places.push_back(nodes_s_ > 1 ? static_cast<double>(j) / (nodes_s_ - 1) : 0);
  directions_->prepare(cosines_, places);
  for (const double s : places) {
    for (const double cosine : cosines_) weights.push_back(&directions_->weights(cosine, s));
  }
  return weights;
}

/// Of a rough metal, by direction, then wavelength. Directions go abreast through the sums over facets, each sum in the order of the cells.
std::vector<std::vector<double>> MetalEmissivity::rough_rows() const {
  constexpr std::size_t kAbreast = 64;
  const std::vector<const std::vector<double>*> weights = weights_of_rows();
  const std::size_t wavelengths = lambda_nm_.size();
  std::vector<std::vector<double>> absorptances(wavelengths), values;
  for (std::size_t i = 0; i < wavelengths; ++i) absorptances[i] = Directions::absorptances(n_[i], k_[i]);
  std::vector<std::array<double, kAbreast>> cells(kCells + 1);
  for (std::size_t first = 0; first < weights.size(); first += kAbreast) {
    const std::size_t count = std::min(kAbreast, weights.size() - first);
    std::array<double, kAbreast> albedos{};
    for (std::size_t c = 0; c < cells.size(); ++c)
      for (std::size_t j = 0; j < count; ++j) albedos[j] += cells[c][j] = (*weights[first + j])[c];
    values.resize(first + count, std::vector<double>(wavelengths));
    deal_items(wavelengths, [&](std::size_t i) {
      std::array<double, kAbreast> absorbed{};
      for (std::size_t c = 0; c < cells.size(); ++c)
        for (std::size_t j = 0; j < kAbreast; ++j) absorbed[j] += cells[c][j] * absorptances[i][c];
      for (std::size_t j = 0; j < count; ++j)
        values[first + j][i] = Directions::emissivity(albedos[j], absorbed[j], absorptances[i][kCells]);
    });
  }
  return values;
}

std::vector<std::vector<double>> MetalEmissivity::smooth_rows() const {
  std::vector<std::vector<double>> values;
  for (const double cosine : cosines_) {
    std::vector<double>& row = values.emplace_back();
    for (std::size_t i = 0; i < lambda_nm_.size(); ++i)
      row.push_back(metal_absorptance(cosine, n_[i], k_[i]));
  }
  return values;
}

std::vector<RegularTable> MetalEmissivity::rows() const {
  std::vector<std::vector<double>> values = directions_->rough() ? rough_rows() : smooth_rows();
  for (auto& row : values)
    for (std::size_t i = 0; i < row.size(); ++i) row[i] = 1 - tint_[i] + tint_[i] * row[i];
  std::vector<RegularTable> tables;
  for (const auto& v : values) tables.push_back(tabulate(v));
  return tables;
}

RegularTable MetalEmissivity::normal_reflectance() const {
  std::vector<double> values;
  for (std::size_t i = 0; i < lambda_nm_.size(); ++i)
    values.push_back(tint_[i] * (1 - metal_absorptance(1, n_[i], k_[i])));
  return tabulate(values);
}

}  // namespace kiloband
