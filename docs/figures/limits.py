"""Draws docs/limits.jpg: python3 docs/figures/limits.py SRBF SUNFLOWER OBSIDIAN OUT.jpg.

The picture shows the errors of three fits on spheres under three lamps. The materials are the bundled film, RGL's cg_sunflower, and black
obsidian, which is a stand-in (paper/stand_ins.py). Chromium sets the text.
"""
import os
import subprocess
import sys
import tempfile

from clone import ROOT
from support import chromium

PANEL, HEAD = 300, 90  # pixels of a panel, and of the names of the rows
FILM = os.path.join(ROOT, "data", "cc_ibiza_sunset_rgb.bsdf")
program, sunflower, obsidian, out = (os.path.abspath(path) for path in sys.argv[1:])
# A name, the measurement, the size of the sphere in pixels, and the corner of the part that is shown.
COLUMNS = [("vinyl film, at the rim", FILM, 700, (400, 60)), ("orange film, a highlight", sunflower, 1000, (190, 190)),
           ("black obsidian, of a network", obsidian, PANEL, (0, 0))]
STYLE = f"""body {{ margin: 0; background: #fff; color: #222; font: 17px DejaVu Sans, sans-serif; display: grid; gap: 3px; align-items: center;
    grid-template-columns: {HEAD}px repeat({len(COLUMNS)}, {PANEL}px) }} i {{ height: {PANEL}px }} b {{ font-weight: normal; text-align: center; padding: 6px }}
    span {{ padding-left: 6px }}"""
with tempfile.TemporaryDirectory() as work:
    run = lambda *arguments: subprocess.run([program, *arguments], check=True, stdout=subprocess.DEVNULL, cwd=work)
    rows = {"measured": "", "fitted": ""}
    for column, (_, measured, size, (left, top)) in enumerate(COLUMNS):
        run("fit", measured, "-o", f"{column}.srbf")
        # One picture with both, so that they have the same exposure.
        run("render", measured, f"{column}.srbf", "--renderer", "raster", "--mesh", "sphere", "--size", f"{size}x{size}",
            "-o", f"{column}.png")
        for shift, row in zip((0, size), rows):
            rows[row] += f'<i style="background: url({column}.png) {-left - shift}px {-top}px"></i>'
    heads = "<span></span>" + "".join(f"<b>{name}</b>" for name, *_ in COLUMNS)
    chromium.picture(f"<style>{STYLE}</style>{heads}" + "".join(f"<span>{row}</span>{pictures}" for row, pictures in rows.items()),
                     HEAD + len(COLUMNS) * (PANEL + 3), out, work)
