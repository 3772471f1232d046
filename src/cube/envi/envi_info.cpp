// From the keys of an ENVI header to a CubeInfo: our own keys exactly, others' as far as they go.
#include <algorithm>
#include <cmath>

#include "cube/cube_layout.hpp"
#include "cube/cube_text.hpp"
#include "cube/envi/envi_header.hpp"

namespace kiloband {
namespace {

/// Nanometres per unit of the wavelengths; 0 where the numbers are no wavelengths (indices).
double wavelength_unit(const EnviHeader& header, const std::vector<double>& wavelengths,
                       const DiagnosticSink& sink) {
  const EnviHeader::Entry* entry = header.find("wavelength units");
  const std::string unit = entry ? lowered(entry->value) : "unknown";
  if (unit == "nanometers" || unit == "nanometer" || unit == "nanometres" || unit == "nm") return 1;
  if (unit == "micrometers" || unit == "micrometer" || unit == "micrometres" || unit == "microns" ||
      unit == "um" || unit == "\xC2\xB5m" || unit == "\xCE\xBCm")
    return 1000;
  if (unit == "index") return 0;
  if (unit != "unknown")
    throw InputError(header.where(*entry) + " '" + printable(entry->value) +
                     "': must be Nanometers or Micrometers");
  const bool nanometres = *std::max_element(wavelengths.begin(), wavelengths.end()) >= 100;
  warn(sink, {header.file().string()},
       std::string("no wavelength units: the wavelengths are taken as ") +
           (nanometres ? "nanometers (the largest is at least 100)" : "micrometers (all are below 100)"));
  return nanometres ? 1 : 1000;
}

/// Bands without wavelengths keep their names and count as derived: they have no width.
std::vector<Band> index_bands(const EnviHeader& header, std::size_t count, const DiagnosticSink& sink) {
  const auto names = header.texts("band names", count);
  std::vector<Band> bands(count);
  for (std::size_t k = 0; k < count; ++k) {
    bands[k].derived = true;
    bands[k].channel.name =
        names.empty() || names[k].empty() ? "band " + std::to_string(k + 1) : decode_text(names[k]);
  }
  warn(sink, {header.file().string()}, "no wavelengths: the bands have names only");
  return bands;
}

/// Centres with widths, or with bounds half-way to the nearer neighbours, or names only.
std::vector<Band> foreign_bands(const EnviHeader& header, std::size_t count, const DiagnosticSink& sink) {
  std::vector<double> centres = header.numbers("wavelength", count), widths = header.numbers("fwhm", count);
  const double unit = centres.empty() ? 0 : wavelength_unit(header, centres, sink);
  if (unit == 0) return index_bands(header, count, sink);
  // Nanometres stay as they are written.
  const auto converted = [&](double nm) { return unit == 1 ? nm : without_roundings(nm); };
  for (double& centre : centres) centre = converted(unit * centre);
  std::vector<Band> bands(count);
  if (widths.empty()) {
    note(sink, {header.file().string()},
         "no fwhm: bands are taken to reach half-way to their nearer neighbours");
    const ChannelList channels = channels_from_centres(centres, header.where(*header.find("wavelength")));
    for (std::size_t k = 0; k < count; ++k) bands[k].channel = channels[k];
    return bands;
  }
  for (std::size_t k = 0; k < count; ++k) {
    const double half = 0.5 * unit * widths[k];
    bands[k].channel = {converted(centres[k] - half), converted(centres[k] + half), ""};
    if (!(half > 0) || !(centres[k] - half > 0))
      throw InputError(header.where(*header.find("fwhm")) + ": band " + std::to_string(k) + " of width " +
                       format_number(2 * half) + " nm at " + format_number(centres[k]) +
                       " nm: must be positive and end above 0 nm");
  }
  return bands;
}

/// Exact bounds from our own lists; centre and fwhm would round them.
std::vector<Band> own_bands(const EnviHeader& header, std::size_t count) {
  const auto low = header.numbers(kEnviMinKey, count), high = header.numbers(kEnviMaxKey, count);
  const auto derived = header.numbers(kEnviDerivedKey, count);
  const auto names = header.texts(kEnviNamesKey, count);
  if (high.empty())
    throw InputError(header.file().string() + ": '" + std::string(kEnviMaxKey) + "' is missing");
  std::vector<Band> bands(count);
  for (std::size_t k = 0; k < count; ++k) {
    bands[k].channel = {low[k], high[k], names.empty() ? "" : decode_text(names[k])};
    bands[k].derived = !derived.empty() && derived[k] != 0;
  }
  return bands;
}

/// Others' cubes hold reflectances or spectral radiances: never integrals over a band.
Quantity read_quantity(const EnviHeader& header, const DiagnosticSink& sink) {
  const EnviHeader::Entry* entry = header.find(kEnviQuantityKey);
  if (!entry) {
    note(sink, {header.file().string()},
         "the header does not state the quantity: values are taken as densities (per nm)");
    return Quantity::kDensity;
  }
  if (entry->value == "integral") return Quantity::kIntegral;
  if (entry->value == "density") return Quantity::kDensity;
  throw InputError(header.where(*entry) + " '" + printable(entry->value) + "': must be integral or density");
}

std::vector<uint64_t> read_replicate_samples(const EnviHeader& header) {
  const EnviHeader::Entry* entry = header.find(kEnviReplicateSamplesKey);
  if (!entry) return {};
  auto samples = parse_counts(entry->value);
  if (!samples)
    throw InputError(header.where(*entry) + " '" + printable(entry->value) + "': must be whole numbers");
  return *std::move(samples);
}

/// Lists keep their braces, on one line.
std::string metadata_value(const EnviHeader::Entry& entry, bool own) {
  if (!entry.list) return own ? decode_text(entry.value) : entry.value;
  std::string line;
  for (const char c : entry.value) {
    const bool blank = c == '\n' || c == '\r' || c == '\t' || c == ' ';
    if (!blank)
      line += c;
    else if (!line.empty() && line.back() != ' ')
      line += ' ';
  }
  return "{" + (own ? decode_text(line) : line) + "}";
}

/// Everything that has no other meaning. Only our own files encode special characters.
void read_metadata(const EnviHeader& header, bool own, CubeInfo& info) {
  for (const EnviHeader::Entry& entry : header.entries()) {
    if (is_reserved_envi_key(entry.lower)) continue;
    std::string key = own ? decode_text(entry.key) : entry.key;
    if (own && entry.key.starts_with(kEnviMetaPrefix))
      key = decode_text(entry.key.substr(kEnviMetaPrefix.size()));
    if (!key.empty()) info.metadata[key] = metadata_value(entry, own);
  }
}

/// Bands that an instrument has marked as bad are data like others here. Copies of ours used to keep the marks of bands that they have not.
void note_bad_bands(const EnviHeader& header, bool own, std::size_t count, const DiagnosticSink& sink) {
  const EnviHeader::Entry* entry = header.find("bbl");
  if (!entry || (own && !entry->list)) return;
  const std::vector<double> good = header.numbers("bbl", count);
  const auto bad = std::ranges::count(good, 0.0);
  if (bad > 0)
    warn(sink, {},
         header.where(*entry) + ": marks " + std::to_string(bad) + " of " + std::to_string(count) +
             " bands as bad: they are read like the others");
}

/// What others state of the numbers in their files, and we do not apply.
void check_calibration(const EnviHeader& header, const DiagnosticSink& sink) {
  for (const std::string_view key : kCalibrations)
    if (const EnviHeader::Entry* entry = header.find(key))
      warn(sink, {}, header.where(*entry) + ": not applied: values are taken as they are stored");
  const EnviHeader::Entry* compression = header.find("file compression");
  if (compression && compression->value != "0")
    throw InputError(header.where(*compression) + " '" + printable(compression->value) +
                     "': compressed data files are not read");
}

}  // namespace

CubeInfo read_envi_info(const EnviHeader& header, const EnviStorage& storage, const DiagnosticSink& sink) {
  const bool own = header.find(kEnviLayoutKey) != nullptr;
  CubeInfo info;
  info.width = storage.samples;
  info.height = storage.lines;
  info.quantity = read_quantity(header, sink);
  info.bands = header.find(kEnviMinKey) ? own_bands(header, storage.bands)
                                        : foreign_bands(header, storage.bands, sink);
  const EnviHeader::Entry* content = header.find(kEnviContentKey);
  info.holds_variances = content && content->value == "variance";
  info.samples_per_pixel = header.count(kEnviSamplesKey, UINT64_MAX, 0);
  info.replicates = static_cast<uint32_t>(header.count(kEnviReplicatesKey, UINT32_MAX, 0));
  info.replicate_samples = read_replicate_samples(header);
  check_calibration(header, sink);
  note_bad_bands(header, own, storage.bands, sink);
  read_metadata(header, own, info);
  check_cube_info(info, header.file().string());
  return info;
}

}  // namespace kiloband
