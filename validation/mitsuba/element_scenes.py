#!/usr/bin/env python3
"""Scenes that use each element of Mitsuba 3 in the ways that its documentation shows, one of them in each scene.

Usage: element_scenes.py FOLDER

Writes FOLDER/KIND_NAME.xml and the files that the scenes need. A scene is a room of one kind, in which one part is another:
the tables are elements/*.xml, whose children say what that is. Their attributes: `name`; `in`: the part of the room that they take the
place of (`lit`: only the lights of the room; `whole`: the text is the scene); a text with an integrator replaces the room's; `differs`: why images are known to.
"""

import pathlib
import re
import struct
import sys
import zlib

HERE = pathlib.Path(__file__).resolve().parent

GREY = '<spectrum name="{}" value="300:{}, 900:{}"/>'
ROOM = {
    "integrator": '<integrator type="path"/>',
    "sensor": """<sensor type="perspective">
        <float name="fov" value="35"/>
        <transform name="to_world"><lookat origin="0, -5, 3" target="0, 0, 0.8" up="0, 0, 1"/></transform>
        FILM SAMPLER
    </sensor>""",
    "film": '<film type="hdrfilm"><integer name="width" value="64"/><integer name="height" value="64"/>FILTER</film>',
    "rfilter": '<rfilter type="box"/>',
    "sampler": '<sampler type="independent"><integer name="sample_count" value="16"/></sampler>',
    "light": """<shape type="rectangle">
        <transform name="to_world"><rotate x="1" angle="180"/><translate x="0.5" y="-1" z="4"/></transform>
        <emitter type="area"><spectrum name="radiance" value="300:3, 900:5"/></emitter>
    </shape>""",
    "emitter": '<emitter type="constant"><spectrum name="radiance" value="300:0.6, 900:0.4"/></emitter>',
    "shape": '<shape type="sphere"><point name="center" x="0" y="0" z="1"/><float name="radius" value="1"/>BSDF</shape>',
    "bsdf": '<bsdf type="diffuse"><spectrum name="reflectance" value="300:0.3, 900:0.7"/></bsdf>',
    "floor": """<shape type="rectangle">
        <transform name="to_world"><scale value="3"/></transform>
        <bsdf type="twosided"><bsdf type="diffuse"><spectrum name="reflectance" value="300:0.5, 900:0.4"/></bsdf></bsdf>
    </shape>""",
}
# Elements that are a parameter of the room's material or lamp.
WRAPS = {
    "reflectance": ("bsdf", '<bsdf type="diffuse">{}</bsdf>'),
    "radiance": ("emitter", '<emitter type="constant">{}</emitter>'),
    "band": ("film", '<film type="specfilm"><integer name="width" value="64"/><integer name="height" value="64"/>{}FILTER</film>'),
}


def scene(place, text):
    """The room with `text` in the place of one of its parts."""
    if place == "whole":
        return text
    parts = dict(ROOM)
    if place in WRAPS:
        place, frame = WRAPS[place]
        text = frame.replace("{}", text)
    if place == "lit":  # instead of the sky, and with the room's lamp out
        place, parts["light"] = "emitter", ""
    if "<integrator" in text:
        parts["integrator"] = ""
    parts[place] = text
    sensor = parts["sensor"].replace("SAMPLER", parts["sampler"]).replace("FILM", parts["film"])
    lines = [parts["integrator"], sensor.replace("FILTER", parts["rfilter"]), parts["light"], parts["emitter"], parts["floor"]]
    lines.append(parts["shape"].replace("BSDF", parts["bsdf"]))
    return '<scene version="3.0.0">\n    ' + "\n    ".join(line.strip() for line in lines if line) + "\n</scene>\n"


def read_table(file):
    """[(name, place, known difference, text)] in their order. The text is kept as it stands, for the scene of a user has its own ways of writing."""
    pattern = re.compile(r'^<element name="([^"]+)" in="([^"]+)"(?: differs="([^"]+)")?>\n(.*?)^</element>$', re.DOTALL | re.MULTILINE)
    return pattern.findall(file.read_text())


def tables():
    return {file.stem: read_table(file) for file in sorted((HERE / "elements").glob("*.xml"))}


def write_png(file, rows, channels):
    """8 bits a channel; rows of tuples."""

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    raw = b"".join(b"\0" + bytes(v for pixel in row for v in pixel) for row in rows)
    size = struct.pack(">IIBBBBB", len(rows[0]), len(rows), 8, 2 if channels == 3 else 0, 0, 0, 0)
    file.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", size) + chunk(b"IDAT", zlib.compress(raw)) + chunk(b"IEND", b""))


def write_pfm(file, rows):
    """Floats, three a pixel; rows from the top."""
    data = b"".join(struct.pack(f"<{3 * len(row)}f", *(v for pixel in row for v in pixel)) for row in reversed(rows))
    file.write_bytes(f"PF\n{len(rows[0])} {len(rows)}\n-1.0\n".encode() + data)


def write_images(folder):
    grey = [[(40 + 23 * ((3 * x + 5 * y) % 9),) for x in range(8)] for y in range(8)]
    write_png(folder / "grey.png", grey, 1)
    write_png(folder / "wood.png", [[(v, v, v) for (v,) in row] for row in grey], 3)
    write_png(folder / "leaf_mask.png", [[(255 * ((x // 2 + y // 2) % 2),) for x in range(8)] for y in range(8)], 1)
    write_png(folder / "pale.png", [[(120 + 9 * x, 150, 180 - 8 * y) for x in range(8)] for y in range(8)], 3)
    normals = [[(128 + 20 * ((x + y) % 3 - 1), 128 + 20 * (x % 3 - 1), 250) for x in range(8)] for y in range(8)]
    write_png(folder / "normals.png", normals, 3)
    sky = [[(0.2 + 0.1 * ((x + 2 * y) % 5),) * 3 for x in range(16)] for y in range(8)]
    write_pfm(folder / "sky.pfm", sky)


CORNERS = [(-1, -1, 0.1), (1, -1, 0.1), (1, 1, 0.1), (-1, 1, 0.1), (0, 0, 1.7)]  # not in the plane of the floor
FACES = [(0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4), (0, 3, 2), (0, 2, 1)]


def write_meshes(folder):
    obj = "".join(f"v {x} {y} {z}\n" for x, y, z in CORNERS) + "".join(f"vt {(x + 1) / 2} {(y + 1) / 2}\n" for x, y, z in CORNERS)
    (folder / "tent.obj").write_text(obj + "".join("f " + " ".join(f"{i + 1}/{i + 1}" for i in face) + "\n" for face in FACES))
    head = f"ply\nformat ascii 1.0\nelement vertex {len(CORNERS)}\n" + "".join(f"property float {n}\n" for n in "xyzrgb")
    head += f"element face {len(FACES)}\nproperty list uchar int vertex_indices\nproperty float w_1\nend_header\n"
    shades = [0.3, 0.4, 0.5, 0.6, 0.7]
    body = "".join(f"{x} {y} {z} {s} {s} {s}\n" for (x, y, z), s in zip(CORNERS, shades))
    (folder / "tent.ply").write_text(head + body + "".join(f"3 {a} {b} {c} {0.2 + 0.1 * i}\n" for i, (a, b, c) in enumerate(FACES)))
    vertices = b"".join(struct.pack("<3f", *corner) for corner in CORNERS) + b"".join(struct.pack("<3I", *face) for face in FACES)
    mesh = struct.pack("<I", 0x1000) + b"tent\0" + struct.pack("<QQ", len(CORNERS), len(FACES)) + vertices
    stored = struct.pack("<HH", 0x041C, 4) + zlib.compress(mesh)
    (folder / "tent.serialized").write_bytes(stored + struct.pack("<QI", 0, 1))


def write_spectra(folder):
    points = [(300 + 50 * i, 0.3 + 0.05 * ((3 * i) % 7)) for i in range(13)]
    (folder / "paint.spd").write_text("# nm value\n" + "".join(f"{nm} {v:g}\n" for nm, v in points))
    (folder / "silver.eta.spd").write_text("".join(f"{nm} {0.2 + 0.0001 * (nm - 300):g}\n" for nm, _ in points))
    (folder / "silver.k.spd").write_text("".join(f"{nm} {2 + 0.006 * (nm - 300):g}\n" for nm, _ in points))
    (folder / "part.xml").write_text('<scene version="3.0.0">\n<bsdf type="diffuse" id="part"/>\n</scene>\n')
    (folder / "parts").mkdir(exist_ok=True)
    (folder / "parts" / "far.spd").write_text((folder / "paint.spd").read_text())


def write_scenes(folder):
    """All scenes and the files that they need; returns [(name, known difference)]."""
    folder.mkdir(parents=True, exist_ok=True)
    write_images(folder)
    write_meshes(folder)
    write_spectra(folder)
    names = []
    for kind, elements in tables().items():
        for name, place, known, text in elements:
            names.append((f"{kind}_{name}", known))
            (folder / f"{kind}_{name}.xml").write_text(scene(place, text))
    return names


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    print(f"{len(write_scenes(pathlib.Path(sys.argv[1])))} scenes")
