#include "tests/support/render_harness.hpp"

#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <numeric>

#include "scene/read/reader.hpp"
#include "validation/suite/rendering.hpp"

namespace kiloband::test {
namespace {

DerivedChannels derived_of(const RenderSpec& spec, const ChannelList& channels) {
  DerivedChannels derived;
  const Channel range = hull(channels);
  for (const auto& [name, response] : spec.responses) {
    derived.names.push_back(name);
    derived.responses.push_back(resample(response, range.min_nm, range.max_nm));
  }
  return derived;
}

void append(const ReplicateMoments& moments, std::size_t unit, const std::vector<double>& scale,
            std::vector<double>& mean, std::vector<double>& variance) {
  std::vector<float> v(moments.channels());
  moments.variance_of_mean(unit, v);
  for (std::size_t c = 0; c < moments.channels(); ++c) {
    mean.push_back(moments.mean(unit)[c] * scale[c]);
    variance.push_back(double{v[c]} * scale[c] * scale[c]);
  }
}

void collect(const SpectralFilm& film, const std::vector<double>& scale, RenderResult& result) {
  const std::size_t row_size = std::size_t{result.width} * result.channels;
  std::vector<float> mean(row_size), variance(row_size);
  for (uint32_t y = 0; y < result.height; ++y) {
    film.row(y, mean, variance);
    for (std::size_t i = 0; i < row_size; ++i) {
      const double s = scale[i % result.channels];
      result.mean.push_back(mean[i] * s);
      result.variance.push_back(double{variance[i]} * s * s);
    }
  }
  append(film.image_moments(), 0, scale, result.image_mean, result.image_variance);
}

/// From the replicates that a film holds.
void collect_tiles(const SpectralFilm& film, const std::vector<double>& scale, RenderResult& result) {
  const std::size_t across = (result.width + kTileSize - 1) / kTileSize, pixels = film.rect().pixels();
  const std::size_t tiles = across * ((result.height + kTileSize - 1) / kTileSize),
                    channels = result.channels;
  ReplicateMoments moments(tiles, channels, true);
  std::vector<float> mean(channels);
  for (uint32_t r = 0; r < result.replicates; ++r) {
    std::vector<double> sums(tiles * channels);
    std::vector<uint64_t> counts(tiles);
    for (std::size_t p = 0; p < pixels; ++p) {
      const std::size_t tile = p / result.width / kTileSize * across + p % result.width / kTileSize;
      const uint64_t samples = film.replicate_samples(r, p);
      film.replicate_mean(r, p, mean);
      for (std::size_t c = 0; c < channels; ++c)
        sums[tile * channels + c] += static_cast<double>(samples) * mean[c];
      counts[tile] += samples;
    }
    for (std::size_t tile = 0; tile < tiles; ++tile) {
      for (std::size_t c = 0; c < channels; ++c)
        mean[c] = static_cast<float>(sums[tile * channels + c] / static_cast<double>(counts[tile]));
      if (counts[tile] > 0) moments.add(tile, counts[tile], mean);
    }
  }
  for (std::size_t tile = 0; tile < tiles; ++tile) {
    if (moments.samples(tile) > 0) append(moments, tile, scale, result.tile_mean, result.tile_variance);
  }
}

/// Once in a test's output: ctest's twins of a program for another backend fail where it is not theirs (cmake/compiler.cmake).
void say_which(const std::string& backend) {
  static const bool said = [&] {
    std::printf("rendered by %s\n", backend.c_str());
    return std::fflush(stdout) == 0;
  }();
  static_cast<void>(said);
}

}  // namespace

std::string test_backend_name() {
  const char* name = std::getenv("KILOBAND_TEST_BACKEND");
  return name && *name ? name : "cpu";
}

PreparedRender::PreparedRender(RenderSpec spec) : spec_(std::move(spec)) {
  const DiagnosticSink sink = [&](const Diagnostic& d) { diagnostics_.push_back(d.to_string()); };
  ReadOptions read;
  read.sink = sink;
  const SceneDescription description = read_scene_text(spec_.xml, "test.xml", spec_.directory, read);
  const ChannelList channels = parse_channels(spec_.bands);
  const ChannelList guide = spec_.guide.empty() ? channels : parse_channels(spec_.guide);
  scene_ = compile_scene_to_move(description, {channels, guide, sink});
  derived_ = derived_of(spec_, channels);
}

void PreparedRender::look_as(const std::string& xml) {
  move_camera(*scene_, read_scene_text(xml, "test.xml", spec_.directory, {}).sensor);
}

RenderResult PreparedRender::render(SamplingSettings sampling) const {
  RenderResult result;
  result.diagnostics = diagnostics_;
  result.scene = *scene_;
  const ReplicatePlan plan = ReplicatePlan::deal(spec_.spp, sampling.replicates);
  sampling.replicates = result.replicates = plan.replicates;
  // One OpenCL program for all tests; tests/statistical/backends compares it with the others.
  BackendRequest request;
  request.backend = test_backend_name();
  say_which(request.backend);
  request.isa = spec_.isa;
  request.threads = spec_.threads;
  request.specialised = false;
  const auto backend = validation::backends().make(request, {scene_, derived_, sampling});

  const PixelRect rect = validation::film_rect(result.scene);
  result.width = rect.width;
  result.height = rect.height;
  result.channels = scene_->channels.size() + derived_.names.size();
  SpectralFilm film(rect, {result.channels, plan.replicates, true, spec_.held});
  std::vector<uint32_t> blocks(film.blocks().size());
  std::iota(blocks.begin(), blocks.end(), 0u);
  const std::atomic<bool> stop{false};
  for (uint32_t r = 0; r < plan.replicates; ++r) {
    backend->render(film, {r, 0, static_cast<uint32_t>(plan.size(r))}, blocks, stop, {});
  }
  collect(film, backend->film_scale(), result);
  if (spec_.held) collect_tiles(film, backend->film_scale(), result);
  const BackendStatistics done = backend->statistics();
  result.invalid_samples = done.invalid_samples;
  result.vertices = done.vertices;
  result.paths = done.paths;
  return result;
}

RenderResult render(const RenderSpec& spec) {
  return PreparedRender(spec).render();
}

double z_score(double value, double expected, double variance) {
  if (variance > 0) return std::abs(value - expected) / std::sqrt(variance);
  return std::abs(value - expected) <= 1e-5 * std::abs(expected) ? 0
                                                                 : std::numeric_limits<double>::infinity();
}

double critical_t(double alpha, std::size_t tests, uint32_t replicates) {
  const double one = 1 - std::pow(1 - alpha, 1.0 / static_cast<double>(tests));
  return boost::math::quantile(boost::math::complement(boost::math::students_t(replicates - 1.0), one / 2));
}

}  // namespace kiloband::test
