"""README's picture of the viewer: the Cornell box after 256 samples per pixel, with four spectra pinned.
usage: KILOBAND_PROGRAM=build/release/app/kiloband KILOBAND_SCENES=scenes screenshot.py OUT.png"""
import sys

from browser import Browser
from program import BOX, Viewer

PIN = """
const {pin} = await import('/pins.js');
const {set} = await import('/state.js');
for (const select of [[90, 300], [452, 300], [270, 450], [150, 30, 200, 60]]) pin(select);
set({hover: [330, 320]});
"""


def main(target):
    viewer = Viewer(BOX, "-D", "res=512", "--spp", 256, "--output-dir", ".")
    browser = Browser()
    try:
        browser.open(viewer.address)
        browser.value(PIN)
        browser.wait("return state.status.state === 'done' && state.curves_of?.frame === state.status.frame", "256 samples",
                     limit_s=600)
        browser.wait("return state.frame.parameters.quality === 'exact'", "the exact frame")
        browser.driver.save_screenshot(target)
    finally:
        browser.close()
        viewer.stop()


if __name__ == "__main__":
    main(sys.argv[1])
