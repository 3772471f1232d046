#include "scene/read/reader.hpp"

#include <memory>
#include <set>

#include "scene/read/context.hpp"
#include "scene/read/object/errors.hpp"
#include "scene/read/object/limits.hpp"
#include "scene/xml/values.hpp"

namespace kiloband {
namespace {

/// Passes every different message on once: a file that several objects name says its notes once.
DiagnosticSink without_repetitions(const DiagnosticSink& sink) {
  return [sink, told = std::make_shared<std::set<std::string>>()](const Diagnostic& d) {
    if (sink && told->insert(d.to_string()).second) sink(d);
  };
}

/// Reads the objects directly under <scene>.
class SceneReader {
 public:
  SceneReader(SceneTree& tree, const ReadOptions& options)
      : tree_(tree),
        sink_(without_repetitions(options.sink)),
        context_{tree, sink_, options.film_size, {}, {}, {}, {}, {}, {}, {}},
        errors_(*tree.root) {}

  SceneDescription run() {
    const ObjectReader scene(*tree_.root);
    for (const auto& child : tree_.root->children) {
      if (child->resolved().kind == TagKind::kObject) read(scene, *child);
    }
    errors_.throw_if_any();  // what follows depends on the whole
    read_ambient(scene);
    check_parts();
    scene.finish();
    check_whole(scene);
    scene_.integrator = integrator_.integrator;
    scene_.requested = integrator_.requested;
    scene_.sensor.sample_count *= integrator_.splitting;
    if (scene_.sensor.sample_count > kMaxSamples) {
      scene.fail_here("more than " + std::to_string(kMaxSamples) + " samples per pixel");
    }
    return std::move(scene_);
  }

 private:
  void read(const ObjectReader& scene, Node& child) {
    Node& node = child.resolved();
    const std::string& tag = node.tag;
    if (is_part(node) || is_thermal(node)) return;
    child.used = true;
    const bool again = (tag == "shape" || tag == "emitter") && !placed_.insert(&node).second;
    sensors_ += tag == "sensor";
    integrators_ += tag == "integrator";
    errors_.attempt([&] {
      if (again)
        fail(child.place, scene.label() + ": " + ObjectReader(node).label() + " is in the scene already");
      read_object(scene, child, node);
    });
  }

  void read_object(const ObjectReader& scene, const Node& child, Node& node) {
    const std::string& tag = node.tag;
    if (tag == "shape") {
      add_shape(node);
    } else if (tag == "emitter") {
      add_emitter(node);
    } else if (tag == "bsdf") {
      read_bsdf(context_, node);
    } else if (tag == "texture" || tag == "spectrum") {
      read_texture_node(context_, node, ObjectReader(node).label(), SpectrumUse::kAny);
    } else if (tag == "sensor") {
      Sensor sensor = read_sensor(context_, node);
      if (sensors_ == 1) scene_.sensor = std::move(sensor);
      if (sensors_ == 2)
        warn(sink_, child.place.position(), scene.label() + ": a second sensor: the first is rendered");
    } else if (tag == "integrator") {
      if (integrators_ > 1) fail(child.place, scene.label() + ": a second integrator");
      integrator_ = read_integrator(context_, node);
    } else if (tag == "medium") {
      add_medium(child, node);
    } else if (tag == "phase" || tag == "volume") {
      fail(child.place, "<" + tag + "> is not supported: gases do not scatter");
    }
  }

  void add_shape(Node& node) {
    if (node.type == "shapegroup") {
      read_shape_group(context_, node);
    } else if (node.type == "instance") {
      scene_.instances.push_back(read_instance(context_, node));
    } else if (node.type == "merge") {
      for (Node* member : merged_shapes(node)) add_shape(*member);
    } else {
      scene_.shapes.push_back(read_shape(context_, node));
    }
  }

  /// Named "atmosphere" it fills the space outside all shapes; else it is there to be referred to.
  void add_medium(const Node& child, Node& node) {
    const std::shared_ptr<const Medium> medium = read_medium(context_, node);
    if (child.name == "atmosphere") {
      scene_.atmosphere = medium;
      node.used_as_part = true;
    } else if (child.is_named()) {
      fail(child.name_place, "a medium of the scene must be named 'atmosphere', not '" + child.name + "'");
    }
  }

  void add_emitter(Node& node) {
    for (Emitter& emitter : read_emitters(context_, node)) add_emitter(node, std::move(emitter));
  }

  void add_emitter(Node& node, Emitter emitter) {
    scene_.emitters.push_back(std::move(emitter));
    const auto& model = scene_.emitters.back().model;
    const auto* directional = std::get_if<DirectionalEmitter>(&model);
    has_sun_ |= directional && directional->angular_radius > 0;
    if (!std::holds_alternative<ConstantEmitter>(model) && !std::holds_alternative<EnvmapEmitter>(model) &&
        !std::holds_alternative<SpectralEnvmapEmitter>(model))
      return;
    if (++environments_ > 1)
      fail(node.place, ObjectReader(node).label() + ": a second environment: only one is allowed");
  }

  static bool is_thermal(const Node& node) { return node.tag == "emitter" && node.type == "thermal"; }

  /// A thermal emitter that no shape refers to is the ambient temperature.
  void read_ambient(const ObjectReader& scene) {
    for (const auto& child : tree_.root->children) {
      Node& node = child->resolved();
      if (node.kind != TagKind::kObject || !is_thermal(node)) continue;
      child->used = true;
      if (node.used_as_part) continue;
      if (scene_.ambient_temperature_k) fail(child->place, scene.label() + ": a second ambient temperature");
      scene_.ambient_temperature_k = read_ambient_temperature(context_, node);
      scene_.ambient_position = node.place.position();
    }
  }

  /// Objects that have an effect only as a part of another; they are read by what refers to them.
  static bool is_part(const Node& node) {
    return node.tag == "film" || node.tag == "sampler" || node.tag == "rfilter" ||
           (node.tag == "emitter" && node.type == "area");
  }

  /// Nothing may be ignored in silence: parts that no object refers to.
  void check_parts() {
    for (const auto& child : tree_.root->children) {
      Node& node = child->resolved();
      if (node.kind == TagKind::kObject && node.tag == "medium" && !node.used_as_part)
        warn(context_.sink, node.place.position(),
             ObjectReader(node).label() + ": is not part of a shape and has no effect");
      if (node.kind != TagKind::kObject || !is_part(node)) continue;
      child->used = true;
      if (node.used_as_part) continue;
      const std::string label = ObjectReader(node).label();
      if (node.tag != "emitter") fail(node.place, label + ": is not part of any other object");
      read_area_emitter(context_, node);
      warn(context_.sink, node.place.position(), label + ": is not part of a shape and has no effect");
    }
  }

  void check_whole(const ObjectReader& scene) const {
    if (sensors_ == 0) scene.fail_here("has no sensor");
    if (scene_.shapes.empty() && scene_.instances.empty() && environments_ == 0 && !has_sun_ &&
        !scene_.ambient_temperature_k)
      scene.fail_here("has neither a shape nor an environment");
    bool lit = !scene_.emitters.empty() || scene_.ambient_temperature_k;
    for (const Shape& shape : scene_.shapes)
      lit = lit || shape.emitter || shape.thermal || emits(shape.interior);
    lit = lit || emits(scene_.atmosphere);
    if (!lit) scene.fail_here("has no emitter");
  }

  static bool emits(const std::shared_ptr<const Medium>& medium) {
    return medium && (medium->temperature_k || !std::holds_alternative<std::monostate>(medium->field));
  }

  SceneTree& tree_;
  DiagnosticSink sink_;
  std::set<const Node*> placed_;  // shapes and emitters of the scene
  ReadContext context_;
  ReadErrors errors_;
  SceneDescription scene_;
  ReadIntegrator integrator_;
  int sensors_ = 0, integrators_ = 0, environments_ = 0;
  bool has_sun_ = false;
};

}  // namespace

std::filesystem::path ReadContext::file(const ObjectReader& object, std::string_view parameter) {
  const std::string name = object.require_string(parameter);
  return find_file(tree, name, object.value_place(parameter));
}

std::shared_ptr<const Image> ReadContext::image(const std::filesystem::path& file, bool raw,
                                                const Place& place) {
  auto& image = images[{file, raw}];
  if (!image)
    image = load_at(place, [&] { return std::make_shared<const Image>(read_image(file, raw, sink)); });
  return image;
}

std::shared_ptr<const SpectralImage> ReadContext::spectral_image(const std::filesystem::path& file,
                                                                 bool weights, const Place& place) {
  auto& image = spectral_images[{file, weights}];
  if (!image) {
    image = load_at(place, [&] {
      return std::make_shared<const SpectralImage>(weights ? read_weight_image(file, sink)
                                                           : read_spectral_image(file, sink));
    });
  }
  return image;
}

void accept_obsolete(const ReadContext& context, const ObjectReader& object,
                     std::initializer_list<std::string_view> names) {
  for (const std::string_view name : names) {
    const Node* node = object.find(name);
    if (!node) continue;
    warn(context.sink, node->name_place.position(),
         object.label() + ": parameter '" + node->name + "' of old files has no meaning here");
  }
}

SceneDescription read_scene_text(std::string text, const std::string& name,
                                 const std::filesystem::path& directory, const ReadOptions& options) {
  SceneTree tree = build_tree(std::move(text), name, directory, options.defines);
  SceneDescription scene = SceneReader(tree, options).run();
  if (options.reads)
    for (const auto& file : tree.found) options.reads(file);
  scene.file = name;
  return scene;
}

SceneDescription read_scene(const std::filesystem::path& file, const ReadOptions& options) {
  const std::string name = file.string();
  const Place place{&name, 0, 0};
  std::error_code error;
  const auto status = std::filesystem::status(file, error);
  if (!std::filesystem::exists(status)) fail(place, "file not found");
  if (!std::filesystem::is_regular_file(status)) fail(place, "not a regular file");
  const std::filesystem::path folder =
      file.has_parent_path() ? file.parent_path() : std::filesystem::path(".");
  return read_scene_text(read_text_file(file, place), name, folder, options);
}

}  // namespace kiloband
