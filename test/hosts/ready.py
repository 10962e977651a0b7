"""Checks that the ready files of the bundled film are what the program writes.

`./run test hosts ready --write` writes them anew. Texts must be equal. Numbers that are fitted to values of a renderer's arithmetic may
differ in their last digits.
"""
import base64
import math
import re
import shutil
import subprocess
import sys
import tempfile
import zlib
from pathlib import Path

from support.checks import ROOT, arguments, expect, finish
from support.chromium import WEBGL, Chromium, program as chromium
from packed import pack

program, data = arguments()[0], ROOT / "data"
NUMBER = re.compile(r"-?\d+\.\d+(?:e[-+]?\d+)?")
MEASURED = data / "cc_ibiza_sunset_rgb.bsdf"
MODEL = ["export", "film.srbf", "--to"]
COMMANDS = [["fit", MEASURED, "-o", "film.srbf"], [*MODEL, "three", "-o", "film.js"],
            [*MODEL, "html", "--reference", MEASURED, "-o", "page.html"], [*MODEL, "unity", "-o", "film.shader"],
            [*MODEL, "glsl", "--with", "albedo", "-o", "film.gdshaderinc"]]
KEPT = {"film.js": data / "ready", "film.html": data / "ready", "film.shader": data / "ready",
        "film.gdshaderinc": ROOT / "examples/hosts/godot4"}


def text_of(path):
    """The unpacked contents of a packed page, without the numbers of shapes and of the measurement."""
    text = path.read_text(encoding="utf-8")
    found = re.search(r'<script id="packed" type="text/plain">(.*?)</script>', text)
    return zlib.decompress(base64.b64decode(found[1])).split(b"\0", 1)[0].decode() if found else text


# The number of colours of each picture that the page shows.
DRAWN = """new Promise((done, failed) => {
    setTimeout(() => failed("nothing was drawn"), 100000);
    const canvases = () => [...document.querySelectorAll("figure canvas")];
    const look = async () => {
        const is_empty = !canvases().length || canvases().some(({ width }) => width === 300);
        if (typeof viewer === "undefined" || is_empty) return setTimeout(look, 200);
        await viewer.settled();
        done(canvases().map((canvas) => {
            const copy = Object.assign(document.createElement("canvas"), { width: canvas.width, height: canvas.height }).getContext("2d");
            copy.drawImage(canvas, 0, 0);
            return new Set(new Uint32Array(copy.getImageData(0, 0, canvas.width, canvas.height).data.buffer)).size;
        }));
    };
    look();
})"""


def check_page(path):
    """The packed page draws the measurement, the fit and their difference, and the browser reports no problem."""
    browser = Chromium(WEBGL)
    try:
        browser.size(1100, 800)
        browser.open(path)
        colours = browser.run(DRAWN)
        is_drawn = len(colours) == 3 and min(colours) > 1000 and not browser.problems
        expect(is_drawn, f"{path.name} in Chromium draws pictures of {colours} colours {browser.problems or ''}")
    finally:
        browser.close()


with tempfile.TemporaryDirectory() as folder:
    for command in COMMANDS:
        subprocess.run([program, *command], cwd=folder, check=True, stdout=subprocess.DEVNULL)
    Path(folder, "film.html").write_text(pack(Path(folder, "page.html").read_text(encoding="utf-8")), encoding="utf-8")
    for name, place in KEPT.items():
        written, kept = Path(folder, name), place / name
        if "--write" in sys.argv:
            shutil.copy(written, kept)
        texts = [text_of(path) for path in (written, kept)]
        numbers = [[float(number) for number in NUMBER.findall(text)] for text in texts]
        same = NUMBER.sub("#", texts[0]) == NUMBER.sub("#", texts[1]) and all(
            math.isclose(a, b, rel_tol=1e-3, abs_tol=1e-5) for a, b in zip(*numbers))
        expect(same, f"{name} is as the program writes it; otherwise: ./run test hosts ready --write")
if chromium():
    check_page(data / "ready/film.html")
finish()
