"""A sphere of a measured material under a lamp, by Slang: sphere.py material.hlsl PICTURE.npy [DEVICE [SLOPES.npy]]

Needs slangpy and numpy of PyPI. DEVICE is one of slangpy's, cpu by default, which needs a C++ compiler. SLOPES are the
derivatives by the direction to the light, by automatic differentiation. brdf.slang says how the HLSL is written.
"""
# needs: slangpy
import re
import sys
from pathlib import Path

import numpy as np
import slangpy

SIZE = 256


def differentiable(code):
    """Marks functions, structures and loops as Slang demands it. Loops that end at a variable have at most 64 steps."""
    def bounded(loop):
        return f"[MaxIters({loop[1] if loop[1].isdigit() else 64})] {loop[0]}"
    code = re.sub(r"(?m)^((?:float\d?|material_\w+) material_\w+\()", r"[Differentiable] \1", code)
    code = re.sub(r"(?m)^struct (\w+) {", r"struct \1 : IDifferentiable {", code)
    return re.sub(r"for \(int \w+ = \d+; \w+ < (\w+)", bounded, code)


text = Path(__file__).with_name("brdf.slang").read_text(encoding="utf-8")
code = differentiable(Path(sys.argv[1]).read_text(encoding="utf-8"))
device = slangpy.Device(type=getattr(slangpy.DeviceType, sys.argv[3] if len(sys.argv) > 3 else "cpu"))
module = device.load_module_from_source("brdf", text.replace("CODE\n", code + "\n", 1))
kernel = device.create_compute_kernel(device.link_program([module], [module.entry_point("draw")]))


def buffer():
    return device.create_buffer(element_count=3 * SIZE**2, struct_size=4, usage=slangpy.BufferUsage.unordered_access,
                                data=np.zeros(3 * SIZE**2, np.float32))


picture, slopes = buffer(), buffer()
kernel.dispatch(thread_count=[SIZE**2, 1, 1], vars={"picture": picture, "slopes": slopes})
for path, values in zip(sys.argv[2:3] + sys.argv[4:5], (picture, slopes)):
    np.save(path, values.to_numpy().view(np.float32).reshape(SIZE, SIZE, 3))
