#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <numbers>

#include "scene/compile/flattener.hpp"
#include "scene/compile/light/envmap_sampling.hpp"
#include "scene/compile/light/lattice_cdf.hpp"
#include "spectral/colour/colour.hpp"
#include "spectral/colour/rgb.hpp"
#include "spectral/planck.hpp"

namespace kiloband {
namespace {

/// Part of the selection probability that is uniform over emitters: a light that is dark in the guide bands
/// may shine in a rendered channel, and a delta light that is never selected would be lost.
constexpr double kUniformSelection = 0.05;
constexpr double kPi = std::numbers::pi;

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
  double sum = 2 * kPi * (1 - std::cos(beam));
  for (int i = 0; i < kSteps; ++i) {
    const double t = (i + 0.5) / kSteps;
    const double angle = beam + t * (cutoff - beam);
    sum += 2 * kPi * std::sin(angle) * (1 - t) * (cutoff - beam) / kSteps;
  }
  return sum;
}

/// A disc of constant radiance L gives a plane that faces its middle E = pi L sin^2 r, the integral of L cos over the
/// cone. Its solid angle is 2 pi (1 - cos r); 1 - cos r = 2 sin^2(r / 2) keeps the digits of small discs.
void set_disc(KbEmitter& record, double radius) {
  const double half = std::sin(0.5 * radius), whole = std::sin(radius);
  record.one_minus_cos = static_cast<float>(2 * half * half);
  record.scale = static_cast<float>(1 / (kPi * whole * whole));
}

bool is_sun(const Emitter& emitter) {
  const auto* directional = std::get_if<DirectionalEmitter>(&emitter.model);
  return directional && directional->angular_radius > 0;
}

}  // namespace

void set_emitter_transforms(KbEmitter& record, const Transform& to_world) {
  store_transform(to_world, record.to_world);
  store_transform(glm::inverse(to_world), record.to_object);
}

void Flattener::add_area_emitter(uint32_t shape_index) {
  const Shape& shape = in_.shapes[shape_index];
  const std::string name = fmt::format("emitter of {}", out_.shape_names[shape_index]);
  KbEmitter record{};
  record.type = KB_EMITTER_AREA;
  record.shape = shape_index;
  record.ref = reference(shape.emitter->radiance, {name + ": radiance", shape.emitter_position, true});
  set_emitter_transforms(record, Transform{1.0});
  out_.shapes[shape_index].emitter = static_cast<uint32_t>(out_.emitters.size());
  out_.emitters.push_back(record);
  out_.emitter_names.push_back(out_.shape_names[shape_index]);
  out_.features.area_light = true;

  const double factor = kPi * out_.shapes[shape_index].area;
  if (std::holds_alternative<std::shared_ptr<const SpectralBitmapTexture>>(shape.emitter->radiance)) {
    powers_.push_back(scaled_power(texture_colours_.at(record.ref & KB_REF_INDEX_MASK), factor));
    return;
  }
  Spectrum colour = illuminant_d65();
  double mean = 1;
  if (std::holds_alternative<std::shared_ptr<const MeshAttributeTexture>>(shape.emitter->radiance)) {
    colour = Spectrum::constant(1);
    mean = texture_means_[record.ref & KB_REF_INDEX_MASK];
  }
  if (const auto* spectrum = std::get_if<Spectrum>(&shape.emitter->radiance)) {
    colour = *spectrum;
  } else if (const auto* image =
                 std::get_if<std::shared_ptr<const BitmapTexture>>(&shape.emitter->radiance)) {
    if ((*image)->raw) colour = Spectrum::constant(1);
    mean = texture_means_[record.ref & KB_REF_INDEX_MASK];
  }
  powers_.push_back({colour, mean * factor});
}

Flattener::EmitterPower Flattener::scaled_power(const WeightedSpectra& colour, double factor) {
  EmitterPower power{colour.front().first, factor * colour.front().second, {}};
  for (std::size_t i = 1; i < colour.size(); ++i)
    power.more.emplace_back(colour[i].first, factor * colour[i].second);
  return power;
}

double Flattener::band_power(const EmitterPower& power, const Channel& band) {
  double sum = power.factor * power.spectrum.integral(band.min_nm, band.max_nm);
  for (const auto& [spectrum, factor] : power.more)
    sum += factor * spectrum.integral(band.min_nm, band.max_nm);
  return std::max(0.0, sum);
}

KbEmitter Flattener::make_emitter(const Emitter& emitter) {
  KbEmitter record{};
  const std::string name = describe(emitter);
  const double disc = kPi * out_.scene_radius * out_.scene_radius;
  const auto use = [&](const char* what) {
    return SpectrumSource{name + ": " + what, emitter.position, true};
  };
  set_emitter_transforms(record, Transform{1.0});
  if (const auto* constant = std::get_if<ConstantEmitter>(&emitter.model)) {
    record.type = KB_EMITTER_CONSTANT;
    record.ref = spectra_.row(constant->radiance, use("radiance"));
    powers_.push_back({constant->radiance, 4 * kPi * disc});
    out_.features.constant_light = true;
  } else if (const auto* envmap = std::get_if<EnvmapEmitter>(&emitter.model)) {
    add_environment_map(record, *envmap, use("envmap"));
  } else if (const auto* spectral = std::get_if<SpectralEnvmapEmitter>(&emitter.model)) {
    add_spectral_environment(record, *spectral, use("spectral_envmap"));
  } else if (const auto* point = std::get_if<PointEmitter>(&emitter.model)) {
    record.type = KB_EMITTER_POINT;
    record.ref = spectra_.row(point->intensity, use("intensity"));
    set_emitter_transforms(record, placed(glm::translate(Transform{1.0}, point->position)));
    powers_.push_back({point->intensity, 4 * kPi});
  } else if (const auto* spot = std::get_if<SpotEmitter>(&emitter.model)) {
    record.type = KB_EMITTER_SPOT;
    record.ref = spectra_.row(spot->intensity, use("intensity"));
    set_emitter_transforms(record, placed(spot->to_world));
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
    set_emitter_transforms(record, frame_along(directional.direction));
    if (directional.angular_radius > 0) set_disc(record, directional.angular_radius);
    powers_.push_back({directional.irradiance, disc});
  }
  return record;
}

/// Without an environment, what is seen past all shapes is a black body of the ambient temperature.
void Flattener::add_ambient_environment() {
  const double temperature_k = in_.ambient_temperature_k.value_or(0);
  if (out_.environment != KB_NONE || !(temperature_k > 0)) return;
  const Spectrum radiance = Spectrum::planck(temperature_k, 1);
  out_.environment = static_cast<uint32_t>(out_.emitters.size());
  out_.emitters.push_back(make_emitter({"ambient", in_.ambient_position, ConstantEmitter{radiance}}));
  out_.emitter_names.push_back("ambient");
}

void Flattener::add_emitters() {
  for (const Emitter& emitter : in_.emitters) {
    if (is_sun(emitter)) continue;
    const KbEmitter record = make_emitter(emitter);
    const bool environment = record.type == KB_EMITTER_CONSTANT || record.type == KB_EMITTER_ENVMAP;
    if (environment) out_.environment = static_cast<uint32_t>(out_.emitters.size());
    out_.features.delta_light |= !environment;
    out_.emitters.push_back(record);
    out_.emitter_names.push_back(emitter.id);
  }
  add_ambient_environment();
  add_suns();
}

/// Suns are the last emitters: rays that escape look at all of them.
void Flattener::add_suns() {
  const auto first = static_cast<uint32_t>(out_.emitters.size());
  for (const Emitter& emitter : in_.emitters) {
    if (!is_sun(emitter)) continue;
    if (out_.emitters.size() - first == KB_MOST_SUNS)
      throw InputError(emitter.position,
                       fmt::format("{}: more than {} directional emitters with an angular_radius",
                                   describe(emitter), KB_MOST_SUNS));
    out_.first_sun = first;
    out_.emitters.push_back(make_emitter(emitter));
    out_.emitter_names.push_back(emitter.id);
    out_.features.sun = true;
  }
}

void Flattener::add_environment_map(KbEmitter& record, const EnvmapEmitter& emitter,
                                    const SpectrumSource& use) {
  record.type = KB_EMITTER_ENVMAP;
  set_emitter_transforms(record, emitter.to_world);
  auto bitmap_texture = std::make_shared<BitmapTexture>();
  bitmap_texture->image = emitter.image;
  bitmap_texture->file = emitter.file;
  bitmap_texture->position = use.position;
  const uint32_t index = bitmap(bitmap_texture, BitmapUse::kEmission);
  record.ref = KB_REF_BITMAP | index;
  KbTexture& texture = out_.textures[index];
  texture.flags = KB_TEXTURE_ENVMAP;
  out_.features.envmap_light = true;

  // Selection and sampling weights: each texel's mean radiance is its colour's, up to the common D65 factor.
  const std::size_t count = std::size_t{texture.width} * texture.height;
  const std::vector<double> solid_angles = row_solid_angles(texture.height);
  std::vector<float> weights(count);
  double mean = 0;
  for (std::size_t i = 0; i < count; ++i) {
    KbFloat4& texel = out_.texels[texture.first_texel + i];
    texel.w *= static_cast<float>(emitter.scale);
    rgb_emission_peak_ = std::max(rgb_emission_peak_, double{texel.w});
    const std::size_t channels = emitter.image->channels;
    double value = 0;
    for (std::size_t c = 0; c < channels; ++c) value += emitter.image->pixels[channels * i + c];
    weights[i] = static_cast<float>(value * emitter.scale / static_cast<double>(channels));
    mean += weights[i] * solid_angles[i / texture.width];
  }
  mean /= static_cast<double>(count);
  out_.envmap = build_envmap_sampling(texture.width, texture.height, weights);
  powers_.push_back({illuminant_d65().scaled(mean), 4 * kPi * kPi * out_.scene_radius * out_.scene_radius});
}

void Flattener::select_emitters() {
  const std::size_t count = out_.emitters.size();
  check_lattice_items(count, {in_.file.string()}, "emitters of the scene");
  std::vector<double> votes(count, 0.0);
  for (const Channel& band : out_.guide) {
    std::vector<double> power(count);
    double total = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const EmitterPower& p = powers_[i];
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
  if (wants_light_tree()) {
    select_with_tree(votes);
    return;
  }
  out_.emitter_cdf = lattice_cdf(votes);
  for (std::size_t i = 0; i < count; ++i) {
    out_.emitters[i].select_pdf = out_.emitter_cdf[i + 1] - out_.emitter_cdf[i];  // exact
  }
}

/// shares: of the emitters, their sum 1.
void Flattener::select_with_tree(std::vector<double> shares) {
  for (std::size_t i = 0; i < shares.size(); ++i) out_.emitters[i].select_pdf = static_cast<float>(shares[i]);
  const double tree = add_light_tree(shares);
  shares.insert(shares.begin(), tree);
  out_.emitter_cdf = lattice_cdf(shares);
  for (std::size_t i = 0; i + 1 < shares.size(); ++i) {
    if (shares[i + 1] > 0) out_.emitters[i].select_pdf = out_.emitter_cdf[i + 2] - out_.emitter_cdf[i + 1];
  }
}

namespace {

/// Largest value of an emission row in a channel, W m^-2 sr^-1 nm^-1: at all knots of its table, and at five
/// wavelengths (Planck's law is smooth; emissivities count as 1).
double peak_in(const SpectrumRow& row, const Channel& channel) {
  double peak = 0;
  for (const double t : {0.0, 0.25, 0.5, 0.75, 1.0}) {
    const double lambda = (1 - t) * channel.min_nm + t * channel.max_nm;
    const bool inside = lambda >= row.planck_min_nm && lambda <= row.planck_max_nm;
    const double value = row.is_planck
                             ? (inside ? row.planck_scale * planck_radiance(lambda, row.temperature_k) : 0)
                             : row.table(lambda);
    peak = std::max(peak, value);
  }
  if (row.is_planck || row.table.values.empty()) return peak;
  const auto last = static_cast<double>(row.table.values.size() - 1);
  const double from = std::clamp((channel.min_nm - row.table.min_nm) / row.table.step_nm, 0.0, last);
  const double to = std::clamp((channel.max_nm - row.table.min_nm) / row.table.step_nm, 0.0, last);
  for (auto i = static_cast<std::size_t>(std::ceil(from)); i <= static_cast<std::size_t>(to); ++i) {
    peak = std::max(peak, row.table.values[i]);
  }
  return peak;
}

}  // namespace

/// The power of two below the largest channel value that an emission row or bitmap reaches: path sums are
/// then of order 1 however dim the channel is (Planck's law at 0.3 um and 200 K is 1e-96).
void Flattener::set_channel_scales() {
  out_.channel_scale.assign(out_.channels.size(), 1.0);
  for (std::size_t k = 0; k < out_.channels.size(); ++k) {
    const Channel& channel = out_.channels[k];
    double peak = raw_emission_peak_;
    for (std::size_t row = 0; row < out_.spectra.size(); ++row) {
      if (!out_.spectra[row].is_emission) continue;
      const double scale = row == d65_row_ ? std::max(1.0, rgb_emission_peak_) : 1.0;
      const auto weight = emission_row_factors_.find(static_cast<uint32_t>(row));
      const double largest = weight == emission_row_factors_.end() ? scale
                             : row == d65_row_                     ? std::max(scale, weight->second)
                                                                   : weight->second;
      peak = std::max(peak, largest * peak_in(out_.spectra[row], channel));
    }
    for (const Spectrum& spectrum : emission_peaks_)
      peak = std::max(peak, spectrum.max_over(channel.min_nm, channel.max_nm));
    for (const Heat& heat : heats_) {
      if (heat.field == KB_NONE) continue;
      for (const double nm : {channel.min_nm, channel.centre_nm(), channel.max_nm})
        peak = std::max(peak, planck_radiance(nm, heat.temperature_k));
    }
    if (peak > 0) out_.channel_scale[k] = std::exp2(std::floor(std::log2(peak * channel.width_nm())));
  }
}

}  // namespace kiloband
