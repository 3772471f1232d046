#include <cmath>

#include "stats/comparison/comparison_json.hpp"
#include "validation/suite/results.hpp"

namespace kiloband::validation {
namespace {

using nlohmann::json;

constexpr auto number = stats::number_json;

/// Six digits are plenty for plots. Infinite t (no noise, yet a difference) must not look like none: 1e30.
template <class Values>
json rounded(const Values& values) {
  json out = json::array();
  for (const double value : values) {
    char text[32];
    std::snprintf(text, sizeof text, "%.6g", std::isinf(value) ? std::copysign(1e30, value) : value);
    out.push_back(std::isnan(value) ? json(nullptr) : json(std::strtod(text, nullptr)));
  }
  return out;
}

json to_json(const stats::Detectable& d) {
  return {{"typical", number(d.typical)},
          {"best", number(d.best)},
          {"largest", number(d.largest)},
          {"largest_channel", d.largest_channel}};
}

json to_json(const stats::TestVerdict& v) {
  json out{{"name", v.name},
           {"p", number(v.p)},
           {"level", number(v.level)},
           {"passed", v.passed},
           {"detectable", to_json(v.detectable)}};
  if (v.worst) out["worst"] = stats::to_json(*v.worst);
  return out;
}

json to_json(const stats::PooledVariance& v) {
  return {{"ratio", number(v.ratio)},
          {"log_error", number(v.log_error)},
          {"ratio_all", number(v.ratio_all)},
          {"log_error_all", number(v.log_error_all)},
          {"p", number(v.p)},
          {"entries", v.entries},
          {"skipped", v.skipped}};
}

json to_json(const stats::ScaleResult& s) {
  return {{"columns", s.columns},       {"rows", s.rows},
          {"units", s.units},           {"pooled_units", s.pooled_units},
          {"tested", s.entries.tested}, {"constant", s.entries.constant},
          {"thin", s.entries.thin},     {"unsampled", s.entries.unsampled},
          {"p", number(s.p)},           {"t_map", rounded(s.t_map)}};
}

json tails_to_json(const std::vector<stats::TailWeight>& tails) {
  return stats::heaviest_json(tails, {"count", "top_variance", "top_sum"});
}

const char* name_of(Pairing::Kind kind) {
  return kind == Pairing::Kind::kClosedForm ? "closed form"
         : kind == Pairing::Kind::kPaired   ? "paired"
                                            : "independent";
}

json to_json(const PairingResult& r) {
  const stats::Comparison& c = r.comparison;
  json out{{"kind", name_of(r.pairing.kind)},
           {"a", r.pairing.a.label()},
           {"passed", r.passed},
           {"attempts", r.attempts},
           {"level", number(r.level)},
           {"first_p", number(r.first_p)},
           {"samples", r.samples},
           {"replicates", c.replicates_a},
           {"invalid_samples", r.invalid_samples},
           {"seconds_a", number(r.seconds_a)},
           {"image_a", rounded(c.image_a)},
           {"image_b", rounded(c.image_b)},
           {"image_error", rounded(c.image_error)},
           {"tails_a", tails_to_json(c.tails_a)},
           {"notes", c.notes}};
  out["b"] = r.pairing.kind == Pairing::Kind::kClosedForm ? json("closed form") : json(r.pairing.b.label());
  if (r.pairing.kind != Pairing::Kind::kClosedForm) {
    out["seconds_b"] = number(r.seconds_b);
    out["tails_b"] = tails_to_json(c.tails_b);
  }
  for (const stats::TestVerdict& v : c.tests) out["tests"].push_back(to_json(v));
  for (const stats::ScaleResult& s : c.means) out["means"].push_back(to_json(s));
  if (c.pooled_variance) out["pooled_variance"] = to_json(*c.pooled_variance);
  if (c.pooled_scatter) out["pooled_scatter"] = to_json(*c.pooled_scatter);
  if (c.uniform_pixels) out["p_values"] = rounded(c.uniform_pixels->p_values);
  return out;
}

json to_json(const CaseResult& c) {
  json out{{"name", c.what.name},
           {"what", c.what.what},
           {"scene", c.what.scene.file.filename().string()},
           {"passed", c.passed},
           {"interrupted", c.interrupted},
           {"width", c.width},
           {"height", c.height},
           {"triangles", c.triangles},
           {"pairings", json::array()},
           {"cubes", json::array()}};
  if (!c.error.empty()) out["error"] = c.error;
  for (const Channel& channel : c.channels) out["channels_nm"].push_back({channel.min_nm, channel.max_nm});
  for (const PairingResult& r : c.pairings) out["pairings"].push_back(to_json(r));
  for (const SideImage& side : c.images)
    out["cubes"].push_back({{"side", side.label}, {"file", cube_name(c, side) + ".hdr"}});
  return out;
}

json to_json(const HardCaseResult& h) {
  json out{{"name", h.name},
           {"what", h.what},
           {"backend", h.backend},
           {"passed", h.passed},
           {"figures", json::array()}};
  if (!h.error.empty()) out["error"] = h.error;
  for (const HardFigure& f : h.figures) {
    out["figures"].push_back({{"name", f.name},
                              {"unit", f.unit},
                              {"value", number(f.value)},
                              {"reference", number(f.reference)},
                              {"error", number(f.error)},
                              {"limit", number(f.limit)},
                              {"passed", f.pass},
                              {"note", f.note}});
  }
  return out;
}

json to_json(const ConvergenceResult& c) {
  json out{{"name", c.name},
           {"passed", c.passed},
           {"interrupted", c.interrupted},
           {"note", c.note},
           {"curves", json::array()}};
  for (const ConvergenceCurve& curve : c.curves) {
    json points = json::array();
    for (const ConvergencePoint& p : curve.points) {
      points.push_back({{"samples", p.samples},
                        {"relative_error", number(p.relative_error)},
                        {"seconds", number(p.seconds)},
                        {"efficiency", number(p.efficiency())}});
    }
    out["curves"].push_back({{"configuration", curve.configuration.label()},
                             {"points", points},
                             {"slope", number(curve.slope)},
                             {"slope_error", number(curve.slope_error)}});
  }
  return out;
}

json to_json(const MitsubaResult& m) {
  json out = m.record.is_object() ? m.record : json::object();
  out["scenes"] = json::array();
  for (const MitsubaScene& s : m.scenes) {
    json& scene = out["scenes"].emplace_back(s.entry.is_object() ? s.entry : json::object());
    scene.update({{"name", s.name}, {"backend", s.backend}, {"passed", s.passed}});
    if (!s.passed) scene["failure"] = s.failure;
  }
  return out;
}

}  // namespace

nlohmann::json to_json(const SuiteResult& result, const RunRecord& record) {
  const SuiteSettings& s = result.settings;
  json out{{"format", "kiloband validation 1"},
           {"program", record.program},
           {"processor", record.processor},
           {"date", record.date},
           {"backends", record.backends},
           {"effort", name_of(s.effort)},
           {"seed", s.seed},
           {"comparisons", result.comparisons},
           {"rate_first", s.rule.first},
           {"rate_again", s.rule.again},
           {"rate", kRunRate},
           {"rate_hard_cases", kHardFamilyRate},
           {"rate_convergence", kConvergenceRate},
           {"rate_mitsuba", kMitsubaRate},
           {"seconds", result.seconds},
           {"passed", result.passed()},
           {"interrupted", result.interrupted},
           {"cases", json::array()},
           {"hard_cases", json::array()},
           {"convergence", json::array()}};
  for (const CaseResult& c : result.cases) out["cases"].push_back(to_json(c));
  for (const HardCaseResult& h : result.hard_cases) out["hard_cases"].push_back(to_json(h));
  for (const ConvergenceResult& c : result.convergence) out["convergence"].push_back(to_json(c));
  if (!result.mitsuba.scenes.empty()) out["mitsuba"] = to_json(result.mitsuba);
  return out;
}

}  // namespace kiloband::validation
