// Numbers of principled materials (shared/principled.h), for tests.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "shared/principled.h"
#include "shared/records.h"

namespace kiloband::test {

using PrincipledNumbers = std::vector<float>;

/// Mitsuba's defaults but for those given; base colour and its luminance 0.5.
inline PrincipledNumbers principled_numbers(
    std::initializer_list<std::pair<KbPrincipledNumber, float>> given) {
  PrincipledNumbers numbers(KB_PRINCIPLED_NUMBERS, 0.0f);
  numbers[KB_PRINCIPLED_ROUGHNESS] = numbers[KB_PRINCIPLED_BASE] = numbers[KB_PRINCIPLED_LUMINANCE] = 0.5f;
  numbers[KB_PRINCIPLED_ETA] = 1.5f;
  for (int i = KB_PRINCIPLED_RATES; i < KB_PRINCIPLED_NUMBERS; ++i) numbers[i] = 1;
  for (const auto& [number, value] : given) numbers[number] = value;
  return numbers;
}

struct PrincipledExample {
  std::string name;
  bool thin;
  PrincipledNumbers numbers;
};

/// Each lobe by itself, and all of them.
inline std::vector<PrincipledExample> principled_examples() {
  std::vector<PrincipledExample> all;
  const auto add = [&](const char* name, bool thin,
                       std::initializer_list<std::pair<KbPrincipledNumber, float>> given) {
    all.push_back({name, thin, principled_numbers(given)});
  };
  add("default", false, {});
  add("metal", false, {{KB_PRINCIPLED_METALLIC, 1}, {KB_PRINCIPLED_ROUGHNESS, 0.3f}});
  add("tinted", false, {{KB_PRINCIPLED_SPEC_TINT, 0.8f}, {KB_PRINCIPLED_ROUGHNESS, 0.2f}});
  add("glass", false, {{KB_PRINCIPLED_SPEC_TRANS, 1}, {KB_PRINCIPLED_ROUGHNESS, 0.4f}});
  add("cloth", false,
      {{KB_PRINCIPLED_SHEEN, 1}, {KB_PRINCIPLED_SHEEN_TINT, 0.4f}, {KB_PRINCIPLED_FLATNESS, 0.7f}});
  add("car", false, {{KB_PRINCIPLED_CLEARCOAT, 1}, {KB_PRINCIPLED_CLEARCOAT_GLOSS, 0.4f}});
  add("all", false,
      {{KB_PRINCIPLED_METALLIC, 0.3f},
       {KB_PRINCIPLED_SPEC_TRANS, 0.5f},
       {KB_PRINCIPLED_ANISOTROPIC, 0.8f},
       {KB_PRINCIPLED_SPEC_TINT, 0.5f},
       {KB_PRINCIPLED_SHEEN, 0.5f},
       {KB_PRINCIPLED_FLATNESS, 0.5f},
       {KB_PRINCIPLED_CLEARCOAT, 0.5f},
       {KB_PRINCIPLED_ETA, 1.33f}});
  add("leaf", true, {{KB_PRINCIPLED_DIFF_TRANS, 1}});
  add("foil", true, {{KB_PRINCIPLED_SPEC_TRANS, 1}, {KB_PRINCIPLED_ROUGHNESS, 0.4f}});
  add("all, thin", true,
      {{KB_PRINCIPLED_SPEC_TRANS, 0.6f},
       {KB_PRINCIPLED_DIFF_TRANS, 1.2f},
       {KB_PRINCIPLED_ANISOTROPIC, 0.5f},
       {KB_PRINCIPLED_SPEC_TINT, 0.5f},
       {KB_PRINCIPLED_SHEEN, 0.5f},
       {KB_PRINCIPLED_SHEEN_TINT, 0.5f},
       {KB_PRINCIPLED_FLATNESS, 0.5f},
       {KB_PRINCIPLED_ETA, 1.33f}});
  return all;
}

/// Without its table.
inline KbMaterial principled_material(const PrincipledExample& example) {
  KbMaterial m{};
  m.type = KB_MATERIAL_PRINCIPLED;
  m.flags = KB_MATERIAL_GGX | KB_MATERIAL_SAMPLE_VISIBLE | (example.thin ? KB_MATERIAL_THIN : 0u);
  m.eta = example.numbers[KB_PRINCIPLED_ETA];
  m.bound_a = m.bound_b = 1;
  m.table = KB_NONE;
  return m;
}

}  // namespace kiloband::test
