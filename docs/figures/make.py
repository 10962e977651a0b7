"""Draws the picture of the front page: python3 docs/figures/make.py SRBF OUT.jpg [YELLOW SUNFLOWER] [--compose]

`./run figures` calls this script. The picture shows the bundled film and paper, each measured, fitted by srbf, and fitted by Lambert and
two GGX lobes, on the same object under three lamps, with the visible error of each fit. Two more films stand between them if their files
are given. Those of docs/front.jpg are vch_golden_yellow and cg_sunflower of the RGL database. Chromium sets the text. With --compose only
the text is set, about pictures drawn before.
"""
import json
import os
import subprocess
import sys

from clone import ROOT
from support import chromium

data = os.path.join(ROOT, "data")
PANEL = 360  # pixels a side
HIDDEN, SHOWN = 37, 323  # rows of a picture that are not shown, of the dark room above the horizon, and those that are
PATHS = 256  # a pixel
HEAD = 150  # pixels of the names of the rows
FILM = ("Colour-shifting film", "cc_ibiza_sunset", os.path.join(data, "cc_ibiza_sunset_rgb.bsdf"))
PAPER = ("White paper", "paper_white", os.path.join(data, "paper_white_rgb.bsdf"))
GIVEN = [("Metallic film", "yellow"), ("Glossy film", "sunflower")]
ROWS = [("measured", ""), ("srbf,<br>210 bytes", ""), ("Lambert,<br>two GGX,<br>26 bytes", "_ggx")]
STYLE = f"""body {{ margin: 0; background: #fff; color: #222; font: 24px DejaVu Sans, sans-serif }} div {{ display: flex; align-items: center }}
    b {{ width: {PANEL}px; text-align: center; font-weight: normal; padding: 10px 0 }} p {{ width: {HEAD}px; margin: 0; padding-left: 10px;
    box-sizing: border-box }} i {{ width: {PANEL}px; height: {SHOWN}px; position: relative; font-style: normal }} u {{ position: absolute; left: 8px;
    bottom: 8px; padding: 1px 8px; background: #fffd; text-decoration: none; font-size: 20px }}"""


def draw(program, materials, work):
    run = lambda *words: subprocess.run([program, *words], cwd=work, check=True, stdout=subprocess.DEVNULL)
    for _, stem, measured in materials:
        run("fit", measured, "-o", stem + ".srbf", "--json", stem + ".json")
        run("fit", measured, "--model", "ggx", "--lobes", "2", "-o", stem + "_ggx.srbf", "--json", stem + "_ggx.json")
        run("render", measured, stem + ".srbf", stem + "_ggx.srbf", "--env", "none", "--lights", "three", "--size", f"{PANEL}x{PANEL}",
            "--spp", str(PATHS), "-o", stem + ".png")


def compose(materials, work, out):
    heads = "".join(f"<b>{name}</b>" for name, _, _ in materials)

    def error(stem):
        with open(os.path.join(work, stem + ".json"), encoding="utf-8") as file:
            return f"<u>ΔE {json.load(file)['pictures']['delta_e_itp']:.1f}</u>"

    def cell(stem, row, fit):
        return f'<i style="background: url({stem}.png) {-row * PANEL}px {-HIDDEN}px">{error(stem + fit) if row else ""}</i>'

    rows = "".join(f"<div><p>{name}</p>" + "".join(cell(stem, row, fit) for _, stem, _ in materials) + "</div>"
                   for row, (name, fit) in enumerate(ROWS))
    chromium.picture(f"<style>{STYLE}</style><div><p></p>{heads}</div>{rows}", HEAD + len(materials) * PANEL, out, work)


program, out, *files = [word for word in sys.argv[1:] if word != "--compose"]
materials = [FILM, *((name, stem, os.path.abspath(file)) for (name, stem), file in zip(GIVEN, files)), PAPER]
work = os.path.join(ROOT, "out", "figures")
os.makedirs(work, exist_ok=True)
if "--compose" not in sys.argv:
    draw(os.path.abspath(program), materials, work)
compose(materials, work, os.path.abspath(out))
