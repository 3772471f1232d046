// What the bsdf of a shape comes to: the materials of its two sides, its opacity, what is blended. Internal to src/scene.
#pragma once

#include <memory>
#include <vector>

#include "scene/compile/material/thermal.hpp"

namespace kiloband {

class SurfaceCompiler {
 public:
  SurfaceCompiler(const CompileContext& context, TextureCompiler& textures, MaterialCompiler& materials,
                  ThermalCompiler& thermal);

  /// heat: of the shape, or KB_NONE. Materials and surfaces with different heat are different.
  /// throws InputError  as MaterialCompiler and ThermalCompiler
  uint32_t surface(const std::shared_ptr<const Bsdf>& bsdf, uint32_t heat);

 private:
  /// A number, or a reference to a bitmap: a share from 0 to 1.
  void set_share(const Texture& texture, const SpectrumSource& use, uint32_t& ref, float& constant);
  /// A shape's surface, or a part of a blend.
  uint32_t part(const std::shared_ptr<const Bsdf>& bsdf, uint32_t heat);
  uint32_t new_surface(const std::shared_ptr<const Bsdf>& bsdf, uint32_t heat);
  uint32_t blend(const BlendBsdf& model, const Bsdf& bsdf, uint32_t heat);
  uint32_t add(const KbSurface& record);
  bool refracts(const KbSurface& surface, bool wholly) const;
  void warn_of_inside(const KbSurface& surface, const Bsdf& bsdf, uint32_t heat) const;

  FlatScene& out_;
  const DiagnosticSink& sink_;
  CurrentMesh& current_;
  TextureCompiler& textures_;
  MaterialCompiler& materials_;
  ThermalCompiler& thermal_;
  CompiledBsdfs<uint32_t> surfaces_;                      // by heat
  std::vector<std::shared_ptr<const Bsdf>> distributed_;  // blends moved outwards: keys of the above
};

}  // namespace kiloband
