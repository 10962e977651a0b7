"""Checks the page of build/site in a browser, which opens it from the disk as a user does.

Checks:
  - Each kind of measurement is opened, fitted and saved, and the saved files have the bytes of the program's files.
  - Damaged files are refused with the program's words.
  - The page in one file, data/ready/srbf.html, fits as the program does.

`./run test hosts site --write` replaces the page in data/ready by that of build/.
"""
# needs: site
import hashlib
import json
import math
import re
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from support.checks import ROOT, arguments, expect, finish, skip
from support.chromium import WEBGL, Chromium, program

srbf = arguments()[0]
LONGEST_TASK, CANCELLED_WITHIN, MOST_MEMORY = 100, 1, 300 * 2**20  # milliseconds; seconds; bytes of the module
PATIENCE = 400  # seconds until a fit counts as failed
EXPORTS = [("glsl", ".glsl"), ("hlsl", ".hlsl"), ("unity", ".shader"), ("wgsl", ".wgsl"), ("msl", ".metal"),
           ("c", ".h"), ("three", ".js"), ("table", ".binary"), ("table", ".bsdf"), ("table", ".mbsdf")]
NUMBER = re.compile(r"-?\d+\.?\d*(?:e[-+]?\d+)?")
SLIDERS = ["roughen", "highlight", "highlight_warmth", "body", "body_warmth", "hue", "saturate"]
LAST_BALL = "#gallery ul:last-of-type li:last-child a"


def check(condition, text):
    expect(condition, text, quiet=True)


def run(*arguments):
    return subprocess.run([str(srbf), *map(str, arguments)], capture_output=True, text=True)


class Page:
    def __init__(self, path):
        self.chromium = Chromium(WEBGL)
        self.chromium.size(1280, 800)
        self.open(path)

    def open(self, path, fragment=""):
        self.chromium.open(path, fragment)
        self.chromium.run(Path(__file__).with_suffix(".js").read_text(encoding="utf-8") + "; true")

    def call(self, function, *arguments):
        """Returns the result of a function of site.js."""
        return self.chromium.run(f"site.{function}({', '.join(map(json.dumps, arguments))})")

    def drop(self, path):
        """Drops the file on the page."""
        document = self.chromium.ask("DOM.getDocument")["root"]["nodeId"]
        node = self.chromium.ask("DOM.querySelector", nodeId=document, selector="#given")["nodeId"]
        self.chromium.ask("DOM.setFileInputFiles", nodeId=node, files=[str(path)])
        self.call("drop")

    def wait(self, name, done):
        begun = time.time()
        while time.time() - begun < PATIENCE:
            state = self.call("state")
            if done(state):
                return state, time.time() - begun
            time.sleep(0.05)
        check(False, f"{name}: nothing after {PATIENCE} s: {state}")
        return state, PATIENCE

    def model(self):
        """Returns the bytes of the model's file."""
        return bytes(self.call("saved_bytes", "srbf", ""))


def hash_of(path):
    return hashlib.sha256(path.read_bytes()).hexdigest() if path.exists() else "nothing"


def compare_file(page, file, folder):
    """Opens, fits and saves a file on the page and by the program. What they save must be equal."""
    page.drop(file)
    page.wait(file.name, lambda state: state["failure"] or state["is_fitting"])
    # The verdict on a first draft or, for both sides, on the last fit.
    _, seen = page.wait(file.name, lambda state: state["failure"] or state["verdict"])
    state, seconds = page.wait(file.name, lambda state: state["failure"] or state["name"] == file.name)
    longest = page.call("longest_task")
    print(f"  {file.name}: the first fit is shown after {seen:.1f} s and the last after {seen + seconds:.1f} s, "
          f"{state['memory'] / 2**20:.0f} MB, at most {longest} ms without an answer: "
          f"{state['failure'] or state['verdict']}")
    check(longest <= LONGEST_TASK, f"{file.name}: the page does not answer for {longest} ms")
    check(not state["failure"], f"{file.name} is refused: {state['failure']}")
    check(state["memory"] <= MOST_MEMORY, f"{file.name} takes {state['memory']} bytes")
    if state["failure"]:
        return
    model, expected = folder / (file.stem + ".srbf"), folder / "program.srbf"
    model.write_bytes(page.model())
    result = run("fit", file, "-o", expected)
    check(result.returncode == 0, result.stderr)
    check(hash_of(model) == hash_of(expected), f"{model.name} is not what the program writes")
    # The other exports are compared with the program's exports of the page's model.
    for export, ending in EXPORTS:
        name = file.stem + ending
        ours, path = page.call("saved_hash", export, name), folder / name
        result = run(*(("convert", model) if export == "table" else ("export", model, "--to", export)), "-o", path)
        if result.returncode != 0:
            check(ours.startswith("error "), f"{name}: the program refuses it: {result.stderr.strip()}")
        elif ending in (".binary", ".bsdf", ".mbsdf", ".js", ".shader") and ours != hash_of(path):
            print(f"  note: {name} differs in bytes")  # fused arithmetic of pictures
            check(not ours.startswith("error "), f"{name}: {ours}")
        else:
            check(ours == hash_of(path), f"{name} is not what the program writes: {ours}")


def check_blender_script(page, subject, folder):
    """Checks that the script for Blender is the program's. Fitted numbers, of the order of 1, may differ a little."""
    begun = time.time()
    ours = page.chromium.run("app.save_as('blender', '').then((content) => content.text())")
    seconds, path = time.time() - begun, folder / "program.py"
    result = run("export", subject, "--to", "blender", "-o", path)
    check(result.returncode == 0, result.stderr)
    texts = [ours, path.read_text(encoding="utf-8")]
    numbers = [[float(number) for number in NUMBER.findall(text)] for text in texts]
    has_numbers = all(math.isclose(a, b, abs_tol=0.01) for a, b in zip(*numbers))
    has_text = NUMBER.sub("#", texts[0]) == NUMBER.sub("#", texts[1])
    check(has_text and has_numbers, f"the script for Blender is not that of {subject.name}")
    print(f"  {subject.name}: the script for Blender is written after {seconds:.1f} s, "
          f"{'' if texts[0] == texts[1] else 'nearly '}with the bytes of the program's")


def check_one_screen(page, material, others=""):
    """Checks that sliders, buttons that save and these other elements fit on the screen with the material's picture."""
    top, bottom = page.call("extent", material, others)
    check(bottom - top <= 800, f"sliders, buttons and picture take {bottom - top:.0f} pixels")


def check_gallery(page, folder):
    """Checks that a link of the gallery shows its model, which is saved as it is and can be edited."""
    chromium = page.chromium
    links = chromium.run("[...document.querySelectorAll('#gallery li a')].map((link) => link.hash.slice(1))")
    models = (path.stem for path in (ROOT / "data/gallery").glob("*.srbf"))
    check(links == sorted(models, key=lambda stem: ("_stand_in" in stem, stem)), f"the gallery has {links}")
    name, begun = links[-1] + ".srbf", time.time()
    click_ball(page, LAST_BALL)
    chromium.run("viewer.settled()")
    print(f"  {name}: the picture of the model is shown after {time.time() - begun:.1f} s")
    check(page.model() == (ROOT / "data/gallery" / name).read_bytes(), f"{name} is not saved as it was opened")
    shown = page.call("materials")
    check(shown == ["1"], f"{name}: pictures {shown}")
    is_in_view = "document.getElementById('state').getBoundingClientRect().top < innerHeight / 2"
    check(chromium.run(is_in_view), f"{name} is shown below the window")
    state = page.call("state")
    check(state["is_editable"], f"{name} cannot be edited")
    for words in ("ΔE 3.1 against a table from a neural network", "ask the authors"):
        check(words in state["about"], f"{name} is described by {state['about']!r}")
    is_alone = chromium.run("[...document.querySelectorAll('.compared')].every((e) => e.hidden)")
    check(is_alone, f"{name}: the page talks of a measurement")
    check(chromium.run("document.querySelector('#about a')?.href") == "https://rgl.epfl.ch/materials",
          f"{name} has no link to its measurement")
    check_one_screen(page, "1", ", .controls > label > *")
    check_blender_script(page, ROOT / "data/gallery" / name, folder)
    # Another file is opened, and then this ball again.
    page.drop(ROOT / "data/paper_white_rgb.csv")
    page.wait("another file", lambda state: state["name"] == "paper_white_rgb.csv" or state["is_fitting"])
    click_ball(page, LAST_BALL)
    chromium.click(LAST_BALL)
    check(chromium.run(is_in_view), "a second click on a ball shows nothing")
    click_ball(page, "#gallery li:first-child a")
    # From the measurement and not from its model, since the page has the measurement.
    check_blender_script(page, ROOT / "data/cc_ibiza_sunset_rgb.bsdf", folder)


def click_ball(page, ball):
    """Clicks another ball, and waits until it is shown."""
    page.chromium.click(ball)
    name = page.chromium.run(f"document.querySelector({ball!r}).hash.slice(1)") + ".srbf"
    page.wait(name, lambda state: state["name"] == name)


def check_layout(page):
    """Checks that edits and resets move nothing, and that there is a picture without black noise at every moment."""
    chromium = page.chromium
    for width in (1440, 768, 360):
        chromium.size(width, 900)
        page.open(ROOT / "build/site/index.html", "#satin_blue_stand_in")
        page.wait("a ball", lambda state: state["is_editable"])
        page.wait("a picture", lambda state: chromium.run("viewer.settled().then(() => viewer.scene(1).samples >= 16)"))
        calm, before = page.call("pixels", "1")[0], page.call("edited_state")["boxes"]
        name = chromium.run("document.querySelector('figure:not([hidden]) figcaption').textContent")
        check(name == "White satin with blue highlights", f"a lone ball has the name {name!r}")
        for hue in (60, 0, 60):
            page.call("set_control", "hue", hue)
            chromium.settle()
            now, is_drawn = page.call("pixels", page.call("materials")[0])
            is_calm = sum(abs(a - b) for a, b in zip(now, calm)) / len(calm) < 0.1
            check(is_drawn and is_calm, f"{width} pixels wide, hue {hue}: no picture, or noise")
            page.wait("an edit", lambda state: not state["is_busy"] and state["is_edited"] == (hue != 0))
            boxes = page.call("edited_state")["boxes"]
            check(boxes == before, f"{width} pixels wide, hue {hue}: sliders, buttons or pictures move")


def check_damaged_files(page, folder):
    """Checks that wrong files are refused in one line, by the program's words or by their kind, and change nothing."""
    film = (ROOT / "data/cc_ibiza_sunset_rgb.bsdf").read_bytes()
    contents = {"empty.bsdf": b"", "text.bsdf": b"Hello, world\n", "cut.bsdf": film[:100000],
                "head.bsdf": film[:12] + b"\xff" * 40 + film[52:], "wrong.csv": b"wl_x,wl_y\n1,2\n",
                "wrong.xml": b"<?xml version='1.0'?><WindowElement><Optical></WindowElement>",
                "huge.binary": (2**30).to_bytes(4, "little") * 3 + b"\0" * 100, "picture.png": b"\x89PNG\r\n\x1a\n",
                "report.json": b'{"lobes": 9}', "cut.hdr": b"#?RADIANCE\n\n-Y 4 +X 8\n"}
    kinds = {"empty.bsdf": "an empty file", "picture.png": "a PNG picture", "report.json": "a JSON file"}
    click_ball(page, LAST_BALL)
    page.call("set_control", "hue", 90)
    page.wait("the edit", lambda state: state["is_edited"] and not state["is_busy"])
    before = page.call("edited_state")
    for name, content in contents.items():
        file = folder / name
        file.write_bytes(content)
        page.drop(file)
        state, _ = page.wait(name, lambda state: state["failure"].startswith(name))
        message = run("info", file).stderr.strip().removeprefix("srbf: ").replace(str(file), name)
        if "unknown format" in message:
            kind = kinds.get(name, "a file of another kind")
            message = f"{name}: this is {kind}; drop a measurement, a model or an .hdr"
        message = re.sub(", or one of them as .* in --columns", "", message)  # the page has no options
        failure = state["failure"]
        check(failure == message or name == "cut.hdr", f"{name}: the page says {failure!r}, not {message!r}")
        check(page.call("edited_state") == before, f"{name}: it takes away what was there")
        check("\n" not in failure and len(failure) < 500, f"{name}: not one line")
    print(f"  {len(contents)} damaged files are refused in one line each, such as: {failure}")


def check_cancelled_fit(page):
    page.drop(ROOT / "data/paper_white_rgb.bsdf")
    page.wait("working", lambda state: state["is_fitting"])
    time.sleep(2)
    page.chromium.click("#cancel")
    _, seconds = page.wait("cancelled", lambda state: "Cancelled" in state["verdict"] and not state["is_fitting"])
    check(seconds <= CANCELLED_WITHIN, f"cancelled after {seconds:.2f} s")
    print(f"  the fit is cancelled within {seconds:.2f} s")


def check_cancelled_save(page):
    """Checks that a save can be cancelled, and that the edited model remains."""
    chromium = page.chromium
    click_ball(page, LAST_BALL)
    page.call("set_control", "hue", 90)
    state, _ = page.wait("the edit", lambda state: state["is_edited"])
    check(state["heading"].startswith("Edited: made from "), f"the edited ball has the name {state['heading']!r}")
    before = page.model()
    chromium.click("[data-save=blender]")
    page.wait("a save", lambda state: state["is_saving"])
    chromium.click("#stop")
    is_enabled = "!document.querySelector('[data-save=blender]').disabled"
    page.wait("no save", lambda state: chromium.run(is_enabled))
    check(page.call("state")["saved"] == "Nothing was saved.", "a save is not cancelled")
    check(page.model() == before, "the edited model is not kept when a save is cancelled")
    chromium.run("document.querySelector('#editing [type=reset]').click()")
    page.wait("the ball as it was", lambda state: not state["is_edited"] and not state["is_busy"])
    heading = page.call("state")["heading"]
    check(not heading.startswith("Edited"), f"the ball has the name {heading!r} after a reset")
    print("  a save is cancelled, and the edited model remains")


def check_replaced_file(page):
    """Opens a second file while the first is fitted; then changes the number of lobes."""
    page.drop(ROOT / "data/cc_ibiza_sunset_rgb.bsdf")
    time.sleep(2)
    page.drop(ROOT / "data/paper_white_rgb.bsdf")
    page.wait("the second", lambda state: state["name"] == "paper_white_rgb.bsdf")
    page.call("set_control", "lobes", 4)
    state, _ = page.wait("fewer lobes", lambda state: state["bytes"] == 100 and not state["is_fitting"])
    check(state["name"] == "paper_white_rgb.bsdf", "the second file does not replace the first")


def check_edits(page, folder):
    """Drops a measurement, edits its model and saves it as a three.js material, by mouse alone."""
    film, chromium = ROOT / "data/cc_ibiza_sunset_rgb.bsdf", page.chromium
    page.drop(film)
    page.wait("the film", lambda state: state["name"] == film.name and not state["is_fitting"])
    fitted = page.model()
    chromium.ask("Page.setDownloadBehavior", behavior="allow", downloadPath=str(folder))
    for slider in SLIDERS:
        chromium.drag(f"#edit_{slider}", 25, 0)
    edits = ("Edited: roughness of the highlight ×", "% warmer", "hue", "saturation")
    state, seconds = page.wait("edits", lambda state: all(edit in state["edit_status"] for edit in edits))
    check_one_screen(page, "2")
    print(f"  {state['edit_status']} It was there {seconds:.1f} s after the last drag.")
    chromium.click("[data-save=three]")
    saved = folder / (film.stem + "_edited.js")
    page.wait(saved.name, lambda state: saved.exists())
    is_material = all(word in saved.read_text() for word in ("roughen", "BlendMaterial"))
    check(is_material, f"{saved.name} is no three.js material")
    model = folder / "edited.srbf"
    model.write_bytes(page.model())
    info = run("info", model).stdout
    check("roughen" in info and "tint highlight" in info, f"the saved model does not say its edits: {info}")
    for slider in SLIDERS:
        chromium.click(f"[data-reset={slider}]")
    page.wait("resets", lambda state: not state["edit_status"])
    check(page.model() == fitted, "the model is not the fitted one after resets")


def close_page(page):
    check(not page.chromium.problems, f"the browser's console: {page.chromium.problems}")
    is_local = all(url.startswith(("file:", "blob:", "data:")) for url in page.chromium.requests)
    check(is_local, "something is asked of the network")
    page.chromium.close()


one_file = ROOT / "data/ready/srbf.html"
if "--write" in sys.argv:
    shutil.copy(ROOT / "build/srbf.html", one_file)
if not program():
    skip("no Chromium (Debian: chromium)")
page = Page(one_file)
with tempfile.TemporaryDirectory() as name:
    print("  the page in one file:")
    film = ROOT / "data/cc_ibiza_sunset_rgb.bsdf"
    compare_file(page, film, Path(name))
    check_blender_script(page, film, Path(name))
    check_gallery(page, Path(name))
close_page(page)
page = Page(ROOT / "build/site/index.html")
loaded_ms = page.chromium.run("Math.round(performance.timing.loadEventEnd - performance.timing.navigationStart)")
print(f"  the page is shown after {loaded_ms} ms")
with tempfile.TemporaryDirectory() as name:
    for file in (film, film.with_suffix(".csv")):
        compare_file(page, file, Path(name))
        time.sleep(1)
        page.call("longest_task")  # checking a saved file takes longer than saving it
    check_edits(page, Path(name))
    check_gallery(page, Path(name))
    check_damaged_files(page, Path(name))
    check_cancelled_fit(page)
    check_cancelled_save(page)
    check_replaced_file(page)
longest = page.call("longest_task")
check(longest <= LONGEST_TASK, f"the page does not answer for {longest} ms")
close_page(page)
page = Page(ROOT / "build/site/index.html")
check_layout(page)
close_page(page)
finish()
