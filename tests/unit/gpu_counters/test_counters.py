"""scripts/gpu_counters: what is captured of a launch is what was launched (under PoCL), and PTX is made what CUDA runs.

usage: test_counters.py SOURCES PROGRAM         PROGRAM: kiloband
"""

import importlib.util
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

SOURCES, PROGRAM = map(pathlib.Path, map(os.path.abspath, sys.argv[1:3]))
TOOL = SOURCES / "scripts/gpu_counters"
specification = importlib.util.spec_from_file_location("replay", TOOL / "replay.py")
replay = importlib.util.module_from_spec(specification)
specification.loader.exec_module(replay)

PTX = b"""//
.version 9.0
.target sm_90, texmode_independent
.const .align 4 .b8 table[8];
.entry k( .param .u64 .ptr .const .align 16 k_0 )
{
 mov.b32 %r1, %envreg3;
 mov.b32 %r2, %envreg6;
 ld.const.u32 %r3, [%rd1+4];
}
\0what stands behind"""


class Capture(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.folder = pathlib.Path(cls.temporary.name)
        subprocess.run(["cc", "-shared", "-fPIC", "-Wall", "-Wextra", "-Werror", "-o", cls.folder / "capture.so", TOOL / "capture.c",
                        "-ldl"], check=True)

    @classmethod
    def tearDownClass(cls):
        cls.temporary.cleanup()

    def render(self, kernel, launch):
        scene = SOURCES / "scenes/cornell_box/cornell_box.xml"
        return subprocess.run(
            [PROGRAM, "render", scene, "--bands", "400:700:8", "--size", "32x32", "--spp", "2", "--backend", "opencl",
             "--method", "dpept-batch", "-o", self.folder / "out.hdr", "--quiet"],
            env={**os.environ, "LD_PRELOAD": str(self.folder / "capture.so"), "ASAN_OPTIONS": "verify_asan_link_order=0", "CAPTURE_KERNEL": kernel,
                 "CAPTURE_LAUNCH": str(launch), "CAPTURE_FOLDER": str(self.folder)}, capture_output=True, text=True)

    def test_a_launch(self):
        done = self.render("dpept_batch", 0)
        self.assertEqual(done.returncode, 0, done.stderr)
        launch = json.loads((self.folder / "launch.json").read_text())
        self.assertEqual(launch["kernel"], "dpept_batch")
        self.assertEqual(launch["global"] % launch["local"], 0)
        kinds = [a["kind"] for a in launch["arguments"]]
        self.assertGreater(kinds.count("buffer"), 20)
        self.assertGreater(kinds.count("value"), 0)
        for number, argument in enumerate(launch["arguments"]):
            if argument["kind"] == "buffer":
                self.assertEqual((self.folder / f"argument-{number}").stat().st_size, argument["bytes"])
        self.assertGreater((self.folder / "program").stat().st_size, 0)

    def test_a_launch_that_there_is_not(self):
        (self.folder / "launch.json").unlink(missing_ok=True)
        self.assertEqual(self.render("dpept_batch", 1000).returncode, 0)
        self.assertFalse((self.folder / "launch.json").exists())


class Translation(unittest.TestCase):
    def test_registers_and_constants(self):
        text = replay.translate(PTX)
        self.assertIn("mov.b32 %r1, 0;", text)
        self.assertIn("mov.b32 %r2, %nctaid.x;", text)
        self.assertIn("ld.global.nc.u32", text)
        self.assertIn(".ptr .global .align 16", text)
        self.assertIn(".global .align 4 .b8 table", text)
        self.assertNotIn("behind", text)

    def test_what_it_does_not_know(self):
        with self.assertRaises(ValueError):
            replay.translate(PTX.replace(b"%envreg6", b"%envreg12"))
        with self.assertRaises(ValueError):
            replay.translate(b"\x7fELF")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
