"""Checks pages by the rules of axe (WCAG 2 A and AA), which are about names, roles and the contrast of text.

The pages are the exported page and the page of build/site, each before and after a click on a ready material, at the widths
of a phone, a tablet and a screen. Axe comes with a package of PyPI.
"""
# needs: site js:axe_playwright_python
import importlib.util
import tempfile
from pathlib import Path

from support.checks import ROOT, expect, finish, skip, srbf
from support.chromium import WEBGL, Chromium, program

SIZES = [(360, 740), (768, 1024), (1440, 900)]
LEAST_CONTRAST = 4.5


def check_rules(name):
    violations, passes, undecided = chromium.run("accessible.violations()")
    expect(not violations, f"{name}: {passes} rules hold, {len(violations)} are violated; not judged: {undecided}")
    for rule, impact, elements in violations:
        print(" ", rule, impact, *elements[:4], sep="\n    ")


package = importlib.util.find_spec("axe_playwright_python")
if package is None or program() is None:
    skip("no axe_playwright_python or no Chromium")
scripts = [Path(package.submodule_search_locations[0], "axe.min.js"), Path(__file__).with_suffix(".js")]
chromium = Chromium(WEBGL)
with tempfile.TemporaryDirectory() as folder:
    page, model, measured = Path(folder, "page.html"), Path(folder, "paper.srbf"), ROOT / "data/paper_white_rgb.bsdf"
    srbf("fit", measured, "-o", model)
    srbf("export", model, "--to", "html", "--reference", measured, "-o", page)
    site = [ROOT / "build/site/index.html", ROOT / "build/site/gallery/index.html"]
    for path in [page, *(path for path in site if path.exists())]:
        for width, height in SIZES:
            chromium.size(width, height, mobile=width < 700)
            chromium.open(path)
            for script in scripts:
                chromium.run(script.read_text(encoding="utf-8") + "; true")
            check_rules(f"{path.name} at {width} pixels")
            if chromium.run("accessible.show_ball()"):
                check_rules(f"{path.name} at {width} pixels, with a ball")
            charts = chromium.run("accessible.contrasts()")
            if charts:
                contrast, text = charts[0]
                details = f"{len(charts)} texts of charts, contrast at least {contrast:.1f}: {text}"
                expect(contrast >= LEAST_CONTRAST, details)
chromium.close()
finish()
