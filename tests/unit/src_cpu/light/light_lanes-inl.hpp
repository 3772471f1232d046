// The table of light_lanes.hpp for the lanes of the file that includes this one.
#if defined(KILOBAND_LIGHT_LANES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef KILOBAND_LIGHT_LANES_INL
#undef KILOBAND_LIGHT_LANES_INL
#else
#define KILOBAND_LIGHT_LANES_INL
#endif

#include "light_lanes.hpp"
#include "src_cpu/light/light-inl.hpp"
#include "src_cpu/path/camera-inl.hpp"

KB_BEFORE_LANES;
namespace kiloband::cpu::KB_LANES {

#define KB_SCENE_FUNCTION(name, body)                                                             \
  inline void name##_of_arrays(const FlatScene& scene, const float* const* in, float* const* out, \
                               std::size_t count) {                                               \
    for (std::size_t i = 0; i < count; i += kLanes) {                                             \
      const auto a = [&](int k) KB_LAMBDA { return load(in[k] + i); };                            \
      const auto put = [&](int k, F v) KB_LAMBDA { store(v, out[k] + i); };                       \
      [[maybe_unused]] const auto put_lookup = [&](int k, const Resolved& r) KB_LAMBDA {          \
        put(k, as_floats(select(r.textured, r.sample.texture, r.row)));                           \
        put(k + 1, as_floats(select(r.textured, r.sample.xy, U(KB_NONE))));                       \
        put(k + 2, select(r.textured, r.sample.fx, F(0)));                                        \
        put(k + 3, select(r.textured, r.sample.fy, F(0)));                                        \
      };                                                                                          \
      body                                                                                        \
    }                                                                                             \
  }

/// Of any normal; of half of them that of receivers which see both sides.
KB_INLINE U some_facing(const FlatScene& scene, V3 normal) {
  if (scene.envmap.height == 0) return U(KB_ALL_FACINGS);
  return select(normal.x + normal.z < F(0), U(KB_ALL_FACINGS),
                facing_of(scene.emitters[scene.environment], normal));
}

KB_SCENE_FUNCTION(lights, {
  const V3 point(V3({a(0), a(1), a(2)}));
  const Light light = sample_lights({scene}, {point, some_facing(scene, point)}, {a(3), a(4), a(5), a(6)},
                                    first_lanes(kLanes));
  const M sampled = light.pdf > F(0);
  put(0, light.pdf);
  put(1, select(sampled, light.factor, F(0)));
  put(2, select(sampled, light.direction.x, F(0)));
  put(3, select(sampled, light.direction.y, F(0)));
  put(4, select(sampled, light.direction.z, F(0)));
  put(5, select(sampled, light.target.x, F(0)));
  put(6, select(sampled, light.target.y, F(0)));
  put(7, select(sampled, light.target.z, F(0)));
  put(8, select(light.infinite, F(1), select(light.delta, F(2), F(3))));
  put_lookup(9, light.radiance);
})
KB_SCENE_FUNCTION(escape, {
  const U facing = some_facing(scene, {a(1), a(2), a(0)});
  const Escape seen = environment_at(scene, {a(0), a(1), a(2)}, facing, first_lanes(kLanes));
  put(0, seen.pdf);
  put_lookup(1, seen.radiance);
})
KB_SCENE_FUNCTION(suns, {
  for (int k = 0; k < 2; ++k) {
    const KbEmitter& sun = scene.emitters[scene.first_sun + static_cast<uint32_t>(k)];
    put(k, select(meets_sun(sun, {a(0), a(1), a(2)}), sun_at(sun).pdf, F(0)));
  }
})
KB_SCENE_FUNCTION(camera, {
  const CameraRays ray = sample_camera_rays(scene.camera, scene.filter_cells.data(), to_words(a(0)),
                                            to_words(a(1)), {a(2), a(3), a(4), a(5)});
  put(0, ray.origin.x);
  put(1, ray.origin.y);
  put(2, ray.origin.z);
  put(3, ray.direction.x);
  put(4, ray.direction.y);
  put(5, ray.direction.z);
  put(6, ray.t_min);
  put(7, ray.t_max);
  put(8, ray.sign);
})
KB_SCENE_FUNCTION(texture, {
  const U ref = as_words(a(0));
  const Resolved spectrum = resolve(scene, ref, {a(1), a(2)}, first_lanes(kLanes));
  put_lookup(0, spectrum);
  put(4, bound_at(scene, ref, spectrum, F(7), first_lanes(kLanes)));
})
KB_SCENE_FUNCTION(number, {
  const M active = a(3) > F(0.1f);
  put(0, number_at(scene, as_words(a(0)), {a(1), a(2)}, a(3), active));
  put(1, share_at(scene, as_words(a(0)), {a(1), a(2)}, a(3), active));
})
KB_SCENE_FUNCTION(surface, {
  const M active = a(3) > F(0.1f);
  F u = a(3);
  const TexturePlace at = place_at({a(1), a(2)});
  const U chosen = chosen_surface(scene, as_words(a(0)), at, u, active);
  put(0, as_floats(chosen));
  put(1, u);
  put(2, opacity_at(scene, chosen, at, active));
})

inline std::vector<test::SceneFunction> scene_functions() {
  return {{"lights", 7, 13, lights_of_arrays},  {"escape", 3, 5, escape_of_arrays},
          {"suns", 3, 2, suns_of_arrays},       {"camera", 6, 9, camera_of_arrays},
          {"texture", 3, 5, texture_of_arrays}, {"number", 4, 2, number_of_arrays},
          {"surface", 4, 3, surface_of_arrays}};
}

}  // namespace kiloband::cpu::KB_LANES
KB_AFTER_LANES;

#endif
