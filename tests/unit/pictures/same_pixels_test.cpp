// What the program's own readers deliver is, bit by bit, what OpenImageIO delivers.
#include <gtest/gtest.h>
#include <png.h>

#include <cstring>

#include "pictures/readers/readers.hpp"
#include "samples.hpp"
#include "tests/support/data_folder.hpp"
#include "tests/unit/scene/image/image_support.hpp"

namespace kiloband::test {
namespace {

namespace fs = std::filesystem;

struct Pixels {
  int width = 0, height = 0;
  PictureInput::Kind kind{};
  std::string alpha;
  std::vector<std::pair<std::string, std::vector<float>>> channels;  // by name
};

/// Every channel by itself, then all together, which must be the same.
Pixels read_all(PictureInput& input) {
  const PictureInput::Spec& spec = input.spec();
  Pixels out{spec.width,
             spec.height,
             spec.kind,
             spec.alpha_channel < 0 ? "" : spec.channels[spec.alpha_channel],
             {}};
  const std::size_t pixels = static_cast<std::size_t>(spec.width * spec.height), count = spec.channels.size();
  std::vector<float> all(pixels * count);
  for (int row = 0; row < spec.height; row += spec.rows_at_once) {
    const int end = std::min(spec.height, row + spec.rows_at_once);
    EXPECT_TRUE(input.read(row, end, 0, static_cast<int>(count),
                           &all[static_cast<std::size_t>(row * spec.width) * count]))
        << input.error();
  }
  for (std::size_t c = 0; c < count; ++c) {
    std::vector<float> plane(pixels);
    EXPECT_TRUE(input.read(0, spec.height, static_cast<int>(c), 1, plane.data())) << input.error();
    for (std::size_t i = 0; i < pixels; ++i)
      EXPECT_EQ(std::memcmp(&plane[i], &all[i * count + c], sizeof(float)), 0)
          << spec.channels[c] << " " << i;
    out.channels.emplace_back(spec.channels[c], std::move(plane));
  }
  std::sort(out.channels.begin(), out.channels.end());
  return out;
}

std::unique_ptr<PictureInput> open_own(const fs::path& file) {
  const std::string extension = file.extension();
  if (extension == ".exr") return open_exr(file);
  if (extension == ".png") return open_png(file);
  if (extension == ".jpg") return open_jpeg(file);
  if (extension == ".hdr") return open_radiance(file);
  if (extension == ".ppm") return open_pnm(file);
  return open_pfm(file);
}

std::unique_ptr<PictureInput> open_oiio(const fs::path& file) {
  const std::map<std::string, std::string> kNames = {{".exr", "openexr"}, {".png", "png"}, {".jpg", "jpeg"},
                                                     {".hdr", "hdr"},     {".pfm", "pnm"}, {".ppm", "pnm"}};
  std::string error;
  auto input = oiio_library().open(kNames.at(file.extension()), file, error);
  EXPECT_TRUE(input) << file << ": " << error;
  return input;
}

bool is_radiance(const fs::path& file) {
  return read_file(file).starts_with("#?");
}

void expect_same(const fs::path& file) {
  SCOPED_TRACE(file.filename().string());
  const auto own = open_own(file), oiio = open_oiio(file);
  ASSERT_TRUE(own && oiio);
  const Pixels a = read_all(*own), b = read_all(*oiio);
  EXPECT_EQ(a.width, b.width);
  EXPECT_EQ(a.height, b.height);
  EXPECT_EQ(a.kind, b.kind);
  EXPECT_EQ(a.alpha, b.alpha);
  ASSERT_EQ(a.channels.size(), b.channels.size());
  for (std::size_t c = 0; c < a.channels.size(); ++c) {
    EXPECT_EQ(a.channels[c].first, b.channels[c].first);
    const std::vector<float>&x = a.channels[c].second, &y = b.channels[c].second;
    ASSERT_EQ(x.size(), y.size());
    std::size_t differ = 0;
    for (std::size_t i = 0; i < x.size(); ++i) differ += std::memcmp(&x[i], &y[i], sizeof(float)) != 0;
    EXPECT_EQ(differ, 0u) << a.channels[c].first;
  }
}

struct SamePixels : testing::Test {
  TemporaryFolder folder;
  const std::vector<std::vector<std::string>> models = {
      {"Y"}, {"Y", "A"}, {"R", "G", "B"}, {"R", "G", "B", "A"}};

  /// Random values, larger than 1 and negative where the type has such.
  fs::path write(const std::string& name, const std::vector<std::string>& channels, OIIO::TypeDesc type,
                 const std::function<void(OIIO::ImageSpec&)>& adjust = {}, int width = 131, int height = 70) {
    std::mt19937 random(static_cast<unsigned>(width));
    std::vector<float> values(static_cast<std::size_t>(width * height) * channels.size());
    const bool light = type == OIIO::TypeFloat || type == OIIO::TypeHalf;
    for (float& value : values) {
      value = std::uniform_real_distribution<float>(0, 1)(random);
      if (light) value = std::exp2(40 * value - 20);
    }
    return write_image(folder / name, width, height, channels, values, type, adjust);
  }
};

TEST_F(SamePixels, PngOfAllKinds) {
  const auto unassociated = [](OIIO::ImageSpec& spec) { spec["oiio:UnassociatedAlpha"] = 1; };
  for (const auto& channels : models)
    for (const auto& type : {OIIO::TypeUInt8, OIIO::TypeUInt16})
      expect_same(write("a.png", channels, type, unassociated));
  const PngSample grey{37, 21, PNG_COLOR_TYPE_GRAY}, colour{37, 21, PNG_COLOR_TYPE_RGB},
      palette{37, 21, PNG_COLOR_TYPE_PALETTE};
  const auto check = [&](PngSample sample, const std::function<void(PngSample&)>& change) {
    for (const bool interlaced : {false, true}) {
      change(sample);
      sample.interlaced = interlaced;
      write_png_sample(folder / "b.png", sample);
      expect_same(folder / "b.png");
    }
  };
  for (const int bits : {1, 2, 4, 8, 16}) {
    check(grey, [bits](PngSample& s) { s.bits = bits; });
    check(grey, [bits](PngSample& s) { s.bits = bits, s.transparent = true; });
  }
  for (const int bits : {8, 16})
    check(colour, [bits](PngSample& s) { s.bits = bits, s.transparent = s.gamma = true; });
  for (const int bits : {4, 8}) {
    check(palette, [bits](PngSample& s) { s.bits = bits; });
    check(palette, [bits](PngSample& s) { s.bits = bits, s.palette_alpha = true; });
  }
}

/// Every value of 8 and of 16 bits.
TEST_F(SamePixels, PngOfAllValues) {
  for (const auto& [type, width, height] :
       {std::tuple{OIIO::TypeUInt8, 16, 16}, std::tuple{OIIO::TypeUInt16, 256, 256}}) {
    const int count = width * height;
    std::vector<float> values(static_cast<std::size_t>(count));
    for (int i = 0; i < count; ++i)
      values[static_cast<std::size_t>(i)] = static_cast<float>(i) / static_cast<float>(count - 1);
    expect_same(write_image(folder / "a.png", width, height, {"Y"}, values, type));
    const auto input = open_png(folder / "a.png");
    std::vector<float> back(values.size());
    ASSERT_TRUE(input->read(0, height, 0, 1, back.data()));
    EXPECT_EQ(std::set<float>(back.begin(), back.end()).size(), values.size());
  }
}

TEST_F(SamePixels, Jpeg) {
  for (const int components : {1, 3})
    for (const bool progressive : {false, true})
      for (const int restart : {0, 1}) {
        write_jpeg_sample(folder / "a.jpg", components, progressive, restart);
        expect_same(folder / "a.jpg");
      }
  write_jpeg_sample(folder / "cmyk.jpg", 4, false);
  EXPECT_FALSE(open_jpeg(folder / "cmyk.jpg"));
}

TEST_F(SamePixels, Radiance) {
  for (const int width : {1, 7, 8, 131, 300})
    expect_same(write("a.hdr", {"R", "G", "B"}, OIIO::TypeFloat, {}, width, 9));
}

TEST_F(SamePixels, Pfm) {
  std::mt19937 random(3);
  std::string values(5 * 4 * 3 * sizeof(float), '\0');
  for (std::size_t i = 0; i < values.size(); ++i)
    values[i] = static_cast<char>(i % 4 == 3 ? 0x3e : random() % 64);
  std::string swapped = values;
  for (std::size_t i = 0; i < swapped.size(); i += 4) std::reverse(&swapped[i], &swapped[i] + 4);
  for (const char* scale : {"-1.0", "-2.5"})
    expect_same(folder.write("a.pfm", "PF\n5 4\n" + std::string(scale) + "\n" + values));
  for (const char* scale : {"1", "0.25"})
    expect_same(folder.write("b.pfm", "PF\n5 4\n" + std::string(scale) + "\n" + swapped));
  expect_same(folder.write("c.pfm", "Pf\n15 4\n-1.0\n" + values));
  EXPECT_FALSE(open_pfm(folder.write("d.pfm", "P6\n1 1\n255\nabc")));
}

/// Text and bytes, grey and colour, 8 and 16 bits, largest values that are not powers of two.
TEST_F(SamePixels, Pnm) {
  for (const int largest : {1, 100, 255, 256, 1000, 32767})
    for (const int channels : {1, 3}) {
      std::string text, bytes;
      for (int i = 0; i < 7 * 5 * channels; ++i) {
        const int value = static_cast<int>(int64_t{i} * 7919 % (largest + 1));
        text += std::to_string(value) + (i % 7 == 6 ? "\n" : " ");
        if (largest > 255) bytes += static_cast<char>(value / 256);
        bytes += static_cast<char>(value % 256);
      }
      const std::string head = "\n# made by hand\n7 5\n" + std::to_string(largest) + "\n";
      expect_same(folder.write("a.ppm", (channels == 1 ? "P2" : "P3") + head + text));
      expect_same(folder.write("b.ppm", (channels == 1 ? "P5" : "P6") + head + bytes));
    }
  EXPECT_FALSE(open_pnm(folder.write("c.ppm", "P1\n1 1\n1\n")));
  EXPECT_FALSE(open_pnm(folder.write("d.ppm", "PF\n1 1\n-1\nabcd")));
  for (const char* name : {"tiles.ppm", "holes.pgm"}) {  // of the scenes
    const fs::path own = fs::path(KILOBAND_SOURCE_DIR) / "validation/scenes" / name;
    expect_same(folder.write("e.ppm", read_file(own)));
  }
}

/// OpenImageIO 2.4.7 makes 39594 of 39595 where the largest value is 65535 (32 bits overflow): held against the definition instead.
TEST_F(SamePixels, PnmOfSixteenBitsIsExact) {
  std::string bytes;
  for (int value = 0; value < 65536; ++value)
    bytes += {static_cast<char>(value / 256), static_cast<char>(value % 256)};
  const auto input = open_pnm(folder.write("a.ppm", "P5\n256 256\n65535\n" + bytes));
  std::vector<float> values(65536);
  ASSERT_TRUE(input->read(0, 256, 0, 1, values.data())) << input->error();
  for (int value = 0; value < 65536; ++value)
    ASSERT_EQ(values[static_cast<std::size_t>(value)], static_cast<float>(value) * (1.0f / 65535)) << value;
}

TEST_F(SamePixels, ExrOfAllCompressions) {
  const auto with = [](const char* compression, int tile) {
    return [=](OIIO::ImageSpec& spec) {
      spec["compression"] = compression;
      spec.tile_width = spec.tile_height = tile;
    };
  };
  for (const char* compression :
       {"none", "rle", "zips", "zip", "piz", "pxr24", "b44", "b44a", "dwaa", "dwab"})
    for (const auto& type : {OIIO::TypeHalf, OIIO::TypeFloat})
      for (const int tile : {0, 32})
        expect_same(write("a.exr", {"R", "G", "B", "A"}, type, with(compression, tile)));
}

TEST_F(SamePixels, ExrChannelsAndWindows) {
  for (const auto& names :
       std::vector<std::vector<std::string>>{{"Y"},
                                             {"Y", "A"},
                                             {"R", "G", "B"},
                                             {"depth", "layer.B", "layer.G", "layer.R", "layer.A"},
                                             {"X", "Y", "Z"},
                                             {"B", "G", "M", "Q", "R"},
                                             {"a-b.R", "a-b.G", "a-b.B", "a.R", "a.G", "a.B"}})
    expect_same(write("a.exr", names, OIIO::TypeHalf));
  const auto shift = [](OIIO::ImageSpec& spec) {
    spec.x = -7;
    spec.y = 11;
    spec["openexr:lineOrder"] = "decreasingY";
  };
  expect_same(write("b.exr", kRgb, OIIO::TypeFloat, shift));
}

/// The channels that carry light; what whole numbers are, a reader need not say.
TEST_F(SamePixels, ExrFirstPartWithNumbersOfObjects) {
  write_two_part_exr(folder / "a.exr");
  const auto own = open_exr(folder / "a.exr"), oiio = open_oiio(folder / "a.exr");
  EXPECT_EQ(own->spec().channels, (std::vector<std::string>{"R", "G", "B", "id"}));
  EXPECT_EQ(own->spec().channels, oiio->spec().channels);
  EXPECT_EQ(own->spec().kind, oiio->spec().kind);
  std::vector<float> a(9 * 9 * 3), b(9 * 9 * 3);
  ASSERT_TRUE(own->read(0, 9, 0, 3, a.data())) << own->error();
  ASSERT_TRUE(oiio->read(0, 9, 0, 3, b.data()));
  EXPECT_EQ(std::memcmp(a.data(), b.data(), a.size() * sizeof(float)), 0);
  EXPECT_EQ(a[5], 1.25f);
  EXPECT_FALSE(own->read(0, 9, 3, 1, a.data()));
  EXPECT_EQ(own->error(), "channel id has whole numbers, no light");
}

TEST_F(SamePixels, ExrWithSubsampledChromaIsLeftToOpenImageIO) {
  write_luminance_chroma_exr(folder / "a.exr");
  EXPECT_FALSE(open_exr(folder / "a.exr"));
}

TEST_F(SamePixels, RealFiles) {
  const fs::path root = data_folder();
  if (root.empty()) return;
  std::size_t files = 0;
  for (const auto& entry : fs::recursive_directory_iterator(root)) {
    const std::string extension = entry.path().extension();
    if (extension != ".exr" && extension != ".hdr" && extension != ".png" && extension != ".jpg") continue;
    if (extension == ".hdr" && !is_radiance(entry.path())) continue;  // ENVI has such names, too
    if (const auto own = open_own(entry.path()); !own || own->spec().kind == PictureInput::Kind::kOther)
      continue;
    expect_same(entry.path());
    ++files;
  }
  EXPECT_GT(files, 0u);
}

TEST_F(SamePixels, PngThatIsWritten) {
  std::vector<uint8_t> rgb;
  for (int i = 0; i < 70 * 31 * 3; ++i) rgb.push_back(static_cast<uint8_t>(i * i / 7));
  const fs::path file = folder.write("a.png", png_file(70, 31, rgb.data()));
  expect_same(file);
  std::vector<float> back(rgb.size());
  ASSERT_TRUE(open_oiio(file)->read(0, 31, 0, 3, back.data()));
  for (std::size_t i = 0; i < rgb.size(); ++i)
    ASSERT_EQ(back[i], static_cast<float>(rgb[i]) * (1.0f / 255)) << i;
  EXPECT_THROW(png_file(0, 1, rgb.data()), std::logic_error);
}

}  // namespace
}  // namespace kiloband::test
