"""The patches of paper/ apply to the sources."""
import subprocess
import sys
from pathlib import Path

root = Path(__file__).resolve().parents[2]
failed = 0
for patch in sorted((root / "paper").glob("*.patch")):
    done = subprocess.run(["git", "apply", "--check", str(patch)], cwd=root, capture_output=True, text=True)
    print(f"{patch.name}: {'applies' if done.returncode == 0 else 'FAILED: ' + done.stderr.strip()}")
    failed |= done.returncode
sys.exit(bool(failed))
