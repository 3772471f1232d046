// Sensors, films, filters.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "support.hpp"

namespace kiloband::test::test_sensor_film {
namespace {

Sensor sensor_of(const std::string& sensor, const std::filesystem::path& folder = "/nonexistent") {
  return read(scene(sensor + kLight), folder).sensor;
}

Film film_of(const std::string& film, const std::filesystem::path& folder = "/nonexistent") {
  return sensor_of(R"(<sensor type="perspective">)" + film + "</sensor>", folder).film;
}

double fov_of(int width, int height, const std::string& parameters) {
  const Sensor sensor =
      sensor_of(R"(<sensor type="perspective"><film type="hdrfilm"><integer name="width" value=")" +
                std::to_string(width) + R"("/><integer name="height" value=")" + std::to_string(height) +
                R"("/></film>)" + parameters + "</sensor>");
  return std::get<PerspectiveSensor>(sensor.model).fov_x * 180 / std::numbers::pi;
}

std::string fov(const std::string& axis) {
  return R"(<float name="fov" value="40"/><string name="fov_axis" value=")" + axis + R"("/>)";
}

/// Full angle across x, degrees, for the half-plane's tangent along x.
double angle(double tangent) {
  return 2 * std::atan(tangent) * 180 / std::numbers::pi;
}

TEST(SceneSensor, FieldOfViewAxes) {
  const double t = std::tan(20 * std::numbers::pi / 180);
  EXPECT_NEAR(fov_of(200, 100, fov("x")), 40, 1e-10);
  EXPECT_NEAR(fov_of(200, 100, fov("y")), angle(2 * t), 1e-10);
  EXPECT_NEAR(fov_of(200, 100, fov("smaller")), angle(2 * t), 1e-10);
  EXPECT_NEAR(fov_of(200, 100, fov("larger")), 40, 1e-10);
  EXPECT_NEAR(fov_of(100, 200, fov("smaller")), 40, 1e-10);
  EXPECT_NEAR(fov_of(100, 200, fov("larger")), angle(0.5 * t), 1e-10);
  EXPECT_NEAR(fov_of(200, 100, fov("diagonal")), angle(t * 2 / std::sqrt(5.0)), 1e-10);
}

TEST(SceneSensor, FocalLengthIsOfTheFullFormat) {
  // On a 3:2 film the width is that of the 36 mm x 24 mm format.
  EXPECT_NEAR(fov_of(300, 200, ""), angle(18.0 / 50), 1e-10);
  EXPECT_NEAR(fov_of(300, 200, R"(<string name="focal_length" value="85mm"/>)"), angle(18.0 / 85), 1e-10);
}

TEST(SceneSensor, ThinLensAndOrthographic) {
  const Sensor lens = sensor_of(
      R"(<sensor type="thinlens"><float name="aperture_radius" value="0.1"/><float name="far_clip" value="50"/></sensor>)");
  EXPECT_EQ(std::get<ThinLensSensor>(lens.model).aperture_radius, 0.1);
  EXPECT_EQ(std::get<ThinLensSensor>(lens.model).focus_distance, 50);
  const Sensor ortho = sensor_of(
      R"(<sensor type="orthographic"><transform name="to_world"><scale x="3" y="2"/></transform></sensor>)");
  EXPECT_TRUE(std::holds_alternative<OrthographicSensor>(ortho.model));
  EXPECT_EQ(ortho.to_world[0].x, 3);
  EXPECT_EQ(ortho.sample_count, 4u);
}

TEST(SceneFilm, DefaultsAndCrop) {
  const Film film = film_of("");
  EXPECT_EQ(film.width, 768u);
  EXPECT_EQ(film.height, 576u);
  EXPECT_EQ(film.crop_width, 768u);
  EXPECT_EQ(film.crop_height, 576u);
  EXPECT_EQ(film.filter, FilterType::kGaussian);
  EXPECT_EQ(film.filter_radius, 2);
  EXPECT_TRUE(film.channels.empty());
  const Film crop = film_of(
      R"(<film type="hdrfilm"><integer name="crop_offset_x" value="100"/><integer name="crop_height" value="5"/></film>)");
  EXPECT_EQ(crop.crop_x, 100u);
  EXPECT_EQ(crop.crop_width, 668u);
  EXPECT_EQ(crop.crop_height, 5u);
}

TEST(SceneFilm, SizeFromOptionsReplacesTheFilms) {
  const auto read_sized = [](const std::string& film, uint32_t width, uint32_t height) {
    ReadOptions options;
    options.film_size = {width, height};
    const std::string sensor =
        R"(<sensor type="perspective"><float name="fov" value="40"/>)" + film + "</sensor>";
    return read_scene_text(scene(sensor + kLight), "scene.xml", "/nonexistent", options).sensor;
  };
  for (const char* film : {"", R"(<film type="hdrfilm"><integer name="width" value="9"/></film>)"}) {
    const Film result = read_sized(film, 30, 20).film;
    EXPECT_EQ(result.width, 30u);
    EXPECT_EQ(result.crop_width, 30u);
    EXPECT_EQ(result.height, 20u);
    EXPECT_EQ(result.crop_height, 20u);
  }
  // The angle of view follows the new shape: fov_axis y on a film twice as wide.
  const Sensor wide = read_sized(R"(<string name="fov_axis" value="y"/>)", 200, 100);
  EXPECT_NEAR(std::get<PerspectiveSensor>(wide.model).fov_x,
              2 * std::atan(2 * std::tan(std::numbers::pi / 9)), 1e-12);
  const std::string crop = R"(<film type="hdrfilm"><integer name="crop_width" value="9"/></film>)";
  EXPECT_THROW(read_sized(crop, 30, 20), InputError);
  EXPECT_THROW(read_sized("", 0, 20), InputError);
  EXPECT_THROW(read_sized("", 30, 65536), InputError);
}

TEST(SceneFilm, Filters) {
  EXPECT_EQ(film_of(R"(<film type="hdrfilm"><rfilter type="box"/></film>)").filter, FilterType::kBox);
  EXPECT_EQ(film_of(R"(<film type="hdrfilm"><rfilter type="box"/></film>)").filter_radius, 0.5);
  EXPECT_EQ(film_of(R"(<film type="hdrfilm"><rfilter type="tent"/></film>)").filter_radius, 1);
  const Film gaussian = film_of(
      R"(<film type="specfilm"><spectrum name="a" value="400:1 410:1"/><rfilter type="gaussian"><float name="stddev" value="0.75"/></rfilter></film>)");
  EXPECT_EQ(gaussian.filter_stddev, 0.75);
  EXPECT_EQ(gaussian.filter_radius, 3);
}

TEST(SceneFilm, FiltersWithNegativeLobes) {
  const auto filter = [](const std::string& type, const std::string& inside = "") {
    return film_of(R"(<film type="hdrfilm"><rfilter type=")" + type + "\">" + inside + "</rfilter></film>");
  };
  const Film mitchell = filter("mitchell");
  EXPECT_EQ(mitchell.filter, FilterType::kMitchell);
  EXPECT_EQ(mitchell.filter_radius, 2);
  EXPECT_EQ(mitchell.filter_b, 1.0 / 3);
  EXPECT_EQ(mitchell.filter_c, 1.0 / 3);
  const Film other = filter("mitchell", R"(<float name="B" value="0.2"/><float name="C" value="0.5"/>)");
  EXPECT_EQ(other.filter_b, 0.2);
  EXPECT_EQ(other.filter_c, 0.5);
  const Film spline = filter("catmullrom");
  EXPECT_EQ(spline.filter, FilterType::kMitchell);
  EXPECT_EQ(spline.filter_b, 0);
  EXPECT_EQ(spline.filter_c, 0.5);
  EXPECT_EQ(filter("lanczos").filter, FilterType::kLanczos);
  EXPECT_EQ(filter("lanczos").filter_radius, 3);
  EXPECT_EQ(filter("lanczos", R"(<integer name="lobes" value="2"/>)").filter_radius, 2);
}

TEST(SceneFilm, BandfilmChannels) {
  const Film range = film_of(R"(<film type="bandfilm"><string name="bands" value="8000:12000:4"/></film>)");
  ASSERT_EQ(range.channels.size(), 4u);
  EXPECT_EQ(range.channels[1].min_nm, 9000);
  const TemporaryFolder folder;
  folder.write("bands.csv", "400,410\n405,420\n");
  const Film file =
      film_of(R"(<film type="bandfilm"><string name="bands_file" value="bands.csv"/></film>)", folder.path());
  ASSERT_EQ(file.channels.size(), 2u);
  EXPECT_EQ(file.channels[1].max_nm, 420);
}

TEST(SceneFilm, SpecfilmBoxesAreChannelsAndOthersResponses) {
  const Film film = film_of(R"(<film type="specfilm"><spectrum name="b02" value="500:1, 510:1"/>)"
                            R"(<spectrum name="tri" value="600:0, 606:1, 618:0"/>)"
                            R"(<spectrum name="b01" value="400:1, 410:1"/></film>)");
  ASSERT_EQ(film.responses.size(), 1u);
  EXPECT_EQ(film.responses[0].first, "tri");
  EXPECT_EQ(film.responses[0].second(603), 0.5);
  ASSERT_EQ(film.channels.size(), 2u + 2u + 3u);  // 6 nm in 2 steps, 12 nm in 3
  EXPECT_EQ(film.channels[0].name, "b02");
  EXPECT_EQ(film.channels[0].min_nm, 500);
  EXPECT_EQ(film.channels[1].name, "b01");
  EXPECT_EQ(film.channels[2].name, "");
  EXPECT_DOUBLE_EQ(film.channels[2].min_nm, 600);
  EXPECT_DOUBLE_EQ(film.channels[3].max_nm, 606);
  EXPECT_DOUBLE_EQ(film.channels[6].max_nm, 618);
  for (std::size_t i = 3; i < 7; ++i) EXPECT_EQ(film.channels[i].min_nm, film.channels[i - 1].max_nm);
}

TEST(SceneFilm, GapsBetweenResponsesNeedNoChannels) {
  const Film film = film_of(R"(<film type="specfilm"><spectrum name="a" value="400:0.5, 402:0.5"/>)"
                            R"(<spectrum name="b" value="900:0.5, 903:1"/></film>)");
  ASSERT_EQ(film.channels.size(), 2u);
  EXPECT_EQ(film.channels[0].max_nm, 402);
  EXPECT_EQ(film.channels[1].min_nm, 900);
}

}  // namespace
}  // namespace kiloband::test::test_sensor_film
