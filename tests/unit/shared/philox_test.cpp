// Philox against the published known-answer vectors, and the conversion to floats.
#include "shared/philox.h"

#include <gtest/gtest.h>

#include <array>

#include "shared/hash.h"

namespace {

// File kat_vectors of the Random123 library, lines "philox4x32 10": counter, key, result.
struct KnownAnswer {
  KbPhilox4 counter;
  KbPhiloxKey key;
  KbPhilox4 result;
};

constexpr std::array<KnownAnswer, 3> kKnownAnswers{{
    {{0, 0, 0, 0}, {0, 0}, {0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8}},
    {{0xffffffff, 0xffffffff, 0xffffffff, 0xffffffff},
     {0xffffffff, 0xffffffff},
     {0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd}},
    {{0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344},
     {0xa4093822, 0x299f31d0},
     {0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1}},
}};

TEST(Philox, MatchesTheKnownAnswers) {
  for (const KnownAnswer& answer : kKnownAnswers) {
    const KbPhilox4 r = kb_philox4x32(answer.counter, answer.key);
    EXPECT_EQ(r.x, answer.result.x);
    EXPECT_EQ(r.y, answer.result.y);
    EXPECT_EQ(r.z, answer.result.z);
    EXPECT_EQ(r.w, answer.result.w);
  }
}

TEST(Philox, FloatsAreTheUpper24BitsOfTheWords) {
  // the third vector, its key as a 64-bit seed: low word first
  const KbFloat4 u = kb_philox_floats(0x299f31d0a4093822ull, 0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344);
  EXPECT_EQ(u.x, static_cast<float>(0xd16cfe) / 16777216.0f);
  EXPECT_EQ(u.y, static_cast<float>(0x94fdcc) / 16777216.0f);
  EXPECT_EQ(u.z, static_cast<float>(0x5001e4) / 16777216.0f);
  EXPECT_EQ(u.w, static_cast<float>(0x24126e) / 16777216.0f);
}

TEST(Hash, FloatsStayBelowOne) {
  EXPECT_EQ(kb_unit_float(0xffffffffu), KB_ONE_MINUS_EPSILON);
  EXPECT_EQ(kb_unit_float(0xffu), 0.0f);
  EXPECT_EQ(kb_unit_float(0x80000000u), 0.5f);
  const KbFloat4 u = kb_unit_float4(kb_u32x4_of(0, 0xffffffffu, 0x80000000u, 0x100u));
  EXPECT_EQ(u.x, 0.0f);
  EXPECT_EQ(u.y, KB_ONE_MINUS_EPSILON);
  EXPECT_EQ(u.z, 0.5f);
  EXPECT_EQ(u.w, 1.0f / 16777216.0f);
}

TEST(Hash, ReversesBits) {
  for (unsigned bit = 0; bit < 32; ++bit) EXPECT_EQ(kb_reverse_bits(1u << bit), 1u << (31 - bit));
  const kb_u32x4 four = kb_reverse_bits4(kb_u32x4_of(0x12345678u, 1, 0, 0xffff0000u));
  EXPECT_EQ(kb_u32x4_x(four), kb_reverse_bits(0x12345678u));
  EXPECT_EQ(kb_u32x4_y(four), 0x80000000u);
  EXPECT_EQ(kb_u32x4_z(four), 0u);
  EXPECT_EQ(kb_u32x4_w(four), 0x0000ffffu);
}

// SplitMix64 with seed 0 gives mix64 of multiples of the golden ratio; its published first outputs.
TEST(Hash, Mix64IsSplitMix64) {
  EXPECT_EQ(kb_mix64(0x9e3779b97f4a7c15ull), 0xe220a8397b1dcdafull);
  EXPECT_EQ(kb_mix64(0x3c6ef372fe94f82aull), 0x6e789e6aa1b965f4ull);
}

TEST(Hash, VectorAndScalarMixAgree) {
  const kb_u32x4 four = kb_mix32x4(kb_u32x4_of(0, 1, 0xdeadbeefu, 0xffffffffu), 77);
  EXPECT_EQ(kb_u32x4_x(four), kb_mix32(0, 77));
  EXPECT_EQ(kb_u32x4_y(four), kb_mix32(1, 77));
  EXPECT_EQ(kb_u32x4_z(four), kb_mix32(0xdeadbeefu, 77));
  EXPECT_EQ(kb_u32x4_w(four), kb_mix32(0xffffffffu, 77));
}

}  // namespace
