// Materials: records of bsdfs that scatter, and their tables. Internal to src/scene.
#pragma once

#include <map>
#include <memory>
#include <tuple>
#include <utility>
#include <vector>

#include "scene/compile/compile_context.hpp"
#include "scene/compile/material/compiled_bsdfs.hpp"
#include "scene/compile/texture/textures.hpp"
#include "scene/optics/coating.hpp"

namespace kiloband {

class MaterialCompiler {
 public:
  MaterialCompiler(const CompileContext& context, TextureCompiler& textures);

  /// Index of the bsdf's material. Its name: its own id, or that of the bsdf that it is nested in, or a number.
  /// compensated: what multiple scattering would add is scaled up to (KB_MATERIAL_COMPENSATED)
  /// throws InputError  no bsdf that scatters, or what its textures and spectra say
  uint32_t material(const std::shared_ptr<const Bsdf>& bsdf, bool compensated, const std::string& outer_id);
  /// Equal coatings are computed once.
  const Coating& coating(const KbMaterial& material);

 private:
  KbMaterial make(const DiffuseBsdf& model, const std::string& name, const SourcePosition& position);
  KbMaterial make(const ConductorBsdf& model, const std::string& name, const SourcePosition& position);
  KbMaterial make(const DielectricBsdf& model, const std::string& name, const SourcePosition& position);
  KbMaterial make(const PlasticBsdf& model, const std::string& name, const SourcePosition& position);
  KbBump bump(const BumpedBsdf& bumped);
  KbRoughness roughness_maps(const Bsdf& scattering);
  // principled.cpp
  KbMaterial make(const PrincipledBsdf& model, const std::string& name, const SourcePosition& position);
  /// The material's table.
  std::vector<float> principled_numbers(const PrincipledBsdf& model, const std::string& name,
                                        const SourcePosition& position);
  void add_principled_maps(const PrincipledBsdf& model);
  // material_tables.cpp
  const std::vector<float>& conductor_bound(const KbMaterial& material);
  void set_tables(KbMaterial& material, const std::vector<float>& compensation);
  std::vector<float> compensate(KbMaterial& material, const Bsdf& bsdf);

  const DiagnosticSink& sink_;
  FlatScene& out_;
  SpectrumTableBuilder& spectra_;
  CurrentMesh& current_;
  TextureCompiler& textures_;
  CompiledBsdfs<bool> materials_;                                   // by compensation
  std::map<std::tuple<uint32_t, float, float>, Coating> coatings_;  // by distribution, roughness, index
  std::map<std::pair<uint32_t, uint32_t>, std::vector<float>> conductor_bounds_;  // by rows of n and k
};

/// Without references and tables.
KbMaterial empty_material(uint32_t type);
bool is_metal(const KbMaterial& material);
/// Of a dielectric: whether its index differs from that around it.
bool bends_light(const KbMaterial& material);

/// "bsdf 'wall'", for messages.
std::string describe(const Bsdf& bsdf);

/// Where the table begins in FlatScene::tables.
uint32_t append_table(FlatScene& scene, const std::vector<float>& table);
/// 1 for an empty table.
double largest_value(const RegularTable& table);

}  // namespace kiloband
