// Lights, what belongs to them and cameras for one path at a time, in glm's types: the lanes' sources for one lane, which renders
// have no use for but tests ask one question at a time.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>

#include "scene/compile/flat_scene.hpp"
#include "shared/environment.h"
#include "src_cpu/geometry/surface_hit.hpp"
#include "src_cpu/geometry/texture/texture_lookup.hpp"
#include "src_cpu/light/emitter.hpp"
#include "src_cpu/path/camera.hpp"

namespace kiloband::test {

struct LightSample : cpu::LightSample {
  bool infinite = false;  // environment and directional lights, suns: no target
  bool delta = false;     // cannot be hit by BSDF sampling; pdf: selection probability
};

/// sample_lights() of light-inl.hpp. 0: no emitters
/// facing  of the receiver (shared/environment.h)
LightSample sample_light(const FlatScene& scene, glm::vec3 point, glm::vec2 u_select, glm::vec2 u_position,
                         uint32_t facing = KB_ALL_FACINGS);

/// Density with which sample_light() gives the direction from `origin` to a hit of an area light (its shape,
/// point and normals); selection included [1/sr]. 0 where the light does not emit to there (on_front()) or
/// cannot be sampled.
/// origin  the `point` that was given to sample_light(): for spheres the density depends on its side
float area_light_pdf(const FlatScene& scene, const cpu::SurfaceHit& hit, glm::vec3 origin);

/// Density with which sample_light() gives a receiver of this facing a direction that escapes to the environment;
/// 0 without environment [1/sr].
float environment_pdf(const FlatScene& scene, glm::vec3 direction, uint32_t facing = KB_ALL_FACINGS);
/// The same of a sun, by its index; 0 beside its disc. direction: a unit vector towards it
float sun_pdf(const FlatScene& scene, uint32_t emitter, glm::vec3 direction);
/// What the environment sends from `direction` (a unit vector towards it); scene.environment must exist.
cpu::ResolvedSpectrum environment_radiance(const FlatScene& scene, glm::vec3 direction);

/// Map coordinates of a world direction: u in [0, 1), v in [0, 1].
glm::vec2 envmap_coordinates(const KbEmitter& emitter, glm::vec3 direction);
/// Density at map coordinates for receivers of a facing, without that of selection [1/sr].
float envmap_density(const EnvmapSampling& sampling, glm::vec2 uv, uint32_t facing = KB_ALL_FACINGS);
/// Facing (shared/environment.h) of a receiver's normal, in the world.
uint32_t environment_facing(const KbEmitter& emitter, glm::vec3 normal);
/// The environment map's sample for local coordinates u in [0,1) (periodic), v in [0,1] (rows align-corners).
KbTextureSample sample_envmap_texture(const KbTexture& texture, uint32_t index, glm::vec2 uv);

/// Upper bound of a resolved spectrum over guide bands and rendered channels (of a lookup: of its four texels).
float spectrum_bound(const FlatScene& scene, const cpu::ResolvedSpectrum& spectrum);
/// The bilinear (or nearest: fx = fy = 0) sample of a bitmap at uv; v = 0 is the first row, pixel centres at
/// (i + 0.5) / n, wrapped as the texture says. Exact at the borders of all wrap modes.
KbTextureSample sample_bitmap(const KbTexture& texture, uint32_t index, glm::vec2 uv);
/// The bilinear value of a bitmap of numbers: of its texels' bounds.
float bitmap_value(const FlatScene& scene, const KbTextureSample& sample);

/// sample_camera_rays() of camera-inl.hpp.
/// u  x, y: film position; z, w: lens; uniform in [0,1)
/// filter_cells  FlatScene's; other filters than KB_FILTER_TABULATED need none
cpu::CameraRay sample_camera_ray(const KbCamera& camera, uint32_t x, uint32_t y, const KbFloat4& u,
                                 const float* filter_cells = nullptr);

/// ray_offset-inl.hpp. area_normal: of the corners, cross product of the edges from the first one
glm::vec3 off_the_edges(glm::vec3 p, glm::vec3 weights, const glm::vec3 (&corners)[3], glm::vec3 area_normal,
                        float offset);
/// largest_coordinates() of a triangle.
glm::vec3 largest_of_triangle(glm::vec3 p0, glm::vec3 p1, glm::vec3 p2);

}  // namespace kiloband::test
