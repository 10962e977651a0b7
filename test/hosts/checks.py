"""Checks of the scripts of this folder, which print a line each. Importing it makes the modules of test/ and web/ importable, so it comes first."""
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path[1:1] = [str(ROOT / "test"), str(ROOT / "web")]
failures = []


def expect(condition, text, quiet=False):
    """Prints the text as "ok" or "FAILED", with `quiet` only if it failed."""
    if not condition:
        failures.append(text)
    if not condition or not quiet:
        print("ok     " if condition else "FAILED ", text, sep="", flush=True)


def skip(reason):
    """Ends the script without checks."""
    print("skipped:", reason)
    sys.exit(0)


def finish():
    """Ends the script. The exit status is 1 if a check failed."""
    sys.exit(bool(failures))
