// Media: gases, and what is inside of shapes. Internal to src/scene.
#pragma once

#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "scene/compile/compile_context.hpp"

namespace kiloband {

class MediumCompiler {
 public:
  /// sources: of the shape records
  MediumCompiler(const CompileContext& context, const std::vector<const Shape*>& sources);

  /// A scene has gas if it has a medium or a null boundary; otherwise nothing of all this exists.
  /// throws InputError  more media than paths can name, or a boundary that a hot gas cannot have
  void add_media();

 private:
  uint32_t medium(const std::shared_ptr<const Medium>& medium, uint32_t boundary);
  uint32_t gas_emission_row(double temperature_k, uint32_t boundary, const std::string& name);
  uint32_t add_medium(const KbMedium& record, const std::string& name, const SourcePosition& position);
  bool refracting_materials(const KbSurface& surface, std::vector<uint32_t>& found) const;
  uint32_t interior(uint32_t shape_index);
  uint32_t add_inside(uint32_t shape_index);
  void part_instances();
  void set_grid(KbMedium& record, const GridField& grid);
  void set_jet(KbMedium& record, const JetField& jet);
  void set_ladder(KbMedium& record) const;

  const DiagnosticSink& sink_;
  const SceneDescription& in_;
  FlatScene& out_;
  SpectrumTableBuilder& spectra_;
  const std::vector<const Shape*>& sources_;
  std::map<std::pair<const void*, uint32_t>, uint32_t> media_;  // by medium and the boundary's material
  std::map<const Shape*, uint32_t> interiors_;                  // that are not a medium's
  std::vector<uint32_t> repeated_;  // shapes that share one of these with an instance before
};

}  // namespace kiloband
