// A small scene rendered by sessions, in a folder of its own.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "render/session.hpp"
#include "scene/read/reader.hpp"
#include "src_cpu/cpu_backend.hpp"
#include "tests/support/cube_files.hpp"
#include "tests/support/messages.hpp"
#include "validation/suite/scene_text.hpp"

namespace kiloband {

inline constexpr uint32_t kSize = 72;  // more than two blocks, the last clipped

class SessionTest : public ::testing::Test {
 protected:
  void SetUp() override {
    using namespace scene_text;
    const std::string xml = scene(
        -1,
        perspective(lookat("0, 0, 3", "0, 0, 0"), 50, film(kSize)) + shape("sphere", "") +
            emitter("point", spectrum("intensity", "400:1, 700:9") + number("point", "position", "3, 2, 4")) +
            sky(0.5));
    scene_ = *compile_scene(read_scene_text(xml, "test.xml", "."), {parse_channels("400:700:5"), {}, {}});
    settings_.stop.samples_per_pixel = 40;
    settings_.variance = true;
  }

  std::unique_ptr<Backend> backend(uint64_t seed = 3) const {
    SamplingSettings sampling;
    sampling.seed = seed;
    sampling.replicates = session_replicates(settings_);
    return cpu::make_backend(std::make_shared<const FlatScene>(scene_), {}, sampling, {});
  }

  RenderReport run(Backend& backend, const std::string& name, const std::atomic<bool>& stop = false,
                   const std::function<void(const Progress&)>& progress = {}) {
    SessionSettings settings = settings_;
    settings.outputs = {folder_ / name};
    return run_session(scene_, {}, backend, settings, stop, progress);
  }

  test::Cube read(const std::string& name) const { return test::read_cube(folder_ / name); }

  test::TemporaryFolder folder_;
  FlatScene scene_;
  SessionSettings settings_;
};

inline void expect_same(const std::vector<float>& a, const std::vector<float>& b, double tolerance) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i)
    ASSERT_LE(std::abs(a[i] - b[i]), tolerance * std::abs(a[i])) << i;
}

}  // namespace kiloband
