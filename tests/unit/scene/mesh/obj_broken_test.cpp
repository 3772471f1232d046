// OBJ files that are wrong, each with the exact message.
#include <gtest/gtest.h>

#include "scene/mesh/mesh.hpp"
#include "support.hpp"

namespace kiloband::test {
namespace {

const std::string kTriangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

const std::vector<BrokenFile> kBroken = {
    {"empty", "", "a.obj: the file is empty"},
    {"no faces", kTriangle, "a.obj: the mesh has no triangles"},
    {"only comments", "# nothing\n", "a.obj: the mesh has no triangles"},
    {"unknown keyword", kTriangle + "curv 0 1\n", "a.obj:4: unknown keyword 'curv'"},
    {"binary rubbish", "\x01v", "a.obj:1: unknown keyword '?v'"},
    {"two numbers", "v 0 0\n", "a.obj:1: v: 2 numbers, must be at least 3"},
    {"eight numbers", "v 0 0 0 1 1 1 1 1\n", "a.obj:1: v: more than 7 numbers"},
    {"letters", "v 0 abc 0\n", "a.obj:1: v: 'abc' is not a number"},
    {"trailing rubbish", "v 0 1.5x 0\n", "a.obj:1: v: '1.5x' is not a number"},
    {"hexadecimal", "v 0 0x10 0\n", "a.obj:1: v: '0x10' is not a number"},
    {"two signs", "v 0 +-1 0\n", "a.obj:1: v: '+-1' is not a number"},
    {"nan", "v nan 0 0\n", "a.obj:1: v: 'nan' is not finite"},
    {"infinity", "v 0 0 -inf\n", "a.obj:1: v: '-inf' is not finite"},
    {"too large", "v 0 0 1e39\n", "a.obj:1: v: '1e39' is too large for a float"},
    {"nan colour", "v 0 0 0 1 nan 1\n", "a.obj:1: v: 'nan' is not finite"},
    {"bad normal", "\n\nvn 0 0\n", "a.obj:3: vn: 2 numbers, must be at least 3"},
    {"bad uv", "vt 0\n", "a.obj:1: vt: 1 numbers, must be at least 2"},
    {"long uv", "vt 0 0 0 0\n", "a.obj:1: vt: more than 3 numbers"},
    {"no corner", kTriangle + "f\n", "a.obj:4: f: 0 corners, must be at least 3"},
    {"two corners", kTriangle + "f 1 2\n", "a.obj:4: f: 2 corners, must be at least 3"},
    {"index too high", kTriangle + "f 1 2 4\n",
     "a.obj:4: f: corner '4': position index 4: must be in 1..3, the number of such lines above"},
    {"index zero", kTriangle + "f 1 0 2\n",
     "a.obj:4: f: corner '0': position index 0: must be in 1..3, the number of such lines above"},
    {"huge index", kTriangle + "f 1 2 99999999999999999999999999\n",
     "a.obj:4: f: corner '99999999999999999999999999': position index 999999999999999999999999: must be in "
     "1..3, the "
     "number of such lines above"},
    {"index below", "f 1 2 3\n" + kTriangle,
     "a.obj:1: f: corner '1': position index 1: must be in 1..0, the number of such lines above"},
    {"negative index", kTriangle + "f -3 -2 -1\n",
     "a.obj:4: f: corner '-3': negative position index: relative indices are not supported, neither by "
     "Mitsuba"},
    {"negative normal", kTriangle + "vn 0 0 1\nf 1//-1 2//1 3//1\n",
     "a.obj:5: f: corner '1//-1': negative normal index: relative indices are not supported, neither by "
     "Mitsuba"},
    {"uv index", kTriangle + "f 1/1 2/1 3/1\n",
     "a.obj:4: f: corner '1/1': texture coordinate index 1: must be in 1..0, the number of such lines above"},
    {"normal index", kTriangle + "vn 0 0 1\nf 1//1 2//2 3//1\n",
     "a.obj:5: f: corner '2//2': normal index 2: must be in 1..1, the number of such lines above"},
    {"index rubbish", kTriangle + "f 1 2x 3\n", "a.obj:4: f: corner '2x': '2x' is not an index"},
    {"fraction", kTriangle + "f 1 2.0 3\n", "a.obj:4: f: corner '2.0': '2.0' is not an index"},
    {"only slashes", kTriangle + "f 1 // 3\n", "a.obj:4: f: corner '//': must be v, v/vt, v//vn or v/vt/vn"},
    {"no position", kTriangle + "f /1 2 3\n", "a.obj:4: f: corner '/1': must be v, v/vt, v//vn or v/vt/vn"},
    {"four parts", kTriangle + "f 1/1/1/1 2 3\n",
     "a.obj:4: f: corner '1/1/1/1': must be v, v/vt, v//vn or v/vt/vn"},
    {"all flat", kTriangle + "f 1 1 2\nf 3 3 3\n",
     "a.obj: 2 of 2 triangles have zero area: nothing is left to render"},
    {"collinear", "v 0 0 0\nv 1 1 1\nv 3 3 3\nf 1 2 3\n",
     "a.obj: 1 of 1 triangles have zero area: nothing is left to render"},
};

TEST(ObjBroken, SaysWhatAndWhere) {
  const TemporaryFolder folder;
  for (const BrokenFile& broken : kBroken) {
    const auto path = folder.write("a.obj", broken.content);
    EXPECT_EQ(error_of(folder, [&] { read_obj(path, {}); }), broken.message) << broken.what;
  }
}

TEST(ObjBroken, RefusesWhatIsNoFile) {
  const TemporaryFolder folder;
  EXPECT_EQ(error_of(folder, [&] { read_obj(folder / "none.obj", {}); }), "none.obj: no such file");
  std::filesystem::create_directory(folder / "folder.obj");
  EXPECT_EQ(error_of(folder, [&] { read_obj(folder / "folder.obj", {}); }), "folder.obj: not a regular file");
}

}  // namespace
}  // namespace kiloband::test
