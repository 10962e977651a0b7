"""Checks pages by the rules of axe (WCAG 2 A and AA), which are about names, roles and the contrast of text.

The pages are the exported page and the page of build/site, each before and after a click on a ready material, at the widths of a phone,
a tablet and a screen. Axe comes with a package of PyPI.
"""
# needs: site js:axe_playwright_python
import importlib.util
import subprocess
import tempfile
from pathlib import Path

from support.checks import ROOT, arguments, expect, finish, skip
from support.chromium import WEBGL, Chromium, program

SIZES = [(360, 740), (768, 1024), (1440, 900)]
LEAST_CONTRAST = 4.5
# Computes the contrast between the texts of charts and the page, since axe does not determine their background.
CHARTS = """(() => {
    const channels = (colour) => colour.match(/[\\d.]+/g).map(Number);
    const luminance = (rgb) => rgb.slice(0, 3).map((c) => (c /= 255) <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4)
        .reduce((sum, c, i) => sum + c * [0.2126, 0.7152, 0.0722][i], 0);
    const behind = (element) => {
        const colour = element ? channels(getComputedStyle(element).backgroundColor) : [255, 255, 255];
        return colour[3] === 0 ? behind(element.parentElement) : colour;
    };
    return [...document.querySelectorAll("svg text")].map((text) => {
        const [low, high] = [channels(getComputedStyle(text).fill), behind(text)].map(luminance).sort((a, b) => a - b);
        return [(high + 0.05) / (low + 0.05), text.textContent.slice(0, 40)];
    }).sort(([a], [b]) => a - b);
})()"""
SHOW_BALL = """const ball = document.querySelector("#gallery li a");
    ball?.click();
    while (ball && document.getElementById("editing").hidden) await new Promise((done) => setTimeout(done, 100));
    return ball !== null;"""
RULES = "{ runOnly: ['wcag2a', 'wcag2aa', 'wcag21a', 'wcag21aa'] }"


def axe():
    """Returns the script of axe, or None without its package. The browser of the package is not needed."""
    found = importlib.util.find_spec("axe_playwright_python")
    return found and (Path(found.submodule_search_locations[0]) / "axe.min.js").read_text()


def violations(chromium):
    """Returns violations (rule, severity, elements), the number of rules that hold, and the rules that could not judge some elements."""
    found = chromium.run(f"axe.run({RULES}).then((r) => ({{passes: r.passes.length, open: r.incomplete.map((v) => [v.id, v.nodes.length]), "
                         "wrong: r.violations.map((v) => [v.id, v.impact, v.nodes.map((n) => n.html.slice(0, 120))])}))")
    return found["wrong"], found["passes"], found["open"]


def check_rules(chromium, name):
    found, passes, undecided = violations(chromium)
    expect(not found, f"{name}: {passes} rules hold, {len(found)} are violated; not judged: {undecided}")
    for rule, impact, elements in found:
        print(" ", rule, impact, *elements[:4], sep="\n    ")


def main(srbf):
    with tempfile.TemporaryDirectory() as folder:
        page = Path(folder) / "page.html"
        model = Path(folder) / "paper.srbf"
        measured = ROOT / "data/paper_white_rgb.bsdf"
        subprocess.run([srbf, "fit", measured, "-o", model], check=True, capture_output=True)
        subprocess.run([srbf, "export", model, "--to", "html", "--reference", measured, "-o", page], check=True, capture_output=True)
        pages = [page] + [path for path in [ROOT / "build/site/index.html", ROOT / "build/site/gallery/index.html"] if path.exists()]
        source, chromium = axe(), Chromium(WEBGL)
        for path in pages:
            for width, height in SIZES:
                chromium.size(width, height, mobile=width < 700)
                chromium.open(path)
                chromium.run(source + "; true")
                check_rules(chromium, f"{path.name} at {width} pixels")
                if chromium.run(f"(async () => {{ {SHOW_BALL} }})()"):
                    check_rules(chromium, f"{path.name} at {width} pixels, with a ball")
                charts = chromium.run(CHARTS)
                if charts:
                    contrast, text = charts[0]
                    expect(contrast >= LEAST_CONTRAST, f"{len(charts)} texts of charts, contrast at least {contrast:.1f}: {text}")
        chromium.close()


if __name__ == "__main__":
    if axe() is None or program() is None:
        skip("no axe_playwright_python or no Chromium")
    main(arguments()[0])
    finish()
