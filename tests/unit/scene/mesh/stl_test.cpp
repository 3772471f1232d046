// STL: text and binary, right and wrong.
#include <gtest/gtest.h>

#include <limits>

#include "binary.hpp"
#include "scene/mesh/mesh.hpp"
#include "support.hpp"

namespace kiloband::test {
namespace {

const std::string kFacet =
    "facet normal 0 0 1\n outer loop\n  vertex 0 0 0\n  vertex 1 0 0\n  vertex 0 1 0\n endloop\nendfacet\n";
const std::string kText = "solid thing one\n" + kFacet + kFacet + "endsolid thing one\n";

std::string binary_stl(uint32_t count, const std::vector<float>& corners) {
  std::string file(80, ' ');
  file += raw(count);
  for (size_t i = 0; i + 9 <= corners.size(); i += 9) {
    file += raw<float>({0, 0, 0}) + raw(std::vector<float>(corners.begin() + i, corners.begin() + i + 9)) +
            raw<uint16_t>(0);
  }
  return file;
}

const std::vector<float> kCorners = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0, 0, 0, 2};

struct Stl : testing::Test {
  TemporaryFolder folder;
  Mesh read(const std::string& bytes) { return read_stl(folder.write("a.stl", bytes), {}); }
  void check(const std::vector<BrokenFile>& files) {
    for (const BrokenFile& broken : files) {
      EXPECT_EQ(error_of(folder, [&] { read(broken.content); }), broken.message) << broken.what;
    }
  }
};

TEST_F(Stl, ReadsText) {
  const Mesh mesh = read(kText);
  EXPECT_EQ(mesh.positions.size(), 6u);  // not welded
  EXPECT_EQ(mesh.triangles, (std::vector<std::array<uint32_t, 3>>{{0, 1, 2}, {3, 4, 5}}));
  EXPECT_EQ(mesh.positions[4], (Vec3f{1, 0, 0}));
  EXPECT_TRUE(mesh.normals.empty());
  EXPECT_TRUE(mesh.uvs.empty());
}

TEST_F(Stl, TextMayHoldSeveralSolidsInCapitals) {
  std::string upper = kText;
  for (char& c : upper) c = static_cast<char>(std::toupper(c));
  EXPECT_EQ(read(kText + upper.replace(0, 5, "solid")).triangles.size(), 4u);
}

TEST_F(Stl, ReadsBinaryEvenIfItBeginsWithSolid) {
  std::string file = binary_stl(2, kCorners);
  EXPECT_EQ(read(file).triangles.size(), 2u);
  EXPECT_EQ(read(file.replace(0, 5, "solid")).positions[5], (Vec3f{0, 0, 2}));
}

TEST_F(Stl, BinaryNormalsAreNotLookedAt) {
  std::string file = binary_stl(1, {kCorners.begin(), kCorners.begin() + 9});
  file.replace(84, 4, raw(std::numeric_limits<float>::quiet_NaN()));
  EXPECT_EQ(read(file).triangles.size(), 1u);
}

TEST_F(Stl, BrokenTexts) {
  check({
      {"empty", "", "a.stl: the file is empty"},
      {"no solid", "facet\n", "a.stl: not an STL file: neither 'solid' nor 84 bytes long, but 6 bytes"},
      {"only a name", "solid\n", "a.stl:1: the file ends before 'endsolid'"},
      {"no facets", "solid\nendsolid\n", "a.stl: the mesh has no triangles"},
      {"unknown keyword", "solid\nface\n", "a.stl:2: expected 'facet', found 'face'"},
      {"no loop", "solid\nfacet normal 0 0 1\nloop\n", "a.stl:3: expected 'outer', found 'loop'"},
      {"half a loop", "solid\nfacet normal 0 0 1\nouter\n", "a.stl:3: expected 'loop', found ''"},
      {"ends in a facet", "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\n",
       "a.stl:4: the file ends before 'vertex'"},
      {"two vertices", "solid\nfacet\nouter loop\nvertex 0 0 0\nvertex 0 1 0\nendloop\n",
       "a.stl:6: expected 'vertex', found 'endloop'"},
      {"two numbers", "solid\nfacet\nouter loop\nvertex 0 0\n", "a.stl:4: vertex: must have 3 numbers"},
      {"four numbers", "solid\nfacet\nouter loop\nvertex 0 0 0 1\n", "a.stl:4: unexpected '1'"},
      {"nan", "solid\nfacet\nouter loop\nvertex 0 nan 0\n", "a.stl:4: vertex: 'nan' is not finite"},
      {"letters", "solid\nfacet\nouter loop\nvertex 0 0 z\n", "a.stl:4: vertex: 'z' is not a number"},
      {"behind the end", kText + "more\n", "a.stl:17: expected 'solid', found 'more'"},
      {"second solid open", kText + "solid\n", "a.stl:17: the file ends before 'endsolid'"},
  });
}

TEST_F(Stl, BrokenBinaries) {
  std::vector<float> with_nan = kCorners;
  with_nan[10] = std::numeric_limits<float>::quiet_NaN();
  check({
      {"count too high", binary_stl(3, kCorners),
       "a.stl: byte 80: 3 triangles need a file of 234 bytes, not of 184 bytes"},
      {"huge count", binary_stl(4294967295u, kCorners),
       "a.stl: byte 80: 4294967295 triangles need a file of 214748364834 bytes, not of 184 bytes"},
      {"count too low", binary_stl(1, kCorners),
       "a.stl: byte 80: 1 triangles need a file of 134 bytes, not of 184 bytes"},
      {"no triangles", binary_stl(0, {}), "a.stl: the mesh has no triangles"},
      {"nan", binary_stl(2, with_nan), "a.stl: byte 150: triangle 1: coordinate is not finite"},
      {"flat", binary_stl(1, std::vector<float>(9, 1.0f)),
       "a.stl: 1 of 1 triangles have zero area: nothing is left to render"},
  });
}

TEST_F(Stl, TruncatedAtEveryEighth) {
  const std::string whole = binary_stl(2, kCorners);
  for (size_t eighth = 1; eighth < 8; ++eighth) {
    const size_t size = whole.size() * eighth / 8;
    const std::string expected = size < 84
                                     ? "a.stl: not an STL file: neither 'solid' nor 84 bytes long, but " +
                                           std::to_string(size) + " bytes"
                                     : "a.stl: byte 80: 2 triangles need a file of 184 bytes, not of " +
                                           std::to_string(size) + " bytes";
    EXPECT_EQ(error_of(folder, [&] { read(whole.substr(0, size)); }), expected);
  }
}

}  // namespace
}  // namespace kiloband::test
