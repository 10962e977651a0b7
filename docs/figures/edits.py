"""docs/edits.png: python3 docs/figures/edits.py STRIPS.png, ten rows of seven spheres, with the names of the edits beside them. Chromium sets the text."""
import os
import sys

here = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(here, "..", "..", "test"))
import chromium  # noqa: E402

PANEL, COLUMNS, HEAD, END = 72, 7, 310, 80  # pixels of a sphere, spheres of a row, pixels of the names and of the last values
ROWS = [("film: roughness", "× 0.5", "× 3"), ("golden yellow: roughness", "× 0.5", "× 3"), ("film: tint of the highlight", "cool", "warm"),
        ("film: highlight", "× 0", "× 3"), ("paper: body", "× 0", "× 2"), ("film: saturation", "0", "2"), ("film: hue", "−90°", "90°"),
        ("film: coat of roughness", "0.02", "0.5"), ("paper into golden yellow", "0", "1"), ("metallic paint into film", "0", "1")]
STYLE = f"""body {{ margin: 0; background: #757575; color: #fff; font: 17px DejaVu Sans, sans-serif }} div {{ display: flex; align-items: center }}
    p {{ margin: 0; width: {HEAD}px; box-sizing: border-box; padding: 0 10px; display: flex; justify-content: space-between; gap: 8px }} span + span {{ white-space: nowrap }}
    p + svg + p {{ width: {END}px }}"""
strips = os.path.abspath(sys.argv[1])
rows = "".join(f'<div><p><span>{name}</span><span>{first}</span></p><svg width="{COLUMNS * PANEL}" height="{PANEL}"><image href="file://{strips}" '
               f'y="{-row * PANEL}"/></svg><p>{last}</p></div>' for row, (name, first, last) in enumerate(ROWS))
chromium.picture(f"<style>{STYLE}</style>{rows}", HEAD + COLUMNS * PANEL + END, os.path.join(here, "..", "edits.png"))
