"""Functions of the scripts of test/hosts: checks, each of which prints a line, and the scripts' arguments."""
import os
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
failures = []


def arguments():
    """The program, the folder of measurements, and further words: [PROGRAM [DATA [WORD..]]], and options anywhere."""
    words = [word for word in sys.argv[1:] if not word.startswith("--")]
    defaults = [ROOT / "build/release/srbf", os.environ.get("SRBF_DATA", ROOT.parent / "shared/data")]
    program, data = map(Path, words[:2] + defaults[len(words[:2]):])
    return program.resolve(), data.resolve(), words[2:]


def srbf(*words, **options):
    """What the program prints to standard output. An error ends the script."""
    return subprocess.run([arguments()[0], *map(str, words)], check=True, stdout=subprocess.PIPE, text=True, **options).stdout


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
