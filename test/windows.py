"""windows.py BUILD [ARGUMENT..]: tests the build for Windows under Wine: golden, with these arguments, and the program's
handling of files. If this system's program is built, both must write the same bytes."""
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT, BUILD = Path(__file__).resolve().parents[1], Path(sys.argv[1]).resolve()
PROGRAM, NATIVE = BUILD / "srbf.exe", [path for path in [ROOT / "build" / "release" / "srbf"] if path.exists()]
DATA = ROOT / "data"
WINE = [next(path for path in ("/usr/lib/wine/wine64", "/usr/bin/wine64", "/usr/bin/wine") if Path(path).exists())]
os.environ.update(WINEDEBUG="-all", WINEPREFIX=str(BUILD / "wine"), LC_ALL="C.UTF-8")


def run(*arguments, program=WINE + [PROGRAM]):
    return subprocess.run([*program, *arguments], capture_output=True, timeout=3600)


def expect(holds, what):
    print(("ok: " if holds else "FAILS: ") + what, flush=True)
    if not holds:
        sys.exit(1)


def same_as_native(folder, ending, *arguments):
    """The bytes that the command writes. They must equal those of the native program."""
    out = folder / f"aus gabe λ.{ending}"
    result = run(*arguments, "-o", out.name)
    expect(result.returncode == 0 and out.exists(), f"{' '.join(arguments)}: {result.stderr.decode()[:300]}")
    written = out.read_bytes()
    out.unlink()
    for native in NATIVE:
        expect(run(*arguments, "-o", out.name, program=[native]).returncode == 0 and out.read_bytes() == written,
               f"{arguments[0]}: the bytes of the native program")
    return written


def killed_writes(folder):
    """A program that is killed while it writes a table leaves the old or the new one."""
    table, old = folder / "table.binary", b"old"
    whole = None
    for delay in [None, *(i / 10 for i in range(3, 28))]:
        table.write_bytes(old)
        process = subprocess.Popen([*WINE, PROGRAM, "convert", "papier weiß λ.bsdf", "-o", table.name],
                                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        if delay:
            time.sleep(delay)
            process.kill()
        process.wait()
        whole = whole or table.read_bytes()
        expect(table.read_bytes() in (old, whole), "a write" + (f" that is killed after {delay} s" if delay else ""))
    expect(len(whole) > 1 << 20, "a table of some size was written")


def main():
    golden = [*WINE, BUILD / "test" / "golden.exe", "data", "test/golden.csv", *sys.argv[2:]]
    expect(subprocess.run(golden, cwd=ROOT).returncode == 0, "the fits of test/golden.csv have the same bytes")
    with tempfile.TemporaryDirectory(prefix="srbf Größe ") as name:
        folder = Path(name)
        os.chdir(folder)
        (folder / "papier weiß λ.bsdf").write_bytes((DATA / "paper_white_rgb.bsdf").read_bytes())
        model = same_as_native(folder, "srbf", "fit", "papier weiß λ.bsdf", "--lobes", "4", "--model", "pm")
        (folder / "modell 光.srbf").write_bytes(model)
        for language in ("c", "glsl"):
            same_as_native(folder, language, "export", "modell 光.srbf", "--to", language)
        same_as_native(folder, "bsdf", "convert", "modell 光.srbf")
        for command in (["info", "papier weiß λ.bsdf"], ["info", "modell 光.srbf"],
                        ["eval", "modell 光.srbf", "--pairs", str(DATA / "paper_white_rgb.csv")],
                        ["compare", "papier weiß λ.bsdf", "modell 光.srbf"]):
            text = run(*command)
            expect(text.returncode == 0 and text.stdout, " ".join(command[:2]) + ": " + text.stderr.decode()[:300])
            for native in NATIVE:
                expect(run(*command, program=[native]).stdout == text.stdout, f"{command[0]}: the native program's text")
        missing = run("info", "fehlt ß.bsdf")
        expect(missing.returncode == 1 and "fehlt ß.bsdf" in missing.stderr.decode(), "a file that is missing is an error")
        killed_writes(folder)


main()
