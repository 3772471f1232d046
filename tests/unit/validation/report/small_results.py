"""Results as `kiloband validate` writes them, small enough to know every number of."""

import json

import numpy

CHANNELS = [[400, 500], [500, 600], [600, 700]]


def test_entry(name, p, passed=True, detectable=None, worst=None):
    figures = {"typical": detectable, "best": detectable, "largest": detectable, "largest_channel": 0}
    entry = {"name": name, "p": p, "level": 1e-5, "passed": passed, "detectable": figures}
    return entry | ({"worst": worst} if worst else {})


def pairing(passed):
    worst = {
        "x": 8,
        "y": 0,
        "width": 8,
        "height": 8,
        "pooled": False,
        "channel": 1,
        "a": 2.0,
        "b": 1.9,
        "difference": 0.1,
        "standard_error": 0.01,
        "t": 10.0,
        "dof": 60,
        "p": 1e-9,
    }
    tail = {"channel": 2, "count": 4096, "effective": 120.5, "top_variance": 0.04, "top_sum": 0.001, "hill_index": None}
    scale = {
        "columns": 16,
        "rows": 8,
        "units": 127,
        "pooled_units": 1,
        "tested": 384,
        "p": 0.4,
        "t_map": [None] + [0.1 * (k % 30) - 1.5 for k in range(127)],
    }
    tests = [
        test_entry("mean/pixel", 0.4, detectable=0.03),
        test_entry("mean/tile", 0.5 if passed else 1e-9, passed, 0.01, worst),
        test_entry("mean/image", 0.3, detectable=0.002),
        test_entry("scatter/image", 0.6, detectable=0.05),
    ]
    return {
        "kind": "independent",
        "a": "cpu shared sobol",
        "b": "opencl:pt shared sobol",
        "passed": passed,
        "attempts": 1 if passed else 2,
        "level": 1e-4,
        "samples": 64,
        "replicates": 32,
        "invalid_samples": 0,
        "image_a": [1.0, 2.0, 3.0],
        "image_b": [1.01, 1.99, 3.0],
        "image_error": [0.01, 0.01, None],
        "tails_a": tail,
        "tails_b": tail,
        "notes": [],
        "tests": tests,
        "means": [scale, {"columns": 2, "rows": 1, "t_map": [0.5, 10.0]}],
        "p_values": [(k + 0.5) / 128 for k in range(128)],
    }


def case(name, passed, cubes=()):
    return {
        "name": name,
        "what": "light & shade",
        "scene": "box.xml",
        "passed": passed,
        "width": 16,
        "height": 8,
        "triangles": 12,
        "channels_nm": CHANNELS,
        "pairings": [pairing(passed)],
        "cubes": [{"side": s, "file": f} for s, f in cubes],
    }


def hard_case(backend, passed):
    figure = {
        "name": "total",
        "unit": "1",
        "value": 1.5,
        "reference": 1.0,
        "error": 0.5,
        "limit": 1e-6,
        "passed": passed,
        "note": "n",
    }
    return {"name": "grazing", "what": "w", "backend": backend, "passed": passed, "figures": [figure]}


def curve(label, slope):
    points = [
        {"samples": n, "relative_error": n**slope, "seconds": 0.1 * n, "efficiency": n ** (-2 * slope) / (0.1 * n)}
        for n in (2, 4, 8)
    ]
    return {"configuration": label, "points": points, "slope": slope, "slope_error": 0.01}


def results(passed, **changes):
    """A run with a case that fails (unless `passed`) behind one that does not."""
    return {
        "format": "kiloband validation 1",
        "program": "kiloband 9.8.7",
        "processor": "Some <CPU>",
        "date": "2025-02-03",
        "backends": ["cpu", "opencl:pt on Device"],
        "effort": "quick",
        "seed": 1,
        "comparisons": 2,
        "rate_first": 0.01,
        "rate_again": 0.005,
        "rate_hard_cases": 3e-5,
        "rate_convergence": 1e-5,
        "rate_mitsuba": 1e-5,
        "rate": 1e-4,
        "seconds": 61.0,
        "passed": passed,
        "interrupted": False,
        "cases": [case("good", True, [("cpu", "cubes/good.hdr")]), case("wrong", passed, [("cpu", "cubes/lost.hdr")])],
        "hard_cases": [hard_case("cpu", True), hard_case("opencl:pt", passed)],
        "convergence": [
            {"name": "convergence/box", "passed": True, "note": "", "curves": [curve("cpu shared sobol", -0.7)]}
        ],
    } | changes


def write_cube(header, values, interleave="bsq"):
    """values: [line][sample][band]."""
    axes = {"bsq": (2, 0, 1), "bil": (0, 2, 1), "bip": (0, 1, 2)}[interleave]
    header.parent.mkdir(parents=True, exist_ok=True)
    values.transpose(axes).astype("<f4").tofile(header.with_suffix(".img"))
    lines, samples, bands = values.shape
    header.write_text(
        f"ENVI\ndescription = {{lines = 3,\n no field}}\nsamples = {samples}\nlines = {lines}\nbands = {bands}\n"
        f"header offset = 0\ndata type = 4\ninterleave = {interleave}\nbyte order = 0\n"
    )


def write_run(directory, content):
    (directory / "results.json").write_text(json.dumps(content))
    write_cube(directory / "cubes/good.hdr", numpy.arange(16 * 8 * 3, dtype=float).reshape(8, 16, 3))
