"""Checks that the patches of paper/ apply to the sources."""
import subprocess

from support.checks import ROOT, expect, finish

for patch in sorted((ROOT / "paper").glob("*.patch")):
    done = subprocess.run(["git", "apply", "--check", str(patch)], cwd=ROOT, capture_output=True, text=True)
    expect(done.returncode == 0, f"{patch.name} applies {done.stderr.strip()}")
finish()
