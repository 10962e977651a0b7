"""Checks surfaces as glTF in three.js.

The test fits a surface to measurements and writes it as binary glTF. three.js (MeshPhysicalMaterial) draws a sphere of it
under three distant lights, and in an environment that three.js filters beforehand; `srbf render` draws the measurement and
the surface. The error of three.js against the measurement is at most 30 % larger than that of the surface, or
LARGEST_RATIOS times as large if three.js uses another formula.
Usage: three_gltf.py PROGRAM DATA [PICTURE], where DATA contains rgl/. It needs Chromium. nicegui contains three.js.
"""
# needs: numpy openexr pillow js:nicegui
import base64
import importlib.util
import math
import shutil
import sys
import tempfile
from pathlib import Path

import numpy as np
from support.checks import arguments, finish, skip, srbf
from support.chromium import WEBGL, Chromium, program as chromium
from support.visible_error import delta_e, displayed, exposure, hdr_of
from support.surface_drawing import (BRUSHED, DISTANCE, ELEVATION, FIELD, MATERIALS, SIZE, drawn as rendered, errors_of, expect_brushed,
                                     expect_errors, on_sphere, studio as environment)

found = next((Path(p) / "nicegui/elements/scene/dist" for p in sys.path if (Path(p) / "nicegui/elements/scene/dist/index.js").exists()),
             None)
if found is None or chromium() is None or importlib.util.find_spec("OpenEXR") is None:
    skip("no three.js of nicegui, no Chromium or no OpenEXR")

_, data, further = arguments()
# three.js uses other formulas, and a blurred map of the environment. These are the figures of docs/surface.md, and 15 % more.
RATIOS = {"lights": (1.8, 1.4, 3.7, 2.0, 1.4), "environment": (2.6, 5.1, 18.5, 15, 3.7)}
LARGEST_RATIOS = {kind: dict(zip(MATERIALS, ratios)) for kind, ratios in RATIOS.items()}
THREE = ("--env", "none", "--lights", "three")
LIGHTS = [((-6 / 11, 6 / 11, 7 / 11), 3), ((6 / 7, 2 / 7, -3 / 7), 2), ((1 / 3, -2 / 3, 2 / 3), 0.5)]  # in the camera's frame


def drawn(page, glb, lights, texels):
    eye = [0, DISTANCE * math.sin(ELEVATION), DISTANCE * math.cos(ELEVATION)]
    light, width, height = "null", 0, 0
    if texels is not None:
        height, width = texels.shape[:2]
        whole = np.concatenate([texels[::-1], np.ones((height, width, 1))], axis=-1).astype(np.float32)  # the lowest row first
        light = '"' + base64.b64encode(whole.tobytes()).decode() + '"'
    answer = page.run(f"draw('{base64.b64encode(Path(glb).read_bytes()).decode()}', {SIZE}, {eye}, {math.degrees(FIELD)},"
                      f" {[[list(w), e] for w, e in lights]}, {light}, {width}, {height})")
    pixels = np.frombuffer(base64.b64decode(answer), np.float32).reshape(SIZE, SIZE, 4)
    return pixels[::-1, :, :3].astype(float)


inside = on_sphere()
rows = []
with tempfile.TemporaryDirectory() as folder:
    shutil.copy(found / "index.js", folder + "/three.js")
    for more in found.glob("*.js"):
        shutil.copy(more, folder)
    shutil.copy(Path(__file__).with_suffix(".html"), folder + "/page.html")
    page = Chromium([*WEBGL, "--allow-file-access-from-files"])
    try:
        page.open(folder + "/page.html")
        print("three.js",
              page.run("new Promise((done) => { const wait = () => window.draw ? done(revision) : setTimeout(wait, 50); wait(); })"))
        for name in MATERIALS:
            measured, model, glb = data / f"rgl/{name}.bsdf", f"{folder}/{name}.srbf", f"{folder}/{name}.glb"
            srbf("fit", measured, "--model", "gltf", "-o", model)
            srbf("export", model, "--to", "glb", "-o", glb)
            row = []
            for words, lights, texels in ((THREE, LIGHTS, None), (("--env", environment), [], hdr_of(environment))):
                pictures = [rendered(subject, f"{folder}/{name}-{len(row)}-{i}.exr", light=words)
                            for i, subject in enumerate((measured, model))]
                pictures.append(drawn(page, glb, lights, texels))
                reference, surface, three = (picture[inside] for picture in pictures)
                kind = "lights" if texels is None else "environment"
                expect_errors(name, f"three.js ({kind})", errors_of(reference, surface, three), LARGEST_RATIOS[kind])
                by = exposure(reference)
                row += [displayed(picture, by) for picture in pictures]
            rows.append(np.concatenate(row, axis=1))
        srbf("export", BRUSHED, "--to", "glb", "-o", f"{folder}/brushed.glb")
        ours, three = rendered(BRUSHED, f"{folder}/brushed.exr", light=THREE), drawn(page, f"{folder}/brushed.glb", LIGHTS, None)
        expect_brushed("three.js", delta_e(three[inside], ours[inside]))
        rows.append(np.concatenate([displayed(picture, exposure(ours[inside])) for picture in (0 * ours, ours, three, *3 * [0 * ours])],
                                   axis=1))
    finally:
        page.close()
if further:
    from PIL import Image
    Image.fromarray(np.concatenate(rows)).save(further[0])
finish()
