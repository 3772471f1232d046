"""A metal that the page replaces by another one."""
import unittest

from program import Cube, kiloband
from rendered_page import RenderedPage

SIZE = 16
# A mirror under an even sky shows what the metal reflects at nearly normal incidence.
SCENE = f"""<scene version="3.0.0">
  <default name="metal" value="Au"/>
  <integrator type="path"/>
  <sensor type="perspective">
    <float name="fov" value="10"/>
    <transform name="to_world"><lookat origin="0, 0, 2" target="0, 0, 0" up="0, 1, 0"/></transform>
    <film type="bandfilm">
      <integer name="width" value="{SIZE}"/> <integer name="height" value="{SIZE}"/>
      <string name="bands" value="400:700:10"/> <rfilter type="box"/>
    </film>
  </sensor>
  <shape type="rectangle"><bsdf type="conductor"><string name="metal" value="$metal"/></bsdf></shape>
  <emitter type="constant"><spectrum name="radiance" value="1"/></emitter>
</scene>
"""


class Metal(RenderedPage):
    @classmethod
    def scene(cls):
        file = cls.saved / "mirror.xml"
        file.write_text(SCENE)
        return (file,)

    def assert_curve_of(self, metal, after):
        """The plotted pixel against a render of the scene with that metal."""
        self.wait_for_samples(64)
        shown = self.browser.wait("return state.curves_of?.revision > given && state.curves_of.samples >= 64 && state.curves[0]",
                                  f"the spectrum of {metal}", after)["mean"]
        file = self.saved / f"{metal}.hdr"
        kiloband("render", self.saved / "mirror.xml", "-D", f"metal={metal}", "--spp", 256, "-o", file, "--quiet")
        for value, true in zip(shown, Cube(file).spectrum(5, 6), strict=True):
            self.assertAlmostEqual(value, true, delta=0.01)

    def test_gold_becomes_silver(self):
        self.browser.click(5, 6)
        self.assert_curve_of("Au", self.revision() - 1)
        revision = self.revision()
        self.open_tab("scene")
        gold = next(s for s in self.browser.value("return state.scene.spectra") if s["kind"] == "metal")
        now = lambda: self.browser.find(f"[data-spectrum={gold['id']}] .now").text
        self.assertEqual(now(), "Au")  # as the scene file names it
        self.browser.find(f"[data-spectrum={gold['id']}]").click()
        self.browser.choose_option(".editor select", "Ag", which=1)
        self.wait_for_revision_after(revision)
        self.assert_curve_of("Ag", revision)
        self.assertIn("Ag", now())
        revision = self.revision()
        self.browser.find(".editor .alone button").click()
        self.wait_for_revision_after(revision)
        self.assert_curve_of("Au", revision)
        self.assertEqual(now(), "Au")


if __name__ == "__main__":
    unittest.main()
