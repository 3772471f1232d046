"""The same page in Firefox."""
import json

from selenium import webdriver
from selenium.webdriver.firefox.options import Options

from browser import KEEP_NOTHING, Browser
from marionette import Marionette

# Errors of scripts and of the page's own requests that Firefox has noted.
NOTED = """
const noted = Services.console.getMessageArray().filter((message) => message instanceof Ci.nsIScriptError);
Services.console.reset();
const {warningFlag, infoFlag} = Ci.nsIScriptError;
return noted.filter((error) => (error.flags & (warningFlag | infoFlag)) === 0 && error.sourceName.startsWith('http://127.0.0.1'))
    .map((error) => error.errorMessage);
"""
# Marionette's scripts have modules of their own; only eval() reaches the page's, and the page's policy has to allow it. Nothing
# else of the policy changes.
ALLOW_EVAL = """
Services.obs.addObserver({observe(subject) {
  const channel = subject.QueryInterface(Ci.nsIHttpChannel);
  if (channel.URI.filePath !== '/') return;
  const policy = channel.getResponseHeader('Content-Security-Policy');
  channel.setResponseHeader('Content-Security-Policy', policy.replace("default-src 'self'", "default-src 'self' 'unsafe-eval'"), false);
}}, 'http-on-examine-response');
"""


class Firefox(Browser):
    @staticmethod
    def in_page(function):
        return f"window.eval({json.dumps(f'({function})')})"

    def _start(self, width, height, downloads):
        preferences = {"browser.download.folderList": 2, "browser.download.dir": str(downloads)} if downloads else {}
        self.marionette = Marionette(width, height, preferences)
        driver = webdriver.Remote(command_executor=self.marionette, options=Options())
        self.marionette.in_chrome(ALLOW_EVAL)
        return driver

    def close(self):
        self.marionette.close()

    def resize(self, width, height):
        """The page's size: the window has bars besides."""
        more = self.driver.execute_script("return [outerWidth - innerWidth, outerHeight - innerHeight]")
        self.driver.set_window_rect(width=width + more[0], height=height + more[1])

    def colour_scheme(self, dark):
        self.marionette.in_chrome("Services.prefs.setIntPref('layout.css.prefers-color-scheme.content-override', arguments[0])",
                                  0 if dark else 1)

    def _forget(self, address):
        """By a page of the same origin."""
        self.driver.get(address)
        self.driver.execute_script("localStorage.clear();" + KEEP_NOTHING)

    def noted_errors(self):
        return self.marionette.in_chrome(NOTED)
