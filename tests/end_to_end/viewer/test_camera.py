"""The camera tool: where panning, dollying and turning put the camera, by hand, and the camera's copy as XML."""
import math
import re
import unittest

from selenium.webdriver.common.actions.wheel_input import ScrollOrigin

from browser import ActionChains, Keys
from program import BOX, Cube, kiloband
from rendered_page import CHANNELS, SIZE, RenderedPage

ORIGIN = [0.278, 0.273, -0.8]
SENSOR = re.compile("<sensor.*</sensor>", re.DOTALL)
FILM = re.compile("<film.*</film>", re.DOTALL)


class Camera(RenderedPage):
    """The Cornell box's camera looks along +z with +y up, so that its right is -x."""

    def setUp(self):
        super().setUp()
        self.browser.wait("return state.camera.origin.every((v, i) => Math.abs(v - given[i]) < 1e-9)", "the scene file's camera", ORIGIN)
        self.browser.press("o")
        self.open_tab("camera")
        camera = self.browser.value("return state.camera")
        self.origin, self.target, self.fov_deg = camera["origin"], camera["target"], camera["fov_deg"]
        self.distance = math.dist(self.origin, camera["pivot"])

    def assert_camera(self, origin, target):
        """As the page moves it, as the server has it, and as the panel shows it, to five digits."""
        self.browser.wait("return state.scene.camera.origin.every((v, i) => Math.abs(v - given[i]) < 1e-6)", f"the camera at {origin}", origin)
        shown = [[float(v) for v in text.replace("−", "-").split(",")] for text in self.browser.texts("#tab output.vector")]
        for text, values in zip(shown, (origin, target)):
            for number, value in zip(text, values):
                self.assertAlmostEqual(number, value, delta=6e-5 * max(0.1, abs(value)))
        for number, value in zip(self.browser.value("return state.camera.target"), target):
            self.assertAlmostEqual(number, value, delta=1e-6)

    def assert_moved(self, by):
        self.assert_camera(*([a + b for a, b in zip(point, by)] for point in (self.origin, self.target)))

    def test_the_pivot_follows_a_pan(self):
        """What is at the pivot's distance moves by as many pixels as the mouse."""
        width_px = SIZE * self.browser.value("return (await import('/image.js')).image_scale()")
        metres = 2 * self.distance * math.tan(math.radians(self.fov_deg) / 2) / width_px
        ActionChains(self.browser.driver).key_down(Keys.SHIFT).perform()
        self.browser.drag_away(60, -30)
        ActionChains(self.browser.driver).key_up(Keys.SHIFT).perform()
        self.assert_moved([60 * metres, -30 * metres, 0])

    def test_the_wheel_dollies(self):
        """By exp(0.0015) of the distance for each step of the wheel, towards the pivot."""
        middle = ScrollOrigin.from_element(self.browser.find("#image"))
        ActionChains(self.browser.driver).scroll_from_origin(middle, 0, -200).perform()
        self.assert_moved([0, 0, self.distance * (1 - math.exp(-0.3))])

    def test_a_movement_that_nobody_ends(self):
        """A page that is closed while it moves the camera: who looks next is told of the reduced size, and gets the full one."""
        self.browser.value("const {post} = await import('/api.js'); await post('/api/camera', {origin: given, moving: true});",
                           [0.3, 0.273, -0.8])
        self.browser.wait("return state.frame.width < state.frame.full_width", "a reduced frame")
        self.assertRegex(self.browser.texts("#status .reduced")[0], r"^reduced to \d+ × \d+$")
        self.browser.wait("return state.frame.width === state.frame.full_width", "the full size")
        self.assertEqual(self.browser.texts("#status .reduced"), [])

    def test_arrows_orbit(self):
        """0.06 radians about the pivot; a key to the right turns the scene to the right."""
        self.browser.press(Keys.ARROW_RIGHT)
        pivot = [*self.origin[:2], self.origin[2] + self.distance]
        ahead = math.dist(self.origin, self.target) - self.distance
        sine, cosine = math.sin(0.06), math.cos(0.06)
        self.assert_camera([pivot[0] + self.distance * sine, pivot[1], pivot[2] - self.distance * cosine],
                           [pivot[0] - ahead * sine, pivot[1], pivot[2] + ahead * cosine])

    def test_keys_move_along_the_axes(self):
        for key, axis, sign in [("s", 2, -1), ("a", 0, 1), ("d", 0, -1), ("e", 1, 1), ("q", 1, -1)]:
            start = self.browser.value("return state.camera.origin")
            ActionChains(self.browser.driver).key_down(key).perform()
            try:
                self.browser.wait("return Math.hypot(...state.camera.origin.map((v, i) => v - given[i])) > 0.02", key, start)
            finally:
                ActionChains(self.browser.driver).key_up(key).perform()
            moved = [a - b for a, b in zip(self.browser.value("return state.camera.origin"), start)]
            self.assertGreater(sign * moved.pop(axis), 0.02, key)
            self.assertLess(max(map(abs, moved)), 1e-6, key)

    def test_a_copied_camera_renders_the_same_view(self):
        copied = self.copy_after_a_look()
        self.wait_for_samples(256)
        self.pause()
        seen = self.save("looked")
        scene = self.saved / "pasted.xml"
        text = BOX.read_text()
        copied = copied.replace("</sensor>", FILM.search(text)[0] + "</sensor>")
        for folder in ("spectra", "meshes"):
            text = text.replace(f'"{folder}/', f'"{BOX.parent}/{folder}/')
        scene.write_text(SENSOR.sub(copied, text))
        self.assertLess(self.difference(seen, self.render(scene)), 0.1)
        self.assertGreater(self.difference(seen, self.render(BOX)), 0.5)

    def render(self, scene):
        file = self.saved / "rendered.hdr"
        kiloband("render", scene, "-D", f"res={SIZE}", "-D", f"bands=400:700:{CHANNELS}", "--spp", 256, "-o", file, "--quiet")
        return Cube(file)

    def copy_after_a_look(self):
        """Turns and dollies, and takes the XML from the clipboard."""
        self.browser.press(Keys.ARROW_LEFT, Keys.ARROW_LEFT, Keys.ARROW_LEFT, Keys.ARROW_DOWN, Keys.ARROW_DOWN)
        self.browser.wait("return state.scene.camera.origin.every((v, i) => Math.abs(v - state.camera.origin[i]) < 1e-9 && v !== given[i])",
                          "the server's camera", self.origin)
        self.browser.allow_clipboard(self.viewer.address)
        self.browser.press("c")
        return self.browser.wait("const text = await navigator.clipboard.readText(); return text.startsWith('<sensor') && text", "the copy").strip()

    @staticmethod
    def difference(a, b):
        """Root mean square of the difference of the channels' sums, relative to the root mean square of them."""
        bands, size = len(a.low), a.width * a.height
        sums = [[sum(cube.values[band * size + i] for band in range(bands)) for i in range(size)] for cube in (a, b)]
        return math.dist(*sums) / math.hypot(*sums[0])


if __name__ == "__main__":
    unittest.main()
