#!/usr/bin/env python3
"""Times renders of Raysect, and leaves their images: what `kiloband bench peers` calls.

Usage: time_raysect.py SCENE.xml --bands 400:700:8 -o STEM.hdr [--size NxN] [--spp N] [--rounds R] [--seed S] [--processes P]
       time_raysect.py SCENE.xml --load      reads it only: exit code 2 and the reason if it has what is not written for Raysect
       time_raysect.py --probe               prints the versions as JSON; exit code 2 and the reason if it cannot be used

Needs numpy and Raysect (`pip install raysect`). Scenes: diffuse_scenes.py. Prints JSON: "load_seconds" of reading the scene and making
Raysect's of it; "warm_up_seconds" of a first render of one sample per pixel, which builds its acceleration structures (and is thrown
away); "seconds" of each of the R renders after it, observe() alone. STEM.r00.hdr ... are their images.

How the scene is set up: Lambert surfaces; a light is Add(Lambert, UniformSurfaceEmitter) with importance 1, so that Raysect samples it, and
has an absorbing twin a millionth of its extent behind it, for Raysect's emits from both sides and ours from the front. PinholeCamera weighs rays by
their cosine to its axis: pixels are divided by its mean over the pixel. One path is one sample of one pixel and carries all bins
(spectral_rays = 1), one bin a channel; ray_max_depth is the scene's max_depth, which counts the same; all other settings are Raysect's defaults (a
fifth of the directions towards lights, roulette of 0.01 after 3 hits). Raysect multiplies averages over bins where the radiance is the average of
products: --bins-per-channel N makes bins narrower (of 8 channels of the Cornell box the first is 4.3 % too low with one, 0.03 % with 13).
With several processes (as many as processors by default) Raysect seeds its workers itself, and --seed has no effect; one process renders the same
image again for the same seed.
"""

import argparse
import json
import os
import pathlib
import platform
import random
import sys
import time

sys.dont_write_bytecode = True  # nothing is left in the source folder

try:
    import diffuse_scenes
    import numpy
    import render_mitsuba
    from diffuse_scenes import Impossible
except ImportError as error:
    print(f"time_raysect.py: Raysect is not installed: {error} (pip install raysect)", file=sys.stderr)
    sys.exit(2)

NO_LIMIT = 10**6  # Raysect's depth has one


def find_raysect():
    """The modules. throws Impossible  they are not installed"""
    try:
        import raysect
        import raysect.core.math.random
        import raysect.optical.observer
        import raysect.primitive
    except ImportError as error:
        raise Impossible("Raysect is not installed (pip install raysect)") from error
    return raysect


def spectral_function(raysect, spectrum):
    if len(spectrum.values) == 1:
        return raysect.optical.ConstantSF(float(spectrum.values[0]))
    return raysect.optical.InterpolatedSF(spectrum.wavelengths, spectrum.values)


def add_surface(raysect, world, surface):
    optical = raysect.optical
    material = optical.Lambert(spectral_function(raysect, surface.reflectance))
    if surface.radiance is not None:
        emitter = optical.UniformSurfaceEmitter(spectral_function(raysect, surface.radiance))
        material = optical.Add(material, emitter, surface_only=True)
        material.importance = 1
        vertices, triangles = diffuse_scenes.backs(surface)
        raysect.primitive.Mesh(vertices, triangles, closed=False, smoothing=False, parent=world, material=optical.AbsorbingSurface())
    raysect.primitive.Mesh(surface.vertices, surface.triangles, closed=False, smoothing=False, parent=world, material=material)


def place_of(raysect, camera):
    optical = raysect.optical
    forward = optical.Point3D(*camera.origin).vector_to(optical.Point3D(*camera.target))
    return optical.translate(*camera.origin) * optical.rotate_basis(forward, optical.Vector3D(*camera.up))


class Renderer:
    """A scene in Raysect, with a camera for channels of equal width."""

    def __init__(self, raysect, scene, size, bands, options):
        self.raysect, self.size, self.bands = raysect, size, bands
        self.cosines = diffuse_scenes.pixel_cosines(size, scene.camera.fov)
        self.world = raysect.optical.World()
        for surface in scene.surfaces:
            add_surface(raysect, self.world, surface)
        observer = raysect.optical.observer
        self.pipeline = observer.SpectralRadiancePipeline2D(accumulate=False)
        self.camera = observer.PinholeCamera((size, size), fov=scene.camera.fov, parent=self.world, pipelines=[self.pipeline])
        self.camera.transform = place_of(raysect, scene.camera)
        self.camera.frame_sampler = observer.FullFrameSampler2D()
        self.camera.min_wavelength, self.camera.max_wavelength = bands[0][0], bands[-1][1]
        self.camera.spectral_bins = len(bands) * options.bins_per_channel
        self.camera.spectral_rays = 1
        depth = NO_LIMIT if scene.max_depth < 0 else scene.max_depth
        self.camera.ray_extinction_min_depth = min(depth, self.camera.ray_extinction_min_depth)
        self.camera.ray_max_depth = depth
        if options.important_path_weight is not None:
            self.camera.ray_important_path_weight = options.important_path_weight
        self.camera.quiet = True
        engines = raysect.core
        self.camera.render_engine = engines.SerialEngine() if options.processes == 1 else engines.MulticoreEngine(options.processes)

    def render(self, spp, seed):
        """Returns seconds and float32 [line][sample][channel], W m^-2 sr^-1. The order of pixels is drawn from Python's numbers."""
        self.raysect.core.math.random.seed(seed)
        random.seed(seed)
        self.camera.pixel_samples = spp
        begin = time.perf_counter()
        self.camera.observe()
        seconds = time.perf_counter() - begin
        radiance = numpy.asarray(self.pipeline.frame.mean).transpose(1, 0, 2) / self.cosines[:, :, None]
        channels = radiance.reshape(self.size, self.size, len(self.bands), -1).mean(axis=3)
        widths = numpy.array([high - low for low, high in self.bands])
        return seconds, (channels * widths).astype(numpy.float32)


def checked_bands(text, scene):
    """throws Impossible  not of equal width and side by side, or outside a spectrum of the scene"""
    bands = render_mitsuba.parse_bands(text)
    edges = numpy.array([low for low, _ in bands] + [bands[-1][1]])
    widths = numpy.array([high - low for low, high in bands])
    if not (numpy.allclose(numpy.diff(edges), widths) and numpy.allclose(widths, widths[0])):
        raise Impossible("Raysect's bins have equal width and lie side by side: give first:last:number")
    for surface in scene.surfaces:
        for spectrum in filter(None, (surface.reflectance, surface.radiance)):
            if not spectrum.covers(edges[0], edges[-1]):
                raise Impossible(f"shape {surface.name}: a spectrum ends within the channels, where Raysect goes on and ours does not")
    return bands


def measure(raysect, options):
    width, height = (int(edge) for edge in options.size.split("x"))
    if width != height:
        raise Impossible("the image is not square: which edge has the field of view is not looked after")
    begin = time.perf_counter()
    scene = diffuse_scenes.read_scene(options.scene)
    bands = checked_bands(options.bands, scene)
    renderer = Renderer(raysect, scene, width, bands, options)
    result = {"load_seconds": time.perf_counter() - begin, "processes": options.processes, "seconds": []}
    result["warm_up_seconds"], _ = renderer.render(1, options.seed)
    for r in range(options.rounds):
        seconds, image = renderer.render(options.spp, options.seed + 1 + r)
        result["seconds"].append(seconds)
        render_mitsuba.write_cube(options.output.with_suffix(f".r{r:02d}.hdr"), image, bands, "Raysect")
    return result


def parse():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("scene", nargs="?")
    parser.add_argument("--bands", default="400:700:8")
    parser.add_argument("-o", dest="output", type=pathlib.Path)
    parser.add_argument("--size", default="64x64")
    parser.add_argument("--spp", type=int, default=64)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--processes", type=int, default=len(os.sched_getaffinity(0)))
    parser.add_argument("--bins-per-channel", type=int, default=1)
    parser.add_argument("--important-path-weight", type=float, help="fraction of directions that are drawn towards lights (Raysect's default: 0.2)")
    parser.add_argument("--load", action="store_true", help="read the scene as it stands, and nothing else")
    parser.add_argument("--probe", action="store_true", help="print the versions of Raysect and what it needs, as JSON")
    options = parser.parse_args()
    if not options.probe and not (options.scene and (options.output or options.load)):
        parser.error("SCENE.xml and -o are needed")
    return options


def main():
    options = parse()
    if options.load:
        diffuse_scenes.read_scene(options.scene)
        return 0
    raysect = find_raysect()
    if options.probe:
        print(json.dumps({"raysect": raysect.__version__, "python": platform.python_version(), "numpy": numpy.__version__}))
        return 0
    print(json.dumps(measure(raysect, options)))
    return 0


if __name__ == "__main__":
    sys.exit(render_mitsuba.exit_code(main))
