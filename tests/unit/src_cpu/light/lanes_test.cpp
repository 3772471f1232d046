// Lights, textures and cameras: every instruction set gives the bits of one lane.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "film/signed_filter.hpp"
#include "light_lanes.hpp"
#include "test_scene.hpp"
#include "tests/support/chi_square.hpp"

namespace kiloband::test::lanes_test {
namespace {

using namespace cpu;

constexpr std::size_t kCount = 1 << 12;

using Arrays = std::vector<std::vector<float>>;

Arrays apply(const std::vector<SceneFunction>& functions, const std::string& name, const FlatScene& scene,
             const Arrays& in) {
  const SceneFunction& function = *std::ranges::find(functions, name, &SceneFunction::name);
  Arrays out(function.outputs, std::vector<float>(in[0].size()));
  std::vector<const float*> from;
  std::vector<float*> to;
  for (const auto& array : in) from.push_back(array.data());
  for (auto& array : out) to.push_back(array.data());
  function.apply(scene, from.data(), to.data(), in[0].size());
  return out;
}

/// The bits, with one NaN for all.
uint32_t bits_of(float value) {
  return std::isnan(value) ? 0x7fc00000u : kb_as_u32(value);
}

void expect_bits_of_one_lane(const std::string& name, const FlatScene& scene, const Arrays& in) {
  const Arrays one = apply(scene_functions_of_one_lane(), name, scene, in);
  for (const Isa isa : {Isa::kSse4, Isa::kAvx2, Isa::kAvx512}) {
    if (!is_available(isa)) continue;
    const Arrays many = apply(scene_functions_of(isa), name, scene, in);
    for (std::size_t k = 0; k < one.size(); ++k)
      for (std::size_t i = 0; i < kCount; ++i)
        ASSERT_EQ(bits_of(many[k][i]), bits_of(one[k][i]))
            << to_string(isa) << " " << name << " output " << k << " number " << i << ": " << many[k][i]
            << " instead of " << one[k][i];
  }
}

std::vector<float> numbers(uint32_t seed, float low, float high) {
  Uniform uniform(seed);
  std::vector<float> values(kCount);
  for (float& value : values) value = low + (high - low) * static_cast<float>(uniform());
  return values;
}

/// Directions, the axes first.
Arrays directions(uint32_t seed) {
  Uniform uniform(seed);
  Arrays d(3, std::vector<float>(kCount));
  for (std::size_t i = 0; i < kCount; ++i) {
    glm::vec3 one(random_direction(uniform));
    if (i < 6) one = glm::vec3(i / 2 == 0, i / 2 == 1, i / 2 == 2) * (i % 2 ? -1.0f : 1.0f);
    if (i % 8 == 7) one = glm::normalize(one * glm::vec3(1e-4f, 1, 1e-4f));
    for (int axis = 0; axis < 3; ++axis) d[axis][i] = one[axis];
  }
  return d;
}

/// Points, and four uniform numbers: inputs of "lights".
Arrays light_inputs() {
  Arrays in;
  for (uint32_t k = 0; k < 7; ++k)
    in.push_back(k < 3 ? numbers(k, -1, 1) : numbers(k, 0, KB_ONE_MINUS_EPSILON));
  return in;
}

FlatScene random_map(uint32_t width, uint32_t height) {
  std::vector<float> texels(std::size_t{width} * height);
  Uniform uniform(3);
  for (float& texel : texels) texel = static_cast<float>(std::pow(uniform(), 8.0) * 100);
  return envmap_scene(width, height, texels, placed({0, 0, 0}, 1.1, glm::dvec3(1)));
}

TEST(LightLanes, EnvironmentMapsOfEverySize) {
  for (const auto& [width, height] : std::vector<std::pair<uint32_t, uint32_t>>{
           {1, 1}, {1, 2}, {2, 1}, {3, 3}, {7, 4}, {16, 9}, {300, 151}}) {
    SCOPED_TRACE(std::to_string(width) + " x " + std::to_string(height));
    const FlatScene scene = random_map(width, height);
    expect_bits_of_one_lane("lights", scene, light_inputs());
    expect_bits_of_one_lane("escape", scene, directions(1));
  }
}

TEST(LightLanes, ConstantEnvironment) {
  const FlatScene scene = scene_with(make_emitter(KB_EMITTER_CONSTANT));
  expect_bits_of_one_lane("lights", scene, light_inputs());
  expect_bits_of_one_lane("escape", scene, directions(2));
}

/// A wide one and a narrow one; directions about the narrow one's edge among others.
TEST(LightLanes, Suns) {
  FlatScene scene = scene_with(make_sun(1, placed({0, 0, 0}, 1.1, glm::dvec3(1))));
  scene.emitters.push_back(make_sun(4.65e-3, placed({0, 0, 0}, 0.3, glm::dvec3(1))));
  scene.emitters[0].select_pdf = scene.emitters[1].select_pdf = 0.5f;
  scene.emitter_cdf = {0, 0.5f, 1};
  expect_bits_of_one_lane("lights", scene, light_inputs());
  Arrays in = directions(3);
  Uniform uniform(4);
  const glm::dvec3 axis = -glm::dvec3(placed({0, 0, 0}, 0.3, glm::dvec3(1))[2]);
  for (std::size_t i = 0; i < kCount; i += 2) {
    const glm::dvec3 aside = glm::normalize(glm::cross(axis, random_direction(uniform)));
    const glm::vec3 edge(std::cos(4.65e-3) * axis + std::sin(4.65e-3 + 2e-7 * (uniform() - 0.5)) * aside);
    for (int k = 0; k < 3; ++k) in[k][i] = edge[k];
  }
  expect_bits_of_one_lane("suns", scene, in);
  const Arrays seen = apply(scene_functions_of_one_lane(), "suns", scene, in);
  for (const auto& pdf : seen) {
    const auto met = static_cast<std::size_t>(std::ranges::count_if(pdf, [](float p) { return p > 0; }));
    EXPECT_GT(met, kCount / 10);
    EXPECT_LT(met, kCount - kCount / 10);
  }
}

/// Points, spots, directional lights, a sphere, a mesh, the sky and a sun, as they fall; points of light among those that are lit.
TEST(LightLanes, EveryKindInOneVector) {
  FlatScene scene = scene_with_mesh({{-1, -1, 2}, {1, -1, 2}, {1, 1, 2.5f}, {-1, 1, 2}}, {0, 1, 2, 0, 2, 3},
                                    KB_SHAPE_LIT_BOTH_SIDES);
  scene.shapes.push_back(make_shape(KB_SHAPE_SPHERE, placed({0, 0, 4}, 0.5, glm::dvec3(1))));
  scene.shapes[1].emitter = 1;
  scene.emitters.push_back(make_emitter(KB_EMITTER_AREA));
  scene.emitters[1].shape = 1;
  const uint32_t types[] = {KB_EMITTER_POINT,       KB_EMITTER_SPOT,     KB_EMITTER_SPOT,
                            KB_EMITTER_DIRECTIONAL, KB_EMITTER_CONSTANT, KB_EMITTER_SUN};
  for (const uint32_t type : types) {
    const auto number = static_cast<double>(scene.emitters.size());
    KbEmitter& emitter = scene.emitters.emplace_back(
        make_emitter(type, placed({0.25, 0.125 * number, -0.5}, number, glm::dvec3(1 + number))));
    emitter.ref = KB_REF_SPECTRUM | static_cast<uint32_t>(number);
    emitter.cutoff_angle = static_cast<float>(number / 2);
    emitter.beam_width = static_cast<float>(number / 4);
    emitter.one_minus_cos = 0.01f, emitter.scale = 17;
  }
  scene.triangles.push_back(0);  // what is spare in a compiled scene, since lanes read four numbers of three
  scene.positions.push_back({});
  scene.environment = 6;
  scene.emitter_cdf = {0};
  for (KbEmitter& emitter : scene.emitters) {
    emitter.select_pdf = 1.0f / static_cast<float>(scene.emitters.size());
    scene.emitter_cdf.push_back(static_cast<float>(scene.emitter_cdf.size()) * emitter.select_pdf);
  }
  Arrays in = light_inputs();
  for (std::size_t i = 0; i < kCount; i += 5) in[0][i] = 0.25f, in[1][i] = 0.25f, in[2][i] = -0.5f;
  expect_bits_of_one_lane("lights", scene, in);
  // All kinds were sampled: each has a reference of its own but for the two area lights.
  const std::vector<float> rows = apply(scene_functions_of_one_lane(), "lights", scene, in)[9];
  std::vector<int> seen(8);
  for (const float row : rows) ++seen.at(kb_as_u32(row));
  for (const int row : {0, 2, 3, 4, 5, 6, 7}) EXPECT_GT(seen[row], 100) << row;
}

/// What a NaN finds is undefined, but lies in the tables: lanes without a ray look, too.
TEST(LightLanes, DirectionsThatAreNoneStayInTheMap) {
  const FlatScene scene = random_map(16, 9);
  Arrays in(3, std::vector<float>(kCount));
  const float odd[] = {0, -0.0f, 1, INFINITY, -INFINITY, NAN, 1e30f, -1e-40f};
  for (std::size_t i = 0; i < kCount; ++i)
    for (std::size_t axis = 0; axis < 3; ++axis) in[axis][i] = odd[i >> 3 * axis & 7];
  for (const Isa isa : {Isa::kSse4, Isa::kAvx2, Isa::kAvx512}) {
    if (!is_available(isa)) continue;
    const std::vector<float> xy = apply(scene_functions_of(isa), "escape", scene, in)[2];
    for (const float word : xy) {
      ASSERT_LT(kb_as_u32(word) & 0xffffu, 16u);
      ASSERT_LT(kb_as_u32(word) >> 16, 9u);
    }
  }
}

/// Textures of every kind and size, then checkerboards, then rows; returns the references.
std::vector<uint32_t> add_textures(FlatScene& scene) {
  Uniform uniform(5);
  std::vector<uint32_t> refs;
  for (const uint32_t wrap : {KB_WRAP_REPEAT, KB_WRAP_MIRROR, KB_WRAP_CLAMP}) {
    for (const uint32_t flags : {0u, KB_TEXTURE_NEAREST}) {
      for (const uint32_t width : {1u, 2u, 13u}) {
        KbTexture texture{};
        texture.width = width, texture.height = 14 - width;
        texture.wrap = wrap, texture.flags = flags;
        for (float& m : texture.to_uv) m = static_cast<float>(3 * uniform() - 1);
        texture.first_bound = static_cast<uint32_t>(scene.texel_bounds.size());
        for (uint32_t i = 0; i < texture.width * texture.height; ++i)
          scene.texel_bounds.push_back(static_cast<float>(uniform()));
        refs.push_back(KB_REF_BITMAP | static_cast<uint32_t>(scene.textures.size()));
        scene.textures.push_back(texture);
      }
    }
  }
  for (const uint16_t row : {2, 0}) {
    const auto scale = static_cast<float>(uniform() * 4);
    refs.push_back(KB_REF_CHECKERBOARD | static_cast<uint32_t>(scene.checkerboards.size()));
    scene.checkerboards.push_back({row, row + 1u, {scale, 0.25f, 0.5f, -0.5f, scale, 0}});
  }
  scene.spectra.resize(4);
  for (SpectrumRow& row : scene.spectra) row.bound = static_cast<float>(uniform());
  refs.push_back(KB_REF_SPECTRUM | 3u);
  return refs;
}

TEST(TextureLanes, MixedInOneVectorAndAlone) {
  FlatScene scene;
  const std::vector<uint32_t> refs = add_textures(scene);
  for (const bool mixed : {true, false}) {
    Uniform uniform(6);
    Arrays in{numbers(1, 0, 1), numbers(2, -3, 4), numbers(3, -3, 4)};
    const float odd[] = {0, -0.0f, 1, 0.5f, INFINITY, -INFINITY, NAN, 1e30f, -1e11f, 0.25f};
    for (std::size_t i = 0; i < kCount; ++i) {
      const std::size_t which = mixed ? static_cast<std::size_t>(uniform() * static_cast<double>(refs.size()))
                                      : i / 64 % refs.size();
      in[0][i] = kb_as_f32(refs[which]);
      if (i % 5 == 0) in[1][i] = odd[i / 5 % std::size(odd)];
      if (i % 7 == 0) in[2][i] = odd[i / 7 % std::size(odd)];
    }
    expect_bits_of_one_lane("texture", scene, in);
  }
}

/// Bitmaps of numbers, in some lanes none.
TEST(NumberLanes, MixedInOneVectorAndAlone) {
  FlatScene scene;
  std::vector<uint32_t> refs = add_textures(scene);
  std::erase_if(refs, [](uint32_t ref) { return (ref & KB_REF_KIND_MASK) != KB_REF_BITMAP; });
  refs.push_back(KB_NONE);
  for (const bool mixed : {true, false}) {
    Uniform uniform(8);
    Arrays in{numbers(1, 0, 1), numbers(2, -3, 4), numbers(3, -3, 4), numbers(4, 0, 1)};
    for (std::size_t i = 0; i < kCount; ++i)
      in[0][i] = kb_as_f32(refs[mixed ? static_cast<std::size_t>(uniform() * static_cast<double>(refs.size()))
                                      : i / 64 % refs.size()]);
    expect_bits_of_one_lane("number", scene, in);
  }
}

/// Blends of blends and of masks, with constants and bitmaps.
TEST(SurfaceLanes, BlendsAndMasks) {
  FlatScene scene;
  add_textures(scene);
  Uniform uniform(9);
  constexpr uint32_t kPlain = 10, kBlends = 12;
  for (uint32_t i = 0; i < kPlain + kBlends; ++i) {
    KbSurface surface{};
    const auto share = static_cast<float>(uniform());
    const uint32_t ref = i % 3 ? KB_NONE : KB_REF_BITMAP | i % static_cast<uint32_t>(scene.textures.size());
    surface.opacity = surface.weight = share;
    surface.opacity_ref = surface.weight_ref = ref;
    if (i >= kPlain) {
      surface.flags = KB_SURFACE_BLEND;
      surface.first = i - 5;
      surface.second = i - 7;
    }
    scene.surfaces.push_back(surface);
  }
  Arrays in{numbers(1, 0, 1), numbers(2, -3, 4), numbers(3, -3, 4), numbers(4, 0, KB_ONE_MINUS_EPSILON)};
  for (float& surface : in[0]) surface = kb_as_f32(static_cast<uint32_t>(surface * (kPlain + kBlends - 1)));
  expect_bits_of_one_lane("surface", scene, in);
}

TEST(CameraLanes, EveryProjectionAndFilter) {
  Arrays in{numbers(1, 0, 1), numbers(2, 0, 1)};
  for (float& x : in[0]) x = std::floor(x * 45000);
  for (float& y : in[1]) y = std::floor(y * 30001);
  for (uint32_t k = 3; k < 7; ++k) in.push_back(numbers(k, 0, KB_ONE_MINUS_EPSILON));
  in[2][0] = in[3][1] = in[4][2] = in[5][3] = 0;
  in[2][4] = in[3][5] = 0.5f;
  FlatScene scene;
  KbCamera& camera = scene.camera;
  camera.film_width = 45000, camera.film_height = 30001;
  camera.tan_half_fov_x = 0.4f, camera.principal_x = 0.1f, camera.principal_y = -0.3f;
  camera.near_clip = 0.1f, camera.far_clip = 50, camera.aperture_radius = 0.3f, camera.focus_distance = 4;
  set_matrix(camera.to_world, placed({1, 2, 3}, 0.9, {-1, 1, 1}));
  scene.filter_cells = make_signed_filter([](double x) { return lanczos(x, 3); }, 3).cells;
  for (const uint32_t type : {KB_CAMERA_PERSPECTIVE, KB_CAMERA_THINLENS, KB_CAMERA_ORTHOGRAPHIC}) {
    for (const uint32_t filter : {KB_FILTER_BOX, KB_FILTER_TENT, KB_FILTER_GAUSSIAN, KB_FILTER_TABULATED}) {
      for (const float radius : {2.0f, 1.3f}) {  // 4 standard deviations, and as no file has it
        SCOPED_TRACE(std::to_string(type) + " " + std::to_string(filter));
        camera.type = type, camera.filter = filter, camera.filter_radius = radius,
        camera.filter_stddev = 0.5f;
        expect_bits_of_one_lane("camera", scene, in);
      }
    }
  }
}

}  // namespace
}  // namespace kiloband::test::lanes_test
