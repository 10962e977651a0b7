"""The exported page and the page of build/site, at the widths of a phone, a tablet and a screen, by the rules of axe (WCAG 2 A and AA): names,
roles, contrast of text. Axe comes with a package of PyPI."""
import subprocess
import sys
import tempfile
from pathlib import Path

root = Path(__file__).resolve().parent.parent.parent
sys.path.insert(0, str(root / "test"))
from chromium import WEBGL, Chromium  # noqa: E402

SIZES = [(360, 740), (768, 1024), (1440, 900)]
RULES = "{ runOnly: ['wcag2a', 'wcag2aa', 'wcag21a', 'wcag21aa'] }"


def axe():
    import axe_playwright_python  # its browser is not needed
    return (Path(axe_playwright_python.__file__).parent / "axe.min.js").read_text()


def violations(chromium):
    """Rule, severity and the elements that violate it; how many elements a rule could not judge."""
    found = chromium.run(f"axe.run({RULES}).then((r) => ({{passes: r.passes.length, open: r.incomplete.map((v) => [v.id, v.nodes.length]), "
                         "wrong: r.violations.map((v) => [v.id, v.impact, v.nodes.map((n) => n.html.slice(0, 120))])}))")
    return found["wrong"], found["passes"], found["open"]


def main(srbf):
    wrong = 0
    with tempfile.TemporaryDirectory() as folder:
        page = Path(folder) / "page.html"
        model = Path(folder) / "paper.srbf"
        measured = root / "data/paper_white_rgb.bsdf"
        subprocess.run([srbf, "fit", measured, "-o", model], check=True, capture_output=True)
        subprocess.run([srbf, "export", model, "--to", "html", "--reference", measured, "-o", page], check=True, capture_output=True)
        pages = [page] + [path for path in [root / "build/site/index.html", root / "build/site/gallery.html"] if path.exists()]
        source, chromium = axe(), Chromium(WEBGL)
        for path in pages:
            for width, height in SIZES:
                chromium.size(width, height, mobile=width < 700)
                chromium.open(path)
                chromium.run(source + "; true")
                found, passes, judged_by_eye = violations(chromium)
                print(f"{path.name} at {width} pixels: {passes} rules hold, {len(found)} are violated; not judged: {judged_by_eye}")
                for rule, impact, elements in found:
                    print("  FAILED:", rule, impact, *elements[:4], sep="\n    ")
                wrong += len(found)
        chromium.close()
    return wrong > 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
