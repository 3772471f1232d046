"""A scene that is rendered while it is looked at: refinement, camera, materials, settings, pausing, saving."""
import os
import unittest

from browser import ActionChains, Keys
from program import wait_until
from rendered_page import CHANNELS, RenderedPage


class Render(RenderedPage):
    def test_refines(self):
        first, before = self.browser.value("return [state.frame.frame, state.frame.samples]")
        self.wait_for_samples(before + 5)
        self.assertGreater(self.browser.value("return state.frame.frame"), first)
        self.assertEqual(self.browser.texts("#status .state"), ["Rendering"])
        self.browser.wait("return state.status.error > 0", "an error, from the second replicate on")
        shown = lambda: " ".join(self.browser.texts("#status span"))
        for part in ("samples per pixel", "paths/s", "frames/s", "error"):
            wait_until(lambda: part in shown(), f"{part} in the status line")

    def test_the_plot_holds_what_is_saved(self):
        self.browser.click(20, 50)
        self.browser.click(50, 30)
        self.browser.drag((10, 40), (14, 44), holding=Keys.SHIFT)
        self.wait_for_samples(16)
        self.pause()
        shown = {(x, y): self.spectrum(x, y)["mean"] for x, y in [(20, 50), (50, 30)]}
        region = self.browser.wait("return state.curves.find((curve) => curve.select === '10,40,14,44')", "the rectangle's spectrum")
        cube = self.save("seen")
        for (x, y), values in shown.items():
            for band in range(CHANNELS):
                self.assertAlmostEqual(values[band], cube.at(x, y, band), delta=2e-6 * max(values))
        self.assertEqual(region["pixels"], 25)
        for value, true in zip(region["mean"], cube.mean(10, 40, 14, 44)):
            self.assertAlmostEqual(value, true, delta=2e-6 * max(region["mean"]))

    def test_modes_do_not_restart(self):
        revision, samples = self.revision(), self.samples()
        pictures = set()
        modes = self.browser.value("return state.scene.modes")
        for mode in modes:
            self.browser.choose(mode)
            pictures.add(self.browser.picture())
        self.assertEqual(len(pictures), len(modes))
        self.assertEqual(self.revision(), revision)
        self.assertGreaterEqual(self.samples(), samples)

    def test_orbit_restarts_and_reset_returns(self):
        self.wait_for_samples(8)
        self.pause()
        before, revision = self.browser.picture(), self.revision()
        start = self.browser.value("return state.scene.camera.origin")
        self.browser.press(Keys.SPACE, "o")
        self.browser.drag_away(120, 40)
        self.wait_for_revision_after(revision)
        self.wait_for_samples(1)
        moved = self.browser.wait("return state.scene.camera.origin[0] !== given[0] && state.scene.camera.origin", "the moved camera", start)
        self.assertNotEqual(moved, start)
        self.assertNotEqual(self.browser.picture(), before)
        distance = lambda point, pivot: sum((a - b) ** 2 for a, b in zip(point, pivot)) ** 0.5
        pivot = self.browser.value("return state.scene.camera.pivot")
        self.assertAlmostEqual(distance(moved, pivot), distance(start, pivot), delta=1e-4)
        self.browser.press(Keys.HOME)
        self.browser.wait("return String(state.scene.camera.origin) === String(given)", "the camera of the scene file", start)

    def test_keys_fly(self):
        start = self.browser.value("return state.scene.camera.origin")
        ActionChains(self.browser.driver).key_down("w").perform()
        try:
            self.browser.wait("return Math.hypot(...state.camera.origin.map((v, i) => v - given[i])) > 0.05", "flying", start)
        finally:
            ActionChains(self.browser.driver).key_up("w").perform()
        self.browser.wait("return String(state.scene.camera.origin) === String(state.camera.origin)", "the server's camera")
        x, y, z = (a - b for a, b in zip(self.browser.value("return state.camera.origin"), start))
        self.assertAlmostEqual(abs(x) + abs(y), 0, delta=1e-6)
        self.assertGreater(z, 0.05)

    def test_an_edited_reflectance_restarts(self):
        self.browser.click(32, 58)
        self.wait_for_samples(16)
        before = self.browser.wait("return state.curves[0]", "the floor's spectrum")["mean"]
        revision = self.revision()
        self.open_tab("scene")
        white = next(s["id"] for s in self.browser.value("return state.scene.spectra") if "white" in s["owner"])
        self.browser.find(f"[data-spectrum={white}]").click()
        field = self.browser.find(".editor input.number")
        field.send_keys("0.05", Keys.ENTER)
        self.wait_for_revision_after(revision)
        self.wait_for_samples(16)
        after = self.browser.wait("return state.curves_of.revision > given && state.curves[0]", "the dark floor's", revision)["mean"]
        self.assertLess(sum(after), 0.3 * sum(before))
        self.browser.find(".editor .alone button").click()
        self.browser.wait("return !Object.values(state.edited).some(Boolean)", "the scene file's reflectance")

    def test_other_channels(self):
        """Until the page has read of them it asks for what there is no more, as it tells nobody."""
        self.browser.choose("channel")
        self.browser.click(30, 40)
        self.browser.value("""
            const {set_view} = await import('/state.js'), {fetch} = window;
            set_view({channel: given});
            window.fetch = async (path, ...rest) => {
              if (path === '/api/scene') await new Promise((done) => setTimeout(done, 400));
              return fetch(path, ...rest);
            };""", CHANNELS - 1)
        self.browser.wait("return state.frame.parameters.channel === String(given)", "the last channel", CHANNELS - 1)
        revision = self.revision()
        self.open_tab("render")
        fields = self.browser.driver.find_elements("css selector", "#tab input.number")
        fields[2].clear()
        fields[2].send_keys("8", Keys.ENTER)
        self.wait_for_revision_after(revision)
        self.browser.wait("return state.scene.channels.length === 8 && state.frame.samples > 0", "eight channels")
        self.browser.click(20, 50)
        self.browser.wait("return state.curves.length && state.curves[0].mean.length === 8", "a curve of eight")
        revision = self.revision()
        self.browser.value("const {post} = await import('/api.js'); await post('/api/settings', {bands: given});", f"400:700:{CHANNELS}")
        self.wait_for_revision_after(revision)
        self.browser.wait("return state.scene.channels.length === given", "all channels", CHANNELS)
        self.assertEqual(self.browser.texts(".notice"), [])
        self.browser.noted_errors()  # Chromium notes what was refused

    def test_other_backends_show_the_same(self):
        """The page's choice of a device and each of its methods; the status says which."""
        self.browser.drag((10, 52), (40, 60), holding=Keys.SHIFT)
        self.open_tab("render")
        before, sums = self.settings(), {}
        devices = [option.text for option in self.browser.find_all("#tab select option")]
        opencl = next(str(i) for i, text in enumerate(devices) if text.startswith("OpenCL: "))
        for method in ("dpept-batch", "dpept-path", "pt") if "KILOBAND_THOROUGH" in os.environ else ("dpept-batch", "pt"):
            revision = self.revision()
            if self.settings()["backend"] == "cpu":
                self.browser.choose_option("#tab select", opencl)
            else:
                self.browser.choose_option("#tab select", method, which=1)
            self.wait_for_revision_after(revision)
            self.wait_for_samples(64)
            self.assertEqual([self.settings()[name] for name in ("backend", "method")], ["opencl", method])
            self.assertEqual(self.browser.texts("#status .backend"), [f"OpenCL, {method}"])
            line = self.browser.value("const {scrollWidth, clientWidth} = document.getElementById('status'); return [scrollWidth, clientWidth]")
            self.assertLessEqual(*line)
            self.browser.screenshot(f"backend_{method}")
            sums[method] = self.floor_after(revision)
        revision = self.revision()
        self.browser.choose_option("#tab select", "0")
        self.wait_for_revision_after(revision)
        self.wait_for_samples(64)
        self.assertEqual(self.settings(), before)
        self.assertEqual(self.browser.texts("#status .backend"), ["CPU"])
        for method, value in sums.items():
            self.assertAlmostEqual(value, self.floor_after(revision), delta=0.1 * value, msg=method)

    def settings(self):
        return self.browser.value("return state.scene.settings")

    def floor_after(self, revision):
        """Sum of the pinned rectangle's channels."""
        return sum(self.browser.wait("return state.curves_of?.revision > given && state.curves[0]", "its spectrum", revision)["mean"])

    def test_refused_settings_are_told(self):
        self.open_tab("render")
        fields = self.browser.driver.find_elements("css selector", "#tab input.number")
        fields[0].clear()
        fields[0].send_keys("900", Keys.ENTER)
        wait_until(lambda: self.browser.texts(".notice.error"), "the server's refusal")
        self.assertEqual(self.browser.value("return state.scene.channels.length"), CHANNELS)
        self.browser.press(Keys.ESCAPE)
        self.browser.noted_errors()  # Chromium notes the refused request

    def test_goes_on_while_no_page_is_open(self):
        samples = self.samples()
        self.browser.driver.get("about:blank")
        self.browser.open(self.viewer.address)
        self.wait_for_samples(samples + 1)
        self.assertGreater(self.browser.value("return state.frame.samples"), samples)

    def test_pause_stops_the_samples(self):
        self.pause()
        samples = self.browser.value("return state.status.samples")
        events = self.browser.value(
            """const source = new EventSource('/api/events');
            const seen = [];
            await new Promise((done) => source.addEventListener('status', (event) => {
              if (seen.push(JSON.parse(event.data).samples) === 3) done();
            }));
            source.close();
            return seen;""")
        self.assertEqual(set(events), {samples})
        self.browser.press(Keys.SPACE)
        self.browser.wait("return state.status.samples > given", "more samples", samples)

    def test_a_change_of_a_paused_render_is_told(self):
        """Nothing is rendered of it: the picture before stays."""
        self.pause()
        told = lambda: self.browser.texts("#status .outdated")
        self.assertEqual(told(), [])
        self.browser.press("o", Keys.ARROW_RIGHT)
        wait_until(lambda: told() == ["the picture is from before the change"], "word of the picture's age")
        self.browser.screenshot("outdated")
        line = self.browser.value("const {scrollWidth, clientWidth} = document.getElementById('status'); return [scrollWidth, clientWidth]")
        self.assertLessEqual(*line)
        self.browser.press(Keys.SPACE)
        wait_until(lambda: not told(), "the new picture")


if __name__ == "__main__":
    unittest.main()
