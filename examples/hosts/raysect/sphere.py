#!/usr/bin/env python3
"""A sphere of a measured material under a lamp of raysect: sphere.py material.h PICTURE.npy

Needs raysect and numpy of PyPI, and a C compiler. The C is written by `srbf export material.srbf --to c -o material.h`. The three
bins of raysect's spectra stand for R, G and B.
"""
import ctypes
import subprocess
import sys
import tempfile
from math import pi, sqrt
from pathlib import Path

import numpy as np
from raysect.core import rotate, translate
from raysect.optical import ConstantSF, World
from raysect.optical.material import ContinuousBSDF, Lambert, UniformSurfaceEmitter
from raysect.optical.observer import FullFrameSampler2D, PinholeCamera, SpectralRadiancePipeline2D
from raysect.primitive import Sphere


class Vec3(ctypes.Structure):
    _fields_ = [("x", ctypes.c_float), ("y", ctypes.c_float), ("z", ctypes.c_float)]


def compiled(header):
    """material_brdf of the exported C."""
    with tempfile.TemporaryDirectory() as folder:
        source, library = Path(folder, "brdf.c"), Path(folder, "brdf.so")
        source.write_text(f'#include "{Path(header).resolve()}"\nsrbf_vec3 value(srbf_vec3 wl, srbf_vec3 wv) {{ return material_brdf(wl, wv); }}\n')
        subprocess.run(["cc", "-O2", "-shared", "-fPIC", source, "-o", library, "-lm"], check=True)
        value = ctypes.CDLL(str(library)).value
    value.argtypes, value.restype = [Vec3, Vec3], Vec3
    return value


class Measured(ContinuousBSDF):
    """raysect's incoming direction is the one to the viewer, the outgoing one that to the light; z is the normal."""

    def __init__(self, brdf):
        super().__init__()
        self.brdf, self.diffuse = brdf, Lambert()

    def pdf(self, incoming, outgoing, back_face):
        return self.diffuse.pdf(incoming, outgoing, back_face)

    def sample(self, incoming, back_face):
        return self.diffuse.sample(incoming, back_face)

    def evaluate_shading(self, world, ray, incoming, outgoing, outside, inside, back_face, to_surface, to_world, intersection):
        if outgoing.z <= 0 or incoming.z <= 0:
            return ray.new_spectrum()
        spectrum = ray.spawn_daughter(outside, outgoing.transform(to_world)).trace(world)
        f = self.brdf(Vec3(outgoing.x, outgoing.y, outgoing.z), Vec3(incoming.x, incoming.y, incoming.z))
        spectrum.samples[:] = spectrum.samples * np.array([f.x, f.y, f.z]) * outgoing.z
        return spectrum


world = World()
Sphere(1, world, material=Measured(compiled(sys.argv[1])))
radius = 0.005  # of the lamp, seen from the sphere
lamp = Sphere(1000 * radius, world, translate(*(1000 / sqrt(17) * x for x in (-2, 2, 3))))
lamp.material = UniformSurfaceEmitter(ConstantSF(1), 3 / (pi * radius**2))
lamp.material.importance = 1
radiance = SpectralRadiancePipeline2D()
camera = PinholeCamera((256, 256), fov=26, parent=world, transform=translate(0, 0, 5) * rotate(180, 0, 0), pipelines=[radiance],
                       frame_sampler=FullFrameSampler2D())
camera.pixel_samples, camera.spectral_bins, camera.ray_important_path_weight, camera.ray_extinction_prob = 4, 3, 1, 0
camera.quiet = True
camera.observe()
np.save(sys.argv[2], radiance.frame.mean.transpose(1, 0, 2))
