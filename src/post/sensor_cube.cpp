#include "post/sensor_cube.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <set>

#include "cube/band_lists.hpp"
#include "cube/cube_layout.hpp"
#include "cube/cube_text.hpp"
#include "post/effective_band.hpp"
#include "spectral/colour/colour.hpp"

namespace kiloband {
namespace {

constexpr double kWorthAWarning = 1e-3;
/// Of a wavelength: what a response does at the very edge of a channel is its neighbour's.
constexpr double kEdge = 1e-13;

/// Index of the render's own band of that name.
std::optional<std::size_t> own_band(const std::vector<Band>& bands, const std::string& name) {
  for (std::size_t k = 0; k < bands.size(); ++k)
    if (bands[k].derived && bands[k].channel.name == name) return k;
  return std::nullopt;
}

class SensorCube : public CubeReader {
 public:
  SensorCube(std::unique_ptr<CubeReader> source, const std::vector<NamedResponse>& responses)
      : source_(std::move(source)), info_(source_->info()) {
    const std::vector<Band>& bands = source_->info().bands;
    const ChannelCover cover(channels_of(bands));
    info_.bands.clear();
    bool own = false;
    for (const auto& [name, response] : responses) {
      const auto band = own_band(bands, name);
      own = own || band;
      own_.push_back(band);
      weights_.push_back(band ? std::vector<double>{} : integral_weights(response, name, cover));
      Channel range = band ? bands[*band].channel : effective_band(response, cover);
      range.name = name;
      info_.bands.push_back({range, true});
    }
    info_.quantity = Quantity::kIntegral;
    info_.variance = info_.variance && own;
    info_.replicate_samples.clear();
    pick_band_lists(info_.metadata, bands.size(), {});
  }

  const CubeInfo& info() const override { return info_; }

  std::size_t floats_held() const override { return CubeReader::floats_held() + source_->floats_held(); }

  void read_rows(uint32_t y0, uint32_t rows, std::span<float> mean, std::span<float> variance) override {
    check_read(info_, y0, rows, mean.size(), info_.bands.size());
    const std::size_t from = source_->info().bands.size(), to = info_.bands.size();
    const std::size_t pixels = std::size_t{rows} * info_.width;
    mean_.resize(pixels * from);
    variance_.resize(variance.empty() ? 0 : mean_.size());
    source_->read_rows(y0, rows, mean_, variance_);
    for (std::size_t p = 0; p < pixels; ++p)
      for (std::size_t d = 0; d < to; ++d) {
        const float* values = mean_.data() + p * from;
        mean[p * to + d] = own_[d] ? values[*own_[d]] : weighted(weights_[d], values);
        if (variance.empty()) continue;
        variance[p * to + d] =
            own_[d] ? variance_[p * from + *own_[d]] : std::numeric_limits<float>::quiet_NaN();
      }
  }

  void read_aux(uint32_t y0, uint32_t rows, std::span<float> aux) override {
    source_->read_aux(y0, rows, aux);
  }

 private:
  /// Weights for values as they are on disk.
  std::vector<double> integral_weights(const Spectrum& response, const std::string& name,
                                       const ChannelCover& cover) const {
    const CubeInfo& info = source_->info();
    if (cover.covered_nm().empty())
      throw InputError(
          "response '" + name +
          "': no band of the cube has wavelengths: give them with kiloband convert --wavelengths");
    std::vector<double> weight = sensor_weights(response, info.bands, cover).weight;
    if (std::all_of(weight.begin(), weight.end(), [](double w) { return w == 0; }))
      throw InputError("response '" + name + "': is 0 in all channels of the cube");
    for (std::size_t k = 0; k < weight.size(); ++k)
      if (info.quantity == Quantity::kDensity) weight[k] *= info.bands[k].channel.width_nm();
    return weight;
  }

  /// Channels of weight 0 do not count, whatever they hold.
  static float weighted(const std::vector<double>& weights, const float* values) {
    double sum = 0;
    for (std::size_t k = 0; k < weights.size(); ++k)
      if (weights[k] != 0) sum += weights[k] * values[k];
    return static_cast<float>(sum);
  }

  std::unique_ptr<CubeReader> source_;
  CubeInfo info_;
  std::vector<std::optional<std::size_t>> own_;  // by response
  std::vector<std::vector<double>> weights_;     // by response, then band
  std::vector<float> mean_, variance_;
};

/// Sums of the channels' integrals over all pixels that have samples.
std::vector<double> image_integrals(CubeReader& cube) {
  const CubeInfo& info = cube.info();
  std::vector<double> sums(info.bands.size(), 0);
  std::vector<float> row(std::size_t{info.width} * sums.size());
  for (uint32_t y = 0; y < info.height; ++y) {
    cube.read_rows(y, 1, row, {});
    for (std::size_t i = 0; i < row.size(); ++i)
      if (!std::isnan(row[i])) sums[i % sums.size()] += row[i];
  }
  for (std::size_t k = 0; k < sums.size(); ++k)
    if (info.quantity == Quantity::kDensity && !info.bands[k].derived)
      sums[k] *= info.bands[k].channel.width_nm();
  return sums;
}

std::string percent(double fraction) {
  return format_short(std::round(fraction * 1e4) / 100) + " %";
}

}  // namespace

std::vector<NamedResponse> xyz_responses() {
  constexpr double kLumensPerWatt = 683.002;  // CIE 018:2019: 683 lm/W at 555.016 nm of the maximum of V
  return {{"X", cie_x().scaled(kLumensPerWatt)},
          {"Y", cie_y().scaled(kLumensPerWatt)},
          {"Z", cie_z().scaled(kLumensPerWatt)}};
}

double uncovered_part(const Spectrum& response, const ChannelCover& cover) {
  const auto& pieces = cover.covered_nm();
  const auto range = response.data_range();
  const double from = range ? range->min_nm : pieces.front().first;
  const double to = range ? range->max_nm : pieces.back().second;
  const double total = absolute_integral(response, from, to);
  if (!(total > 0)) return 0;
  double covered = 0;
  for (const auto& [a, b] : pieces)
    if (a < to && b > from) covered += absolute_integral(response, std::max(a, from), std::min(b, to));
  return 1 - covered / total;
}

SensorWeights sensor_weights(const Spectrum& response, const std::vector<Band>& bands,
                             const ChannelCover& cover) {
  SensorWeights result{std::vector<double>(bands.size(), 0), std::vector<double>(bands.size(), 0)};
  for (std::size_t k = 0; k < bands.size(); ++k) {
    if (bands[k].derived) continue;
    const Channel& c = bands[k].channel;
    double integral = 0, lowest = std::numeric_limits<double>::infinity(), highest = -lowest;
    cover.for_shares(c, [&](double a, double b, double share) {
      integral += response.integral(a, b) * share;
      const double from = a * (1 + kEdge), to = b * (1 - kEdge);
      if (!(from < to)) return;
      lowest = std::min(lowest, response.min_over(from, to) * share);
      highest = std::max(highest, response.max_over(from, to) * share);
    });
    const double weight = integral / c.width_nm();
    result.weight[k] = weight;
    result.deviation[k] = std::max({weight - lowest, highest - weight, 0.0});
  }
  return result;
}

std::unique_ptr<CubeReader> apply_responses(std::unique_ptr<CubeReader> cube,
                                            const std::vector<NamedResponse>& responses) {
  std::set<std::string> names;
  for (const auto& [name, response] : responses)
    if (!names.insert(name).second) throw InputError("response '" + name + "' is given twice");
  return std::make_unique<SensorCube>(std::move(cube), responses);
}

void report_responses(CubeReader& cube, const std::vector<NamedResponse>& responses,
                      const DiagnosticSink& sink) {
  if (responses.empty()) return;  // there are the bands that the render accumulated
  const std::vector<Band>& bands = cube.info().bands;
  const ChannelCover cover(channels_of(bands));
  const std::vector<double> integrals = image_integrals(cube);
  for (const auto& [name, response] : responses) {
    if (own_band(bands, name)) {
      note(sink, {}, "response '" + name + "': the band that the render accumulated is taken");
      continue;
    }
    if (cover.covered_nm().empty()) continue;  // apply_responses() refuses it
    const double missing = uncovered_part(response, cover);
    if (missing > kWorthAWarning)
      warn(sink, {},
           "response '" + name + "': " + percent(missing) + " of its integral lies outside the channels");
    const SensorWeights weights = sensor_weights(response, bands, cover);
    double sum = 0, bound = 0;
    for (std::size_t k = 0; k < bands.size(); ++k) {
      sum += weights.weight[k] * integrals[k];
      bound += weights.deviation[k] * integrals[k];
    }
    if (bound > kWorthAWarning * std::abs(sum))
      warn(sink, {},
           "response '" + name + "': changes inside channels; the image's mean can be off by " +
               percent(bound / std::abs(sum)) + " (give it before the render, or finer channels)");
  }
}

}  // namespace kiloband
