#!/usr/bin/env python3
"""Renders a scene file with Mitsuba 3 into the channels of kiloband, by independent replicates.

Usage: render_mitsuba.py SCENE.xml --bands 400:700:8 -o OUT.hdr [--size WxH] [--spp N] [--replicates R] [--seed S]
       render_mitsuba.py SCENE.xml --load     reads it only: exit code 2 and the reason if it is refused
       render_mitsuba.py --probe     prints the versions as JSON; `kiloband validate` asks so whether Mitsuba is there

Writes OUT.r00.hdr ... (ENVI, 32-bit floats, integrals over the channels: W m^-2 sr^-1), as `kiloband render
--keep-replicates` does, so that `kiloband compare OURS.hdr OUT.r00.hdr,OUT.r01.hdr,... --no-variances` can compare them.
Needs numpy and Mitsuba 3 (`pip install mitsuba`) in a spectral variant. Exit code 2 where it could not be done.

How the scene is changed: the film becomes a `specfilm` with one response per channel, 1 inside and 0 outside, and a box
filter. A pixel of specfilm is the integral of radiance times response over the wavelength, which is our channel integral:
scenes/analytic/furnace.xml gives 2.1, 8.4, 7.9 within its noise of 0.3 %, without any factor. Film size and channels are given
here, everything else of the scene is taken as it stands.
"""

import argparse
import json
import pathlib
import platform
import sys
import traceback
import xml.etree.ElementTree as ElementTree

import numpy

sys.dont_write_bytecode = True  # nothing is left in the source folder


def parse_bands(text):
    """ "400:700:8" (equal channels) or "400-410, 450-500". Returns [(min, max)], nm."""
    if ":" in text:
        first, last, count = text.split(":")
        edges = numpy.linspace(float(first), float(last), int(count) + 1)
        return list(zip(edges[:-1].tolist(), edges[1:].tolist()))
    return [tuple(float(edge) for edge in band.split("-")) for band in text.split(",")]


def spectral_film(size, bands):
    """specfilm samples wavelengths by the sum of all responses, tabulated as coarsely as the narrowest one: `whole` keeps that
    above 0 wherever a channel is. It is the last band and is dropped afterwards."""
    film = ElementTree.Element("film", type="specfilm")
    for name, value in zip(("width", "height"), size):
        ElementTree.SubElement(film, "integer", name=name, value=str(value))
    ElementTree.SubElement(film, "string", name="component_format", value="float32")
    ElementTree.SubElement(film, "rfilter", type="box")
    for k, (low, high) in enumerate(bands):
        ElementTree.SubElement(film, "spectrum", name=f"channel{k:05d}", value=f"{low!r}:1, {high!r}:1")
    low, high = min(b[0] for b in bands), max(b[1] for b in bands)
    ElementTree.SubElement(film, "spectrum", name="whole", value=f"{low!r}:1, {high!r}:1")
    return film


def _found(name, folders):
    """The first file of that name, absolute; in the first folder if there is none."""
    candidates = [folder / name for folder in folders]
    return str(next((file for file in candidates if file.exists()), candidates[0]))


def _substituted(name, defaults):
    """With the values of <default> for $parameters, those with the longest names first."""
    for parameter in sorted(defaults, key=len, reverse=True):
        name = name.replace("$" + parameter, defaults[parameter])
    return name


def _with_includes(scene_file, folders, defaults):
    """The scene's XML with what it includes in its place, at any depth, and absolute file names: all are in relation to the first
    scene, or else in its <path> folders."""
    root = ElementTree.parse(scene_file).getroot()
    for default in root.iter("default"):
        defaults.setdefault(default.get("name"), default.get("value"))
    folders = folders + [folders[0] / _substituted(path.get("value"), defaults) for path in root.findall("path")]

    def found(name):
        return _found(_substituted(name, defaults), folders)

    for element in root.iter():
        if element.tag == "spectrum" and "filename" in element.attrib:
            element.set("filename", found(element.get("filename")))
        if element.tag == "string" and element.get("name") == "filename":
            element.set("value", found(element.get("value")))
        if element.tag == "lookAt":  # of Mitsuba 0.x; version 3.9.1 takes its other names
            element.tag = "lookat"
    for parent in list(root.iter()):
        for place, element in reversed(list(enumerate(parent))):
            if element.tag == "path":
                parent.remove(element)
            if element.tag == "include":
                parent.remove(element)
                for inner in reversed(list(_with_includes(found(element.get("filename")), folders, defaults))):
                    parent.insert(place, inner)
    return root


# Of Mitsuba 0.x: version 3.9.1 refuses them, and they have no meaning for the image.
OBSOLETE = {"sampler": ["dimension"], "integrator": ["strictNormals"], "film": ["banner"]}


def adapted(scene_file, film=None):
    """The scene's XML with absolute file names, and that film if one is given."""
    root = _with_includes(scene_file, [pathlib.Path(scene_file).resolve().parent], {})
    for parent in root.iter():
        for child in list(parent):
            if child.get("name") in OBSOLETE.get(parent.tag, []):
                parent.remove(child)
    for sensor in root.iter("sensor") if film is not None else ():
        for old in sensor.findall("film"):
            sensor.remove(old)
        sensor.append(film)
    return ElementTree.tostring(root, encoding="unicode")


class Impossible(Exception):
    """What was asked for cannot be done; the message says why."""


def find_mitsuba(variant):
    """The module, in that variant. throws Impossible  it is not installed, or has no such variant"""
    try:
        import mitsuba
    except ImportError as error:
        raise Impossible("Mitsuba 3 is not installed (pip install mitsuba)") from error
    if variant not in mitsuba.variants() or "spectral" not in variant:
        known = ", ".join(mitsuba.variants())
        raise Impossible(f"Mitsuba {mitsuba.__version__} has no spectral variant {variant}: {known}")
    mitsuba.set_variant(variant)
    return mitsuba


def render(mitsuba, scene_file, size, bands, spp, replicates, seed):
    """Returns float32 [replicate][line][sample][channel]. Mitsuba's seeds have 32 bits."""
    scene = mitsuba.load_string(adapted(scene_file, spectral_film(size, bands)))
    seeds = [(seed * replicates + r) % 2**32 for r in range(replicates)]
    images = [numpy.array(mitsuba.render(scene, spp=spp, seed=s)) for s in seeds]
    return numpy.stack(images)[..., : len(bands)].astype(numpy.float32)


def write_cube(header, image, bands, program="Mitsuba 3"):
    """ENVI: float32 [line][sample][channel], W m^-2 sr^-1."""
    lines, samples, count = image.shape
    numbers = [", ".join(f"{value:.9g}" for value in values) for values in zip(*bands)]
    centres = ", ".join(f"{0.5 * (low + high):.9g}" for low, high in bands)
    widths = ", ".join(f"{high - low:.9g}" for low, high in bands)
    image.transpose(2, 0, 1).astype("<f4").tofile(header.with_suffix(".img"))
    header.write_text(
        f"ENVI\ndescription = {{band radiance (integral over the band) in W m^-2 sr^-1; by {program}}}\n"
        f"samples = {samples}\nlines = {lines}\nbands = {count}\nheader offset = 0\nfile type = ENVI Standard\n"
        f"data type = 4\ninterleave = bsq\nbyte order = 0\nwavelength units = Nanometers\nwavelength = {{{centres}}}\n"
        f"fwhm = {{{widths}}}\nkiloband band minimum = {{{numbers[0]}}}\nkiloband band maximum = {{{numbers[1]}}}\n"
        "kiloband quantity = integral\n"
    )


def parse():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("scene", nargs="?")
    parser.add_argument("--bands")
    parser.add_argument("-o", dest="output", type=pathlib.Path)
    parser.add_argument("--size", default="32x32")
    parser.add_argument("--spp", type=int, default=64)
    parser.add_argument("--replicates", type=int, default=32)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--variant", default="scalar_spectral")
    parser.add_argument("--load", action="store_true", help="read the scene as it stands, and nothing else")
    parser.add_argument("--probe", action="store_true", help="print the versions of Mitsuba and what it needs, as JSON")
    options = parser.parse_args()
    if not options.probe and not options.load and not (options.scene and options.bands and options.output):
        parser.error("SCENE.xml, --bands and -o are needed")
    return options


def exit_code(action):
    """What `action` returns; 2 where it cannot be done."""
    try:
        return action()
    except Impossible as error:
        print(f"{pathlib.Path(sys.argv[0]).name}: {error}", file=sys.stderr)
    except Exception:
        traceback.print_exc()
    return 2


def print_means(images, bands):
    means = images.mean(axis=(1, 2))
    for (low, high), mean, error in zip(bands, means.mean(axis=0), means.std(axis=0, ddof=1) / len(means) ** 0.5):
        print(f"{low:g}-{high:g} nm: {mean:.6g} +- {error:.2g}")


def main():
    options = parse()
    mitsuba = find_mitsuba(options.variant)
    if options.probe:
        versions = {"mitsuba": mitsuba.__version__, "variant": options.variant}
        print(json.dumps(versions | {"python": platform.python_version(), "numpy": numpy.__version__}))
        return 0
    if options.load:
        mitsuba.set_log_level(mitsuba.LogLevel.Error)
        mitsuba.load_string(adapted(options.scene))
        return 0
    bands = parse_bands(options.bands)
    size = [int(edge) for edge in options.size.split("x")]
    images = render(mitsuba, options.scene, size, bands, options.spp, options.replicates, options.seed)
    for r, image in enumerate(images):
        write_cube(options.output.with_suffix(f".r{r:02d}.hdr"), image, bands)
    print(f"Mitsuba {mitsuba.__version__} ({options.variant}), {options.replicates} x {options.spp} samples per pixel")
    print_means(images, bands)
    return 0


if __name__ == "__main__":
    sys.exit(exit_code(main))
