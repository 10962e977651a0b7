"""Checks the two materials for three.js in Chromium: that for WebGLRenderer (release 187) and that for WebGPURenderer (release 185).

Both draw spheres of the film and the paper. Checks:
  - Under four lamps, and under an ambient light, both renderers draw the same picture.
  - Under a rectangular light, both draw nearly the same picture.
  - Under three environments, each picture agrees with a path-traced picture, in means of 4 x 4 pixels.
  - With WebGPURenderer, a cube texture of the studio, and the filtered map that three.js makes of the studio, give nearly the same picture
    as the studio itself.
  - A second material on the page is independent of the first.
  - A material that is saved and loaded draws the same picture.

The test prints the processor time of frames of 256 x 256 pixels, which other programs on the machine hardly change.
Usage: three_webgpu.py PROGRAM DATA, with the files of three.js in peers/ beside DATA. It is skipped without them.
"""
# needs: numpy openexr
import importlib.util
import json
import math
import shutil
import tempfile
from pathlib import Path

from support.checks import ROOT, arguments, expect, finish, skip, srbf
from support.chromium import program as chromium
from support.visible_error import delta_e, equirectangular
from support.browser_server import WEBGPU, opened, picture
from support.surface_drawing import DISTANCE, ELEVATION, FIELD, SIZE, coarse, drawn, on_sphere

SWIFTSHADER = ["--use-gl=angle", "--use-angle=swiftshader", "--ignore-gpu-blocklist", "--enable-unsafe-swiftshader"]
RENDERERS = {"WebGLRenderer": ("three", SWIFTSHADER, ("module", "core"), {"three": "./three.module.js"}),
             "WebGPURenderer": ("three-webgpu", WEBGPU, ("webgpu", "core", "tsl"),
                                {"three/webgpu": "./three.webgpu.js", "three/tsl": "./three.tsl.js"})}
ENVIRONMENTS = {"studio": 8, "lobby": 3, "sunset": 3}  # and the ΔE_ITP against path tracing
LIGHTS = {"lamps": 0.01, "rectangle": 2, "ambient": 0.01}  # and the ΔE_ITP between the renderers; their lobes differ
STUDIO_TEXTURES = {"cube": 1, "map": 30}  # and the ΔE_ITP between pictures by these and by the equirectangular one
_, data, _ = arguments()


def folder_of(files):
    """Returns the folder in peers/ that has these files of three.js, or None."""
    folders = data.parent.glob("peers/*")
    return next((folder for folder in folders if all((folder / f"three.{file}.js").exists() for file in files)), None)


found = {name: folder_of(files) for name, (_, _, files, _) in RENDERERS.items()}
if None in found.values() or chromium() is None or importlib.util.find_spec("OpenEXR") is None:
    skip("no three.js of both releases, no Chromium or no OpenEXR")
inside = on_sphere()
whole = coarse(inside)[..., 0] == 1


def words_of(process):
    """Returns the command line of a process, which is empty if the process has ended."""
    try:
        return (process / "cmdline").read_bytes()
    except OSError:
        return b""


def spent(browser):
    """Returns the processor time of the browser's graphics process [ms]."""
    graphics, = (process for process in Path("/proc").glob("[0-9]*") if b"--type=gpu-process" in (words := words_of(process))
                 and browser.profile.name.encode() in words)
    return sum(int(path.read_text().split()[0]) for path in graphics.glob("task/*/schedstat")) / 1e6


def milliseconds(browser, material, light):
    """Returns the least time of four frames."""
    times = []
    for _ in range(4):
        start = spent(browser)
        browser.run(f"frames('{material}', '{light}', 6)")
        times.append((spent(browser) - start) / 6)
    return min(times)


environments = {name: data / "hdr" / (name + ".hdr") for name in ENVIRONMENTS}
texels = {name: json.dumps(dict(zip(("rows", "width", "height"), equirectangular(path)))) for name, path in environments.items()}
with tempfile.TemporaryDirectory() as name:
    for material in ("cc_ibiza_sunset_rgb", "paper_white_rgb"):
        model, other, pictures = Path(name, "material.srbf"), Path(name, "other.srbf"), {}
        srbf("fit", ROOT / f"data/{material}.bsdf", "-o", model)
        srbf("edit", model, "--hue", 120, "-o", other)
        traced = {light: coarse(drawn(model, f"{name}/traced.exr", path))[whole] for light, path in environments.items()}
        for renderer, (kind, flags, files, imports) in RENDERERS.items():
            site = Path(name, material, renderer)
            site.mkdir(parents=True)
            for file in files:
                shutil.copy(found[renderer] / f"three.{file}.js", site)
            srbf("export", model, other, "--to", kind, "-o", site / "material.js")
            for light, text in texels.items():
                (site / f"{light}.json").write_text(text)
            texts = {"ENVIRONMENTS": json.dumps(list(ENVIRONMENTS)), "IMPORTS": json.dumps(imports), "LIBRARY": next(iter(imports)),
                     "FIELD": str(math.degrees(FIELD)), "SIZE": str(SIZE),
                     "EYE": str([0, DISTANCE * math.sin(ELEVATION), DISTANCE * math.cos(ELEVATION)])}
            page = Path(__file__).with_suffix(".html").read_text(encoding="utf-8")
            for word, text in texts.items():
                page = page.replace(word, text)
            (site / "index.html").write_text(page)
            with opened(site, "index.html", flags) as browser:
                browser.run("new Promise((done) => { const wait = () => window.isReady ? done() : setTimeout(wait, 50); wait(); })")
                for light in [*LIGHTS, *ENVIRONMENTS]:
                    pictures[renderer, light] = picture(browser, f"drawn('ours', '{light}')", SIZE)
                    if light in ENVIRONMENTS and light != "studio":
                        continue
                    standard, ours = (milliseconds(browser, name, light) for name in ("standard", "ours"))
                    print(f"     {material}, {renderer}, {light}: {ours:.0f} ms, {ours / standard:.1f} times as long as "
                          "MeshStandardMaterial", flush=True)
                for texture, most in STUDIO_TEXTURES.items() if kind == "three-webgpu" else []:
                    shown = picture(browser, f"drawn('ours', '{texture}')", SIZE)
                    difference = delta_e(shown[inside], pictures[renderer, "studio"][inside])
                    expect(difference < most, f"{material}, {renderer}, studio: by a {texture} {difference:.2f}")
                browser.run("loaded()")
                for shown in ("other", "saved", "loaded"):
                    pictures[renderer, shown] = picture(browser, f"drawn('{shown}', 'lamps')", SIZE)
            difference = delta_e(pictures[renderer, "other"][inside], pictures[renderer, "lamps"][inside])
            expect(difference > 5, f"{material}, {renderer}: between two materials of a page {difference:.2f}")
            difference = delta_e(pictures[renderer, "loaded"][inside], pictures[renderer, "saved"][inside])
            expect(difference == 0, f"{material}, {renderer}: between one that was saved and loaded {difference:.2f}")
            for light, most in ENVIRONMENTS.items():
                difference = delta_e(coarse(pictures[renderer, light])[whole], traced[light])
                expect(difference <= most, f"{material}, {renderer}, {light}: against path tracing {difference:.2f}")
        for light, most in LIGHTS.items():
            difference = delta_e(*(pictures[renderer, light][inside] for renderer in RENDERERS))
            expect(difference <= most, f"{material}, {light}: between the renderers {difference:.4f}")
finish()
