// What the suite compares: cases, each a scene and the ways in which it is rendered.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "validation/suite/effort.hpp"
#include "validation/suite/rendering.hpp"

namespace kiloband::validation {

/// Image means of all channels that a scene must show, W m^-2 sr^-1.
struct ClosedForm {
  std::vector<double> values;
  double relative_bound = 2e-6;  // the digits that are given
};

struct Case {
  std::string name, what;
  CaseScene scene;
  ByEffort<uint32_t> samples;     // per pixel and replicate
  Effort least = Effort::kQuick;  // the smallest effort that includes it
  bool closed_form = false;       // stated in the scene file: held against that, else across backends
};

/// What follows "Expected:" in the comment of a scene file.
/// throws InputError  there is none, or its length is not the number of channels
ClosedForm read_closed_form(const std::filesystem::path& scene, std::size_t channels);

/// Where scene files are.
struct SceneFolders {
  std::filesystem::path scenes;      // of the project: analytic/, cornell_box/
  std::filesystem::path validation;  // validation/scenes
  std::filesystem::path generated;   // what generate_scenes writes; empty: the large scenes are left out
  std::filesystem::path data;        // public meshes and spectra, see validation/scenes/real; empty: left out
};

/// All cases, in the order of the report. Every file of scenes/analytic is one.
std::vector<Case> all_cases(const SceneFolders& folders);

/// One comparison of a case. Sides that are rendered alike are rendered once.
struct Pairing {
  enum class Kind { kClosedForm, kIndependent, kPaired };
  Kind kind = Kind::kIndependent;
  Configuration a, b;      // b: not for closed forms
  bool variances = false;  // the sides are the same estimator
};

/// The comparisons of a case over the backends that there are ("cpu" among them or not).
std::vector<Pairing> pairings_of(const Case& c, const std::vector<std::string>& backends, Effort effort);

}  // namespace kiloband::validation
