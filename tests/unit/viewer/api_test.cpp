// The answers to requests, for a small stored cube.
#include <gtest/gtest.h>

#include <atomic>
#include <fstream>
#include <thread>
#include <vector>

#include "tests/support/temporary_folder.hpp"
#include "tests/unit/viewer/test_requests.hpp"
#include "tests/unit/viewer/viewed_cube.hpp"
#include "viewer/api/json_text.hpp"

namespace kiloband::test {
namespace {

using namespace viewer;
using nlohmann::json;

json body_of(const Response& response) {
  return json::parse(response.body);
}

class ApiOfACube : public testing::Test {
 protected:
  Response get(const std::string& path, std::map<std::string, std::string> query = {}) {
    return cube_.api().answer(get_request(path, std::move(query)), [] { return true; });
  }
  Response post(const std::string& path, const std::string& body) {
    return cube_.api().answer(post_request(path, body), [] { return true; });
  }
  std::string error(const Response& response) {
    EXPECT_EQ(response.status, 400);
    return body_of(response)["error"];
  }

  ViewedCube cube_;
};

TEST_F(ApiOfACube, SceneSaysWhatThereIs) {
  const json scene = body_of(get("/api/scene"));
  EXPECT_EQ(scene["kind"], "cube");
  EXPECT_EQ(scene["width"], 3);
  EXPECT_EQ(scene["height"], 2);
  EXPECT_EQ(scene["channels"].size(), 2u);
  EXPECT_EQ(scene["errors"], true);
  EXPECT_EQ(scene["modes"], json({"color", "false", "channel", "error"}));
  EXPECT_EQ(scene["choices"]["output"], true);
  EXPECT_TRUE(scene["camera"].is_null());
}

/// The cube's integrals are 10 (x + 3 y) + k + 1 over channels of 10 and 20 nm, its variances 4.
TEST_F(ApiOfACube, SpectraAreDensitiesWithErrors) {
  const json answer = body_of(get("/api/spectra", {{"select", "1,1;0,0,1,0"}}));
  EXPECT_EQ(answer["curves"][0]["mean"], json({4.1, 2.1}));
  EXPECT_EQ(answer["curves"][0]["standard_error"], json({0.2, 0.1}));
  EXPECT_EQ(answer["curves"][1]["pixels"], 2);
  EXPECT_EQ(answer["curves"][1]["mean"], json({0.6, 0.35}));
  EXPECT_EQ(answer["curves"][1]["standard_error"], nullptr) << "nobody knows what the pixels share";
}

TEST_F(ApiOfACube, SpectraAsCsv) {
  EXPECT_EQ(get("/api/export.csv", {{"select", "1,1"}}).body,
            "min_nm,max_nm,mean_1_1,standard_error_1_1\n500,510,4.1,0.2\n600,620,2.1,0.1\n");
}

TEST_F(ApiOfACube, ValuesAreThoseOfTheMode) {
  const json answer = body_of(
      get("/api/values",
          {{"mode", "channel"}, {"channel", "1"}, {"x0", "1"}, {"y0", "0"}, {"x1", "2"}, {"y1", "1"}}));
  EXPECT_EQ(answer["values"], json({0.6, 1.1, 2.1, 2.6}));
  EXPECT_EQ(answer["components"], 1);
}

TEST_F(ApiOfACube, PlacesOutsideTheImageAreRefused) {
  EXPECT_EQ(error(get("/api/spectra", {{"select", "3,0"}})), "select: '3,0': the image has 3 x 2 pixels");
  EXPECT_EQ(error(get("/api/spectra", {{"select", "-1,0"}})),
            "select: '-1,0': must be X,Y or X0,Y0,X1,Y1 with whole numbers from 0");
  EXPECT_EQ(error(get("/api/spectra", {{"select", "4294967296,0"}})),
            "select: '4294967296,0': must be X,Y or X0,Y0,X1,Y1 with whole numbers from 0");
  EXPECT_EQ(error(get("/api/spectra", {{"select", "2,1,1,1"}})), "select: '2,1,1,1': ends before it begins");
  EXPECT_EQ(error(get("/api/spectra")), "select: '': must be X,Y or X0,Y0,X1,Y1 with whole numbers from 0");
  std::string many = "0,0";
  for (int i = 0; i < 16; ++i) many += ";0,0";
  EXPECT_EQ(error(get("/api/spectra", {{"select", many}})), "select: 17 places: at most 16");
  EXPECT_EQ(error(get("/api/frame", {{"mode", "channel"}, {"low", "-1e300"}})),
            "low=-1e+300: must be within 3.40282e+38");
  EXPECT_EQ(error(get("/api/frame", {{"mode", "channel"}, {"channel", "2"}})),
            "channel=2: the image has 2 channels");
}

TEST_F(ApiOfACube, FramesOfEveryMode) {
  for (const char* mode : {"color", "channel", "error"}) {
    const Response jpeg = get("/api/frame", {{"mode", mode}});
    EXPECT_EQ(jpeg.status, 200) << mode;
    EXPECT_EQ(jpeg.type, "image/jpeg");
    const Response png = get("/api/frame", {{"mode", mode}, {"quality", "exact"}});
    EXPECT_EQ(png.type, "image/png");
    EXPECT_EQ(png.body.substr(1, 3), "PNG");
    EXPECT_EQ(png.headers[0].first, "X-Kiloband-Frame");
    EXPECT_EQ(json::parse(png.headers[0].second)["full_width"], 3);
  }
  EXPECT_EQ(get("/api/frame", {{"after", "1"}}).status, 204) << "the client has gone";
  EXPECT_EQ(
      error(get("/api/frame", {{"mode", "false"}, {"r", "610-620"}, {"g", "500-505"}, {"b", "300-400"}})),
      "the range 300-400 nm overlaps no channel");
  EXPECT_EQ(error(get("/api/frame", {{"mode", "temperature"}, {"channel", "x"}})),
            "channel='x': must be a whole number from 0");
  EXPECT_EQ(error(get("/api/frame", {{"mode", "rainbow"}})),
            "mode='rainbow': must be color, false, channel, error, temperature");
}

/// A bound that is given stays, on whichever side of the automatic other one. Values: 0.1 to 5.1.
TEST_F(ApiOfACube, GivenBoundsAreUsed) {
  const auto facts = [&](std::map<std::string, std::string> query) {
    query["mode"] = "channel";
    return json::parse(get("/api/frame", std::move(query)).headers[0].second);
  };
  EXPECT_EQ(facts({{"high", "0.0625"}})["high"], 0.0625);
  EXPECT_EQ(facts({{"high", "0.0625"}})["low"], 0);
  EXPECT_EQ(facts({{"high", "-2"}})["low"], -4);
  EXPECT_EQ(facts({{"low", "8"}})["low"], 8);
  EXPECT_EQ(facts({{"low", "8"}})["high"], 16);
  EXPECT_EQ(facts({{"low", "8"}, {"scale", "log"}})["high"], 80);
  EXPECT_EQ(facts({{"high", "0.0625"}, {"scale", "log"}})["low"], 0.00625f);
  EXPECT_EQ(facts({{"low", "3"}, {"high", "2"}})["low"], 3);
}

TEST_F(ApiOfACube, ResponsesBecomeModes) {
  Request upload = post_request("/api/response", "wavelength_nm,red,green\n400,1,0\n700,1,2\n");
  upload.query["name"] = "camera";
  const uint64_t before = cube_.api().scene_number();
  ASSERT_EQ(cube_.api().answer(upload, [] { return true; }).status, 200);
  EXPECT_GT(cube_.api().scene_number(), before);
  EXPECT_EQ(body_of(get("/api/scene"))["modes"][1], "response:camera");
  const json answer = body_of(
      get("/api/values", {{"mode", "response:camera"}, {"x0", "0"}, {"y0", "0"}, {"x1", "0"}, {"y1", "0"}}));
  EXPECT_EQ(answer["values"][0], 3) << "a response of 1: 1 + 2";
  EXPECT_NEAR(answer["values"][1].get<double>(), 1 * 2 * 105 / 300.0 + 2 * 2 * 210 / 300.0, 1e-5);
  upload.query["name"] = "../camera";
  EXPECT_EQ(cube_.api().answer(upload, [] { return true; }).status, 400);
  upload.query["name"] = "words";
  upload.body = "no numbers";
  const Response refused = cube_.api().answer(upload, [] { return true; });
  EXPECT_TRUE(error(refused).starts_with("words.csv")) << refused.body;
}

TEST_F(ApiOfACube, SavesOnlyUnderPlainNewNames) {
  EXPECT_EQ(body_of(post("/api/save", R"({"format": "envi", "name": "copy"})"))["files"],
            json({"copy.hdr", "copy.img", "copy.var.hdr", "copy.var.img"}));
  EXPECT_EQ(body_of(post("/api/save",
                         R"({"format": "png", "name": "copy", "mode": "channel", "channel": 1})"))["files"],
            json({"copy.png"}));
  const auto saved = open_cube(cube_.output() / "copy.hdr");
  std::vector<float> mean(6 * 2), variance(6 * 2);
  saved->read_rows(0, 2, mean, variance);
  EXPECT_EQ(mean, cube_.values());
  EXPECT_EQ(variance, std::vector<float>(12, 4.0f));
  EXPECT_EQ(saved->info().replicates, 5u) << "or errors would seem to be known exactly";
  EXPECT_EQ(error(post("/api/save", R"({"format": "envi", "name": "copy"})")),
            "'copy.hdr' is there already: choose another name");
  for (const char* name : {"../x", "/etc/x", "a/b", ".hidden", "", "a\\u0000b", "x\\n", "-x"}) {
    const Response refused = post("/api/save", std::string(R"({"format": "exr", "name": ")") + name + "\"}");
    EXPECT_TRUE(error(refused).starts_with("the file's name")) << name;
  }
  EXPECT_EQ(error(post("/api/save", R"({"format": "gif", "name": "x"})")),
            "format: must be exr, envi or png");
}

/// Whoever asks first has the name; nothing that was written is replaced.
TEST_F(ApiOfACube, ANameIsSavedOnce) {
  for (const std::string format : {"envi", "exr", "png"}) {
    std::atomic<int> saved{0}, refused{0};
    std::vector<std::thread> threads;
    for (int i = 0; i < 8; ++i)
      threads.emplace_back([&] {
        const Response answer =
            post("/api/save", R"({"name": "race", "mode": "channel", "format": ")" + format + "\"}");
        (answer.status == 200 ? saved : refused) += 1;
      });
    for (std::thread& thread : threads) thread.join();
    EXPECT_EQ(saved, 1) << format;
    EXPECT_EQ(refused, 7) << format;
  }
}

TEST_F(ApiOfACube, BadJsonIsRefused) {
  for (const char* body : {"", "{", "[]", "1", "{\"a\":}", "\xff", "nul"})
    EXPECT_EQ(error(post("/api/save", body)), "the body must be a JSON object") << body;
  EXPECT_EQ(error(post("/api/save", "{\"a\":" + std::string(20, '[') + std::string(20, ']') + "}")),
            "JSON: more than 16 levels");
  EXPECT_EQ(error(post("/api/save", R"({"nome": 1})")), "unknown member 'nome'");
  EXPECT_EQ(error(post("/api/save", R"({"name": 1, "format": "exr"})")), "'name': must be a text");
  EXPECT_EQ(error(post("/api/camera", R"({"reset": true})")),
            "a stored cube is not rendered: it has no camera, settings or materials");
}

TEST_F(ApiOfACube, WhatIsNotThereIsNotFound) {
  for (const char* path : {"/nothing", "/../etc/passwd", "/api/nothing", "/api/"})
    EXPECT_EQ(get(path).status, 404) << path;
  EXPECT_EQ(post("/api/nothing", "{}").status, 404);
  EXPECT_EQ(post("/", "{}").status, 404);
  EXPECT_EQ(get("/").type, "text/html; charset=utf-8");
  EXPECT_EQ(get("/dygraph.min.js").type, "text/javascript; charset=utf-8");
}

TEST_F(ApiOfACube, EveryAnswerHasThePolicies) {
  for (const Response& response : {get("/"), get("/nothing"), get("/api/scene")}) {
    const std::map<std::string, std::string> headers(response.headers.begin(), response.headers.end());
    EXPECT_EQ(headers.at("X-Content-Type-Options"), "nosniff");
    EXPECT_TRUE(headers.at("Content-Security-Policy").starts_with("default-src 'self';"));
  }
}

}  // namespace
}  // namespace kiloband::test
