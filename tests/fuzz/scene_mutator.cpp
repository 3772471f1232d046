// Mutations of scene files for libFuzzer: most keep the XML well-formed, so that they come past the parser.
#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <random>
#include <string>
#include <vector>

extern "C" std::size_t LLVMFuzzerMutate(uint8_t* data, std::size_t size, std::size_t max_size);

namespace kiloband::fuzz {
namespace {

struct Range {
  std::size_t begin = 0, end = 0;
};

constexpr std::array kNumbers{"0",     "1",        "-1",    "0.5",        "2",          "1e-3",  "1e3",
                              "1e-30", "1e30",     "1e-45", "3e38",       "1e39",       "1e308", "1e-320",
                              "nan",   "65535",    "65536", "2147483647", "4294967296", "550",   "400",
                              "1e-7",  "0.999999", "90",    "180",        "360"};
constexpr std::array kTypes{"sphere",
                            "rectangle",
                            "cube",
                            "disk",
                            "cylinder",
                            "obj",
                            "ply",
                            "diffuse",
                            "conductor",
                            "roughconductor",
                            "dielectric",
                            "roughdielectric",
                            "plastic",
                            "roughplastic",
                            "twosided",
                            "mask",
                            "null",
                            "area",
                            "constant",
                            "envmap",
                            "spectral_envmap",
                            "point",
                            "spot",
                            "directional",
                            "thermal",
                            "bitmap",
                            "checkerboard",
                            "spectral_bitmap",
                            "regular",
                            "irregular",
                            "blackbody",
                            "d65",
                            "uniform",
                            "perspective",
                            "thinlens",
                            "orthographic",
                            "hdrfilm",
                            "specfilm",
                            "bandfilm",
                            "absorbing",
                            "plume",
                            "box",
                            "tent",
                            "gaussian"};

class SceneMutator {
 public:
  SceneMutator(std::string text, unsigned seed) : text_(std::move(text)), random_(seed) { find_parts(); }

  std::string mutate() {
    switch (below(6)) {
      case 0:
        replace(pick(values_), text(pick(values_)));
        break;
      case 1:
      case 2:
        replace(pick(numbers_), kNumbers[below(kNumbers.size())]);
        break;
      case 3:
        replace(pick(types_), kTypes[below(kTypes.size())]);
        break;
      case 4:
        text_.insert(pick(elements_).begin, text(pick(elements_)));
        break;
      default:
        replace(pick(elements_), below(2) == 0 ? "" : text(pick(elements_)));
    }
    return text_;
  }

 private:
  std::size_t below(std::size_t n) { return n == 0 ? 0 : random_() % n; }
  Range pick(const std::vector<Range>& ranges) {
    return ranges.empty() ? Range{} : ranges[below(ranges.size())];
  }
  std::string text(const Range& range) const { return text_.substr(range.begin, range.end - range.begin); }
  void replace(const Range& range, const std::string& by) {
    text_.replace(range.begin, range.end - range.begin, by);
  }

  /// Values of attributes, the numbers in them, those of `type`; and elements with all that is in them.
  void find_parts() {
    std::vector<std::size_t> open;
    for (std::size_t at = text_.find('<'); at != std::string::npos; at = text_.find('<', at + 1)) {
      const std::size_t end = text_.find('>', at);
      if (end == std::string::npos) return;
      if (text_[at + 1] == '/') {
        if (!open.empty()) elements_.push_back({open.back(), end + 1}), open.pop_back();
        continue;
      }
      find_values({at, end});
      if (text_[end - 1] == '/')
        elements_.push_back({at, end + 1});
      else
        open.push_back(at);
    }
  }

  void find_values(const Range& tag) {
    for (std::size_t at = tag.begin; at < tag.end; ++at) {
      const char quote = text_[at];
      if (quote != '\'' && quote != '"') continue;
      const std::size_t end = text_.find(quote, at + 1);
      if (end >= tag.end) return;
      values_.push_back({at + 1, end});
      if (at >= 5 && text_.compare(at - 5, 5, "type=") == 0) types_.push_back(values_.back());
      find_numbers(values_.back());
      at = end;
    }
  }

  void find_numbers(const Range& value) {
    constexpr const char* kDigits = "0123456789.-+e";
    for (std::size_t at = value.begin; at < value.end;) {
      const std::size_t end = std::min(value.end, text_.find_first_not_of(kDigits, at));
      if (end > at) numbers_.push_back({at, end});
      at = end + 1;
    }
  }

  std::string text_;
  std::minstd_rand random_;
  std::vector<Range> values_, numbers_, types_, elements_;
};

}  // namespace
}  // namespace kiloband::fuzz

extern "C" std::size_t LLVMFuzzerCustomMutator(uint8_t* data, std::size_t size, std::size_t max_size,
                                               unsigned seed) {
  static const char* const kTarget = std::getenv("KILOBAND_FUZZ_TARGET");
  static const bool kOfScenes = kTarget && std::strcmp(kTarget, "scene") == 0;
  if (!kOfScenes || seed % 4 == 0) return LLVMFuzzerMutate(data, size, max_size);
  const std::string before(reinterpret_cast<const char*>(data), size);
  const std::string after = kiloband::fuzz::SceneMutator(before, seed).mutate();
  if (after.size() > max_size) return LLVMFuzzerMutate(data, size, max_size);
  std::memcpy(data, after.data(), after.size());
  return after.size();
}
