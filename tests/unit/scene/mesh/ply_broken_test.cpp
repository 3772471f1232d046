// PLY files that are wrong, each with the exact message.
#include <gtest/gtest.h>

#include <limits>

#include "binary.hpp"
#include "scene/mesh/mesh.hpp"
#include "support.hpp"

namespace kiloband::test {
namespace {

const std::string kXyz = "property float x\nproperty float y\nproperty float z\n";
const std::string kFace = "element face 1\nproperty list uchar int vertex_indices\n";

/// A text file whose header is complete but for `end_header`, with three vertices.
std::string text_file(const std::string& body, const std::string& extra = "",
                      const std::string& face = kFace) {
  return "ply\nformat ascii 1.0\nelement vertex 3\n" + kXyz + extra + face + "end_header\n" + body;
}

/// Header of 155 bytes, then 36 bytes of vertices and the face.
std::string binary_file(const std::string& body) {
  return "ply\nformat binary_little_endian 1.0\nelement vertex 3\n" + kXyz + kFace + "end_header\n" + body;
}

const std::string kVertices = "0 0 0\n1 0 0\n0 1 0\n";
const std::string kRawVertices = raw<float>({0, 0, 0, 1, 0, 0, 0, 1, 0});
const std::string kRawFace = raw<uint8_t>(3) + raw<int32_t>({0, 1, 2});
const float kNan = std::numeric_limits<float>::quiet_NaN();

const std::vector<BrokenFile> kBrokenHeaders = {
    {"wrong magic", "plx\n", "a.ply:1: header: not a PLY file: the first line must be 'ply'"},
    {"nothing but magic", "ply\n", "a.ply:1: header: the file ends before 'end_header'"},
    {"no end", "ply\nformat ascii 1.0\nelement vertex 3\n",
     "a.ply:3: header: the file ends before 'end_header'"},
    {"no format", "ply\nend_header\n", "a.ply:2: header: no 'format' line"},
    {"bad format", "ply\nformat binary 1.0\n",
     "a.ply:2: header: format 'binary': must be ascii, binary_little_endian or binary_big_endian"},
    {"bad version", "ply\nformat ascii 2.0\n", "a.ply:2: header: version '2.0': must be 1.0"},
    {"two formats", "ply\nformat ascii 1.0\nformat ascii 1.0\n", "a.ply:3: header: second 'format' line"},
    {"extra word", "ply\nformat ascii 1.0 x\n", "a.ply:2: header: unexpected 'x' at the end of the line"},
    {"unknown keyword", "ply\nelephant 3\n", "a.ply:2: header: unknown keyword 'elephant'"},
    {"negative count", "ply\nformat ascii 1.0\nelement vertex -3\n",
     "a.ply:3: header: element 'vertex': '-3' is not a count"},
    {"missing count", "ply\nformat ascii 1.0\nelement vertex\n",
     "a.ply:3: header: element 'vertex': '' is not a count"},
    {"count beyond 64 bits", "ply\nelement vertex 99999999999999999999\n",
     "a.ply:2: header: element 'vertex': '99999999999999999999' is not a count"},
    {"nameless element", "ply\nelement\n", "a.ply:2: header: element without a name"},
    {"same element twice", "ply\nelement a 1\nelement a 1\n", "a.ply:3: header: second element 'a'"},
    {"early property", "ply\nproperty float x\n", "a.ply:2: header: property before the first element"},
    {"unknown type", "ply\nelement vertex 3\nproperty half x\n", "a.ply:3: header: unknown type 'half'"},
    {"nameless property", "ply\nelement vertex 3\nproperty float\n",
     "a.ply:3: header: property without a name"},
    {"float list count", "ply\nelement face 1\nproperty list float int vertex_indices\n",
     "a.ply:3: header: list count of type float: must be an integer type"},
    {"same property twice", "ply\nelement vertex 3\nproperty float x\nproperty int x\n",
     "a.ply:4: header: element 'vertex': second property 'x'"},
    {"huge count",
     "ply\nformat ascii 1.0\nelement vertex 4000000000\n" + kXyz + kFace + "end_header\n" + kVertices,
     "a.ply:3: header: element 'vertex': 4000000000 rows of at least 6 bytes, but only 18 bytes follow the "
     "header"},
    {"huge binary count",
     "ply\nformat binary_big_endian 1.0\nelement vertex 18446744073709551615\n" + kXyz + kFace +
         "end_header\n0123",
     "a.ply:3: header: element 'vertex': 18446744073709551615 rows of at least 12 bytes, but only 4 bytes "
     "follow the header"},
    {"no vertices", "ply\nformat ascii 1.0\n" + kFace + "end_header\n3 0 1 2\n",
     "a.ply: header: no element 'vertex'"},
    {"no faces", "ply\nformat ascii 1.0\nelement vertex 3\n" + kXyz + "end_header\n" + kVertices,
     "a.ply: header: no element 'face'"},
    {"no z",
     "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n" + kFace +
         "end_header\n0 0 3 0 0 0\n",
     "a.ply:3: header: element 'vertex' has no property 'z'"},
    {"list as z",
     "ply\nformat ascii 1.0\nelement vertex 0\nproperty list uchar float x\nproperty float y\nproperty float "
     "z\n" +
         kFace + "end_header\n3 0 0 0\n",
     "a.ply:3: header: property 'x' must not be a list"},
    {"no index list", text_file(kVertices, "", "element face 1\nproperty list uchar int corners\n"),
     "a.ply:7: header: element 'face' has no property 'vertex_indices' or 'vertex_index'"},
    {"index scalar", text_file(kVertices + "1\n", "", "element face 1\nproperty int vertex_index\n"),
     "a.ply:7: header: property 'vertex_index' must be a list of integers"},
    {"float indices",
     text_file(kVertices + "3 0 1 2\n", "", "element face 1\nproperty list uchar float vertex_index\n"),
     "a.ply:7: header: property 'vertex_index' must be a list of integers"},
};

const std::vector<BrokenFile> kBrokenTexts = {
    {"letters", text_file("0 0 0\n1 zero 0\n0 1 0\n3 0 1 2\n"),
     "a.ply:11: vertex 1: property 'y': 'zero' is not a number"},
    {"trailing rubbish", text_file("0 0 0\n1 0, 0\n0 1 0\n3 0 1 2\n"),
     "a.ply:11: vertex 1: property 'y': '0,' is not a number"},
    {"nan", text_file("0 0 nan\n1 0 0\n0 1 0\n3 0 1 2\n"),
     "a.ply:10: vertex 0: property 'z': 'nan' is not finite"},
    {"infinity", text_file("0 0 0\n1 0 0\n0 inf 0\n3 0 1 2\n"),
     "a.ply:12: vertex 2: property 'y': 'inf' is not finite"},
    {"too large for a float", text_file("0 0 0\n1 0 1e39\n0 1 0\n3 0 1 2\n"),
     "a.ply:11: vertex 1: property 'z': the value is too large for a float"},
    {"too large for a double", text_file("0 0 0\n1 0 1e999\n0 1 0\n3 0 1 2\n"),
     "a.ply:11: vertex 1: property 'z': '1e999' is too large"},
    {"not a byte", text_file("0 0 0 1\n1 0 0 256\n0 1 0 1\n3 0 1 2\n", "property uchar red\n"),
     "a.ply:12: vertex 1: property 'red': '256' is not of type uchar"},
    {"not a short", text_file("0 0 0 1\n1 0 0 -32769\n0 1 0 1\n3 0 1 2\n", "property short a\n"),
     "a.ply:12: vertex 1: property 'a': '-32769' is not of type short"},
    {"not whole", text_file(kVertices + "3 0 1.5 2\n"),
     "a.ply:13: face 0: property 'vertex_indices': '1.5' is not of type int"},
    {"no corner", text_file(kVertices + "0\n"),
     "a.ply:13: face 0: property 'vertex_indices': 0 corners, must be at least 3"},
    {"one corner", text_file(kVertices + "1 0\n"),
     "a.ply:13: face 0: property 'vertex_indices': 1 corners, must be at least 3"},
    {"two corners", text_file(kVertices + "2 0 1\n"),
     "a.ply:13: face 0: property 'vertex_indices': 2 corners, must be at least 3"},
    {"negative list",
     text_file(kVertices + "-3 0 1 2\n", "", "element face 1\nproperty list char int vertex_indices\n"),
     "a.ply:13: face 0: property 'vertex_indices': list of -3 items"},
    {"index too high", text_file(kVertices + "3 0 1 3\n"),
     "a.ply:13: face 0: property 'vertex_indices': index 3: must be below 3, the number of vertices"},
    {"negative index", text_file(kVertices + "3 0 -1 2\n"),
     "a.ply:13: face 0: property 'vertex_indices': index -1: must be below 3, the number of vertices"},
    {"too few", text_file(kVertices + "3 0 1\n"),
     "a.ply:14: face 0: property 'vertex_indices': the file ends too early"},
    {"too many", text_file(kVertices + "3 0 1 2\n\n7\n"), "a.ply:15: unexpected '7' after the last element"},
    {"zero faces", text_file(kVertices, "", "element face 0\nproperty list uchar int vertex_indices\n"),
     "a.ply: the mesh has no triangles"},
    {"flat", text_file(kVertices + "3 0 0 2\n"),
     "a.ply: 1 of 1 triangles have zero area: nothing is left to render"},
};

const std::vector<BrokenFile> kBrokenBinaries = {
    {"nan", binary_file(raw<float>({0, 0, 0, 1, kNan, 0, 0, 1, 0}) + kRawFace),
     "a.ply: byte 185: vertex 1: property 'y': the value is not finite"},
    {"index too high", binary_file(kRawVertices + raw<uint8_t>(3) + raw<int32_t>({0, 1, 77})),
     "a.ply: byte 214: face 0: property 'vertex_indices': index 77: must be below 3, the number of vertices"},
    {"two corners", binary_file(kRawVertices + raw<uint8_t>(2) + raw<int32_t>({0, 1})),
     "a.ply: byte 205: face 0: property 'vertex_indices': 2 corners, must be at least 3"},
    {"long list", binary_file(kRawVertices + raw<uint8_t>(255) + raw<int32_t>({0, 1, 2})),
     "a.ply: byte 218: face 0: property 'vertex_indices': the file ends too early"},
    {"trailing bytes", binary_file(kRawVertices + kRawFace + "abc"),
     "a.ply: byte 218: 3 unexpected bytes after the last element"},
};

void check(const std::vector<BrokenFile>& files) {
  const TemporaryFolder folder;
  for (const BrokenFile& broken : files) {
    const auto path = folder.write("a.ply", broken.content);
    EXPECT_EQ(error_of(folder, [&] { read_ply(path, {}); }), broken.message) << broken.what;
  }
}

TEST(PlyBroken, Headers) {
  check(kBrokenHeaders);
}
TEST(PlyBroken, Texts) {
  check(kBrokenTexts);
}
TEST(PlyBroken, Binaries) {
  check(kBrokenBinaries);
}

// 218 bytes: cuts 1..6 fall into the header, cut 7 into the vertices.
TEST(PlyBroken, TruncatedAtEveryEighth) {
  const std::vector<std::string> messages = {
      "a.ply:2: header: format 'binary_little_en': must be ascii, binary_little_endian or binary_big_endian",
      "a.ply:4: header: unknown keyword 'p'",
      "a.ply:5: header: unknown type 'fl'",
      "a.ply:7: header: unknown keyword 'eleme'",
      "a.ply:8: header: unknown type 'uch'",
      "a.ply:9: header: unknown keyword 'end_h'",
      "a.ply:3: header: element 'vertex': 3 rows of at least 12 bytes, but only 21 bytes follow the header",
  };
  const TemporaryFolder folder;
  const std::string whole = binary_file(kRawVertices + kRawFace);
  ASSERT_EQ(whole.size(), 218u);
  for (size_t eighth = 1; eighth < 8; ++eighth) {
    const auto path = folder.write("a.ply", whole.substr(0, whole.size() * eighth / 8));
    EXPECT_EQ(error_of(folder, [&] { read_ply(path, {}); }), messages[eighth - 1]) << eighth;
  }
}

// Whatever is missing of the body, even one byte, is noticed.
TEST(PlyBroken, EveryTruncatedBody) {
  const TemporaryFolder folder;
  const std::string whole = binary_file(kRawVertices + kRawFace);
  for (size_t size = 0; size < whole.size(); ++size) {
    const auto path = folder.write("a.ply", whole.substr(0, size));
    EXPECT_NE(error_of(folder, [&] { read_ply(path, {}); }), "accepted") << size;
  }
}

}  // namespace
}  // namespace kiloband::test
