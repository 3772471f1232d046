// What a scene needs: the one list of features that backends are specialised for.
#pragma once

#include <string>
#include <vector>

namespace kiloband {

// X(macro, member, name): KB_HAS_macro in kernels (kernels/base/scene.clh has them all where none is chosen), the member
// of SceneFeatures, the name in `info` and the statistics.
#define KB_SCENE_FEATURES(X)                                                                          \
  X(DIFFUSE, diffuse, "diffuse")                                                                      \
  X(CONDUCTOR, conductor, "conductor")                                                                \
  X(ROUGH_CONDUCTOR, rough_conductor, "roughconductor")                                               \
  X(DIELECTRIC, dielectric, "dielectric")                                                             \
  X(ROUGH_DIELECTRIC, rough_dielectric, "roughdielectric")                                            \
  X(PLASTIC, plastic, "plastic")                                                                      \
  X(ROUGH_PLASTIC, rough_plastic, "roughplastic")                                                     \
  X(MASK, mask, "mask")                                                                               \
  X(BLEND, blend, "blend")                                                                            \
  X(BUMP, bump, "bump or normal map")                                                                 \
  X(ROUGHNESS_MAP, roughness_map, "roughness map")                                                    \
  X(PRINCIPLED, principled, "principled")                                                             \
  X(PRINCIPLED_MAP, principled_map, "principled map")                                                 \
  X(DISPERSION, dispersion, "dispersion")                                                             \
  X(BITMAP, bitmap, "bitmap")                                                                         \
  X(CHECKERBOARD, checkerboard, "checkerboard")                                                       \
  X(MESH_ATTRIBUTE, mesh_attribute, "mesh attribute")                                                 \
  X(SPECTRAL_TEXTURE, spectral_texture, "spectral texture")                                           \
  X(AREA_LIGHT, area_light, "area light")                                                             \
  X(CONSTANT_LIGHT, constant_light, "constant environment")                                           \
  X(ENVMAP_LIGHT, envmap_light, "environment map")                                                    \
  X(DELTA_LIGHT, delta_light, "delta light")                                                          \
  X(SUN, sun, "sun")                                       /* directional with an angular radius */   \
  X(PROJECTED_LIGHT, projected_light, "projected picture") /* of spots and projectors */              \
  X(LIGHT_TREE, light_tree, "light tree")                  /* many lights */                          \
  X(ANALYTIC_SHAPES, analytic_shapes, "analytic shapes")                                              \
  X(INSTANCES, instances, "instances")                                                                \
  X(THERMAL, thermal, "thermal emission")                      /* surfaces emit by Kirchhoff's law */ \
  X(COMPENSATION, compensation, "energy compensation")         /* of rough surfaces */                \
  X(TEMPERATURE_FIELD, temperature_field, "temperature field") /* temperatures depend on the place */ \
  X(GAS, gas, "gas")                                           /* media or null boundaries */         \
  X(PLUME, plume, "plume")                                     /* media that vary in space */         \
  X(SIGNED_FILTER, signed_filter, "signed filter")             /* of reconstruction, with negative lobes */

// What no code is specialised for, but is said, too.
#define KB_SCENE_NOTES(X) X(TWO_SIDED, two_sided, "twosided")

/// What is false costs nothing.
struct SceneFeatures {
#define KB_MEMBER(macro, member, name) bool member = false;
  KB_SCENE_FEATURES(KB_MEMBER)
  KB_SCENE_NOTES(KB_MEMBER)
#undef KB_MEMBER

  /// Names of the features that are present, for `info` and the statistics.
  std::vector<std::string> names() const;
};

}  // namespace kiloband
