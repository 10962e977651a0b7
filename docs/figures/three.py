"""Draws docs/tutorials/three_spheres.png: python3 docs/figures/three.py SRBF THREE.

THREE is a folder with three.js of release 187. The script needs numpy, openexr and pillow of PyPI.

The film under three distant lights and under data/studio.hdr: the measurement by path tracing, the exported material, and the
MeshStandardMaterial whose colour, roughness and metalness have the least visible error in this picture, found by a search. Chromium draws
the last two, and sets the names.
"""
import base64
import math
import os
import shutil
import subprocess
import sys
import tempfile

import numpy as np

from clone import ROOT
from support import chromium
from support.visible_error import delta_e, displayed, equirectangular, exposure
from support.surface_drawing import DISTANCE, ELEVATION, FIELD, pixels_of

SIZE, PATHS = 240, 512  # pixels of a side; paths of a pixel
FINE = 1 / 200  # the last step of the search
data = os.path.join(ROOT, "data")
PAGE = """<!doctype html><script type="importmap">{ "imports": { "three": "./three.module.js" } }</script><script type="module">
import * as THREE from "three";
import { FilmMaterial } from "./film.js";
const renderer = new THREE.WebGLRenderer(), scene = new THREE.Scene(), camera = new THREE.PerspectiveCamera(FIELD, 1, 0.1, 100);
const sphere = new THREE.Mesh(new THREE.SphereGeometry(1, 192, 96)), standard = new THREE.MeshStandardMaterial(), film = new FilmMaterial();
scene.add(sphere);
camera.position.set(...EYE);
camera.lookAt(0, 0, 0);
camera.updateMatrixWorld();
const lamps = [[[-6, 6, 7], 3], [[6, 2, -3], 2], [[1, -2, 2], 0.5]].map(([towards, irradiance]) => {  // those of `srbf render --lights three`
    const lamp = new THREE.DirectionalLight("white", irradiance);
    lamp.position.set(...towards).transformDirection(camera.matrixWorld);
    scene.add(lamp);
    return lamp;
});
window.light = (rows, width, height) => {
    for (const lamp of lamps) scene.remove(lamp);
    const texels = new THREE.DataTexture(new Float32Array(Uint8Array.from(atob(rows), (c) => c.charCodeAt(0)).buffer), width, height, THREE.RGBAFormat, THREE.FloatType);
    texels.mapping = THREE.EquirectangularReflectionMapping;
    texels.minFilter = texels.magFilter = THREE.LinearFilter;
    texels.needsUpdate = true;
    scene.environment = new THREE.PMREMGenerator(renderer).fromEquirectangular(texels).texture;
    scene.environmentRotation.y = Math.PI / 2;  // the middle of the picture lies behind the sphere
};
const target = new THREE.WebGLRenderTarget(SIZE, SIZE, { type: THREE.FloatType, colorSpace: THREE.LinearSRGBColorSpace, samples: 0 });
// With five numbers a MeshStandardMaterial: colour, roughness, metalness; otherwise the exported one.
window.draw = (numbers) => {
    if (numbers) standard.color.setRGB(...numbers.slice(0, 3)), [standard.roughness, standard.metalness] = numbers.slice(3);
    sphere.material = numbers ? standard : film;
    renderer.setRenderTarget(target);
    renderer.render(scene, camera);
    const pixels = new Float32Array(4 * SIZE * SIZE);
    renderer.readRenderTargetPixels(target, 0, 0, SIZE, SIZE, pixels);
    let text = "";
    for (const byte of new Uint8Array(pixels.buffer)) text += String.fromCharCode(byte);
    return btoa(text);
};
</script>"""
STYLE = f"""body {{ margin: 0; background: #fff; color: #222; font: 17px DejaVu Sans, sans-serif; display: flex; flex-wrap: wrap }} figure {{ margin: 0; width: {SIZE}px;
    text-align: center }} figcaption {{ padding: 6px 0 }} img {{ display: block }}"""


def on_sphere():
    at = (np.arange(SIZE) + 0.5) / SIZE * 2 - 1
    return math.tan(FIELD / 2) * np.hypot(*np.meshgrid(at, at)) < 0.98 / math.sqrt(DISTANCE**2 - 1)


def best(error):
    """Returns the numbers from 0 to 1 with the least error. The search steps along each number, and halves the steps when none helps."""
    numbers, step = np.array([0.5, 0.4, 0.4, 0.4, 1]), 0.2
    least = error(numbers)
    while step > FINE:
        tries = [np.clip(numbers + sign * step * np.eye(5)[i], 0, 1) for i in range(5) for sign in (-1, 1)]
        errors = [error(guess) for guess in tries]
        if min(errors) < least:
            least, numbers = min(errors), tries[int(np.argmin(errors))]
        else:
            step /= 2
    return numbers, least


def drawn(page, numbers="null"):
    pixels = np.frombuffer(base64.b64decode(page.run(f"draw({numbers})")), np.float32)
    return pixels.reshape(SIZE, SIZE, 4)[::-1, :, :3].astype(float)


def row(page, reference, inside):
    """Returns the panels of a row, each with a name and a picture."""
    error = lambda picture: delta_e(picture[inside], reference[inside])
    film = drawn(page)
    numbers, least = best(lambda guess: error(drawn(page, guess.tolist())))
    print("colour, roughness, metalness", numbers.round(3).tolist())
    return [("measured", reference), (f"FilmMaterial, ΔE {error(film):.1f}", film),
            (f"MeshStandard, ΔE {least:.1f}", drawn(page, numbers.tolist()))]


def opened(three, work):
    for name in ("three.module.js", "three.core.js"):
        shutil.copy(os.path.join(three, name), work)
    eye = [0, DISTANCE * math.sin(ELEVATION), DISTANCE * math.cos(ELEVATION)]
    with open(os.path.join(work, "page.html"), "w", encoding="utf-8") as file:
        file.write(PAGE.replace("FIELD", str(math.degrees(FIELD))).replace("EYE", str(eye)).replace("SIZE", str(SIZE)))
    page = chromium.Chromium([*chromium.WEBGL, "--allow-file-access-from-files"])
    page.open(os.path.join(work, "page.html"))
    page.run("new Promise((done) => { const wait = () => window.draw ? done() : setTimeout(wait, 50); wait(); })")
    return page


def main(program, three):
    from PIL import Image
    inside, figures = on_sphere(), ""
    with tempfile.TemporaryDirectory() as work:
        run = lambda *words: subprocess.run([program, *words], cwd=work, check=True, stdout=subprocess.DEVNULL)
        measured = os.path.join(data, "cc_ibiza_sunset_rgb.bsdf")
        run("fit", measured, "-o", "film.srbf")
        run("export", "film.srbf", "--to", "three", "-o", "film.js")
        page = opened(three, work)
        try:
            for light in (["--env", "none", "--lights", "three"], ["--env", "studio"]):
                run("render", measured, "-o", "measured.exr", "--mesh", "sphere", *light,
                    "--no-ground", "--no-occlusion", "--size", f"{SIZE}x{SIZE}", "--spp", str(PATHS))
                reference = pixels_of(os.path.join(work, "measured.exr"))
                if light[1] == "studio":
                    rows, width, height = equirectangular(os.path.join(data, "studio.hdr"))
                    page.run(f"light('{rows}', {width}, {height})")
                for i, (name, picture) in enumerate(row(page, reference, inside)):
                    file = f"{light[1]}{i}.png"
                    Image.fromarray(displayed(picture * inside[..., None], exposure(reference[inside]))).save(os.path.join(work, file))
                    figures += f'<figure><img src="{file}"><figcaption>{name}</figcaption></figure>'
        finally:
            page.close()
        chromium.picture(f"<style>{STYLE}</style>{figures}", 3 * SIZE, os.path.join(ROOT, "docs", "tutorials", "three_spheres.png"), work)


main(os.path.abspath(sys.argv[1]), sys.argv[2])
