// Targets: the text files of numbers, that is spectra, optical constants, sensor responses, plumes, channels.
#include <algorithm>
#include <cmath>

#include "post/sensor_cube.hpp"
#include "scene/read/reader.hpp"
#include "spectral/channel_knots.hpp"
#include "spectral/channels.hpp"
#include "spectral/files/spectrum_files.hpp"
#include "tests/fuzz/flat_scene_check.hpp"
#include "tests/fuzz/fuzz_target.hpp"

namespace kiloband::fuzz {
namespace {

constexpr std::size_t kMostChannels = 8;  // that a scene is flattened for

const ChannelList& some_channels() {
  static const ChannelList kChannels{{400, 500, ""}, {500, 500.5, ""}, {480, 700, ""}, {8000, 12000, ""}};
  return kChannels;
}

/// What the rest of the program asks of a spectrum that was read.
void use(const Spectrum& spectrum) {
  const auto range = spectrum.data_range();
  promise(range && range->min_nm <= range->max_nm, "a file of data without a range");
  for (const double nm : spectrum.knots_nm())
    promise(std::isfinite(nm) && nm > 0, "a wavelength that is no wavelength");
  for (const double value : spectrum.knot_values())
    promise(std::isfinite(value), "a value that is not finite");
  for (const Channel& c : some_channels()) {
    spectrum.mean(c.min_nm, c.max_nm);
    promise(spectrum.min_over(c.min_nm, c.max_nm) <= spectrum.max_over(c.min_nm, c.max_nm),
            "bounds that cross");
    resample(spectrum, c.min_nm, c.max_nm,
             {1e-4, std::size_t{1} << 14});  // finer tables take long, not another way
  }
}

}  // namespace

void spectrum(std::string_view bytes) {
  const auto file = scratch_file("spectrum.txt", bytes);
  accept_or_refuse([&] { use(read_spectrum_file(file)); });
  for (const ValueKind kind :
       {ValueKind::kAny, ValueKind::kRadiance, ValueKind::kIrradiance, ValueKind::kIntensity})
    accept_or_refuse([&] { read_spectrum_file(file, kind); });
}

void absorption(std::string_view bytes) {
  const auto file = scratch_file("absorption.txt", bytes);
  accept_or_refuse([&] {
    const Spectrum absorption = read_spectrum_file(file, ValueKind::kAbsorption);
    const ChannelKnots knots = sampled_knots(absorption, some_channels(), "gas"),
                       sorted = sorted_knots(knots);
    for (std::size_t k = 0; k < some_channels().size(); ++k) {
      knots(k, 0.5);
      promise(sorted(k, 0.25) <= sorted(k, 0.75), "sorted knots that descend");
    }
  });
}

void optical_constants(std::string_view bytes) {
  for (const char* name : {"material.yml", "material.txt"}) {
    const auto file = scratch_file(name, bytes);
    accept_or_refuse([&] {
      const OpticalConstants constants = read_optical_constants(file);
      const auto n = constants.n.knot_values();
      promise(std::all_of(n.begin(), n.end(), [](double v) { return v > 0; }),
              "an index that is not positive");
      use(constants.n);
      if (constants.k) use(*constants.k);
    });
  }
}

void responses(std::string_view bytes) {
  const auto file = scratch_file("responses.csv", bytes);
  accept_or_refuse([&] {
    std::vector<Band> bands;
    for (const Channel& channel : some_channels()) bands.push_back({channel, false});
    const ChannelCover cover(some_channels());
    for (const auto& [name, response] : read_response_file(file)) {
      promise(!name.empty(), "a response without a name");
      use(response);
      uncovered_part(response, cover);
      sensor_weights(response, bands, cover);
    }
  });
}

/// The grid of a plume, which a scene names.
void plume(std::string_view bytes) {
  scratch_file("plume.txt", bytes);
  const std::string text =
      "<scene version='3.0.0'><sensor type='perspective'/><emitter type='constant'/><shape "
      "type='sphere'><bsdf type='null'/><medium type='plume' name='interior'>"
      "<spectrum name='absorption' value='1'/><string name='field' value='grid'/><string name='nodes' "
      "value='2 2 3'/>"
      "<string name='filename' value='plume.txt'/></medium></shape></scene>";
  accept_or_refuse([&] { read_scene_text(text, "plume.xml", scratch_folder()); });
}

/// The option --bands, and the file of --bands-file.
void bands(std::string_view bytes) {
  const auto check = [](const ChannelList& channels) {
    promise(!channels.empty() && channels.size() <= kMaxChannels, "a number of channels");
    for (const Channel& c : channels)
      promise(c.min_nm > 0 && c.min_nm < c.max_nm && std::isfinite(c.max_nm),
              "a channel that is no interval");
    if (channels.size() > kMostChannels) return;
    accept_or_refuse([&] {
      flatten_and_check(
          "<shape type='sphere'><bsdf type='plastic'><rgb name='diffuse_reflectance' value='0.1 0.5 "
          "0.2'/></bsdf>"
          "<emitter type='thermal'><float name='temperature' value='300'/></emitter></shape><emitter "
          "type='constant'>"
          "<spectrum type='blackbody' name='radiance'><float name='temperature' "
          "value='6000'/></spectrum></emitter>",
          channels);
    });
  };
  accept_or_refuse([&] { check(parse_channels(bytes)); });
  const auto file = scratch_file("bands.csv", bytes);
  accept_or_refuse([&] { check(read_channels_file(file)); });
}

}  // namespace kiloband::fuzz
