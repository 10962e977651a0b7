"""Checks materials of nodes in Blender's Cycles.

The script that `srbf export --to blender` writes makes the materials of measurements, and Cycles draws a sphere of each. The script's
tables hold closures, and "the formula" is the sum of these closures. Checks:
  - Under a distant lamp, the picture agrees with the formula.
  - Under environments and round lamps, the picture is nearer to that of the measurement than a picture by Principled's parameters.
  - In a furnace, no pixel is brighter than FURNACE_WITHIN.
  - With a normal map, the picture agrees with the formula.
  - The materials of film.blend and library.blend agree with the formula.
  - A .blend file with two materials has both as assets with previews, and the picture of one of them agrees with the formula.
  - The shader that `--to osl` writes agrees with its formula.
  - Within the noise of paths, that shader is no farther from the measurement than the nodes.

Usage: blender.py PROGRAM DATA [PICTURE], where DATA contains rgl/. The environment variable SRBF_ENVIRONMENTS names
environments that are tried beside the bundled one, separated by colons. It also needs bpy of PyPI in a Python of its version.
"""
# needs: numpy openexr pillow
import importlib.util
import math
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

from support.checks import ROOT, arguments, expect, finish, skip, srbf

if importlib.util.find_spec("bpy") is None:
    skip("no bpy")
import numpy as np
from support.visible_error import delta_e, displayed, exposure
from support.surface_drawing import DISTANCE, ELEVATION, FIELD, MATERIALS, SIZE, drawn, drawn_by_cycles, on_sphere, studio

_, data, further = arguments()
LAMP = (0.6, -0.5, 0.62)
ROUND_LAMPS = {"lamp": ((-50, 40), 4), "lamp behind": ((120, 20), 8)}  # azimuth from the viewer and elevation, and radius [degrees]
FORMULA_WITHIN = 0.5  # ΔE_ITP
FURNACE_WITHIN = 1.02  # with the noise of paths
PRINCIPLED_FRACTION = 0.6  # of Principled's error, in the mean of the materials
MAPPED = np.array([0.48, -0.64, 0.6])  # the normal of a map, on all of the sphere
MAP = f"""
import bpy
tree = bpy.data.materials[0].node_tree
node = tree.nodes.new("ShaderNodeNormalMap")
node.space, node.inputs["Color"].default_value = "OBJECT", {(*(0.5 + 0.5 * MAPPED).tolist(), 1)}
tree.links.new(node.outputs[0], next(n for n in tree.nodes if n.type == "GROUP").inputs["Normal"])
"""
SHADER = """
import bpy, glob, sys
sys.path += glob.glob(bpy.utils.resource_path("LOCAL") + "/python/lib/python3*/site-packages")  # oslquery
scene = bpy.context.scene
scene.render.engine, scene.cycles.shading_system = "CYCLES", True
material = bpy.data.materials.new("osl")
material.use_nodes, material.cycles.use_bump_map_correction = True, False
tree = material.node_tree
tree.nodes.clear()
script, output = tree.nodes.new("ShaderNodeScript"), tree.nodes.new("ShaderNodeOutputMaterial")
script.mode, script.filepath = "EXTERNAL", FILE
tree.links.new(script.outputs["BSDF"], output.inputs["Surface"])
"""
ASSETS = """
import bpy
with bpy.data.libraries.load(FILE, assets_only=True) as (there, here):
    here.materials = there.materials
for material in bpy.data.materials:
    assert max(material.preview.image_pixels_float) > 0.1, material.name
    asset = material.asset_data
    assert asset.author and asset.license and asset.description and len(asset.tags) > 2, material.name
    assert asset.catalog_id in open(CATALOGUES).read(), material.name
"""
READY = """
import bpy
with bpy.data.libraries.load(FILE) as (there, here):
    here.materials = [NAME]
"""
SUB = 3  # points of a pixel along a side


def table_of(path):
    """Returns the terms and the rows of texels of a script or a shader."""
    text = Path(path).read_text(encoding="utf-8")
    if path.endswith(".osl"):
        columns, terms = map(int, re.search(r"\(tables, (\d+), (\d+)", text).groups())
        numbers = [float(number) for number in re.search(r"tables\[\d+\] = {([^}]*)}", text)[1].split(",")]
    else:
        names = {}
        exec(compile(text, path, "exec"), names)
        (name, columns, terms, numbers), = names["_MEASURED"]
    return terms, np.reshape(numbers, (-1, columns, 3))


def dot(a, b):
    return (a * b).sum(-1)


def unit(a):
    return a / np.linalg.norm(a, axis=-1, keepdims=True)


def reflected(terms, table, normal, viewer, light):
    """Returns f cosθl of a sum of closures, whose terms extras/blender/closures.h defines. Vectors are [n, 3]."""
    nv, nl = dot(normal, viewer), dot(normal, light)
    x = np.arccos(np.clip(nv, 0, 1)) / (np.pi / 2) * (table.shape[1] - 1)
    i = np.minimum(x.astype(int), table.shape[1] - 2)

    def row(k):
        return table[k, i] + (x - i)[:, None] * (table[k, i + 1] - table[k, i])
    away = unit(nv[:, None] * normal - viewer)
    h = unit(viewer + light)
    ramp = len(table) - 2 * terms
    total = sum(row(2 * terms + j) * np.maximum(1 - np.abs(ramp * nl - j - 1), 0)[:, None] for j in range(ramp)) / np.pi
    for k in range(terms):
        slope, roughness, anisotropy = row(2 * k).T
        ratio = 1 - np.abs(anisotropy)
        ax, ay = (roughness**2 * np.where((anisotropy < 0) == across, ratio, 1 / ratio) for across in (False, True))
        n = unit(normal + slope[:, None] * away)
        t = unit(away - dot(away, n)[:, None] * n)
        b = np.cross(n, t)
        cosines = [np.maximum(dot(n, w), 1e-3) for w in (viewer, light, h)]

        def smith(w, c):
            a = 1 / np.sqrt(np.maximum(((ax * dot(t, w))**2 + (ay * dot(b, w))**2) / c**2, 0.39))
            return np.where(a < 1.6, ((0.396 * a - 1.259) * a + 1) / ((2.181 * a + 3.535) * a), 0)
        d = np.exp(-((dot(t, h) / ax)**2 + (dot(b, h) / ay)**2) / cosines[2]**2) / (np.pi * ax * ay * cosines[2]**4)
        value = d / (4 * cosines[0] * (1 + smith(viewer, cosines[0]) + smith(light, cosines[1])))
        total += row(2 * k + 1) * np.where((dot(n, viewer) > 0) & (dot(n, light) > 0) & (nl > 0), value, 0)[:, None]
    return total


def formula(script, mapped=None):
    """Returns the picture that the tables give under the lamp, with normals of the sphere or of a map."""
    a = (np.arange(SIZE * SUB) + 0.5) / (SIZE * SUB) * 2 - 1
    x, z = np.meshgrid(a, -a)
    forward, up = np.array([0, math.cos(ELEVATION), -math.sin(ELEVATION)]), np.array([0, math.sin(ELEVATION), math.cos(ELEVATION)])
    ray = forward + math.tan(FIELD / 2) * (x[..., None] * np.array([1, 0, 0]) + z[..., None] * up)
    ray = unit(ray).reshape(-1, 3)
    along = ray @ (DISTANCE * forward)
    square = along**2 - (DISTANCE**2 - 1)
    hit = square > 0
    normal = -DISTANCE * forward + (along - np.sqrt(np.maximum(square, 0)))[:, None] * ray
    picture = np.zeros_like(ray)
    normal, ray, light = normal[hit], ray[hit], unit(np.array(LAMP))
    shading = normal if mapped is None else np.broadcast_to(mapped, normal.shape)
    picture[hit] = reflected(*table_of(script), shading, -ray, light) * (normal @ light > 0)[:, None]
    return picture.reshape(SIZE, SUB, SIZE, SUB, 3).mean((1, 3))


def round_lamp(path, towards, radius):
    """A black environment with a round lamp."""
    width, height = 1024, 512
    azimuth, elevation = np.radians(towards)
    x, y = np.meshgrid((np.arange(width) + 0.5) / width * 2 * np.pi - np.pi, np.pi / 2 - (np.arange(height) + 0.5) / height * np.pi)
    cosine = np.sin(y) * np.sin(elevation) + np.cos(y) * np.cos(elevation) * np.cos(x - azimuth - np.pi)
    texels = np.where(cosine[..., None] > np.cos(np.radians(radius)), np.uint8([128, 128, 128, 136]), np.uint8(0))  # radiance 128
    Path(path).write_bytes(f"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {height} +X {width}\n".encode() + texels.astype(np.uint8).tobytes())


def expect_formula(scene, name, script, mapped=None):
    """Checks that Cycles draws a scene under the lamp as the formula of a script or a shader gives it."""
    picture = drawn_by_cycles(scene, f"{folder}/lit.exr", LAMP)
    difference = delta_e(picture[inside], formula(script, mapped)[inside])
    expect(difference <= FORMULA_WITHIN, f"{name}: Cycles against the formula {difference:.2f}")


inside, rows, errors, studio_errors = on_sphere(), [], [], []
with tempfile.TemporaryDirectory() as folder:
    lights = {Path(path).stem: path for path in [studio, *filter(None, os.environ.get("SRBF_ENVIRONMENTS", "").split(":"))]}
    for light, (towards, radius) in ROUND_LAMPS.items():
        lights[light] = f"{folder}/{light}.hdr"
        round_lamp(lights[light], towards, radius)
    for name in MATERIALS:
        measured, script, principled = data / f"rgl/{name}.bsdf", f"{folder}/{name}.py", f"{folder}/{name}_principled"
        print(srbf("export", measured, "--to", "blender", "-o", script).strip())
        expect_formula(script, name, script)
        srbf("fit", measured, "--model", "principled", "-o", principled + ".srbf")
        srbf("export", principled + ".srbf", "--to", "principled", "-o", principled + ".py")
        light_errors = []
        for light, environment in lights.items():
            pictures = [drawn(measured, f"{folder}/m.exr", environment),
                        *(drawn_by_cycles(exported, f"{folder}/n.exr", environment=environment)
                          for exported in (script, principled + ".py"))]
            reference, nodes, parameters = (picture[inside] for picture in pictures)
            light_errors.append((delta_e(nodes, reference), delta_e(parameters, reference)))
            rows.append(np.concatenate([displayed(picture, exposure(reference)) for picture in pictures], axis=1))
        errors.append(np.mean(light_errors, axis=0))
        studio_errors.append(light_errors[0])
        ours, theirs = errors[-1]
        details = ", ".join(f"{light} {a:.2f} {b:.2f}" for light, (a, b) in zip(lights, light_errors))
        expect(ours < theirs, f"{name}: against the measurement nodes {ours:.2f}, Principled {theirs:.2f} ({details})")
        furnace = drawn_by_cycles(script, f"{folder}/f.exr", "furnace")[inside].max()
        expect(furnace <= FURNACE_WITHIN, f"{name}: brightest in a furnace {furnace:.3f}")
    script, both, mapped, appended = (f"{folder}/{name}.py" for name in (MATERIALS[0], "both", "mapped", "appended"))
    Path(mapped).write_text(Path(script).read_text(encoding="utf-8") + MAP, encoding="utf-8")
    expect_formula(mapped, "with a normal map", script, MAPPED)
    table = str(ROOT / "data/library.csv")
    srbf("export", *(data / f"rgl/{name}.bsdf" for name in MATERIALS[:2]), "--to", "blender", "-o", both)
    program = (f"import sys, runpy; sys.argv[1:] = ['--', {folder + '/both.blend'!r}, {table!r}]; "
               f"runpy.run_path({both!r}, run_name='__main__')")
    subprocess.run([sys.executable, "-c", program], check=True, stdout=subprocess.DEVNULL)
    assets = ASSETS.replace("FILE", repr(folder + "/both.blend"))
    Path(appended).write_text(assets.replace("CATALOGUES", repr(folder + "/blender_assets.cats.txt")))
    expect_formula(appended, "from a .blend file with two materials", script)
    kept, ready = ROOT / "data/ready", f"{folder}/ready.py"
    for name, material in {"film.blend": "film", "library.blend": "Ibiza Sunset film"}.items():
        Path(ready).write_text(READY.replace("FILE", repr(str(kept / name))).replace("NAME", repr(material)))
        expect_formula(ready, name, script)
    measured, shader, scene = data / f"rgl/{MATERIALS[0]}.bsdf", f"{folder}/film.osl", f"{folder}/film_osl.py"
    print(srbf("export", measured, "--to", "osl", "-o", shader).strip())
    Path(scene).write_text(SHADER.replace("FILE", repr(shader)))
    expect_formula(scene, "osl", shader)
    ours = delta_e(drawn_by_cycles(scene, f"{folder}/n.exr")[inside], drawn(measured, f"{folder}/m.exr")[inside])
    expect(ours < 1.05 * studio_errors[0][0], f"osl: against the measurement {ours:.2f}, nodes {studio_errors[0][0]:.2f}")
ours, theirs = np.mean(errors, axis=0)
expect(ours <= PRINCIPLED_FRACTION * theirs, f"mean: nodes {ours:.2f}, Principled {theirs:.2f}")
if further:
    from PIL import Image
    Image.fromarray(np.concatenate(rows)).save(further[0])
finish()
