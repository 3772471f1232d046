#include "viewer/live/live_state.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <thread>
#include <utility>

#include "render/error_sums.hpp"
#include "render/scene_metadata.hpp"
#include "viewer/api/json_text.hpp"
#include "viewer/live/camera_view.hpp"

namespace kiloband::viewer {
namespace {

constexpr double kPieceSeconds = 0.15;   // of rendering between two looks at what pages ask for
constexpr double kMovingSeconds = 0.03;  // of a pass while the camera is moved
constexpr uint32_t kMostReduction = 8;   // of width and height
constexpr double kMovingPause = 1;  // s without a step, after which a movement has ended whatever pages say
constexpr std::chrono::milliseconds kRest{10};  // between two looks at whether it has
constexpr double kErrorInterval = 2;            // s
constexpr uint32_t kErrorRows = 8;              // the error is estimated from every 8th row
constexpr std::size_t kMostChannels = 4096;     // that a page can draw
constexpr std::size_t kFirstBlocks = 64;        // of a film of which nothing is known yet

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace

LiveState::LiveState(LiveOptions options, const std::atomic<bool>& interrupt)
    : options_(std::move(options)),
      interrupt_(interrupt),
      settings_(options_.settings),
      channels_(options_.channels),
      derived_(options_.derived),
      sensor_(options_.scene.sensor) {
  settings_.sampling.replicates = LiveFilm::kReplicates;
  status_.state = "loading";
  status_.newest.revision = 1;
  status_.target_samples =
      std::min(options_.samples.value_or(LiveFilm::most_samples()), LiveFilm::most_samples());
}

std::pair<uint32_t, uint32_t> LiveState::full_size() const {
  return {sensor_.film.crop_width, sensor_.film.crop_height};
}

bool LiveState::is_done() const {
  return film_ && film_ == full_.get() && film_->samples() >= *status_.target_samples;
}

bool LiveState::work() {
  try {
    if (!failed_ && !scene_) {
      compile();
      set_state();
      return true;
    }
    if (failed_ || is_done()) return false;
    if (is_reduced() && seconds_since(last_moving_) > kMovingPause) move_to(sensor_, false);
    if (paused_ && !is_reduced()) return false;
    if (paused_ || (is_reduced() && film_->samples() >= *status_.target_samples))
      std::this_thread::sleep_for(kRest);
    else
      render_some();
  } catch (const std::exception& error) {
    fail(error);
  }
  set_state();
  return !failed_ && !is_done();
}

void LiveState::fail(const std::exception& error) {
  failed_ = true;
  status_.message = error.what();
  set_state();
}

void LiveState::set_state() {
  status_.state = failed_     ? "failed"
                  : !film_    ? "loading"
                  : is_done() ? "done"
                  : paused_   ? "paused"
                              : "rendering";
}

/// Without error bars if need be; for any rule of sums, which only the backend knows.
void LiveState::check_film(std::size_t channels) const {
  if (channels > kMostChannels)
    throw InputError(fmt::format("{} channels: at most {} can be looked at", channels, kMostChannels));
  const std::size_t bytes = LiveFilm::bytes(film_rect(sensor_.film), channels, SumRule{}, false);
  if (bytes > options_.memory_bytes)
    throw InputError(
        fmt::format("the film needs {} MiB, at most {} MiB may be used: fewer channels or a smaller --size",
                    bytes >> 20, options_.memory_bytes >> 20));
}

/// What was before goes first: two films or two acceleration structures may be more than there is memory for.
void LiveState::compile() {
  const std::size_t channels = bands().size();
  check_film(channels);
  film_ = nullptr;
  full_.reset();
  small_.reset();
  backend_.reset();
  SceneDescription scene = edits_.apply(options_.scene);
  scene.sensor = sensor_;
  scene.integrator.max_depth = settings_.max_depth;
  scene_ = compile_scene_to_move(scene, {channels_, options_.guide, options_.sink});
  backend_ = options_.backends.make(settings_, scene_, derived_);
  units_ = backend_->film_scale();
  const std::size_t bytes = LiveFilm::bytes(film_rect(sensor_.film), channels, backend_->sum_rule(), true);
  variance_ = bytes <= options_.memory_bytes;
  status_.memory_bytes = LiveFilm::bytes(film_rect(sensor_.film), channels, backend_->sum_rule(), variance_);
  if (!variance_) status_.message = "no error bars: the film would be too large with them";
  full_ = make_film(sensor_);
  film_ = full_.get();
  look_along_the_axis();
}

std::vector<Band> LiveState::bands() const {
  std::vector<Band> bands;
  for (const Channel& channel : channels_) bands.push_back({channel, false});
  for (const Channel& response : derived_.bands) bands.push_back({response, true});
  return bands;
}

std::unique_ptr<LiveFilm> LiveState::make_film(const Sensor& sensor) const {
  auto film =
      std::make_unique<LiveFilm>(film_rect(sensor.film), bands(), units_, backend_->sum_rule(), variance_);
  if (settings_.sampling.wavelengths == WavelengthMode::kPerPath) film->set_independent_errors();
  return film;
}

/// What the camera turns about: what is seen in the middle, or else something as far away as the scene is large.
void LiveState::look_along_the_axis() {
  if (!scene_) return;  // compile() does it
  scene_size_ = std::max(1e-6, 2.0 * static_cast<double>(scene_->scene_radius));
  const Film& film = sensor_.film;
  const PixelRect middle{film.crop_x + film.crop_width / 2, film.crop_y + film.crop_height / 2, 1, 1};
  const double depth = backend_->auxiliary(middle).front().depth;
  distance_ = depth > 0 ? depth : scene_size_;
}

/// Width and height by this, so that a pass is short enough for a hand that moves.
uint32_t LiveState::reduction() const {
  uint32_t factor = 2;
  while (factor < kMostReduction && pass_seconds_ / (factor * factor) > kMovingSeconds) factor *= 2;
  return factor;
}

void LiveState::use_film(bool reduced) {
  if (!reduced) {
    film_ = full_.get();
    return;
  }
  const uint32_t factor =
      film_ == small_.get() && small_ ? small_factor_ : reduction();  // no change while moving
  if (!small_ || factor != small_factor_) small_ = make_film(reduced_sensor(sensor_, factor));
  small_factor_ = factor;
  film_ = small_.get();
}

/// The scene stays; if the camera is refused everything does. A backend that fails at it ends the render: its device is lost.
void LiveState::move_to(const Sensor& sensor, bool reduced) {
  if (failed_) throw InputError("there is no render: " + status_.message);
  if (!scene_) {  // is compiled next
    sensor_ = sensor;
    return begin_revision();
  }
  const Sensor before = sensor_;
  LiveFilm* const shown = film_;  // use_film() leaves it as it is
  try {
    sensor_ = sensor;
    if (reduced) use_film(true);
    move_camera(*scene_, reduced ? reduced_sensor(sensor, small_factor_) : sensor);
  } catch (...) {
    sensor_ = before;
    film_ = shown;
    throw;
  }
  use_film(reduced);
  try {
    backend_->camera_moved();
  } catch (const std::exception& error) {
    fail(error);
    throw;
  }
  begin_revision();
}

void LiveState::begin_revision() {
  ++status_.newest.revision;
  status_.newest.samples = 0;
  status_.blank = true;
  status_.error.reset();
  status_.seconds = busy_seconds_ = 0;
  paths_ = 0;
  last_error_ = Clock::now();
  if (film_) film_->restart();
  set_state();
}

void LiveState::set_camera(const nlohmann::json& wanted) {
  check_members(wanted, {"origin", "target", "up", "fov_deg", "moving", "reset"});
  const bool moving = get_flag(wanted, "moving").value_or(false);
  if (moving) last_moving_ = Clock::now();
  if (get_flag(wanted, "reset").value_or(false)) {
    move_to(options_.scene.sensor, moving);
    return look_along_the_axis();
  }
  const Sensor sensor = placed_sensor(sensor_, wanted, distance_);
  const auto target = get_triple(wanted, "target");
  move_to(sensor, moving);
  if (target)
    distance_ =
        glm::length(glm::dvec3((*target)[0], (*target)[1], (*target)[2]) - glm::dvec3(sensor.to_world[3]));
}

/// After a failure with a backend of its own: the old one may have no device any more.
void LiveState::restart() {
  if (std::exchange(failed_, false)) {
    scene_.reset();
    status_.message.clear();
  }
  if (scene_ && film_ && film_ == full_.get()) return begin_revision();
  if (scene_ && film_) return move_to(sensor_, false);
  scene_.reset();
  begin_revision();
}

void LiveState::pause(bool paused) {
  paused_ = paused;
  set_state();
}

void LiveState::render_some() {
  const std::size_t blocks = film_->blocks();
  const double share = static_cast<double>(film_->film().rect().pixels()) /
                       static_cast<double>(film_rect(sensor_.film).pixels());
  const double expected = pass_seconds_ * share;
  std::size_t most = pass_seconds_ > 0 ? blocks : kFirstBlocks;
  if (expected > 2 * kPieceSeconds)
    most = std::max<std::size_t>(
        static_cast<std::size_t>(static_cast<double>(blocks) * kPieceSeconds / expected), 8);
  const std::vector<uint32_t> some = film_->next_blocks(most);
  const auto start = Clock::now();
  const uint64_t paths = backend_->statistics().paths;
  backend_->render(film_->film(), film_->range(), some, interrupt_, {});
  const double seconds = seconds_since(start);
  paths_ += backend_->statistics().paths - paths;
  if (!interrupt_) measure(some.size(), seconds);
  const bool was_first = film_->passes() == 0;
  const bool is_whole = film_->finish_pass();
  // Parts are shown while there is nothing else. A whole pass always: what interrupts the next may be refused.
  if (!is_whole && (interrupt_ || !was_first)) return;
  ++status_.newest.frame;
  status_.blank = false;
  status_.newest.samples = film_->samples();
  update_error();
}

void LiveState::measure(std::size_t blocks, double seconds) {
  const double full_blocks = static_cast<double>(full_->blocks());
  const double pass = seconds * full_blocks / static_cast<double>(blocks);
  pass_seconds_ = pass_seconds_ == 0 ? pass : 0.7 * pass_seconds_ + 0.3 * pass;
  busy_seconds_ += seconds;
  status_.seconds = busy_seconds_;
  status_.paths_per_second = static_cast<double>(paths_) / busy_seconds_;
  status_.frames_per_second = static_cast<double>(film_->passes()) / busy_seconds_;
}

/// Now and then, and once more of the last sample: what stands there while the render rests belongs to its samples.
void LiveState::update_error() {
  if (!variance_ || film_ != full_.get()) return;
  if (!is_done() && seconds_since(last_error_) < kErrorInterval) return;
  last_error_ = Clock::now();
  const std::size_t bands = film_->bands().size(), width = film_->width();
  ErrorSums sums(bands);
  std::vector<float> means(width * bands), variances(width * bands);
  std::vector<double> mean(bands), variance(bands);
  for (uint32_t y = 0; y < film_->height(); y += kErrorRows) {
    film_->means(y, means);
    film_->variances(y, variances);
    for (std::size_t x = 0; x < width; ++x) {
      std::copy_n(&means[x * bands], bands, mean.begin());
      std::copy_n(&variances[x * bands], bands, variance.begin());
      if (!std::isnan(mean.front())) sums.add(mean, variance);
    }
  }
  status_.error = sums.errors().worst;
}

}  // namespace kiloband::viewer
