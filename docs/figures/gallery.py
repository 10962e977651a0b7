"""The ready models and what they are: python3 docs/figures/gallery.py SRBF OUT.jpg, where OUT.jpg is data/gallery/gallery.jpg. The program
draws each model of data/gallery under its built-in studio light; Chromium sets the kinds, which the table of data/README.md has. Measured
materials come first. The page that fits shows the balls alone (web/site.mjs knows PANEL, ROW and HIDDEN)."""
import glob
import os
import re
import subprocess
import sys
import tempfile

here = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(here, "..", "..", "test"))
import chromium  # noqa: E402

PANEL, COLUMNS, PATHS = 200, 5, 128  # pixels of a panel, panels of a row, paths of a pixel
ROW = 233  # pixels of a panel with its text
HIDDEN = 20  # rows of a picture that are not shown, of the dark room above the horizon
STAND_IN = "_stand_in"
STYLE = f"""body {{ margin: 0; background: #fff; color: #222; font: 13px/1.15 DejaVu Sans, sans-serif; display: grid;
    grid-template-columns: repeat({COLUMNS}, {PANEL}px); grid-auto-rows: {ROW}px }} figure {{ margin: 0 }} i {{ display: block; height: {PANEL - HIDDEN}px }}
    figcaption {{ padding: 3px 5px 0 }} small {{ color: #666; font-size: 12px }}"""

program, out = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2])
models = sorted(glob.glob(os.path.join(here, "..", "..", "data", "gallery", "*.srbf")), key=lambda path: (STAND_IN in path, path))
with open(os.path.join(here, "..", "..", "data", "README.md"), encoding="utf-8") as file:
    kinds = dict(re.findall(r"^\| (\w+) \| (.+?) \| a ", file.read(), re.MULTILINE))
with tempfile.TemporaryDirectory() as work:
    figures = ""
    for path in models:
        stem = os.path.basename(path).removesuffix(".srbf")
        picture = os.path.join(work, stem + ".png")
        subprocess.run([program, "render", path, "--size", f"{PANEL}x{PANEL}", "--spp", str(PATHS), "-o", picture], check=True, stdout=subprocess.DEVNULL)
        source = "computed by a network" if STAND_IN in stem else "measured"
        figures += f'<figure><i style="background: url({stem}.png) 0 {-HIDDEN}px"></i><figcaption>{kinds[stem][0].upper() + kinds[stem][1:]}<br><small>{source}</small></figcaption></figure>'
    chromium.picture(f"<style>{STYLE}</style>{figures}", COLUMNS * PANEL, out, work)
