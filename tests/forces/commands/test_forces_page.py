"""The page of ``linkwork forces``."""

from __future__ import annotations

import json
import math
from pathlib import Path

import linkwork as lw
from linkwork import example_text
from tests.core.commands.conftest import Run


def test_forces_at_one_position_fit_into_a_terminal(run: Run) -> None:
    done = run("forces", "balanced-lamp", "--at", "20")
    assert done.exit_code == 0
    assert max(map(len, done.stdout.splitlines())) <= 80
    assert "  A.load   -56.3816   79.4788   97.4462  125.35  A\n" in done.stdout
    assert "check  virtual work and free bodies agree" in done.stdout


def test_forces_of_a_structure_have_a_position_and_no_plot(run: Run, tmp_path: Path) -> None:
    truss = tmp_path / "truss.toml"
    truss.write_text(
        "format = 1\n[points]\nA = [0, 0]\nB = [10, 0]\nC = [5, 5]\n[links]\n"
        'ground = ["A", "B"]\nl = ["A", "C"]\nr = ["B", "C"]\n'
        '[[loads]]\npoint = "C"\nforce = [0, -10]\n',
        encoding="utf-8",
    )
    done = run("forces", str(truss), "--draw", str(tmp_path / "f.svg"))
    assert done.exit_code == 0
    assert "  C.load    0        -10.0000   10.0000   -90.00  C\n" in done.stdout
    refused = run("forces", str(truss), "--plot", str(tmp_path / "p.svg"))
    assert refused.exit_code == 2
    assert 'Error: "mechanism" has no input, so that --plot has no motion to show' in refused.stderr


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


def test_forces_say_when_a_law_leaves_the_reach(run: Run, tmp_path: Path) -> None:
    """A crank of a double rocker cannot turn on at 36 degrees, 1.8 s after it starts."""
    rocker = lw.linkage(
        points={"A": (0, 0), "B": (40, 0), "C": (70, 40), "D": (100, 0)},
        lengths={"A B": 60, "B C": 40, "C D": 30, "A D": 100},
        links={"ground": ["A", "D"], "crank": ["A", "B"], "rod": ["B", "C"], "rocker": ["C", "D"]},
        masses={"rod": lw.Mass(mass=1, shape="rod")},
        inputs=lw.Input(link="crank", law="20*t", from_=0, to=5, step=0.5),
    )
    rocker.save(tmp_path / "m.toml")
    done = run("forces", str(tmp_path / "m.toml"))
    assert done.exit_code == 1
    # 60² + 100² - 2 60 100 cos(crank) = 70²
    when = math.degrees(math.acos((60**2 + 100**2 - 70**2) / (2 * 60 * 100))) / 20
    assert f"t = {when:.6f}"[:10] in done.stdout
    assert "dead point" in done.stdout


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
