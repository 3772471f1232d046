"""The portable folder (docs/portable.md): every library that its programs load is in it or glibc's.

usage: test_folder.py PACK_SCRIPT PROGRAM
"""

import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

PACK, PROGRAM = map(os.path.abspath, sys.argv[1:3])
GLIBC = re.compile(r"(linux-vdso|ld-linux-x86-64|lib(c|m|pthread|dl|rt|resolv|util))\.so")


def run(*command, **options):
    return subprocess.run(command, capture_output=True, text=True, cwd="/", **options)


def dynamic(file, tag):
    """Values of one tag of a file's dynamic section."""
    return re.findall(rf"\({tag}\).*\[(.*)\]", run("readelf", "-d", str(file)).stdout)


class Folder(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.folder = pathlib.Path(cls.temporary.name) / "a folder"
        packed = run(PACK, str(cls.folder), PROGRAM)
        if packed.returncode != 0:
            raise RuntimeError(packed.stdout + packed.stderr)

    @classmethod
    def tearDownClass(cls):
        cls.temporary.cleanup()

    def test_libraries_are_inside(self):
        libraries = {file.name for file in (self.folder / "lib").glob("*.so*")}
        self.assertIn("libOpenCL.so.1", libraries)
        self.assertIn("libstdc++.so.6", libraries)
        self.assertFalse([name for name in libraries if GLIBC.match(name) or "OpenImageIO" in name])
        for file in [self.folder / "bin/kiloband", *(self.folder / "lib").glob("*.so*")]:
            for name in dynamic(file, "NEEDED"):
                self.assertTrue(name in libraries or GLIBC.match(name), f"{file.name} needs {name}")
        loaded = run("ldd", str(self.folder / "bin/kiloband")).stdout
        for name, place in re.findall(r"^\s*(\S+) => (.*) \(0x", loaded, re.MULTILINE):
            if not GLIBC.match(name):
                self.assertEqual(pathlib.Path(place).resolve().parent, (self.folder / "lib").resolve(), name)
        self.assertNotIn("not found", loaded)

    def test_libraries_are_looked_for_inside(self):
        """By DT_RPATH, which holds for libraries of libraries; one of their own would take its place."""
        self.assertEqual(dynamic(self.folder / "bin/kiloband", "RPATH"), ["$ORIGIN/../lib"])
        self.assertEqual(dynamic(self.folder / "bin/kiloband", "RUNPATH"), [])
        for file in (self.folder / "lib").glob("*.so*"):
            self.assertEqual(dynamic(file, "RUNPATH") + dynamic(file, "RPATH"), [], file.name)

    def test_scenes_are_the_folders(self):
        """The default of --root: shown by its message where something is missing."""
        program, analytic = str(self.folder / "kiloband"), self.folder / "share/kiloband/scenes/analytic"
        listed = run(program, "validate", "--list", "--quick", "--backends", "cpu")
        self.assertEqual(listed.returncode, 0, listed.stderr)
        self.assertIn("cornell_box", listed.stdout)
        analytic.rename(analytic.with_name("away"))
        refused = run(program, "validate", "--list", "--quick", "--backends", "cpu")
        analytic.with_name("away").rename(analytic)
        self.assertEqual(refused.returncode, 2)
        self.assertIn(f"{self.folder}/share/kiloband: no folder scenes/analytic there", refused.stderr)

    def test_scenes_need_no_picture_module(self):
        for name in ("metals_and_lamps", "glade"):
            scene = self.folder / "share/kiloband/validation/scenes" / f"{name}.xml"
            read = run(str(self.folder / "kiloband"), "info", str(scene), env={**os.environ, "LD_DEBUG": "files"})
            self.assertEqual(read.returncode, 0, read.stdout)
            self.assertIn("libOpenCL", read.stderr)
            self.assertNotIn("libOpenImageIO", read.stderr)

    def test_licences_travel(self):
        names = {file.name for file in (self.folder / "licences").iterdir() if file.stat().st_size > 0}
        self.assertLessEqual({"kiloband", "libembree3-3", "libopenexr-3-1-30", "libjpeg62-turbo", "libpng16-16", "libstdc++6",
                              "ocl-icd-libopencl1", "libtbb12", "zlib1g"}, names)
        self.assertTrue((self.folder / "licences/common-licenses/Apache-2.0").is_file())

    def test_newer_libraries_of_the_system_are_taken(self):
        script = f'here=$1; . "{self.folder}/lib/newer_libraries.sh"; echo "$LD_PRELOAD"'
        environment = {name: value for name, value in os.environ.items() if name != "LD_PRELOAD"}
        with tempfile.TemporaryDirectory() as place:
            (pathlib.Path(place) / "lib").mkdir()
            for version, newer in (("6.0.1", True), ("6.0.999", False)):
                (pathlib.Path(place) / "lib/versions").write_text(
                    f"libstdc++.so.6 libstdc++.so.{version}\nlibz.so.1 libz.so.1.999\n")
                preload = run("sh", "-c", script, "sh", place, env=environment).stdout.strip()
                self.assertEqual("libstdc++.so.6" in preload and "libgcc_s.so.1" in preload, newer, preload)
                self.assertNotIn("libz", preload)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
