"""Reads ENVI cubes of 32-bit floats and makes pictures of them."""

import re

import numpy


class CubeError(Exception):
    """The cube cannot be read; the message says why."""


def _fields(header_text):
    """Keys in lower case; values as text, those of lists without braces."""
    fields = {}
    for match in re.finditer(r"^\s*([^=\n;][^=\n]*?)\s*=\s*(\{[^}]*\}|[^\n]*)", header_text, re.MULTILINE):
        fields[match.group(1).lower()] = match.group(2).strip().strip("{}").strip()
    return fields


def read_cube(header):
    """header: path of X.hdr beside X.img. Returns float32 values [line][sample][band]."""
    try:
        fields = _fields(header.read_text(encoding="utf-8", errors="replace"))
        lines, samples, bands = (int(fields[key]) for key in ("lines", "samples", "bands"))
        if int(fields.get("data type", 4)) != 4:
            raise CubeError(f"{header.name}: data type {fields['data type']}, expected 4 (32-bit floats)")
        order = ">f4" if fields.get("byte order", "0") == "1" else "<f4"
        values = numpy.fromfile(
            header.with_suffix(".img"), order, lines * samples * bands, offset=int(fields.get("header offset", 0))
        )
    except OSError as error:
        raise CubeError(f"{header.name}: {error.strerror}") from error
    except (KeyError, ValueError) as error:
        raise CubeError(f"{header.name}: {error}") from error
    if values.size != lines * samples * bands or values.size == 0:
        raise CubeError(f"{header.name}: {values.size} values instead of {lines} x {samples} x {bands}")
    interleave = fields.get("interleave", "bsq").lower()
    shapes = {
        "bsq": ((bands, lines, samples), (1, 2, 0)),
        "bil": ((lines, bands, samples), (0, 2, 1)),
        "bip": ((lines, samples, bands), (0, 1, 2)),
    }
    if interleave not in shapes:
        raise CubeError(f"{header.name}: interleave {interleave}")
    shape, axes = shapes[interleave]
    return values.reshape(shape).transpose(axes)


def _lobe(nm, centre, below, above):
    return numpy.exp(-0.5 * ((nm - centre) / numpy.where(nm < centre, below, above)) ** 2)


def _cie(nm):
    """The CIE 1931 observer as sums of lobes: Wyman, Sloan and Shirley, JCGT 2(2), 2013. [channel][x, y, z]"""
    x = 1.056 * _lobe(nm, 599.8, 37.9, 31.0) + 0.362 * _lobe(nm, 442, 16, 26.7) - 0.065 * _lobe(nm, 501.1, 20.4, 26.2)
    y = 0.821 * _lobe(nm, 568.8, 46.9, 40.5) + 0.286 * _lobe(nm, 530.9, 16.3, 31.1)
    z = 1.217 * _lobe(nm, 437, 11.8, 36.0) + 0.681 * _lobe(nm, 459, 26.0, 13.8)
    return numpy.stack([x, y, z], axis=-1)


XYZ_TO_SRGB = numpy.array([[3.2406, -1.5372, -0.4986], [-0.9689, 1.8758, 0.0415], [0.0557, -0.2040, 1.0570]])


def is_visible(channels_nm):
    """Whether the channels are enough of the visible range to see colours by."""
    return len(channels_nm) >= 6 and min(c[0] for c in channels_nm) < 500 and max(c[1] for c in channels_nm) > 600


def false_colour_weights(channels_nm):
    """[channel][r, g, b]: means over the long, middle and short third of the channels (fewer than 3: grey)."""
    count = len(channels_nm)
    weights = numpy.zeros((count, 3))
    order = sorted(range(count), key=lambda k: sum(channels_nm[k]))
    for colour, part in enumerate(reversed(numpy.array_split(order, 3)) if count >= 3 else [order] * 3):
        weights[part, colour] = 1 / len(part)
    return weights


def colours(cube, channels_nm):
    """cube: [line][sample][channel], integrals over the channels. Returns bytes [line][sample][rgb]: the 98th
    percentile of the brightest component becomes white; equal-energy light is neutral."""
    bounds = numpy.array(channels_nm, float)
    values = numpy.nan_to_num(cube.astype(float), nan=0.0, posinf=0.0, neginf=0.0)
    if is_visible(channels_nm):
        linear = values @ _cie(bounds.mean(axis=1)) @ XYZ_TO_SRGB.T
        white = XYZ_TO_SRGB @ numpy.ones(3)
        linear = linear / white
    else:
        density = values / numpy.maximum(bounds[:, 1] - bounds[:, 0], 1e-12)
        linear = density @ false_colour_weights(channels_nm)
    brightest = linear.max(axis=2)
    top = numpy.percentile(brightest, 98) or brightest.max()
    linear = numpy.clip(linear / (top if top > 0 else 1), 0, 1)
    encoded = numpy.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
    return (255 * encoded + 0.5).astype(numpy.uint8)
