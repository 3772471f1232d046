// Damaged input by the thousand: whoever reads it returns or throws InputError, and soon. Anything else (a crash, another
// exception, a hang) fails the test.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <ctime>
#include <exception>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "base/error.hpp"

namespace kiloband::test {

/// How input is damaged.
struct Damage {
  int times = 2000;
  std::size_t most_changes = 4;
  std::size_t head = SIZE_MAX;  // half of the changes lie in this many bytes, where they hurt most
  double longest_seconds = 2;   // of processor time: far more than any takes, far less than a runaway loop
  std::vector<std::string> words = {"4294967295",       "-1",   "nan", "1e999", std::string(8, '\0'),
                                    "\x7f\xff\xff\xff", "\xff", "0",   "\n",    " "};  // of the format
};

/// One or more changes: a byte, a bit, a digit, a piece that is removed, a piece or a word that is put in, a word
/// that is written over others, now and then a cut.
inline std::string mutated(std::string bytes, const Damage& damage, std::mt19937& random) {
  const auto below = [&](std::size_t n) { return static_cast<std::size_t>(random() % n); };
  for (std::size_t changes = 1 + below(damage.most_changes); changes > 0 && !bytes.empty(); --changes) {
    const std::size_t at = below(std::min(below(2) ? bytes.size() : damage.head, bytes.size()));
    const std::size_t length = 1 + below(std::min<std::size_t>(32, bytes.size() - at));
    const std::string& word = damage.words[below(damage.words.size())];
    switch (below(8)) {
      case 0:
        bytes[at] = static_cast<char>(below(256));
        break;
      case 1:
        bytes[at] = static_cast<char>(bytes[at] ^ (1 << below(8)));
        break;
      case 2:
        if (const std::size_t digit = bytes.find_first_of("0123456789", at); digit != std::string::npos)
          bytes[digit] = static_cast<char>('0' + below(10));
        break;
      case 3:
        bytes.erase(at, length);
        break;
      case 4:
        bytes.insert(below(bytes.size()), bytes.substr(at, length));
        break;
      case 5:
        bytes.insert(at, word);
        break;
      case 6:
        bytes.replace(at, word.size(), word);
        break;
      default:
        if (below(4) == 0) bytes.resize(at);
    }
  }
  return bytes;
}

/// Gives mutants of `good`, which must be accepted itself, to `use`; how many it accepted.
inline int use_mutants(const std::string& good, const Damage& damage,
                       const std::function<void(const std::string& mutant)>& use) {
  EXPECT_NO_THROW(use(good));
  std::mt19937 random(20240607);
  int accepted = 0;
  for (int i = 0; i < damage.times; ++i) {
    const std::string mutant = mutated(good, damage, random);
    const std::clock_t start = std::clock();
    try {
      use(mutant);
      ++accepted;
    } catch (const InputError&) {
    } catch (const std::exception& error) {
      ADD_FAILURE() << error.what() << "\n" << mutant;
    }
    EXPECT_LT(static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC, damage.longest_seconds) << mutant;
  }
  return accepted;
}

/// The same; both outcomes must be frequent (each `share` of all), or the damage is too coarse or too fine.
inline void expect_robust(const std::string& good, const Damage& damage, double share,
                          const std::function<void(const std::string& mutant)>& use) {
  const int accepted = use_mutants(good, damage, use);
  EXPECT_GT(accepted, share * damage.times);
  EXPECT_LT(accepted, (1 - share) * damage.times);
}

}  // namespace kiloband::test
