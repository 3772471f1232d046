#!/usr/bin/env python3
"""Repeats a launch that capture.c has written, under CUDA: NVIDIA's profiler knows no OpenCL, but its OpenCL driver compiles to PTX.

usage: replay.py FOLDER [--registers MOST] [--launches 1]

Needs cupy, and ptxas in PATH (CUDA 12 or later). What differs from the launch under OpenCL: arguments in constant memory are read from global
memory, and the kernel's code is assembled by this ptxas, not by the driver's.
"""

import argparse
import json
import pathlib
import re
import subprocess
import sys

# Where OpenCL's launch tells its sizes: special registers that CUDA does not set. Offsets of groups and items are 0 (capture.c sees to it).
REGISTERS = {**{i: "0" for i in range(6)}, 6: "%nctaid.x", 7: "%nctaid.y", 8: "%nctaid.z", 9: "1"}


def translate(binary):
    """PTX that CUDA runs, of what NVIDIA's OpenCL driver gives as a program's binary."""
    text = binary.split(b"\0")[0].decode()
    if ".target" not in text:
        raise ValueError("no PTX: not a program of NVIDIA's OpenCL driver")

    def register(match):
        number = int(match[1])
        if number not in REGISTERS:
            raise ValueError(f"%envreg{number} is not known")
        return REGISTERS[number]

    text = re.sub(r"%envreg(\d+)", register, text)
    for old, new in ((".ptr .const", ".ptr .global"), ("ld.const", "ld.global.nc"), ("cvta.to.const", "cvta.to.global"),
                     ("cvta.const", "cvta.global")):
        text = text.replace(old, new)
    return re.sub(r"(?m)^(\s*(?:\.visible |\.extern )?)\.const ", r"\1.global ", text)


def assemble(folder, registers):
    """The path of the machine code for this device."""
    import cupy

    (folder / "program.ptx").write_text(translate((folder / "program").read_bytes()))
    command = ["ptxas", f"-arch=sm_{cupy.cuda.Device().compute_capability}", folder / "program.ptx", "-o", folder / "program.cubin"]
    if registers:
        command.append(f"--maxrregcount={registers}")
    subprocess.run(command, check=True)
    return str(folder / "program.cubin")


def load_arguments(folder, launch):
    """Arguments in order, and (array, bytes) of every buffer; handles that are named more than once are one array."""
    import cupy
    import numpy

    arrays, arguments, buffers = {}, [], []
    for number, argument in enumerate(launch["arguments"]):
        kind = argument["kind"]
        if kind == "buffer":
            handle = argument["handle"]
            if handle not in arrays:
                host = numpy.fromfile(folder / f"argument-{number}", dtype=numpy.uint8)
                arrays[handle] = cupy.asarray(host)
                buffers.append((arrays[handle], host))
            arguments.append(numpy.uint64(arrays[handle].data.ptr))
        elif kind == "null":
            arguments.append(numpy.uint64(0))
        elif kind == "value":
            value = bytes.fromhex(argument["hex"])
            arguments.append(numpy.frombuffer(value, dtype=f"u{len(value)}")[0])
        else:
            raise ValueError("local memory as an argument is not known")
    return arguments, buffers


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--registers", type=int, default=0, help="of a work-item at most (default: any number)")
    parser.add_argument("--launches", type=int, default=1)
    settings = parser.parse_args()
    import cupy

    launch = json.loads((settings.folder / "launch.json").read_text())
    kernel = cupy.RawModule(path=assemble(settings.folder, settings.registers)).get_function(launch["kernel"])
    arguments, buffers = load_arguments(settings.folder, launch)
    print(f"{launch['kernel']}: {launch['global']} items in groups of {launch['local']}, {kernel.num_regs} registers, "
          f"{kernel.shared_size_bytes} bytes of local memory")
    for number in range(settings.launches):
        for array, host in buffers if number else []:  # as they were
            array.set(host)
        begin, end = cupy.cuda.Event(), cupy.cuda.Event()
        begin.record()
        kernel((launch["global"] // launch["local"],), (launch["local"],), tuple(arguments))
        end.record()
        end.synchronize()
        print(f"launch {number}: {cupy.cuda.get_elapsed_time(begin, end):.4f} ms")


if __name__ == "__main__":
    sys.exit(main())
