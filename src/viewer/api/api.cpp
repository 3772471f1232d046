#include "viewer/api/api.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/json_dump.hpp"
#include "base/number.hpp"
#include "base/text.hpp"
#include "viewer/api/json_text.hpp"
#include "viewer/api/page_files.hpp"
#include "viewer/api/save.hpp"
#include "viewer/api/selections.hpp"
#include "viewer/display/colour_map.hpp"
#include "viewer/display/encode.hpp"
#include "viewer/display/row_range.hpp"

namespace kiloband::viewer {
namespace {

using nlohmann::json;

constexpr std::chrono::seconds kLongestWait{10};
constexpr std::chrono::milliseconds kWaitStep{200};
constexpr uint32_t kMostValues = 1024;  // pixels of /api/values

Response answer_json(const json& value) {
  return {200, "application/json", to_text(value), {}};
}

struct NotFound {};

Response page_file(const std::string& path) {
  const std::string name = path == "/" ? "/index.html" : path;
  const auto file = page_files().find(name);
  if (file == page_files().end()) throw NotFound{};
  return {200, media_type(name), std::string(file->second), {}};
}

Response colour_map_answer(const Request& request) {
  const auto name = find_colour_map(request.parameter("map"));
  if (!name) throw InputError("map: must be viridis, cividis, magma or grey");
  json colours = json::array();
  for (const Colour& colour : colour_map(*name)) colours.push_back(to_hex(colour));
  return answer_json({{"colors", std::move(colours)}});
}

uint64_t parse_count(const Request& request, const std::string& name) {
  const std::string text = request.parameter(name);
  const auto value = whole_number<uint64_t>(text.empty() ? "0" : text);
  if (!value) throw InputError(fmt::format("{}={}: must be a whole number from 0", name, quote_text(text)));
  return *value;
}

json stamp_json(const FrameStamp& stamp) {
  return {{"frame", stamp.frame}, {"revision", stamp.revision}, {"samples", stamp.samples}};
}

bool has_errors(const Curve& curve) {
  return std::ranges::any_of(curve.standard_error, [](float error) { return !std::isnan(error); });
}

/// The values of a part of the image, given in pixels of the full one, from a plane of the rows that have something of it.
json values_of(const ImageView& seen, const Selection& part,
               const std::function<Plane(const PixelSource&)>& make) {
  const auto row_of = [&](uint32_t y) { return reduced(y, seen.full_height, seen.pixels.height()); };
  const uint32_t first = row_of(part.y0);
  const Plane plane = make(RowRange(seen.pixels, first, row_of(part.y1) - first + 1));
  std::vector<float> values;
  for (uint32_t y = part.y0; y <= part.y1; ++y) {
    for (uint32_t x = part.x0; x <= part.x1; ++x) {
      const std::size_t column = reduced(x, seen.full_width, plane.width);
      const std::size_t at = (std::size_t{row_of(y) - first} * plane.width + column) * plane.components;
      values.insert(values.end(), &plane.values[at], &plane.values[at] + plane.components);
    }
  }
  return {{"components", plane.components}, {"values", numbers_json(values)}};
}

}  // namespace

Response Api::answer(const Request& request, const std::function<bool()>& gone) {
  Response response;
  try {
    auto refused = refuse(request);
    response = refused ? std::move(*refused) : route(request, gone);
  } catch (const NotFound&) {
    response = refusal(404, "there is no " + quote_text(request.path));
  } catch (const InputError& error) {
    response = refusal(400, error.what());
  } catch (const std::exception& error) {
    response = refusal(500, error.what());
  }
  response.headers.insert(
      response.headers.end(),
      {{"Cache-Control", "no-store"},
       {"X-Content-Type-Options", "nosniff"},
       {"Cross-Origin-Resource-Policy", "same-origin"},
       {"Referrer-Policy", "no-referrer"},
       {"Content-Security-Policy",
        "default-src 'self'; img-src 'self' blob: data:; style-src 'self' 'unsafe-inline'; frame-ancestors 'none'"}});
  return response;
}

Response Api::route(const Request& request, const std::function<bool()>& gone) {
  return request.method == "GET" ? get(request, gone) : post(request);
}

Response Api::get(const Request& request, const std::function<bool()>& gone) {
  const std::string& path = request.path;
  if (!path.starts_with("/api/")) return page_file(path);
  if (path == "/api/scene") return scene();
  if (path == "/api/frame") return frame(request, gone);
  if (path == "/api/values") return values(request);
  if (path == "/api/colormap") return colour_map_answer(request);
  if (path == "/api/spectra") return spectra(request);
  if (path == "/api/export.csv") return export_csv(request);
  if (path == "/api/camera.xml") return {200, "text/plain; charset=utf-8", controls().camera_xml(), {}};
  throw NotFound{};
}

Response Api::post(const Request& request) {
  if (request.path == "/api/response") {
    responses_.add(request.parameter("name"), request.body);
    return answer_json(json::object());
  }
  const bool known = request.path == "/api/camera" || request.path == "/api/settings" ||
                     request.path == "/api/spectrum" || request.path == "/api/control" ||
                     request.path == "/api/save";
  if (!known) throw NotFound{};
  if (!request.header("content-type").starts_with("application/json"))
    throw InputError("the body must be of type application/json");
  const json wanted = parse_object(request.body);
  if (request.path == "/api/save") return save(wanted);
  if (request.path == "/api/control") return control(wanted);
  if (request.path == "/api/camera") controls().set_camera(wanted);
  if (request.path == "/api/settings") controls().set_settings(wanted);
  if (request.path == "/api/spectrum") controls().set_spectrum(wanted);
  return answer_json({{"revision", image_.status().newest.revision}});
}

RenderControls& Api::controls() {
  RenderControls* const controls = image_.controls();
  if (!controls) throw InputError("a stored cube is not rendered: it has no camera, settings or materials");
  return *controls;
}

Response Api::scene() {
  json scene = image_.scene();
  std::vector<Band> bands;
  for (const json& c : scene["channels"])
    bands.push_back({{c["min_nm"], c["max_nm"], c["name"]}, c["derived"].get<bool>()});
  scene["modes"] = modes_for(bands, scene["errors"].get<bool>(), responses_);
  scene["choices"]["output"] = settings_.output_dir.has_value();
  return answer_json(scene);
}

Response Api::frame(const Request& request, const std::function<bool()>& gone) {
  const ViewParameters view = parse_view(request);
  const uint64_t after = parse_count(request, "after");
  const auto give_up = std::chrono::steady_clock::now() + kLongestWait;
  Plane plane;
  json facts;
  const auto look = [&](const ImageView& seen) {
    plane = make_plane(seen.pixels, view, responses_, image_.threads());
    const Legend legend = legend_of(view, seen.pixels.bands());
    facts = stamp_json(seen.stamp);
    facts.update({{"width", plane.width},
                  {"height", plane.height},
                  {"full_width", seen.full_width},
                  {"full_height", seen.full_height},
                  {"unit", legend.unit},
                  {"label", legend.label}});
  };
  while (!image_.read_newer(after, kWaitStep, look)) {
    if (gone() || std::chrono::steady_clock::now() > give_up) return {204, "", "", {}};
  }
  const Shown shown = show(plane, view);
  facts.update(shown.facts);
  const bool exact = view.exact || !fits_jpeg(shown.picture);
  Response response{200, exact ? "image/png" : "image/jpeg", "", {}};
  response.body = exact ? encode_png(shown.picture) : encode_jpeg(shown.picture);
  response.headers = {{"X-Kiloband-Frame", dump_json(facts, -1, true)}};
  return response;
}

Response Api::values(const Request& request) {
  const ViewParameters view = parse_view(request);
  const std::string place = fmt::format("{},{},{},{}", request.parameter("x0"), request.parameter("y0"),
                                        request.parameter("x1"), request.parameter("y1"));
  json answer;
  image_.read([&](const ImageView& seen) {
    const Selection part = parse_selections(place, seen.full_width, seen.full_height).at(0);
    const uint64_t width = part.x1 - part.x0 + 1, height = part.y1 - part.y0 + 1;
    if (width * height > kMostValues)
      throw InputError(fmt::format("values of {} pixels: at most {}", width * height, kMostValues));
    answer = stamp_json(seen.stamp);
    answer.update({{"width", width}, {"height", height}});
    answer.update(values_of(seen, part, [&](const PixelSource& rows) {
      return make_plane(rows, view, responses_, image_.threads());
    }));
  });
  return answer_json(answer);
}

std::vector<Curve> Api::curves_of(const ImageView& seen, const std::vector<Selection>& places) {
  if (!image_.controls()) return kept_curves_.read(seen, places, image_.threads());  // a stored cube
  return read_curves(seen.pixels, places, seen.full_width, seen.full_height, image_.threads());
}

Response Api::spectra(const Request& request) {
  json answer;
  image_.read([&](const ImageView& seen) {
    const auto places = parse_selections(request.parameter("select"), seen.full_width, seen.full_height);
    const auto curves = curves_of(seen, places);
    answer = stamp_json(seen.stamp);
    answer["curves"] = json::array();
    for (std::size_t i = 0; i < places.size(); ++i) {
      answer["curves"].push_back(
          {{"select", places[i].text},
           {"pixels", curves[i].pixels},
           {"mean", numbers_json(curves[i].mean)},
           {"standard_error",
            has_errors(curves[i]) ? numbers_json(curves[i].standard_error) : json(nullptr)}});
    }
  });
  return answer_json(answer);
}

Response Api::export_csv(const Request& request) {
  Response response{200, "text/csv; charset=utf-8", "", {}};
  image_.read([&](const ImageView& seen) {
    const auto places = parse_selections(request.parameter("select"), seen.full_width, seen.full_height);
    response.body = curves_csv(seen.pixels.bands(), places, curves_of(seen, places));
  });
  response.headers = {{"Content-Disposition", "attachment; filename=\"spectra.csv\""}};
  return response;
}

Response Api::save(const json& wanted) {
  check_members(wanted, {"format", "name", "mode", "exposure", "tone", "r", "g", "b", "channel", "map",
                         "scale", "low", "high", "quality"});
  if (!settings_.output_dir)
    throw InputError("saving is not allowed: kiloband view was started without --output-dir");
  const std::lock_guard alone(saving_);
  const std::string format = get_text(wanted, "format").value_or("");
  const std::filesystem::path file =
      new_file(*settings_.output_dir, get_text(wanted, "name").value_or(""), format);
  const auto check = [](const ImageView& seen) {
    if (seen.blank) throw InputError("there is no image yet: the render has no sample");
  };
  if (format == "png") {
    Request parameters;
    for (const auto& [name, value] : wanted.items())
      parameters.query[name] = value.is_string() ? value.get<std::string>() : to_text(value);
    const ViewParameters view = parse_view(parameters);
    Plane plane;
    image_.read([&](const ImageView& seen) {
      check(seen);
      plane = make_plane(seen.pixels, view, responses_, image_.threads());
    });
    save_picture(file, encode_png(show(plane, view).picture));
  } else {
    image_.read([&](const ImageView& seen) {
      check(seen);
      save_cube(file, seen);
    });
  }
  return answer_json({{"files", files_of(file)}});
}

Response Api::control(const json& wanted) {
  check_members(wanted, {"action"});
  const std::string action = get_text(wanted, "action").value_or("");
  if (action == "pause")
    controls().pause();
  else if (action == "resume")
    controls().resume();
  else if (action == "restart")
    controls().restart();
  else
    throw InputError("action: must be pause, resume or restart");
  return answer_json(json::object());
}

}  // namespace kiloband::viewer
