// What kernels read of a scene, from a FlatScene: the one list of which array goes where.
#pragma once

#include <algorithm>
#include <iterator>
#include <vector>

#include "film/filter_table.hpp"
#include "scene/compile/flat_scene.hpp"
#include "shared/pipeline.h"
#include "shared/sobol_table.h"
#include "src_gpu/device/kernel_groups.hpp"

namespace kiloband::opencl {

/// The gaussian filter's table; other filters read none.
inline std::vector<KbFloat2> filter_nodes(const KbCamera& camera) {
  if (camera.filter != KB_FILTER_GAUSSIAN) return {};
  return make_gaussian_filter_table(static_cast<double>(camera.filter_radius) / camera.filter_stddev);
}

inline std::vector<float> bounds_of_rows(const FlatScene& scene) {
  std::vector<float> bounds;
  for (const SpectrumRow& row : scene.spectra) bounds.push_back(row.bound);
  return bounds;
}

/// (x, y, z, 0)
inline std::vector<KbFloat4> with_fourth(const std::vector<KbFloat3>& values) {
  std::vector<KbFloat4> padded(values.size());
  std::ranges::transform(values, padded.begin(), [](const KbFloat3& v) {
    return KbFloat4{v.x, v.y, v.z, 0};
  });
  return padded;
}

inline std::vector<KbTriangle> device_triangles(const FlatScene& scene) {
  std::vector<KbTriangle> triangles(scene.triangles.size() / 3);
  for (std::size_t i = 0; i < triangles.size(); ++i)
    triangles[i] = {{scene.triangles[3 * i], scene.triangles[3 * i + 1], scene.triangles[3 * i + 2]}, 0};
  return triangles;
}

inline KbSceneConstants scene_constants(const FlatScene& scene) {
  KbSceneConstants c{};
  c.camera = scene.camera;
  c.channels = static_cast<uint32_t>(scene.channels.size());
  c.emitter_count = static_cast<uint32_t>(scene.emitters.size());
  c.environment = scene.environment;
  c.first_sun = std::min(scene.first_sun, c.emitter_count);
  c.max_depth = scene.integrator.max_depth < 0 ? KB_NONE : static_cast<uint32_t>(scene.integrator.max_depth);
  c.rr_depth = static_cast<uint32_t>(scene.integrator.rr_depth);
  c.hide_emitters = scene.integrator.hide_emitters ? 1 : 0;
  c.unit_row = scene.unit_row;
  c.envmap_width = scene.envmap.width;
  c.envmap_height = scene.envmap.height;
  c.envmap_row_shift = scene.envmap.row_shift;
  c.envmap_column_shift = scene.envmap.column_shift;
  c.atmosphere = scene.atmosphere;
  std::ranges::copy(scene.camera_media, c.camera_media);
  c.gas = scene.features.gas ? 1 : 0;
  c.instances = scene.features.instances ? 1 : 0;
  c.light_tree = scene.features.light_tree ? 1 : 0;
  return c;
}

/// All arrays of a scene but the values of spectral textures, whose many gigabytes go piece by piece.
/// up  (name, vector) -> Buffer<its type>
template <template <class> class Buffer, class Upload>
SceneArguments::Of<Buffer> scene_arguments(const FlatScene& scene, const Upload& up) {
  return {.constants = up("scene constants", std::vector{scene_constants(scene)}),
          .materials = up("materials", scene.materials),
          .bumps = up("bump maps", scene.bumps),
          .roughness = up("roughness", scene.roughness),
          .principled_maps = up("principled maps", scene.principled_maps),
          .tables = up("tables", scene.tables),
          .surfaces = up("surfaces", scene.surfaces),
          .shapes = up("shapes", scene.shapes),
          .textures = up("textures", scene.textures),
          .checkerboards = up("checkerboards", scene.checkerboards),
          .texels = up("texels", scene.texels),
          .texel_values = {},
          .texel_bounds = up("texel bounds", scene.texel_bounds),
          .spectrum_bounds = up("spectrum bounds", bounds_of_rows(scene)),
          .normals = up("normals", with_fourth(scene.normals)),
          .uvs = up("texture coordinates", scene.uvs),
          .positions = up("positions", with_fourth(scene.positions)),
          .triangles = up("triangles", device_triangles(scene)),
          .area_cdf = up("area distribution", scene.area_cdf),
          .emitters = up("emitters", scene.emitters),
          .emitter_cdf = up("emitter distribution", scene.emitter_cdf),
          .light_nodes = up("light tree", scene.light_nodes),
          .tree_lights = up("lights of the tree", scene.tree_lights),
          .first_tree_light = up("lights of emitters", scene.first_tree_light),
          .envmap_facings = up("environment regions", scene.envmap.facing_cdf),
          .envmap_rows = up("environment rows", scene.envmap.row_cdf),
          .envmap_columns = up("environment distribution", scene.envmap.column_cdf),
          .media = up("media", scene.media),
          .plume_nodes = up("plumes", scene.plume_nodes),
          .interiors = up("interiors", scene.interiors),
          .filter_cells = up("filter cells", scene.filter_cells),
          .filter_table = up("filter table", filter_nodes(scene.camera)),
          .channel_bins = up("reflectances by channel bins", scene.channel_bins),
          .sobol =
              up("Sobol points", std::vector<uint32_t>(std::begin(kb_sobol_table), std::end(kb_sobol_table))),
          .thermals = up("thermal emission", scene.thermals)};
}

}  // namespace kiloband::opencl
