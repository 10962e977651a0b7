"""Draws the ready models and names their kinds: python3 docs/figures/gallery.py OUT.jpg, where OUT.jpg is data/gallery/gallery.jpg. The
page that fits, build/srbf.html, draws each model of data/gallery as it first shows it; Chromium sets the kinds, which the table of
data/README.md has. Measured materials come first. The page shows the balls alone (web/site.mjs knows PANEL and ROW)."""
import glob
import os
import re
import sys

from clone import ROOT
from support import chromium

PANEL, COLUMNS, SAMPLES = (200, 150), 5, 64  # pixels of a panel, panels of a row, samples of a pixel
ROW = 203  # pixels of a panel with its text
STAND_IN = "_stand_in"
STYLE = f"""body {{ margin: 0; background: #fff; color: #222; font: 13px/1.15 DejaVu Sans, sans-serif; display: grid;
    grid-template-columns: repeat({COLUMNS}, {PANEL[0]}px); grid-auto-rows: {ROW}px }} figure {{ margin: 0 }} img {{ display: block }}
    figcaption {{ padding: 3px 5px 0 }} small {{ color: #666; font-size: 12px }}"""
PICTURE = """(() => { const canvas = document.querySelector("figure[data-material='1'] canvas"), { width, height } = canvas;
    const copy = Object.assign(document.createElement("canvas"), { width, height });
    copy.getContext("2d").drawImage(canvas, 0, 0);
    return copy.toDataURL(); })()"""

models = sorted(glob.glob(os.path.join(ROOT, "data", "gallery", "*.srbf")), key=lambda path: (STAND_IN in path, path))
with open(os.path.join(ROOT, "data", "README.md"), encoding="utf-8") as file:
    kinds = dict(re.findall(r"^\| (\w+) \| (.+?) \| a ", file.read(), re.MULTILINE))
page, figures = chromium.Chromium(chromium.WEBGL), ""
wait = lambda shown: page.run(f"(async () => {{ while (!({shown})) await new Promise((done) => setTimeout(done, 100)); await viewer.settled(); }})()")
page.size(1280, 800)
page.open(os.path.join(ROOT, "build", "srbf.html"))
page.run(f"document.getElementById('viewer').style.setProperty('--one', '{PANEL[0]}px')")
for path in models:
    stem = os.path.basename(path).removesuffix(".srbf")
    page.click(f"#gallery a[href='#{stem}']")
    wait(f"app.state().fitted && app.state().file.name === '{stem}.srbf'")
    wait(f"viewer.scene(1).samples >= {SAMPLES}")
    source = "computed by a network" if STAND_IN in stem else "measured"
    kind = kinds[stem][0].upper() + kinds[stem][1:]
    figures += f'<figure><img src="{page.run(PICTURE)}"><figcaption>{kind}<br><small>{source}</small></figcaption></figure>'
page.close()
chromium.picture(f"<style>{STYLE}</style>{figures}", COLUMNS * PANEL[0], os.path.abspath(sys.argv[1]))
