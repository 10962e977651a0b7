"""Runs the programs of examples/hosts.

Each program draws spheres of the bundled materials under a directional light, by exported code or by a model. The picture
must differ from that of the model itself by a mean ΔE_ITP of at most 1. A host that is not installed is skipped. The last
line counts the hosts that ran.
Usage: example_hosts.py PROGRAM DATA [PICTURES [NAME..]]. The folder peers/ stands beside DATA, PICTURES is a folder for the
pictures, and NAME restricts the test to some hosts.
"""
# needs: numpy pillow js:pybabylonjs
import importlib.util
import re
import shutil
import subprocess
import sys
import tempfile
from importlib.metadata import version
from pathlib import Path

import numpy as np
from support.checks import ROOT, arguments, expect, finish
from support import lit_sphere
from support.chromium import WEBGL, program as chromium
from support.browser_server import WEBGPU, opened, picture as picture_of

(program, data, further), EXAMPLES = arguments(), ROOT / "examples/hosts"
FILAMENT = "/usr/include/filament-1.9"  # where Debian has its headers
MATERIALS = {"film": "cc_ibiza_sunset_rgb", "paper": "paper_white_rgb"}


def draw_by_page(flags, files):
    """Draws with the page of an example in Chromium. Beside the page stand these files of the host: {name: text}."""
    def draw(example, code, picture):
        folder = Path(picture).parent
        shutil.copy(example / "index.html", folder)
        for name, text in files.items():
            (folder / name).write_text(text, encoding="utf-8")
        with opened(folder, "index.html", flags) as browser:
            np.save(picture, picture_of(browser, "radiance", lit_sphere.SIZE))
    return draw


def run(*command, folder=None):
    """Runs a command. Raises RuntimeError with the end of its output if it fails."""
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=600)
    if done.returncode:
        raise RuntimeError(done.stdout[-2000:] + done.stderr[-2000:])


def draw_by_script(example, code, picture, *more):
    """Draws with the script of an example."""
    run(sys.executable, example / "sphere.py", code, picture, *more)


def draw_by_slang(example, code, picture):
    """Draws, and compares derivatives by the direction to the light with differences of values by `srbf eval`."""
    folder = Path(picture).parent
    draw_by_script(example, code, picture, "cpu", folder / "slopes.npy")
    directions, step = lit_sphere.pairs(), 1e-3
    some = np.flatnonzero(directions[:, 2] * directions[:, 5] > 0.05)[::97]
    wl, wv = directions[some, :3], directions[some, 3:]
    along = np.cross(wl, [0.3, 0.5, 0.8])
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    moved = [np.hstack([np.cos(step) * wl + sign * np.sin(step) * along, wv]) for sign in (1, -1)]
    up, down = (lit_sphere.reflected(program, models[folder.name], directions, folder).sum(1) for directions in moved)
    slopes = (np.load(folder / "slopes.npy")[lit_sphere.points()[0]][some] * along).sum(1)
    difference = np.median(np.abs(slopes - (up - down) / (2 * np.sin(step))) / (np.abs(slopes) + 1e-3))
    if not difference < 1e-3:
        raise RuntimeError(f"slang: derivatives differ from slopes by {difference:.1e} in the median")
    print(f"     slang: derivatives differ from finite differences by {difference:.1e} in the median")


def draw_by_c(example, code, picture):
    folder = Path(picture).parent
    shutil.copy(example / "sphere.c", folder)
    subprocess.run(["cc", "-O2", "sphere.c", "-o", "sphere", "-lm"], cwd=folder, check=True)
    pixels = subprocess.run([folder / "sphere"], check=True, stdout=subprocess.PIPE).stdout
    np.save(picture, np.frombuffer(pixels, np.float32).reshape(lit_sphere.SIZE, lit_sphere.SIZE, 3))


def draw_by_filament(example, code, picture):
    """Compiles the material and the program of an example, and draws in a separate display."""
    folder, material = Path(picture).parent, (example / "measured.mat").read_text(encoding="utf-8")
    (folder / "measured.mat").write_text(material.replace("CODE", code.read_text(encoding="utf-8")))
    libraries = [f"-lfilament{part}" for part in ("", "_geometry", "_utils", "_backend")]
    run("matc", "--api", "opengl", "--platform", "desktop", "-o", "measured.filamat", "measured.mat", folder=folder)
    run("g++", "-std=c++17", "-O1", f"-I{FILAMENT}", example / "sphere.cpp", "-o", "sphere", *libraries, folder=folder)
    run("xvfb-run", "-a", "-s", "-screen 0 640x480x24", "./sphere", "measured.filamat", "picture", folder=folder)
    np.save(picture, np.fromfile(folder / "picture", np.float32).reshape(lit_sphere.SIZE, lit_sphere.SIZE, 4)[..., :3])


def three_files(files):
    """Returns {name: text} of these files of three.js from a folder in peers/, or None if a file is missing."""
    for folder in data.parent.glob("peers/*"):
        paths = [folder / f"three.{file}.js" for file in files]
        if all(path.exists() for path in paths):
            return {path.name: path.read_text(encoding="utf-8") for path in paths}
    return None


def babylon_script():
    """Returns the script of Babylon.js, which a module of pybabylonjs contains, or None without the package."""
    package = importlib.util.find_spec("pybabylonjs")
    scripts = Path(package.submodule_search_locations[0]).glob("labextension/static/*.js") if package else ()
    text = "".join(path.read_text(encoding="utf-8") + ";\n" for path in scripts if path.stat().st_size > 2e5)
    module = re.search(r"(\d+):\(\w,(\w),\w\)=>\{\"use strict\";\w\.r\(\2\),\w\.d\(\2,\{AbstractActionManager:", text)
    webpack = Path(__file__).with_name("webpack.js").read_text(encoding="utf-8")
    return module and webpack.replace("\nCHUNK\n", f"\n{text}\n") + f"window.BABYLON = load({module[1]});"


def export_of(example):
    """Returns the arguments of `srbf export` that a file of the example states, and the name of the file that it writes.
    Without such a statement there are no arguments, and the file is the model's."""
    text = "".join(path.read_text(encoding="utf-8") for path in sorted(example.glob("*.*")))
    command = re.search(r"`srbf export material\.srbf ([^`]+) -o (material\.\w+)`", text.replace("\n// ", " "))
    return (command[1].split(), command[2]) if command else ([], "material.srbf")


def version_of(script):
    """Returns the version of the first package that a script needs, or None if a package is missing."""
    needs = re.search(r"^# needs: (?:numpy1 )?(.+)$", script.read_text(encoding="utf-8"), re.M)[1].split()
    return version(needs[0]) if all(map(importlib.util.find_spec, needs)) else None


def hosts():
    """Yields each example: its name, the version of the host or None, and what draws it."""
    compiler = shutil.which("cc") and subprocess.run(["cc", "--version"], capture_output=True, text=True).stdout.splitlines()[0]
    yield "c", compiler, draw_by_c
    for name, flags, files in (("three_webgl", WEBGL, ("module", "core")), ("three_webgpu", WEBGPU, ("webgpu", "core", "tsl"))):
        texts = three_files(files)
        release = texts and chromium() and re.search(r"REVISION = '(\w+)'", texts["three.core.js"])[1]
        yield name, release, draw_by_page(flags, texts)
    bundle = babylon_script()
    release = bundle and chromium() and re.search(r'"(7\.\d+\.\d+)"', bundle)[1]
    yield "babylon", release, draw_by_page(WEBGL, {"babylon.js": bundle})
    filament = Path(FILAMENT).exists() and all(map(shutil.which, ("matc", "xvfb-run"))) and subprocess.run(
        ["dpkg-query", "-W", "-f", "${Version}", "libfilament-dev"], capture_output=True, text=True).stdout
    yield "filament", filament, draw_by_filament
    for script in sorted(EXAMPLES.glob("*/sphere.py")):
        name = script.parent.name
        yield name, version_of(script), draw_by_slang if name == "slang" else draw_by_script


ran, rows, names = [], {material: [] for material in MATERIALS}, further[1:]
with tempfile.TemporaryDirectory() as folder:
    models, references = {}, {}
    for material, measurement in MATERIALS.items():
        models[material] = Path(folder, material, "material.srbf")
        models[material].parent.mkdir()
        subprocess.run([program, "fit", ROOT / f"data/{measurement}.bsdf", "-o", models[material]], check=True, stdout=subprocess.DEVNULL)
        references[material] = lit_sphere.reference(program, models[material], folder)
    for host, version_of_host, draw in hosts():
        if names and host not in names:
            continue
        if not version_of_host:
            print(f"skipped: {host} is not installed")
            continue
        export, file_name = export_of(EXAMPLES / host)
        errors = []
        for material, model in models.items():
            work = Path(folder, host, material)
            work.mkdir(parents=True)
            code, picture = work / file_name, work / "picture.npy"
            if export:
                subprocess.run([program, "export", model, *export, "-o", code], check=True)
            else:
                shutil.copy(model, code)
            draw(EXAMPLES / host, code, picture)
            rows[material].append(np.load(picture).astype(float))
            errors.append(lit_sphere.picture_error(rows[material][-1], references[material]))
        ran.append(host)
        text = f"{host} {version_of_host}: " + ", ".join(f"{material} {error:.2f}" for material, error in zip(MATERIALS, errors))
        expect(max(errors) <= lit_sphere.WITHIN, text)
    if further:
        from PIL import Image, ImageDraw
        rows_of_spheres = Image.fromarray(np.concatenate([lit_sphere.side_by_side(references[material], rows[material])
                                                          for material in MATERIALS]))
        spheres = rows_of_spheres.resize([96 * length // lit_sphere.SIZE for length in rows_of_spheres.size], Image.Resampling.BOX)
        sheet = Image.new("RGB", (spheres.width, spheres.height + 14), "white")
        sheet.paste(spheres, (0, 14))
        for i, label in enumerate(["model", *ran]):
            ImageDraw.Draw(sheet).text((96 * i + 4, 1), label, fill="black")
        sheet.save(Path(further[0], "hosts.png"))
print(f"{len(ran)} hosts ran")
finish()
