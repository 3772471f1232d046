// <film type="hdrfilm | specfilm | bandfilm"> and <rfilter>.
#include <algorithm>
#include <cmath>
#include <tuple>

#include "scene/read/context.hpp"
#include "scene/xml/values.hpp"

namespace kiloband {
namespace {

constexpr int64_t kMaxSide = 65535;       // pixels
constexpr double kMinFilter = 1e-3;       // pixels: finer than positions in a film of 65535
constexpr double kMostCubic = 10;         // coefficients of filters: others are mostly noise
constexpr double kSubChannelNm = 5;       // widest sub-channel of a response that is not constant
constexpr std::size_t kMaxBands = 65536;  // spectra of a specfilm

uint32_t side(const ObjectReader& object, std::string_view name, int64_t fallback, int64_t lowest,
              int64_t highest) {
  const int64_t value = object.get_int(name, fallback);
  if (value < lowest || value > highest) {
    object.fail_at(name, std::string(name) + " " + std::to_string(value) + ": must be from " +
                             std::to_string(lowest) + " to " + std::to_string(highest));
  }
  return static_cast<uint32_t>(value);
}

/// ReadOptions::film_size in place of the film's: the whole image, which a crop window would contradict.
void replace_size(const ReadContext& context, Film& film) {
  if (!context.film_size) return;
  const auto [width, height] = *context.film_size;
  if (width < 1 || height < 1 || width > kMaxSide || height > kMaxSide) {
    throw InputError("film size " + std::to_string(width) + "x" + std::to_string(height) +
                     ": each side must be from 1 to " + std::to_string(kMaxSide));
  }
  film.width = film.crop_width = width;
  film.height = film.crop_height = height;
}

/// Size and crop window, which must lie inside the film.
void read_size(const ReadContext& context, const ObjectReader& object, Film& film) {
  film.width = side(object, "width", 768, 1, kMaxSide);
  film.height = side(object, "height", 576, 1, kMaxSide);
  film.crop_x = side(object, "crop_offset_x", 0, 0, film.width - 1);
  film.crop_y = side(object, "crop_offset_y", 0, 0, film.height - 1);
  film.crop_width = side(object, "crop_width", film.width - film.crop_x, 1, film.width - film.crop_x);
  film.crop_height = side(object, "crop_height", film.height - film.crop_y, 1, film.height - film.crop_y);
  if (!context.film_size) return;
  if (film.crop_width != film.width || film.crop_height != film.height) {
    object.fail_here("a film with a crop window cannot be given another size");
  }
  replace_size(context, film);
}

void set_default_filter(Film& film) {
  film.filter = FilterType::kGaussian;
  film.filter_stddev = 0.5;
  film.filter_radius = 4 * film.filter_stddev;
}

/// mitchell: B, C; catmullrom is the one with 0 and 1/2.
void read_cubic(const ObjectReader& object, Film& film) {
  film.filter = FilterType::kMitchell;
  film.filter_radius = 2;
  film.filter_b = 0;
  film.filter_c = 0.5;
  if (object.type() == "catmullrom") return;
  film.filter_b = object.get_float("B", 1.0 / 3);
  film.filter_c = object.get_float("C", 1.0 / 3);
  const auto check = [&](std::string_view name, double value) {
    object.check(std::fabs(value) <= kMostCubic, name, value, "must be from -10 to 10");
  };
  check("B", film.filter_b);
  check("C", film.filter_c);
}

/// box: no parameters; tent: radius 1; gaussian: stddev 0.5, cut at 4 standard deviations. Default: gaussian.
void read_filter(const ObjectReader& film_object, Film& film) {
  set_default_filter(film);
  Node* node = film_object.nested_one("rfilter");
  if (!node) return;
  const ObjectReader object(*node);
  if (node->type == "box") {
    film.filter = FilterType::kBox;
    film.filter_radius = 0.5;
  } else if (node->type == "tent") {
    film.filter = FilterType::kTent;
    film.filter_radius = object.get_float("radius", 1);
    object.check(film.filter_radius >= kMinFilter && film.filter_radius <= 100, "radius", film.filter_radius,
                 "must be from 0.001 to 100 pixels");
  } else if (node->type == "gaussian") {
    film.filter_stddev = object.get_float("stddev", 0.5);
    object.check(film.filter_stddev >= kMinFilter && film.filter_stddev <= 25, "stddev", film.filter_stddev,
                 "must be from 0.001 to 25 pixels");
    film.filter_radius = 4 * film.filter_stddev;
  } else if (node->type == "mitchell" || node->type == "catmullrom") {
    read_cubic(object, film);
  } else if (node->type == "lanczos") {
    film.filter = FilterType::kLanczos;
    film.filter_radius = object.get_float("lobes", 3);
    object.check(film.filter_radius >= 1 && film.filter_radius <= 16, "lobes", film.filter_radius,
                 "must be from 1 to 16");
  } else {
    object.refuse_type({"box", "tent", "gaussian", "mitchell", "catmullrom", "lanczos"});
  }
  object.finish();
}

/// Mitsuba 0.x's film for pictures: an hdrfilm whose output is a PNG.
void accept_picture_film(const ReadContext& context, const ObjectReader& object) {
  note(context.sink, object.node().type_place.position(),
       object.label() + ": read as an hdrfilm; --preview writes a picture");
  accept_obsolete(context, object,
                  {"banner", "attach_log", "file_format", "pixel_format", "gamma", "exposure",
                   "tonemap_method", "key", "burn", "high_quality_edges"});
}

/// What Mitsuba's films say about their output files: checked, without meaning here (-o decides).
void accept_output_parameters(const ReadContext& context, const ObjectReader& object) {
  if (object.type() == "ldrfilm") return accept_picture_film(context, object);
  if (object.node().legacy)
    accept_obsolete(context, object, {"banner", "attach_log", "file_format", "high_quality_edges"});
  object.get_choice("file_format", {"openexr", "exr", "rgbe", "pfm"});
  if (object.type() == "hdrfilm") {
    object.get_choice("pixel_format", {"rgb", "luminance", "luminance_alpha", "rgba", "xyz", "xyza"});
  }
  object.get_choice("component_format", {"float16", "float32", "uint32"});
  object.get_bool("sample_border", false);
  object.get_bool("compensate", false);  // Mitsuba's sums with their rounding errors; ours have them always
}

/// True for a table that is 1 everywhere in its range: a channel as it stands.
bool is_box(const Spectrum& spectrum) {
  const auto values = spectrum.knot_values();
  return std::all_of(values.begin(), values.end(), [](double v) { return v == 1; });
}

/// Sub-channels for responses that are not constant: between all their knots, where any of them is not 0,
/// steps of at most kSubChannelNm of equal width.
void add_sub_channels(const ObjectReader& object, Film& film) {
  std::vector<double> knots;
  for (const auto& response : film.responses) {
    knots.insert(knots.end(), response.second.knots_nm().begin(), response.second.knots_nm().end());
  }
  std::sort(knots.begin(), knots.end());
  knots.erase(std::unique(knots.begin(), knots.end()), knots.end());
  for (std::size_t i = 0; i + 1 < knots.size(); ++i) {
    const double low = knots[i], width = knots[i + 1] - low;
    const bool seen = std::any_of(film.responses.begin(), film.responses.end(),
                                  [&](const auto& r) { return r.second(low + 0.5 * width) > 0; });
    if (!seen) continue;
    const double steps = std::ceil(width / kSubChannelNm);
    if (steps + static_cast<double>(film.channels.size()) > static_cast<double>(kMaxChannels)) {
      object.fail_here("the responses need more than " + std::to_string(kMaxChannels) + " channels");
    }
    for (double step = 0; step < steps; ++step) {
      film.channels.push_back({low + width * (step / steps), low + width * ((step + 1) / steps), {}});
    }
  }
}

/// Every spectrum of a specfilm is a band named as the parameter.
void read_spectra(ReadContext& context, const ObjectReader& object, Film& film) {
  std::size_t count = 0;
  for (const auto& child : object.node().children) {
    Node& node = child->resolved();
    if (node.tag != "spectrum" && node.tag != "texture") continue;
    child->used = true;
    const Place place = place_of_value(*child);
    if (!child->is_named()) fail(child->place, object.label() + ": a band's spectrum needs a name");
    if (++count > kMaxBands)
      fail(child->place, object.label() + ": more than " + std::to_string(kMaxBands) + " bands");
    const std::string label = object.label() + ": band '" + child->name + "'";
    const Texture texture = read_texture_node(context, *child, label, SpectrumUse::kQuantity);
    const Spectrum spectrum = std::get<Spectrum>(texture);
    const auto range = spectrum.data_range();
    if (spectrum.knots_nm().size() < 2 || !range || spectrum.extrapolates()) {
      fail(place, label + ": needs a tabulated spectrum with a first and a last wavelength");
    }
    if (is_box(spectrum)) {
      film.channels.push_back({range->min_nm, range->max_nm, child->name});
    } else {
      film.responses.emplace_back(child->name, spectrum);
    }
  }
  if (count == 0) object.fail_here("needs at least one spectrum");
  add_sub_channels(object, film);
  if (film.channels.empty()) object.fail_here("all responses are 0");
}

void read_bands(ReadContext& context, const ObjectReader& object, Film& film) {
  if (object.has("bands") == object.has("bands_file"))
    object.fail_here("needs either 'bands' or 'bands_file'");
  if (object.has("bands")) {
    const std::string bands = object.require_string("bands");
    film.channels = load_at(object.value_place("bands"), [&] { return parse_channels(bands); });
  } else {
    const std::filesystem::path file = context.file(object, "bands_file");
    film.channels = load_at(object.value_place("bands_file"), [&] { return read_channels_file(file); });
  }
}

}  // namespace

Film default_film(const ReadContext& context) {
  Film film;
  film.crop_width = film.width;
  film.crop_height = film.height;
  set_default_filter(film);
  replace_size(context, film);
  return film;
}

Film read_film(ReadContext& context, Node& node) {
  const ObjectReader object(node);
  Film film;
  const bool old_picture = node.legacy && node.type == "ldrfilm";
  if (node.type != "hdrfilm" && node.type != "specfilm" && node.type != "bandfilm" && !old_picture) {
    object.refuse_type({"hdrfilm", "specfilm", "bandfilm"});
  }
  read_size(context, object, film);
  read_filter(object, film);
  if (node.type != "bandfilm") accept_output_parameters(context, object);
  if (node.type == "specfilm") read_spectra(context, object, film);
  if (node.type == "bandfilm") read_bands(context, object, film);
  object.finish();
  return film;
}

}  // namespace kiloband
