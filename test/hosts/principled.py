"""Checks surfaces in Blender's Cycles.

The test fits a surface to measurements and makes Blender's material by the script that `srbf export` writes. Cycles draws
a sphere of it under one environment, and `srbf render` draws the measurement and the surface. The error of Cycles' picture
against the measurement is at most 30 % larger than that of the surface, or LARGEST_RATIOS times as large if Cycles uses
another formula.
Usage: principled.py PROGRAM DATA [PICTURE], where DATA contains rgl/. It also needs bpy of PyPI in a Python of its version.
"""
# needs: numpy openexr pillow
import importlib.util
import tempfile

from support.checks import arguments, finish, skip, srbf

if importlib.util.find_spec("bpy") is None:
    skip("no bpy")
import numpy as np
from support.visible_error import delta_e, displayed, exposure
from support.surface_drawing import BRUSHED, MATERIALS, drawn, drawn_by_cycles, errors_of, expect_brushed, expect_errors, on_sphere

_, data, further = arguments()
# By formulas of Cycles' own, which docs/surface.md names: its figures, and 15 % more.
LARGEST_RATIOS = {"cg_sunflower_rgb": 1.6, "colodur_napoli_4f_rgb": 1.45}
inside, rows = on_sphere(), []
with tempfile.TemporaryDirectory() as folder:
    for name in MATERIALS:
        measured, model = data / f"rgl/{name}.bsdf", f"{folder}/{name}.srbf"
        srbf("fit", measured, "--model", "principled", "-o", model)
        srbf("export", model, "--to", "principled", "-o", f"{folder}/{name}.py")
        pictures = [drawn(subject, f"{folder}/{name}-{i}.exr") for i, subject in enumerate((measured, model))]
        pictures.append(drawn_by_cycles(f"{folder}/{name}.py", f"{folder}/{name}-cycles.exr"))
        reference, surface, cycles = (picture[inside] for picture in pictures)
        expect_errors(name, "Cycles", errors_of(reference, surface, cycles), LARGEST_RATIOS)
        by = exposure(reference)
        rows.append(np.concatenate([displayed(picture, by) for picture in pictures], axis=1))
    srbf("export", BRUSHED, "--to", "principled", "-o", f"{folder}/brushed.py")
    ours, cycles = drawn(BRUSHED, f"{folder}/brushed.exr"), drawn_by_cycles(f"{folder}/brushed.py", f"{folder}/brushed-cycles.exr")
    expect_brushed("Cycles", delta_e(cycles[inside], ours[inside]))
    rows.append(np.concatenate([displayed(picture, exposure(ours[inside])) for picture in (0 * ours, ours, cycles)], axis=1))
if further:
    from PIL import Image
    Image.fromarray(np.concatenate(rows)).save(further[0])
finish()
