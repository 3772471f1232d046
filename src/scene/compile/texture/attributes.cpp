// Attributes of meshes as textures: texels by triangle.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "scene/compile/texture/texel_memo.hpp"
#include "scene/compile/texture/textures.hpp"
#include "spectral/colour/rgb.hpp"

namespace kiloband {
namespace {

using Values = std::vector<float>;

/// One value, or three of a colour, for every vertex or triangle.
struct Attribute {
  bool of_faces = false;
  std::vector<const Values*> parts;
  double unit = 1;  // 1/255: of colours in bytes
};

/// Of which properties the attribute NAME may consist: r, g, b or red, green, blue are "color", NAME_r, NAME_g, NAME_b are "NAME_color";
/// NAME itself, or followed by _ and one character, is one value. The first list that the mesh has counts.
std::vector<std::vector<std::string>> property_lists(const std::string& name,
                                                     const std::map<std::string, Values>& properties) {
  std::vector<std::vector<std::string>> lists;
  if (name == "color") lists = {{"r", "g", "b"}, {"red", "green", "blue"}};
  if (name.ends_with("_color")) {
    const std::string prefix = name.substr(0, name.size() - 6);
    lists.push_back({prefix + "_r", prefix + "_g", prefix + "_b"});
  }
  lists.push_back({name});
  std::vector<std::string> numbered;
  for (const auto& [property, values] : properties)
    if (property.size() == name.size() + 2 && property.starts_with(name + "_")) numbered.push_back(property);
  if (numbered.size() == 1) lists.push_back(numbered);
  return lists;
}

Attribute find_attribute(const Mesh& mesh, const MeshAttributeTexture& texture) {
  Attribute attribute;
  attribute.of_faces = texture.name.starts_with("face_");
  const std::string element = attribute.of_faces ? "face" : "vertex";
  const auto& properties = attribute.of_faces ? mesh.face_attributes : mesh.vertex_attributes;
  for (const auto& list : property_lists(texture.name.substr(element.size() + 1), properties)) {
    if (!std::ranges::all_of(list, [&](const auto& property) { return properties.contains(property); }))
      continue;
    for (const std::string& property : list) attribute.parts.push_back(&properties.at(property));
    if (list.size() == 3 && mesh.byte_attributes.contains(element + " " + list.front()))
      attribute.unit = 1 / 255.0;
    break;
  }
  return attribute;
}

/// Two rows of two texels for vertices, one for faces.
struct Cells {
  uint32_t size, across;  // of a cell; triangles side by side

  Cells(bool of_faces, std::size_t triangles)
      : size(of_faces ? 1 : 2),
        across(static_cast<uint32_t>(std::min<std::size_t>(triangles, KB_TRIANGLES_ACROSS))) {}
  uint32_t width() const { return size * across; }
  uint32_t height(std::size_t triangles) const {
    return size * static_cast<uint32_t>((triangles + across - 1) / across);
  }
};

}  // namespace

/// Of every vertex or face: of a colour the spectrum of a reflectance, or a multiple of one; of one value, and of a share, a flat one.
std::vector<KbFloat4> TextureCompiler::attribute_texels(const std::vector<const std::vector<float>*>& parts,
                                                        double unit, bool share) {
  std::vector<KbFloat4> texels(parts.front()->size());
  TexelMemo memo(texels.size());
  for (std::size_t at = 0; at < texels.size(); ++at) {
    float values[3];
    for (std::size_t i = 0; i < 3; ++i)
      values[i] = static_cast<float>(unit * (*parts[parts.size() == 3 ? i : 0])[at]);
    if (share) std::fill_n(values, 3, luminance_of(values));
    texels[at] =
        memo.find(values, [&] { return SolvedTexel{texel_of(values, BitmapUse::kPicture, 1)}; }).texel;
  }
  return texels;
}

uint32_t TextureCompiler::mesh_attribute(const std::shared_ptr<const MeshAttributeTexture>& texture,
                                         const SpectrumSource& use, bool share) {
  const std::string label = fmt::format("{}: mesh_attribute '{}'", use.name, texture->name);
  if (!current_.mesh) throw InputError(texture->position, label + ": only meshes have attributes");
  ++current_.lookups;
  const BitmapUse kind = share          ? BitmapUse::kOpacity
                         : use.emission ? BitmapUse::kEmission
                                        : BitmapUse::kPicture;
  const auto [place, is_new] = attributes_.try_emplace({texture.get(), current_.mesh, kind},
                                                       static_cast<uint32_t>(out_.textures.size()));
  if (!is_new) return place->second;
  const Attribute attribute = find_attribute(*current_.mesh, *texture);
  if (attribute.parts.empty())
    throw InputError(texture->position, label + ": the mesh has no properties of this name");
  const double unit = attribute.unit * texture->scale, most = use.emission ? kMaxEmission : 1;
  for (const auto* part : attribute.parts)
    for (const float value : *part)
      if (!(value * unit >= 0 && value * unit <= most * (1 + 1e-6)))
        throw InputError(texture->position, fmt::format("{}: a value is {:g}: must be from 0 to {:g}", label,
                                                        value * unit, most));
  out_.features.bitmap = out_.features.mesh_attribute = true;
  const auto& triangles = current_.mesh->triangles;
  const Cells cells(attribute.of_faces, triangles.size());
  KbTexture record{};
  record.width = cells.width();
  record.height = cells.height(triangles.size());
  record.wrap = KB_WRAP_CLAMP;
  record.flags =
      KB_TEXTURE_TRIANGLES | (attribute.of_faces ? KB_TEXTURE_NEAREST : 0) | (share ? KB_TEXTURE_NUMBERS : 0);
  record.illuminant_row = KB_NONE;
  store_uv_transform(glm::dmat3(1.0), record.to_uv);
  const std::size_t count = std::size_t{record.width} * record.height;
  record.first_texel = static_cast<uint32_t>(out_.texels.size());
  record.first_bound = first_texel_index(out_.texel_bounds.size(), count, texture->position, texture->name);
  out_.texels.resize(out_.texels.size() + count, KbFloat4{0, 0, 0, 0});
  KbFloat4* texels = &out_.texels[record.first_texel];
  const std::vector<KbFloat4> solved = attribute_texels(attribute.parts, unit, share);
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    KbFloat4* cell = texels + cells.size * (t / cells.across * record.width + t % cells.across);
    cell[0] = solved[attribute.of_faces ? t : triangles[t][0]];
    if (attribute.of_faces) continue;
    cell[1] = solved[triangles[t][1]];
    cell[record.width] = cell[record.width + 1] = solved[triangles[t][2]];
  }
  finish_attribute(record, count, use.emission);
  return place->second;
}

/// Bounds, mean and largest of the texels that were added last, of which numbers keep their bounds alone.
void TextureCompiler::finish_attribute(KbTexture record, std::size_t count, bool emits) {
  double sum = 0, largest = 0, peak = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const KbFloat4& texel = out_.texels[record.first_texel + i];
    const double bound = texel_bound(texel);
    out_.texel_bounds.push_back(static_cast<float>(bound));
    sum += bound;
    largest = std::max(largest, bound);
    peak = std::max(peak, double{texel.w});
  }
  if (emits) peaks_.raw = std::max(peaks_.raw, peak);
  if (record.flags & KB_TEXTURE_NUMBERS) {
    out_.texels.resize(record.first_texel);
    record.first_texel = 0;
  }
  add_record(record, sum / static_cast<double>(count), largest);
}

}  // namespace kiloband
