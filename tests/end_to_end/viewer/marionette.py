"""Firefox without a screen, driven by selenium over Firefox's own protocol, Marionette: Debian has no geckodriver, whose job is to
translate WebDriver into it. Commands have the same names and parameters in both."""
import atexit
import json
import os
import pathlib
import shutil
import socket
import subprocess
import tempfile

from selenium.common.exceptions import WebDriverException
from selenium.webdriver.remote.command import Command

from program import wait_until

PREFERENCES = {"marionette.port": 0, "app.update.auto": False, "browser.shell.checkDefaultBrowser": False,
               "datareporting.policy.dataSubmissionEnabled": False, "network.captive-portal-service.enabled": False,
               "network.connectivity-service.enabled": False, "layout.css.devPixelsPerPx": "1.0"}
NAMES = {
    Command.NEW_SESSION: "NewSession", Command.SET_TIMEOUTS: "SetTimeouts", Command.GET: "Navigate", Command.W3C_EXECUTE_SCRIPT: "ExecuteScript",
    Command.W3C_EXECUTE_SCRIPT_ASYNC: "ExecuteAsyncScript", Command.FIND_ELEMENT: "FindElement", Command.FIND_ELEMENTS: "FindElements",
    Command.CLICK_ELEMENT: "ElementClick", Command.CLEAR_ELEMENT: "ElementClear", Command.SEND_KEYS_TO_ELEMENT: "ElementSendKeys",
    Command.GET_ELEMENT_TEXT: "GetElementText", Command.W3C_ACTIONS: "PerformActions", Command.W3C_CLEAR_ACTIONS: "ReleaseActions",
    Command.SCREENSHOT: "TakeScreenshot", Command.SET_WINDOW_RECT: "SetWindowRect",
}  # fmt: skip
ANSWER_S = 120  # longer than any script may take


class Marionette:
    """What selenium hands its commands to. A message is its length, a colon and JSON: [0, number, name, parameters] there,
    [1, number, error, result] back."""
    keep_alive = True

    def __init__(self, width, height, preferences):
        self.profile = pathlib.Path(tempfile.mkdtemp(prefix="kiloband-browser-"))
        lines = [f"user_pref({json.dumps(name)}, {json.dumps(value)});" for name, value in {**PREFERENCES, **preferences}.items()]
        (self.profile / "user.js").write_text("\n".join(lines))
        command = [os.environ.get("KILOBAND_FIREFOX", "/usr/bin/firefox-esr"), "--headless", "--no-remote", "--marionette",
                   "--remote-allow-system-access", "--profile", self.profile, "--width", str(width), "--height", str(height), "about:blank"]
        self.process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        atexit.register(self.process.kill)  # where a test does not get as far as close()
        self.socket = socket.create_connection(("127.0.0.1", self._port()), timeout=ANSWER_S)
        self.stream = self.socket.makefile("rb")
        self.number = 0
        self._message()  # a greeting

    def _port(self):
        file = self.profile / "MarionetteActivePort"
        return int(wait_until(lambda: file.exists() and file.read_text().strip(), "Firefox's port"))

    def _message(self):
        length = b""
        while (byte := self.stream.read(1)) != b":":
            if not byte:
                raise WebDriverException("Firefox has closed the connection")
            length += byte
        return json.loads(self.stream.read(int(length)))

    def call(self, name, parameters):
        self.number += 1
        message = json.dumps([0, self.number, name, parameters]).encode()
        self.socket.sendall(b"%d:%s" % (len(message), message))
        _, _, error, result = self._message()
        if error:
            raise WebDriverException(f"{name}: {error['error']}: {error['message']}")
        return result

    def in_chrome(self, script, *arguments):
        """Runs a script with the browser's own rights."""
        self.call("Marionette:SetContext", {"value": "chrome"})
        try:
            return self.call("WebDriver:ExecuteScript", {"script": script, "args": arguments})["value"]
        finally:
            self.call("Marionette:SetContext", {"value": "content"})

    def execute(self, command, parameters):
        result = self.call("WebDriver:" + NAMES[command], {k: v for k, v in parameters.items() if k != "sessionId"})
        if command == Command.NEW_SESSION:
            return {"value": result}
        return result if isinstance(result, dict) and "value" in result else {"value": result}

    def close(self):
        self.stream.close()
        self.socket.close()
        self.process.terminate()
        self.process.wait(30)
        shutil.rmtree(self.profile, ignore_errors=True)
