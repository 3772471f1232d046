"""Scenes for Raysect, as far as it takes no Raysect."""

import pathlib
import subprocess
import sys
import tempfile
import unittest

import numpy

sys.dont_write_bytecode = True  # nothing is left in the source folder
ROOT = pathlib.Path(__file__).resolve().parents[4]
sys.path.insert(0, str(ROOT / "validation" / "raysect"))

import diffuse_scenes  # noqa: E402
import time_raysect  # noqa: E402

SCRIPT = ROOT / "validation" / "raysect" / "time_raysect.py"
CORNELL_BOX = ROOT / "scenes/cornell_box/cornell_box.xml"

SCENE = """<scene version="3.0.0"><default name="depth" value="4"/>
  <integrator type="path"><integer name="max_depth" value="$depth"/></integrator>
  <sensor type="perspective"><float name="fov" value="40"/>
    <transform name="to_world"><lookat origin="0, 0, -1" target="0 0 0" up="0, 1, 0"/></transform>
    <film type="bandfilm"><rfilter type="box"/></film></sensor>
  <bsdf type="diffuse" id="grey"><spectrum name="reflectance" value="0.25"/></bsdf>
  <shape type="obj" id="plate"><string name="filename" value="plate.obj"/><ref id="grey"/></shape></scene>"""
PLATE = "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 0 1 0\nf 1/1 2/2 3/3 4/4\nf -4 -3 -2\n"


def read(text, plate=PLATE):
    with tempfile.TemporaryDirectory() as folder:
        (pathlib.Path(folder) / "plate.obj").write_text(plate)
        (pathlib.Path(folder) / "scene.xml").write_text(text)
        return diffuse_scenes.read_scene(pathlib.Path(folder) / "scene.xml")


class Scenes(unittest.TestCase):
    def test_cornell_box(self):
        scene = diffuse_scenes.read_scene(CORNELL_BOX)
        self.assertEqual(scene.max_depth, 6)
        self.assertEqual(scene.camera, diffuse_scenes.Camera((0.278, 0.273, -0.8), (0.278, 0.273, 0), (0, 1, 0), 39.3077))
        self.assertEqual(sum(len(surface.triangles) for surface in scene.surfaces), 32)
        lights = [surface for surface in scene.surfaces if surface.radiance is not None]
        self.assertEqual([light.name for light in lights], ["light"])
        self.assertEqual(lights[0].radiance.values.tolist(), [0, 8, 15.6, 18.4])
        self.assertEqual(lights[0].reflectance.values.tolist(), [0.78])
        walls = {surface.name: surface.reflectance for surface in scene.surfaces}
        self.assertEqual(walls["red_wall"].values[0], 0.04)
        self.assertEqual(walls["tall_block"].values[0], 0.343)

    def test_defaults_polygons_and_references(self):
        scene = read(SCENE)
        self.assertEqual(scene.max_depth, 4)
        (plate,) = scene.surfaces
        self.assertEqual(plate.triangles, [(0, 1, 2), (0, 2, 3), (0, 1, 2)])
        self.assertEqual(plate.vertices.tolist()[2], [2, 1, 0])
        self.assertEqual((plate.reflectance.values.tolist(), plate.radiance), ([0.25], None))
        self.assertEqual(read(SCENE.replace('<integer name="max_depth" value="$depth"/>', "")).max_depth, -1)

    def test_whatever_else_a_scene_has_is_refused(self):
        normals = PLATE + "vn 0 0 1\n"
        for old, new, message in (
            ('<bsdf type="diffuse"', '<bsdf type="plastic"', "bsdf plastic: only diffuse"),
            ('<shape type="obj"', '<shape type="sphere"', "shape sphere: only obj"),
            ("</scene>", '<emitter type="constant"/></scene>', "scene: emitter constant"),
            ('<ref id="grey"/>', '<ref id="grey"/><boolean name="flip_normals" value="true"/>', "boolean flip_normals"),
            ('<ref id="grey"/>', "", "one diffuse BSDF"),
            ('value="0.25"', 'value="400:0, 700:1"', "only constants and files"),
            ('"box"', '"gaussian"', "not a box"),
            ('type="perspective">', 'type="perspective"><string name="fov_axis" value="y"/>', "string fov_axis"),
            ("</integrator>", '<boolean name="hide_emitters" value="true"/></integrator>', "boolean hide_emitters"),
            ('<transform name="to_world">', '<transform name="to_world"><scale value="2"/>', "transform: scale"),
        ):
            self.assertIn(old, SCENE)
            with self.assertRaisesRegex(diffuse_scenes.Impossible, message):
                read(SCENE.replace(old, new))
        with self.assertRaisesRegex(diffuse_scenes.Impossible, "smooth normals"):
            read(SCENE, normals)
        read(SCENE.replace('<ref id="grey"/>', '<ref id="grey"/><boolean name="face_normals" value="true"/>'), normals)

    def test_the_script_says_why_it_refuses(self):
        for scene, code, message in (
            (CORNELL_BOX, 0, ""),
            (ROOT / "validation/mitsuba/scenes/glass.xml", 2, "time_raysect.py: scene: emitter constant is not written for Raysect\n"),
        ):
            end = subprocess.run([sys.executable, SCRIPT, scene, "--load"], capture_output=True, text=True)
            self.assertEqual((end.returncode, end.stderr), (code, message))

    def test_without_raysect_the_script_says_so(self):
        """Without site packages there is no Raysect, wherever it is installed."""
        end = subprocess.run([sys.executable, "-S", "-E", SCRIPT, "--probe"], capture_output=True, text=True)
        self.assertEqual((end.returncode, end.stdout), (2, ""))
        self.assertRegex(end.stderr, r"^time_raysect\.py: Raysect is not installed: No module named 'numpy' \(pip install raysect\)\n$")


class Channels(unittest.TestCase):
    def test_equal_neighbours_within_the_spectra(self):
        scene = diffuse_scenes.read_scene(CORNELL_BOX)
        self.assertEqual(time_raysect.checked_bands("400:700:3", scene), [(400, 500), (500, 600), (600, 700)])
        for bands, message in (("400-410, 420-430", "equal width"), ("400-410, 410-430", "equal width"), ("390:700:4", "a spectrum ends")):
            with self.assertRaisesRegex(diffuse_scenes.Impossible, message):
                time_raysect.checked_bands(bands, scene)


class Geometry(unittest.TestCase):
    def test_backs_are_behind(self):
        (plate,) = read(SCENE).surfaces
        vertices, triangles = diffuse_scenes.backs(plate)
        self.assertEqual(triangles, [(0, 1, 2), (3, 4, 5), (6, 7, 8)])
        numpy.testing.assert_allclose(vertices[:, 2], -2e-6)
        numpy.testing.assert_array_equal(vertices[:3, :2], plate.vertices[:3, :2])

    def test_cosines_of_pixels(self):
        """Their mean over the image is that of 1 / sqrt(1 + x² + y²) over [0, 1]²: ln(2 + √3) - π / 6."""
        cosines = diffuse_scenes.pixel_cosines(4, 90)
        self.assertEqual(cosines.shape, (4, 4))
        numpy.testing.assert_allclose(cosines, cosines.T)
        numpy.testing.assert_allclose(cosines, cosines[::-1, ::-1])
        self.assertAlmostEqual(cosines.mean(), numpy.log(2 + numpy.sqrt(3)) - numpy.pi / 6, places=4)


if __name__ == "__main__":
    unittest.main()
