#include "render/checkpoint/fingerprint.hpp"

#include "base/hash.hpp"
#include "spectral/channel_knots.hpp"

namespace kiloband {
namespace {

void add_text(WordHash& hash, const std::string& text) {
  hash.add_value(text.size());
  hash.add({text.data(), text.size()});
}

void add_absorption(WordHash& hash, const ChannelKnots& knots) {
  hash.add_all(knots.first);
  hash.add_all(knots.mu);
  hash.add_all(knots.value);
}
void add_channels(WordHash& hash, const ChannelList& channels) {
  hash.add_value(channels.size());
  for (const Channel& channel : channels) {
    hash.add_value(channel.min_nm);
    hash.add_value(channel.max_nm);
  }
}

void add_spectra(WordHash& hash, const std::vector<SpectrumRow>& spectra) {
  for (const SpectrumRow& row : spectra) {
    hash.add_all(row.table.values);
    for (const double v : {row.table.min_nm, row.table.step_nm, row.temperature_k, row.planck_scale,
                           row.planck_min_nm, row.planck_max_nm}) {
      hash.add_value(v);
    }
    hash.add_value(row.is_planck);
    hash.add_value(row.is_emission);
    hash.add_value(row.table.extrapolate);
    if (row.absorption) add_absorption(hash, *row.absorption);
  }
}

void add_spectral_textures(WordHash& hash, const FlatScene& scene) {
  for (const BandSet& set : scene.band_sets) {
    hash.add_all(set.centres_nm);
    for (const double value : {set.min_nm, set.max_nm, set.scale}) hash.add_value(value);
    hash.add_value(set.extrapolate);
  }
  for (const SpectralTexels& texels : scene.spectral_texels)
    if (texels) hash.add_all(*texels);
}

/// Media, what is inside which shape, and where rays begin.
void add_gas(WordHash& hash, const FlatScene& scene) {
  hash.add_all(scene.media);
  hash.add_all(scene.plume_nodes);
  hash.add_all(scene.interiors);
  hash.add_value(scene.atmosphere);
  hash.add_value(scene.camera_media);
}

/// Materials, and the shapes that have them.
void add_surfaces(WordHash& hash, const FlatScene& scene) {
  hash.add_all(scene.textures);
  hash.add_all(scene.texels);
  hash.add_all(scene.texel_bounds);
  add_spectral_textures(hash, scene);
  hash.add_all(scene.checkerboards);
  hash.add_all(scene.materials);
  hash.add_all(scene.thermals);
  hash.add_all(scene.tables);
  hash.add_all(scene.bumps);
  hash.add_all(scene.roughness);
  hash.add_all(scene.principled_maps);
  hash.add_all(scene.surfaces);
  hash.add_all(scene.shapes);
  hash.add_all(scene.positions);
  hash.add_all(scene.normals);
  hash.add_all(scene.uvs);
  hash.add_all(scene.triangles);
}

/// Lights, gas, the camera, and how far paths go.
void add_rays(WordHash& hash, const FlatScene& scene) {
  hash.add_all(scene.emitters);
  hash.add_all(scene.emitter_cdf);
  hash.add_all(scene.light_nodes);
  hash.add_all(scene.tree_lights);
  add_gas(hash, scene);
  hash.add_value(scene.origin);
  hash.add_value(scene.camera);
  hash.add_all(scene.filter_cells);
  for (const uint32_t value :
       {scene.film.crop_x, scene.film.crop_y, scene.film.crop_width, scene.film.crop_height}) {
    hash.add_value(value);
  }
  hash.add_value(scene.integrator.max_depth);
  hash.add_value(scene.integrator.rr_depth);
  hash.add_value(scene.integrator.hide_emitters);
}

void add_sampling(WordHash& hash, const SamplingSettings& sampling) {
  hash.add_value(sampling.seed);
  hash.add_value(sampling.replicates);
  hash.add_value(static_cast<int>(sampling.sampler));
  hash.add_value(static_cast<int>(sampling.rough_dispersion));
  hash.add_value(static_cast<int>(sampling.wavelengths));
}

void add_derived(WordHash& hash, const DerivedChannels& derived) {
  for (const std::string& name : derived.names) add_text(hash, name);
  for (const RegularTable& response : derived.responses) {
    hash.add_all(response.values);
    hash.add_value(response.min_nm);
    hash.add_value(response.step_nm);
    hash.add_value(response.extrapolate);
  }
}

}  // namespace

std::string arithmetic_of(const Backend& backend) {
  const BackendInfo info = backend.info();
  if (info.name == "cpu") return info.isa;
  return info.isa + ", " + info.device + ", " + info.method;
}

uint64_t render_fingerprint(const FlatScene& scene, const SamplingSettings& sampling,
                            const std::string& arithmetic, const DerivedChannels& derived) {
  WordHash hash;
  add_channels(hash, scene.channels);
  add_channels(hash, scene.guide);
  add_spectra(hash, scene.spectra);
  add_surfaces(hash, scene);
  add_rays(hash, scene);
  add_sampling(hash, sampling);
  add_text(hash, arithmetic);
  add_derived(hash, derived);
  return hash.value();
}

}  // namespace kiloband
