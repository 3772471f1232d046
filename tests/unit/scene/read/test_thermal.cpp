// Thermal emitters: what is read, and every way to get them wrong with its exact message.
#include <gtest/gtest.h>

#include "support.hpp"

namespace kiloband::test::test_thermal {
namespace {

const char* const kPly =
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
    "property float kelvin\nproperty float wrong\nelement face 1\nproperty list uchar int vertex_indices\n"
    "end_header\n0 0 0 300 300\n1 0 0 310 -4\n0 1 0 320 5\n3 0 1 2\n";

std::string in_sphere(const std::string& parameters) {
  return scene(R"(<shape type="sphere"><emitter type="thermal">)" + parameters + "</emitter></shape>" +
               kSensor);
}
std::string in_mesh(const std::string& parameters) {
  return scene(R"(<shape type="ply"><string name="filename" value="t.ply"/><emitter type="thermal">)" +
               parameters + "</emitter></shape>" + kSensor);
}
std::string ambient(const std::string& parameters) {
  return scene(R"(<emitter type="thermal">)" + parameters + "</emitter>" + kSensor + kSphere);
}
const char* const kWarm = R"(<float name="temperature" value="310"/>)";

std::string pfm(const std::vector<float>& pixels, int channels = 1) {
  std::string text =
      (channels == 3 ? "PF\n" : "Pf\n") + std::to_string(pixels.size() / channels) + " 1\n-1.0\n";
  text.append(reinterpret_cast<const char*>(pixels.data()), pixels.size() * sizeof(float));
  return text;
}
std::string image(const std::string& file) {
  return R"(<texture type="bitmap" name="temperature"><string name="filename" value=")" + file +
         R"("/></texture>)";
}

TEST(SceneThermal, ConstantTemperature) {
  const SceneDescription result = read(in_sphere(kWarm));
  ASSERT_TRUE(result.shapes.at(0).thermal);
  EXPECT_EQ(result.shapes[0].thermal->temperature_k, 310);
  EXPECT_FALSE(result.shapes[0].emitter);
  EXPECT_FALSE(result.ambient_temperature_k);
  // Without a bsdf it is a black body.
  EXPECT_EQ(std::get<Spectrum>(std::get<DiffuseBsdf>(result.shapes[0].bsdf->model).reflectance)(550), 0);
}

/// 27 degrees Celsius as kelvins shine 6e-27 times as bright.
TEST(SceneThermal, CelsiusIsWarnedOf) {
  const TemporaryFolder folder;
  folder.write("room.pfm", pfm({20, 27}));
  folder.write("warm.pfm", pfm({20, 300}));
  folder.write("dark.pfm", pfm({0, 0}));
  folder.write(
      "a.ply",
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "property float t\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
      "0 0 0 20\n1 0 0 21\n0 1 0 22\n3 0 1 2\n");
  Messages messages;
  for (const char* file : {"room.pfm", "warm.pfm", "dark.pfm"})
    read(in_sphere(image(file)), folder.path(), {}, messages.sink());
  read(scene(R"(<shape type="ply"><string name="filename" value="a.ply"/><emitter type="thermal">)"
             R"(<string name="temperature_attribute" value="t"/></emitter></shape>)" +
             std::string(kSensor)),
       folder.path(), {}, messages.sink());
  EXPECT_EQ(messages.texts, (std::vector<std::string>{
                                "thermal emitter: temperature: 'room.pfm' has no more than 27 K: kelvins are "
                                "meant, not degrees Celsius",
                                "ply shape: temperature_attribute: 't' has no more than 22 K: kelvins are "
                                "meant, not degrees Celsius"}));
}

TEST(SceneThermal, AmbientTemperatureLightsTheScene) {
  const SceneDescription result = read(ambient(kWarm));
  EXPECT_EQ(result.ambient_temperature_k, 310);
  EXPECT_FALSE(result.shapes.at(0).thermal);
  EXPECT_TRUE(result.emitters.empty());
}

/// What a shape refers to is its emitter, not the ambient temperature.
TEST(SceneThermal, SharedEmitterIsNotAmbient) {
  const SceneDescription result =
      read(scene(R"(<emitter type="thermal" id="hot"><float name="temperature" value="900"/></emitter>)"
                 R"(<shape type="sphere"><ref id="hot"/></shape><shape type="cube"><ref id="hot"/></shape>)" +
                 std::string(kSensor)));
  EXPECT_FALSE(result.ambient_temperature_k);
  EXPECT_EQ(result.shapes.at(1).thermal->temperature_k, 900);
}

TEST(SceneThermal, TemperaturesFromImagesAndVertices) {
  const TemporaryFolder folder;
  folder.write("t.pfm", pfm({300, 400}));
  folder.write("t.ply", kPly);
  const SceneDescription with_image = read(in_sphere(image("t.pfm")), folder.path());
  ASSERT_TRUE(with_image.shapes.at(0).thermal->texture);
  EXPECT_EQ(with_image.shapes[0].thermal->texture->image->pixels[1], 400);
  const SceneDescription by_vertex =
      read(in_mesh(R"(<string name="temperature_attribute" value="kelvin"/>)"), folder.path());
  EXPECT_EQ(by_vertex.shapes.at(0).thermal->attribute, "kelvin");
}

TEST(SceneThermal, WrongInput) {
  const TemporaryFolder folder;
  folder.write("t.ply", kPly);
  folder.write("hot.pfm", pfm({300, 123456}));
  folder.write("cold.pfm", pfm({300, -1}));
  folder.write("rgb.pfm", pfm({300, 300, 300}, 3));
  folder.write("part.pgm", "P2\n2 1\n255\n0 255\n");
  expect_messages(
      {
          {"no temperature", in_sphere(""),
           "scene.xml:2:23: error: thermal emitter: parameter 'temperature' is missing"},
          {"negative", in_sphere(R"(<float name="temperature" value="-3"/>)"),
           "scene.xml:2:79: error: thermal emitter: temperature -3: must be from 0 to 100000 K"},
          {"too hot", in_sphere(R"(<float name="temperature" value="100001"/>)"),
           "scene.xml:2:79: error: thermal emitter: temperature 100001: must be from 0 to 100000 K"},
          {"a string", in_sphere(R"(<string name="temperature" value="warm"/>)"),
           "scene.xml:2:80: error: thermal emitter: parameter 'temperature': expected a float, found a "
           "string"},
          {"with a transform",
           in_sphere(std::string(kWarm) + R"(<transform name="to_world"><scale value="2"/></transform>)"),
           "scene.xml:2:86: error: thermal emitter: a thermal emitter has no transform of its own"},
          {"area emitter too",
           scene(R"(<shape type="sphere"><emitter type="area"/><emitter type="thermal"/></shape>)"),
           "scene.xml:2:45: error: sphere shape: a second emitter"},
          {"radiance", in_sphere(std::string(kWarm) + R"(<float name="radiance" value="1"/>)"),
           "scene.xml:2:98: error: thermal emitter: unknown parameter 'radiance'"},
          {"checkerboard", in_sphere(R"(<texture type="checkerboard" name="temperature"/>)"),
           "scene.xml:2:61: error: thermal emitter: temperature: expected a float or a bitmap, found a "
           "texture"},
          {"hot image", in_sphere(image("hot.pfm")),
           "scene.xml:2:61: error: thermal emitter: temperature 123456 at pixel (1, 0) of 'hot.pfm': must be "
           "from 0 to "
           "100000 K"},
          {"slightly negative image", in_sphere(image("cold.pfm")),
           "scene.xml:2:61: error: thermal emitter: temperature -1 in 'cold.pfm': must be from 0 to 100000 K"},
          {"fractions", in_sphere(image("part.pgm")),
           "scene.xml:2:61: error: thermal emitter: temperature: 'part.pgm' has no more than 1 K: images of "
           "integers hold fractions of 1, not kelvins: EXR and PFM do"},
          {"coloured image", in_sphere(image("rgb.pfm")),
           "scene.xml:2:61: error: thermal emitter: temperature: an image of temperatures has one channel, "
           "'rgb.pfm' "
           "has 3"},
          {"attribute of a sphere", in_sphere(R"(<string name="temperature_attribute" value="kelvin"/>)"),
           "scene.xml:2:23: error: sphere shape: temperature_attribute 'kelvin': only meshes have vertex "
           "properties"},
          {"missing attribute", in_mesh(R"(<string name="temperature_attribute" value="celsius"/>)"),
           "scene.xml:2:59: error: ply shape: temperature_attribute: the mesh has no vertex property "
           "'celsius' (it has "
           "'kelvin', 'wrong')"},
          {"negative vertex", in_mesh(R"(<string name="temperature_attribute" value="wrong"/>)"),
           "scene.xml:2:59: error: ply shape: temperature_attribute: wrong -4 of vertex 1: must be from 0 to "
           "100000 K"},
          {"both", in_mesh(std::string(kWarm) + R"(<string name="temperature_attribute" value="kelvin"/>)"),
           "scene.xml:2:165: error: thermal emitter: 'temperature_attribute' together with 'temperature'"},
          {"empty name", in_mesh(R"(<string name="temperature_attribute" value=""/>)"),
           "scene.xml:2:126: error: thermal emitter: temperature_attribute: the name is empty"},
          {"ambient field", ambient(R"(<string name="temperature_attribute" value="kelvin"/>)"),
           "scene.xml:2:69: error: thermal emitter: the ambient temperature is one number"},
          {"ambient image", ambient(image("hot.pfm")),
           "scene.xml:2:40: error: thermal emitter: the ambient temperature is one number"},
          {"two ambient temperatures",
           scene(R"(<emitter type="thermal"><float name="temperature" value="3"/></emitter>
<emitter type="thermal"><float name="temperature" value="4"/></emitter>)" +
                 std::string(kSensor) + kSphere),
           "scene.xml:3:2: error: scene: a second ambient temperature"},
      },
      folder);
}

}  // namespace
}  // namespace kiloband::test::test_thermal
