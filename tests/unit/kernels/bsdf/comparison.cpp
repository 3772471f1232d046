#include "comparison.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

namespace kiloband::test {
namespace {

constexpr double kRounding = 2e-6;

glm::dvec3 vector_of(const float* v) {
  return {v[0], v[1], v[2]};
}

/// Relative allowance for F and for 1 - F. eta: far over near index
double fresnel_noise(double cos_i, double eta) {
  if (eta == 1) return 0;
  const double sin2 = (1 - cos_i * cos_i) / (eta * eta);
  if (sin2 >= 1) return 0;  // total reflection, exactly
  const double cos_t = std::sqrt(1 - sin2);
  const double s = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
  const double p = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
  const double f = 0.5 * (s * s + p * p);
  return 5e-7 / std::sqrt(std::max(f, 1e-12)) + 1e-6 / std::max(1 - f, 1e-12);
}

/// Relative allowance for everything that is proportional to the BSDF or a density.
double allowance(const KbMaterial& m, const Query& query, glm::dvec3 wo) {
  const glm::dvec3 wi = vector_of(query.wi);
  double eta = m.flags & KB_MATERIAL_DISPERSIVE && query.dispersion_eta > 0 ? query.dispersion_eta : m.eta;
  if (wi.z < 0 && !(m.flags & KB_MATERIAL_THIN)) eta = 1 / eta;  // panes: outside on both sides
  const glm::dvec3 sum = wi.z * wo.z > 0 ? wi + wo : wi + eta * wo;
  const double dot = std::min(std::abs(glm::dot(wi, sum)) / std::max(glm::length(sum), 1e-20), 1.0);
  switch (m.type) {
    case KB_MATERIAL_DIELECTRIC:
      return kRounding + fresnel_noise(std::abs(wi.z), eta);
    case KB_MATERIAL_PLASTIC:
      return kRounding + fresnel_noise(wi.z, eta) + fresnel_noise(wo.z, eta);
    case KB_MATERIAL_ROUGH_DIELECTRIC:  // the last: where it acts as a smooth one
      return kRounding + fresnel_noise(dot, eta) + fresnel_noise(std::abs(wi.z), eta);
    case KB_MATERIAL_ROUGH_PLASTIC:
      return kRounding + fresnel_noise(dot, eta);
    case KB_MATERIAL_PRINCIPLED:  // the first power of the lobes' probabilities has Fresnel's factor of wi
      return 2 * kRounding + fresnel_noise(dot, eta) + fresnel_noise(std::abs(wi.z), m.eta);
    default:
      return kRounding;
  }
}

void expect_close(double cpu, double device, double relative, const char* what, const std::string& where) {
  // Below 1e-30 nothing carries light; there denormals round coarsely.
  EXPECT_LE(std::abs(cpu - device), relative * std::abs(cpu) + 1e-30)
      << what << ": CPU " << cpu << ", device " << device << "; " << where;
}

std::string located(const KbMaterial& material, const Query& q) {
  std::string text = describe(material);
  for (const float x : {q.wi[0], q.wi[1], q.wi[2], q.wo[0], q.wo[1], q.wo[2], q.u_lobe, q.u[0], q.u[1]})
    text += fmt::format(" {:.9g}", x);
  return text;
}

/// Upper bound of the throughput factor: weights times the bounds of the spectra they go with, without the
/// radiance scaling of transmission.
double expected_bound(const KbMaterial& m, const Sample& s) {
  if (s.kind == KB_KIND_TWO_TERM) return double(s.w0) * m.bound_a + double(s.w1) * m.bound_b;
  if (s.kind == KB_KIND_TINTED) {
    const double second = s.w1 < 0 ? -s.w1 * std::sqrt(double(m.bound_a)) : double(s.w1);
    return (double(s.w0) * m.bound_a + second) * s.eta * s.eta;
  }
  if (s.kind == KB_KIND_NONLINEAR)
    return double(s.w0) * m.bound_a + double(s.w1) * m.bound_b / (1 - double(m.bound_b) * (1 - m.escape));
  return double(s.w0) * s.eta * s.eta * (s.flags & kLobeB ? m.bound_b : m.bound_a);
}

}  // namespace

void Comparison::check_value(const Query& query, const Value& cpu, const Value& device) {
  const KbMaterial& m = scene_.material(query.material);
  if ((cpu.pdf > 0) != (device.pdf > 0) || cpu.lobe_b != device.lobe_b) {
    ++decisions_;
    return;
  }
  const std::string where = located(m, query);
  const double relative = allowance(m, query, vector_of(query.wo));
  expect_close(cpu.w0, device.w0, relative, "w0", where);
  expect_close(cpu.w1, device.w1, relative, "w1", where);
  expect_close(cpu.pdf, device.pdf, relative, "pdf", where);
}

void Comparison::check_sample(const Query& query, const Sample& cpu, const Sample& device, bool transmitted) {
  const KbMaterial& m = scene_.material(query.material);
  if (transmitted && (cpu.pdf > 0) != (device.pdf > 0)) {
    // F rounds to 1 on one side only: what the other lets through is below the rounding of 1 - F.
    const Sample& some = cpu.pdf > 0 ? cpu : device;
    EXPECT_LT(some.w0 * some.eta * some.eta * query.probability, 1e-6) << located(m, query);
    return;
  }
  if ((cpu.pdf > 0) != (device.pdf > 0) || cpu.flags != device.flags || cpu.kind != device.kind) {
    ++decisions_;
    return;
  }
  if (!(cpu.pdf > 0)) return;
  const std::string where = located(m, query);
  const glm::dvec3 wo = vector_of(device.wo);
  const double distance = glm::length(vector_of(cpu.wo) - wo);
  far_ += distance > 1e-5;
  EXPECT_LT(distance, 1e-3) << where;
  Sample expected = cpu;
  if (!(cpu.flags & kDelta)) {
    const BsdfValue value = eval_bsdf(scene_.context(query), glm::vec3(vector_of(query.wi)), glm::vec3(wo));
    expected.pdf = value.pdf;
    expected.w0 = value.w0 / value.pdf;
    expected.w1 = cpu.kind == KB_KIND_CONDUCTOR ? value.w1 : value.w1 / value.pdf;
  }
  const double channel_eta = query.wi[2] < 0 ? 1.0 / query.dispersion_eta : query.dispersion_eta;
  const double relative = transmitted ? kRounding + fresnel_noise(std::abs(double(query.wi[2])), channel_eta)
                                      : allowance(m, query, wo);
  expect_close(expected.pdf, device.pdf, transmitted ? 0 : relative, "sample's pdf", where);
  // Fresnel's factor is both in the value of a rough dielectric and in the density: it cancels.
  const bool cancels = m.type == KB_MATERIAL_ROUGH_DIELECTRIC && !transmitted;
  expect_close(expected.w0, device.w0, cancels ? kRounding : relative, "sample's w0", where);
  expect_close(expected.w1, device.w1, relative, "sample's w1", where);
  EXPECT_EQ(cpu.eta, device.eta) << where;
  if (!(cpu.flags & kNeedsChannel))
    expect_close(expected_bound(m, device), device.bound, 1e-6, "bound", where);
}

void Comparison::check(const std::vector<Query>& queries, const Answers& cpu, const Answers& device) {
  ASSERT_EQ(device.values.size(), queries.size());
  decisions_ = far_ = 0;
  for (std::size_t i = 0; i < queries.size() && !::testing::Test::HasFailure(); ++i) {
    check_value(queries[i], cpu.values[i], device.values[i]);
    check_sample(queries[i], cpu.samples[i], device.samples[i], false);
    check_sample(queries[i], cpu.transmitted[i], device.transmitted[i], true);
    EXPECT_EQ(cpu.kinds[i], device.kinds[i]) << describe(scene_.material(queries[i].material));
  }
  const int allowed = static_cast<int>(1e-4 * static_cast<double>(queries.size()));
  EXPECT_LE(decisions_, allowed) << "decisions differ, of " << queries.size() << " queries";
  EXPECT_LE(far_, allowed) << "directions are 1e-5 apart, of " << queries.size() << " queries";
}

}  // namespace kiloband::test
