"""A stored cube in the browser: every mode, spectra against the file, pins, exports, saving; nothing that only a render has."""
import array
import csv
import math
import pathlib
import tempfile
import unittest

from browser import ActionChains, Browser, Keys
from program import BOX, Cube, Viewer, kiloband, wait_until

CHANNELS = 16
SIZE = 48


class StoredCube(unittest.TestCase):
    browser_type = Browser

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory(prefix="kiloband-viewer-")
        cls.path = pathlib.Path(cls.folder.name)
        kiloband("render", BOX, "-D", f"res={SIZE}", "-D", f"bands=400:700:{CHANNELS}", "--spp", 32, "--variance",
                 "-o", cls.path / "box.hdr", "--quiet")
        cls.cube = Cube(cls.path / "box.hdr")
        cls.variances = array.array("f", (cls.path / "box.var.img").read_bytes())
        cls.saved = cls.path / "saved"
        cls.saved.mkdir()
        cls.viewer = Viewer(cls.path / "box.hdr", "--output-dir", cls.saved)
        cls.browser = cls.browser_type(downloads=cls.path)

    @classmethod
    def tearDownClass(cls):
        cls.browser.close()
        status = cls.viewer.stop()
        cls.folder.cleanup()
        assert status == 0, f"kiloband view has ended with {status}"

    def setUp(self):
        self.browser.open(self.viewer.address)

    def tearDown(self):
        self.assertEqual(self.browser.complaints(), [])

    def wait_for_mode(self, mode):
        self.browser.wait("return state.frame.mode === given", f"a frame of {mode}", mode)

    def curve(self, key):
        return self.browser.wait("return state.curves.find((curve) => curve.select === given)", f"curve {key}", key)

    def assert_spectrum(self, shown, expected):
        self.assertEqual(len(shown), len(expected))
        for value, true in zip(shown, expected):
            self.assertAlmostEqual(value, true, delta=2e-6 * max(expected) + 1e-12)

    def standard_errors(self, x, y):
        cube = self.cube
        return [math.sqrt(self.variances[(band * SIZE + y) * SIZE + x]) / (cube.high[band] - cube.low[band])
                for band in range(CHANNELS)]

    def test_only_what_applies_is_there(self):
        self.assertEqual(self.browser.texts("#tabs button"), ["Image", "Save"])
        self.assertFalse(self.browser.find("#tools .choice").is_displayed())
        self.assertEqual(self.browser.texts("#status .state"), ["Stored cube"])
        self.assertNotIn("temperature", self.browser.value("return state.scene.modes"))

    def test_every_mode_has_a_picture_of_its_own(self):
        modes = self.browser.value("return state.scene.modes")
        self.assertEqual(modes[:1], ["color"])
        pictures = {}
        for mode in modes:
            self.browser.choose(mode)
            scalar = self.browser.value("return state.frame.low !== undefined && state.frame.low !== null")
            self.assertEqual(self.browser.find("#colorbar").is_displayed(), scalar, mode)
            pictures[mode] = self.browser.picture()
        self.assertEqual(len(set(pictures.values())), len(modes), pictures)

    def test_a_camera_s_response_becomes_a_mode(self):
        table = self.path / "camera.csv"
        table.write_text("wavelength_nm,red,green,blue\n400,0,0,1\n500,0,1,1\n600,1,1,0\n700,1,0,0\n")
        self.browser.find("#tab input[type=file]").send_keys(str(table))
        self.wait_for_mode("response:camera")
        self.assertIn("camera", self.browser.texts("#tab .modes button"))
        self.assertEqual(self.browser.find("#tab .modes [aria-checked=true]").text, "camera")

    def test_a_click_plots_the_pixel_of_the_file(self):
        for x, y in [(10, 40), (SIZE - 1, 0)]:
            self.browser.click(x, y)
            shown = self.curve(f"{x},{y}")
            self.assert_spectrum(shown["mean"], self.cube.spectrum(x, y))
            self.assert_spectrum(shown["standard_error"], self.standard_errors(x, y))
        plotted = self.browser.wait(
            """const {the_graph, curves_shown} = await import('/plot.js');
            const column = 1 + curves_shown().findIndex(({selection}) => selection.key === given);
            const graph = the_graph();
            if (column === 0 || !Array.isArray(graph.getValue(0, column))) return null;
            return Array.from({length: graph.numRows()},
                              (_, row) => [graph.getValue(row, 0), ...graph.getValue(row, column)]);""", "the drawn curve", "10,40")
        shown = self.curve("10,40")
        for row, (nm, low, mean, high) in enumerate(plotted):
            self.assertAlmostEqual(nm, (self.cube.low[row] + self.cube.high[row]) / 2, places=6)
            self.assertAlmostEqual(mean, self.cube.at(10, 40, row), delta=2e-6 * abs(mean))
            self.assertAlmostEqual(high - low, 2 * shown["standard_error"][row], delta=1e-6 * mean)

    def test_a_rectangle_is_the_mean_of_its_pixels(self):
        self.browser.drag((12, 30), (20, 34), holding=Keys.SHIFT)
        shown = self.curve("12,30,20,34")
        self.assertEqual(shown["pixels"], 45)
        self.assert_spectrum(shown["mean"], self.cube.mean(12, 30, 20, 34))
        wait_until(lambda: "(45 px)" in " ".join(self.browser.texts("#legend .place")), "the legend's row")
        self.assertIsNone(shown["standard_error"], "what the pixels' errors have in common is not known")
        self.browser.click(5, 5)
        self.curve("5,5")
        self.browser.wait("return document.getElementById('plot-band').textContent === given", "the legend's words",
                          "Bands: ± 1 standard error (of pixels)")
        self.browser.screenshot("rectangle")

    def test_the_keyboard_pins_and_unpins(self):
        self.browser.press(Keys.ARROW_LEFT, Keys.ARROW_LEFT, Keys.ENTER)
        middle = SIZE // 2
        self.assertEqual(self.browser.value("return state.pins.map((pin) => pin.key)"), [f"{middle - 2},{middle}"])
        self.browser.press("r", Keys.ARROW_RIGHT, Keys.ARROW_DOWN, Keys.ENTER)
        self.assertEqual(self.browser.value("return state.pins[1].select"), [middle - 2, middle, middle - 1, middle + 1])
        self.browser.press(Keys.DELETE)
        self.assertEqual(self.browser.value("return state.pins.length"), 1)

    def test_a_channel_is_painted_by_the_map_between_the_bounds(self):
        self.browser.choose("channel")
        high = max(self.cube.at(x, y, 9) for x in range(SIZE) for y in range(SIZE)) / 4
        self.browser.value(
            """const {set_view} = await import('/state.js');
            set_view({channel: 9, low: '0', high: String(given), map: 'cividis', grid: false, scale: 'linear'});""", high)
        self.browser.wait("return state.frame.parameters.channel === '9' && state.frame.parameters.map === 'cividis'", "channel 9")
        colours = self.browser.value("return (await (await fetch('/api/colormap?map=cividis')).json()).colors")
        self.browser.value("const {set} = await import('/state.js'); set({hover: null});")
        for x, y in [(5, 5), (24, 40), (30, 20), (44, 30)]:
            index = min(255, int(255 * self.cube.at(x, y, 9) / high + 0.5))
            near = [colours[i] for i in range(max(0, index - 1), min(255, index + 1) + 1)]
            shown = "#" + "".join(f"{part:02x}" for part in self.browser.colour_at(x, y))
            self.assertIn(shown, near, f"pixel {x}, {y}")

    def test_a_click_in_the_plot_shows_that_channel(self):
        self.browser.click(24, 40)
        self.curve("24,40")
        self.browser.wait("const {the_graph} = await import('/plot.js'); return the_graph().numRows() > 1", "the plot")
        offset = self.browser.value(
            """const {the_graph} = await import('/plot.js');
            const box = document.getElementById('plot').getBoundingClientRect();
            return Math.round(the_graph().toDomXCoord(given) - box.width / 2);""",
            (self.cube.low[3] + self.cube.high[3]) / 2)
        chain = ActionChains(self.browser.driver, duration=0)
        chain.move_to_element_with_offset(self.browser.find("#plot"), offset, 0).click().perform()
        self.browser.wait("return state.frame.mode === 'channel' && state.frame.parameters.channel === '3'", "channel 3")

    def test_axes_change(self):
        self.browser.click(24, 40)
        self.curve("24,40")
        for key, title in [("l", "nm"), ("u", "µm")]:
            self.browser.press(key)
            wait_until(lambda: title in self.browser.find("#plot-x").text, f"axis in {title}")
        self.assertIn("W m⁻² sr⁻¹ nm⁻¹", self.browser.find("#plot-y").text)
        self.assertTrue(self.browser.value("return state.plot.log_y"))
        self.assertGreater(len(self.browser.texts("#plot .dygraph-axis-label-y")), 1)

    def test_pixel_values_at_high_zoom(self):
        self.browser.choose("channel")
        self.browser.value("const {zoom} = await import('/image.js'); zoom(12);")
        self.browser.wait("return state.values", "values of pixels")

    def test_errors_in_pixels_are_per_cent(self):
        """As those of the colour bar and of the range are."""
        self.browser.choose("error")
        self.browser.value("const {zoom} = await import('/image.js'); zoom(12);")
        self.browser.wait("return state.values", "values of pixels")
        texts, expected = self.browser.value("""
            const drawn = [];
            const draw = CanvasRenderingContext2D.prototype.fillText;
            CanvasRenderingContext2D.prototype.fillText = function(text, ...rest) {
              if (this.canvas.id === 'image') drawn.push(text);
              return draw.call(this, text, ...rest);
            };
            const {redraw} = await import('/image.js');
            redraw();
            await new Promise((done) => setTimeout(done, 500));
            CanvasRenderingContext2D.prototype.fillText = draw;
            const {x, y} = {x: 24, y: 24};
            const answer = await fetch(`/api/values?mode=error&x0=${x}&y0=${y}&x1=${x}&y1=${y}`);
            return [drawn, (await answer.json()).values[0]];""")
        self.browser.screenshot("error_values")
        numbers = [float(text.removesuffix(" %")) for text in texts if text.endswith(" %")]
        self.assertGreater(len(numbers), 10, texts)
        self.assertLess(min(abs(number - 100 * expected) for number in numbers), 0.006 * 100 * expected)

    def test_csv_has_the_curves(self):
        self.browser.click(10, 40)
        self.curve("10,40")
        wait_until(self.browser.find("#export-csv").is_displayed, "the button")
        self.browser.find("#export-csv").click()
        file = self.path / "box_spectra.csv"
        wait_until(lambda: file.exists() and file.stat().st_size > 0, "the CSV file")
        rows = [row for row in csv.reader(file.read_text().splitlines()) if row and not row[0].startswith("#")]
        numbers = [[float(field) for field in row] for row in rows if row[0][:1].isdigit()]
        self.assertEqual(len(numbers), CHANNELS)
        for band, row in enumerate(numbers):
            self.assertTrue(any(abs(v - self.cube.at(10, 40, band)) <= 2e-6 * v for v in row), row)
        self.browser.find("#export-png").click()
        picture = self.path / "box_spectra.png"
        wait_until(lambda: picture.exists() and picture.stat().st_size > 1000, "the plot as a picture")

    def test_saving(self):
        self.browser.press("s", holding=Keys.CONTROL)
        name = self.browser.find("#tab input[type=text]")
        name.clear()
        name.send_keys("copy")
        self.browser.find("#tab [data-value=envi]").click()
        self.browser.find("#tab .primary").click()
        wait_until(lambda: any("copy.hdr" in text for text in self.browser.texts(".files li")), "the saved file")
        self.assertEqual(list(Cube(self.saved / "copy.hdr").values), list(self.cube.values))

    def test_enter_again_while_a_file_is_saved(self):
        self.browser.press("s", holding=Keys.CONTROL)
        self.browser.find("#tab [data-value=exr]").click()
        self.browser.value("""
            const {set} = await import('/state.js');
            set({saved: []});
            const field = document.querySelector('#tab input[type=text]');
            field.value = 'twice';
            for (let i = 0; i < 3; ++i) field.dispatchEvent(new KeyboardEvent('keydown', {key: 'Enter', bubbles: true}));""")
        self.browser.wait("return state.saved.length > 0 && !document.querySelector('#tab .primary').disabled", "the saved file")
        self.assertEqual(self.browser.value("return state.saved"), ["twice.exr"])

    def test_the_server_s_errors_are_shown(self):
        self.browser.value("const {post} = await import('/api.js'); await post('/api/save', {format: 'exr', name: '../x'});")
        shown = self.browser.texts(".notice.error")
        self.assertEqual(len(shown), 1)
        self.assertIn("../x", shown[0])
        self.browser.press(Keys.ESCAPE)
        self.assertEqual(self.browser.texts(".notice.error"), [])
        self.browser.noted_errors()  # Chromium notes the refused request


if __name__ == "__main__":
    unittest.main()
