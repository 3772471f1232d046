"""Rows of scripts/gpu_static.sh: what an assembler and a disassembler say of the kernels in one cubin.

usage: gpu_static.py SET TAG PTXAS_REPORT DISASSEMBLY     (one line of a Markdown table per kernel)

Instructions are counted where they stand, not as they are executed; functions that were not inlined count in their kernel.
Loads and stores of 4 bytes include narrower ones; constant means LDC, not operands in constant memory. Warps per multiprocessor follow from registers alone
(65,536 of them, handed out per warp in units of 256), at most 64: no kernel has shared memory that would limit it further.
"""

import re
import sys

REGISTERS, UNIT, MOST_WARPS, LANES = 65536, 256, 64, 32
CLASSES = ("load4", "load8", "load16", "store4", "store8", "store16", "local", "constant", "fma", "branch")


def resources(report):
    """{kernel: (registers, stack bytes, spilled bytes)} of `ptxas -v`."""
    found, name, stack, spills = {}, None, 0, 0
    for line in report.splitlines():
        if entry := re.search(r"Compiling entry function '(\w+)'", line):
            name = entry[1]
        elif frame := re.search(r"(\d+) bytes stack frame, (\d+) bytes spill stores, (\d+) bytes spill loads", line):
            stack, spills = int(frame[1]), int(frame[2]) + int(frame[3])
        elif (used := re.search(r"Used (\d+) registers", line)) and name:
            found[name] = (int(used[1]), stack, spills)
            name = None
    return found


def width_class(kind, modifiers):
    if "128" in modifiers:
        return kind + "16"
    return kind + ("8" if "64" in modifiers else "4")


def classes_of(operation):
    """The columns that one instruction counts in."""
    name, *modifiers = operation.split(".")
    if name in ("LDG", "STG", "LD", "ST"):
        return [width_class("load" if name.startswith("LD") else "store", modifiers)]
    return [c for c, hit in (("local", name in ("LDL", "STL")), ("constant", name == "LDC"),
                             ("fma", name == "FFMA"), ("branch", name in ("BRA", "BRX", "CALL", "RET"))) if hit]


def instructions(disassembly):
    """{kernel: {"all": n, class: n}} of `nvdisasm -c`."""
    found, counts = {}, None
    for line in disassembly.splitlines():
        if section := re.match(r"\s*\.section\s+\.text\.(\w+)", line):
            counts = found.setdefault(section[1], dict.fromkeys(("all",) + CLASSES, 0))
        elif counts is not None and (code := re.match(r"\s*/\*[0-9a-f]+\*/\s+(?:@!?U?P\w+\s+)?([A-Z][\w.]*).*;", line)):
            if code[1] == "NOP":
                continue
            counts["all"] += 1
            for name in classes_of(code[1]):
                counts[name] += 1
    return found


def warps(registers):
    per_warp = -(-registers * LANES // UNIT) * UNIT
    return min(MOST_WARPS, REGISTERS // per_warp // 4 * 4)


def main():
    feature_set, tag, report, disassembly = sys.argv[1:]
    with open(report) as r, open(disassembly) as d:
        used, counted = resources(r.read()), instructions(d.read())
    if not used or used.keys() != counted.keys():
        sys.exit(f"gpu_static: {report} and {disassembly} do not name the same kernels")
    for kernel, (registers, stack, spills) in sorted(used.items()):
        numbers = [registers, stack, spills, warps(registers), counted[kernel]["all"]]
        numbers += [counted[kernel][c] for c in CLASSES]
        print(f"| {feature_set} | {tag} | {kernel} | " + " | ".join(f"{n:,}" for n in numbers) + " |")


if __name__ == "__main__":
    main()
