#include "scene/compile/light/emitters.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <numbers>

#include "scene/compile/light/lattice_cdf.hpp"
#include "scene/compile/place.hpp"
#include "scene/compile/record_vectors.hpp"

namespace kiloband {
namespace {

/// Part of the selection probability that is uniform over emitters: a light that is dark in the guide bands
/// may shine in a rendered channel, and a delta light that is never selected would be lost.
constexpr double kUniformSelection = 0.05;

std::string describe(const Emitter& emitter) {
  return emitter.id.empty() ? "emitter" : "emitter '" + emitter.id + "'";
}

/// Some transform whose third column is the unit vector z.
Transform frame_along(const glm::dvec3& z) {
  const glm::dvec3 helper = std::abs(z.x) < 0.9 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
  const glm::dvec3 x = glm::normalize(glm::cross(helper, z));
  return {glm::dvec4(x, 0), glm::dvec4(glm::cross(z, x), 0), glm::dvec4(z, 0), glm::dvec4(0, 0, 0, 1)};
}

/// Solid angle of the spot weighted by its falloff, from the beam's cone to the cutoff linearly in angle.
double spot_solid_angle(double beam, double cutoff) {
  constexpr int kSteps = 256;
  double sum = 2 * std::numbers::pi * (1 - std::cos(beam));
  for (int i = 0; i < kSteps; ++i) {
    const double t = (i + 0.5) / kSteps;
    const double angle = beam + t * (cutoff - beam);
    sum += 2 * std::numbers::pi * std::sin(angle) * (1 - t) * (cutoff - beam) / kSteps;
  }
  return sum;
}

/// A disc of constant radiance L gives a plane that faces its middle E = pi L sin^2 r, the integral of L cos over the
/// cone. Its solid angle is 2 pi (1 - cos r); 1 - cos r = 2 sin^2(r / 2) keeps the digits of small discs.
void set_disc(KbEmitter& record, double radius) {
  const double half = std::sin(0.5 * radius), whole = std::sin(radius);
  record.one_minus_cos = static_cast<float>(2 * half * half);
  record.scale = static_cast<float>(1 / (std::numbers::pi * whole * whole));
}

bool is_sun(const Emitter& emitter) {
  const auto* directional = std::get_if<DirectionalEmitter>(&emitter.model);
  return directional && directional->angular_radius > 0;
}

}  // namespace

EmitterCompiler::EmitterCompiler(const CompileContext& context, TextureCompiler& textures,
                                 const ThermalCompiler& thermal)
    : in_(context.in), out_(context.out), spectra_(context.spectra), textures_(textures), thermal_(thermal) {}

void EmitterCompiler::add(const KbEmitter& record, const std::string& name) {
  out_.emitters.push_back(record);
  out_.emitter_names.push_back(name);
}

KbEmitter EmitterCompiler::make_emitter(const Emitter& emitter) {
  KbEmitter record{};
  const std::string name = describe(emitter);
  const double disc = std::numbers::pi * out_.scene_radius * out_.scene_radius;
  const auto use = [&](const char* what) {
    return SpectrumSource{name + ": " + what, emitter.position, true};
  };
  set_transforms(record, Transform{1.0});
  if (const auto* constant = std::get_if<ConstantEmitter>(&emitter.model)) {
    record.type = KB_EMITTER_CONSTANT;
    record.ref = spectra_.row(constant->radiance, use("radiance"));
    powers_.push_back({constant->radiance, 4 * std::numbers::pi * disc});
    out_.features.constant_light = true;
  } else if (const auto* envmap = std::get_if<EnvmapEmitter>(&emitter.model)) {
    add_environment_map(record, *envmap, use("envmap"));
  } else if (const auto* spectral = std::get_if<SpectralEnvmapEmitter>(&emitter.model)) {
    add_spectral_environment(record, *spectral, use("spectral_envmap"));
  } else if (const auto* point = std::get_if<PointEmitter>(&emitter.model)) {
    record.type = KB_EMITTER_POINT;
    record.ref = spectra_.row(point->intensity, use("intensity"));
    set_transforms(record, placed_at(out_.origin, glm::translate(Transform{1.0}, point->position)));
    powers_.push_back({point->intensity, 4 * std::numbers::pi});
  } else if (const auto* spot = std::get_if<SpotEmitter>(&emitter.model)) {
    record.type = KB_EMITTER_SPOT;
    record.ref = spectra_.row(spot->intensity, use("intensity"));
    set_transforms(record, placed_at(out_.origin, spot->to_world));
    record.cutoff_angle = static_cast<float>(spot->cutoff_angle);
    record.beam_width = static_cast<float>(spot->beam_width);
    const double solid_angle = spot_solid_angle(spot->beam_width, spot->cutoff_angle);
    if (spot->texture)
      add_spot_picture(record, *spot, solid_angle, use("texture"));
    else
      powers_.push_back({spot->intensity, solid_angle});
  } else if (const auto* projector = std::get_if<ProjectorEmitter>(&emitter.model)) {
    add_projector(record, *projector, use("irradiance"));
  } else {
    const auto& directional = std::get<DirectionalEmitter>(emitter.model);
    record.type = directional.angular_radius > 0 ? KB_EMITTER_SUN : KB_EMITTER_DIRECTIONAL;
    record.ref = spectra_.row(directional.irradiance, use("irradiance"));
    set_transforms(record, frame_along(directional.direction));
    if (directional.angular_radius > 0) set_disc(record, directional.angular_radius);
    powers_.push_back({directional.irradiance, disc});
  }
  return record;
}

/// Without an environment, what is seen past all shapes is a black body of the ambient temperature.
void EmitterCompiler::add_ambient_environment() {
  const double temperature_k = in_.ambient_temperature_k.value_or(0);
  if (out_.environment != KB_NONE || !(temperature_k > 0)) return;
  const Spectrum radiance = Spectrum::planck(temperature_k, 1);
  out_.environment = static_cast<uint32_t>(out_.emitters.size());
  add(make_emitter({"ambient", in_.ambient_position, ConstantEmitter{radiance}}), "ambient");
}

void EmitterCompiler::add_emitters() {
  for (const Emitter& emitter : in_.emitters) {
    if (is_sun(emitter)) continue;
    const KbEmitter record = make_emitter(emitter);
    const bool environment = record.type == KB_EMITTER_CONSTANT || record.type == KB_EMITTER_ENVMAP;
    if (environment) out_.environment = static_cast<uint32_t>(out_.emitters.size());
    out_.features.delta_light |= !environment;
    add(record, emitter.id);
  }
  add_ambient_environment();
  add_suns();
}

/// Suns are the last emitters: rays that escape look at all of them.
void EmitterCompiler::add_suns() {
  const auto first = static_cast<uint32_t>(out_.emitters.size());
  for (const Emitter& emitter : in_.emitters) {
    if (!is_sun(emitter)) continue;
    if (out_.emitters.size() - first == KB_MOST_SUNS)
      throw InputError(emitter.position,
                       fmt::format("{}: more than {} directional emitters with an angular_radius",
                                   describe(emitter), KB_MOST_SUNS));
    out_.first_sun = first;
    add(make_emitter(emitter), emitter.id);
    out_.features.sun = true;
  }
}

/// Each guide band has a vote. Their sum is 1.
std::vector<double> EmitterCompiler::shares_by_power() const {
  const std::size_t count = out_.emitters.size();
  std::vector<double> votes(count, 0.0);
  for (const Channel& band : out_.guide) {
    std::vector<double> power(count);
    double total = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const Power& p = powers_[i];
      const auto b = static_cast<std::size_t>(&band - out_.guide.data());
      power[i] = p.by_band.empty() ? band_power(p, band) : p.by_band[b];
      total += power[i];
    }
    if (!(total > 0) || !std::isfinite(total)) continue;
    for (std::size_t i = 0; i < count; ++i) votes[i] += power[i] / total;
  }
  double sum = 0;
  for (const double vote : votes) sum += vote;
  const double uniform = 1.0 / static_cast<double>(count);
  for (double& vote : votes) {
    vote = sum > 0 ? (1 - kUniformSelection) * vote / sum + kUniformSelection * uniform : uniform;
  }
  return votes;
}

void EmitterCompiler::select_emitters() {
  const std::size_t count = out_.emitters.size();
  check_lattice_items(count, {in_.file.string()}, "emitters of the scene");
  const std::vector<double> shares = shares_by_power();
  if (wants_light_tree()) {
    select_with_tree(shares);
    return;
  }
  out_.emitter_cdf = lattice_cdf(shares);
  for (std::size_t i = 0; i < count; ++i) {
    out_.emitters[i].select_pdf = out_.emitter_cdf[i + 1] - out_.emitter_cdf[i];  // exact
  }
}

/// shares: of the emitters, their sum 1.
void EmitterCompiler::select_with_tree(std::vector<double> shares) {
  for (std::size_t i = 0; i < shares.size(); ++i) out_.emitters[i].select_pdf = static_cast<float>(shares[i]);
  const double tree = add_light_tree(shares);
  shares.insert(shares.begin(), tree);
  out_.emitter_cdf = lattice_cdf(shares);
  for (std::size_t i = 0; i + 1 < shares.size(); ++i) {
    if (shares[i + 1] > 0) out_.emitters[i].select_pdf = out_.emitter_cdf[i + 2] - out_.emitter_cdf[i + 1];
  }
}

}  // namespace kiloband
