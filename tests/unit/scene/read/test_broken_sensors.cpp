// Broken scenes with the exact message and position: sensors, films, samplers, integrators.
#include <gtest/gtest.h>

#include "support.hpp"

namespace kiloband::test::test_broken_sensors {
namespace {

/// Scenes begin in line 2: see scene() and complete_scene().
std::vector<BrokenScene> table() {
  return {
      {"unknown sensor", scene(R"xml(<sensor type="perspektive"/>)xml"),
       "scene.xml:2:15: error: sensor type 'perspektive' is not supported; did you mean 'perspective'?"},
      {"camera that scales",
       scene(
           R"xml(<sensor type="perspective"><transform name="to_world"><scale value="2"/></transform></sensor>)xml"),
       "scene.xml:2:29: error: perspective sensor: to_world scales by 2: a camera's transform must not "
       "scale"},
      {"field of view 180",
       scene(R"xml(<sensor type="perspective"><float name="fov" value="180"/></sensor>)xml"),
       "scene.xml:2:53: error: perspective sensor: fov 180: must be between 0 and 180 degrees"},
      {"field of view and focal length",
       scene(
           R"xml(<sensor type="perspective"><float name="fov" value="18"/><string name="focal_length" value="50mm"/></sensor>)xml"),
       "scene.xml:2:93: error: perspective sensor: 'focal_length' together with 'fov'"},
      {"focal length without unit",
       scene(R"xml(<sensor type="perspective"><string name="focal_length" value="50"/></sensor>)xml"),
       "scene.xml:2:63: error: perspective sensor: focal_length '50': must be a length such as 50mm"},
      {"clipping planes reversed",
       scene(R"xml(<sensor type="perspective"><float name="far_clip" value="0.001"/></sensor>)xml"),
       "scene.xml:2:58: error: perspective sensor: far_clip 0.001: must be larger than near_clip"},
      {"lens without aperture", scene(R"xml(<sensor type="thinlens"/>)xml"),
       "scene.xml:2:2: error: thinlens sensor: parameter 'aperture_radius' is missing"},
      {"unknown film", scene(R"xml(<sensor type="perspective"><film type="ldrfilm"/></sensor>)xml"),
       "scene.xml:2:40: error: film type 'ldrfilm' is not supported: it is read in files of versions below 2; use hdrfilm, --preview writes PNG"},
      {"film of width 0",
       scene(
           R"xml(<sensor type="perspective"><film type="hdrfilm"><integer name="width" value="0"/></film></sensor>)xml"),
       "scene.xml:2:78: error: hdrfilm film: width 0: must be from 1 to 65535"},
      {"huge film",
       scene(
           R"xml(<sensor type="perspective"><film type="hdrfilm"><integer name="height" value="65536"/></film></sensor>)xml"),
       "scene.xml:2:79: error: hdrfilm film: height 65536: must be from 1 to 65535"},
      {"crop window outside",
       scene(
           R"xml(<sensor type="perspective"><film type="hdrfilm"><integer name="crop_offset_x" value="700"/><integer name="crop_width" value="100"/></film></sensor>)xml"),
       "scene.xml:2:126: error: hdrfilm film: crop_width 100: must be from 1 to 68"},
      {"unknown filter",
       scene(
           R"xml(<sensor type="perspective"><film type="hdrfilm"><rfilter type="sinc"/></film></sensor>)xml"),
       "scene.xml:2:64: error: rfilter type 'sinc' is not supported"},
      {"unknown pixel format",
       scene(
           R"xml(<sensor type="perspective"><film type="hdrfilm"><string name="pixel_format" value="cmyk"/></film></sensor>)xml"),
       "scene.xml:2:84: error: hdrfilm film: pixel_format 'cmyk': must be one of rgb, luminance, "
       "luminance_alpha, rgba, xyz, xyza"},
      {"bands reversed",
       scene(
           R"xml(<sensor type="perspective"><film type="bandfilm"><string name="bands" value="780:380:4"/></film></sensor>)xml"),
       "scene.xml:2:78: error: bands '780:380:4': the interval is reversed: 780 nm is above 380 nm"},
      {"no band",
       scene(
           R"xml(<sensor type="perspective"><film type="bandfilm"><string name="bands" value="380:780:0"/></film></sensor>)xml"),
       "scene.xml:2:78: error: bands '380:780:0': count '0': must be a whole number from 1"},
      {"interval of a list reversed",
       scene(
           R"xml(<sensor type="perspective"><film type="bandfilm"><string name="bands" value="400-500, 600-550"/></film></sensor>)xml"),
       "scene.xml:2:78: error: bands '400-500, 600-550': '600-550': the interval is reversed: 600 nm is above 550 nm"},
      {"file of bands reversed",
       scene(
           R"xml(<sensor type="perspective"><film type="bandfilm"><string name="bands_file" value="reversed.csv"/></film></sensor>)xml"),
       "scene.xml:2:83: error: reversed.csv:3: the interval is reversed: 500 nm is above 450 nm"},
      {"bandfilm without bands",
       scene(R"xml(<sensor type="perspective"><film type="bandfilm"/></sensor>)xml"),
       "scene.xml:2:29: error: bandfilm film: needs either 'bands' or 'bands_file'"},
      {"specfilm without bands",
       scene(R"xml(<sensor type="perspective"><film type="specfilm"/></sensor>)xml"),
       "scene.xml:2:29: error: specfilm film: needs at least one spectrum"},
      {"specfilm band without range",
       scene(
           R"xml(<sensor type="perspective"><film type="specfilm"><spectrum name="a" value="1"/></film></sensor>)xml"),
       "scene.xml:2:76: error: specfilm film: band 'a': needs a tabulated spectrum with a first and a last "
       "wavelength"},
      {"specfilm band below 0",
       scene(
           R"xml(<sensor type="perspective"><film type="specfilm"><spectrum name="a" value="400:1 500:-1"/></film></sensor>)xml"),
       "scene.xml:2:76: error: specfilm film: band 'a' -1 at 500 nm: must be >= 0"},
      {"no samples",
       scene(
           R"xml(<sensor type="perspective"><sampler type="independent"><integer name="sample_count" value="0"/></sampler></sensor>)xml"),
       "scene.xml:2:92: error: independent sampler: sample_count 0: must be >= 1"},
      {"max_depth below -1",
       complete_scene(R"xml(<integrator type="path"><integer name="max_depth" value="-2"/></integrator>)xml"),
       "scene.xml:2:58: error: path integrator: max_depth -2: must be >= 0, or -1 for no limit"},
      {"rr_depth 0",
       complete_scene(R"xml(<integrator type="path"><integer name="rr_depth" value="0"/></integrator>)xml"),
       "scene.xml:2:57: error: path integrator: rr_depth 0: must be >= 1"},
      {"direct without samples",
       complete_scene(
           R"xml(<integrator type="direct"><integer name="emitter_samples" value="0"/><integer name="bsdf_samples" value="0"/></integrator>)xml"),
       "scene.xml:2:66: error: direct integrator: emitter_samples and bsdf_samples are both 0"},
      {"unknown integrator", complete_scene(R"xml(<integrator type="bdpt"/>)xml"),
       "scene.xml:2:19: error: integrator type 'bdpt' is not supported: 'path' gives the same image"},
  };
}

TEST(BrokenScenes, Sensors) {
  const TemporaryFolder folder;
  folder.write("reversed.csv", "min_nm,max_nm\n400,450\n500,450\n");
  expect_messages(table(), folder);
}

}  // namespace
}  // namespace kiloband::test::test_broken_sensors
