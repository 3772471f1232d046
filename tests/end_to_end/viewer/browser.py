"""Chromium without a screen (firefox.py: Firefox). What the page shows is read from its own modules and its canvas."""
import os
import shutil
import tempfile

from selenium import webdriver
from selenium.webdriver.chrome.options import Options
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys
from selenium.webdriver.support.ui import Select

from program import wait_until

ARGUMENTS = ["--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--disable-gpu", "--hide-scrollbars",
             "--no-first-run", "--disable-background-networking", "--force-device-scale-factor=1"]
EVALUATE = """
async (given) => {
  const {state} = await import('/state.js');
  return await (async (given) => { %s })(given);
}"""
KEEP_NOTHING = "Storage.prototype.setItem = () => {};"
ANSWER = "(arguments[0]).then(arguments[1]).catch((error) => arguments[1]({failed: String(error)}));"
PICTURE = """
await new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)));  // frames are painted in the next one
const canvas = document.getElementById('image');
const {data} = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
"""


class Browser:
    @staticmethod
    def in_page(function):
        """Source that runs a function among the page's own modules, which are loaded once per page."""
        return f"({function})"

    def __init__(self, width=1280, height=800, dark=False, downloads=None):
        self.driver = self._start(width, height, downloads)
        self.driver.set_script_timeout(60)
        self.resize(width, height)
        self.colour_scheme(dark)

    def _start(self, width, height, downloads):
        self.folder = tempfile.mkdtemp(prefix="kiloband-browser-")
        options = Options()
        options.binary_location = os.environ.get("KILOBAND_CHROMIUM", "/usr/bin/chromium")
        for argument in [*ARGUMENTS, f"--window-size={width},{height}", f"--user-data-dir={self.folder}"]:
            options.add_argument(argument)
        options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
        if downloads:
            options.add_experimental_option("prefs", {"download.default_directory": str(downloads)})
        driver = Service(os.environ.get("KILOBAND_CHROMEDRIVER", "/usr/bin/chromedriver"))
        return webdriver.Chrome(service=driver, options=options)

    def close(self):
        self.driver.quit()
        shutil.rmtree(self.folder, ignore_errors=True)

    def resize(self, width, height):
        metrics = {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": False}
        self.driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", metrics)

    def colour_scheme(self, dark):
        features = [{"name": "prefers-color-scheme", "value": "dark" if dark else "light"}]
        self.driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": features})

    def open(self, address, forget=True):
        """With `forget` as on a first visit."""
        if forget:
            self._forget(address)
        self.driver.get(address)
        self.wait("return state.frame && state.status && state.scene", "the first frame")

    def _forget(self, address):
        """For good: what an open page is about to keep, too."""
        self.driver.execute_script(KEEP_NOTHING)
        self.driver.execute_cdp_cmd("Storage.clearDataForOrigin", {"origin": address.rstrip("/"), "storageTypes": "local_storage"})

    def value(self, code, given=None):
        """What the statements return; `state` is the page's."""
        answer = self.driver.execute_async_script(self.in_page(EVALUATE % code) + ANSWER, given)
        if isinstance(answer, dict) and "failed" in answer:
            raise AssertionError(answer["failed"])
        return answer

    def wait(self, code, what, given=None, limit_s=60):
        return wait_until(lambda: self.value(code, given), what, limit_s)

    def find(self, selector):
        return self.driver.find_element(By.CSS_SELECTOR, selector)

    def find_all(self, selector):
        return self.driver.find_elements(By.CSS_SELECTOR, selector)

    def choose_option(self, selector, value, which=0):
        Select(self.find_all(selector)[which]).select_by_value(value)

    def texts(self, selector):
        return self.driver.execute_script(
            "return [...document.querySelectorAll(arguments[0])].map((found) => found.innerText)", selector)

    def press(self, *keys, holding=None):
        """Keys for the image, which gets the focus."""
        self.driver.execute_script("document.getElementById('image').focus()")
        chain = ActionChains(self.driver, duration=0)
        if holding:
            chain.key_down(holding)
        chain.send_keys(*keys)
        if holding:
            chain.key_up(holding)
        chain.perform()

    def choose(self, mode):
        """Its key, and its frame."""
        self.press(str(1 + self.value("return state.scene.modes.indexOf(given)", mode)))
        self.wait("return state.frame.mode === given", f"a frame of {mode}", mode)

    def point_of(self, x, y):
        """Offset from the middle of the canvas (which selenium counts from) of a film pixel's middle."""
        return self.value(
            """const {point_of} = await import('/image.js');
            const canvas = document.getElementById('image');
            const [x, y] = point_of(given);
            return [Math.round(x - canvas.clientWidth / 2), Math.round(y - canvas.clientHeight / 2)];""", [x, y])

    def click(self, x, y):
        chain = ActionChains(self.driver, duration=0)
        chain.move_to_element_with_offset(self.find("#image"), *self.point_of(x, y)).click().perform()

    def drag(self, start, end, holding=None):
        """From one film pixel to another, in a few steps."""
        first, last = self.point_of(*start), self.point_of(*end)
        chain = ActionChains(self.driver, duration=10)
        if holding:
            chain.key_down(holding)
        chain.move_to_element_with_offset(self.find("#image"), *first).click_and_hold()
        for step in range(1, 5):
            at = [round(a + (b - a) * step / 4) for a, b in zip(first, last)]
            chain.move_to_element_with_offset(self.find("#image"), *at)
        chain.release()
        if holding:
            chain.key_up(holding)
        chain.perform()

    def drag_away(self, dx, dy):
        """Presses in the middle of the image, moves by so many CSS pixels, lets go."""
        chain = ActionChains(self.driver, duration=10)
        chain.move_to_element(self.find("#image")).click_and_hold()
        chain.move_by_offset(dx // 2, dy // 2).move_by_offset(dx - dx // 2, dy - dy // 2).release().perform()

    def colour_at(self, x, y):
        """Red, green and blue of a film pixel as painted."""
        return self.value(PICTURE + """
            const {point_of} = await import('/image.js');
            const [x, y] = point_of(given);
            const at = 4 * (Math.floor(y) * canvas.width + Math.floor(x));
            return [...data.slice(at, at + 3)];""", [x, y])

    def picture(self):
        """A hash of all that is painted."""
        return self.value(PICTURE + """
            let hash = 0;
            for (let i = 0; i < data.length; i += 4) {
              hash = (Math.imul(hash, 31) + data[i] + (data[i + 1] << 8) + (data[i + 2] << 16)) | 0;
            }
            return hash;""")

    def allow_clipboard(self, address):
        permissions = ["clipboardReadWrite", "clipboardSanitizedWrite"]
        self.driver.execute_cdp_cmd("Browser.grantPermissions", {"origin": address.rstrip("/"), "permissions": permissions})

    def noted_errors(self):
        """What the browser's log has of them since it was last asked."""
        return [entry["message"] for entry in self.driver.get_log("browser") if entry["level"] == "SEVERE"]

    def complaints(self):
        """Errors of the page: in the browser's log, and shown over the image."""
        return self.noted_errors() + self.texts(".notice.error")

    def screenshot(self, name):
        """Kept where KILOBAND_SCREENSHOTS says; None otherwise."""
        folder = os.environ.get("KILOBAND_SCREENSHOTS")
        if folder:
            self.driver.save_screenshot(os.path.join(folder, name + ".png"))


__all__ = ["ActionChains", "Browser", "By", "Keys"]
