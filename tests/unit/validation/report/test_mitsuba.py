"""Scenes for Mitsuba 3 and the cubes of its images, as far as it takes no Mitsuba."""

import pathlib
import sys
import tempfile
import unittest
import xml.etree.ElementTree as ElementTree

import numpy

ROOT = pathlib.Path(__file__).resolve().parents[4]
sys.path[:0] = [str(ROOT / "validation" / "mitsuba"), str(ROOT / "validation" / "report")]

import cubes  # noqa: E402
import render_mitsuba  # noqa: E402


class Scene(unittest.TestCase):
    def test_bands(self):
        self.assertEqual(render_mitsuba.parse_bands("400:700:3"), [(400, 500), (500, 600), (600, 700)])
        self.assertEqual(render_mitsuba.parse_bands("400-410, 500-520.5"), [(400, 410), (500, 520.5)])

    def test_film_and_file_names(self):
        scene = ROOT / "scenes/cornell_box/cornell_box.xml"
        film = render_mitsuba.spectral_film((6, 4), [(400.0, 500.0), (600.0, 700.0)])
        root = ElementTree.fromstring(render_mitsuba.adapted(scene, film))
        (film,) = root.iter("film")
        self.assertEqual(film.get("type"), "specfilm")
        self.assertEqual([e.get("value") for e in film.findall("integer")], ["6", "4"])
        bands = [(e.get("name"), e.get("value")) for e in film.findall("spectrum")]
        self.assertEqual(
            bands,
            [("channel00000", "400.0:1, 500.0:1"), ("channel00001", "600.0:1, 700.0:1"), ("whole", "400.0:1, 700.0:1")],
        )
        files = [e.get("filename") or e.get("value") for e in root.iter() if "filename" in (*e.attrib, e.get("name"))]
        self.assertEqual(len(files), 12)
        for file in files:
            self.assertTrue(pathlib.Path(file).is_absolute() and pathlib.Path(file).is_file(), file)

    def test_old_scenes(self):
        """Every sensor has a film; files in <path> folders are found; what version 3.9.1 refuses of old files is gone."""
        text = """<scene version="0.6.0"><path value="far"/>
            <sensor type="perspective"><transform name="toWorld"><lookAt origin="0,0,1" target="0,0,0"/></transform>
            <sampler type="independent"><integer name="dimension" value="1"/><integer name="sampleCount" value="4"/></sampler></sensor>
            <shape type="obj"><string name="filename" value="a.obj"/></shape></scene>"""
        with tempfile.TemporaryDirectory() as folder:
            scene = pathlib.Path(folder).resolve() / "old.xml"
            scene.write_text(text)
            (scene.parent / "far").mkdir()
            (scene.parent / "far" / "a.obj").write_text("")
            root = ElementTree.fromstring(render_mitsuba.adapted(scene, ElementTree.Element("film", type="hdrfilm")))
            self.assertEqual([e.get("type") for e in root.findall("sensor/film")], ["hdrfilm"])
            self.assertEqual(len(list(root.iter("lookat"))), 1)
            self.assertEqual([e.get("name") for e in root.iter("integer")], ["sampleCount"])
            self.assertEqual(root.find("shape/string").get("value"), str(scene.parent / "far" / "a.obj"))
            self.assertEqual(root.findall("path"), [])

    def test_includes(self):
        """In <path> folders, inside objects, in each other; names with parameters; all in relation to the first scene."""
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name).resolve()
            (folder / "parts").mkdir()
            for file in ("parts/a.obj", "b.obj"):
                (folder / file).write_text("")
            (folder / "parts/shape.xml").write_text(
                """<scene><shape type="obj"><string name="filename" value="a.obj"/><include filename="bsdf.xml"/></shape></scene>"""
            )
            (folder / "bsdf.xml").write_text("""<scene><bsdf type="diffuse" id="d"/><bsdf type="plastic" id="p"/></scene>""")
            scene = folder / "scene.xml"
            scene.write_text(f"""<scene version="3.0.0"><path value="parts"/><default name="file" value="{folder}/b.obj"/>
                <default name="part" value="shape"/><include filename="$part.xml"/>
                <shape type="obj"><string name="filename" value="$file"/></shape></scene>""")
            root = ElementTree.fromstring(render_mitsuba.adapted(scene))
            self.assertEqual(list(root.iter("include")), [])
            names = [e.get("value") for e in root.iter("string")]
            self.assertEqual(names, [str(folder / "parts/a.obj"), str(folder / "b.obj")])
            self.assertEqual([e.get("id") for e in root.findall("shape")[0].findall("bsdf")], ["d", "p"])

    def test_scenes_have_box_filters(self):
        """Other filters treat the image's border differently in the two programs."""
        scenes = sorted((ROOT / "validation/mitsuba/scenes").glob("*.xml"))
        self.assertGreaterEqual(len(scenes), 8)
        for scene in scenes:
            self.assertEqual([f.get("type") for f in ElementTree.parse(scene).iter("rfilter")], ["box"], scene)

    def test_cube(self):
        image = numpy.arange(24, dtype=numpy.float32).reshape(2, 4, 3)
        with tempfile.TemporaryDirectory() as folder:
            header = pathlib.Path(folder) / "a.r00.hdr"
            render_mitsuba.write_cube(header, image, [(400.0, 500.0), (500.0, 600.0), (600.0, 650.5)])
            numpy.testing.assert_array_equal(cubes.read_cube(header), image)
            self.assertIn("kiloband band maximum = {500, 600, 650.5}\n", header.read_text())
            self.assertIn("kiloband quantity = integral\n", header.read_text())


if __name__ == "__main__":
    unittest.main()
