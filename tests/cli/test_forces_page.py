"""The page of ``linkwork forces``."""

from __future__ import annotations

import json
from pathlib import Path

import linkwork as lw
from linkwork.api import example_text
from tests.cli.conftest import Run


def test_forces_at_one_position_fit_into_a_terminal(run: Run) -> None:
    done = run("forces", "balanced-lamp", "--at", "20")
    assert done.exit_code == 0
    assert max(map(len, done.stdout.splitlines())) <= 80
    assert "  A.load   -56.3816   79.4788   97.4462  125.35  A\n" in done.stdout
    assert "check  virtual work and free bodies agree" in done.stdout


def test_forces_of_a_motion_are_written_and_plotted(run: Run, tmp_path: Path) -> None:
    table, plot = tmp_path / "f.csv", tmp_path / "f.svg"
    done = run("forces", "crank-press", "--csv", str(table), "--plot", str(plot))
    assert done.exit_code == 0
    page, _, _ = done.stdout.partition("Wrote")
    assert max(map(len, page.splitlines())) <= 80
    header, first, *_ = table.read_text(encoding="utf-8").splitlines()
    assert header.startswith("crank,O.force.x,")
    assert first.startswith("90,")
    assert plot.stat().st_size > 0


def test_forces_are_drawn_as_arrows(run: Run, tmp_path: Path) -> None:
    picture = tmp_path / "f.svg"
    done = run("forces", "crank-press", "--at", "240", "--draw", str(picture))
    assert done.exit_code == 0
    assert picture.stat().st_size > 0


def test_forces_as_json_name_what_is_undetermined(run: Run, tmp_path: Path) -> None:
    file = tmp_path / "cranks.toml"
    link = next(name for name in lw.example("parallel-cranks").model.equations.links)
    load = f'\n[[loads]]\nlink = "{link}"\ntorque = 5\n'
    file.write_text(example_text("parallel-cranks") + load, encoding="utf-8")
    data = json.loads(run("forces", str(file), "--at", "70", "--json").stdout)
    assert data["status"] == "UNDETERMINED"
    assert "A1.force.x" in data["undetermined"]


def test_a_wrong_load_is_reported_with_its_line(run: Run, tmp_path: Path) -> None:
    file = tmp_path / "lamp.toml"
    text = example_text("balanced-lamp")
    file.write_text(text.replace('point = "P"', 'point = "Q"'), encoding="utf-8")
    done = run("forces", str(file))
    line = text.splitlines().index('point = "P"') + 1
    assert done.exit_code == 2
    assert f"line {line}" in done.stderr
    assert 'point "Q" is not defined' in done.stderr


def test_a_mechanism_without_loads_says_what_to_add(run: Run) -> None:
    done = run("forces", "four-bar")
    assert done.exit_code == 2
    assert "add [masses], [[loads]]" in done.stderr
