"""Scenes that show which side of a shape is its front: a row of cells, each with a shape of another kind.

A cell is 12 pixels of 6 units wide. The shape is about (x, 0, 0), where flat ones lie in z = 0; beside it stand a receiver
above and one below, whose sides towards the shape are seen by an orthographic camera on its other side, from above (+Z) or
below. Cells are so far apart that a receiver sees less than 1 % of its own light from the neighbours. Inside closed shapes
rays begin in the plane z = 0: one shape of a pair is empty, in the other stands a receiver that faces up.
"""

import dataclasses
import itertools
import struct
import zlib

PIXEL, CELL, LIGHT, LOWER, UPPER, INNER = 6, 12, 5, 3, 7, 11
GROUP = 16  # cells of a scene

CORNERS = [(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)]
WINDINGS = {"ccw": [(0, 1, 2), (0, 2, 3)], "cw": [(0, 2, 1), (0, 3, 2)]}
UP, DOWN = (0, 0, 1), (0, 0, -1)
NORMALS = {
    "up": [UP] * 4,
    "down": [DOWN] * 4,
    "absent": [],
    "halves": [UP, UP, DOWN, DOWN],
    "leaning": [(0.6, 0, 0.8)] * 4,
    "leaning_down": [(0.6, 0, -0.8)] * 4,
}
TRANSFORMS = {
    "plain": "",
    "x": '<scale x="-1"/>',
    "z": '<scale z="-1"/>',
    "xyz": '<scale value="-1"/>',
}
BSDFS = {
    "none": "",
    "one-sided": '<bsdf type="diffuse"><spectrum name="reflectance" value="0.5"/></bsdf>',
    "twosided": '<bsdf type="twosided"><bsdf type="diffuse"><spectrum name="reflectance" value="0.5"/></bsdf></bsdf>',
}
# For surfaces, by a number near 0.9: Mitsuba 3.9.1 merges meshes with the same BSDF, and cannot merge all of them.
SURFACES = {
    "one-sided": '<bsdf type="diffuse"><spectrum name="reflectance" value="{:.6f}"/></bsdf>',
    "glass": '<bsdf type="dielectric"><float name="int_ior" value="{:.6f}"/><float name="ext_ior" value="0.6"/></bsdf>',
}
CLOSED = ("sphere", "cylinder", "cube")


@dataclasses.dataclass(frozen=True)
class Cell:
    kind: str  # of the shape
    mesh: str  # file name, or empty
    face_normals: bool
    flipped: bool
    transform: str
    bsdf: str

    def name(self):
        parts = [self.kind, self.mesh, "face_normals" * self.face_normals, "flip_normals" * self.flipped]
        return " ".join(part for part in parts + [f"to_world {self.transform}", f"bsdf {self.bsdf}"] if part)

    def xml(self, x, size, content):
        text = f'<shape type="{self.kind}"><boolean name="flip_normals" value="{str(self.flipped).lower()}"/>'
        if self.mesh:
            text += f'<string name="filename" value="{self.mesh}"/>'
            text += f'<boolean name="face_normals" value="{str(self.face_normals).lower()}"/>'
        if self.kind == "cylinder":
            text += '<point name="p0" value="0, -1, 0"/><point name="p1" value="0, 1, 0"/>'
        place = f'<scale value="{size}"/><translate x="{x}"/>'
        return text + f'<transform name="to_world">{TRANSFORMS[self.transform]}{place}</transform>{content}</shape>'


def write_obj(path, normals, winding):
    lines = ["v %g %g %g" % corner for corner in CORNERS] + ["vn %g %g %g" % normal for normal in normals]
    form = "{0}//{0}" if normals else "{0}"
    lines += ["f " + " ".join(form.format(corner + 1) for corner in face) for face in WINDINGS[winding]]
    path.write_text("\n".join(lines) + "\n")


def write_ply(path, normals, winding):
    names = ("x", "y", "z") + (("nx", "ny", "nz") if normals else ())
    header = ["ply", "format ascii 1.0", "element vertex 4"] + [f"property float {name}" for name in names]
    header += ["element face 2", "property list uchar int vertex_indices", "end_header"]
    rows = [corner + (normals[i] if normals else ()) for i, corner in enumerate(CORNERS)]
    rows += [(3,) + face for face in WINDINGS[winding]]
    path.write_text("\n".join(header + [" ".join(f"{value:g}" for value in row) for row in rows]) + "\n")


def write_serialized(path, normals, winding):
    """Version 4: single precision 0x1000, with normals 0x1."""
    body = struct.pack("<I", 0x1000 | (0x1 if normals else 0)) + b"square\0" + struct.pack("<QQ", 4, 2)
    for vector in CORNERS + list(normals):
        body += struct.pack("<3f", *vector)
    for face in WINDINGS[winding]:
        body += struct.pack("<3I", *face)
    data = struct.pack("<HH", 0x041C, 4) + zlib.compress(body)
    path.write_bytes(data + struct.pack("<QI", 0, 1))


WRITERS = {"obj": write_obj, "ply": write_ply, "serialized": write_serialized}


def write_meshes(folder):
    for (kind, write), (name, normals), winding in itertools.product(WRITERS.items(), NORMALS.items(), WINDINGS):
        write(folder / f"{name}_{winding}.{kind}", normals, winding)


def meshes(kinds, normals, windings, bsdfs):
    options = itertools.product(kinds, normals, windings, (False, True), (False, True), TRANSFORMS, bsdfs)
    return [Cell(kind, f"{n}_{w}.{kind}", face, flip, t, b) for kind, n, w, face, flip, t, b in options]


def shapes(kinds, bsdfs):
    return [Cell(k, "", False, flip, t, b) for k, flip, t, b in itertools.product(kinds, (False, True), TRANSFORMS, bsdfs)]


def table():
    """Cells by how they are looked at: lights beside receivers (flat, leaning normals, closed), lights from inside, surfaces."""
    plain = ("up", "down", "absent", "halves")
    flat = meshes(["obj"], plain, ["ccw"], BSDFS) + meshes(["obj"], plain, ["cw"], ["none"])
    flat += meshes(["ply", "serialized"], plain, ["ccw"], ["none"]) + shapes(("rectangle", "disk"), BSDFS)
    leaning = meshes(["obj"], ("leaning", "leaning_down"), WINDINGS, ["none"])
    closed = shapes(CLOSED, BSDFS)
    surfaces = [cell for cell in flat + leaning + closed if cell.bsdf == "none"]
    inside = shapes(CLOSED, ["none"])
    return {"flat": flat, "leaning": leaning, "closed": closed, "inside": inside, "surfaces": surfaces}


def groups(cells):
    return [cells[first : first + GROUP] for first in range(0, len(cells), GROUP)]


def width(cells):
    return CELL * len(cells)


def centre(index):
    return PIXEL * (CELL * index + LIGHT)


def camera(cells, above, near_clip):
    middle, z = PIXEL * (width(cells) - 1) / 2, 100 if above else -100
    zoom = width(cells) * PIXEL / 2
    return (
        f'<sensor type="orthographic"><float name="near_clip" value="{near_clip}"/><transform name="to_world">'
        f'<scale x="{zoom}" y="{zoom}"/><lookat origin="{middle}, 0, {z}" target="{middle}, 0, 0" up="0, 1, 0"/></transform>'
        f'<film type="hdrfilm"><integer name="width" value="{width(cells)}"/><integer name="height" value="1"/>'
        '<rfilter type="box"/></film><sampler type="independent"/></sensor>'
    )


def receiver(x, z, turn=""):
    place = f'{turn}<scale value="4"/><translate x="{x}" z="{z}"/>'
    white = '<bsdf type="diffuse"><spectrum name="reflectance" value="1"/></bsdf>'
    return f'<shape type="rectangle"><transform name="to_world">{place}</transform>{white}</shape>'


def scene(integrator, *parts):
    return f'<scene version="3.0.0">{integrator}{"".join(parts)}</scene>'


AREA = '<emitter type="area"><spectrum name="radiance" value="1"/></emitter>'
SKY = '<emitter type="constant"><spectrum name="radiance" value="1"/></emitter>'


def light_scene(cells, above, integrator):
    parts = [camera(cells, above, 0.01)]
    for i, cell in enumerate(cells):
        x = centre(i)
        parts.append(cell.xml(x, 4, BSDFS[cell.bsdf] + AREA))
        parts.append(receiver(x + 2 * PIXEL, 4, '<rotate x="1" angle="180"/>') + receiver(x - 2 * PIXEL, -4))
    return scene(integrator, *parts)


def inside_scene(cells, above, integrator):
    parts = [camera(cells, above, 100)]
    for i, cell in enumerate(cells):
        for x in (centre(i), centre(i) + 6 * PIXEL):
            parts.append(cell.xml(x, 6, BSDFS[cell.bsdf] + AREA))
        turn, z = ("", -1) if above else ('<rotate x="1" angle="180"/>', 1)
        parts.append(receiver(centre(i) + 6 * PIXEL, z, turn))
    return scene(integrator, *parts)


def surface_scene(cells, above, integrator, surface):
    """The shapes with one of SURFACES under a sky of radiance 1."""
    shapes = [c.xml(centre(i), 5, SURFACES[surface].format(0.9 + 1e-5 * i)) for i, c in enumerate(cells)]
    return scene(integrator, camera(cells, above, 0.01), SKY, *shapes)
