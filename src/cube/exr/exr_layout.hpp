// Which channels and attributes of an EXR file mean what; docs/output_formats.md lists them.
#pragma once

#include <OpenEXR/ImfHeader.h>

#include <string>
#include <vector>

#include "cube/cube_io.hpp"

namespace kiloband {

/// A cube as the channels of an EXR file.
struct ExrLayout {
  CubeInfo info;
  std::vector<std::string> means, variances;  // channel names in band order; variances may be empty
  bool preview = true;                        // R, G, B
};

/// Channel names for a cube.
/// throws InputError  an auxiliary plane has the name of another channel
ExrLayout plan_exr(const CubeInfo& info, const std::string& where);

/// Of the attributes that state samples and replicates: name and text of those that are known.
std::map<std::string, std::string> exr_count_texts(const CubeInfo& info);

/// Adds channels and attributes. Only width and height of the header must be set before.
void write_exr_attributes(Imf::Header& header, const ExrLayout& layout);

/// The cube that a header describes: our own attributes where they fit the channels,
/// the plain layout otherwise.
/// throws InputError  no spectral channels, contradictions
ExrLayout read_exr_layout(const Imf::Header& header, const std::string& where, const DiagnosticSink& sink);

// Attributes of our own.
inline constexpr char kExrBandsAttribute[] = "kilobandBands";
inline constexpr char kExrAuxAttribute[] = "kilobandAux";
inline constexpr char kExrSamplesAttribute[] = "kilobandSamplesPerPixel";
inline constexpr char kExrReplicatesAttribute[] = "kilobandReplicates";
inline constexpr char kExrReplicateSamplesAttribute[] = "kilobandReplicateSamples";
inline constexpr char kExrQuantityAttribute[] = "bandQuantity";
inline constexpr char kExrUnits[] = "W.m^-2.sr^-1";
inline constexpr char kExrDensityText[] = "mean spectral radiance of the band, W.m^-2.sr^-1.nm^-1";
inline constexpr char kExrIntegralText[] = "band radiance (integral over the band), W.m^-2.sr^-1";
/// Put before the name of a metadata entry that would collide with another attribute.
inline constexpr char kMetaPrefix[] = "meta.";

/// Attribute names that metadata must not take; `channels` are the file's channel names.
bool is_reserved_exr_attribute(const std::string& name, const Imf::ChannelList& channels);

}  // namespace kiloband
