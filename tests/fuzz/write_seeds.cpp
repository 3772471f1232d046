// Writes the seeds that the program's own writers and other tests can make: write_seeds FOLDER, which is
// tests/fuzz. To be run again where a format of ours changes; the other seeds are written by hand.
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "post/camera_geometry.hpp"
#include "tests/fuzz/fuzz_checkpoint.hpp"
#include "tests/support/zoo/scene_zoo.hpp"
#include "tests/unit/cube/cube_support.hpp"
#include "tests/unit/scene/mesh/binary.hpp"

namespace kiloband::fuzz {
namespace {

namespace fs = std::filesystem;

void write(const fs::path& file, const std::string& bytes) {
  fs::create_directories(file.parent_path());
  std::ofstream(file, std::ios::binary) << bytes;
}

/// What the scenes of the corpus name.
void write_files(const fs::path& folder) {
  const test::ZooFolder files;
  fs::copy(files.path(), folder / "files",
           fs::copy_options::recursive | fs::copy_options::overwrite_existing);
}

void write_meshes(const fs::path& folder) {
  const test::PlainMesh plain;
  test::PlainMesh full;
  full.flags = 0x2000 | 0x1 | 0x2 | 0x8;
  full.arrays = test::raw(std::vector<double>{0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}) +
                test::raw(std::vector<double>{0, 0, 2, 0, 0, 2, 0, 0, 2, 0, 0, 2}) +
                test::raw(std::vector<double>(8, 0.25)) + test::raw(std::vector<double>(12, 0.5));
  write(folder / "plain3.serialized", test::serialized_file(plain, 3));
  write(folder / "full4.serialized",
        test::serialized_file(4, {test::deflate(full.bytes(4)), test::deflate(plain.bytes(4))}));
}

/// Bands, one of them a response; with everything that may accompany it, or with nothing.
test::Cube small_cube(bool complete) {
  std::vector<Band> bands = test::equal_bands(500, 620, 2);
  if (complete) bands.push_back({{500, 620, "red"}, true});
  test::Cube cube =
      complete ? test::make_cube(3, 2, bands, true, {"depth", "normal.X"}) : test::make_cube(2, 2, bands);
  if (!complete) return cube;
  cube.info.samples_per_pixel = 16;
  cube.info.replicates = 4;
  CameraGeometry camera;
  camera.film_width = camera.film_height = 8;
  camera.tan_half_fov_x = 0.5;
  cube.info.metadata = {{kCameraKey, camera.to_text()}, {"seed", "1"}};
  return cube;
}

void write_cubes(const fs::path& folder) {
  for (const bool complete : {false, true}) {
    const std::string name = complete ? "complete" : "plain";
    const test::TemporaryFolder scratch;
    test::write_cube_file(small_cube(complete), scratch / "a.exr");
    test::write_cube_file(small_cube(complete), scratch / "a.hdr");
    write(folder / "exr_cube" / (name + ".exr"), scratch.read("a.exr"));
    std::string envi = scratch.read("a.hdr") + "\n----\n" + scratch.read("a.img");
    if (complete) {
      for (const char* part : {"a.var.hdr", "a.var.img", "a.aux.hdr", "a.aux.img"})
        envi += "\n----\n" + scratch.read(part);
    }
    write(folder / "envi_cube" / (name + ".txt"), envi);
  }
}

void write_seeds(const fs::path& folder) {
  write_files(folder);
  write_meshes(folder / "corpus/serialized");
  write_cubes(folder / "corpus");
  const test::TemporaryFolder scratch;
  write_small_checkpoint(scratch / "a");
  write(folder / "corpus/checkpoint/small.checkpoint", scratch.read("a"));
}

}  // namespace
}  // namespace kiloband::fuzz

int main(int count, char** arguments) {
  if (count != 2) {
    std::fputs("usage: write_seeds FOLDER\n", stderr);
    return 2;
  }
  kiloband::fuzz::write_seeds(arguments[1]);
  return 0;
}
