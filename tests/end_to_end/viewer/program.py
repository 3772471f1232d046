"""kiloband view as a user starts it, and the cubes that it writes."""
import array
import os
import pathlib
import re
import select
import signal
import subprocess
import sys
import time

PROGRAM = os.environ["KILOBAND_PROGRAM"]
SCENES = pathlib.Path(os.environ["KILOBAND_SCENES"])
BOX = SCENES / "cornell_box" / "cornell_box.xml"
START_S = 60
END_S = 30


def kiloband(*arguments):
    """Runs the program to its end."""
    subprocess.run([PROGRAM, *map(str, arguments)], check=True, stdout=subprocess.DEVNULL, timeout=300)


class Viewer:
    """A running `kiloband view`; its address is what it prints first."""

    def __init__(self, file, *arguments, port=0):
        command = [PROGRAM, "view", str(file), "--port", str(port), *map(str, arguments)]
        self.process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=sys.stderr)
        self.address = self._first_line()

    def _first_line(self):
        ready, _, _ = select.select([self.process.stdout], [], [], START_S)
        line = self.process.stdout.readline().decode() if ready else ""
        found = re.search(r"http://\S+", line)
        if not found:
            self.process.kill()
            raise RuntimeError(f"kiloband view has said {line!r} instead of its address")
        return found[0]

    @property
    def port(self):
        return int(re.search(r":(\d+)/", self.address)[1])

    def stop(self):
        """Ctrl-C; the exit status."""
        if self.process.poll() is None:
            self.process.send_signal(signal.SIGINT)
        try:
            return self.process.wait(END_S)
        except subprocess.TimeoutExpired:
            self.process.kill()
            raise
        finally:
            self.process.stdout.close()


def wait_until(condition, what, limit_s=60):
    """Looks at `condition` until it is true, which it must become."""
    end = time.monotonic() + limit_s
    while not (value := condition()):
        if time.monotonic() > end:
            raise AssertionError(f"{what}: not within {limit_s} s")
        time.sleep(0.03)
    return value


class Cube:
    """An ENVI cube of floats, band by band; values as spectral radiance (density)."""

    def __init__(self, header):
        header = pathlib.Path(header)
        text = header.read_text()
        self.width, self.height, bands = (int(self._field(text, name)) for name in ("samples", "lines", "bands"))
        assert self._field(text, "data type") == "4" and self._field(text, "interleave") == "bsq"
        self.low = self._numbers(text, "kiloband band minimum")
        self.high = self._numbers(text, "kiloband band maximum")
        self.integral = self._field(text, "kiloband quantity") == "integral"
        assert len(self.low) == bands
        self.values = array.array("f", header.with_suffix(".img").read_bytes())
        assert len(self.values) == self.width * self.height * bands

    @staticmethod
    def _field(text, name):
        return re.search(rf"^{name} = (.*)$", text, re.MULTILINE)[1]

    @staticmethod
    def _numbers(text, name):
        return [float(number) for number in re.search(rf"^{name} = \{{([^}}]*)\}}", text, re.MULTILINE)[1].split(",")]

    def at(self, x, y, band):
        value = self.values[(band * self.height + y) * self.width + x]
        return value / (self.high[band] - self.low[band]) if self.integral else value

    def spectrum(self, x, y):
        return [self.at(x, y, band) for band in range(len(self.low))]

    def mean(self, x0, y0, x1, y1):
        """Spectrum of a rectangle, corners included."""
        pixels = [self.spectrum(x, y) for y in range(y0, y1 + 1) for x in range(x0, x1 + 1)]
        return [sum(values) / len(pixels) for values in zip(*pixels)]
