"""Draws docs/surface_hosts.png: python3 docs/figures/hosts.py THREE.png CYCLES.png.

THREE.png and CYCLES.png are the pictures that test/hosts/three_gltf.py and test/hosts/principled.py write as PICTURE. They stand beside
each other, under the names of what they show. Chromium sets the text.
"""
import os
import sys

from clone import ROOT
from support import chromium

PANEL = 128  # pixels a side
HEAD = 190  # pixels of the names of the rows
ROWS = ["cc_ibiza_sunset", "cg_sunflower", "colodur_napoli_4f", "paper_white", "vch_golden_yellow", "brushed metal<br>(no measurement)"]
GROUPS = ["three.js under lights", "three.js under an environment", "Blender's Cycles under an environment"]
PROGRAMS = ["three.js", "three.js", "Cycles"]  # of each group, after the measurement and the surface
EMPTY = {(5, 0), (5, 3), (5, 4), (5, 5), (5, 6)}  # (row, column) without a picture
STYLE = f"""body {{ margin: 0; background: #fff; color: #222; font: 17px DejaVu Sans, sans-serif }}
    table {{ border-spacing: 0 }} td, th {{ padding: 0; font-weight: normal; text-align: center }} td:first-child {{ text-align: left; padding-left: 8px;
    width: {HEAD}px; box-sizing: border-box }} th {{ padding: 6px 0; width: {PANEL}px }} th[colspan] {{ border-bottom: 1px solid #999; width: auto }}
    img {{ display: block }}"""


def cell(picture, column, row):
    """Returns a panel of a picture."""
    return f'<td><svg width="{PANEL}" height="{PANEL}"><image href="file://{picture}" x="{-column * PANEL}" y="{-row * PANEL}"/></svg></td>'


def page_of(three, cycles):
    heads = "<tr><td></td>" + "".join(f'<th colspan="3">{name}</th>' for name in GROUPS) + "</tr><tr><td></td>"
    heads += "".join(f"<th>measurement</th><th>surface, by<br>srbf render</th><th>{program}</th>" for program in PROGRAMS) + "</tr>"
    pictures = [(three, column) for column in range(6)] + [(cycles, column) for column in range(3)]
    rows = ""
    for row, name in enumerate(ROWS):
        cells = (cell(*picture, row) if (row, column) not in EMPTY else "<td></td>" for column, picture in enumerate(pictures))
        rows += f"<tr><td>{name}</td>" + "".join(cells) + "</tr>"
    return f'<style>{STYLE}</style><table>{heads}{rows}</table>'


three, cycles = map(os.path.abspath, sys.argv[1:])
chromium.picture(page_of(three, cycles), HEAD + 9 * PANEL, os.path.join(ROOT, "docs", "surface_hosts.png"))
