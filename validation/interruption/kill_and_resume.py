#!/usr/bin/env python3
"""Kills renders at random moments, resumes them, and compares their files with those of uninterrupted ones, byte by byte.

    kill_and_resume.py PROGRAM [--renders 50] [--backends cpu,opencl] [--seed 1] [--spp 192] [--folder F]

PROGRAM is the kiloband program. The renders are spread evenly over backends, samplers (sobol, independent) and with and without
--variance; within these, every other one has two replicates, so that their sums go over the bounds of chunks
(src/film/replicate_sums.hpp). The reference of each configuration is rendered once, without a checkpoint. Each render is
then killed (SIGKILL) up to --kills times, each time after a random time from 0 to 1.3 times what the reference took, and resumed; the
last run is left to end. Another render of each configuration ends at a third of the samples and is extended.

Before a kill the program is stopped (SIGSTOP) and its open files are looked at: one in the checkpoint's folder that is not the
checkpoint is a checkpoint being written. Standard output is a table; the exit code is 1 if a byte differs.
"""

import argparse
import os
import pathlib
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time

SCENE = pathlib.Path(__file__).resolve().parents[2] / "scenes/cornell_box/cornell_box.xml"


def command(program, configuration, spp, folder, checkpoint):
    """The render; outputs go to folder/out, the checkpoint to folder/saved."""
    backend, sampler, variance, replicates = configuration
    words = [program, "render", str(SCENE), "--quiet", "--backend", backend, "--sampler", sampler, "--size", "72x40",
             "--bands", "400:700:24", "--spp", str(spp), "--replicates", str(replicates), "-o", str(folder / "out/a.hdr"),
             "-o", str(folder / "out/a.exr")]
    if variance:
        words.append("--variance")
    if checkpoint:
        words += ["--checkpoint", str(folder / "saved/c"), "--checkpoint-interval", "0.01s", "--resume"]
    return words


def fresh(folder):
    shutil.rmtree(folder, ignore_errors=True)
    (folder / "out").mkdir(parents=True)
    (folder / "saved").mkdir()


def run(words):
    start = time.monotonic()
    done = subprocess.run(words, capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"{' '.join(words)}\nexit code {done.returncode}: {done.stderr}")
    return time.monotonic() - start


def writes_checkpoint(process, saved):
    """Whether the stopped program has a file open in the checkpoint's folder."""
    try:
        names = [os.readlink(entry.path) for entry in os.scandir(f"/proc/{process.pid}/fd")]
    except OSError:
        return False
    return any(name.startswith(f"{saved}/") for name in names)


def kill(words, folder, seconds):
    """Starts the render and kills it after `seconds`. Returns what it was at; None: it had ended."""
    process = subprocess.Popen(words, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    saved = folder / "saved"
    try:
        _, errors = process.communicate(timeout=seconds)
    except subprocess.TimeoutExpired:
        process.send_signal(signal.SIGSTOP)
        time.sleep(0.002)
        writing = writes_checkpoint(process, saved)
        exists = (saved / "c").exists()
        process.send_signal(signal.SIGKILL)
        process.communicate()
        return "writing" if writing else "between" if exists else "before"
    if process.returncode != 0:
        sys.exit(f"{' '.join(words)}\nexit code {process.returncode}: {errors}")
    return None


def files(folder):
    """What was written; a kill may leave temporary files behind, whose names begin with a dot."""
    return {path.name: path.read_bytes() for path in sorted((folder / "out").iterdir()) if path.name[0] != "."}


def configurations(backends):
    return [(backend, sampler, variance, replicates) for replicates in (16, 2) for variance in (True, False)
            for sampler in ("sobol", "independent") for backend in backends]


class Study:
    def __init__(self, arguments, folder):
        self.arguments, self.folder = arguments, folder
        self.random = random.Random(arguments.seed)
        self.references = {}
        self.kills = {"before": 0, "between": 0, "writing": 0}
        self.same = self.extended = self.renders = self.extensions = 0

    def reference(self, configuration):
        if configuration not in self.references:
            folder = self.folder / "reference"
            fresh(folder)
            seconds = run(command(self.arguments.program, configuration, self.arguments.spp, folder, False))
            self.references[configuration] = files(folder), seconds
            self.extend(configuration, self.references[configuration][0])
        return self.references[configuration]

    def extend(self, configuration, expected):
        folder = self.folder / "extended"
        fresh(folder)
        for spp in (self.arguments.spp // 3, self.arguments.spp):
            run(command(self.arguments.program, configuration, spp, folder, True))
        self.extensions += 1
        self.extended += files(folder) == expected

    def killed(self, configuration):
        expected, seconds = self.reference(configuration)
        folder = self.folder / "killed"
        fresh(folder)
        words = command(self.arguments.program, configuration, self.arguments.spp, folder, True)
        for _ in range(self.arguments.kills):
            moment = kill(words, folder, self.random.uniform(0, 1.3 * seconds))
            if moment is None:
                break
            self.kills[moment] += 1
        else:
            run(words)
        self.renders += 1
        found = files(folder)
        self.same += found == expected
        for name in sorted(found.keys() | expected.keys()):
            if found.get(name) != expected.get(name):
                print("differs:", *configuration, name, flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--renders", type=int, default=50)
    parser.add_argument("--kills", type=int, default=4)
    parser.add_argument("--backends", default="cpu,opencl")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--spp", type=int, default=192)
    parser.add_argument("--folder", type=pathlib.Path)
    arguments = parser.parse_args()
    folder = arguments.folder or pathlib.Path(tempfile.mkdtemp(prefix="kiloband_kills_"))
    study = Study(arguments, folder)
    every = configurations(arguments.backends.split(","))
    for i in range(arguments.renders):
        study.killed(every[i % len(every)])
    print(f"{study.same} of {study.renders} killed renders have the bits of uninterrupted ones")
    print(f"kills: {sum(study.kills.values())}; before the first checkpoint {study.kills['before']}, between checkpoints "
          f"{study.kills['between']}, while one was written {study.kills['writing']}")
    print(f"{study.extended} of {study.extensions} renders extended to three times their samples have them too")
    if arguments.folder is None:
        shutil.rmtree(folder)
    return 0 if study.same == study.renders and study.extended == study.extensions else 1


if __name__ == "__main__":
    sys.exit(main())
