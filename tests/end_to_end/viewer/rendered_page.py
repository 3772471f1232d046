"""A page that shows a scene while it is rendered: what its tests wait for."""
import pathlib
import tempfile
import unittest

from browser import Browser, Keys
from program import BOX, Cube, Viewer, wait_until

CHANNELS = 16
SIZE = 64


class RenderedPage(unittest.TestCase):
    browser_type = Browser

    @classmethod
    def scene(cls):
        """Scene file and options; `saved` is a folder for it."""
        return BOX, "-D", f"res={SIZE}", "-D", f"bands=400:700:{CHANNELS}"

    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory(prefix="kiloband-viewer-")
        cls.addClassCleanup(folder.cleanup)
        cls.saved = pathlib.Path(folder.name)
        cls.viewer = Viewer(*cls.scene(), "--output-dir", cls.saved)
        cls.addClassCleanup(cls.end_viewer)
        cls.browser = cls.browser_type()
        cls.addClassCleanup(cls.browser.close)

    @classmethod
    def end_viewer(cls):
        status = cls.viewer.stop()
        assert status == 0, f"kiloband view has ended with {status}"

    def setUp(self):
        self.browser.open(self.viewer.address)
        self.start_afresh()

    def tearDown(self):
        self.assertEqual(self.browser.complaints(), [])

    def start_afresh(self):
        """The scene file's camera and spectra, rendering."""
        revision = self.browser.value(
            """const {post} = await import('/api.js');
            for (const id of Object.keys(state.edited ?? {})) await post('/api/spectrum', {id, set: {reset: true}});
            await post('/api/camera', {reset: true});
            await post('/api/control', {action: 'resume'});
            return (await (await fetch('/api/scene')).json()).revision;""")
        self.browser.wait("return state.frame.revision >= given", "the scene file's camera", revision)
        self.wait_for_samples(2)

    def samples(self):
        return self.browser.value("return state.frame.samples")

    def revision(self):
        return self.browser.value("return state.frame.revision")

    def wait_for_samples(self, least):
        self.browser.wait("return state.frame.samples >= given && state.frame.width === state.frame.full_width", f"{least} samples", least)

    def wait_for_revision_after(self, revision):
        self.browser.wait("return state.frame.revision > given", f"a restart after revision {revision}", revision)

    def pause(self):
        self.browser.press(Keys.SPACE)
        self.browser.wait("return state.status.state === 'paused'", "the pause")

    def spectrum(self, x, y):
        """What the plot holds once it belongs to the newest frame."""
        self.browser.wait("return state.curves_of && state.curves_of.frame === state.status.frame", "spectra of the newest frame")
        return self.browser.value("return state.curves.find((curve) => curve.select === given)", f"{x},{y}")

    def open_tab(self, name):
        self.browser.find(f"#tab-{name}").click()

    def save(self, name):
        """The cube that the page saves under a name."""
        self.open_tab("save")
        field = self.browser.find("#tab input[type=text]")
        field.clear()
        field.send_keys(name)
        self.browser.find("#tab [data-value=envi]").click()
        self.browser.find("#tab .primary").click()
        wait_until(lambda: any(f"{name}.hdr" in text for text in self.browser.texts(".files li")), "the saved file")
        return Cube(self.saved / f"{name}.hdr")
