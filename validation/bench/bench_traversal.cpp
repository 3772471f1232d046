// Ray queries of kernels/geometry/bvh.clh against Embree's: the same rays, in one run.
//
//   bench_traversal [--threads N] [--width N] [SCENE.xml | cornell | conference]...
//
// Rays: camera rays through width x width pixels, in blocks of 8 x 4; from what they hit, one ray per pixel
// in a uniform direction of the hemisphere (incoherent), and the same direction as an occlusion query over a
// quarter of the scene's radius. Both sides use N threads (default 2) and single-ray queries; camera rays
// also go to Embree in packets of 16; secondary rays also sorted by octant and cell. Rates are the best of several rounds in which the two take turns, in
// 10^6 rays per second.
#include <fmt/format.h>
#include <omp.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <string>
#include <vector>

#include "scene/read/reader.hpp"
#include "shared/philox.h"
#include "shared/warp.h"
#include "src_cpu/geometry/embree_scene.hpp"
#include "src_cpu/geometry/ray_offset.hpp"
#include "src_cpu/geometry/surface_hit.hpp"
#include "src_cpu/path/camera.hpp"
#include "src_gpu/geometry/bvh_builder.hpp"
#include "tests/support/opencl_probe.hpp"

namespace kiloband {

using namespace cpu;
namespace {

constexpr int kRounds = 7;
constexpr std::size_t kBatch = kWavePaths;  // rays that a thread takes at a time

constexpr const char* kConferenceScene = R"(<scene version="3.0.0">
  <integrator type="path"/>
  <sensor type="perspective"><float name="fov" value="75"/><float name="near_clip" value="0.01"/>
    <transform name="to_world"><lookat origin="4.3, 1.45, 1.5" target="0, 0.5, -1" up="0, 1, 0"/></transform>
    <film type="hdrfilm"/>
  </sensor>
  <shape type="ply"><string name="filename" value="meshes/conference.ply"/><boolean name="face_normals" value="true"/>
    <transform name="to_world"><scale value="0.003"/></transform>
    <bsdf type="twosided"><bsdf type="diffuse"/></bsdf></shape>
  <emitter type="constant"/>
</scene>)";

constexpr const char* kKernels = R"(
#include "geometry/bvh.clh"
__kernel void closest(__global const KbBvhNode* restrict nodes, __global const KbPrimitive* restrict primitives,
                      __global const KbShape* restrict shapes, __global const KbRay* restrict rays,
                      __global KbHit* restrict hits, __global kb_u32* restrict faults) {
  const KbRay ray = rays[get_global_id(0)];
  kb_u32 fault = 0;
  hits[get_global_id(0)] = stored_hit(closest_hit(nodes, primitives, shapes, vload3(0, ray.origin), vload3(0, ray.direction),
                                       ray.t_min, ray.t_max, &fault));
  if (fault) atomic_or(faults, fault);
}
__kernel void occluded(__global const KbBvhNode* restrict nodes, __global const KbPrimitive* restrict primitives,
                       __global const KbShape* restrict shapes, __global const KbRay* restrict rays,
                       __global KbHit* restrict hits, __global kb_u32* restrict faults) {
  const KbRay ray = rays[get_global_id(0)];
  kb_u32 fault = 0;
  hits[get_global_id(0)].primitive = any_hit(nodes, primitives, shapes, vload3(0, ray.origin),
                                             vload3(0, ray.direction), ray.t_max, &fault);
  if (fault) atomic_or(faults, fault);
}
)";

FlatScene load(const std::string& name) {
  const std::filesystem::path root(KILOBAND_SOURCE_DIR);
  const char* data = std::getenv("KILOBAND_DATA");
  const SceneDescription scene =
      name == "cornell"      ? read_scene(root / "scenes/cornell_box/cornell_box.xml")
      : name == "conference" ? read_scene_text(kConferenceScene, name, data ? data : root / "../shared/data")
                             : read_scene(name);
  return *compile_scene(scene, {parse_channels("500:600:1"), {}, {}});
}

KbRay make_ray(glm::vec3 origin, glm::vec3 direction, float t_min, float t_max) {
  return {
      {origin.x, origin.y, origin.z}, t_min, {direction.x, direction.y, direction.z}, t_max, {0, 0, 0}, 0};
}

std::vector<KbRay> camera_rays(KbCamera camera, uint32_t width) {
  camera.film_width = camera.film_height = width;
  std::vector<KbRay> rays;
  for (uint32_t y = 0; y < width; y += 4) {
    for (uint32_t x = 0; x < width; x += 8) {
      for (uint32_t i = 0; i < 32; ++i) {
        const CameraRay ray = centre_camera_ray(camera, x + i % 8, y + i / 8);
        rays.push_back(make_ray(ray.origin, ray.direction, ray.t_min, ray.t_max));
      }
    }
  }
  return rays;
}

/// The two sides, over any of the ray sets.
class Contest {
 public:
  Contest(const FlatScene& scene, int threads)
      : embree_(scene, Isa::kAuto, threads),
        bvh_(opencl::build_bvh(scene)),
        probe_(kKernels, fmt::format("-DKB_BVH_STACK={} -DKB_SPECIALISED=1{}{}", bvh_.stack_entries(),
                                     scene.features.analytic_shapes ? " -DKB_HAS_ANALYTIC_SHAPES=1" : "",
                                     scene.features.instances ? " -DKB_HAS_INSTANCES=1" : "")),
        nodes_(probe_.upload(bvh_.nodes)),
        primitives_(probe_.upload(bvh_.primitives)),
        shapes_(probe_.upload(scene.shapes)),
        faults_(probe_.upload(std::vector<cl_uint>{0})),
        threads_(threads) {}

  /// Embree's answers in place; seconds.
  double embree(std::vector<TraceRay> rays, std::vector<TraceRay>* answers = nullptr) const {
    const double seconds = over_batches(rays.size(), [&](std::size_t first, std::size_t count) {
      embree_.closest_hits({&rays[first], count});
    });
    if (answers) *answers = std::move(rays);
    return seconds;
  }
  /// In coherent packets of 16, from queues that are filled before the clock runs.
  double embree_by_16(const std::vector<TraceRay>& rays) const {
    std::vector<RayQueue> queues((rays.size() + kBatch - 1) / kBatch);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      RayQueue& queue = queues[i / kBatch];
      put_ray(rays[i], queue, queue.count++);
    }
    return over_batches(rays.size(), [&](std::size_t first, std::size_t) {
      embree_.closest_hits(queues[first / kBatch], RayPackets::kCoherent);
    });
  }
  double embree(std::vector<ShadowRay> rays) const {
    return over_batches(rays.size(), [&](std::size_t first, std::size_t count) {
      embree_.occlusions({&rays[first], count});
    });
  }
  double opencl(const char* kernel, const cl::Buffer& rays, const cl::Buffer& hits, std::size_t count) {
    const auto start = std::chrono::steady_clock::now();
    probe_.run(kernel, count, nodes_, primitives_, shapes_, rays, hits, faults_);
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  }
  uint32_t faults() { return probe_.download<cl_uint>(faults_, 1)[0]; }
  test::OpenclProbe& probe() { return probe_; }
  const opencl::Bvh& bvh() const { return bvh_; }

 private:
  template <class F>
  double over_batches(std::size_t count, F&& f) const {
    const auto start = std::chrono::steady_clock::now();
#pragma omp parallel for schedule(dynamic) num_threads(threads_)
    for (std::size_t first = 0; first < count; first += kBatch) f(first, std::min(kBatch, count - first));
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  }

  EmbreeScene embree_;
  opencl::Bvh bvh_;
  test::OpenclProbe probe_;
  cl::Buffer nodes_, primitives_, shapes_, faults_;
  int threads_;
};

glm::vec3 vec3(const float* v) {
  return {v[0], v[1], v[2]};
}

std::vector<TraceRay> trace_rays(const std::vector<KbRay>& rays) {
  std::vector<TraceRay> out;
  for (const KbRay& r : rays) out.emplace_back(vec3(r.origin), vec3(r.direction), r.t_min, r.t_max);
  return out;
}

std::vector<ShadowRay> shadow_rays(const std::vector<KbRay>& rays) {
  std::vector<ShadowRay> out;
  for (const KbRay& r : rays) out.emplace_back(vec3(r.origin), vec3(r.direction), r.t_max);
  return out;
}

/// From each hit, into the hemisphere on the side that the ray came from.
std::vector<KbRay> secondary_rays(const FlatScene& scene, const std::vector<TraceRay>& hits, float t_max) {
  std::vector<KbRay> rays;
  for (std::size_t i = 0; i < hits.size(); ++i) {
    const TraceRay& hit = hits[i];
    if (hit.shape == KB_NONE) continue;
    const SurfaceHit at = make_surface_hit(scene, hit.shape, hit.primitive, hit.u, hit.v, hit.origin(),
                                           hit.direction(), hit.t_max);
    const glm::vec3 normal =
        glm::dot(at.geometric_normal, hit.direction()) < 0 ? at.geometric_normal : -at.geometric_normal;
    const KbFloat4 u = kb_philox_floats(1, static_cast<uint32_t>(i), 0, 0, 0);
    const KbFloat3 d = kb_sphere_uniform(u.x, u.y);
    const glm::vec3 direction(d.x, d.y, d.z);
    rays.push_back(make_ray(offset_ray_origin(at.departure, normal, at.offset),
                            glm::dot(direction, normal) < 0 ? -direction : direction, 0, t_max));
  }
  return rays;
}

/// By the octant of their directions, then by the cell of their origins, of 32^3 in the box of all (sorting is not timed).
std::vector<KbRay> sorted_rays(std::vector<KbRay> rays) {
  glm::vec3 low(INFINITY), high(-INFINITY);
  for (const KbRay& ray : rays)
    low = glm::min(low, vec3(ray.origin)), high = glm::max(high, vec3(ray.origin));
  const auto place = [&](const KbRay& ray) {
    const glm::uvec3 cell(31.0f * (vec3(ray.origin) - low) / glm::max(high - low, 1e-30f));
    uint32_t key = 0;
    for (const float d : ray.direction) key = key << 1 | (d < 0 ? 1 : 0);
    for (int bit = 4; bit >= 0; --bit)
      for (int axis = 0; axis < 3; ++axis) key = key << 1 | (cell[axis] >> bit & 1);
    return key;
  };
  std::ranges::stable_sort(rays, {}, place);
  return rays;
}

void report(const std::string& scene, const char* what, double embree, double opencl) {
  std::cout << fmt::format("{:<20} {:<22} Embree {:7.2f}  OpenCL {:7.2f}  ratio {:.3f}\n", scene, what,
                           embree / 1e6, opencl / 1e6, opencl / embree);
}

void closest(Contest& contest, const std::string& scene, const char* what, const std::vector<KbRay>& rays,
             bool packets) {
  const std::vector<TraceRay> mine = trace_rays(rays);
  const cl::Buffer input = contest.probe().upload(rays),
                   output = contest.probe().upload(std::vector<KbHit>(rays.size()));
  double embree = 1e30, opencl = 1e30;
  for (int round = 0; round < kRounds; ++round) {
    embree = std::min(embree, packets ? contest.embree_by_16(mine) : contest.embree(mine));
    opencl = std::min(opencl, contest.opencl("closest", input, output, rays.size()));
  }
  const auto count = static_cast<double>(rays.size());
  report(scene, what, count / embree, count / opencl);
}

void occlusion(Contest& contest, const std::string& scene, const std::vector<KbRay>& rays) {
  const std::vector<ShadowRay> mine = shadow_rays(rays);
  const cl::Buffer input = contest.probe().upload(rays),
                   output = contest.probe().upload(std::vector<KbHit>(rays.size()));
  double embree = 1e30, opencl = 1e30;
  for (int round = 0; round < kRounds; ++round) {
    embree = std::min(embree, contest.embree(mine));
    opencl = std::min(opencl, contest.opencl("occluded", input, output, rays.size()));
  }
  const auto count = static_cast<double>(rays.size());
  report(scene, "occlusion", count / embree, count / opencl);
}

void bench(const std::string& name, int threads, uint32_t width) {
  const FlatScene scene = load(name);
  const auto start = std::chrono::steady_clock::now();
  const std::size_t nodes = opencl::build_bvh(scene).nodes.size();
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  Contest contest(scene, threads);
  std::cout << fmt::format("{}: {} primitives, {} nodes of {} children, depth {}, built in {:.3f} s\n", name,
                           contest.bvh().primitives.size(), nodes, KB_BVH_WIDTH, contest.bvh().depth,
                           seconds);
  const std::vector<KbRay> camera = camera_rays(scene.camera, width);
  std::vector<TraceRay> hits;
  contest.embree(trace_rays(camera), &hits);
  closest(contest, name, "camera", camera, false);
  closest(contest, name, "camera, Embree by 16", camera, true);
  const std::vector<KbRay> secondary = secondary_rays(scene, hits, INFINITY);
  closest(contest, name, "secondary", secondary, false);
  closest(contest, name, "secondary, sorted", sorted_rays(secondary), false);
  occlusion(contest, name, secondary_rays(scene, hits, scene.scene_radius / 4));
  if (contest.faults()) throw std::logic_error("the traversal's stack overflowed");
}

}  // namespace
}  // namespace kiloband

int main(int argc, char** argv) {
  CLI::App app("Ray queries of the OpenCL kernels against Embree's");
  int threads = 2;
  uint32_t width = 512;
  std::vector<std::string> scenes;
  app.add_option("--threads", threads)->check(CLI::PositiveNumber);
  app.add_option("--width", width, "a multiple of 8")->check(CLI::Range(8, 8192));
  app.add_option("scenes", scenes);
  CLI11_PARSE(app, argc, argv);
  setenv("POCL_MAX_PTHREAD_COUNT", std::to_string(threads).c_str(), 1);
  if (scenes.empty()) scenes = {"cornell"};
  try {
    for (const std::string& scene : scenes) kiloband::bench(scene, threads, width & ~7u);
  } catch (const std::exception& error) {
    std::cerr << error.what() << '\n';
    return 1;
  }
}
