// <integrator> and <sampler>.
#include <algorithm>

#include "scene/read/context.hpp"
#include "scene/xml/values.hpp"

namespace kiloband {
namespace {

constexpr int64_t kMaxDepth = 1'000'000;
constexpr int64_t kMaxCount = int64_t{1} << 32;  // samples per pixel

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

/// Mitsuba's integrator around another, which adds an image of second moments.
/// Its first image is that of the nested one.
std::pair<Integrator, uint64_t> read_moment(ReadContext& context, const ObjectReader& object) {
  Node* nested = object.nested_one("integrator");
  if (!nested) object.fail_here("needs a nested integrator");
  object.get_bool("hide_emitters", false);  // without effect in Mitsuba: the nested one has its own
  object.finish();
  note(
      context.sink, object.node().type_place.position(),
      object.label() +
          ": read as the integrator in it: second moments are not written, --variance writes the variance of "
          "the mean");
  return read_integrator(context, *nested);
}

}  // namespace

std::pair<Integrator, uint64_t> read_integrator(ReadContext& context, Node& node) {
  const ObjectReader object(node);
  if (node.type == "moment") return read_moment(context, object);
  Integrator integrator;
  uint64_t splitting = 1;
  if (node.type == "direct") {
    integrator.max_depth = 2;
    splitting = direct_splitting(object);
  } else if (node.type == "path" || node.type == "volpath" || node.type == "volpathmis") {
    integrator = read_path(object);
  } else {
    object.refuse_type({"path", "direct", "volpath", "volpathmis", "moment"});
  }
  integrator.hide_emitters = object.get_bool("hide_emitters", false);
  object.finish();
  return {integrator, splitting};
}

uint64_t read_sampler(ReadContext& context, Node& node) {
  const ObjectReader object(node);
  const std::vector<std::string_view> kMapped = {"stratified", "multijitter", "orthogonal",
                                                 "ldsampler",  "halton",      "sobol"};
  const bool mapped = std::find(kMapped.begin(), kMapped.end(), node.type) != kMapped.end();
  if (!mapped && node.type != "independent") {
    object.refuse_type(
        {"independent", "stratified", "multijitter", "orthogonal", "ldsampler", "halton", "sobol"});
  }
  const int64_t samples = positive(object, "sample_count", 4, kMaxCount);
  if (object.has("seed")) {
    object.get_int("seed", 0);
    note(context.sink, object.value_place("seed").position(),
         object.label() + ": 'seed' has no meaning here: use --seed");
  }
  if (node.type == "stratified" || node.type == "multijitter" || node.type == "orthogonal")
    object.get_bool("jitter", true);
  if (node.legacy) accept_obsolete(context, object, {"dimension"});
  if (mapped) {
    note(context.sink, node.type_place.position(),
         "sampler type '" + node.type + "' is replaced by the program's own (--sampler)");
  }
  object.finish();
  return static_cast<uint64_t>(samples);
}

}  // namespace kiloband
