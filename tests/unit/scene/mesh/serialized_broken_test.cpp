// Serialized meshes that are wrong, each with the exact message.
#include <gtest/gtest.h>

#include <limits>

#include "binary.hpp"
#include "scene/mesh/mesh.hpp"
#include "support.hpp"

namespace kiloband::test {
namespace {

struct SerializedBroken : testing::Test {
  TemporaryFolder folder;
  std::string error(const std::string& bytes, int shape_index = 0) {
    const auto path = folder.write("a.serialized", bytes);
    MeshOptions options;
    options.shape_index = shape_index;
    return error_of(folder, [&] { read_serialized(path, options); });
  }
  /// The message with the number of its byte replaced by N: inside a zlib stream it depends
  /// on how zlib buffers.
  std::string error_anywhere(const std::string& bytes) {
    std::string text = error(bytes);
    const std::string mark = "byte ";
    const size_t begin = text.find(mark);
    if (begin == std::string::npos) return text;
    const size_t end = text.find(':', begin);
    return text.replace(begin + mark.size(), end - begin - mark.size(), "N");
  }
};

template <typename Change>
std::string changed(Change change) {
  PlainMesh mesh;
  change(mesh);
  return serialized_file(mesh);
}

TEST_F(SerializedBroken, Container) {
  const std::string good = serialized_file(PlainMesh{});
  EXPECT_EQ(error(""), "a.serialized: the file is empty");
  EXPECT_EQ(error("abc"), "a.serialized: too short for a serialized mesh: 3 bytes");
  EXPECT_EQ(error("ply\nformat"),
            "a.serialized: byte 0: not a Mitsuba serialized mesh: it must begin with 0x041C");
  EXPECT_EQ(error(std::string(good).replace(2, 2, raw<uint16_t>(5))),
            "a.serialized: byte 2: version 5: must be 3 or 4");
  EXPECT_EQ(error(good, 1), "a.serialized: shape_index 1: must be in 0..0");
  EXPECT_EQ(error(good, -1), "a.serialized: shape_index -1: must be in 0..0");
  const size_t count_at = good.size() - 4, entry_at = good.size() - 12;
  const auto at = [](size_t byte) { return "a.serialized: byte " + std::to_string(byte) + ": "; };
  EXPECT_EQ(error(std::string(good).replace(count_at, 4, raw<uint32_t>(0))),
            at(count_at) + "table of 0 meshes does not fit: the file is truncated or damaged");
  EXPECT_EQ(error(std::string(good).replace(count_at, 4, raw<uint32_t>(4000000000u))),
            at(count_at) + "table of 4000000000 meshes does not fit: the file is truncated or damaged");
  EXPECT_EQ(error(std::string(good).replace(entry_at, 8, raw<uint64_t>(1ull << 63))),
            at(entry_at) + "mesh 0 cannot span bytes 9223372036854775808.." + std::to_string(entry_at) +
                ": the file is truncated or damaged");
  EXPECT_EQ(error(std::string(good).replace(entry_at, 8, raw<uint64_t>(2))),
            at(2) + "not a Mitsuba serialized mesh: it must begin with 0x041C");
}

TEST_F(SerializedBroken, Stream) {
  const std::string stream = deflate(PlainMesh{}.bytes(4));
  EXPECT_EQ(error_anywhere(serialized_file(4, {std::string("no zlib stream")})),
            "a.serialized: byte N: bad zlib stream: incorrect header check");
  EXPECT_EQ(error_anywhere(serialized_file(4, {stream.substr(0, stream.size() / 2)})),
            "a.serialized: byte N: the zlib stream is cut off");
  EXPECT_EQ(error_anywhere(serialized_file(4, {stream.substr(0, stream.size() - 4)})),
            "a.serialized: byte N: the zlib stream is cut off");
  std::string checksum = stream;
  checksum.back() ^= 1;
  EXPECT_EQ(error_anywhere(serialized_file(4, {checksum})),
            "a.serialized: byte N: bad zlib stream: incorrect data check");
  EXPECT_EQ(error_anywhere(serialized_file(4, {deflate(PlainMesh{}.bytes(4) + "x")})),
            "a.serialized: byte N: the zlib stream holds more than the mesh");
  const std::string plain = PlainMesh{}.bytes(4);
  EXPECT_EQ(error_anywhere(serialized_file(4, {deflate(plain.substr(0, plain.size() - 1))})),
            "a.serialized: byte N: the zlib stream ends too early");
  EXPECT_EQ(error_anywhere(serialized_file(4, {deflate("")})),
            "a.serialized: byte N: the zlib stream ends too early");
}

TEST_F(SerializedBroken, Contents) {
  const std::string start = "a.serialized: byte N: ";
  EXPECT_EQ(error_anywhere(changed([](PlainMesh& m) { m.flags = 0; })), start + "bad mesh flags 0");
  EXPECT_EQ(error_anywhere(changed([](PlainMesh& m) { m.flags = 0x3000; })), start + "bad mesh flags 12288");
  EXPECT_EQ(error_anywhere(changed([](PlainMesh& m) { m.flags = 0x1100; })), start + "bad mesh flags 4352");
  EXPECT_EQ(error_anywhere(changed([](PlainMesh& m) { m.name = std::string(70000, 'n'); })),
            start + "the mesh's name has more than 65536 bytes");
  EXPECT_EQ(error_anywhere(changed([](PlainMesh& m) { m.vertices = 1ull << 60; })),
            start + "1152921504606846976 vertices and 2 triangles: more than the file can hold");
  EXPECT_EQ(error_anywhere(changed([](PlainMesh& m) { m.triangles = 1ull << 40; })),
            start + "4 vertices and 1099511627776 triangles: more than the file can hold");
  EXPECT_EQ(error_anywhere(changed([](PlainMesh& m) {
              m.indices = raw<uint32_t>({0, 1, 2, 0, 2, 4});
            })),
            start + "triangle 1: index 4: must be below 4, the number of vertices");
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(error_anywhere(changed([&](PlainMesh& m) { m.arrays.replace(16, 4, raw(nan)); })),
            start + "vertex 1: position not finite");
  EXPECT_EQ(error_anywhere(changed([&](PlainMesh& m) {
              m.flags = 0x1001;
              m.arrays += raw<float>({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, nan});
            })),
            start + "vertex 3: normal not finite");
  EXPECT_EQ(error_anywhere(changed([](PlainMesh& m) {
              m.flags = 0x2000;
              m.arrays = raw(std::vector<double>(12, 1e39));
            })),
            start + "vertex 0: position too large for a float");
}

TEST_F(SerializedBroken, EmptyMeshes) {
  EXPECT_EQ(error(changed([](PlainMesh& m) {
              m.triangles = 0;
              m.indices.clear();
            })),
            "a.serialized: the mesh has no triangles");
  EXPECT_EQ(error(changed([](PlainMesh& m) {
              m.vertices = 0;
              m.triangles = 0;
              m.arrays.clear();
              m.indices.clear();
            })),
            "a.serialized: the mesh has no triangles");
}

// A stream of zeros that promises a gigabyte in a small file must not cost a gigabyte:
// the counts do not fit it.
TEST_F(SerializedBroken, SmallBombIsRefused) {
  PlainMesh bomb;
  bomb.vertices = 100'000'000;
  bomb.arrays = std::string(1'000'000, '\0');
  EXPECT_EQ(error_anywhere(serialized_file(bomb)),
            "a.serialized: byte N: 100000000 vertices and 2 triangles: more than the file can hold");
}

TEST_F(SerializedBroken, EveryTruncation) {
  const std::string whole =
      serialized_file(4, {deflate(PlainMesh{}.bytes(4)), deflate(PlainMesh{}.bytes(4))});
  for (size_t size = 0; size < whole.size(); ++size) {
    EXPECT_NE(error(whole.substr(0, size)), "accepted") << size;
    EXPECT_NE(error(whole.substr(0, size), 1), "accepted") << size;
  }
}

}  // namespace
}  // namespace kiloband::test
