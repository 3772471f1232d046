// Targets: the requests of pages, to a stored cube and to a render.
#include <atomic>
#include <sstream>

#include "base/text.hpp"
#include "cube/cube_io.hpp"
#include "scene/read/reader.hpp"
#include "tests/fuzz/fuzz_target.hpp"
#include "viewer/api/api.hpp"
#include "viewer/api/save.hpp"
#include "viewer/api/stored_image.hpp"
#include "viewer/live/live_state.hpp"

namespace kiloband::fuzz {
namespace {

using namespace viewer;

/// A line "METHOD path?query", headers, an empty line, the body.
Request parse_request(std::string_view bytes) {
  Request request{
      "GET", "/", {}, {{"host", "localhost"}, {"x-kiloband", "1"}, {"content-type", "application/json"}}, ""};
  const std::size_t end = bytes.find("\n\n");
  std::istringstream lines{std::string(bytes.substr(0, end))};
  if (end != std::string_view::npos) request.body = bytes.substr(end + 2);
  std::string line, target;
  std::getline(lines, line);
  std::istringstream(line) >> request.method >> target;
  request.path = target.substr(0, target.find('?'));
  std::istringstream parameters(target.find('?') == std::string::npos ? ""
                                                                      : target.substr(target.find('?') + 1));
  for (std::string pair; std::getline(parameters, pair, '&');)
    request.query.emplace(pair.substr(0, pair.find('=')),
                          pair.find('=') == std::string::npos ? "" : pair.substr(pair.find('=') + 1));
  while (std::getline(lines, line)) {
    const std::size_t colon = line.find(':');
    if (colon != std::string::npos)
      request.headers[lowered(line.substr(0, colon))] = trimmed(line.substr(colon + 1));
  }
  return request;
}

void ask(Api& api, const Request& request) {
  const Response response = api.answer(request, [] { return true; });
  promise(response.status != 500, response.body.c_str());
  accept_or_refuse([&] {
    if (response.status >= 400) throw InputError(response.body);
  });
  if (request.path != "/api/save") return;
  accept_or_refuse([&] {
    const auto file = new_file(scratch_folder() / "none", request.body, "exr");
    promise(file.parent_path() == scratch_folder() / "none", "a file outside the folder");
  });
}

std::filesystem::path write_cube() {
  CubeInfo info;
  info.width = 3;
  info.height = 2;
  info.bands = {{{500, 510, ""}}, {{600, 620, ""}}, {{8000, 9000, ""}}};
  info.variance = true;
  const std::filesystem::path file = scratch_folder() / "viewed.hdr";
  const auto writer = create_cube_writer(file, info, 2);
  const std::vector<float> values(18, 1.0f);
  writer->write_rows({0, 2, values, values, {}});
  writer->finish();
  return file;
}

/// Samples that find nothing.
class NoBackend final : public Backend {
 public:
  explicit NoBackend(std::size_t channels) : channels_(channels) {}
  void render(SpectralFilm& film, const SampleRange& range, const std::vector<uint32_t>& blocks,
              const std::atomic<bool>&, const std::function<void(uint64_t)>&) override {
    for (const uint32_t block : blocks) {
      film.open_replicate(range.replicate, block);
      film.set_attempted(range.replicate, block, range.first + range.count);
    }
  }
  std::vector<AuxiliaryPixel> auxiliary(const PixelRect& rect) override {
    return std::vector<AuxiliaryPixel>(rect.pixels());
  }
  std::vector<TracedPath> trace(const PixelRect& rect, const SampleRange&) override {
    return std::vector<TracedPath>(rect.pixels());
  }
  void camera_moved() override {}
  BackendInfo info() const override { return {"none", "none", "none"}; }
  BackendStatistics statistics() const override { return {}; }
  std::vector<double> film_scale() const override { return std::vector<double>(channels_, 1.0); }
  SumRule sum_rule() const override { return {}; }
  uint32_t blocks_at_once(uint32_t) const override { return 1; }

 private:
  std::size_t channels_;
};

const char* const kScene = R"(<scene version='3.0.0'>
<sensor type='perspective'><film type='hdrfilm'><integer name='width' value='8'/><integer name='height' value='8'/></film></sensor>
<shape type='sphere' id='a'><bsdf type='conductor'><string name='material' value='Au'/></bsdf></shape>
<shape type='sphere' id='b'><bsdf type='dielectric'/></shape>
<shape type='rectangle' id='c'><bsdf type='twosided'><bsdf type='diffuse'/></bsdf>
 <emitter type='area'><spectrum name='radiance' value='1'/></emitter></shape>
<emitter type='point'><spectrum name='intensity' value='1'/></emitter></scene>)";

LiveOptions live_options() {
  LiveOptions options;
  options.scene = read_scene_text(kScene, "fuzz.xml", ".");
  options.channels = parse_channels("500:600:3");
  options.settings.backend = "none";
  options.settings.method = "a";
  options.backends.choices = {{"none", "none", {}, {"a", "b"}}};
  options.backends.make = [](const LiveSettings&, std::shared_ptr<const FlatScene> scene,
                             const DerivedChannels&) {
    return std::make_unique<NoBackend>(scene->channels.size());
  };
  options.memory_bytes = std::size_t{1} << 24;
  return options;
}

/// A render whose thread is the caller's.
class SameThreadRender final : public ViewedImage, public RenderControls {
 public:
  SameThreadRender() : state_(live_options(), interrupt_) { work(); }
  void work() {
    for (int i = 0; i < 3; ++i) state_.work();
  }

  nlohmann::json scene() override { return state_.scene_json(); }
  uint64_t scene_number() override { return 1; }
  ViewStatus status() override { return state_.status(); }
  bool wait_for_frame(uint64_t after, std::chrono::milliseconds) override {
    return state_.status().newest.frame > after && state_.film();
  }
  bool read_newer(uint64_t after, std::chrono::milliseconds most,
                  const std::function<void(const ImageView&)>& look) override {
    if (!wait_for_frame(after, most)) return false;
    read(look);
    return true;
  }
  void read(const std::function<void(const ImageView&)>& look) override {
    if (!state_.film()) throw InputError("there is no image yet");
    const auto [width, height] = state_.full_size();
    look({*state_.film(), state_.status().newest, state_.status().blank, width, height,
          [this] { return state_.metadata(); }});
  }
  unsigned threads() const override { return 1; }
  RenderControls* controls() override { return this; }
  void set_camera(const nlohmann::json& wanted) override { state_.set_camera(wanted), work(); }
  void set_settings(const nlohmann::json& wanted) override { state_.set_settings(wanted), work(); }
  void set_spectrum(const nlohmann::json& wanted) override { state_.set_spectrum(wanted), work(); }
  void pause() override { state_.pause(true); }
  void resume() override { state_.pause(false), work(); }
  void restart() override { state_.restart(), work(); }
  std::string camera_xml() override { return state_.camera_xml(); }

 private:
  std::atomic<bool> interrupt_{false};
  LiveState state_;
};

}  // namespace

void viewer_requests(std::string_view bytes) {
  static const auto kCube = open_stored_image(write_cube(), std::size_t{1} << 20, 1, {});
  const Request request = parse_request(bytes);
  Api of_cube(*kCube, {});
  ask(of_cube, request);
  SameThreadRender render;
  Api of_render(render, {});
  ask(of_render, request);
  read_scene_text("<scene version='3.0.0'>" + render.camera_xml() +
                      "<shape type='sphere'/><emitter type='constant'/></scene>",
                  "camera.xml",
                  ".");  // is accepted
}

}  // namespace kiloband::fuzz
