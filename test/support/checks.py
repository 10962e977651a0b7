"""Printed verdicts of a check of many things; `end` exits with 1 if one was bad."""
import sys

failures = []


def expect(holds, what):
    print("ok  " if holds else "BAD ", what, flush=True)
    if not holds:
        failures.append(what)


def end():
    sys.exit(bool(failures))
