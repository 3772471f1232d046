// The cases. A new one: a scene file in scenes/analytic that states its channels
// and expected values, or a line below.
#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <sstream>

#include "base/error.hpp"
#include "validation/suite/case.hpp"

namespace kiloband::validation {
namespace fs = std::filesystem;
namespace {

/// The scene's comment begins with what it shows.
std::string first_comment_line(const fs::path& scene) {
  std::ifstream file(scene);
  const std::string opening = "<!-- ";
  for (std::string line; std::getline(file, line);) {
    const auto at = line.find(opening);
    if (at != std::string::npos) return line.substr(at + opening.size());
  }
  return {};
}

std::vector<Case> analytic_cases(const fs::path& folder) {
  std::vector<Case> cases;
  std::error_code unknown;
  if (!fs::is_directory(folder, unknown)) throw InputError(folder.string() + ": no such folder of scenes");
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.path().extension() != ".xml") continue;
    const std::string stem = entry.path().stem().string();
    cases.push_back({"analytic/" + stem,
                     first_comment_line(entry.path()),
                     {entry.path(), {}, ""},
                     {64, 1024, 8192},
                     Effort::kQuick,
                     true});
  }
  std::ranges::sort(cases, {}, &Case::name);
  return cases;
}

}  // namespace

ClosedForm read_closed_form(const fs::path& scene, std::size_t channels) {
  std::ifstream file(scene);
  const std::string label = "Expected:";
  for (std::string line; std::getline(file, line);) {
    const auto at = line.find(label);
    if (at == std::string::npos) continue;
    ClosedForm form;
    std::istringstream numbers(line.substr(at + label.size()));
    for (std::string number; std::getline(numbers, number, ',');) form.values.push_back(std::stod(number));
    if (form.values.size() == channels) return form;
    throw InputError(
        fmt::format("{}: {} expected values for {} channels", scene.string(), form.values.size(), channels));
  }
  throw InputError(scene.string() + ": states no expected values (a comment line 'Expected: ...')");
}

std::vector<Case> all_cases(const SceneFolders& folders) {
  std::vector<Case> cases = analytic_cases(folders.scenes / "analytic");
  const auto add = [&](const std::string& name, const std::string& what, const fs::path& file,
                       const std::string& bands, std::pair<uint32_t, uint32_t> size,
                       ByEffort<uint32_t> samples, Effort least = Effort::kQuick) {
    cases.push_back({name, what, {file, {}, bands, size.first, size.second}, samples, least});
  };
  const fs::path stress = folders.validation;
  add("cornell_box", "diffuse interreflection with measured spectra",
      folders.scenes / "cornell_box/cornell_box.xml", "400:700:16", {64, 64}, {2, 128, 512});
  add("stress/metals_and_lamps",
      "rough metals, plastics, masks, every kind of lamp, an environment map, textures",
      stress / "metals_and_lamps.xml", "400:700:12", {32, 32}, {4, 32, 256});
  add("stress/endless", "albedo 0.95 without a limit of depth: roulette", stress / "endless.xml", "400:700:8",
      {24, 24}, {4, 32, 256});
  add("stress/hot_gas", "thermal emission of compensated metals in an absorbing atmosphere, a plume",
      stress / "hot_gas.xml", "2000:5000:12", {32, 32}, {4, 32, 256});
  add("stress/flint_ball", "rough dispersive glass: spectral MIS", stress / "flint_ball.xml", "400:700:16",
      {24, 24}, {4, 32, 256});
  add("stress/red_glass_ball", "smooth dispersive, coloured glass: degradation to a chosen channel",
      stress / "red_glass_ball.xml", "400:700:16", {24, 24}, {4, 32, 256});
  add("stress/lens_and_glass", "a lens that blurs by a pixel, smooth glass, total reflection",
      stress / "lens_and_glass.xml", "400:700:12", {32, 32}, {4, 32, 256});
  add("stress/glade",
      "instances, bumps, blends, panes, principled materials, a sun, thrown pictures, a filter with negative parts",
      stress / "glade.xml", "400:700:12", {32, 32}, {4, 32, 256});
  if (!folders.data.empty()) {
    for (const char* name : {"buddha", "conference", "dragon", "f16", "lucy", "suzanne"}) {
      add(std::string("real/") + name, "meshes, environments and spectra of other people",
          stress / "real" / (std::string(name) + ".xml"), "", {40, 30}, {1, 8, 64}, Effort::kStandard);
      cases.back().scene.defines = {{"data", folders.data.string()}};
    }
  }
  if (folders.generated.empty()) return cases;
  const fs::path large = folders.generated;
  constexpr Effort kStandard = Effort::kStandard;
  add("aircraft", "curved surfaces under a sky", large / "aircraft/aircraft.xml", "400:700:12", {48, 27},
      {1, 16, 128}, kStandard);
  add("conference", "many materials, a furnished room", large / "conference/conference.xml", "400:700:12",
      {48, 27}, {1, 16, 128}, kStandard);
  add("statues", "dispersive glass among sculptures, depth 17", large / "statues/statues.xml", "400:700:12",
      {48, 27}, {1, 16, 128}, kStandard);
  return cases;
}

}  // namespace kiloband::validation
