"""Runs the code of README.md, of docs and of examples as a reader would, each page in a folder of its own.

```sh blocks are run by bash, in order; a ```text block is what the block before it prints, where `...` stands for anything; ```python
without a file's name runs in one session for the page; any other block is a file, whose name its first line says in a comment. A block that
is not run says why in the line above it: <!-- not run: ... -->. `data` and `examples` are the folders of the clone; READER_FILES makes the
files that a page takes as its reader's. A page that needs a package of PyPI that is not installed is named, and not run.
Usage: pages.py PROGRAM DATA [NAME..], of some pages.
"""
# needs: numpy1 mitsuba openexr
import importlib.util
import os
import re
import shutil
import subprocess
import sys
import tempfile
import textwrap
from pathlib import Path

from support.checks import ROOT, arguments, expect, finish

program, measurements, names = arguments()
documents = [ROOT / "README.md", ROOT / "examples/README.md", *sorted(ROOT.glob("docs/*.md")), *sorted(ROOT.glob("docs/tutorials/*.md"))]
NEEDS = {"mitsuba": ["mitsuba"], "blender": ["bpy"], "maps": ["OpenEXR"]}
NOT_CODE = {"math", ""}  # formulas, and diagrams
OWN_PATHS = {ROOT / name for name in ("test/hosts", "test", "web")}  # which no reader has


def srbf(folder, *arguments):
    subprocess.run([program, *arguments], cwd=folder, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def materials(folder):
    (folder / "materials").mkdir()
    for name, file in [("nickel", "paper_white_rgb"), ("film", "cc_ibiza_sunset_rgb")]:
        srbf(folder, "convert", f"data/{file}.bsdf", "-o", f"materials/{name}.binary")


def texels(folder):
    """Texels, each the paper times a colour of its own: six rows of 512, or a few."""
    import numpy as np

    pairs = np.loadtxt(folder / "data/paper_white_rgb.csv", delimiter=",", skiprows=1)[:256, :9]
    np.savetxt(folder / "pairs.csv", pairs[:, :6], delimiter=",", header="wl_x,wl_y,wl_z,wv_x,wv_y,wv_z", comments="")
    colours = np.random.default_rng(1).uniform(0.2, 1, [6 * 512, 1, 3])
    np.save(folder / "texels.npy", (colours * np.abs(pairs[None, :, 6:9])).astype(np.float32))


def masks(folder):
    """Three materials, and the fraction of each in a map of 16 x 8 texels."""
    import numpy as np

    for name, file in [("paper", "paper_white_rgb"), ("film", "cc_ibiza_sunset_rgb"), ("gold", "cc_ibiza_sunset_rgb")]:
        shutil.copy(ROOT / f"data/{file}.bsdf", folder / f"{name}.bsdf")
    np.save(folder / "masks.npy", np.random.default_rng(1).dirichlet([1, 1, 1], [8, 16]).astype(np.float32))


def goniometer_scan(folder):
    """Columns of a goniometer: scans in the plane of incidence over four decades."""
    rows = [f"{light} 180 {abs(view)} {0 if view >= 0 else 180} {2e-3 + 20 / (1 + (view - light) ** 2):.5g}"
            for light in (5, 20, 40, 60) for view in range(-80, 81, 2)]
    (folder / "scan.csv").write_text("\n".join(rows) + "\n", encoding="utf-8")


READER_FILES = {
    "materials/": materials, "texels.npy": texels, "masks.npy": masks, "scan.csv": goniometer_scan,
    "shade.xml": lambda folder: shutil.copy(measurements / "klems/2011-SA1.xml", folder / "shade.xml"),
    "sky.hdr": lambda folder: shutil.copy(ROOT / "data/studio.hdr", folder / "sky.hdr"),
    "paint.brdf": lambda folder: shutil.copy(measurements / "cornell/garnet_red.brdf", folder / "paint.brdf"),
}


def prepare(folder, page):
    """Makes the folder for a page, and returns the environment with paths to program, Python package and installed library."""
    for name in ("data", "examples"):
        (folder / name).symlink_to(ROOT / name)
    for name, make in READER_FILES.items():
        if name in page.read_text(encoding="utf-8") and page.parent.name != "tutorials":
            make(folder)
    environment = dict(os.environ, PATH=f"{program.parent}:{Path(sys.executable).parent}:{os.environ['PATH']}")
    environment["PYTHONPATH"] = os.pathsep.join([str(program.parent / "python"), *(p for p in sys.path if p and Path(p) not in OWN_PATHS)])
    environment["CMAKE_PREFIX_PATH"] = str(program.parent.parent / "hosts/prefix")
    if page.stem == "path_tracer" or page.parent.name == "examples":
        subprocess.run(["cmake", "--install", program.parent, "--prefix", environment["CMAKE_PREFIX_PATH"]], check=True,
                       stdout=subprocess.DEVNULL)
    return environment


def matches(expected, printed):
    parts = [re.escape(" ".join(part.split())) for part in expected.split("...")]
    return re.search(".*".join(parts), " ".join(printed.split())) is not None


def run(page):
    text = page.read_text(encoding="utf-8")
    blocks = re.findall(r"^(<!-- not run: [^\n]* -->\n+)? *```(\w*)\n(.*?)^ *```", text, flags=re.M | re.S)
    if 2 * len(blocks) != (fences := len(re.findall(r"^ *```", text, flags=re.M))):
        return f"{len(blocks)} blocks of code between {fences} fences"
    with tempfile.TemporaryDirectory() as work:
        folder, printed, session = Path(work), "", ""
        environment = prepare(folder, page)
        for reason, language, block in blocks:
            block = textwrap.dedent(block)
            name = re.match(r"(?://|#|<!--) ([\w.]+\.\w+)", block)
            if reason or language in NOT_CODE:
                continue
            if name:
                (folder / name[1]).write_text(block, encoding="utf-8")
            elif language == "text":
                if not matches(block, printed):
                    return f"expected\n{block}found\n{printed}"
            elif language in ("sh", "python"):
                session += block if language == "python" else ""
                command = ["bash", "-euo", "pipefail", "-c", block] if language == "sh" else [sys.executable, "-c", session]
                done = subprocess.run(command, cwd=folder, env=environment, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
                printed = done.stdout
                if done.returncode:
                    return f"{block}ended with {done.returncode}:\n{printed}"
            else:
                return f"{block}is neither run nor a file, and does not say why"
    return ""


for page in [page for page in documents if not names or page.stem in names]:
    missing = [package for package in NEEDS.get(page.stem, []) if importlib.util.find_spec(package) is None]
    if missing:
        print(f"skipped: {page.stem}, without {', '.join(missing)}")
    else:
        error = run(page)
        expect(not error, f"{page.stem} {error}")
finish()
