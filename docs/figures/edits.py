"""docs/edits.png: python3 docs/figures/edits.py STRIPS.png, ten rows of seven spheres, with the names of the edits beside them and a frame
about the sphere that is not edited. Chromium sets the text."""
import os
import sys

here = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(here, "..", "..", "test"))
import chromium  # noqa: E402

PANEL, COLUMNS, HEAD, END = 72, 7, 310, 80  # pixels of a sphere, spheres of a row, pixels of the names and of the last values
# Name, first and last value, and the column of the sphere that is not edited.
ROWS = [("film: roughness", "× 0.5", "× 3", None), ("golden yellow: roughness", "× 0.5", "× 3", None), ("film: tint of the highlight", "cool", "warm", 3),
        ("film: highlight", "× 0", "× 3", 2), ("paper: body", "× 0", "× 2", 3), ("film: saturation", "0", "2", 3), ("film: hue", "−90°", "90°", 3),
        ("film: coat of roughness", "0.02", "0.5", None), ("paper into golden yellow", "0", "1", None), ("metallic paint into film", "0", "1", None)]
STYLE = f"""body {{ margin: 0; background: #757575; color: #fff; font: 17px DejaVu Sans, sans-serif }} div {{ display: flex; align-items: center }}
    p {{ margin: 0; width: {HEAD}px; box-sizing: border-box; padding: 0 10px; display: flex; justify-content: space-between; gap: 8px }} span + span {{ white-space: nowrap }}
    p + svg + p {{ width: {END}px }}"""
strips = os.path.abspath(sys.argv[1])
frame = lambda at: "" if at is None else f'<rect x="{at * PANEL + 1}" y="1" width="{PANEL - 2}" height="{PANEL - 2}" fill="none" stroke="#fff" stroke-width="2"/>'
rows = "".join(f'<div><p><span>{name}</span><span>{first}</span></p><svg width="{COLUMNS * PANEL}" height="{PANEL}"><image href="file://{strips}" '
               f'y="{-row * PANEL}"/>{frame(unedited)}</svg><p>{last}</p></div>' for row, (name, first, last, unedited) in enumerate(ROWS))
chromium.picture(f"<style>{STYLE}</style>{rows}", HEAD + COLUMNS * PANEL + END, os.path.join(here, "..", "edits.png"))
