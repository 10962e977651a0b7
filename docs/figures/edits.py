"""Draws docs/edits.jpg: python3 docs/figures/edits.py SRBF OUT.jpg. It shows ten edits of ready models, in seven steps each. The program
edits and draws the models under its studio light; Chromium sets the text, and a frame about the ball that is not edited."""
import os
import subprocess
import sys
import tempfile

from clone import ROOT
from support import chromium

PANEL, PATHS = 140, 96  # pixels of a panel, paths of a pixel
HIDDEN = 14  # rows of a picture that are not shown, of the dark room above the horizon
FILM, GOLD, PAPER, METAL = "cc_ibiza_sunset", "vch_golden_yellow", "paper_white", "ilm_l3_37_metallic_stand_in"
ROUGHER, COATS, SHARES = [0.5, 0.7, 1, 1.5, 2, 2.5, 3], [0.02, 0.05, 0.1, 0.2, 0.3, 0.4, 0.5], [i / 6 for i in range(7)]


def tint(i):
    """Returns a tint from cool to warm; it is white for i = 3."""
    return f"{2 ** ((i - 3) / 5):.2f},1,{2 ** ((3 - i) / 5):.2f}"


# The name, the model, the options of each step, the values below the balls, and the step that is not edited.
ROWS = [(name, model, [[option, str(value)] for value in values], [text(value) for value in values], unedited)
        for name, model, option, values, text, unedited in (
    ("Roughness of the film, --roughen", FILM, "--roughen", ROUGHER, "× {}".format, 2),
    ("Roughness of golden yellow, --roughen", GOLD, "--roughen", ROUGHER, "× {}".format, 2),
    ("Colour of the film's highlight, --tint-highlight R,G,B", FILM, "--tint-highlight", [tint(i) for i in range(7)], "{}".format, 3),
    ("Brightness of the film's highlight, --scale-highlight", FILM, "--scale-highlight", [0, 0.5, 1, 1.5, 2, 2.5, 3], "× {}".format, 2),
    ("Brightness of the paper's body, --scale-body", PAPER, "--scale-body", [i / 3 for i in range(7)], "× {:.2g}".format, 3),
    ("Saturation of the film, --saturate", FILM, "--saturate", [i / 3 for i in range(7)], "{:.2g}".format, 3),
    ("Hue of the film, --hue", FILM, "--hue", [30 * i for i in range(-3, 4)], "{}°".format, 3),
    ("A clear coat on the film, from smooth to rough, --coat", FILM, "--coat", COATS, "{}".format, None),
    ("Paper into golden yellow, srbf blend --mix", (PAPER, GOLD), "--mix", SHARES, "{:.2g}".format, None),
    ("Silver paint into the film, srbf blend --mix", (METAL, FILM), "--mix", SHARES, "{:.2g}".format, None))]
STYLE = f"""body {{ margin: 0; background: #fff; color: #222; font: 17px DejaVu Sans, sans-serif }} p {{ margin: 0; padding: 12px 6px 4px }}
    div {{ display: flex }} figure {{ margin: 0; width: {PANEL}px; text-align: center; font-size: 15px }} figcaption {{ padding: 3px 0 }}
    i {{ display: block; height: {PANEL - HIDDEN}px; }} .unedited i {{ outline: 4px solid #c40; outline-offset: -4px }} .unedited {{ font-weight: bold }}"""

program, out = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2])
ready = lambda name: os.path.join(ROOT, "data", "gallery", name + ".srbf")
with tempfile.TemporaryDirectory() as work:
    run = lambda *arguments: subprocess.run([program, *arguments], check=True, stdout=subprocess.DEVNULL, cwd=work)
    page = ""
    for row, (name, model, steps, values, unedited) in enumerate(ROWS):
        models = [ready(part) for part in (model if isinstance(model, tuple) else (model,))]
        edited = [f"{row}_{step}.srbf" for step in range(len(steps))]
        for options, path in zip(steps, edited):
            run("edit" if len(models) == 1 else "blend", *models, *options, "-o", path)
        # The first picture, which is not shown, sets the exposure of the row.
        run("render", models[0], *edited, "--size", f"{PANEL}x{PANEL}", "--spp", str(PATHS), "-o", f"{row}.png")
        figures = ""
        for step, value in enumerate(values):
            figures += (f'<figure{" class=unedited" if step == unedited else ""}><i style="background: url({row}.png) {-(step + 1) * PANEL}px {-HIDDEN}px"></i>'
                        f"<figcaption>{value}</figcaption></figure>")
        page += f"<p>{name}</p><div>{figures}</div>"
    chromium.picture(f"<style>{STYLE}</style>{page}", 7 * PANEL, out, work)
