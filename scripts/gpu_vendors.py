"""Rows of scripts/gpu_vendors.sh.

usage: gpu_vendors.py amd SET TAG CHIP SECONDS ASSEMBLY                    (a line of a Markdown table per kernel)
       gpu_vendors.py spirv SET TAG CLANG_SECONDS SPIRV_SECONDS BYTES DISASSEMBLY     (one line)

AMD: as clang's assembly says. Scratch: bytes per work-item; waves: per SIMD, by registers (of 10 on gfx900, 16 on gfx1030); code: bytes
of the kernel itself, without functions that were not inlined.
SPIR-V: fails if a kernel asks for more than OpenCL 1.2's full profile has without fp64.
"""

import re
import sys

ALLOWED = {"Addresses", "Linkage", "Kernel", "Vector16", "Int64", "Int16", "Int8"}
NUMBERS = {"VGPRs": r"; NumVgprs: (\d+)", "SGPRs": r"; NumSgprs: (\d+)", "scratch": r"; ScratchSize: (\d+)",
           "waves": r"; Occupancy: (\d+)", "code": r"; codeLenInByte = (\d+)"}


def amd_kernels(assembly):
    """{kernel: {number: value}}; spills are in the metadata at the end."""
    found = {}
    for name, text in re.findall(r"-- Begin function (\w+)\n(.*?)(?=-- Begin function|\Z)", assembly, re.DOTALL):
        if "; Kernel info:" in text:
            info = text[text.index("; Kernel info:"):]
            found[name] = {key: int(re.search(pattern, info)[1]) for key, pattern in NUMBERS.items()}
    for name, text in re.findall(r"\.symbol:\s+'?(\w+)\.kd'?\n(.*?)(?=\.args:|\Z)", assembly, re.DOTALL):
        found[name]["spills"] = sum(int(n) for n in re.findall(r"\.[sv]gpr_spill_count:\s+(\d+)", text))
    return found


def wanted(tag, kernel):
    """evaluate.cl is two programs, each of which is asked for one method's kernel."""
    return not ((tag == "batch" and kernel == "dpept_path") or (tag == "path" and kernel != "dpept_path"))


def amd(feature_set, tag, chip, seconds, file):
    with open(file) as text:
        kernels = amd_kernels(text.read())
    if not kernels:
        sys.exit(f"gpu_vendors: no kernels in {file}")
    for kernel, n in sorted(kernels.items()):
        if wanted(tag, kernel):
            numbers = [n["VGPRs"], n["SGPRs"], n["scratch"], n["spills"], n["waves"], n["code"]]
            print(f"| {feature_set} | {tag} | {float(seconds):.1f} | {chip} | {kernel} | " + " | ".join(f"{x:,}" for x in numbers) + " |")


def spirv(feature_set, tag, clang, translator, size, file):
    with open(file) as text:
        lines = text.read()
    capabilities = re.findall(r"OpCapability (\w+)", lines)
    kernels = re.findall(r'OpEntryPoint Kernel %\w+ "(\w+)"', lines)
    extra = set(capabilities) - ALLOWED | set(re.findall(r'OpExtension "(\w+)"', lines))
    if extra or not kernels:
        sys.exit(f"gpu_vendors: {feature_set} {tag}: {len(kernels)} kernels; needs {', '.join(sorted(extra))}")
    print(f"| {feature_set} | {tag} | {float(clang):.1f} | {float(translator):.1f} | {int(size):,} | {len(kernels)} | {', '.join(capabilities)} |")


if __name__ == "__main__":
    {"amd": amd, "spirv": spirv}[sys.argv[1]](*sys.argv[2:])
