#!/usr/bin/env python3
"""Surfaces in Blender's Cycles: packages bpy, openexr and pillow of PyPI, in a Python of bpy's version. Without bpy nothing is tried.

Fits a surface to measurements, makes Blender's material by the script that `srbf export` writes, and draws a sphere under one
environment with Cycles, beside the measurement and the surface that `srbf render` draws. What Cycles loses against the measurement
is within 30 % of what the surface does. Argument 3, if given: a picture of them is written there.
Arguments: the program, a folder with rgl/.
"""
import importlib.util
import math
import sys
import tempfile
from pathlib import Path

if importlib.util.find_spec("bpy") is None:
    print("skipped: no bpy")
    sys.exit(0)
import bpy
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
from seen import delta_e, displayed, exposure  # noqa: E402
from surface_host import BRUSHED, DISTANCE, ELEVATION, FIELD, MATERIALS, SAMPLES, SIZE, draws_brushed, environment, holds, lost, on_sphere, pixels_of, run  # noqa: E402

data = Path(sys.argv[2])
OWN_FORMULAS = {"cg_sunflower_rgb", "colodur_napoli_4f_rgb", "paper_white_rgb"}  # farther apart by Cycles' own, which docs/surface.md names


def drawn_by_cycles(script, out):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    exec(compile(Path(script).read_text(encoding="utf-8"), str(script), "exec"), {})
    material = bpy.data.materials[0]
    bpy.ops.mesh.primitive_uv_sphere_add(segments=192, ring_count=96, radius=1)
    sphere = bpy.context.object
    bpy.ops.object.shade_smooth()
    sphere.data.materials.append(material)
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    camera.location = (0, -DISTANCE * math.cos(ELEVATION), DISTANCE * math.sin(ELEVATION))
    camera.rotation_euler = (math.pi / 2 - ELEVATION, 0, 0)
    camera.data.angle = FIELD
    scene = bpy.context.scene
    scene.collection.objects.link(camera)
    scene.camera = camera
    scene.world = bpy.data.worlds.new("world")
    scene.world.use_nodes = True
    nodes, links = scene.world.node_tree.nodes, scene.world.node_tree.links
    texture = nodes.new("ShaderNodeTexEnvironment")
    texture.image = bpy.data.images.load(str(environment))
    texture.image.colorspace_settings.name = "Linear Rec.709"
    coordinates, turn = nodes.new("ShaderNodeTexCoord"), nodes.new("ShaderNodeMapping")
    turn.inputs["Rotation"].default_value[2] = -math.pi / 2  # the middle of the picture lies behind the sphere
    background = next(n for n in nodes if n.type == "BACKGROUND")
    links.new(coordinates.outputs["Generated"], turn.inputs["Vector"])
    links.new(turn.outputs["Vector"], texture.inputs["Vector"])
    links.new(texture.outputs["Color"], background.inputs["Color"])
    scene.render.engine = "CYCLES"
    scene.cycles.samples, scene.cycles.use_denoising, scene.cycles.seed = SAMPLES, False, 1
    scene.cycles.use_adaptive_sampling = False
    scene.cycles.pixel_filter_type = "BOX"
    scene.cycles.filter_width = 1
    scene.cycles.sample_clamp_indirect = 0
    scene.render.resolution_x = scene.render.resolution_y = SIZE
    scene.render.film_transparent = True
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.filepath = str(out)
    bpy.ops.render.render(write_still=True)
    return pixels_of(out)


def drawn(subject, out):
    """By `srbf render`."""
    run("render", subject, "-o", out, "--mesh", "sphere", "--env", environment, "--no-ground", "--no-occlusion", "--size", f"{SIZE}x{SIZE}", "--spp", SAMPLES)
    return pixels_of(out)


inside, rows, failures = on_sphere(), [], []
with tempfile.TemporaryDirectory() as folder:
    for name in MATERIALS:
        measured, model = data / f"rgl/{name}.bsdf", f"{folder}/{name}.srbf"
        run("fit", measured, "--model", "openpbr", "--surface", "principled", "-o", model)
        run("export", model, "--to", "blender", "-o", f"{folder}/{name}.py")
        pictures = [drawn(subject, f"{folder}/{name}-{i}.exr") for i, subject in enumerate((measured, model))]
        pictures.append(drawn_by_cycles(f"{folder}/{name}.py", f"{folder}/{name}-cycles.exr"))
        reference, surface, cycles = (of[inside] for of in pictures)
        if not holds(name, "Cycles", lost(reference, surface, cycles), OWN_FORMULAS):
            failures.append(name)
        by = exposure(reference)
        rows.append(np.concatenate([displayed(of, by) for of in pictures], axis=1))
    run("export", BRUSHED, "--to", "blender", "-o", f"{folder}/brushed.py")
    ours, cycles = drawn(BRUSHED, f"{folder}/brushed.exr"), drawn_by_cycles(f"{folder}/brushed.py", f"{folder}/brushed-cycles.exr")
    if not draws_brushed("Cycles", delta_e(cycles[inside], ours[inside])):
        failures.append("brushed")
    rows.append(np.concatenate([displayed(of, exposure(ours[inside])) for of in (0 * ours, ours, cycles)], axis=1))
if len(sys.argv) > 3:
    from PIL import Image
    Image.fromarray(np.concatenate(rows)).save(sys.argv[3])
sys.exit(bool(failures))
