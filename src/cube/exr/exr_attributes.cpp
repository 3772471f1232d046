// Writing side of exr_layout.hpp.
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFloatAttribute.h>
#include <OpenEXR/ImfStringAttribute.h>

#include <algorithm>
#include <array>
#include <set>

#include "cube/cube_layout.hpp"
#include "cube/cube_text.hpp"
#include "cube/exr/exr_layout.hpp"
#include "cube/exr/exr_names.hpp"

namespace kiloband {
namespace {

constexpr std::string_view kExrListSpecial = " ;";

/// "channel min max [own name];" per band in scene order, bounds in nm.
std::string bands_text(const ExrLayout& layout) {
  std::string text;
  for (std::size_t k = 0; k < layout.means.size(); ++k) {
    const Channel& c = layout.info.bands[k].channel;
    text += encode_text(layout.means[k], kExrListSpecial) + std::string(" ") + format_number(c.min_nm) + " " +
            format_number(c.max_nm);
    if (!c.name.empty()) text.append(" ").append(encode_text(c.name, kExrListSpecial));
    text += ';';
  }
  return text;
}

/// "plane;" per auxiliary plane in order; channels alone would come back sorted by name.
std::string aux_text(const CubeInfo& info) {
  std::string text;
  for (const std::string& name : info.aux) text += encode_text(name, kExrListSpecial) + ";";
  return text;
}

void insert_text(Imf::Header& header, const std::string& name, const std::string& text) {
  header.insert(name, Imf::StringAttribute(text));
}

/// Entries whose names are taken (or begin with the prefix themselves) get the prefix.
void insert_metadata(Imf::Header& header, const CubeInfo& info) {
  for (const auto& [key, value] : info.metadata) {
    const bool taken = key.starts_with(kMetaPrefix) || is_reserved_exr_attribute(key, header.channels());
    insert_text(header, taken ? kMetaPrefix + key : key, value);
  }
}

}  // namespace

bool is_reserved_exr_attribute(const std::string& name, const Imf::ChannelList& channels) {
  // Names of the EXR standard and of the spectral layout, and ours.
  constexpr std::array<std::string_view, 27> kReserved = {"channels",
                                                          "compression",
                                                          "dataWindow",
                                                          "displayWindow",
                                                          "lineOrder",
                                                          "pixelAspectRatio",
                                                          "screenWindowCenter",
                                                          "screenWindowWidth",
                                                          "tiles",
                                                          "name",
                                                          "type",
                                                          "version",
                                                          "chunkCount",
                                                          "view",
                                                          "preview",
                                                          "spectralLayoutVersion",
                                                          "emissiveUnits",
                                                          "EV",
                                                          "polarisationHandedness",
                                                          "cameraResponse",
                                                          "lensTransmission",
                                                          kExrQuantityAttribute,
                                                          kExrBandsAttribute,
                                                          kExrAuxAttribute,
                                                          kExrSamplesAttribute,
                                                          kExrReplicatesAttribute,
                                                          kExrReplicateSamplesAttribute};
  for (const std::string_view reserved : kReserved)
    if (name == reserved) return true;
  return parse_spectral_name(name).has_value() || channels.findChannel(name) != nullptr;
}

ExrLayout plan_exr(const CubeInfo& info, const std::string& where) {
  ExrLayout layout;
  layout.info = info;
  layout.means = exr_band_names(info.bands);
  if (info.variance)
    for (const std::string& name : layout.means) layout.variances.push_back("var." + name);
  std::set<std::string> used(std::begin(kPreviewChannels), std::end(kPreviewChannels));
  used.insert(layout.means.begin(), layout.means.end());
  used.insert(layout.variances.begin(), layout.variances.end());
  for (const std::string& name : info.aux)
    if (!used.insert(name).second || parse_spectral_name(name))
      throw InputError(where + ": auxiliary plane '" + printable(name) +
                       "': the name is that of another EXR channel");
  const auto is_variance = [&](const std::string& mean) { return used.contains("var." + mean); };
  if (!info.variance && std::ranges::all_of(layout.means, is_variance))  // what readers take variances from
    throw InputError(where + ": auxiliary plane '" + printable("var." + layout.means.front()) +
                     "': would be read as the variance of a band");
  for (const auto& [key, value] : info.metadata)
    if (key.empty() || key.size() > kMaxNameLength || key.find('\0') != std::string::npos)
      throw InputError(where + ": metadata name '" + printable(key) + "': must have 1 to " +
                       std::to_string(kMaxNameLength) + " bytes");
  return layout;
}

std::map<std::string, std::string> exr_count_texts(const CubeInfo& info) {
  std::map<std::string, std::string> texts;
  if (info.samples_per_pixel > 0) texts[kExrSamplesAttribute] = std::to_string(info.samples_per_pixel);
  if (info.replicates > 0) texts[kExrReplicatesAttribute] = std::to_string(info.replicates);
  for (const uint64_t samples : info.replicate_samples) {
    std::string& list = texts[kExrReplicateSamplesAttribute];
    list += (list.empty() ? "" : ",") + std::to_string(samples);
  }
  return texts;
}

void write_exr_attributes(Imf::Header& header, const ExrLayout& layout) {
  const CubeInfo& info = layout.info;
  const Imf::Channel channel(Imf::FLOAT);
  for (std::size_t k = 0; k < layout.means.size(); ++k) {
    header.channels().insert(layout.means[k], channel);
    if (!info.bands[k].derived) insert_text(header, layout.means[k], sensitivity_text(info.bands[k].channel));
  }
  for (const std::string& name : layout.variances) header.channels().insert(name, channel);
  for (const std::string& name : info.aux) header.channels().insert(name, channel);
  for (const std::string_view name : kPreviewChannels) header.channels().insert(std::string(name), channel);

  insert_text(header, "spectralLayoutVersion", "1.0");
  insert_text(header, "emissiveUnits", kExrUnits);
  header.insert("EV", Imf::FloatAttribute(0));
  insert_text(header, kExrQuantityAttribute,
              info.quantity == Quantity::kDensity ? kExrDensityText : kExrIntegralText);
  insert_text(header, kExrBandsAttribute, bands_text(layout));
  if (!info.aux.empty()) insert_text(header, kExrAuxAttribute, aux_text(info));
  for (const auto& [name, text] : exr_count_texts(info)) insert_text(header, name, text);
  insert_metadata(header, info);
}

}  // namespace kiloband
