// Targets: short texts (names, numbers with units, lists), and the first look at images.
#include <set>

#include "app/options/option_values.hpp"
#include "cube/cube_text.hpp"
#include "cube/exr/exr_names.hpp"
#include "post/convert.hpp"
#include "scene/image/channels.hpp"
#include "scene/image/format.hpp"
#include "spectral/materials/materials.hpp"
#include "tests/fuzz/fuzz_target.hpp"

namespace kiloband::fuzz {

namespace {

void parse(std::string_view bytes) {
  find_metal(bytes);
  find_dielectric(bytes);
  parse_spectral_name(bytes);
  parse_sensitivity(bytes);
  decode_text(bytes);
  printable(bytes);
  promise(decode_text(encode_text(bytes, ",;{}=")) == bytes, "another text after encoding and decoding");
}

void name_channels(std::string_view bytes) {
  std::vector<std::string> words;
  for (const std::string_view word : split(bytes, ',')) words.emplace_back(word);
  const auto unique = make_unique_names(words);
  promise(std::set<std::string>(unique.begin(), unique.end()).size() == words.size(),
          "names that are not unique");
  const ImageChannels choice = choose_channels(words, words.size() > 3 ? 3 : -1);
  for (int i = 0; i < choice.count; ++i)
    promise(choice.index[i] >= 0 && choice.index[i] < static_cast<int>(words.size()),
            "a channel that is not there");
}

}  // namespace

void names(std::string_view bytes) {
  accept_or_refuse([&] { parse(bytes); });
  accept_or_refuse([&] { name_channels(bytes); });
  accept_or_refuse([&] { parse_band_indices(bytes, 40); });
  accept_or_refuse([&] { parse_duration("--time", std::string(bytes)); });
  accept_or_refuse([&] { parse_error("--target-error", std::string(bytes)); });
}

/// Up to where libraries take over; fuzz_pictures.cpp goes on.
void image_header(std::string_view bytes) {
  for (const char* name : {"image.png", "image.tga"}) {
    const auto file = scratch_file(name, bytes);
    accept_or_refuse([&] { check_image_size(examine_image(file), 64, 64); });
  }
}

}  // namespace kiloband::fuzz
