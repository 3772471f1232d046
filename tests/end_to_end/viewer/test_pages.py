"""Pages of one server: several at once, closed and opened again, a server that goes and comes back; how they look."""
import pathlib
import tempfile
import unittest

from browser import Browser, Keys
from program import BOX, Viewer, kiloband, wait_until
from test_other_cubes import write_cube

SIZES = {"1280x800": (1280, 800), "2560x1440": (2560, 1440), "3840x2160": (3840, 2160)}
# Elements whose text does not fit into them, or that reach beyond the window. What may be cut says so by an ellipsis.
MISFITS = """
const cut = (element) => element.scrollWidth > element.clientWidth + 1 &&
    getComputedStyle(element).textOverflow !== 'ellipsis' && !element.matches('.dygraph-axis-label, svg, svg *');
const found = [];
for (const element of document.querySelectorAll('#panel *, #foot *, dialog[open] *')) {
  const box = element.getBoundingClientRect();
  if (box.width === 0 || box.height === 0 || element.closest('[hidden]')) continue;
  const scrolled = element.closest(innerWidth < 700 ? '#panel, dialog' : '#tab, #legend-box, dialog');
  const outside = box.left < -1 || box.right > innerWidth + 1 || (!scrolled && (box.top < -1 || box.bottom > innerHeight + 1));
  if (outside || (element.children.length === 0 && element.clientWidth > 0 && cut(element))) {
    found.push(`${element.tagName} ${element.className} '${element.textContent.slice(0, 40)}'`);
  }
}
return found;
"""
# Contrast of all texts with what is behind them, by the formula of WCAG 2; the lowest.
CONTRAST = """
const channels = (colour) => colour.match(/[\\d.]+/g).map(Number);
const light = (c) => c.slice(0, 3).map((v) => v / 255).map((v) => v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4)
    .reduce((sum, v, i) => sum + v * [0.2126, 0.7152, 0.0722][i], 0);
const behind = (element) => {
  for (let at = element; at; at = at.parentElement) {
    const colour = channels(getComputedStyle(at).backgroundColor);
    if ((colour[3] ?? 1) > 0.99) return colour;
  }
  return [255, 255, 255];
};
let lowest = [99, ''];
for (const element of document.querySelectorAll('#panel *, #foot *')) {
  const own = [...element.childNodes].some((node) => node.nodeType === 3 && node.textContent.trim());
  if (!own || element.disabled || element.getBoundingClientRect().width === 0) continue;
  const [a, b] = [light(channels(getComputedStyle(element).color)), light(behind(element))].sort((x, y) => y - x);
  const ratio = (a + 0.05) / (b + 0.05);
  if (ratio < lowest[0]) lowest = [ratio, `${element.className} '${element.textContent.slice(0, 30)}'`];
}
return lowest;
"""
LEAST_CONTRAST = 4.5  # of texts of this size, WCAG 2 level AA


class Pages(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory(prefix="kiloband-viewer-")
        cls.cube = pathlib.Path(cls.folder.name) / "cornell_box.hdr"
        kiloband("render", BOX, "-D", "res=160", "-D", "bands=400:700:60", "--spp", 32, "--variance", "-o", cls.cube, "--quiet")
        cls.viewer = Viewer(cls.cube, "--output-dir", cls.folder.name)
        cls.browser = Browser()

    @classmethod
    def tearDownClass(cls):
        cls.browser.close()
        status = cls.viewer.stop()
        cls.folder.cleanup()
        assert status == 0, f"kiloband view has ended with {status}"

    def pin_some(self):
        self.browser.value(
            """const {pin} = await import('/pins.js');
            const {set} = await import('/state.js');
            for (const select of [[40, 120], [120, 110], [20, 60, 40, 90], [80, 3]]) pin(select);
            set({hover: [70, 140]});""")
        self.browser.wait("return state.curves.length === 5 && state.drawn", "five curves")

    def assert_tidy(self, what):
        self.browser.wait("await new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))); return true", what)
        self.assertEqual(self.browser.driver.execute_script(MISFITS), [], what)
        ratio, where = self.browser.driver.execute_script(CONTRAST)
        self.assertGreaterEqual(ratio, LEAST_CONTRAST, f"{what}: {where}")

    def look_at_everything(self, name):
        for mode in self.browser.value("return state.scene.modes"):
            self.browser.value("const {set_mode} = await import('/display.js'); set_mode(given);", mode)
            self.browser.wait("return state.frame.mode === given", mode, mode)
            self.assert_tidy(f"{name} {mode}")
            self.browser.screenshot(f"{name}_{mode}")
        for tab in self.browser.value("return [...document.querySelectorAll('#tabs button')].map((b) => b.id.slice(4))"):
            self.browser.value("const {open_tab} = await import('/tabs.js'); open_tab(given);", tab)
            self.assert_tidy(f"{name} tab {tab}")
        self.browser.press("?")
        self.assert_tidy(f"{name} help")
        self.browser.screenshot(f"{name}_help")
        self.browser.press("?")

    def test_looks(self):
        for name, (width, height) in SIZES.items():
            for dark in (False, True) if width < 3840 else (False,):  # colours are the same on every screen
                self.browser.resize(width, height)
                self.browser.colour_scheme(dark)
                self.browser.open(self.viewer.address)
                self.pin_some()
                self.look_at_everything(f"{name}_{'dark' if dark else 'light'}")

    def test_the_image_has_most_of_the_window(self):
        for width, height in SIZES.values():
            self.browser.resize(width, height)
            self.browser.open(self.viewer.address)
            box = self.browser.value("const {width, height} = document.getElementById('image').getBoundingClientRect(); return [width, height]")
            self.assertGreaterEqual(box[0] / width, 0.65)
            self.assertGreaterEqual(box[1] / height, 0.95)

    def test_a_narrow_window(self):
        """As of a telephone: the image is as wide as the window, above the panel."""
        self.browser.resize(360, 640)
        self.addCleanup(self.browser.resize, 1280, 800)
        self.browser.open(self.viewer.address)
        self.pin_some()
        width, height, bottom, top = self.browser.value("""
            const [image, panel] = ['image', 'panel'].map((id) => document.getElementById(id).getBoundingClientRect());
            return [image.width, image.height, image.bottom, panel.top];""")
        self.assertEqual(width, 360)
        self.assertGreaterEqual(height, 0.4 * 640)
        self.assertLessEqual(bottom, top)
        self.look_at_everything("360x640")
        self.assertEqual(self.browser.complaints(), [])

    def test_two_pages_look_at_different_things(self):
        second = Browser()
        try:
            self.browser.open(self.viewer.address)
            second.open(self.viewer.address)
            second.choose("channel")
            self.assertEqual(self.browser.value("return state.frame.mode"), "color")
            second.wait("return state.status.clients === 2", "two pages in the status")
            self.assertIn("2 pages", " ".join(second.texts("#status span")))
        finally:
            second.close()
        self.browser.wait("return state.status.clients === 1", "one page in the status")

    def test_two_windows_of_one_browser(self):
        self.browser.open(self.viewer.address)
        first = self.browser.driver.current_window_handle
        self.browser.driver.switch_to.new_window("window")
        try:
            self.browser.open(self.viewer.address)
            self.browser.choose("false")
        finally:
            self.browser.driver.close()
            self.browser.driver.switch_to.window(first)
        self.browser.choose("channel")

    def test_closed_and_opened_again(self):
        self.browser.open(self.viewer.address)
        self.browser.press("4", "l")
        self.browser.click(40, 120)
        self.browser.wait("return state.curves.length === 1", "a pinned spectrum")
        kept = "return Object.keys(localStorage).some((key) => localStorage.getItem(key).includes('[40,120]'))"
        self.browser.wait(kept, "the browser's memory")
        self.browser.driver.get("about:blank")
        self.browser.open(self.viewer.address, forget=False)
        self.browser.wait("return state.frame.mode === 'error' && state.curves.length === 1", "the page as it was")
        self.assertEqual(self.browser.value("return [state.pins[0].key, state.plot.log_y]"), ["40,120", True])
        self.assertEqual(self.browser.complaints(), [])

    def test_requests_that_fail_around_an_absence(self):
        """The page has told of the absence: only a request that fails while the server is there is told of."""
        self.browser.open(self.viewer.address)
        self.browser.wait("return state.connected", "the page has found the server")
        self.browser.value("""
            const {show_error} = await import('/api.js'), {set} = await import('/state.js');
            set({connected: false});
            show_error(new TypeError('while it was away'));
            set({connected: true});
            show_error(new TypeError('while it was there'));
            return true""")
        self.browser.wait("return document.querySelectorAll('.notice').length > 0", "a notice")
        self.assertEqual([text.split("\n")[0] for text in self.browser.texts(".notice")],
                         ["The request failed: while it was there"])

    def test_a_server_that_comes_back(self):
        viewer = Viewer(self.cube)
        address = viewer.address
        try:
            self.browser.open(address)
            self.assertEqual(viewer.stop(), 0)
            wait_until(lambda: self.browser.find("#offline").is_displayed(), "word of the server's absence")
            viewer = Viewer(self.cube, "--token", "random", port=viewer.port)
            wait_until(lambda: "needs its token" in self.browser.find("#offline").text, "the server's own words")
            self.assertEqual(viewer.stop(), 0)
            wait_until(lambda: "does not answer" in self.browser.find("#offline").text, "word of the server's absence")
            viewer = Viewer(self.cube, port=viewer.port)
            self.browser.wait("return state.connected", "the page has found the server")
            self.browser.choose("channel")
            self.assertFalse(self.browser.find("#offline").is_displayed())
            self.browser.press(Keys.ARROW_LEFT)
            self.assertEqual(viewer.stop(), 0)
            write_cube(self.cube.with_name("small.hdr"), [(500, 510), (600, 610)], lambda x, y, k: 1 + x)
            viewer = Viewer(self.cube.with_name("small.hdr"), port=viewer.port)
            self.browser.wait("return state.scene.width === 8 && state.frame.full_width === 8", "a smaller image")
            self.assertIsNone(self.browser.value("return state.hover"), "a cursor that is outside")
            self.assertEqual(self.browser.texts(".notice"), [])
        finally:
            viewer.stop()
        self.browser.driver.get("about:blank")
        self.browser.noted_errors()  # refused connections


if __name__ == "__main__":
    unittest.main()
