// <integrator> and <sampler>.
#include <algorithm>

#include "scene/read/context.hpp"
#include "scene/read/object/limits.hpp"
#include "scene/xml/values.hpp"

namespace kiloband {
namespace {

constexpr int64_t kMaxDepth = 1'000'000;

int64_t positive(const ObjectReader& object, std::string_view name, int64_t fallback, int64_t highest) {
  const int64_t value = object.get_int(name, fallback);
  object.check(value >= 1, name, static_cast<double>(value), "must be >= 1");
  object.check(value <= highest, name, static_cast<double>(value), "must be <= " + std::to_string(highest));
  return value;
}

int64_t count(const ObjectReader& object, std::string_view name, int64_t fallback) {
  const int64_t value = object.get_int(name, fallback);
  object.check(value >= 0, name, static_cast<double>(value), "must be >= 0");
  object.check(value <= 65536, name, static_cast<double>(value), "must be <= 65536");
  return value;
}

/// How often `direct` splits each sample. One of our paths takes one emitter and one BSDF sample; the larger
/// of the two counts gives both strategies at least as many samples as the scene asks for.
uint64_t direct_splitting(const ObjectReader& object) {
  const bool separate = object.has("emitter_samples") || object.has("bsdf_samples");
  if (object.has("shading_samples") && separate) {
    object.fail_at("shading_samples", "'shading_samples' together with 'emitter_samples' or 'bsdf_samples'");
  }
  const int64_t shading = positive(object, "shading_samples", 1, 65536);
  const int64_t emitter = count(object, "emitter_samples", shading);
  const int64_t bsdf = count(object, "bsdf_samples", shading);
  if (emitter + bsdf == 0) object.fail_at("emitter_samples", "emitter_samples and bsdf_samples are both 0");
  return static_cast<uint64_t>(std::max(emitter, bsdf));
}

Integrator read_path(const ObjectReader& object) {
  Integrator result;
  const int64_t depth = object.get_int("max_depth", -1);
  object.check(depth >= -1, "max_depth", static_cast<double>(depth), "must be >= 0, or -1 for no limit");
  object.check(depth <= kMaxDepth, "max_depth", static_cast<double>(depth),
               "must be <= 1000000 (-1: no limit)");
  result.max_depth = static_cast<int>(depth);
  result.rr_depth = static_cast<int>(positive(object, "rr_depth", 5, kMaxDepth));
  return result;
}

/// How Mitsuba divides its work, and when it gives up: checked, without meaning here.
void accept_scheduling(ReadContext& context, const ObjectReader& object) {
  count(object, "samples_per_pass", 0);
  count(object, "block_size", 0);
  if (object.has("timeout")) {
    object.get_float("timeout", -1);
    note(context.sink, object.value_place("timeout").position(),
         object.label() + ": 'timeout' has no meaning here: use --time");
  }
  if (object.node().legacy) accept_obsolete(context, object, {"strict_normals"});
}

/// The one integrator in another that adds images to it. Its own image is that of the nested one.
ReadIntegrator read_nested(ReadContext& context, const ObjectReader& object) {
  Node* nested = object.nested_one("integrator");
  if (!nested && object.type() != "aov") object.fail_here("needs a nested integrator");
  object.get_bool("hide_emitters", false);  // without effect in Mitsuba: the nested one has its own
  accept_scheduling(context, object);
  object.finish();
  if (nested) return read_integrator(context, *nested);
  note(context.sink, object.node().type_place.position(),
       object.label() + ": has no nested integrator: there is the image of 'path', too");
  return {};
}

/// Adds an image of second moments in Mitsuba; the variance of the mean says the same.
ReadIntegrator read_moment(ReadContext& context, const ObjectReader& object) {
  ReadIntegrator result = read_nested(context, object);
  result.requested.variance = true;
  note(context.sink, object.node().type_place.position(),
       object.label() + ": in place of second moments the variance of the mean is written (--variance)");
  return result;
}

struct AovType {
  std::string_view name;   // Mitsuba's
  std::string_view image;  // ours; empty: there is none
};

constexpr AovType kAovTypes[] = {{"depth", "depth"},   {"sh_normal", "normal"}, {"shape_index", "object"},
                                 {"albedo", {}},       {"position", {}},        {"uv", {}},
                                 {"geo_normal", {}},   {"dp_du", {}},           {"dp_dv", {}},
                                 {"duv_dx", {}},       {"duv_dy", {}},          {"prim_index", {}},
                                 {"boundary_test", {}}};

/// "name:type" of an aov integrator.
/// throws InputError  it is something else
const AovType& aov_type(const ObjectReader& object, std::string_view text) {
  const std::size_t colon = text.find(':');
  const std::string_view type = colon == text.npos ? std::string_view{} : text.substr(colon + 1);
  std::vector<std::string_view> names;
  for (const AovType& known : kAovTypes) {
    if (known.name == type) return known;
    names.push_back(known.name);
  }
  object.fail_at("aovs", "aovs: '" + std::string(text) + "' is not NAME:TYPE with a known type" +
                             suggestion(type, names));
}

/// Auxiliary images beside the image.
ReadIntegrator read_aov(ReadContext& context, const ObjectReader& object) {
  const std::string aovs = object.require_string("aovs");
  std::vector<std::string> images;
  std::string others;
  for (const std::string_view text : split_tokens(aovs)) {
    const AovType& type = aov_type(object, text);
    const std::string image(type.image);
    if (image.empty())
      others += (others.empty() ? "" : ", ") + std::string(type.name);
    else if (std::ranges::find(images, image) == images.end())
      images.push_back(image);
  }
  if (!others.empty())
    note(context.sink, object.value_place("aovs").position(),
         object.label() + ": no images of " + others + ": there are depth, sh_normal, shape_index");
  ReadIntegrator result = read_nested(context, object);
  std::vector<std::string>& all = result.requested.auxiliary;
  std::erase_if(images, [&](const std::string& image) { return std::ranges::find(all, image) != all.end(); });
  all.insert(all.begin(), images.begin(), images.end());
  return result;
}

struct IntegratorType {
  std::string_view name;
  ReadIntegrator (*read)(ReadContext&, const ObjectReader&);
};

ReadIntegrator read_plain(ReadContext& context, const ObjectReader& object) {
  ReadIntegrator result{read_path(object), 1, {}};
  result.integrator.hide_emitters = object.get_bool("hide_emitters", false);
  accept_scheduling(context, object);
  object.finish();
  return result;
}

/// For derivatives; the image is that of `path`.
ReadIntegrator read_replayed(ReadContext& context, const ObjectReader& object) {
  note(context.sink, object.node().type_place.position(),
       object.label() + ": nothing is differentiated: rendered as 'path', which has the same image");
  return read_plain(context, object);
}

ReadIntegrator read_direct(ReadContext& context, const ObjectReader& object) {
  ReadIntegrator result;
  result.integrator.max_depth = 2;
  result.splitting = direct_splitting(object);
  result.integrator.hide_emitters = object.get_bool("hide_emitters", false);
  accept_scheduling(context, object);
  object.finish();
  return result;
}

constexpr IntegratorType kIntegratorTypes[] = {
    {"path", read_plain},       {"direct", read_direct},      {"volpath", read_plain},
    {"volpathmis", read_plain}, {"moment", read_moment},      {"aov", read_aov},
    {"prb", read_replayed},     {"prb_basic", read_replayed}, {"prbvolpath", read_replayed}};

}  // namespace

ReadIntegrator read_integrator(ReadContext& context, Node& node) {
  const ObjectReader object(node);
  std::vector<std::string_view> names;
  for (const IntegratorType& type : kIntegratorTypes) {
    if (type.name == node.type) return type.read(context, object);
    names.push_back(type.name);
  }
  object.refuse_type(names);
}

uint64_t read_sampler(ReadContext& context, Node& node) {
  const ObjectReader object(node);
  const std::vector<std::string_view> kMapped = {"stratified", "multijitter", "orthogonal", "ldsampler",
                                                 "halton",     "sobol",       "hammersley"};
  const bool mapped = std::find(kMapped.begin(), kMapped.end(), node.type) != kMapped.end();
  if (!mapped && node.type != "independent") {
    object.refuse_type({"independent", "stratified", "multijitter", "orthogonal", "ldsampler", "halton",
                        "sobol", "hammersley"});
  }
  const int64_t samples = positive(object, "sample_count", 4, kMaxSamples);
  if (object.has("seed")) {
    object.get_int("seed", 0);
    note(context.sink, object.value_place("seed").position(),
         object.label() + ": 'seed' has no meaning here: use --seed");
  }
  if (node.type == "stratified" || node.type == "multijitter" || node.type == "orthogonal")
    object.get_bool("jitter", true);
  if (node.type == "orthogonal") count(object, "strength", 2);
  if (node.legacy) accept_obsolete(context, object, {"dimension", "scramble"});
  if (mapped) {
    note(context.sink, node.type_place.position(),
         "sampler type '" + node.type + "' is replaced by the program's own (--sampler)");
  }
  object.finish();
  return static_cast<uint64_t>(samples);
}

}  // namespace kiloband
