#include "scene/compile/media.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "base/diagnostics.hpp"
#include "scene/compile/material/materials.hpp"
#include "scene/compile/place.hpp"
#include "scene/compile/record_vectors.hpp"
#include "spectral/planck.hpp"

namespace kiloband {
namespace {

constexpr std::size_t kMaxMedia = 65534;  // a path remembers them as 16-bit numbers, 0 for none

std::string describe(const Medium& medium) {
  return medium.id.empty() ? "medium" : "medium '" + medium.id + "'";
}

KbMedium empty_medium(uint32_t type) {
  KbMedium record{};
  record.type = type;
  record.row = record.emit_row = KB_NONE;
  record.scale = 1;
  return record;
}

void set_to_local(KbMedium& record, const Transform& to_world, const glm::dvec3& scale) {
  store_transform(glm::scale(Transform{1.0}, scale) * glm::inverse(to_world), record.to_local);
}

}  // namespace

MediumCompiler::MediumCompiler(const CompileContext& context, const std::vector<const Shape*>& sources)
    : sink_(context.options.sink),
      in_(context.in),
      out_(context.out),
      spectra_(context.spectra),
      sources_(sources) {}

/// hc / (k lambda T) from the longest to the shortest rendered wavelength, in equal ratios.
void MediumCompiler::set_ladder(KbMedium& record) const {
  const Channel range = hull(out_.channels);
  const double low = kPlanckSecond_nm_k / (range.max_nm * record.reference_k);
  const double ratio = range.max_nm / range.min_nm;
  for (int j = 0; j < KB_PLUME_LADDER; ++j)
    record.second[j] = static_cast<float>(low * std::pow(ratio, j / (KB_PLUME_LADDER - 1.0)));
}

void MediumCompiler::set_grid(KbMedium& record, const GridField& grid) {
  record.type = KB_MEDIUM_GRID;
  record.first_node = static_cast<uint32_t>(out_.plume_nodes.size());
  std::ranges::copy(grid.nodes, record.nodes);
  for (const GridField::Node& node : grid.values) {
    record.reference_k = std::max(record.reference_k, node.temperature_k);
    out_.plume_nodes.push_back({node.temperature_k, node.scale});
  }
  set_to_local(record, placed_at(out_.origin, grid.to_world),
               {grid.nodes[0] - 1.0, grid.nodes[1] - 1.0, grid.nodes[2] - 1.0});
}

void MediumCompiler::set_jet(KbMedium& record, const JetField& jet) {
  record.type = KB_MEDIUM_JET;
  record.temperature_k = static_cast<float>(jet.temperature_k);
  record.ambient_k = static_cast<float>(jet.ambient_k);
  record.radius = static_cast<float>(jet.radius);
  record.spread = static_cast<float>(jet.spread);
  record.length = static_cast<float>(jet.length);
  record.reference_k = std::max(record.temperature_k, record.ambient_k);
  set_to_local(record, placed_at(out_.origin, jet.to_world), {1, 1, 1});
}

uint32_t MediumCompiler::add_medium(const KbMedium& record, const std::string& name,
                                    const SourcePosition& position) {
  if (out_.media.size() >= kMaxMedia)
    throw InputError(position, fmt::format("more than {} media and shapes that transmit light", kMaxMedia));
  out_.media.push_back(record);
  out_.medium_names.push_back(name);
  return static_cast<uint32_t>(out_.media.size() - 1);
}

/// In a body of relative index n the radiance of equilibrium is n^2 B: what refraction into it multiplies by
/// n^2, its gas has to add. `boundary`: the body's material, KB_NONE for a null boundary or the atmosphere.
uint32_t MediumCompiler::gas_emission_row(double temperature_k, uint32_t boundary, const std::string& name) {
  SpectrumRow row;
  row.name = name + ": temperature";
  row.is_planck = row.is_emission = true;
  row.temperature_k = temperature_k;
  row.bound = 1;
  if (boundary != KB_NONE && (out_.materials[boundary].flags & KB_MATERIAL_DISPERSIVE)) {
    const KbMaterial& glass = out_.materials[boundary];
    row.table = out_.spectra[glass.eta_row].table;
    for (std::size_t i = 0; i < row.table.values.size(); ++i) {
      const double lambda_nm = row.table.min_nm + static_cast<double>(i) * row.table.step_nm;
      const double outside =
          glass.ext_row == KB_NONE ? glass.eta_ext : out_.spectra[glass.ext_row].table(lambda_nm);
      row.table.values[i] = std::pow(row.table.values[i] / outside, 2);
    }
  } else if (boundary != KB_NONE) {
    row.planck_scale = std::pow(double{out_.materials[boundary].eta}, 2);
  }
  return spectra_.add(std::move(row));
}

uint32_t MediumCompiler::medium(const std::shared_ptr<const Medium>& medium, uint32_t boundary) {
  const auto [place, is_new] = media_.try_emplace({medium.get(), boundary}, KB_NONE);
  if (!is_new) return place->second;
  const std::string name = describe(*medium);
  KbMedium record = empty_medium(KB_MEDIUM_HOMOGENEOUS);
  record.scale = static_cast<float>(medium->scale);
  record.row = spectra_.absorption_row(medium->absorption, medium->spectrum,
                                       {name + ": absorption", medium->position, false});
  if (medium->temperature_k) record.reference_k = static_cast<float>(*medium->temperature_k);
  if (const auto* grid = std::get_if<GridField>(&medium->field)) set_grid(record, *grid);
  if (const auto* jet = std::get_if<JetField>(&medium->field)) set_jet(record, *jet);
  if (record.type != KB_MEDIUM_HOMOGENEOUS) {
    out_.features.plume = true;
    set_ladder(record);
  }
  if (record.reference_k > 0) record.emit_row = gas_emission_row(record.reference_k, boundary, name);
  const std::string label = medium->id.empty() ? fmt::format("medium {}", out_.media.size()) : medium->id;
  return place->second = add_medium(record, label, medium->position);
}

/// The dielectrics by which light gets inside; panes have no inside. Returns whether light gets in without refraction, too:
/// by the openings of a mask or by a pane.
bool MediumCompiler::refracting_materials(const KbSurface& surface, std::vector<uint32_t>& found) const {
  if (surface.flags & KB_SURFACE_BLEND) {
    const bool first = refracting_materials(out_.surfaces[surface.first], found);
    return refracting_materials(out_.surfaces[surface.second], found) || first;
  }
  const bool open = surface.opacity_ref != KB_NONE || surface.opacity < 1;
  if (!(surface.flags & KB_SURFACE_TRANSMISSIVE)) return open;
  if (out_.materials[surface.front].flags & KB_MATERIAL_THIN) return true;
  if (std::ranges::find(found, surface.front) == found.end()) found.push_back(surface.front);
  return open;
}

/// What is inside a shape: its medium; nothing, where light enters a body without one. A hot gas inside has to radiate
/// n^2 B towards where its light is refracted on leaving, which divides by n^2, and B towards where it is not: no one
/// radiance would do for both.
uint32_t MediumCompiler::interior(uint32_t shape_index) {
  const Shape& shape = *sources_[shape_index];
  std::vector<uint32_t> boundaries;
  const bool open = refracting_materials(out_.surfaces[out_.shapes[shape_index].surface], boundaries);
  if (boundaries.size() > 1 && shape.interior) {
    throw InputError(shape.position,
                     fmt::format("shape '{}': blended dielectrics cannot bound a medium: what it "
                                 "emits inside depends on the index that light enters by",
                                 out_.shape_names[shape_index]));
  }
  if (shape.interior) {
    const uint32_t boundary = boundaries.empty() ? KB_NONE : boundaries.front();
    const uint32_t inside = medium(shape.interior, boundary);
    const bool hot = out_.media[inside].emit_row != KB_NONE;
    if (open && hot && boundary != KB_NONE && bends_light(out_.materials[boundary]))
      throw InputError(shape.position,
                       fmt::format("shape '{}': a dielectric in a mask or blended with a pane cannot bound a "
                                   "medium with a temperature: what it emits inside depends on whether light "
                                   "leaves by refraction",
                                   out_.shape_names[shape_index]));
    return inside;
  }
  if (boundaries.empty()) return KB_NONE;
  const auto [inside, is_new] = interiors_.try_emplace(&shape);
  if (is_new)
    inside->second = add_inside(shape_index);
  else
    repeated_.push_back(shape_index);
  return inside->second;
}

uint32_t MediumCompiler::add_inside(uint32_t shape_index) {
  return add_medium(empty_medium(KB_MEDIUM_EMPTY), "inside of " + out_.shape_names[shape_index],
                    sources_[shape_index]->position);
}

/// Instances of a glass body may stand in each other: each has an inside of its own, while there are numbers.
void MediumCompiler::part_instances() {
  if (repeated_.size() <= kMaxMedia - out_.media.size()) {
    for (const uint32_t shape : repeated_) out_.interiors[shape] = add_inside(shape);
    return;
  }
  const uint32_t first = repeated_.front();
  warn(sink_, sources_[first]->position,
       fmt::format("shape '{}': more than {} media and shapes that transmit light: instances of one shape "
                   "count as one body, which is wrong where they stand in each other",
                   out_.shape_names[first], kMaxMedia));
}

void MediumCompiler::add_media() {
  const bool bounded =
      std::ranges::any_of(out_.shapes, [](const KbShape& s) { return s.flags & KB_SHAPE_NULL; });
  const bool filled = std::ranges::any_of(in_.shapes, [](const Shape& s) { return s.interior != nullptr; });
  if (!bounded && !filled && !in_.atmosphere) return;
  out_.features.gas = true;
  if (in_.atmosphere) out_.atmosphere = medium(in_.atmosphere, KB_NONE);
  for (uint32_t i = 0; i < out_.shapes.size(); ++i) out_.interiors.push_back(interior(i));
  part_instances();
}

}  // namespace kiloband
