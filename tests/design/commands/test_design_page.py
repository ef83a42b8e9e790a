"""The page of ``linkwork design``, and that of forces with friction."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

import linkwork as lw
from tests.core.commands.conftest import FOUR_BAR, Run

TRAMMEL = """format = 1
name = "Wedge"
[points]
O = [0, 0]
X = [1, 0]
Y = [0, 1]
P = [60, 0]
Q = [0, 80]
[links]
ground = ["O", "X", "Y"]
rod = ["P", "Q"]
first = ["P"]
second = ["Q"]
[[sliders]]
name = "x"
link = "first"
points = ["P"]
on = "ground"
line = ["O", "X"]
[[sliders]]
name = "y"
link = "second"
points = ["Q"]
on = "ground"
line = ["O", "Y"]
[[loads]]
point = "Q"
link = "second"
force = [0, -10]
[input]
slider = "x"
from = 99
to = 60
step = -13
[friction]
x = { mu = 0.4 }
y = { mu = 0.4 }
"""


def test_answers_of_a_designer_fit_into_a_terminal(run: Run) -> None:
    asked = ["--flywheel", "0.05", "--motor", "900000", "1500 rpm", "--harmonics", "shaking.y"]
    done = run("design", "crank-press", *asked)
    assert done.exit_code == 0
    assert max(map(len, done.stdout.splitlines())) <= 80
    assert "The motor is too weak" in done.stdout
    assert "inertia  4.29842e+07 kg·mm²" in done.stdout
    data = json.loads(run("design", "crank-press", *asked, "--json").stdout)
    assert data["motor"]["fits"] is False
    assert len(data["harmonics"]["amplitude"]) == 8


def test_a_balanced_four_bar_is_written(run: Run, tmp_path: Path) -> None:
    file, balanced = tmp_path / "bar.toml", tmp_path / "balanced.toml"
    file.write_text(f'{FOUR_BAR}\n[masses]\ncoupler = {{ mass = 2, shape = "rod" }}\n')
    text = file.read_text().replace('name = "Four-bar"', 'name = "Four-bar"\nlength = "mm"')
    file.write_text(text)
    done = run("design", str(file), "--counterweights", "20", "--save", str(balanced))
    assert done.exit_code == 0
    assert f"Wrote {balanced}" in done.stdout
    after, before = (float(lw.load(own).forces(at=30)["shaking.x"]) for own in (balanced, file))
    assert abs(after) < 1e-9 * abs(before)


@pytest.mark.parametrize(
    ("asked", "message"),
    [
        ((), "no option is set"),
        (("--rated", "5"), "--rated belongs to --motor"),
        (("--save", "x.toml"), "--save writes the mechanism with its --counterweights"),
        (("--motor", "twelve", "9 rpm"), "--motor needs a number for its torque"),
    ],
)
def test_questions_that_do_not_fit_are_refused(
    run: Run, asked: tuple[str, ...], message: str
) -> None:
    done = run("design", "crank-press", *asked)
    assert done.exit_code == 2
    assert message in " ".join(done.stderr.split())


def test_the_stall_of_a_wedge_is_printed_with_its_proof(run: Run, tmp_path: Path) -> None:
    file = tmp_path / "wedge.toml"
    file.write_text(TRAMMEL)
    done = run("forces", str(file))
    assert done.exit_code == 0
    assert max(map(len, done.stdout.splitlines())) <= 80
    assert "stalls  at x = 92.847669" in done.stdout
    assert "proved: moves at" in " ".join(done.stdout.split())
    locked = run("forces", str(file), "--at", "95")
    assert "friction locks the mechanism" in locked.stdout
    assert "proved  yes" in locked.stdout
