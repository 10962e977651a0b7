"""A sphere of a measured material under a lamp of Mitsuba 3: sphere.py material.srbf PICTURE.npy

Needs mitsuba and numpy of PyPI, and the Python package srbf.
"""
# needs: numpy1 mitsuba srbf
import sys

import mitsuba as mi
import numpy as np

mi.set_variant("scalar_rgb")
import srbf.mitsuba  # noqa: E402, F401

scene = mi.load_dict({
    "type": "scene",
    "integrator": {"type": "direct", "emitter_samples": 1, "bsdf_samples": 0},
    "lamp": {"type": "directional", "direction": [2, -2, -3], "irradiance": {"type": "rgb", "value": 3}},
    "ball": {"type": "sphere", "bsdf": {"type": "srbf", "filename": sys.argv[1]}},
    "sensor": {
        "type": "perspective", "fov": 26, "to_world": mi.ScalarTransform4f().look_at(origin=[0, 0, 5], target=[0, 0, 0], up=[0, 1, 0]),
        "film": {"type": "hdrfilm", "width": 256, "height": 256, "pixel_format": "rgb", "component_format": "float32",
                 "rfilter": {"type": "box"}},
        "sampler": {"type": "stratified", "sample_count": 16},
    },
})
np.save(sys.argv[2], np.array(mi.render(scene)))
