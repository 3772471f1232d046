// Lookups in the tables of materials (shared/material_tables.h): the device's against the host's.
#include <gtest/gtest.h>

#include <algorithm>

#include "probe.hpp"
#include "shared/material_tables.h"

namespace kiloband::test::test_tables {
namespace {

std::vector<float> cosines() {
  std::vector<float> all{-0.5f, -0.0f, 1.0f, 1.5f};
  for (int i = 0; i <= 1000; ++i) all.push_back(static_cast<float>(i) / 1000);
  return all;
}

std::vector<float> random_table() {
  Uniform uniform(5);
  std::vector<float> table(KB_CONDUCTOR_CELLS + 1);
  for (float& value : table) value = uniform();
  return table;
}

TEST(MaterialTables, LookupsAreTheHosts) {
  const std::vector<float> table = random_table(), asked = cosines();
  const Lookups device = lookups_on_device(table, asked);
  for (std::size_t i = 0; i < asked.size(); ++i) {
    ASSERT_EQ(device.bounds[i], kb_conductor_bound(table.data(), asked[i])) << asked[i];
    ASSERT_EQ(device.transmittances[i], kb_coat_transmittance(table.data(), asked[i])) << asked[i];
  }
}

/// A bound is no interpolation: it is the larger end of its cell, so that nothing in between is above it.
TEST(MaterialTables, BoundsAreThoseOfTheCell) {
  const std::vector<float> table = random_table();
  for (int cell = 0; cell < KB_CONDUCTOR_CELLS; ++cell) {
    const float larger = std::max(table[cell], table[cell + 1]);
    for (const float t : {0.001f, 0.5f, 0.999f})
      ASSERT_EQ(kb_conductor_bound(table.data(), (static_cast<float>(cell) + t) / KB_CONDUCTOR_CELLS),
                larger);
  }
  EXPECT_EQ(kb_conductor_bound(table.data(), -1), std::max(table[0], table[1]));
  EXPECT_EQ(kb_conductor_bound(table.data(), 2),
            std::max(table[KB_CONDUCTOR_CELLS - 1], table[KB_CONDUCTOR_CELLS]));
}

TEST(MaterialTables, WithoutTableTheBoundIsOne) {
  EXPECT_EQ(lookups_on_device({}, {0.0f, 0.5f, 1.0f}).bounds, std::vector<float>(3, 1.0f));
}

}  // namespace
}  // namespace kiloband::test::test_tables
