"""The leaderboard of paper/leaderboard.py."""
import os
import subprocess
import sys
from pathlib import Path

import srbf

ROOT = Path(__file__).resolve().parent.parent.parent


def run(*arguments):
    environment = {**os.environ, "PYTHONPATH": str(Path(srbf.__file__).parent.parent)}
    command = [sys.executable, ROOT / "paper/leaderboard.py", *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, env=environment, check=False)


def test_results_repeat_and_merge(tmp_path):
    """Fits of one file have the same results, other files are skipped, and two leaderboards become one."""
    paper, second = ROOT / "data/paper_white_rgb.bsdf", tmp_path / "second"
    second.mkdir()
    (second / paper.name).write_bytes(paper.read_bytes())
    (second / "notes.txt").write_text("no measurement")
    for out, path in (("a", paper), ("c", second)):
        said = run(path, "--models", "ggx", "-o", tmp_path / out)
        assert said.returncode == 0, said.stderr
    assert "left out" in said.stderr and "notes.txt" in said.stderr
    results = [(tmp_path / out / "results.csv").read_bytes() for out in "ac"]
    assert results[0].splitlines()[1].removeprefix(b"data,") == results[1].splitlines()[1].removeprefix(b"second,")
    assert run("--merge", tmp_path / "a", tmp_path / "c", "-o", tmp_path / "both").returncode == 0
    assert (tmp_path / "both/results.csv").read_bytes() == results[0] + results[1].splitlines(keepends=True)[1]
    page = (tmp_path / "both/README.md").read_text(encoding="utf-8")
    assert "Lambert, 1 GGX" in page and "## data" in page and "## second" in page
    assert "seconds" not in page  # which differ from run to run
    # Rows that exist are not fitted again.
    assert "1/1" not in run(paper, "--models", "ggx", "-o", tmp_path / "a").stderr


def test_errors_are_one_line(tmp_path):
    for arguments in ([tmp_path / "nothing"], ["--merge", tmp_path]):
        said = run(*arguments, "-o", tmp_path / "out")
        assert said.returncode == 1 and len(said.stderr.splitlines()) == 1, said.stderr
