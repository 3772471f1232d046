// kiloband render SCENE.xml: loads, renders, writes.
#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <memory>

#include "app/commands.hpp"
#include "app/console/messages.hpp"
#include "app/console/open_files.hpp"
#include "app/console/output_files.hpp"
#include "app/console/progress_bar.hpp"
#include "app/console/stop_signals.hpp"
#include "app/options/backend_options.hpp"
#include "app/options/option_values.hpp"
#include "app/options/render_options.hpp"
#include "app/options/sampling_options.hpp"
#include "app/options/whole_numbers.hpp"
#include "app/render_statistics.hpp"
#include "files/atomic_file.hpp"
#include "render/checkpoint/checkpoint.hpp"
#include "render/scene_metadata.hpp"
#include "render/session.hpp"

namespace kiloband {
namespace {

struct RenderOptions {
  SceneOptions scene;
  std::vector<std::string> outputs, responses, aux;
  BackendOptions backend;
  SamplingOptions sampling;
  std::string quantity;
  std::optional<std::string> preview, stats, time, target_error, checkpoint, checkpoint_interval;
  std::optional<uint64_t> spp;
  std::optional<uint32_t> replicates;
  bool variance = false, keep_replicates = false, resume = false, quiet = false;
};

constexpr uint32_t kReplicates = 16;  // for error bars, unless --replicates says otherwise

/// Where nobody asks for error bars all samples of a pixel are one set: sobol converges faster (docs/error_bars.md).
uint32_t default_replicates(const RenderOptions& options) {
  return options.variance || options.keep_replicates || options.target_error ? kReplicates : 1;
}

/// The scene is not needed for these; reading it may take long.
OutputFiles output_files(const RenderOptions& options) {
  OutputFiles files;
  files.inputs = {{"the scene", options.scene.scene}};
  add_inputs(files, "--response", options.responses);
  if (options.scene.bands_file) add_inputs(files, "--bands-file", {*options.scene.bands_file});
  for (const std::string& output : options.outputs) files.cubes.emplace_back(output);
  if (files.cubes.empty())
    files.cubes.push_back(std::filesystem::path(options.scene.scene).stem().string() + ".exr");
  files.preview = options.preview;
  files.stats = options.stats;
  files.checkpoint = options.checkpoint;
  if (options.keep_replicates) files.kept_replicates = options.replicates.value_or(kReplicates);
  return files;
}

/// Error bars need two replicates: options that contradict this.
void check_replicates(const RenderOptions& options) {
  if (options.replicates.value_or(kReplicates) >= 2) return;
  for (const auto& [name, given] :
       {std::pair{"--target-error", options.target_error.has_value()},
        std::pair{"--variance", options.variance}, std::pair{"--keep-replicates", options.keep_replicates}}) {
    if (given)
      throw InputError(
          fmt::format("{} needs error bars, --replicates 1 gives none: must be at least 2", name));
  }
}

/// What becomes of the replicates where the samples do not suffice.
void report_replicates(const RenderOptions& options, const SessionSettings& settings,
                       const DiagnosticSink& sink) {
  const uint32_t replicates = session_replicates(settings);
  if (replicates >= settings.replicates) return;
  const uint64_t samples = *settings.stop.samples_per_pixel;  // without it nothing is lowered
  if (options.target_error && replicates < 2)
    throw InputError(fmt::format(
        "--target-error needs error bars: --spp {} makes 1 replicate, at least 4 are needed", samples));
  if (default_replicates(options) >= 2 && replicates < 2) {
    warn(sink, {},
         fmt::format("{}: {} samples per pixel make 1 replicate: no error bars{}; at least 4 are needed",
                     options.variance ? "--variance" : "--keep-replicates", samples,
                     options.variance ? " (the variance is NaN)" : ""));
  } else if (options.replicates) {
    note(sink, {},
         fmt::format("--replicates {}: {} samples per pixel make {} of at least 2 samples",
                     settings.replicates, samples, replicates));
  }
}

StopRule stop_rule(const RenderOptions& options, const SceneDescription& scene) {
  StopRule stop;
  if (options.time) stop.seconds = parse_duration("--time", *options.time);
  if (options.target_error) stop.relative_error = parse_error("--target-error", *options.target_error);
  stop.samples_per_pixel = options.spp;
  if (!options.spp && stop.is_fixed()) stop.samples_per_pixel = scene.sensor.sample_count;
  return stop;
}

/// Those of the checkpoint that is gone on with: more samples than before might be dealt to more replicates.
uint32_t wanted_replicates(const RenderOptions& options) {
  if (options.replicates) return *options.replicates;
  const uint32_t usual = default_replicates(options);
  if (!options.resume) return usual;
  const uint32_t begun = checkpoint_replicates(*options.checkpoint).value_or(usual);
  if (begun >= 2 || usual < 2) return begun;
  const char* const what = options.target_error ? "--target-error"
                           : options.variance   ? "--variance"
                                                : "--keep-replicates";
  throw InputError(
      fmt::format("{}: checkpoint {} has 1 replicate, and so no error bars", what, *options.checkpoint));
}

/// What the options say; what is stated of the render comes with `stating`.
SessionSettings session_settings(const RenderOptions& options, const OutputFiles& files,
                                 const SceneDescription& scene, const DiagnosticSink& sink) {
  SessionSettings settings;
  settings.stop = stop_rule(options, scene);
  settings.replicates = wanted_replicates(options);
  settings.replicates_fixed = options.resume && checkpoint_replicates(*options.checkpoint).has_value();
  settings.sink = sink;
  settings.variance = options.variance;
  settings.keep_replicates = options.keep_replicates;
  settings.outputs = files.cubes;
  if (options.quantity == "integral") settings.quantity = Quantity::kIntegral;
  if (options.quantity == "density") settings.quantity = Quantity::kDensity;
  settings.preview = files.preview;
  settings.aux = options.aux;
  if (options.checkpoint) settings.checkpoint = *options.checkpoint;
  if (options.checkpoint_interval) {
    settings.checkpoint_interval_seconds =
        parse_duration("--checkpoint-interval", *options.checkpoint_interval);
  }
  settings.resume = options.resume;
  return settings;
}

/// The same with what files and checkpoints state of the render.
SessionSettings stating(SessionSettings settings, std::map<std::string, std::string> metadata,
                        uint64_t fingerprint) {
  settings.metadata = std::move(metadata);
  settings.fingerprint = fingerprint;
  return settings;
}

/// Without a checkpoint to go on from, the render starts afresh and says so.
void report_checkpoint(const RenderOptions& options) {
  if (options.resume && !checkpoint_exists(*options.checkpoint))
    tell("note: no checkpoint {}: starting afresh\n", *options.checkpoint);
}

std::map<std::string, std::string> metadata_of(const RenderOptions& options, const FlatScene& scene,
                                               const SamplingSettings& sampling, const Backend& backend) {
  std::map<std::string, std::string> metadata;
  metadata["software"] = fmt::format("kiloband {}", KILOBAND_VERSION);
  metadata["scene"] = std::filesystem::path(options.scene.scene).filename().string();
  const BackendInfo info = backend.info();
  metadata["backend"] = info.name;
  metadata["isa"] = info.isa;
  metadata["seed"] = std::to_string(sampling.seed);
  metadata["sampler"] = to_string(sampling.sampler);
  metadata["wavelengths"] = to_string(sampling.wavelengths);
  metadata[kCameraKey] = camera_geometry(scene).to_text();
  const bool objects = std::ranges::find(options.aux, "object") != options.aux.end();
  if (const std::string names = object_names(scene); objects && !names.empty()) metadata["objects"] = names;
  return metadata;
}

/// What each of several devices did.
void print_shares(const BackendStatistics& done) {
  for (const DeviceShare& share : done.devices)
    tell("  {} ({}): {:.1f} % of the paths{}\n", share.backend, share.device,
         100 * static_cast<double>(share.paths) / static_cast<double>(std::max<uint64_t>(done.paths, 1)),
         share.failure.empty() ? "" : ", until it failed");
}

void print_summary(const RenderReport& report, const Backend& backend, double setup_seconds) {
  const uint64_t paths = backend.statistics().paths;
  const BackendInfo info = backend.info();
  tell("{} paths in {:.2f} s ({:.2f} Mpaths/s on {}, {}); set-up {:.2f} s, output {:.2f} s\n", paths,
       report.sampling_seconds, static_cast<double>(paths) / report.sampling_seconds * 1e-6, info.name,
       info.isa, setup_seconds, report.output_seconds);
  print_shares(backend.statistics());
  if (report.errors.worst) tell("{}\n", describe_errors(report));
  for (const auto& file : report.written) tell("wrote {}\n", file.string());
}

/// Two rules and more, or one whose end is not its own.
void print_end(const RenderOptions& options, const RenderReport& report) {
  const int rules = options.spp.has_value() + options.time.has_value() + options.target_error.has_value();
  if (report.ended_by == StopReason::kDark || (rules > 1 && !report.interrupted))
    tell("ended by {}\n", to_string(report.ended_by));
}

/// The target was set, and something else ended the render.
void warn_of_missed_target(const RenderOptions& options, const RenderReport& report,
                           const DiagnosticSink& sink) {
  if (!options.target_error || report.ended_by == StopReason::kError) return;
  warn(sink, {},
       fmt::format("--target-error {} was not reached: ended by {}; {}", *options.target_error,
                   to_string(report.ended_by), describe_errors(report)));
}

void print_problems(const RenderReport& report, const Backend& backend) {
  const BackendStatistics done = backend.statistics();
  if (done.invalid_samples > 0) {
    tell("warning: {} invalid samples (not finite or endless) left the mean; the first:\n",
         done.invalid_samples);
    for (const InvalidSample& s : done.first_invalid) {
      tell("  pixel {},{} sample {}\n", s.x, s.y, s.sample);
    }
  }
  if (report.underflowed_values > 0) {
    tell("warning: {} values are too small for float32 and became 0\n", report.underflowed_values);
  }
  if (report.underflowed_variances > 0) {
    tell("warning: {} variances are too small for float32 and became 0: their errors are not 0\n",
         report.underflowed_variances);
  }
  if (report.overflowed_values > 0) {
    tell("warning: {} values are too large for float32 and became infinite or NaN\n",
         report.overflowed_values);
  }
  if (report.overflowed_variances > 0) {
    tell("warning: {} variances are too large for float32 and became infinite\n",
         report.overflowed_variances);
  }
  if (report.pixels_without_sample > 0) {
    tell("warning: {} pixels have no sample: NaN\n", report.pixels_without_sample);
  }
}

OutputFiles checked_files(const RenderOptions& options) {
  OutputFiles files = output_files(options);
  if (files.kept_replicates > 0) allow_many_open_files();
  check_output_files(files);
  if (!files.checkpoint) return files;
  check_checkpoint_file(*files.checkpoint, options.resume);  // first: it says what is no regular file
  check_writable(*files.checkpoint);
  if (options.resume && files.kept_replicates > 0) {  // as many as were begun
    files.kept_replicates = wanted_replicates(options);
    check_output_files(files);
  }
  return files;
}

/// Of what the scene reads nothing may be replaced, by a name that nobody gave least of all.
LoadedScene load_checked_scene(const RenderOptions& options, OutputFiles files, const DiagnosticSink& sink) {
  LoadedScene loaded = load_scene(options.scene, sink);
  for (const auto& file : loaded.files) add_cube_input(files, "a file of the scene", file);
  check_output_files(files);
  return loaded;
}

/// The options, and what the scene asks for besides: auxiliary images unless --aov names some, variances where there can be any.
RenderOptions with_requests(RenderOptions options, const RequestedImages& requested) {
  if (options.aux.empty()) options.aux = requested.auxiliary;
  const uint32_t usual = options.replicates.value_or(kReplicates);
  const uint32_t replicates =
      options.resume ? checkpoint_replicates(*options.checkpoint).value_or(usual) : usual;
  if (requested.variance && replicates >= 2) options.variance = true;
  return options;
}

void say_chosen(const BackendInfo& backend) {
  tell("backend {} ({}, {})\n", backend.name, backend.device, backend.isa);
}

int render(const RenderOptions& given) {
  std::signal(SIGPIPE, SIG_IGN);  // who reads our messages may go away before the render ends
  const auto start = std::chrono::steady_clock::now();
  const DiagnosticSink sink = print_diagnostics(given.quiet);
  check_scene_file(given.scene.scene);
  const OutputFiles files = checked_files(given);
  check_replicates(given);
  LoadedScene loaded = load_checked_scene(given, files, sink);
  const RenderOptions options = with_requests(given, loaded.description.requested);
  const SessionSettings wanted = session_settings(options, files, loaded.description, sink);
  report_replicates(options, wanted, sink);
  const SamplingSettings sampling = options.sampling.settings(session_replicates(wanted));
  const auto compiled = compile_scene(loaded.description, {loaded.channels, loaded.guide, sink});
  const FlatScene& scene = *compiled;
  const DerivedChannels derived = load_responses(options.responses, loaded, sink);
  loaded.description = {};  // meshes and images: what is rendered of them is in the compiled scene
  const auto backend = make_backend(options.backend, compiled, derived, sampling, sink);
  report_checkpoint(options);
  const uint64_t fingerprint =
      options.checkpoint ? render_fingerprint(scene, sampling, arithmetic_of(*backend), derived) : 0;
  const SessionSettings settings =
      stating(wanted, metadata_of(options, scene, sampling, *backend), fingerprint);
  catch_stop_signals();
  if (options.backend.backend == "auto" && !options.quiet) say_chosen(backend->info());
  const double setup = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();

  ProgressBar bar(!options.quiet);
  Progress last;
  const RenderReport report = run_session(scene, derived.bands, *backend, settings, stop_requested,
                                          [&](const Progress& progress) { bar.update(last = progress); });
  if (last.pixel_samples > 0) bar.finish(last);
  if (!options.quiet) {
    print_summary(report, *backend, setup);
    print_end(options, report);
  }
  warn_of_missed_target(options, report, sink);
  print_problems(report, *backend);
  if (options.stats) {
    const RenderContext context{
        sampling, scene.film.crop_width, scene.film.crop_height, scene.channels.size(),
        setup,    scene.features.names()};
    write_file_atomically(*options.stats, statistics_json(context, report, *backend));
  }
  return report.interrupted ? kInterrupted : kDone;
}

void add_sampling_options(CLI::App& command, RenderOptions& o) {
  o.backend.add_to(command);
  o.sampling.add_to(command);
  command
      .add_option(
          "--spp", o.spp,
          "samples per pixel; with --time or --target-error at most (default without these: the scene's)")
      ->transform(whole_numbers<uint64_t>(1, 0xffffffff));
  command.add_option("--time", o.time, "render for (at most) this long: 60s, 5min, 2h");
  command.add_option("--target-error", o.target_error,
                     "render until the relative error of the worst channel is below: 1%");
  command
      .add_option("--replicates", o.replicates,
                  "independent replicates that error bars come from (default: 16 with --variance, "
                  "--keep-replicates or --target-error, else 1)")
      ->transform(whole_numbers(1, 4096));
}

void add_output_options(CLI::App& command, RenderOptions& o) {
  command.add_option("-o", o.outputs, "output: .exr, or .hdr (ENVI); may be repeated (default: SCENE.exr)")
      ->allow_extra_args(false);
  command.add_flag("--variance", o.variance, "write the variance of the mean of every channel");
  command.add_flag("--keep-replicates", o.keep_replicates,
                   "also write the mean of every replicate (OUT.rNN)");
  command.add_option("--response", o.responses, "file of sensor responses to accumulate; may be repeated")
      ->allow_extra_args(false);
  command.add_option("--aov", o.aux, "auxiliary images: depth,normal,object,material")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(CLI::IsMember({"depth", "normal", "object", "material"}));
  command
      .add_option("--quantity", o.quantity,
                  "of the values on disk (default: density in EXR, integral in ENVI)")
      ->check(CLI::IsMember({"integral", "density"}));
  command.add_option("--preview", o.preview, "PNG preview");
  auto* checkpoint =
      command.add_option("--checkpoint", o.checkpoint, "new file that the unfinished render is saved in");
  command.add_option("--checkpoint-interval", o.checkpoint_interval, "how often: 60s (the default), 10min")
      ->needs(checkpoint);
  command.add_flag("--resume", o.resume, "go on from the checkpoint; more --spp extend a render")
      ->needs(checkpoint);
  command.add_option("--stats", o.stats, "statistics as JSON");
  command.add_flag("--quiet", o.quiet, "only errors and warnings");
}

}  // namespace

Command add_render(CLI::App& program) {
  auto options = std::make_shared<RenderOptions>();
  CLI::App* command = program.add_subcommand("render", "Render a scene into a spectral image");
  options->scene.add_to(*command);
  add_sampling_options(*command, *options);
  add_output_options(*command, *options);
  return [options] { return render(*options); };
}

}  // namespace kiloband
