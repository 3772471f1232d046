"""Scene files that are made of diffuse meshes and diffuse area lights alone, as plain arrays: what Raysect can be given.

Whatever else a scene has is refused with a reason, so that nothing of it is left out in silence. Lengths and spectra are the file's.
"""

import dataclasses
import pathlib
import sys
import xml.etree.ElementTree as ElementTree

import numpy

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "mitsuba"))

import render_mitsuba  # noqa: E402
from render_mitsuba import Impossible  # noqa: E402


@dataclasses.dataclass
class Spectrum:
    """Joined by straight lines; a constant has one point and holds for every wavelength."""

    wavelengths: numpy.ndarray  # nm, ascending
    values: numpy.ndarray

    def covers(self, low, high):
        return len(self.values) == 1 or (self.wavelengths[0] <= low and high <= self.wavelengths[-1])


@dataclasses.dataclass
class Surface:
    name: str
    vertices: numpy.ndarray  # [n][3]
    triangles: list  # [(a, b, c)] into the vertices, counter-clockwise from the front
    reflectance: Spectrum
    radiance: Spectrum | None  # of the front, W m^-2 sr^-1 nm^-1; None: no light


@dataclasses.dataclass
class Camera:
    origin: tuple
    target: tuple
    up: tuple
    fov: float  # degrees, of an edge of a square image


@dataclasses.dataclass
class DiffuseScene:
    camera: Camera
    max_depth: int  # -1: no limit; 1: emission only, 2: direct light
    surfaces: list


def expect(element, kind, children):
    """throws Impossible  another type, or something in it that is not among children ("tag" or "tag:name")"""
    if element.get("type", kind) != kind:
        raise Impossible(f"{element.tag} {element.get('type')}: only {kind} is written for Raysect")
    what = f"{element.tag} {kind or ''}".strip()
    for child in element:
        names = (child.tag, f"{child.tag}:{child.get('name')}")
        if not any(name in children for name in names):
            raise Impossible(f"{what}: {child.tag} {child.get('name') or child.get('type') or ''} is not written for Raysect")


def the_one(parent, tag, name=None):
    """The only child of that tag (and name). throws Impossible  there is none, or more"""
    found = [child for child in parent.findall(tag) if name is None or child.get("name") == name]
    if len(found) != 1:
        raise Impossible(f"{parent.tag}: {len(found)} elements {tag} {name or ''} where one is needed")
    return found[0]


def value_of(parent, tag, name, default):
    """The text of a parameter."""
    found = [child.get("value") for child in parent.findall(tag) if child.get("name") == name]
    return found[0] if found else default


def with_defaults(root):
    """Every $name is what <default> says; <default> is gone."""
    values = {element.get("name"): element.get("value") for element in root.findall("default")}
    for element in root.findall("default"):
        root.remove(element)
    for element in root.iter():
        for key, text in element.attrib.items():
            for name in sorted(values, key=len, reverse=True):
                text = text.replace(f"${name}", values[name])
            element.set(key, text)
    return root


def read_spectrum(element):
    """A constant, or two columns of a file: nm, value."""
    if element.get("value") is not None:
        try:
            return Spectrum(numpy.array([0.0]), numpy.array([float(element.get("value"))]))
        except ValueError as error:
            raise Impossible(f"spectrum {element.get('name')}: only constants and files are written for Raysect") from error
    if element.get("filename") is None:
        raise Impossible(f"spectrum {element.get('name')}: only constants and files are written for Raysect")
    columns = numpy.loadtxt(element.get("filename"), ndmin=2)
    if columns.shape[1] != 2 or not (numpy.diff(columns[:, 0]) > 0).all():
        raise Impossible(f"{element.get('filename')}: not two columns of ascending wavelengths")
    return Spectrum(columns[:, 0].copy(), columns[:, 1].copy())


def read_obj(file):
    """Vertices and triangles; polygons become fans. Normals and coordinates of textures do not matter to flat diffuse faces."""
    vertices, triangles = [], []
    for line in pathlib.Path(file).read_text(encoding="utf-8").splitlines():
        words = line.split()
        if words[:1] == ["v"]:
            vertices.append([float(word) for word in words[1:4]])
        if words[:1] == ["f"]:
            corners = [int(word.split("/")[0]) for word in words[1:]]
            corners = [c - 1 if c > 0 else len(vertices) + c for c in corners]
            triangles += [(corners[0], corners[k], corners[k + 1]) for k in range(1, len(corners) - 1)]
    return numpy.array(vertices), triangles


def has_normals(file):
    return any(line.startswith("vn ") for line in pathlib.Path(file).read_text(encoding="utf-8").splitlines())


def read_diffuse(bsdf):
    expect(bsdf, "diffuse", ["spectrum:reflectance"])
    return read_spectrum(the_one(bsdf, "spectrum", "reflectance"))


def read_emitter(shape):
    emitters = shape.findall("emitter")
    if not emitters:
        return None
    emitter = the_one(shape, "emitter")
    expect(emitter, "area", ["spectrum:radiance"])
    return read_spectrum(the_one(emitter, "spectrum", "radiance"))


def read_surface(shape, materials):
    """materials: {id: reflectance}"""
    expect(shape, "obj", ["string:filename", "boolean:face_normals", "bsdf", "ref", "emitter"])
    file = value_of(shape, "string", "filename", "")
    if has_normals(file) and value_of(shape, "boolean", "face_normals", "false") != "true":
        raise Impossible(f"{file}: smooth normals are not written for Raysect")
    own = [read_diffuse(bsdf) for bsdf in shape.findall("bsdf")] + [materials.get(ref.get("id")) for ref in shape.findall("ref")]
    if len(own) != 1 or own[0] is None:
        raise Impossible(f"shape {shape.get('id') or ''}: one diffuse BSDF is needed")
    vertices, triangles = read_obj(file)
    return Surface(shape.get("id") or "", vertices, triangles, own[0], read_emitter(shape))


def numbers(text):
    return tuple(float(word) for word in text.replace(",", " ").split())


def read_camera(sensor):
    expect(sensor, "perspective", ["float:fov", "transform:to_world", "sampler", "film"])
    transform = the_one(sensor, "transform")
    expect(transform, None, ["lookat"])
    lookat = the_one(transform, "lookat")
    filters = [rfilter.get("type") for rfilter in sensor.iter("rfilter")]
    if filters != ["box"]:
        raise Impossible("the film's filter is not a box: a pixel of Raysect's camera is one")
    origin, target, up = (numbers(lookat.get(key, "")) for key in ("origin", "target", "up"))
    return Camera(origin, target, up, float(the_one(sensor, "float", "fov").get("value")))


def read_scene(file):
    """throws Impossible  it has what is not written for Raysect; the message says what"""
    root = with_defaults(ElementTree.fromstring(render_mitsuba.adapted(file)))
    expect(root, None, ["integrator", "sensor", "bsdf", "shape"])
    integrator = the_one(root, "integrator")
    expect(integrator, "path", ["integer:max_depth", "integer:rr_depth"])
    materials = {bsdf.get("id"): read_diffuse(bsdf) for bsdf in root.findall("bsdf")}
    surfaces = [read_surface(shape, materials) for shape in root.findall("shape")]
    max_depth = int(value_of(integrator, "integer", "max_depth", "-1"))
    return DiffuseScene(read_camera(the_one(root, "sensor")), max_depth, surfaces)


def backs(surface):
    """Vertices and triangles of the same triangles, moved back by a millionth of the surface's extent, each with vertices of its own."""
    corners = surface.vertices[numpy.array(surface.triangles)]
    normals = numpy.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= numpy.linalg.norm(normals, axis=1, keepdims=True)
    distance = 1e-6 * numpy.ptp(surface.vertices, axis=0).max()
    moved = (corners - distance * normals[:, None, :]).reshape(-1, 3)
    return moved, [(3 * t, 3 * t + 1, 3 * t + 2) for t in range(len(corners))]


def pixel_cosines(size, fov, parts=16):
    """Mean over each pixel of the cosine between its rays and the camera's axis: [line][sample] of a square image."""
    edge = numpy.tan(numpy.radians(fov) / 2)
    places = edge * (2 * (numpy.arange(size * parts) + 0.5) / (size * parts) - 1)
    cosines = 1 / numpy.sqrt(1 + places[:, None] ** 2 + places[None, :] ** 2)
    return cosines.reshape(size, parts, size, parts).mean(axis=(1, 3))
