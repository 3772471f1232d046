// Wrong spectral images and elements: each with its exact message.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "scene/compile/flat_scene.hpp"
#include "scene/image/spectral_image.hpp"
#include "support.hpp"

namespace kiloband::test::spectral_messages_test {
namespace {

const ChannelList kBands{{400, 450, ""}, {450, 500, ""}};

std::string bitmap(const std::string& content) {
  return sphere_with("<texture type='spectral_bitmap' name='reflectance'>" + content + "</texture>");
}
std::string file_bitmap(const std::string& file) {
  return bitmap("<string name='filename' value='" + file + "'/>");
}
std::string sky(const std::string& file, const std::string& more = "") {
  return "<emitter type='spectral_envmap'><string name='filename' value='" + file + "'/>" + more +
         "</emitter>";
}

/// What stands before messages about the value of `filename`.
const std::string kSkyValue = "scene.xml:2:64: error: ";

struct WrongValue {
  const char* name;
  double value;
  const char* message;
};

TEST(SpectralMessages, ValuesNameBandAndPixel) {
  const TemporaryFolder folder;
  const WrongValue wrong[] = {
      {"negative", -0.5, "-0.5: must be finite and >= 0 (down to -0.00417, 1 % of the mean, is taken as 0)"},
      {"nan", std::nan(""), "nan: must be finite and >= 0"},
      {"infinite", std::numeric_limits<double>::infinity(), "inf: must be finite and >= 0"}};
  for (const WrongValue& w : wrong) {
    for (const std::string extension : {".exr", ".hdr"}) {
      const std::string file = w.name + extension;
      write_cube(folder / file, 3, 2, kBands, [&](uint32_t x, uint32_t y, std::size_t b) {
        return x == 2 && y == 1 && b == 1 ? w.value : 0.5;
      });
      EXPECT_EQ(error_of(sky(file), folder),
                kSkyValue + file + ": band 450-500 nm at pixel (2, 1): " + w.message);
    }
  }
}

TEST(SpectralMessages, SlightlyNegativeValuesAreTakenAsZero) {
  const TemporaryFolder folder;
  write_cube(folder / "a.exr", 3, 2, kBands, [&](uint32_t x, uint32_t y, std::size_t b) {
    return x == 2 && b == 1 ? (y == 1 ? -2e-3 : -1e-6) : 0.5;
  });
  Messages messages;
  const SpectralImage image = read_spectral_image(folder / "a.exr", messages.sink());
  const std::size_t bands = kBands.size();
  EXPECT_EQ((*image.values)[2 * bands + 1], 0);
  EXPECT_EQ((*image.values)[5 * bands + 1], 0);
  EXPECT_EQ((*image.values)[5 * bands], 0.5f);
  ASSERT_EQ(messages.texts.size(), 1u);
  EXPECT_EQ(messages.texts[0],
            "2 texels have slightly negative values, which are taken as 0; the lowest: band 450-500 nm at "
            "pixel (2, "
            "1): -0.002");
}

TEST(SpectralMessages, EachBandHasItsOwnMean) {
  const TemporaryFolder folder;
  write_cube(folder / "dark.exr", 3, 2, kBands,
             [&](uint32_t x, uint32_t, std::size_t b) { return b == 1 ? (x == 0 ? -1e-4 : 1e-4) : 1000; });
  EXPECT_EQ(error_of(sky("dark.exr"), folder),
            kSkyValue +
                "dark.exr: band 450-500 nm at pixel (0, 0): -1e-04: must be finite and >= 0 (down to "
                "-6.67e-07, 1 % of the mean, is taken as 0)");
}

TEST(SpectralMessages, ReflectanceAboveOne) {
  const TemporaryFolder folder;
  write_cube(folder / "bright.exr", 3, 2, kBands,
             [&](uint32_t x, uint32_t y, std::size_t b) { return x == 1 && y == 1 && b == 0 ? 1.5 : 1; });
  EXPECT_EQ(error_of(file_bitmap("bright.exr"), folder),
            "scene.xml:2:58: error: diffuse bsdf: reflectance 1.5 at pixel (1, 1) of 'bright.exr', band "
            "400-450 nm: must "
            "be in [0, 1]");
  EXPECT_EQ(error_of(sky("bright.exr"), folder), "accepted");
}

TEST(SpectralMessages, Files) {
  const TemporaryFolder folder;
  const auto value = [](uint32_t, uint32_t, std::size_t) { return 0.5; };
  EXPECT_EQ(error_of(sky("none.exr"), folder), kSkyValue + "file 'none.exr' not found");
  write_cube(folder / "small.exr", 1, 2, kBands, value);
  EXPECT_EQ(
      error_of(sky("small.exr"), folder),
      kSkyValue +
          "spectral_envmap emitter: an environment map needs at least 2 x 2 pixels, 'small.exr' has 1 x 2");
  folder.write("colours.pfm", "PF\n1 1\n-1.0\n............");
  EXPECT_EQ(
      error_of(sky("colours.pfm"), folder),
      kSkyValue + "'colours.pfm': cannot tell the format of a cube: must end in .exr, .hdr or .img (ENVI)");

  write_cube(folder / "cut.hdr", 4, 4, kBands, value);
  std::filesystem::resize_file(folder / "cut.img", 100);
  EXPECT_EQ(error_of(sky("cut.hdr"), folder),
            kSkyValue + "cut.img: the file has 100 bytes, its header needs 128");
  const std::string header = "ENVI\nlines = 2\nbands = 1\ndata type = 1\ninterleave = bip\nbyte order = 0\n";
  folder.write("empty.hdr", header + "samples = 0\n");
  folder.write("empty.img", "");
  EXPECT_EQ(error_of(sky("empty.hdr"), folder), kSkyValue + "empty.hdr:7: samples '0': must be at least 1");
  folder.write("names.hdr", header + "samples = 2\nband names = {soil}\n");
  folder.write("names.img", "1234");
  EXPECT_EQ(error_of(sky("names.hdr"), folder),
            kSkyValue +
                "names.hdr: no band has wavelengths: give them with kiloband "
                "convert --wavelengths");
  folder.write(
      "wide.hdr",
      "ENVI\nlines = 1\nbands = 1\ndata type = 1\ninterleave = bip\nbyte order = 0\nsamples = 70000\n"
      "wavelength = {500}\nwavelength units = Nanometers\n");
  folder.write("wide.img", std::string(70000, '1'));
  EXPECT_EQ(error_of(sky("wide.hdr"), folder),
            kSkyValue + "wide.hdr: image size 70000x1: must be at most 65535 in a dimension");
  write_cube(folder / "twice.hdr", 2, 2, {{400, 500, ""}, {440, 460, ""}}, value);
  EXPECT_EQ(error_of(sky("twice.hdr"), folder),
            kSkyValue + "twice.hdr: two bands have their centre at 450 nm");
}

TEST(SpectralMessages, DamagedExr) {
  const TemporaryFolder folder;
  write_cube(folder / "cut.exr", 64, 64, kBands, [](uint32_t, uint32_t, std::size_t) { return 0.5; });
  std::filesystem::resize_file(folder / "cut.exr", std::filesystem::file_size(folder / "cut.exr") / 2);
  const std::string message = error_of(sky("cut.exr"), folder);
  EXPECT_EQ(message.substr(0, kSkyValue.size() + 7), kSkyValue + "cut.exr");
}

TEST(SpectralMessages, Elements) {
  const TemporaryFolder folder;
  write_cube(folder / "a.exr", 2, 2, kBands, [](uint32_t, uint32_t, std::size_t) { return 0.5; });
  EXPECT_EQ(error_of(sky("a.exr", "<float name='scale' value='-1'/>"), folder),
            "scene.xml:2:99: error: spectral_envmap emitter: scale -1: must be >= 0");
  EXPECT_EQ(error_of(sky("a.exr", "<transform name='to_world'><scale x='2'/></transform>"), folder),
            "scene.xml:2:73: error: spectral_envmap emitter: to_world must only rotate, move, mirror and "
            "scale uniformly");
  EXPECT_EQ(error_of(sky("a.exr") + "<emitter type='constant'/>", folder),
            "scene.xml:2:83: error: constant emitter: a second environment: only one is allowed");
  EXPECT_EQ(error_of(bitmap("<string name='filename' value='a.exr'/><string name='weights' value='a.exr'/>"),
                     folder),
            "scene.xml:2:163: error: spectral_bitmap texture: 'weights' together with 'filename'");
  EXPECT_EQ(error_of(bitmap(""), folder),
            "scene.xml:2:44: error: spectral_bitmap texture: parameter 'filename' is missing");
  EXPECT_EQ(
      error_of(
          "<shape type='sphere'><bsdf type='mask'><texture type='spectral_bitmap' name='opacity'><string "
          "name='filename' value='a.exr'/></texture></bsdf></shape><emitter type='constant'/>",
          folder),
      "scene.xml:2:55: error: mask bsdf: opacity: a spectral_bitmap is not supported here");
}

/// The emissivity would be the complement of its texels, which are not where those of bitmaps are.
TEST(SpectralMessages, NotWhereASurfaceEmitsThermally) {
  const TemporaryFolder folder;
  write_cube(folder / "a.exr", 2, 2, kBands, [](uint32_t, uint32_t, std::size_t) { return 0.5; });
  folder.write("t.pfm", std::string("Pf\n1 1\n-1.0\n\0\0\x96\x43", 16));  // 300 K
  const std::string image =
      "<texture type='spectral_bitmap' name='reflectance'><string name='filename' value='a.exr'/></texture>";
  const std::string temperatures[] = {
      "<float name='temperature' value='300'/>",
      "<texture type='bitmap' name='temperature'><boolean name='raw' value='true'/><string name='filename' value='t.pfm'/></texture>"};
  for (const std::string& temperature : temperatures) {
    const std::string body = "<shape type='sphere'><bsdf type='diffuse'>" + image +
                             "</bsdf><emitter type='thermal'>" + temperature + "</emitter></shape>";
    const auto compile = [&] {
      compile_scene(read_scene_text(scene_around(body), "scene.xml", folder.path(), {}),
                    {parse_channels("410-440"), {}, {}});
    };
    EXPECT_EQ(
        error_of(folder, compile),
        "scene.xml:2:23: error: bsdf: reflectance: a surface that emits thermally cannot have a spectral_bitmap here");
  }
}

std::string mixture(const std::string& endmembers) {
  return bitmap("<string name='weights' value='w.ppm'/>" + endmembers);
}

TEST(SpectralMessages, Endmembers) {
  const TemporaryFolder folder;
  folder.write("w.ppm", "P3\n2 1\n255\n0 0 0 204 102 51\n");  // 0.8, 0.4, 0.2
  const std::string half =
      "<spectrum name='endmember_0' value='0.5'/><spectrum name='endmember_1' value='0.5'/>";
  EXPECT_EQ(error_of(mixture(half + "<spectrum name='endmember_2' value='400:0.5, 500:1'/>"), folder),
            "accepted");
  EXPECT_EQ(error_of(mixture(half), folder),
            "scene.xml:2:124: error: spectral_bitmap texture: 2 endmembers (endmember_0 ...) for 3 weights "
            "of 'w.ppm'");
  EXPECT_EQ(error_of(mixture(half + "<spectrum name='endmember_2' value='400:0.5, 500:4'/>"), folder),
            "scene.xml:2:58: error: diffuse bsdf: reflectance: the weights at pixel (1, 0) of 'w.ppm' mix to "
            "1.4 at 500 "
            "nm: must be in [0, 1]");
  EXPECT_EQ(error_of(mixture(half + "<spectrum name='endmember_2' value='-1'/>"), folder),
            "scene.xml:2:252: error: spectral_bitmap texture: endmember_2 -1: must be >= 0");
  EXPECT_EQ(
      error_of(mixture(half + "<spectrum name='endmember_2' type='planck'><float name='temperature' "
                              "value='300'/></spectrum>"),
               folder),
      "scene.xml:2:58: error: diffuse bsdf: reflectance: endmember_2 describes emission: not allowed in a "
      "reflectance");
}

}  // namespace
}  // namespace kiloband::test::spectral_messages_test
