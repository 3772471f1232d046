#!/usr/bin/env python3
"""How many frames `kiloband view` delivers to one client, and how soon after a change of the camera.

Usage: viewer_speed.py KILOBAND SCENE.xml [--size 512x512] [--bands 400:700:100] [--seconds 15] [--moves 20]

The client asks for the next frame (JPEG, mode color) when it has got the last. A frame has a new sample of every channel in every pixel,
but for those while the camera moves, which are smaller. Latency: from the request that moves the camera to the first frame of the new view.
"""

import argparse
import http.client
import json
import math
import signal
import statistics
import subprocess
import time


class Client:
    def __init__(self, address):
        self.connection = http.client.HTTPConnection(address.split("/")[2], timeout=60)
        self.last = 0

    def ask(self, method, path, body=None):
        self.connection.request(method, path, body, {"X-Kiloband": "1", "Content-Type": "application/json"})
        response = self.connection.getresponse()
        content = response.read()
        if response.status >= 300:
            raise RuntimeError(f"{path}: {response.status} {content!r}")
        return response, content

    def frame(self):
        """The facts of the next frame."""
        while True:
            response, _ = self.ask("GET", f"/api/frame?mode=color&quality=lossy&after={self.last}")
            if response.status == 200:
                facts = json.loads(response.headers["X-Kiloband-Frame"])
                self.last = facts["frame"]
                return facts


def deliver(client, seconds):
    """Frames and samples per pixel, per second."""
    before, frames, start = client.frame(), 0, time.monotonic()
    while time.monotonic() < start + seconds:
        after = client.frame()
        frames += 1
    taken = time.monotonic() - start
    return frames / taken, (after["samples"] - before["samples"]) / taken


def latencies(client, moving, moves):
    """Milliseconds of each move."""
    _, text = client.ask("GET", "/api/scene")
    camera = json.loads(text)["camera"]
    found = []
    for i in range(moves):
        origin = list(camera["origin"])
        origin[0] += 0.02 * camera["scale_m"] * math.sin(i)
        before = client.frame()["revision"]
        start = time.monotonic()
        client.ask("POST", "/api/camera", json.dumps({"origin": origin, "target": camera["target"], "up": camera["up"], "moving": moving}))
        while client.frame()["revision"] <= before:
            pass
        found.append(1000 * (time.monotonic() - start))
    return found


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("scene")
    parser.add_argument("--size", default="512x512")
    parser.add_argument("--bands", default="400:700:100")
    parser.add_argument("--seconds", type=float, default=15)
    parser.add_argument("--moves", type=int, default=20)
    options = parser.parse_args()
    command = [options.program, "view", options.scene, "--port", "0", "--size", options.size, "--bands", options.bands]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as viewer:
        try:
            client = Client(viewer.stdout.readline().strip())
            for _ in range(5):
                client.frame()
            frames, samples = deliver(client, options.seconds)
            print(f"{frames:.1f} frames per second delivered, {samples:.1f} samples per pixel and second rendered")
            for name, moving in (("moving", True), ("at full size", False)):
                found = latencies(client, moving, options.moves)
                print(f"camera {name}: first frame after {statistics.median(found):.0f} ms (median), {max(found):.0f} ms (largest)")
        finally:
            viewer.send_signal(signal.SIGTERM)


if __name__ == "__main__":
    main()
