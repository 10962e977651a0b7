#!/usr/bin/env python3
"""Materials under environments in three.js, and the time of a frame: numpy and openexr of PyPI, three.js in the folder peers/three beside
the data's, and Chromium. Without one of them nothing is tried.

Draws a sphere 64 pixels wide by the exported material of models and, for Lambert and GGX, by MeshStandardMaterial of the same
roughness, and compares means of 4 x 4 pixels with `srbf render`'s, which traces paths. Both materials look up the same environment, as
three.js filters it. Then the time of a frame of 512 x 512 pixels, of MeshStandardMaterial and of the exported one by turns.
Prints the table of docs/engines.md. Exported materials are nearer than MeshStandardMaterial, and draw a frame in less than three times its time: Mesa
takes longer for the five look-ups than SwiftShader, which three_webgpu.py times.
Arguments: the program, a folder with rgl/ and hdr/; a folder, if given, in which pictures are kept, since paths take long.
"""
import base64
import importlib.util
import json
import math
import shutil
import struct
import sys
import tempfile
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
from chromium import WEBGL, Chromium, program as chromium  # noqa: E402
from seen import delta_e, displayed, equirectangular, exposure  # noqa: E402
from surface_host import DISTANCE, ELEVATION, FIELD, SIZE, coarse, on_sphere, pixels_of, run  # noqa: E402

data = Path(sys.argv[2])
three = data.parent / "peers/three"
if not three.exists() or chromium() is None or importlib.util.find_spec("OpenEXR") is None:
    print("skipped: no three.js beside the data, no Chromium or no OpenEXR")
    sys.exit(0)

ENVIRONMENTS, FITS = ["studio", "lobby", "sunset"], ["cc_ibiza_sunset_rgb", "paper_white_rgb", "vch_golden_yellow_rgb"]
PATHS = 128  # a pixel, of which 16 are compared as one
FRAME, FRAMES, ROUNDS = 512, 10, 7
# Of MeshStandardMaterial: colour, roughness, metalness.
OWN = {
    "white": ((0.8, 0.8, 0.8), 0.2, 0), "red": ((0.5, 0.1, 0.05), 0.35, 0), "copper": ((0.95, 0.64, 0.54), 0.2, 1), "gold": ((1, 0.78, 0.34), 0.4, 1)
}
PAGE = """<!doctype html><script type="importmap">{ "imports": { "three": "./three.module.js" } }</script><script type="module">
import * as THREE from "three";
import * as exported from "./materials.js";
const bytes = (text) => Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
const renderer = new THREE.WebGLRenderer(), scene = new THREE.Scene(), camera = new THREE.PerspectiveCamera(30, 1, 0.1, 100);
const sphere = new THREE.Mesh(new THREE.SphereGeometry(1, 192, 96));
scene.add(sphere);
window.look = (eye, field) => {
    camera.fov = field;
    camera.position.set(...eye);
    camera.lookAt(0, 0, 0);
    camera.updateProjectionMatrix();
};
window.lit = (light, width, height) => {
    const texels = new THREE.DataTexture(new Float32Array(bytes(light).buffer), width, height, THREE.RGBAFormat, THREE.FloatType);
    texels.mapping = THREE.EquirectangularReflectionMapping;
    texels.minFilter = texels.magFilter = THREE.LinearFilter;
    texels.needsUpdate = true;
    scene.environment = new THREE.PMREMGenerator(renderer).fromEquirectangular(texels).texture;
    scene.environmentRotation.y = Math.PI / 2;  // the middle of the picture lies behind the sphere
};
const made = {};
window.worn = (name, own) => {
    const colour = new THREE.Color();
    made[name] ??= own ? new THREE.MeshStandardMaterial({ color: colour.setRGB(...own[0]), roughness: own[1], metalness: own[2] }) : new exported[name]();
    sphere.material = made[name];
};
window.draw = (size) => {
    const target = new THREE.WebGLRenderTarget(size, size, { type: THREE.FloatType, colorSpace: THREE.LinearSRGBColorSpace, samples: 0 });
    renderer.setRenderTarget(target);
    renderer.render(scene, camera);
    const pixels = new Float32Array(4 * size * size);
    renderer.readRenderTargetPixels(target, 0, 0, size, size, pixels);
    target.dispose();
    let text = "";
    for (const byte of new Uint8Array(pixels.buffer)) text += String.fromCharCode(byte);
    return btoa(text);
};
window.milliseconds = (size, frames) => {
    renderer.setRenderTarget(null);
    renderer.setSize(size, size, false);
    const gl = renderer.getContext(), pixel = new Uint8Array(4), frame = () => {
        renderer.render(scene, camera);
        gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);  // waits for it
    };
    frame();
    const start = performance.now();
    for (let i = 0; i < frames; ++i) frame();
    return (performance.now() - start) / frames;
};
window.revision = THREE.REVISION;
</script>"""


def write_ggx(path, colour, roughness, metalness):
    """A model file of the Lambert and GGX of MeshStandardMaterial."""
    f0 = [0.04 + metalness * (of - 0.04) for of in colour]
    tensors, data, header = {"diffuse": [(1 - metalness) * of for of in colour], "facing": f0, "grazing": [1], "roughness": [roughness**2]}, b"", {}
    for name, numbers in tensors.items():
        start, data = len(data), data + np.array(numbers, np.float16).tobytes()
        header[name] = {"data_offsets": [start, len(data)], "dtype": "F16", "shape": [1, 3] if name == "facing" else [len(numbers)]}
    header["__metadata__"] = {"model": "ggx", "srbf": "1"}
    text = json.dumps(header).encode()
    text += b" " * (-len(text) % 8)
    Path(path).write_bytes(struct.pack("<Q", len(text)) + text + data)


def psnr(picture, reference):
    by = exposure(reference)
    a, b = (displayed(of, by).astype(float) for of in (picture, reference))
    return 20 * math.log10(255 / max(math.sqrt(((a - b)**2).mean()), 1e-3))


def text_of(errors):
    return "{:.2f}, {:.1f}".format(*np.mean(errors, axis=0)) if errors else ""


whole = coarse(on_sphere())[..., 0] == 1
failures = []
with tempfile.TemporaryDirectory() as folder:
    for name in ("three.module.js", "three.core.js"):
        shutil.copy(three / name, folder)
    Path(folder, "page.html").write_text(PAGE, encoding="utf-8")
    for name, (colour, roughness, metalness) in OWN.items():
        write_ggx(f"{folder}/{name}.srbf", colour, roughness, metalness)
    for name in FITS:
        run("fit", data / f"rgl/{name}.bsdf", "-o", f"{folder}/{name}.srbf")
    models = [Path(folder, name + ".srbf") for name in [*OWN, *FITS]]
    pictures = Path(sys.argv[3] if len(sys.argv) > 3 else folder)
    run("export", *models, "--to", "three", "-o", f"{folder}/materials.js")
    page = Chromium([*WEBGL, "--allow-file-access-from-files"])
    try:
        page.open(folder + "/page.html")
        print("three.js", page.run("new Promise((done) => { const wait = () => window.draw ? done(revision) : setTimeout(wait, 50); wait(); })"))
        page.run(f"look({[0, DISTANCE * math.sin(ELEVATION), DISTANCE * math.cos(ELEVATION)]}, {math.degrees(FIELD)})")

        def drawn():
            pixels = np.frombuffer(base64.b64decode(page.run(f"draw({SIZE})")), np.float32).reshape(SIZE, SIZE, 4)
            return coarse(pixels[::-1, :, :3].astype(float))

        exported = {path: "".join(word.capitalize() for word in path.stem.replace("-", "_").split("_")) + "Material" for path in models}
        errors = {path: ([], []) for path in models}  # of the exported material, of three.js' own
        for environment in (data / f"hdr/{name}.hdr" for name in ENVIRONMENTS):
            rows, width, height = equirectangular(environment)
            page.run(f"lit('{rows}', {width}, {height})")
            sheet = []
            for path in models:
                picture = pictures / f"{path.stem}-{environment.stem}.exr"
                if not picture.exists():
                    run("render", path, "-o", picture, "--mesh", "sphere", "--env", environment, "--no-ground", "--no-occlusion", "--size",
                        f"{SIZE}x{SIZE}", "--spp", PATHS)
                reference, columns = coarse(pixels_of(picture)), []
                for i, own in enumerate([None, OWN.get(path.stem)][:1 + (path.stem in OWN)]):
                    page.run(f"worn('{path.stem if own else exported[path]}', {json.dumps(own)})")
                    columns.append(drawn())
                    errors[path][i].append((delta_e(columns[-1][whole], reference[whole]), psnr(columns[-1][whole], reference[whole])))
                columns = [reference, columns[0], columns[-1]]
                sheet.append(np.concatenate([displayed(of * whole[..., None], exposure(reference[whole])) for of in columns], axis=1))
            np.save(pictures / f"{environment.stem}.npy", np.concatenate(sheet))
        print("| mean ΔE_ITP, PSNR [dB] | exported | MeshStandardMaterial |\n|---|---|---|")
        for path in models:
            print(f"| {path.stem} | {text_of(errors[path][0])} | {text_of(errors[path][1])} |")
        for name, some in (("mean of those", models[:len(OWN)]), ("mean of the fits", models[len(OWN):])):
            for environment, of in ((name, slice(None)), *((f"{name}, {ENVIRONMENTS[i]}", slice(i, i + 1)) for i in range(len(ENVIRONMENTS)))):
                columns = (text_of(sum((errors[path][column][of] for path in some), [])) for column in (0, 1))
                print("|", environment, "|", " | ".join(columns), "|")
        ours, theirs = (np.mean([errors[path][i] for path in models[:len(OWN)]], axis=(0, 1))[0] for i in (0, 1))
        if ours >= theirs:
            failures.append("exported materials are not nearer")
        times = []
        last = models[-1]
        for _ in range(ROUNDS):
            page.run(f"worn('red', {json.dumps(OWN['red'])})")
            own = page.run(f"milliseconds({FRAME}, {FRAMES})")
            page.run(f"worn('{exported[last]}', null)")
            times.append((own, page.run(f"milliseconds({FRAME}, {FRAMES})")))
        own, ours = np.median(times, axis=0)
        ratio = float(np.median([b / a for a, b in times]))
        print(f"a frame: MeshStandardMaterial {own:.1f} ms, {last.stem} {ours:.1f} ms, {ratio:.2f} times as long")
        if ratio > 3:
            failures.append("a frame takes long")
        problems = list(page.problems)
        print(problems or "no warnings")
    finally:
        page.close()
for of in failures:
    print("BAD ", of)
sys.exit(bool(failures))
