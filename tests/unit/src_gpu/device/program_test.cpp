// Building programs: logs that name the line, macros, and where a program comes from.
#include "src_gpu/device/program.hpp"

#include <filesystem>
#include <fstream>

#include "src_gpu/device/program_cache.hpp"
#include "tests/unit/src_gpu/device/gpu_fixture.hpp"

namespace kiloband::opencl::test {
namespace {

namespace fs = std::filesystem;

const std::string kHelper =
    "#ifndef H\n#define H\nstatic inline uint value(void) { return KB_VALUE; }\n#endif\n";
const SourceMap kSources{
    {"kernels/a.cl", "#include \"h.clh\"\n__kernel void store(__global uint* x) { x[0] = value(); }\n"},
    {"kernels/h.clh", kHelper}};

class ProgramTest : public GpuTest {
 protected:
  fs::path folder() const { return cache_.path() / "kiloband" / "programs"; }
  std::vector<fs::path> files() const {
    std::vector<fs::path> found;
    if (!fs::exists(folder())) return found;
    for (const auto& entry : fs::directory_iterator(folder())) found.push_back(entry.path());
    return found;
  }
  static Program build_in(DeviceContext& context, uint32_t value = 7) {
    return build_program(context, kSources, "kernels/a.cl", {{"KB_VALUE=" + std::to_string(value)}, true});
  }
  static uint32_t run(DeviceContext& context, const Program& program) {
    DeviceMemory memory(context);
    auto x = memory.upload("x", std::vector<uint32_t>(1));
    program.kernel("store").set(x).launch(1);
    return x.read(0);
  }
  /// As the next process finds it: built in a context that knows no program.
  ProgramOrigin built_afresh() {
    DeviceContext fresh(context_.device());
    const Program program = build_in(fresh);
    EXPECT_EQ(run(fresh, program), 7u);
    return program.origin();
  }
};

TEST_F(ProgramTest, LogNamesFileAndLineOfTheOriginal) {
  SourceMap sources = kSources;
  sources["kernels/h.clh"] =
      "#ifndef H\n#define H\n\nstatic inline uint value(void) { return unheard_of; }\n#endif\n";
  const auto wrong_include = [&] { build_program(context_, sources, "kernels/a.cl", {{}, true}); };
  std::string message = message_of<ProgramBuildError>(wrong_include);
  EXPECT_NE(message.find("clBuildProgram of 'kernels/a.cl': CL_BUILD_PROGRAM_FAILURE (-11)"),
            std::string::npos)
      << message;
  EXPECT_NE(message.find("kernels/h.clh:4"), std::string::npos) << message;
  EXPECT_NE(message.find("unheard_of"), std::string::npos) << message;

  // After an include the count goes on.
  sources = kSources;
  sources["kernels/a.cl"] += "\n__kernel void f(__global uint* x) { x[0] = unheard_of; }\n";
  const auto wrong_main = [&] { build_program(context_, sources, "kernels/a.cl", {{"KB_VALUE=1"}, true}); };
  message = message_of<ProgramBuildError>(wrong_main);
  EXPECT_NE(message.find("kernels/a.cl:4"), std::string::npos) << message;
  EXPECT_TRUE(files().empty()) << "nothing to keep";
}

TEST_F(ProgramTest, MacrosThatNothingAsksForMakeNoOther) {
  build_in(context_);
  const Program same =
      build_program(context_, kSources, "kernels/a.cl", {{"KB_UNHEARD_OF=1", "KB_VALUE=7", "KB_VALU"}, true});
  EXPECT_EQ(same.origin(), ProgramOrigin::kProcess);
  EXPECT_EQ(run(context_, same), 7u);
}

TEST_F(ProgramTest, MacrosMakeOtherPrograms) {
  for (const uint32_t value : {7u, 8u}) {
    const Program program = build_in(context_, value);
    EXPECT_EQ(program.origin(), ProgramOrigin::kSource);
    EXPECT_EQ(run(context_, program), value);
  }
  EXPECT_EQ(files().size(), 2u);
}

TEST_F(ProgramTest, ComesFromTheProcessThenTheDisk) {
  EXPECT_EQ(build_in(context_).origin(), ProgramOrigin::kSource);
  EXPECT_EQ(build_in(context_).origin(), ProgramOrigin::kProcess);
  EXPECT_EQ(built_afresh(), ProgramOrigin::kDisk);
  context_.rebuild();
  const Program rebuilt = build_in(context_);
  EXPECT_EQ(rebuilt.origin(), ProgramOrigin::kDisk);
  EXPECT_EQ(run(context_, rebuilt), 7u);
  EXPECT_EQ(fs::status(folder()).permissions(), fs::perms::owner_all);
}

/// Who shares a device finds what another has built, also when that one is gone.
TEST_F(ProgramTest, SharedByAllOfTheDevice) {
  const DeviceInfo device = context_.device();
  const auto origin = [&](DeviceContext& context) {
    const Program program = build_in(context);
    EXPECT_EQ(run(context, program), 7u);
    return program.origin();
  };
  {
    DeviceContext first(device, {.shared = true});
    EXPECT_EQ(origin(first), ProgramOrigin::kSource);
  }
  DeviceContext second(device, {.shared = true}), third(device, {.profiling = true, .shared = true});
  EXPECT_EQ(second.context()(), third.context()());
  EXPECT_EQ(origin(second), ProgramOrigin::kProcess);
  EXPECT_EQ(built_afresh(), ProgramOrigin::kDisk) << "a context of its own";

  // A lost context is nobody's any more, but for those who have yet to notice; they find the new one.
  const cl_context lost = third.context()();
  second.rebuild();
  EXPECT_NE(second.context()(), lost);
  EXPECT_EQ(third.context()(), lost);
  EXPECT_EQ(origin(second), ProgramOrigin::kDisk);
  third.rebuild();
  EXPECT_EQ(third.context()(), second.context()());
  EXPECT_EQ(origin(third), ProgramOrigin::kProcess);

  second.abandon();
  DeviceContext fourth(device, {.shared = true});
  EXPECT_NE(fourth.context()(), second.context()());
  EXPECT_EQ(origin(fourth), ProgramOrigin::kDisk);
  third.rebuild();
  EXPECT_EQ(third.context()(), fourth.context()());
}

TEST_F(ProgramTest, PartsOfADeviceShareNothing) {
  DeviceInfo part = context_.device();
  part.kept = std::make_shared<int>(0);
  DeviceContext first(part, {.shared = true}), second(part, {.shared = true});
  EXPECT_NE(first.context()(), second.context()());
}

/// The latest are kept; a program that has gone can still be used.
TEST_F(ProgramTest, AsManyAsAreKept) {
  const Program built = build_in(context_);
  ContextPrograms programs(context_.context());
  for (std::size_t i = 0; i < ContextPrograms::kMost; ++i)
    programs.keep(std::to_string(i), built.cl_program());
  ASSERT_TRUE(programs.find("0").has_value());
  EXPECT_EQ((*programs.find("0"))(), built.cl_program()());
  EXPECT_FALSE(programs.find("another").has_value());
  programs.keep("another", built.cl_program());
  EXPECT_TRUE(programs.find("another").has_value());
  EXPECT_FALSE(programs.find("0").has_value());
  EXPECT_TRUE(programs.find("1").has_value());
  EXPECT_EQ(run(context_, built), 7u);
}

TEST_F(ProgramTest, DamagedFilesAreReplaced) {
  build_in(context_);
  ASSERT_EQ(files().size(), 1u);
  const fs::path file = files().front();
  const uint64_t size = fs::file_size(file);
  const auto flip = [&](uint64_t at) {
    std::fstream stream(file, std::ios::binary | std::ios::in | std::ios::out);
    stream.seekg(static_cast<std::streamoff>(at));
    const char byte = static_cast<char>(stream.get() ^ 1);
    stream.seekp(static_cast<std::streamoff>(at));
    stream.put(byte);
  };
  for (const uint64_t at : {uint64_t{0}, uint64_t{20}, uint64_t{50}, uint64_t{74}, size / 2, size - 1}) {
    flip(at);
    EXPECT_EQ(built_afresh(), ProgramOrigin::kSource) << "byte " << at;
    EXPECT_EQ(built_afresh(), ProgramOrigin::kDisk) << "byte " << at;
  }
  for (const uint64_t length : {uint64_t{0}, uint64_t{10}, uint64_t{80}, size - 1}) {
    fs::resize_file(file, length);
    EXPECT_EQ(built_afresh(), ProgramOrigin::kSource) << length;
    EXPECT_EQ(built_afresh(), ProgramOrigin::kDisk) << length;
  }
}

TEST_F(ProgramTest, RefusedBinaryIsReplaced) {
  build_in(context_);
  ASSERT_EQ(files().size(), 1u);
  const std::string key = files().front().stem().string();
  const ProgramCache cache(folder());
  cache.save(key, std::vector<unsigned char>(1000, 'x'));  // whole, but no program
  ASSERT_TRUE(cache.load(key).has_value());
  EXPECT_EQ(built_afresh(), ProgramOrigin::kSource);
  EXPECT_EQ(built_afresh(), ProgramOrigin::kDisk);
}

TEST_F(ProgramTest, NoFolderNoCacheNoError) {
  std::ofstream(cache_.path() / "file") << "x";
  const char* home = std::getenv("HOME");
  const std::string before = home ? home : "";
  for (const std::string& place :
       {(cache_.path() / "file").string(), std::string("/proc/none"), std::string("relative")}) {
    setenv("XDG_CACHE_HOME", place.c_str(), 1);
    setenv("HOME", "", 1);
    EXPECT_EQ(built_afresh(), ProgramOrigin::kSource) << place;
    EXPECT_EQ(built_afresh(), ProgramOrigin::kSource) << place;
  }
  EXPECT_FALSE(fs::exists("relative"));
  setenv("HOME", before.c_str(), 1);
}

/// The option of NVIDIA's compiler goes to no other: an unknown option fails the build.
TEST(ProgramRegisters, OnlyForCompilersThatKnowTheOption) {
  const std::string nvidia = "cl_khr_fp64 cl_nv_compiler_options cl_nv_device_attribute_query";
  EXPECT_EQ(register_option(nvidia, 80), " -cl-nv-maxrregcount=80");
  EXPECT_EQ(register_option("cl_nv_compiler_options", 64), " -cl-nv-maxrregcount=64");
  EXPECT_EQ(register_option(nvidia, 0), "");
  EXPECT_EQ(register_option("cl_khr_fp64 cl_nv_compiler_options2", 80), "");
  EXPECT_EQ(register_option("", 80), "");
}

}  // namespace
}  // namespace kiloband::opencl::test
