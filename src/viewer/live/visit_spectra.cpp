#include <fmt/format.h>

#include <map>
#include <memory>

#include "viewer/live/scene_spectra.hpp"

namespace kiloband::viewer {
namespace {

using Type = SpectrumSlot::Type;

std::string named(const char* kind, const std::string& id, std::size_t number) {
  return id.empty() ? fmt::format("{} {}", kind, number) : fmt::format("{} '{}'", kind, id);
}

/// Walks over a description that it may change; every BSDF and group is copied and visited once.
class Visitor {
 public:
  explicit Visitor(const std::function<void(SpectrumSlot&)>& visit) : visit_(visit) {}

  void scene(SceneDescription& scene) {
    for (std::size_t i = 0; i < scene.shapes.size(); ++i) shape(scene.shapes[i], i);
    for (Instance& placed : scene.instances) instance(placed);
    for (std::size_t i = 0; i < scene.emitters.size(); ++i) emitter(scene.emitters[i], i);
    if (scene.ambient_temperature_k)
      number(Type::kTemperature, "surroundings", "temperature", "K", *scene.ambient_temperature_k);
  }

 private:
  void spectrum(Type type, const std::string& owner, const char* role, const char* unit, Spectrum& spectrum,
                Spectrum* second = nullptr, const std::string& material = {}) {
    // Of a file its name alone: folders are nobody's business.
    SpectrumSlot slot{type,      owner,  role,   unit, material.substr(material.rfind('/') + 1),
                      &spectrum, second, nullptr};
    visit_(slot);
  }
  void number(Type type, const std::string& owner, const char* role, const char* unit, double& value) {
    SpectrumSlot slot{type, owner, role, unit, {}, nullptr, nullptr, &value};
    visit_(slot);
  }
  /// Textures are left as they are.
  void texture(Type type, const std::string& owner, const char* role, const char* unit, Texture& texture) {
    if (auto* constant = std::get_if<Spectrum>(&texture)) spectrum(type, owner, role, unit, *constant);
  }

  void shape(Shape& shape, std::size_t index) {
    const std::string owner = named("shape", shape.id, index);
    shape.bsdf = bsdf(shape.bsdf);
    if (shape.emitter)
      texture(Type::kEmission, owner, "radiance", "W m-2 sr-1 nm-1", shape.emitter->radiance);
    if (shape.thermal && !shape.thermal->texture && shape.thermal->attribute.empty())
      number(Type::kTemperature, owner, "temperature", "K", shape.thermal->temperature_k);
  }

  void instance(Instance& instance) { instance.group = group(instance.group); }

  std::shared_ptr<const ShapeGroup> group(const std::shared_ptr<const ShapeGroup>& original) {
    auto& copy = groups_[original.get()];
    if (copy) return copy;
    auto changed = std::make_shared<ShapeGroup>(*original);
    for (std::size_t i = 0; i < changed->shapes.size(); ++i) shape(changed->shapes[i], i);
    for (Instance& nested : changed->instances) instance(nested);
    return groups_[original.get()] = changed;
  }

  std::shared_ptr<const Bsdf> bsdf(const std::shared_ptr<const Bsdf>& original) {
    if (!original) return original;
    if (const auto known = bsdfs_.find(original.get()); known != bsdfs_.end()) return known->second;
    auto changed = std::make_shared<Bsdf>(*original);
    const std::string owner = named("bsdf", changed->id, bsdfs_.size());
    bsdfs_[original.get()] = changed;
    std::visit([&](auto& model) { this->model(model, owner); }, changed->model);
    return changed;
  }

  void model(DiffuseBsdf& m, const std::string& owner) {
    texture(Type::kReflectance, owner, "reflectance", "1", m.reflectance);
  }
  void model(ConductorBsdf& m, const std::string& owner) {
    spectrum(Type::kMetal, owner, "index of refraction", "1", m.eta, &m.k, m.material);
  }
  void model(DielectricBsdf& m, const std::string& owner) {
    spectrum(Type::kGlass, owner, "index of refraction inside", "1", m.int_ior, nullptr, m.material);
  }
  void model(PlasticBsdf& m, const std::string& owner) {
    texture(Type::kReflectance, owner, "diffuse reflectance", "1", m.diffuse_reflectance);
  }
  void model(PrincipledBsdf& m, const std::string& owner) {
    texture(Type::kReflectance, owner, "base colour", "1", m.base_color);
  }
  void model(TwoSidedBsdf& m, const std::string&) {
    m.front = bsdf(m.front);
    m.back = bsdf(m.back);
  }
  void model(MaskBsdf& m, const std::string&) { m.nested = bsdf(m.nested); }
  void model(BlendBsdf& m, const std::string&) {
    m.first = bsdf(m.first);
    m.second = bsdf(m.second);
  }
  void model(BumpedBsdf& m, const std::string&) { m.nested = bsdf(m.nested); }
  void model(NullBsdf&, const std::string&) {}

  void emitter(Emitter& emitter, std::size_t index) {
    const std::string owner = named("emitter", emitter.id, index);
    if (auto* constant = std::get_if<ConstantEmitter>(&emitter.model))
      spectrum(Type::kEmission, owner, "radiance", "W m-2 sr-1 nm-1", constant->radiance);
    if (auto* map = std::get_if<EnvmapEmitter>(&emitter.model))
      number(Type::kScale, owner, "scale", "1", map->scale);
    if (auto* map = std::get_if<SpectralEnvmapEmitter>(&emitter.model))
      number(Type::kScale, owner, "scale", "1", map->scale);
    if (auto* point = std::get_if<PointEmitter>(&emitter.model))
      spectrum(Type::kEmission, owner, "intensity", "W sr-1 nm-1", point->intensity);
    if (auto* spot = std::get_if<SpotEmitter>(&emitter.model))
      spectrum(Type::kEmission, owner, "intensity", "W sr-1 nm-1", spot->intensity);
    if (auto* projector = std::get_if<ProjectorEmitter>(&emitter.model))
      number(Type::kScale, owner, "scale", "1", projector->scale);
    if (auto* directional = std::get_if<DirectionalEmitter>(&emitter.model))
      spectrum(Type::kEmission, owner, "irradiance", "W m-2 nm-1", directional->irradiance);
  }

  const std::function<void(SpectrumSlot&)>& visit_;
  std::map<const Bsdf*, std::shared_ptr<const Bsdf>> bsdfs_;
  std::map<const ShapeGroup*, std::shared_ptr<const ShapeGroup>> groups_;
};

}  // namespace

void visit_spectra(SceneDescription& scene, const std::function<void(SpectrumSlot&)>& visit) {
  Visitor(visit).scene(scene);
}

}  // namespace kiloband::viewer
