// FlatScene: the scene as plain arrays of the records in shared/records.h; what every backend renders.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "scene/compile/scene_features.hpp"
#include "scene/description/description.hpp"
#include "shared/light_tree.h"
#include "shared/pipeline.h"
#include "shared/records.h"
#include "shared/thermal.h"
#include "spectral/channel_knots.hpp"
#include "spectral/channels.hpp"
#include "spectral/spectrum.hpp"

namespace kiloband {

/// One row of the spectrum table.
struct SpectrumRow {
  std::string name;        // where it comes from, for messages
  RegularTable table;      // reflectances, indices, tabulated emission
  bool is_planck = false;  // then: planck_scale * planck_radiance(lambda, temperature_k) on [min_nm, max_nm],
                           // times the table if that is not empty (an emissivity)
  double temperature_k = 0, planck_scale = 1, planck_min_nm = 0, planck_max_nm = 1e300;
  std::shared_ptr<const ChannelKnots> absorption;  // a gas's, 1/m: then `table` is empty
  bool is_emission = false;                        // values are divided by the channel's scale
  float bound = 0;                                 // upper bound over guide bands and rendered channels
};

/// Importance sampling of an environment map, piecewise constant in (u, v) for each facing of receivers (shared/environment.h):
/// scene/compile/light/envmap_sampling.hpp. Cells form regions of 2^shift cells along their edges, at the map's ends fewer.
struct EnvmapSampling {
  uint32_t width = 0, height = 0;  // cells
  uint32_t column_shift = 0, row_shift = 0;
  std::vector<float> facing_cdf;  // by facing: of the rows of regions, then of each row's regions
  std::vector<float> row_cdf;     // by region: of its 2^row_shift rows of cells
  std::vector<float> column_cdf;  // by row of cells and column of regions: of 2^column_shift cells

  uint32_t regions_across() const { return ((width - 1) >> column_shift) + 1; }
  uint32_t regions_down() const { return ((height - 1) >> row_shift) + 1; }
};

/// The wavelengths of spectral texels (KB_TEXTURE_BANDS): a texel's spectrum is linear between band centres,
/// constant from the outer centres to the outermost edges, and beyond these 0, or continued if `extrapolate`.
struct BandSet {
  std::vector<double> centres_nm;  // ascending
  double min_nm = 0, max_nm = 0;   // outermost edges
  bool extrapolate = false;
  bool is_emission = false;  // values are divided by the channel's scale
  double scale = 1;          // multiplies all values
};

/// The numbers of spectral texels, [y][x][value]; shared with the image that they were read from.
using SpectralTexels = std::shared_ptr<const std::vector<float>>;

/// Meshes that are stored once and stand in the scene where instances put them.
struct MeshGroup {
  uint32_t
      first_shape;  // its shapes in the first instance: KB_SHAPE_INSTANCED, their triangles are the group's
  uint32_t shape_count;
};
struct MeshInstance {
  uint32_t group;
  uint32_t first_shape;  // as many as the group has; all with the instance's matrices
};

/// The flattened scene. Positions and normals carry one spare vertex at the end, triangles a spare index: triples are
/// read with 16-byte loads.
struct FlatScene {
  ChannelList channels;  // K rendered channels
  ChannelList guide;     // guide bands
  std::vector<double>
      channel_scale;  // K powers of two; emission rows are divided by it, the film multiplies by it

  std::vector<SpectrumRow> spectra;  // at most 65535
  /// Means of reflectances over bins of channels, [spectrum][KB_CHANNEL_BINS]; empty without dispersion.
  std::vector<float> channel_bins;
  uint32_t unit_row = KB_NONE;  // a reflectance of 1, where the scene needs one (rough dispersive boundaries)
  std::vector<KbTexture> textures;
  std::vector<KbFloat4> texels;
  std::vector<float> texel_bounds;  // per texel: upper bound of its spectrum over guide bands and channels
  std::vector<BandSet> band_sets;
  std::vector<SpectralTexels>
      spectral_texels;  // by texture; null for others; may end before the last texture
  std::vector<KbCheckerboard> checkerboards;

  std::vector<KbMaterial> materials;
  std::vector<KbBump> bumps;           // by material
  std::vector<KbRoughness> roughness;  // by material
  /// [material][KB_PRINCIPLED_MAPPED]: bitmap references, or KB_NONE for the number; empty without principled materials.
  std::vector<uint32_t> principled_maps;
  std::vector<KbSurface> surfaces;
  std::vector<KbThermal> thermals;
  std::vector<float> tables;  // what KbMaterial::table, KbThermal::table and field_offset refer to
  std::vector<KbShape> shapes;
  std::vector<MeshGroup> groups;
  std::vector<MeshInstance> instances;  // in ascending order of their shapes
  std::vector<std::string> shape_names, material_names;
  std::vector<KbFloat3> positions;  // m: world, or of instanced meshes their own
  std::vector<KbFloat3> normals;    // world, unit; zero where a shape has none; empty if no shape has
  std::vector<KbFloat2> uvs;        // empty if no shape has
  std::vector<uint32_t> triangles;  // 3 absolute vertex indices each
  std::vector<float> area_cdf;      // see KbShape::first_cdf, lattice_cdf.hpp

  std::vector<KbMedium> media;
  std::vector<std::string> medium_names;
  std::vector<KbFloat2> plume_nodes;  // temperature (K) and scale, see KbMedium::first_node
  std::vector<uint32_t> interiors;    // by shape: the medium inside, or KB_NONE; empty without gas
  uint32_t atmosphere = KB_NONE;      // the medium outside all interiors
  std::array<uint16_t, KB_MEDIUM_DEPTH> camera_media{};  // where rays begin: as KbGasState::inside

  std::vector<KbEmitter> emitters;
  std::vector<std::string> emitter_names;  // an area light's is its shape's; empty: without id
  /// What selects an emitter: emitters + 1 entries, 0 to 1, see lattice_cdf.hpp. With a light tree its share comes first, that
  /// of all its emitters, which have none of their own: emitters + 2 entries.
  std::vector<float> emitter_cdf;
  std::vector<KbLightNode> light_nodes;    // the light tree; empty: lights are chosen by power alone
  std::vector<KbTreeLight> tree_lights;    // in the order of the emitters and of the triangles of meshes
  std::vector<uint32_t> first_tree_light;  // by emitter; empty without a tree
  uint32_t environment = KB_NONE;          // emitter index of the constant or envmap emitter
  uint32_t first_sun = KB_NONE;            // the emitters from here on are KB_EMITTER_SUN; KB_NONE: none is
  EnvmapSampling envmap;
  /// Where the coordinates of all of this begin, in the scene file's: 0 unless it is far.
  std::array<double, 3> origin{};
  float scene_radius = 0;  // bounding sphere of the geometry, m

  KbCamera camera{};
  std::vector<float> filter_cells;  // SignedFilter::cells of KB_FILTER_TABULATED, else empty
  double filter_scale = 1;          // SignedFilter::scale: the film multiplies by it
  Film film;                        // crop window; channels as in `channels`
  Integrator integrator;
  SceneFeatures features;
};

struct CompileOptions {
  ChannelList channels;  // rendered channels, not empty
  ChannelList guide;     // empty: the rendered channels
  DiagnosticSink sink;
};

/// A complete scene: whoever renders it reads it and changes nothing, so that backends share it.
/// throws InputError for what cannot be rendered in these channels (no data, more than 65535 spectra ...)
std::shared_ptr<const FlatScene> compile_scene(const SceneDescription& scene, const CompileOptions& options);
/// The same for who moves the camera between renders: move_camera(), and Backend::camera_moved() of all who render it.
std::shared_ptr<FlatScene> compile_scene_to_move(const SceneDescription& scene,
                                                 const CompileOptions& options);

/// The scene seen by another sensor, of the same kind and filter: what compile_scene() would have made of it.
/// The film's size may be another, too; scene.film stays as it is.
/// throws InputError  a place or size that single precision cannot take
void move_camera(FlatScene& scene, const Sensor& sensor);

}  // namespace kiloband
