"""The mechanism files and the printed results of the README."""

from __future__ import annotations

import re
from contextlib import redirect_stdout
from io import StringIO
from pathlib import Path

import pytest

import linkwork as lw
from scripts.docsite.commands_run import run_command

_README = (Path(__file__).resolve().parents[2] / "README.md").read_text(encoding="utf-8")


def _blocks(language: str) -> list[str]:
    return re.findall(rf"```{language}\n(.*?)```", _README, re.DOTALL)


def test_both_mechanism_files_of_the_readme_are_the_same_four_bar() -> None:
    drawn, written = (lw.loads(block).sweep(from_=0, to=360, step=30) for block in _blocks("toml"))
    assert drawn.certified.all()
    assert written.certified.all()
    assert drawn["rocker"] == pytest.approx(written["θ4"], abs=1e-9)


def test_the_first_result_is_what_the_commands_print(tmp_path: Path) -> None:
    commands = _blocks("sh")[0].partition(" && ")[2]
    done = run_command(commands, tmp_path)
    assert done.code == 0
    printed = done.output[done.output.index("Rapier drive") :].splitlines()
    shown = _blocks("text")[0].splitlines()
    # which row has the worst residual, and its last digit, is rounding
    rounding = [k for k, line in enumerate(shown) if line.startswith("  worst residual")]
    assert len(rounding) == 1
    del shown[rounding[0]], printed[rounding[0]]
    assert printed == shown


def test_the_ten_lines_print_what_is_shown(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    printed = StringIO()
    with redirect_stdout(printed):
        exec(_blocks("python")[0], {})
    pieces = _blocks("text")[1].split("…\n")
    assert len(pieces) == 3
    assert all(piece in printed.getvalue() for piece in pieces)
    assert (tmp_path / "rapier.html").stat().st_size > 10_000
