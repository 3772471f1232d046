// Includes put in place, and what was embedded.
#include <filesystem>
#include <stdexcept>

#include "src_gpu/device/kernel_sources.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/unit/src_gpu/device/gpu_fixture.hpp"

namespace kiloband::opencl::test {
namespace {

TEST(AssembleSource, PutsIncludesInPlaceOnce) {
  const SourceMap sources{{"kernels/a.cl", "#include \"b.clh\"\n#include \"shared/c.h\"\nA\n"},
                          {"kernels/b.clh", "  #  include \"shared/c.h\"  // the records\nB\n"},
                          {"src/shared/c.h", "C"}};
  EXPECT_EQ(assemble_source(sources, "kernels/a.cl"),
            "#line 1 \"kernels/a.cl\"\n#line 1 \"kernels/b.clh\"\n#line 1 \"src/shared/c.h\"\nC\n"
            "#line 2 \"kernels/b.clh\"\nB\n#line 2 \"kernels/a.cl\"\n\nA\n");
}

/// What stands in a conditional may be left out by the compiler: it must not count as included. The guard of
/// the file around it is no such conditional.
TEST(AssembleSource, ConditionalIncludeIsRepeated) {
  const std::string guarded = "#ifndef C\n#define C\n#include \"d.clh\"\nC\n#endif\n";
  const SourceMap sources{
      {"kernels/a.cl", "#if X\n#include \"c.clh\"\n#endif\n#include \"c.clh\"\n#include \"d.clh\"\n"},
      {"kernels/c.clh", guarded},
      {"kernels/d.clh", "D\n"}};
  const std::string text = assemble_source(sources, "kernels/a.cl");
  const auto count = [&](const std::string& what) {
    std::size_t found = 0;
    for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; ++at) ++found;
    return found;
  };
  EXPECT_EQ(count("#line 1 \"kernels/c.clh\""), 2u) << text;
  EXPECT_EQ(count("#line 1 \"kernels/d.clh\""), 2u) << text;  // the last one, by a.cl, is the third mention
}

TEST(AssembleSource, CirclesEnd) {
  const SourceMap sources{{"kernels/a.cl", "#include \"b.clh\"\nA\n"},
                          {"kernels/b.clh", "#if 1\n#include \"b.clh\"\n#endif\n"}};
  EXPECT_EQ(
      assemble_source(sources, "kernels/a.cl"),
      "#line 1 \"kernels/a.cl\"\n#line 1 \"kernels/b.clh\"\n#if 1\n\n#endif\n#line 2 \"kernels/a.cl\"\nA\n");
}

TEST(AssembleSource, NamesTheLineOfAMissingFile) {
  const SourceMap sources{{"kernels/a.cl", "\n#include \"b.clh\"\n"}};
  EXPECT_EQ(message_of<std::logic_error>([&] { assemble_source(sources, "kernels/a.cl"); }),
            "kernels/a.cl:2: no source 'b.clh'");
  EXPECT_EQ(message_of<std::logic_error>([&] { assemble_source(sources, "kernels/b.cl"); }),
            "no source 'kernels/b.cl'");
}

TEST(AsksFor, WholeNamesThatAreNotJustDefined) {
  for (const char* text : {"#if A\n", "x = A;", "A", "#define B A\n", "#ifndef A\n#define A 1\n#endif\n",
                           "#define A 1\n A(2)", "#undef A"})
    EXPECT_TRUE(asks_for(text, "A")) << text;
  for (const char* text : {"", "#define A 1\n", "# define  A 1\n#define A 2", "AB _A A1", "#define A"})
    EXPECT_FALSE(asks_for(text, "A")) << text;
}

/// Scenes that differ in their lights share a program of evaluation; those that differ in their gas do not.
TEST(AsksFor, FeaturesOfEvaluationAndOfPaths) {
  const std::string paths = assemble_source(embedded_sources(), "kernels/path/paths.cl");
  for (const char* main : {"kernels/evaluate/evaluate.cl", "kernels/evaluate/pt.cl"}) {
    const std::string text = assemble_source(embedded_sources(), main);
    for (const char* macro : {"KB_HAS_GAS", "KB_HAS_DISPERSION", "KB_HAS_BITMAP", "KB_HAS_PRINCIPLED",
                              "KB_WIDTH", "KB_CHUNK_ENTRIES"})
      EXPECT_TRUE(asks_for(text, macro)) << main << " " << macro;
    for (const char* macro : {"KB_HAS_DIFFUSE", "KB_HAS_SUN", "KB_HAS_AREA_LIGHT", "KB_HAS_INSTANCES",
                              "KB_HAS_BUMP", "KB_HAS_LIGHT_TREE"}) {
      EXPECT_FALSE(asks_for(text, macro)) << main << " " << macro;
      EXPECT_TRUE(asks_for(paths, macro)) << macro;
    }
  }
}

/// Every byte of every file, so that a stale or cut embedding shows.
TEST(EmbeddedSources, AreTheFiles) {
  const std::filesystem::path root = KILOBAND_SOURCE_DIR;
  std::size_t files = 0;
  for (const std::string folder : {"kernels", "src/shared"}) {
    for (const auto& entry : std::filesystem::recursive_directory_iterator(root / folder)) {
      const std::string extension = entry.path().extension().string();
      if (extension != ".cl" && extension != ".clh" && extension != ".h") continue;
      const std::string path = entry.path().lexically_relative(root).string();
      ASSERT_TRUE(embedded_sources().contains(path)) << path;
      EXPECT_TRUE(embedded_sources().at(path) == kiloband::test::read_file(entry.path()))
          << path << " differs";
      ++files;
    }
  }
  EXPECT_EQ(files, embedded_sources().size());
  EXPECT_GE(files, 60u);
}

TEST(EmbeddedSources, AllIncludesAreThere) {
  for (const auto& [path, text] : embedded_sources())
    EXPECT_NO_THROW(assemble_source(embedded_sources(), path)) << path;
}

}  // namespace
}  // namespace kiloband::opencl::test
