#!/usr/bin/env python3
"""Surfaces in Blender's Cycles: packages bpy, openexr and pillow of PyPI, in a Python of bpy's version. Without bpy nothing is tried.

Fits a surface to measurements, makes Blender's material by the script that `srbf export` writes, and draws a sphere under one
environment with Cycles, beside the measurement and the surface that `srbf render` draws. What Cycles loses against the measurement
is within 30 % of what the surface does. Argument 3, if given: a picture of them is written there.
Arguments: the program, a folder with rgl/.
"""
import importlib.util
import sys
import tempfile
from pathlib import Path

from checks import expect, finish, skip

if importlib.util.find_spec("bpy") is None:
    skip("no bpy")
import numpy as np
from support.visible_error import delta_e, displayed, exposure
from support.surface_drawing import BRUSHED, MATERIALS, drawn, drawn_by_cycles, errors_of, judge_brushed, judge_errors, on_sphere, run

data = Path(sys.argv[2])
OWN_FORMULAS = {"cg_sunflower_rgb", "colodur_napoli_4f_rgb", "paper_white_rgb"}  # farther apart by Cycles' own, which docs/surface.md names
inside, rows = on_sphere(), []
with tempfile.TemporaryDirectory() as folder:
    for name in MATERIALS:
        measured, model = data / f"rgl/{name}.bsdf", f"{folder}/{name}.srbf"
        run("fit", measured, "--model", "principled", "-o", model)
        run("export", model, "--to", "principled", "-o", f"{folder}/{name}.py")
        pictures = [drawn(subject, f"{folder}/{name}-{i}.exr") for i, subject in enumerate((measured, model))]
        pictures.append(drawn_by_cycles(f"{folder}/{name}.py", f"{folder}/{name}-cycles.exr"))
        reference, surface, cycles = (picture[inside] for picture in pictures)
        expect(*judge_errors(name, "Cycles", errors_of(reference, surface, cycles), OWN_FORMULAS))
        by = exposure(reference)
        rows.append(np.concatenate([displayed(picture, by) for picture in pictures], axis=1))
    run("export", BRUSHED, "--to", "principled", "-o", f"{folder}/brushed.py")
    ours, cycles = drawn(BRUSHED, f"{folder}/brushed.exr"), drawn_by_cycles(f"{folder}/brushed.py", f"{folder}/brushed-cycles.exr")
    expect(*judge_brushed("Cycles", delta_e(cycles[inside], ours[inside])))
    rows.append(np.concatenate([displayed(picture, exposure(ours[inside])) for picture in (0 * ours, ours, cycles)], axis=1))
if len(sys.argv) > 3:
    from PIL import Image
    Image.fromarray(np.concatenate(rows)).save(sys.argv[3])
finish()
