// Broken scenes with the exact message and position: spectra, bsdfs, shapes, emitters, the whole scene.
#include <gtest/gtest.h>

#include "support.hpp"
#include "tests/support/picture_files.hpp"

namespace kiloband::test::test_broken_entities {
namespace {

/// Scenes begin in line 2: see scene() and complete_scene().
std::vector<BrokenScene> table() {
  return {
      {"no sensor", scene(R"xml(<shape type="sphere"><emitter type="area"/></shape>)xml"),
       "scene.xml:1:2: error: scene: has no sensor"},
      {"a second sensor that is wrong",
       complete_scene(R"xml(<sensor type="perspective"/><sensor type="thinlens"/>)xml"),
       "scene.xml:2:30: error: thinlens sensor: parameter 'aperture_radius' is missing"},
      {"no emitter", scene(R"xml(<sensor type="perspective"/><shape type="sphere"/>)xml"),
       "scene.xml:1:2: error: scene: has no emitter"},
      {"nothing to see", scene(R"xml(<sensor type="perspective"/><emitter type="point"/>)xml"),
       "scene.xml:1:2: error: scene: has neither a shape nor an environment"},
      {"two environments", complete_scene(R"xml(<emitter type="constant"/>)xml"),
       "scene.xml:3:30: error: constant emitter: a second environment: only one is allowed"},
      {"two integrators", complete_scene(R"xml(<integrator type="path"/><integrator type="path"/>)xml"),
       "scene.xml:2:27: error: scene: a second integrator"},
      {"film without sensor", complete_scene(R"xml(<film type="hdrfilm" id="f"/>)xml"),
       "scene.xml:2:2: error: film 'f': is not part of any other object"},
      {"medium", complete_scene(R"xml(<medium type="homogeneous"/>)xml"),
       "scene.xml:2:2: error: homogeneous medium: albedo: nothing scatters in a volume here: must be 0"},
      {"medium in a shape",
       complete_scene(R"xml(<shape type="sphere"><medium type="homogeneous" name="interior"/></shape>)xml"),
       "scene.xml:2:23: error: homogeneous medium: albedo: nothing scatters in a volume here: must be 0"},
      {"unknown bsdf", complete_scene(R"xml(<bsdf type="difuse"/>)xml"),
       "scene.xml:2:13: error: bsdf type 'difuse' is not supported; did you mean 'diffuse'?"},
      {"unsupported bsdf", complete_scene(R"xml(<bsdf type="measured"/>)xml"),
       "scene.xml:2:13: error: bsdf type 'measured' is not supported: there is no such model; 'roughconductor' and "
       "'principled' have parameters to be fitted"},
      {"reflectance above 1",
       complete_scene(
           R"xml(<bsdf type="diffuse" id="leaf"><spectrum name="reflectance" value="500:0.9, 550:1.27"/></bsdf>)xml"),
       "scene.xml:2:68: error: bsdf 'leaf': reflectance 1.27 at 550 nm: must be in [0, 1]"},
      {"negative reflectance",
       complete_scene(
           R"xml(<bsdf type="diffuse" id="leaf"><float name="reflectance" value="-0.1"/></bsdf>)xml"),
       "scene.xml:2:65: error: bsdf 'leaf': reflectance -0.1: must be in [0, 1]"},
      {"colour above 1",
       complete_scene(
           R"xml(<bsdf type="plastic"><rgb name="diffuse_reflectance" value="0.1, 1.5, 0"/></bsdf>)xml"),
       "scene.xml:2:61: error: plastic bsdf: diffuse_reflectance rgb component 1.5: must be in [0, 1]"},
      {"colour with two components",
       complete_scene(
           R"xml(<bsdf type="plastic"><rgb name="diffuse_reflectance" value="0.1, 0.5"/></bsdf>)xml"),
       "scene.xml:2:61: error: plastic bsdf: diffuse_reflectance: expected 1 or 3 numbers, found 2"},
      {"negative radiance",
       scene(R"xml(<emitter type="constant"><spectrum name="radiance" value="400:1 500:-2"/></emitter>)xml"),
       "scene.xml:2:59: error: constant emitter: radiance -2 at 500 nm: must be >= 0"},
      {"wavelengths out of order",
       complete_scene(
           R"xml(<bsdf type="diffuse"><spectrum name="reflectance" value="500:0.1, 400:0.2"/></bsdf>)xml"),
       "scene.xml:2:58: error: diffuse bsdf: reflectance: wavelength 400 nm after 500 nm: must increase "
       "strictly"},
      {"wavelength repeated",
       complete_scene(
           R"xml(<bsdf type="diffuse"><spectrum name="reflectance" value="500:0.5, 500:0.6"/></bsdf>)xml"),
       "scene.xml:2:58: error: diffuse bsdf: reflectance: wavelength 500 nm after 500 nm: must increase strictly"},
      {"blank after the colon",
       complete_scene(R"xml(<bsdf type="diffuse"><spectrum name="reflectance" value="500: 0.1"/></bsdf>)xml"),
       "scene.xml:2:58: error: diffuse bsdf: reflectance: '500:' is not a pair wavelength:value (no blanks "
       "around ':')"},
      {"one pair",
       complete_scene(R"xml(<bsdf type="diffuse"><spectrum name="reflectance" value="500:0.1"/></bsdf>)xml"),
       "scene.xml:2:58: error: diffuse bsdf: reflectance: a spectrum needs at least 2 pairs "
       "wavelength:value"},
      {"wavelength zero",
       complete_scene(
           R"xml(<bsdf type="diffuse"><spectrum name="reflectance" value="0:0.1 400:0.2"/></bsdf>)xml"),
       "scene.xml:2:58: error: diffuse bsdf: reflectance: wavelength 0 nm: must be > 0"},
      {"missing spectrum file",
       complete_scene(
           R"xml(<bsdf type="diffuse"><spectrum name="reflectance" filename="none.spd"/></bsdf>)xml"),
       "scene.xml:2:61: error: file 'none.spd' not found"},
      {"spectrum file with a word",
       complete_scene(
           R"xml(<bsdf type="diffuse"><spectrum name="reflectance" filename="word.spd"/></bsdf>)xml"),
       "scene.xml:2:61: error: word.spd:2: 'high' is not a number"},
      {"spectrum file above 1",
       complete_scene(
           R"xml(<bsdf type="diffuse"><spectrum name="reflectance" filename="bright.spd"/></bsdf>)xml"),
       "scene.xml:2:61: error: diffuse bsdf: reflectance 1.2 at 500 nm: must be in [0, 1]"},
      {"irregular lists of different lengths",
       complete_scene(
           R"xml(<bsdf type="diffuse"><spectrum type="irregular" name="reflectance"><string name="wavelengths" value="1 2 3"/><string name="values" value="0 0"/></spectrum></bsdf>)xml"),
       "scene.xml:2:139: error: irregular spectrum: 2 values for 3 wavelengths"},
      {"irregular wavelengths out of order",
       complete_scene(
           R"xml(<bsdf type="diffuse"><spectrum type="irregular" name="reflectance"><string name="wavelengths" value="400 400"/><string name="values" value="0 0"/></spectrum></bsdf>)xml"),
       "scene.xml:2:102: error: irregular spectrum: wavelengths 400: must increase strictly"},
      {"regular range reversed",
       complete_scene(
           R"xml(<bsdf type="diffuse"><spectrum type="regular" name="reflectance"><float name="wavelength_min" value="500"/><float name="wavelength_max" value="400"/><string name="values" value="0 0"/></spectrum></bsdf>)xml"),
       "scene.xml:2:144: error: regular spectrum: wavelength_max 400: must be larger than wavelength_min"},
      {"blackbody as a reflectance",
       complete_scene(
           R"xml(<bsdf type="diffuse"><spectrum type="blackbody" name="reflectance"><float name="temperature" value="300"/></spectrum></bsdf>)xml"),
       "scene.xml:2:38: error: blackbody spectrum describes emission: not allowed as a reflectance"},
      {"negative temperature",
       scene(
           R"xml(<emitter type="constant"><spectrum type="planck" name="radiance"><float name="temperature" value="-1"/></spectrum></emitter>)xml"),
       "scene.xml:2:99: error: planck spectrum: temperature -1: must be >= 0 K"},
      {"unknown spectrum",
       complete_scene(R"xml(<bsdf type="diffuse"><spectrum type="regularr" name="reflectance"/></bsdf>)xml"),
       "scene.xml:2:38: error: spectrum type 'regularr' is not supported; did you mean 'regular'?"},
      {"string as a reflectance",
       complete_scene(R"xml(<bsdf type="diffuse"><string name="reflectance" value="red"/></bsdf>)xml"),
       "scene.xml:2:56: error: diffuse bsdf: reflectance: expected a spectrum, found a string"},
      {"missing bitmap",
       complete_scene(R"xml(<texture type="bitmap"><string name="filename" value="none.png"/></texture>)xml"),
       "scene.xml:2:55: error: file 'none.png' not found"},
      {"bitmap without a file", complete_scene(R"xml(<texture type="bitmap"/>)xml"),
       "scene.xml:2:2: error: bitmap texture: parameter 'filename' is missing"},
      {"unknown wrap mode",
       complete_scene(
           R"xml(<texture type="bitmap"><string name="filename" value="a.obj"/><string name="wrap_mode" value="once"/></texture>)xml"),
       "scene.xml:2:55: error: a.obj: not an image of a known format (EXR, HDR, PNG, JPEG, TIFF, BMP, PNM, PFM, TGA)\n"
       "scene.xml:2:95: error: bitmap texture: wrap_mode 'once': must be one of repeat, mirror, clamp"},
      {"texture where a spectrum is needed",
       scene(R"xml(<emitter type="constant"><texture type="checkerboard" name="radiance"/></emitter>)xml"),
       "scene.xml:2:41: error: constant emitter: radiance: a texture is not supported here"},
      {"alpha 0", complete_scene(R"xml(<bsdf type="roughplastic"><float name="alpha" value="0"/></bsdf>)xml"),
       "scene.xml:2:54: error: roughplastic bsdf: alpha 0: must be > 0"},
      {"alpha above 100 in an image",
       complete_scene(
           R"xml(<bsdf type="roughconductor"><texture name="alpha_u" type="bitmap"><string name="filename" value="large.pfm"/></texture><float name="alpha_v" value="0.1"/></bsdf>)xml"),
       "scene.xml:2:59: error: roughconductor bsdf: alpha_u: a value of 'large.pfm' is 101: must be from 0 to 100"},
      {"alpha of plastic in an image",
       complete_scene(
           R"xml(<bsdf type="roughplastic"><texture name="alpha" type="checkerboard"/></bsdf>)xml"),
       "scene.xml:2:55: error: roughplastic bsdf: parameter 'alpha': expected a float, found a texture"},
      {"alpha and alpha_u",
       complete_scene(
           R"xml(<bsdf type="roughconductor"><float name="alpha" value="0.1"/><float name="alpha_u" value="0.1"/></bsdf>)xml"),
       "scene.xml:2:56: error: roughconductor bsdf: 'alpha' together with 'alpha_u' or 'alpha_v'"},
      {"alpha_u without alpha_v",
       complete_scene(R"xml(<bsdf type="roughconductor"><float name="alpha_u" value="0.1"/></bsdf>)xml"),
       "scene.xml:2:2: error: roughconductor bsdf: parameter 'alpha_v' is missing"},
      {"unknown distribution",
       complete_scene(
           R"xml(<bsdf type="roughconductor"><string name="distribution" value="phong"/></bsdf>)xml"),
       "scene.xml:2:64: error: roughconductor bsdf: distribution 'phong': must be one of beckmann, ggx"},
      {"integer index of refraction",
       complete_scene(R"xml(<bsdf type="dielectric"><integer name="int_ior" value="2"/></bsdf>)xml"),
       "scene.xml:2:56: error: dielectric bsdf: parameter 'int_ior': expected a float or a material name, "
       "found an integer"},
      {"index of refraction 0",
       complete_scene(R"xml(<bsdf type="dielectric"><float name="int_ior" value="0"/></bsdf>)xml"),
       "scene.xml:2:54: error: dielectric bsdf: int_ior 0: must be > 0"},
      {"unknown material",
       complete_scene(R"xml(<bsdf type="dielectric"><string name="int_ior" value="watter"/></bsdf>)xml"),
       "scene.xml:2:55: error: dielectric bsdf: int_ior: unknown material 'watter'; did you mean 'water'?"},
      {"glass with a similar name",
       complete_scene(R"xml(<bsdf type="dielectric"><string name="int_material" value="NBK7"/></bsdf>)xml"),
       "scene.xml:2:60: error: dielectric bsdf: int_material: 'NBK7' is neither a built-in transparent "
       "material nor a file; did you mean 'N-BK7'?"},
      {"metal as glass",
       complete_scene(R"xml(<bsdf type="dielectric"><string name="ext_material" value="Au"/></bsdf>)xml"),
       "scene.xml:2:60: error: dielectric bsdf: ext_material: 'Au' is a metal, not transparent"},
      {"glass file that is missing",
       complete_scene(R"xml(<bsdf type="dielectric"><string name="int_material" value="no.yml"/></bsdf>)xml"),
       "scene.xml:2:60: error: file 'no.yml' not found"},
      {"extrapolation of a constant index",
       complete_scene(R"xml(<bsdf type="dielectric"><boolean name="extrapolate" value="true"/></bsdf>)xml"),
       "scene.xml:2:40: error: dielectric bsdf: unknown parameter 'extrapolate'"},
      {"index given in two ways",
       complete_scene(
           R"xml(<bsdf type="dielectric"><string name="int_material" value="glass.txt"/><float name="int_ior" value="1.5"/></bsdf>)xml"),
       "scene.xml:2:60: error: dielectric bsdf: 'int_material' together with 'int_ior'"},
      {"glass with a negative index",
       complete_scene(
           R"xml(<bsdf type="dielectric"><string name="int_material" value="negative.txt"/></bsdf>)xml"),
       "scene.xml:2:60: error: negative.txt: n -1.5 at 800 nm: must be positive"},
      {"equal indices",
       complete_scene(
           R"xml(<bsdf type="roughdielectric"><float name="int_ior" value="1.5"/><float name="ext_ior" value="1.5"/></bsdf>)xml"),
       "scene.xml:2:59: error: roughdielectric bsdf: int_ior and ext_ior are equal: there is no rough "
       "interface"},
      {"Mitsuba's metal without data here",
       complete_scene(R"xml(<bsdf type="conductor"><string name="material" value="MgO"/></bsdf>)xml"),
       "scene.xml:2:55: error: conductor bsdf: material: no data of 'MgO' are built in; there are Ag, Al, Au, "
       "Be, Cr, Cu, Ni, Pd, Pt, Ti, W; 'metal' takes a file of n and k"},
      {"Mitsuba's metal and an index",
       complete_scene(
           R"xml(<bsdf type="conductor"><string name="material" value="Au"/><float name="eta" value="1"/></bsdf>)xml"),
       "scene.xml:2:55: error: conductor bsdf: 'material' together with 'eta' or 'k'"},
      {"mixture without weights",
       complete_scene(R"xml(<bsdf type="mixturebsdf"><bsdf type="diffuse"/></bsdf>)xml"),
       "scene.xml:2:2: error: mixturebsdf bsdf: parameter 'weights' is missing"},
      {"mixture with too many weights",
       complete_scene(
           R"xml(<bsdf type="mixturebsdf"><string name="weights" value="0.5, 0.5"/><bsdf type="diffuse"/></bsdf>)xml"),
       "scene.xml:2:56: error: mixturebsdf bsdf: 2 weights for 1 nested bsdfs"},
      {"mixture of nothing",
       complete_scene(R"xml(<bsdf type="mixturebsdf"><string name="weights" value=""/></bsdf>)xml"),
       "scene.xml:2:56: error: mixturebsdf bsdf: 0 weights for 0 nested bsdfs"},
      {"mixture with a negative weight",
       complete_scene(
           R"xml(<bsdf type="mixturebsdf"><string name="weights" value="1.5, -0.5"/><bsdf type="diffuse"/><bsdf type="plastic"/></bsdf>)xml"),
       "scene.xml:2:56: error: mixturebsdf bsdf: weights -0.5: must be >= 0"},
      {"mixture without any weight",
       complete_scene(
           R"xml(<bsdf type="mixturebsdf"><string name="weights" value="0"/><bsdf type="diffuse"/></bsdf>)xml"),
       "scene.xml:2:56: error: mixturebsdf bsdf: weights 0: must have a sum > 0"},
      {"mixture with null",
       complete_scene(
           R"xml(<bsdf type="mixturebsdf"><string name="weights" value="1"/><bsdf type="null"/></bsdf>)xml"),
       "scene.xml:2:2: error: mixturebsdf bsdf: a nested bsdf is null"},
      {"unknown metal",
       complete_scene(R"xml(<bsdf type="conductor"><string name="metal" value="mithril"/></bsdf>)xml"),
       "scene.xml:2:52: error: conductor bsdf: metal: 'mithril' is neither a built-in metal nor a file; "
       "there are Ag, Al, Au, Be, Cr, Cu, Ni, Pd, Pt, Ti, W"},
      {"metal with a similar name",
       complete_scene(R"xml(<bsdf type="conductor"><string name="metal" value="Auu"/></bsdf>)xml"),
       "scene.xml:2:52: error: conductor bsdf: metal: 'Auu' is neither a built-in metal nor a file; "
       "did you mean 'Au'?"},
      {"glass as metal",
       complete_scene(R"xml(<bsdf type="conductor"><string name="metal" value="n-bk7"/></bsdf>)xml"),
       "scene.xml:2:52: error: conductor bsdf: metal: 'n-bk7' is a transparent material, not a metal"},
      {"metal without extinction",
       complete_scene(R"xml(<bsdf type="conductor"><string name="metal" value="glass.txt"/></bsdf>)xml"),
       "scene.xml:2:52: error: conductor bsdf: metal: the file gives no extinction k"},
      {"empty twosided", complete_scene(R"xml(<bsdf type="twosided"/>)xml"),
       "scene.xml:2:2: error: twosided bsdf: needs 1 or 2 nested bsdfs, found 0"},
      {"twosided glass", complete_scene(R"xml(<bsdf type="twosided"><bsdf type="dielectric"/></bsdf>)xml"),
       "scene.xml:2:2: error: twosided bsdf: the nested dielectric bsdf transmits light"},
      {"mask without bsdf", complete_scene(R"xml(<bsdf type="mask"/>)xml"),
       "scene.xml:2:2: error: mask bsdf: needs a nested bsdf"},
      {"mask in a mask",
       complete_scene(R"xml(<bsdf type="mask"><bsdf type="mask"><bsdf type="diffuse"/></bsdf></bsdf>)xml"),
       "scene.xml:2:2: error: mask bsdf: the nested bsdf is a mask itself"},
      {"board of lamps",
       complete_scene(
           R"xml(<bsdf type="diffuse"><texture type="checkerboard" name="reflectance"><spectrum type="planck" name="color1"><float name="temperature" value="300"/></spectrum></texture></bsdf>)xml"),
       "scene.xml:2:37: error: diffuse bsdf: reflectance: color1 describes emission: not allowed in a reflectance"},
      {"opacity above 1",
       complete_scene(
           R"xml(<bsdf type="mask"><float name="opacity" value="2"/><bsdf type="diffuse"/></bsdf>)xml"),
       "scene.xml:2:48: error: mask bsdf: opacity 2: must be in [0, 1]"},
      {"blend without weight",
       complete_scene(R"xml(<bsdf type="blendbsdf"><bsdf type="diffuse"/><bsdf type="plastic"/></bsdf>)xml"),
       "scene.xml:2:2: error: blendbsdf bsdf: needs a weight"},
      {"blend of one",
       complete_scene(
           R"xml(<bsdf type="blendbsdf"><float name="weight" value="0.5"/><bsdf type="diffuse"/></bsdf>)xml"),
       "scene.xml:2:2: error: blendbsdf bsdf: needs 2 nested bsdfs, found 1"},
      {"blend with null",
       complete_scene(
           R"xml(<bsdf type="blendbsdf"><float name="weight" value="0.5"/><bsdf type="diffuse"/><bsdf type="null"/></bsdf>)xml"),
       "scene.xml:2:2: error: blendbsdf bsdf: a nested bsdf is null: a mask with the weight of the other as opacity "
       "is the same"},
      {"weight above 1",
       complete_scene(
           R"xml(<bsdf type="blendbsdf"><float name="weight" value="2"/><bsdf type="diffuse"/><bsdf type="plastic"/></bsdf>)xml"),
       "scene.xml:2:52: error: blendbsdf bsdf: weight 2: must be in [0, 1]"},
      {"twosided blend with glass",
       complete_scene(
           R"xml(<bsdf type="twosided"><bsdf type="blendbsdf"><float name="weight" value="0.5"/><bsdf type="diffuse"/><bsdf type="dielectric"/></bsdf></bsdf>)xml"),
       "scene.xml:2:2: error: twosided bsdf: the nested blendbsdf bsdf transmits light"},
      {"mask of a blend with a mask",
       complete_scene(
           R"xml(<bsdf type="mask"><bsdf type="blendbsdf"><float name="weight" value="0.5"/><bsdf type="diffuse"/><bsdf type="mask"><bsdf type="diffuse"/></bsdf></bsdf></bsdf>)xml"),
       "scene.xml:2:2: error: mask bsdf: the nested bsdf is a mask itself"},
      {"unknown shape", complete_scene(R"xml(<shape type="spere"/>)xml"),
       "scene.xml:2:14: error: shape type 'spere' is not supported; did you mean 'sphere'?"},
      {"mesh without a file", complete_scene(R"xml(<shape type="obj"/>)xml"),
       "scene.xml:2:2: error: obj shape: parameter 'filename' is missing"},
      {"missing mesh",
       complete_scene(R"xml(<shape type="ply"><string name="filename" value="none.ply"/></shape>)xml"),
       "scene.xml:2:50: error: file 'none.ply' not found"},
      {"mesh without triangles",
       complete_scene(R"xml(<shape type="obj"><string name="filename" value="a.obj"/></shape>)xml"),
       "scene.xml:2:50: error: a.obj: the mesh has no triangles"},
      {"negative radius",
       complete_scene(R"xml(<shape type="sphere" id="ball"><float name="radius" value="-1"/></shape>)xml"),
       "scene.xml:2:60: error: shape 'ball': radius -1: must be > 0"},
      {"ellipsoid",
       complete_scene(
           R"xml(<shape type="sphere"><transform name="to_world"><scale x="2"/></transform></shape>)xml"),
       "scene.xml:2:23: error: sphere shape: to_world must not scale a sphere differently along its axes"},
      {"elliptic disk",
       complete_scene(
           R"xml(<shape type="disk"><transform name="to_world"><scale x="2"/></transform></shape>)xml"),
       "scene.xml:2:21: error: disk shape: to_world must keep a disk circular and its axis perpendicular"},
      {"sheared cylinder",
       complete_scene(
           R"xml(<shape type="cylinder"><transform name="to_world"><matrix value="1 0 1 0 1 0 0 0 1"/></transform></shape>)xml"),
       "scene.xml:2:25: error: cylinder shape: to_world must keep a cylinder circular and its axis "
       "perpendicular"},
      {"cylinder without length",
       complete_scene(R"xml(<shape type="cylinder"><point name="p1" value="0 0 0"/></shape>)xml"),
       "scene.xml:2:48: error: cylinder shape: p0 and p1 are equal"},
      {"singular transform",
       complete_scene(
           R"xml(<shape type="cube"><transform name="to_world"><scale z="0"/></transform></shape>)xml"),
       "scene.xml:2:21: error: transform 'to_world' is singular"},
      {"projective matrix",
       complete_scene(
           R"xml(<shape type="cube"><transform name="to_world"><matrix value="1 0 0 0 0 1 0 0 0 0 1 0 0 0 1 1"/></transform></shape>)xml"),
       "scene.xml:2:62: error: the last row of the matrix must be 0 0 0 1"},
      {"matrix with 12 numbers",
       complete_scene(
           R"xml(<shape type="cube"><transform name="to_world"><matrix value="1 0 0 0 0 1 0 0 0 0 1 0"/></transform></shape>)xml"),
       "scene.xml:2:62: error: <matrix> needs 16 or 9 numbers, found 12"},
      {"rotation without axis",
       complete_scene(
           R"xml(<shape type="cube"><transform name="to_world"><rotate angle="3"/></transform></shape>)xml"),
       "scene.xml:2:48: error: <rotate> needs an axis that is not zero"},
      {"lookat to itself",
       complete_scene(
           R"xml(<shape type="cube"><transform name="to_world"><lookat origin="1 2 3" target="1 2 3"/></transform></shape>)xml"),
       "scene.xml:2:78: error: lookat: origin and target are equal"},
      {"lookat along up",
       complete_scene(
           R"xml(<shape type="cube"><transform name="to_world"><lookat origin="0 0 0" target="0 1 0" up="0 1 0"/></transform></shape>)xml"),
       "scene.xml:2:89: error: lookat: up is parallel to the view direction"},
      {"two bsdfs",
       complete_scene(R"xml(<shape type="cube"><bsdf type="diffuse"/><bsdf type="plastic"/></shape>)xml"),
       "scene.xml:2:43: error: cube shape: a second bsdf"},
      {"point light in a shape",
       complete_scene(R"xml(<shape type="cube"><emitter type="point"/></shape>)xml"),
       "scene.xml:2:35: error: point emitter: only area and thermal emitters can be part of a shape"},
      {"area light with a transform",
       complete_scene(
           R"xml(<shape type="cube"><emitter type="area"><transform name="to_world"><scale value="2"/></transform></emitter></shape>)xml"),
       "scene.xml:2:42: error: area emitter: an area emitter has no transform of its own"},
      {"missing environment map",
       complete_scene(R"xml(<emitter type="envmap"><string name="filename" value="none.exr"/></emitter>)xml"),
       "scene.xml:2:55: error: file 'none.exr' not found"},
      {"environment map of one pixel",
       complete_scene(R"xml(<emitter type="envmap"><string name="filename" value="one.pfm"/></emitter>)xml"),
       "scene.xml:2:55: error: envmap emitter: an environment map needs at least 2 x 2 pixels, "
       "'one.pfm' has 1 x 1"},
      {"beam wider than the cutoff",
       complete_scene(R"xml(<emitter type="spot"><float name="beam_width" value="30"/></emitter>)xml"),
       "scene.xml:2:54: error: spot emitter: beam_width 30: must be from 0 to cutoff_angle"},
      {"spot with a texture that is none",
       complete_scene(R"xml(<emitter type="spot"><spectrum name="texture" value="0.5"/></emitter>)xml"),
       "scene.xml:2:54: error: spot emitter: texture: must be a bitmap, checkerboard or spectral_bitmap"},
      {"spot with an attribute of a mesh",
       complete_scene(
           R"xml(<emitter type="spot"><texture name="texture" type="mesh_attribute"><string name="name" value="vertex_a"/></texture></emitter>)xml"),
       "scene.xml:2:52: error: spot emitter: texture: must be a bitmap, checkerboard or spectral_bitmap"},
      {"projector of an attribute of a mesh",
       complete_scene(
           R"xml(<emitter type="projector"><texture name="irradiance" type="mesh_attribute"><string name="name" value="vertex_a"/></texture></emitter>)xml"),
       "scene.xml:2:60: error: projector emitter: irradiance: must be a spectrum, bitmap, checkerboard or spectral_bitmap"},
      {"spot with a texture over half of all directions",
       complete_scene(
           R"xml(<emitter type="spot"><float name="cutoff_angle" value="90"/><texture name="texture" type="checkerboard"/></emitter>)xml"),
       "scene.xml:2:56: error: spot emitter: cutoff_angle 90: must be below 90 degrees with a texture"},
      {"projector of nothing",
       complete_scene(R"xml(<emitter type="projector"><float name="fov" value="30"/></emitter>)xml"),
       "scene.xml:2:2: error: projector emitter: parameter 'irradiance' is missing"},
      {"projector of less than nothing",
       complete_scene(
           R"xml(<emitter type="projector"><spectrum name="irradiance" value="1"/><float name="fov" value="30"/><float name="scale" value="-1"/></emitter>)xml"),
       "scene.xml:2:123: error: projector emitter: scale -1: must be >= 0"},
      {"radius of a sun that floats cannot resolve",
       complete_scene(
           R"xml(<emitter type="directional"><float name="angular_radius" value="1e-4"/></emitter>)xml"),
       "scene.xml:2:65: error: directional emitter: angular_radius 1e-04: must be 0, or from 0.001 to 90 "
       "degrees"},
      {"direction of length 0",
       complete_scene(
           R"xml(<emitter type="directional"><vector name="direction" value="0 0 0"/></emitter>)xml"),
       "scene.xml:2:61: error: directional emitter: direction: its length must be > 0"},
      {"sampling weight 0",
       complete_scene(R"xml(<emitter type="point"><float name="sampling_weight" value="0"/></emitter>)xml"),
       "scene.xml:2:60: error: point emitter: sampling_weight 0: must be > 0"},
  };
}

TEST(BrokenScenes, Entities) {
  const TemporaryFolder folder;
  folder.write("a.obj", "v 0 0 0\n");
  folder.write("glass.txt", "400 1.6\n800 1.5\n");
  folder.write("word.spd", "400 0.1\n500 high\n");
  folder.write("bright.spd", "400 0.1\n500 1.2\n");
  folder.write("one.pfm", pfm_image(1, 1, 1, {0.5f}));
  folder.write("large.pfm", pfm_image(1, 1, 1, {101.0f}));
  folder.write("negative.txt", "400 1.6\n800 -1.5\n");
  expect_messages(table(), folder);
}

}  // namespace
}  // namespace kiloband::test::test_broken_entities
