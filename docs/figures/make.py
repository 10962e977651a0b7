"""The picture of the front page: python3 docs/figures/make.py SRBF OUT.png [--compose], as `./run figures` calls it.

The bundled materials, each measured, fitted by srbf and fitted by Lambert and GGX, on the same object under the same environment.
Chromium sets the text, so that it is drawn from outlines. With --compose only the text is set, about pictures drawn before.
"""
import os
import subprocess
import sys

here = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(here, "..", "..", "test"))
import chromium  # noqa: E402

PANEL = 512  # pixels a side
HIDDEN, SHOWN = 52, 460  # rows of a picture that are not shown, of the dark room above the horizon, and those that are
PATHS = 64  # a pixel
MATERIALS = [("White paper", "paper_white"), ("Vinyl film that changes its colour", "cc_ibiza_sunset")]
COLUMNS = ["measured, 659 kB", "srbf, 208 bytes", "Lambert and GGX, 16 bytes"]
STYLE = f"""body {{ margin: 0; background: #fff; color: #222; font: 24px DejaVu Sans, sans-serif }} div {{ display: flex }}
    b {{ width: {PANEL}px; text-align: center; font-weight: normal; padding: 12px 0 }} h2 {{ font-size: 20px; margin: 0; padding: 8px 12px }}
    img {{ display: block; width: {3 * PANEL}px; height: {SHOWN}px; object-fit: none; object-position: 0 {-HIDDEN}px }}"""


def draw(program, work):
    run = lambda *words: subprocess.run([program, *words], cwd=work, check=True, stdout=subprocess.DEVNULL)
    for _, stem in MATERIALS:
        measured = os.path.join(here, "..", "..", "data", stem + "_rgb.bsdf")
        run("fit", measured, "-o", stem + ".srbf")
        run("fit", measured, "--model", "ggx", "-o", stem + "_ggx.srbf")
        run("render", measured, stem + ".srbf", stem + "_ggx.srbf", "--size", f"{PANEL}x{PANEL}", "--spp", str(PATHS), "-o", stem + ".png")


def compose(work, out):
    rows = "".join(f'<h2>{name}</h2><img src="{stem}.png">' for name, stem in MATERIALS)
    heads = "".join(f"<b>{column}</b>" for column in COLUMNS)
    page = os.path.join(work, "front.html")
    with open(page, "w", encoding="utf-8") as file:
        file.write(f'<!doctype html><meta charset="utf-8"><style>{STYLE}</style><div>{heads}</div>{rows}')
    browser = chromium.Chromium([])
    try:
        browser.size(3 * PANEL, 100)
        browser.open(page)
        browser.screenshot(out, whole=True)
    finally:
        browser.close()


work = os.path.abspath(os.path.join(here, "..", "..", "out", "figures"))
os.makedirs(work, exist_ok=True)
if "--compose" not in sys.argv:
    draw(os.path.abspath(sys.argv[1]), work)
compose(work, os.path.abspath(sys.argv[2]))
