// The spectra, temperatures and powers of a scene: a list of them, and other values in their place.
#pragma once

#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <variant>

#include "scene/description/description.hpp"

namespace kiloband::viewer {

/// A place of a description where a page may put something else.
struct SpectrumSlot {
  enum class Type { kReflectance, kEmission, kMetal, kGlass, kTemperature, kScale };
  Type type = Type::kReflectance;
  std::string owner, role, unit;
  std::string name;              // of the metal or glass in the scene file; empty: it has none
  Spectrum* spectrum = nullptr;  // null: a number
  Spectrum* second = nullptr;    // kMetal: k, `spectrum` being n
  double* number = nullptr;      // kTemperature: K; kScale
};

/// Calls `visit` for every slot, always in the same order. BSDFs and groups are copied before, so that what shares
/// them with `scene` stays as it is; meshes and images are not.
void visit_spectra(SceneDescription& scene, const std::function<void(SpectrumSlot&)>& visit);

class SpectrumEdits {
 public:
  /// wanted  {"id", "set"} as in docs/viewer.md
  /// range   of the wavelengths that are rendered
  /// throws InputError  no such slot, values that it cannot have
  void set(const SceneDescription& original, const Channel& range, const nlohmann::json& wanted);
  /// Whether all that was set suits other channels, too.
  /// throws InputError  it does not
  void check_all(const SceneDescription& original, const Channel& range) const;
  /// The scene with all that was set.
  SceneDescription apply(const SceneDescription& original) const;
  /// "reflectance of bsdf 'paint' = 0.25; radiance of emitter 'sky' x 3": what is not as in the scene file; empty: nothing.
  std::string summary(const SceneDescription& original) const;
  /// Member "spectra" of /api/scene.
  nlohmann::json list(const SceneDescription& original, const Channel& range) const;

 private:
  struct Scale {
    double factor;
  };
  struct Temperature {
    double kelvin;
  };
  struct Pair {
    Spectrum n, k;
  };
  struct Edit {
    std::variant<Spectrum, Pair, Temperature, Scale> value;
    std::string name;  // of a metal or glass
  };

  static Edit parse(const SpectrumSlot& slot, const nlohmann::json& wanted);
  static Edit parse_material(const SpectrumSlot& slot, const std::string& kind, const std::string& name);
  static void apply_to(SpectrumSlot& slot, const Edit& edit);
  static void check(const SpectrumSlot& slot, const Channel& rendered);

  std::map<std::string, Edit> edits_;  // by the slot's id
};

}  // namespace kiloband::viewer
