#include "tests/support/one_path_lights.hpp"

#include "src_cpu/lanes/one_lane_glm.hpp"
// After the lanes that it is to be compiled for.
#include "src_cpu/light/light-inl.hpp"
#include "src_cpu/path/camera-inl.hpp"

namespace kiloband::test {

using cpu::to_glm;
using cpu::to_lane;
namespace one_lane = cpu::one_lane;

namespace {

KbTextureSample sample_of(const one_lane::TextureSample& s) {
  return {s.texture.v, s.xy.v, s.fx.v, s.fy.v};
}

cpu::ResolvedSpectrum radiance_of(const one_lane::Resolved& r) {
  return {static_cast<uint16_t>(r.row.v), r.textured.v, sample_of(r.sample)};
}

}  // namespace

LightSample sample_light(const FlatScene& scene, glm::vec3 point, glm::vec2 u_select, glm::vec2 u_position,
                         uint32_t facing) {
  if (scene.emitters.empty()) return {};
  const one_lane::F4 u{u_select.x, u_select.y, u_position.x, u_position.y};
  const one_lane::ChosenLight chosen = one_lane::choose_light(scene, to_lane(point), u, {true});
  if (chosen.head.type.v == KB_EMITTER_THERMAL) {
    const cpu::SelectedLight selected{chosen.emitter.v, chosen.head.select_pdf.v, chosen.triangle.v,
                                      chosen.area.v};
    return {cpu::sample_shape_light(scene, selected, point, u_select.y, u_position)};
  }
  const one_lane::Light light = one_lane::sample_chosen({scene}, chosen, {to_lane(point), facing}, u, {true});
  LightSample sample;
  sample.direction = to_glm(light.direction);
  sample.target = to_glm(light.target);
  sample.infinite = light.infinite.v;
  sample.delta = light.delta.v;
  sample.pdf = light.pdf.v;
  sample.factor = light.factor.v;
  sample.radiance = radiance_of(light.radiance);
  return sample;
}

float area_light_pdf(const FlatScene& scene, const cpu::SurfaceHit& hit, glm::vec3 origin) {
  const KbShape& record = scene.shapes[hit.shape];
  if (record.emitter == KB_NONE) return 0;
  one_lane::Hit lane{};
  lane.shape = hit.shape;
  lane.shape_flags = record.flags;
  lane.point = to_lane(hit.point);
  lane.geometric_normal = to_lane(hit.geometric_normal);
  lane.shading_normal = to_lane(hit.shading_normal);
  return one_lane::area_light_pdf(scene, lane, record.emitter, hit.triangle, to_lane(origin), {true}).v;
}

float environment_pdf(const FlatScene& scene, glm::vec3 direction, uint32_t facing) {
  if (scene.environment == KB_NONE) return 0;
  const one_lane::V2 uv = one_lane::environment_coordinates(scene, to_lane(direction));
  return one_lane::environment_pdf(scene, uv, facing).v;
}

float sun_pdf(const FlatScene& scene, uint32_t emitter, glm::vec3 direction) {
  const KbEmitter& sun = scene.emitters[emitter];
  return one_lane::meets_sun(sun, to_lane(direction)).v ? one_lane::sun_at(sun).pdf.v : 0;
}

cpu::ResolvedSpectrum environment_radiance(const FlatScene& scene, glm::vec3 direction) {
  return radiance_of(one_lane::environment_radiance(
      scene, one_lane::environment_coordinates(scene, to_lane(direction)), {true}));
}

glm::vec2 envmap_coordinates(const KbEmitter& emitter, glm::vec3 direction) {
  return to_glm(one_lane::envmap_coordinates(emitter, to_lane(direction)));
}

float envmap_density(const EnvmapSampling& sampling, glm::vec2 uv, uint32_t facing) {
  return one_lane::envmap_density(sampling, to_lane(uv), facing).v;
}

uint32_t environment_facing(const KbEmitter& emitter, glm::vec3 normal) {
  return one_lane::facing_of(emitter, to_lane(normal)).v;
}

KbTextureSample sample_envmap_texture(const KbTexture& texture, uint32_t index, glm::vec2 uv) {
  return sample_of(one_lane::sample_envmap_texture(texture, index, to_lane(uv)));
}

float spectrum_bound(const FlatScene& scene, const cpu::ResolvedSpectrum& spectrum) {
  if (!spectrum.textured) return scene.spectra[spectrum.row].bound;
  return one_lane::texel_bounds(scene, spectrum.texture.texture, spectrum.texture.xy, {true}).v;
}

KbTextureSample sample_bitmap(const KbTexture& texture, uint32_t index, glm::vec2 uv) {
  return sample_of(one_lane::sample_bitmaps(one_lane::Textures(texture), index, to_lane(uv), {true}));
}

float bitmap_value(const FlatScene& scene, const KbTextureSample& sample) {
  const one_lane::Textures textures(scene.textures[sample.texture]);
  return one_lane::bitmap_value(scene, textures, {sample.texture, sample.xy, sample.fx, sample.fy}, {true}).v;
}

cpu::CameraRay sample_camera_ray(const KbCamera& camera, uint32_t x, uint32_t y, const KbFloat4& u,
                                 const float* filter_cells) {
  const one_lane::CameraRays ray =
      one_lane::sample_camera_rays(camera, filter_cells, x, y, {u.x, u.y, u.z, u.w});
  return {to_glm(ray.origin), to_glm(ray.direction), ray.t_min.v, ray.t_max.v, ray.sign.v};
}

glm::vec3 off_the_edges(glm::vec3 p, glm::vec3 weights, const glm::vec3 (&corners)[3], glm::vec3 area_normal,
                        float offset) {
  const one_lane::Triangle triangle{to_lane(corners[0]),
                                    to_lane(corners[1]),
                                    to_lane(corners[2]),
                                    to_lane(corners[1] - corners[0]),
                                    to_lane(corners[2] - corners[0]),
                                    to_lane(area_normal)};
  return to_glm(one_lane::off_the_edges(triangle, to_lane(p), to_lane(weights), offset, {true}));
}

glm::vec3 largest_of_triangle(glm::vec3 p0, glm::vec3 p1, glm::vec3 p2) {
  return glm::max(glm::max(glm::abs(p0), glm::abs(p1)), glm::abs(p2));
}

}  // namespace kiloband::test
