"""Cubes that no render has written: bands in any order, with gaps, without values, and responses of sensors."""
import array
import pathlib
import tempfile
import unittest

from browser import Browser, Keys
from program import BOX, Viewer, kiloband

WIDTH, HEIGHT = 8, 6
# (x, y) of all drawn values of the first curve, by its rows.
DRAWN = """
const {the_graph} = await import('/plot.js');
const graph = the_graph();
if (!graph || document.getElementById('plot').classList.contains('empty') || !Array.isArray(graph.getValue(0, 1) ?? graph.getValue(0, 2)))
  return null;
return Array.from({length: graph.numRows()}, (_, row) => {
  const columns = [1, 2].map((column) => column < graph.numColumns() && graph.getValue(row, column));
  return [graph.getValue(row, 0), ...columns.map((bars) => Array.isArray(bars) ? bars[1] : null)];
});"""


def write_cube(header, bands, value_of, extra=""):
    """bands: [(lowest, highest)] in nm, or names of bands without wavelengths; value_of(x, y, band): densities."""
    def numbers(values):
        return "{" + ", ".join(map(str, values)) + "}"
    if isinstance(bands[0], str):
        places = f"band names = {numbers(bands)}\n"
    else:
        places = (f"wavelength units = Nanometers\nwavelength = {numbers((low + high) / 2 for low, high in bands)}\n"
                  f"fwhm = {numbers(high - low for low, high in bands)}\n")
    header.write_text(
        f"ENVI\nsamples = {WIDTH}\nlines = {HEIGHT}\nbands = {len(bands)}\nheader offset = 0\nfile type = ENVI Standard\n"
        f"data type = 4\ninterleave = bsq\nbyte order = 0\n{places}{extra}")
    values = array.array("f", (value_of(x, y, k) for k in range(len(bands)) for y in range(HEIGHT) for x in range(WIDTH)))
    header.with_suffix(".img").write_bytes(values.tobytes())


class OtherCubes(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory(prefix="kiloband-viewer-")
        cls.addClassCleanup(folder.cleanup)
        cls.path = pathlib.Path(folder.name)
        cls.browser = Browser()
        cls.addClassCleanup(cls.browser.close)

    def open(self, file):
        viewer = Viewer(file)
        self.addCleanup(lambda: self.assertEqual(viewer.stop(), 0))
        self.addCleanup(self.browser.driver.get, "about:blank")
        self.browser.open(viewer.address)

    def pin_and_draw(self):
        self.browser.value("const {pin} = await import('/pins.js'); pin([3, 2]);")
        return self.browser.wait(DRAWN, "the drawn curve")

    def show(self, mode):
        self.browser.choose(mode)
        self.assertEqual(self.browser.complaints(), [])

    def channel_texts(self):
        """Of the slider and of the legend."""
        legend = self.browser.wait("return document.getElementById('legend-channel').textContent", "the legend")
        return [self.browser.find("#tab .amount.channel").text, legend.removeprefix("at ")]

    def test_bands_in_any_order(self):
        """The plot has all of them, along rising wavelengths; what it points at is the band of the file."""
        orders = {"descending": [(k, k + 20) for k in range(880, 380, -20)],
                  "mixed": [(845, 875), (475, 505), (545, 575), (645, 675), (1560, 1640), (2150, 2250)]}
        for name, bands in orders.items():
            with self.subTest(name):
                write_cube(self.path / f"{name}.hdr", bands, lambda x, y, k: bands[k][0] + x)
                self.open(self.path / f"{name}.hdr")
                drawn = self.pin_and_draw()
                self.browser.screenshot(f"order_{name}")
                self.assertEqual([row[0] for row in drawn], sorted((low + high) / 2 for low, high in bands))
                self.assertEqual([row[1] for row in drawn], sorted(low + 3 for low, high in bands))
                low, high = self.browser.value("return (await import('/plot.js')).the_graph().xAxisRange()")
                self.assertLessEqual(low, drawn[0][0])
                self.assertGreaterEqual(high, drawn[-1][0])
                pointed = self.browser.value("""
                    const {the_graph} = await import('/plot.js');
                    the_graph().getFunctionOption('highlightCallback')({}, 0, [], 0);
                    return state.pointed;""")
                self.assertEqual(pointed, min(range(len(bands)), key=lambda k: bands[k]))
                self.show("false")

    def test_false_colour_of_bands_with_a_gap(self):
        """Its ranges are thirds of the bands, so that each has some."""
        bands = [(450, 520), (520, 600), (630, 690), (10000, 10400), (10500, 10900), (11000, 11400)]
        write_cube(self.path / "gap.hdr", bands, lambda x, y, k: 1 + x)
        self.open(self.path / "gap.hdr")
        self.show("false")
        self.assertEqual(self.browser.value("return (await import('/state.js')).default_ranges()"),
                         {"r": [10500, 11400], "g": [630, 10400], "b": [450, 600]})

    def test_bands_without_values(self):
        """A dead band, as the header's `data ignore value` makes one, is missing; all others are there."""
        bands = [(k, k + 20) for k in range(400, 1000, 20)]
        nothing = float("nan")
        for dead, modes in {0: ["channel"], 27: ["color", "false", "channel"]}.items():
            with self.subTest(dead=dead):
                write_cube(self.path / "dead.hdr", bands, lambda x, y, k: nothing if k == dead else 1 + k + x + y)
                self.open(self.path / "dead.hdr")
                drawn = self.pin_and_draw()
                self.assertEqual([row[1] for row in drawn], [None if k == dead else 1 + k + 5 for k in range(30)])
                for mode in modes:
                    self.browser.value("const {set_view} = await import('/state.js'); set_view({ranges: {r: [600, 700], g: [500, 600], b: [420, 500]}})")
                    self.show(mode)
                    values = self.browser.value("""
                        const {frame_parameters} = await import('/state.js');
                        const query = new URLSearchParams({...frame_parameters(), x0: 0, y0: 0, x1: 7, y1: 5});
                        return (await (await fetch(`/api/values?${query}`)).json()).values;""")
                    self.assertNotIn(None, values, mode)
                self.browser.screenshot(f"dead_{dead}")

    def test_bands_without_wavelengths(self):
        """A logarithmic axis of wavelengths has no place for them: there is none, whatever was chosen for another cube."""
        write_cube(self.path / "named.hdr", ["Red", "NIR (far)", "Elevation"], lambda x, y, k: 10 * (k + 1) + x)
        self.open(self.path / "named.hdr")
        self.pin_and_draw()
        self.browser.press("L")
        self.browser.wait("return state.plot.log_x", "the key's choice")
        drawn = self.browser.wait(DRAWN, "the drawn curve")
        self.assertEqual([row[2] for row in drawn], [13, 23, 33])
        self.assertFalse(self.browser.find("#plot-log-x").is_enabled())
        self.assertEqual(self.browser.value("return (await import('/format.js')).log_ticks(0, 5)"), [0, 2, 4])
        self.assertEqual(self.channel_texts(), ["NIR (far)"] * 2)
        self.browser.press("]")
        self.browser.wait("return state.frame.parameters.channel === '2' && state.drawn", "the next band")
        self.assertEqual(self.channel_texts(), ["Elevation"] * 2)
        self.browser.screenshot("named")
        self.assertEqual(self.browser.complaints(), [])

    def test_what_would_be_refused_is_not_asked_for(self):
        """Temperatures of responses, what was remembered of other channels, a logarithm's bounds below 0; else once."""
        spectral = [1, 0, 0, 1, 0]
        write_cube(self.path / "warm.hdr", [(8000 + 1000 * k, 8900 + 1000 * k) for k in range(5)], lambda x, y, k: 1e-3 * (1 + x),
                   "kiloband band minimum = {8000, 9000, 10000, 11000, 12000}\n"
                   "kiloband band maximum = {8900, 9900, 10900, 11900, 12900}\n"
                   "kiloband own names = {, a, b, , c}\n"
                   f"kiloband derived bands = {{{', '.join(str(1 - one) for one in spectral)}}}\n")
        self.open(self.path / "warm.hdr")
        self.assertEqual(self.browser.value("return state.scene.channels.map(({derived}) => derived ? 0 : 1)"), spectral)
        self.assertEqual(self.browser.value("return [state.view.mode, state.view.channel]"), ["temperature", 3])
        for key, channel in [("]", "3"), ("[", "0"), ("[", "0"), ("]", "3")]:
            self.browser.press(key)
            self.browser.wait("return state.frame.parameters.channel === given", "the next channel with a temperature", channel)
        self.show("channel")
        self.browser.value("const {set_view} = await import('/state.js'); set_view({low: '-1'});")
        self.browser.press("k")
        self.browser.wait("return state.frame.parameters.scale === 'log' && state.frame.low > 0", "a logarithmic scale")
        self.assertEqual(self.browser.value("return state.view.low"), "")
        self.browser.value("""
            const {memory_key} = await import('/adapt.js');
            const ranges = {r: [600, 700], g: [500, 600], b: [400, 500]};
            await new Promise((done) => setTimeout(done, 400));  // until the page has kept its own
            localStorage.setItem(memory_key(state.scene), JSON.stringify({view: {...state.view, mode: 'false', ranges, channel: 99}}));""")
        self.browser.open(self.browser.driver.current_url, forget=False)
        self.assertEqual(self.browser.value("return [state.frame.mode, state.view.channel, state.view.ranges]"), ["false", 2, None])
        self.assertEqual(self.browser.complaints(), [])
        asked = self.browser.value("""
            const {set_view} = await import('/state.js'), asked = [], {fetch} = window;
            window.fetch = (path, ...rest) => (asked.push(path), fetch(path, ...rest));
            set_view({ranges: {r: [600, 700], g: [500, 600], b: [400, 500]}});
            await new Promise((done) => setTimeout(done, 1300));
            window.fetch = fetch;
            return asked.filter((path) => path.startsWith('/api/frame'));""")
        self.assertEqual(len(asked), 1, asked)
        self.assertIn("overlaps no channel", self.browser.texts(".notice.error")[0])
        self.browser.noted_errors()  # Chromium notes the refused request
        self.browser.press(Keys.ESCAPE)
        self.show("channel")

    def test_responses_are_points_in_units_of_their_own(self):
        (self.path / "red.csv").write_text("wavelength_nm,red,blue\n400,0,1\n500,0,0.5\n600,1,0\n700,0.5,0\n")
        kiloband("render", BOX, "-D", "res=16", "-D", "bands=400:700:6", "--spp", 4, "-o", self.path / "box.exr", "--quiet")
        kiloband("sensor", self.path / "box.exr", "--response", self.path / "red.csv", "-o", self.path / "seen.exr")
        self.open(self.path / "seen.exr")
        drawn = self.pin_and_draw()
        self.browser.screenshot("responses")
        self.assertEqual([row[1] for row in drawn], [None] * 2, "no line of channels")
        self.assertNotIn(None, [row[2] for row in drawn])
        self.show("channel")
        self.assertEqual(self.channel_texts(), ["blue (466.67 nm)"] * 2)
        self.assertNotIn("nm⁻¹", self.browser.find("#legend-channel").text + self.browser.find("#plot-y").text)


if __name__ == "__main__":
    unittest.main()
