#!/usr/bin/env python3
"""Runs the pages of docs/tutorials as a reader would, each in a folder of its own.

```sh blocks are run by bash, in order; a ```text block is what the block before it prints, where `...` stands for anything; any other block
is a file, whose name its first line says in a comment. `data` is the folder of bundled measurements. A page that needs a package of PyPI
which this Python has not is named, and not run.
Arguments: the program, a folder that is not used, and names of pages; all pages without these.
"""
import importlib.util
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

root = Path(__file__).resolve().parents[2]
program = Path(sys.argv[1]).resolve()
pages = [root / "docs/tutorials" / (name + ".md") for name in sys.argv[3:]] or sorted((root / "docs/tutorials").glob("*.md"))
NEEDS = {"mitsuba": ["mitsuba"], "blender": ["bpy"]}


def prepare(folder, page):
    """Makes the folder that a page begins in, and returns the environment: the program, its package, and where the library is installed."""
    (folder / "data").symlink_to(root / "data")
    environment = dict(os.environ, PATH=f"{program.parent}:{Path(sys.executable).parent}:{os.environ['PATH']}")
    environment["PYTHONPATH"] = os.pathsep.join([str(program.parent / "python"), *(p for p in sys.path if p)])
    environment["CMAKE_PREFIX_PATH"] = str(program.parent.parent / "hosts/prefix")
    if page.stem == "path_tracer":
        subprocess.run(["cmake", "--install", program.parent, "--prefix", environment["CMAKE_PREFIX_PATH"]], check=True, stdout=subprocess.DEVNULL)
    return environment


def matches(expected, printed):
    words = lambda text: " ".join(text.split())
    return re.search(".*".join(map(re.escape, (words(part) for part in expected.split("...")))), words(printed)) is not None


def run(page):
    blocks = re.findall(r"^```(\w+)\n(.*?)^```", page.read_text(encoding="utf-8"), flags=re.M | re.S)
    with tempfile.TemporaryDirectory() as work:
        folder, printed = Path(work), ""
        environment = prepare(folder, page)
        for language, block in blocks:
            if language == "sh":
                done = subprocess.run(["bash", "-euo", "pipefail", "-c", block], cwd=folder, env=environment, text=True, stdout=subprocess.PIPE,
                                      stderr=subprocess.STDOUT)
                printed = done.stdout
                if done.returncode:
                    return f"{block}ended with {done.returncode}:\n{printed}"
            elif language == "text":
                if not matches(block, printed):
                    return f"expected\n{block}found\n{printed}"
            else:
                name = re.search(r"[\w.]+\.\w+", block.split("\n", 1)[0])
                (folder / name[0]).write_text(block, encoding="utf-8")
    return ""


failed = False
for page in pages:
    missing = [package for package in NEEDS.get(page.stem, []) if importlib.util.find_spec(package) is None]
    wrong = "" if missing else run(page)
    print(f"{page.stem}: " + (f"not run, without {', '.join(missing)}" if missing else wrong or "ok"), flush=True)
    failed |= bool(wrong)
sys.exit(failed)
