// Reading side of exr_layout.hpp.
#include "cube/exr/exr_layout.hpp"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFloatAttribute.h>
#include <OpenEXR/ImfStringAttribute.h>

#include <algorithm>
#include <iterator>
#include <set>

#include "base/text.hpp"
#include "cube/cube_layout.hpp"
#include "cube/cube_text.hpp"
#include "cube/exr/exr_names.hpp"

namespace kiloband {
namespace {

std::optional<std::string> text_attribute(const Imf::Header& header, const std::string& name) {
  const auto* attribute = header.findTypedAttribute<Imf::StringAttribute>(name);
  if (!attribute) return std::nullopt;
  return attribute->value();
}

/// A number that we wrote as text (EXR's integers have 32 bits); 0 where it is missing.
uint64_t count_attribute(const Imf::Header& header, const char* name, uint64_t largest,
                         const std::string& where) {
  const auto text = text_attribute(header, name);
  if (!text) return 0;
  const auto value = parse_unsigned(*text);
  if (!value || *value > largest)
    throw InputError(where + ": " + name + " '" + printable(*text) + "': must be a whole number, at most " +
                     std::to_string(largest));
  return *value;
}

/// Fills bands from our own attribute; false where the attribute is missing or does not fit the channels any
/// more (another program added or dropped some).
bool read_own_bands(const Imf::Header& header, ExrLayout& layout) {
  const auto text = text_attribute(header, kExrBandsAttribute);
  if (!text) return false;
  for (const std::string_view line : split(*text, ';')) {
    if (line.empty()) continue;
    const auto words = split(line, ' ');
    const auto low = words.size() > 1 ? parse_number(words[1]) : std::nullopt;
    const auto high = words.size() > 2 ? parse_number(words[2]) : std::nullopt;
    if (!low || !high || words.size() > 4) return false;
    Band band{{*low, *high, words.size() > 3 ? decode_text(words[3]) : ""}, false};
    layout.means.push_back(decode_text(words[0]));
    band.derived = layout.means.back().starts_with("response.");
    if (!header.channels().findChannel(layout.means.back())) return false;
    layout.info.bands.push_back(std::move(band));
  }
  const std::set<std::string> listed(layout.means.begin(), layout.means.end());
  if (listed.size() != layout.means.size()) return false;
  for (auto c = header.channels().begin(); c != header.channels().end(); ++c)
    if (const auto name = parse_spectral_name(c.name()); name && name->kind == 'S' && name->stokes == 0)
      if (!listed.contains(c.name())) return false;
  return !layout.means.empty();
}

struct ForeignBand {
  std::string channel;
  double centre_nm;
};

/// The spectral channels of a file that says nothing more, by ascending wavelength.
std::vector<ForeignBand> find_spectral_channels(const Imf::Header& header, const std::string& where,
                                                const DiagnosticSink& sink) {
  std::vector<ForeignBand> emissive, reflective;
  bool polarised = false;
  for (auto c = header.channels().begin(); c != header.channels().end(); ++c) {
    const auto name = parse_spectral_name(c.name());
    if (!name) continue;
    if (name->kind == 'T')
      reflective.push_back({c.name(), name->centre_nm});
    else if (name->stokes == 0)
      emissive.push_back({c.name(), name->centre_nm});
    else
      polarised = true;
  }
  if (polarised) warn(sink, {where}, "polarised channels (S1, S2, S3) are ignored");
  if (!emissive.empty() && !reflective.empty()) warn(sink, {where}, "reflective channels (T) are ignored");
  std::vector<ForeignBand>& bands = emissive.empty() ? reflective : emissive;
  if (bands.empty())
    throw InputError(where + ": no spectral channels: names such as S0.550,0nm or T.550,0nm are expected");
  if (emissive.empty()) note(sink, {where}, "the channels are reflective (T), values are taken as they are");
  std::sort(bands.begin(), bands.end(),
            [](const ForeignBand& a, const ForeignBand& b) { return a.centre_nm < b.centre_nm; });
  for (std::size_t i = 1; i < bands.size(); ++i)
    if (bands[i].centre_nm == bands[i - 1].centre_nm)
      throw InputError(where + ": channels '" + printable(bands[i - 1].channel) + "' and '" +
                       printable(bands[i].channel) + "' have the same wavelength");
  return bands;
}

/// Bounds from sensitivities where there are any, otherwise half-way to the nearer neighbours.
void read_foreign_bands(const Imf::Header& header, ExrLayout& layout, const std::string& where,
                        const DiagnosticSink& sink) {
  layout.means.clear();
  layout.info.bands.clear();
  const auto found = find_spectral_channels(header, where, sink);
  std::vector<double> centres;
  for (const ForeignBand& band : found) centres.push_back(band.centre_nm);
  const ChannelList boxes = channels_from_centres(centres, where);
  bool shaped = false, guessed = false;
  for (std::size_t k = 0; k < found.size(); ++k) {
    const auto text = text_attribute(header, found[k].channel);
    const auto sensitivity = text ? parse_sensitivity(*text) : std::nullopt;
    if (text && !sensitivity)
      throw InputError(where + ": sensitivity of channel '" + found[k].channel + "': '" + printable(*text) +
                       "' is no spectrum such as 545nm:1;555nm:1;");
    shaped |= sensitivity && !sensitivity->box;
    guessed |= !sensitivity;
    layout.means.push_back(found[k].channel);
    const Channel box = sensitivity ? Channel{sensitivity->min_nm, sensitivity->max_nm, ""} : boxes[k];
    layout.info.bands.push_back({box, false});
  }
  if (shaped)
    warn(sink, {where}, "sensitivities are not constant over their bands: only their ranges are used");
  if (guessed)
    note(sink, {where}, "no sensitivities: bands are taken to reach half-way to their nearer neighbours");
}

/// The bands of a file by Mitsuba 3's specfilm, which states neither wavelengths nor units: channels have the
/// names of the film's spectra. Images of nested integrators and auxiliary ones are "NAME.CHANNEL". Nothing
/// but R, G, B ... is the picture of an hdrfilm.
std::vector<std::string> find_specfilm_bands(const Imf::Header& header) {
  const auto program = text_attribute(header, "generatedBy");
  if (!program || !program->starts_with("Mitsuba")) return {};
  const std::set<std::string_view> kPicture = {"R", "G", "B", "A", "X", "Y", "Z"};
  std::vector<std::string> bands;
  bool picture = true;
  for (auto c = header.channels().begin(); c != header.channels().end(); ++c) {
    const std::string_view name = c.name();
    if (parse_spectral_name(name)) return {};  // the scene's names are those of the spectral layout
    if (name.find('.') != std::string_view::npos) continue;
    picture = picture && kPicture.contains(name);
    bands.emplace_back(name);
  }
  return picture ? std::vector<std::string>() : bands;
}

/// Fills bands with names only. A pixel of specfilm is the integral of radiance times response.
bool read_specfilm_bands(const Imf::Header& header, ExrLayout& layout, const std::string& where,
                         const DiagnosticSink& sink) {
  layout.means = find_specfilm_bands(header);
  if (layout.means.empty()) return false;
  layout.info.bands.clear();
  for (const std::string& name : layout.means) layout.info.bands.push_back({{0, 0, name}, true});
  layout.info.quantity = Quantity::kIntegral;
  note(sink, {where},
       "written by Mitsuba, which states no wavelengths: the bands have names only (kiloband convert "
       "--wavelengths gives them some); values are integrals of radiance times response, W.m^-2.sr^-1");
  return true;
}

/// Variances count only if every band has one.
void read_variances(const Imf::Header& header, ExrLayout& layout) {
  for (const std::string& name : layout.means)
    if (header.channels().findChannel("var." + name)) layout.variances.push_back("var." + name);
  if (layout.variances.size() != layout.means.size()) layout.variances.clear();
  layout.info.variance = !layout.variances.empty();
}

/// Our own list where it fits, otherwise every channel that is nothing else.
void read_aux(const Imf::Header& header, ExrLayout& layout) {
  std::vector<std::string> own;
  const std::string list = text_attribute(header, kExrAuxAttribute).value_or("");
  for (const std::string_view line : split(list, ';'))
    if (!line.empty()) own.push_back(decode_text(line));
  std::set<std::string> used(std::begin(kPreviewChannels), std::end(kPreviewChannels));
  used.insert(layout.means.begin(), layout.means.end());
  used.insert(layout.variances.begin(), layout.variances.end());
  std::vector<std::string> other;
  for (auto c = header.channels().begin(); c != header.channels().end(); ++c)
    if (!used.contains(c.name()) && !parse_spectral_name(c.name())) other.push_back(c.name());
  std::vector<std::string> sorted = own;
  std::sort(sorted.begin(), sorted.end());
  layout.info.aux = sorted == other ? own : other;  // channels of a file are in the order of their names
}

/// String attributes that mean nothing else to us.
void read_metadata(const Imf::Header& header, CubeInfo& info) {
  for (auto a = header.begin(); a != header.end(); ++a) {
    const auto* text = dynamic_cast<const Imf::StringAttribute*>(&a.attribute());
    std::string name = a.name();
    if (!text || is_reserved_exr_attribute(name, header.channels())) continue;
    if (name.starts_with(kMetaPrefix)) name.erase(0, std::string_view(kMetaPrefix).size());
    if (!name.empty()) info.metadata[name] = text->value();
  }
}

/// Of a copy of others' ENVI cube.
void warn_of_calibration(const CubeInfo& info, const std::string& where, const DiagnosticSink& sink) {
  for (const auto& [name, value] : info.metadata)
    if (std::ranges::find(kCalibrations, lowered(name)) != std::end(kCalibrations))
      warn(sink, {where}, "'" + printable(name) + "': not applied: values are taken as they are stored");
}

/// The layout's unit leaves open whether values are per nm;
/// its reference code and other renderers take them so.
Quantity read_quantity(const Imf::Header& header, const std::string& where, const DiagnosticSink& sink) {
  const auto units = text_attribute(header, "emissiveUnits");
  if (units && *units != kExrUnits)
    warn(sink, {where}, "emissiveUnits '" + printable(*units) + "': taken as " + kExrUnits);
  if (const auto* ev = header.findTypedAttribute<Imf::FloatAttribute>("EV"); ev && ev->value() != 0)
    note(sink, {where}, "EV " + format_number(ev->value()) + " is meant for display and not applied");
  const auto text = text_attribute(header, kExrQuantityAttribute);
  if (text && *text == kExrIntegralText) return Quantity::kIntegral;
  if (text && *text != kExrDensityText)
    warn(sink, {where},
         "bandQuantity '" + printable(*text) + "': unknown, values are taken as densities (per nm)");
  return Quantity::kDensity;
}

}  // namespace

ExrLayout read_exr_layout(const Imf::Header& header, const std::string& where, const DiagnosticSink& sink) {
  ExrLayout layout;
  const auto& window = header.dataWindow();
  layout.info.width = static_cast<uint32_t>(int64_t{window.max.x} - window.min.x + 1);
  layout.info.height = static_cast<uint32_t>(int64_t{window.max.y} - window.min.y + 1);
  layout.info.quantity = read_quantity(header, where, sink);
  if (!read_own_bands(header, layout) && !read_specfilm_bands(header, layout, where, sink)) {
    if (text_attribute(header, kExrBandsAttribute))
      warn(sink, {where},
           "the band list does not fit the channels any more: bands are taken from the channel names");
    read_foreign_bands(header, layout, where, sink);
  }
  read_variances(header, layout);
  read_aux(header, layout);
  read_metadata(header, layout.info);
  warn_of_calibration(layout.info, where, sink);
  layout.info.samples_per_pixel = count_attribute(header, kExrSamplesAttribute, UINT64_MAX, where);
  layout.info.replicates =
      static_cast<uint32_t>(count_attribute(header, kExrReplicatesAttribute, UINT32_MAX, where));
  if (const auto samples = text_attribute(header, kExrReplicateSamplesAttribute))
    layout.info.replicate_samples = parse_counts(*samples).value_or(std::vector<uint64_t>{});
  check_cube_info(layout.info, where);
  return layout;
}

}  // namespace kiloband
