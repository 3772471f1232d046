// kiloband trace SCENE.xml --pixel X,Y --sample N: one path, vertex by vertex.
#include <fmt/core.h>

#include <charconv>
#include <cstring>
#include <iterator>
#include <memory>

#include "app/commands.hpp"
#include "app/console/messages.hpp"
#include "app/console/standard_output.hpp"
#include "app/options/backend_options.hpp"
#include "app/options/render_options.hpp"
#include "app/options/sampling_options.hpp"
#include "app/options/whole_numbers.hpp"
#include "render/traced_path.hpp"

namespace kiloband {
namespace {

struct TraceOptions {
  SceneOptions scene;
  BackendOptions backend;
  std::string pixel;
  uint32_t sample = 0, replicates = 1;
  SamplingOptions sampling;
};

struct Pixel {
  uint32_t x = 0, y = 0;
};

Pixel parse_pixel(const std::string& text) {
  Pixel pixel;
  const char* end = text.data() + text.size();
  const auto [comma, error] = std::from_chars(text.data(), end, pixel.x);
  if (error == std::errc{} && comma != end && *comma == ',') {
    const auto [rest, second] = std::from_chars(comma + 1, end, pixel.y);
    if (second == std::errc{} && rest == end) return pixel;
  }
  throw InputError("--pixel " + text + ": must be X,Y with whole numbers from 0");
}

const char* name_of_kind(uint32_t kind) {
  static constexpr const char* kNames[] = {"scaled",     "two-term", "nonlinear",          "conductor",
                                           "dispersive", "gas",      "rough transmission", "tinted"};
  return kind < std::size(kNames) ? kNames[kind] : "?";
}

std::string spectrum_name(const FlatScene& scene, uint32_t row, bool textured) {
  if (textured) return "texture";
  return row < scene.spectra.size() ? scene.spectra[row].name : "?";
}

void print_hit(const FlatScene& scene, const std::string& what, const TracedHit& hit) {
  if (hit.shape == KB_NONE) {
    answer("{:<10} leaves the scene\n", what);
    return;
  }
  answer("{:<10} shape {} ({}) triangle {}  t {:.9g}  u {:.9g}  v {:.9g}\n", what, hit.shape,
         scene.shape_names[hit.shape], hit.primitive, hit.t, hit.u, hit.v);
}

void print_gas(const FlatScene& scene, const KbPathVertex& v) {
  answer("vertex     gas, {}\n", spectrum_name(scene, v.row_a, false));
  if (v.head & KB_VERTEX_NEE) {
    answer("  light    through a column of {:.9g} m\n", v.nee0);
    return;
  }
  if (v.head & KB_VERTEX_DEFER) {
    answer("  column   {:.9g} m in front of the next vertex's emission\n", v.scatter0);
    return;
  }
  answer("  column   {:.9g} m\n", v.scatter0);
  const uint32_t cells = v.head >> KB_VERTEX_MATERIAL_SHIFT;
  if (v.head & KB_VERTEX_EMIT) answer("  emission of {}\n", spectrum_name(scene, v.emit_row, false));
  if (cells == 0) return;
  answer("  cells    {}, from {:.9g} K\n", cells, v.nee0);
  for (uint32_t i = 0; i < cells; ++i) {
    KbPlumeCell cell;
    std::memcpy(&cell, reinterpret_cast<const char*>(&v + 1) + i * sizeof cell, sizeof cell);
    answer("    {:.9g} m to {:.9g} K\n", cell.column, cell.temperature_k);
  }
}

/// With the entries that follow it.
void print_vertex(const FlatScene& scene, const KbPathVertex& v) {
  const uint32_t kind = v.head & KB_VERTEX_KIND_MASK;
  if (kind == KB_KIND_MEDIUM) return print_gas(scene, v);
  const bool two = kb_has_two_spectra(kind);
  answer("vertex     {}", name_of_kind(kind));
  const uint32_t material = v.head >> KB_VERTEX_MATERIAL_SHIFT;
  const bool reflects = v.head & (KB_VERTEX_NEE | KB_VERTEX_SCATTER);
  if (reflects && material < scene.material_names.size()) answer(" '{}'", scene.material_names[material]);
  answer("\n");
  if (v.head & KB_VERTEX_EMIT) {
    answer("  emission weight {:.9g} of {}\n", v.emit_weight,
           spectrum_name(scene, v.emit_row, v.head & KB_VERTEX_TEX_EMIT));
  }
  if (reflects) {
    answer("  factors  {}{}\n", spectrum_name(scene, v.row_a, v.head & KB_VERTEX_TEX_A),
           two ? ", " + spectrum_name(scene, v.row_b, v.head & KB_VERTEX_TEX_B) : "");
  }
  if (v.head & KB_VERTEX_NEE) {
    answer("  light    weights {:.9g} {:.9g} of {}{}\n", v.nee0, v.nee1,
           spectrum_name(scene, v.nee_row, v.head & KB_VERTEX_TEX_NEE),
           v.head & KB_VERTEX_DEFER ? ", through gas" : "");
  }
  if (v.head & KB_VERTEX_DEGRADE) {
    answer("  scatter  weight {:.9g}, only channel {} goes on\n", v.scatter0,
           kb_surviving_channel(v.scatter1));
  } else if (v.head & KB_VERTEX_SCATTER) {
    answer("  scatter  weights {:.9g} {:.9g}\n", v.scatter0, v.scatter1);
  }
}

void print_path(const FlatScene& scene, const TracedPath& path) {
  std::size_t bounce = 0;
  for (const TracedHit& hit : path.hits) {
    const bool boundary = hit.shape != KB_NONE && (scene.shapes[hit.shape].flags & KB_SHAPE_NULL);
    print_hit(scene, boundary ? "boundary" : fmt::format("bounce {}", bounce), hit);
    bounce += boundary ? 0 : 1;
  }
  if (path.invalid) answer("invalid: a weight is not finite, or the path is endless; it leaves the mean\n");
  if (path.entries.empty() && !path.invalid) answer("no vertex contributes\n");
  if (!path.entries.empty() && (path.entries.front().head & KB_VERTEX_NEGATIVE))
    answer("camera     weight -1: the reconstruction filter is negative there\n");
  for (std::size_t i = 0; i < path.entries.size();) {
    print_vertex(scene, path.entries[i]);
    i += 1 + kb_vertex_extensions(path.entries[i].head);
  }
}

int trace(const TraceOptions& options) {
  const Pixel pixel = parse_pixel(options.pixel);
  const DiagnosticSink sink = print_diagnostics(false);
  check_scene_file(options.scene.scene);
  const LoadedScene loaded = load_scene(options.scene, sink);
  const auto compiled = compile_scene(loaded.description, {loaded.channels, loaded.guide, sink});
  const FlatScene& scene = *compiled;
  const KbCamera& camera = scene.camera;
  if (pixel.x >= camera.film_width || pixel.y >= camera.film_height) {
    throw InputError(fmt::format("--pixel {}: the film has {} x {} pixels", options.pixel, camera.film_width,
                                 camera.film_height));
  }
  const SamplingSettings sampling = options.sampling.settings(options.replicates);
  const auto backend = make_backend(options.backend, compiled, {}, sampling, sink);
  const SampleRange range{options.sample % options.replicates, options.sample / options.replicates, 1};
  const BackendInfo info = backend->info();
  answer("pixel {},{} sample {} (replicate {}, index {}) on {} ({})\n", pixel.x, pixel.y, options.sample,
         range.replicate, range.first, info.name, info.isa);
  print_path(scene, backend->trace({pixel.x, pixel.y, 1, 1}, range).front());
  return kDone;
}

}  // namespace

Command add_trace(CLI::App& program) {
  auto o = std::make_shared<TraceOptions>();
  CLI::App* command = program.add_subcommand("trace", "Show one path of a render, vertex by vertex");
  o->scene.add_to(*command);
  o->backend.add_to(*command, false);
  command->add_option("--pixel", o->pixel, "X,Y in the full film")->required();
  command->add_option("--sample", o->sample, "number among the pixel's samples")
      ->transform(whole_numbers<uint32_t>(0, 0xffffffff))
      ->capture_default_str();
  command->add_option("--replicates", o->replicates, "of the render that the sample belongs to")
      ->transform(whole_numbers(1, 4096))
      ->capture_default_str();
  o->sampling.add_to(*command);
  return [o] { return trace(*o); };
}

}  // namespace kiloband
