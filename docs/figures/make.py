"""The picture of the front page: python3 docs/figures/make.py SRBF OUT.png [METAL PLASTIC] [--compose], as `./run figures` calls it.

The bundled materials, each measured, fitted by srbf and fitted by Lambert and two GGX lobes, on the same object under the same
environment; before them a metal and a plastic, if their files are given. Those of docs/front.png are stand-ins: tables of MERL's layout,
computed from the networks that Sztrajman et al. published for brass and specular-red-phenolic. Chromium sets the text, so that it is
drawn from outlines. With --compose only the text is set, about pictures drawn before.
"""
import os
import subprocess
import sys

here = os.path.dirname(os.path.abspath(__file__))
data = os.path.join(here, "..", "..", "data")
sys.path.insert(0, os.path.join(here, "..", "..", "test"))
import chromium  # noqa: E402

PANEL = 360  # pixels a side
HIDDEN, SHOWN = 37, 323  # rows of a picture that are not shown, of the dark room above the horizon, and those that are
PATHS = 128  # a pixel
HEAD = 150  # pixels of the names of the rows
BUNDLED = [("White paper", "paper_white", os.path.join(data, "paper_white_rgb.bsdf")),
           ("Vinyl film", "cc_ibiza_sunset", os.path.join(data, "cc_ibiza_sunset_rgb.bsdf"))]
GIVEN = [("Brass (stand-in)", "metal"), ("Red plastic (stand-in)", "plastic")]
ROWS = ["the table", "srbf,<br>210 bytes", "Lambert,<br>two GGX,<br>26 bytes"]
STYLE = f"""body {{ margin: 0; background: #fff; color: #222; font: 24px DejaVu Sans, sans-serif }} div {{ display: flex; align-items: center }}
    b {{ width: {PANEL}px; text-align: center; font-weight: normal; padding: 10px 0 }} p {{ width: {HEAD}px; margin: 0; padding-left: 10px;
    box-sizing: border-box }} i {{ width: {PANEL}px; height: {SHOWN}px }}"""


def draw(program, materials, work):
    run = lambda *words: subprocess.run([program, *words], cwd=work, check=True, stdout=subprocess.DEVNULL)
    for _, stem, measured in materials:
        run("fit", measured, "-o", stem + ".srbf")
        run("fit", measured, "--model", "ggx", "--lobes", "2", "-o", stem + "_ggx.srbf")
        run("render", measured, stem + ".srbf", stem + "_ggx.srbf", "--size", f"{PANEL}x{PANEL}", "--spp", str(PATHS), "-o", stem + ".png")


def compose(materials, work, out):
    heads = "".join(f"<b>{name}</b>" for name, _, _ in materials)
    cell = lambda stem, row: f'<i style="background: url({stem}.png) {-row * PANEL}px {-HIDDEN}px"></i>'
    rows = "".join(f"<div><p>{name}</p>" + "".join(cell(stem, row) for _, stem, _ in materials) + "</div>" for row, name in enumerate(ROWS))
    page = os.path.join(work, "front.html")
    with open(page, "w", encoding="utf-8") as file:
        file.write(f'<!doctype html><meta charset="utf-8"><style>{STYLE}</style><div><p></p>{heads}</div>{rows}')
    browser = chromium.Chromium([])
    try:
        browser.size(HEAD + len(materials) * PANEL, 100)
        browser.open(page)
        browser.screenshot(out, whole=True)
    finally:
        browser.close()


program, out, *files = [word for word in sys.argv[1:] if word != "--compose"]
materials = [(name, stem, os.path.abspath(file)) for (name, stem), file in zip(GIVEN, files)] + BUNDLED
work = os.path.abspath(os.path.join(here, "..", "..", "out", "figures"))
os.makedirs(work, exist_ok=True)
if "--compose" not in sys.argv:
    draw(os.path.abspath(program), materials, work)
compose(materials, work, os.path.abspath(out))
