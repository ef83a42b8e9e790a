"""``linkwork synthesize``: what it advises, and what its files say about positions."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner

import linkwork as lw
from linkwork.core.commands.main import linkwork
from linkwork.synthesis.solvers.solving import advice_of, remark_on, remarks_on

_POSES = """
[[positions]]
point = [0, 0]
angle = 0
[[positions]]
point = [60, 80]
angle = 20
[[positions]]
point = [180, 100]
angle = 60
[[positions]]
point = [260, 20]
angle = 90
"""
_TASK = f'format = 1\ntask = "motion"\nname = "Pick"\nmechanism = "four-bar"\n{_POSES}'
_GIVEN = (
    "[given]\nfixed_pivots = [[117.28833170811875, 53.69843215549852], "
    "[225.91762394635717, 195.3457297543642]]\n"
)
_FUNCTION = """
format = 1
task = "function"
name = "Square"
mechanism = "four-bar"
[function]
of = "x^2"
x = [0, 1]
input = [30, 120]
output = [60, 150]
"""


def _printed(text: str, folder: Path, *options: str, code: int = 0) -> str:
    path = folder / "task.toml"
    path.write_text(text)
    done = CliRunner().invoke(linkwork, ["synthesize", str(path), *options])
    assert done.exit_code == code, done.output
    return done.stdout


def test_a_design_says_at_which_inputs_it_passes_the_poses(tmp_path: Path) -> None:
    shown = _printed(_TASK + _GIVEN, tmp_path, "-o", str(tmp_path / "out"), "--draw", "--json")
    design = json.loads(shown)["designs"][0]
    mechanism = lw.load(design["file"])
    crank = design["inputs"]
    for value, point in zip(crank, ((0, 0), (60, 80), (180, 100), (260, 20)), strict=True):
        position = mechanism.solve(at=value)
        # given pivots are on the curve to 1e-9 of the poses' size
        assert (position["P.x"], position["P.y"]) == pytest.approx(point, abs=1e-6)
    listed = re.search(r" at crank = (.*) deg;", mechanism.description.purpose)
    assert listed is not None
    assert np.allclose([float(v) for v in listed[1].split(", ")], crank, rtol=1e-5)
    picture = Path(design["file"]).with_suffix(".svg").read_text()
    assert all(f">{number}<" in picture for number in (1, 2, 3, 4))


def test_doubtful_designs_are_counted_with_the_wish_that_refuses_them() -> None:
    poses = [(45, 81, 33), (-12, 93, 40.2), (-24, 40, 17.9), (35, 2, -6), (80, 27, 6.8)]
    found = lw.Task.motion(poses).solve()
    slight = sum(design.transmission < 30.0 for design in found.delivered)
    uneven = sum(design.size > 20.0 * design.shortest for design in found.delivered)
    assert slight > 0
    assert uneven > 0
    first, second = remarks_on(found)
    assert first.startswith(f"Delivered designs with a transmission angle below 30 deg: {slight}.")
    assert f"times the shortest: {uneven}." in second
    told = [remark_on(design) for design in found.designs]
    assert sum("below 30 deg: [wanted] transmission" in text for text in told) == slight
    assert sum("times the shortest: [wanted] lengths" in text for text in told) == uneven
    assert not any(remark_on(design) for design in found.refused)
    wanted = {"transmission": {"least": 30}, "lengths": {"ratio": 20}}
    strict = lw.Task.motion(poses, wanted=wanted).solve()
    assert remarks_on(strict) == ()
    assert strict.sound < found.sound


def test_if_no_wish_is_to_blame_changes_of_the_task_are_named(tmp_path: Path) -> None:
    same = _FUNCTION.replace("x^2", "x").replace("60, 150", "30, 120")
    shown = " ".join(_printed(same, tmp_path, code=1).split())
    assert "the task. Try to change the ranges of input and output." in shown
    poses = lw.Task.motion(
        [(0, 0, 90), (-400, 1100, 50), (-1300, 1500, 5)],
        mechanism="four-bar",
        wanted={"fixed_pivots": {"inside": [(-1500, 200), (-100, 200), (-100, 1400)]}},
    ).solve()
    assert poses.sound == 0
    told = advice_of(poses)
    for change in ('"slider-crank"', "enlarge the region", "a tolerance", "move a position"):
        assert change in told


_STARTS = {"x": (0, 1), "input": (30, 120), "output": (60, 150)}
_STEADY = [(0, 0), (30, 10), (60, 30), (90, 60)]
_HALTING = [(0, 0), (40, 20), (80, 30), (120, 35), (160, 80), (200, 90)]


@pytest.mark.parametrize(
    ("function", "tables", "kind", "told"),
    [
        ("x^2", _STARTS, "BRANCH", "With free start angles (input = 90 and output = 90) "),
        # a requirement is to blame
        (
            "sqrt(x)",
            {**_STARTS, "fit": "minimax", "wanted": {"transmission": {"least": 15}}},
            "TRANSMISSION", "With free start angles (input = 90 and output = 90) ",
        ),
        (
            "log10(x)",
            {**_STARTS, "x": (1, 2), "wanted": {"transmission": {"least": 60}}},
            "TRANSMISSION", 'With fit = "least squares" there is 1 design without defects.',
        ),
        # a pair is at a dead point
        (
            _STEADY, {"input": (30, 120), "output": (40, 100), "fit": "least squares"},
            "NOT_PROVED", "With free start angles (leave out input and output) there are ",
        ),
        (
            # behind it the loop is open, which rounding there may leave undecided
            _HALTING, {"fit": "least squares"},
            "CIRCUIT NOT_PROVED", 'With fit = "minimax" there is 1 design without defects.',
        ),
    ],
)  # fmt: skip
def test_what_helps_a_function_is_tried(
    function: Any, tables: dict[str, Any], kind: str, told: str
) -> None:
    found = lw.Task.function(function, mechanism="four-bar", **tables).solve()
    (defect,) = found.defects
    assert defect.name in kind.split()
    assert (found.most_restrictive is not None) == (kind == "TRANSMISSION")
    assert advice_of(found).startswith(told)


def test_if_a_wish_is_to_blame_it_is_named_instead(tmp_path: Path) -> None:
    text = _TASK + _GIVEN + "[wanted]\ntransmission = { least = 80 }\n"
    shown = _printed(text, tmp_path, code=1)
    assert (
        "The requirement that rejects the most designs is the least transmission angle"
        in " ".join(shown.split())
    )
    assert "No requirement alone is to blame" not in shown


def test_one_sound_design_has_no_defect(tmp_path: Path) -> None:
    shown = _printed(_TASK + _GIVEN, tmp_path)
    assert re.search(r"1 of \d designs has no defect\.", shown)


def test_an_exact_design_comes_before_tolerated_misses_unless_weighed_otherwise(
    tmp_path: Path,
) -> None:
    """Poses of the library's four-bar, measured with errors of up to 2.8 mm and 1.5°."""
    poses = [
        (83.38, 80.04, 25.64),
        (65.81, 96.55, 19.25),
        (13.62, 92.74, 23.74),
        (-10.86, 54.92, 48.51),
        (12.05, 43.68, 64.2),
    ]
    text = 'format = 1\ntask = "motion"\nname = "Measured"\nmechanism = "four-bar"\n'
    for x, y, angle in poses:
        text += f"[[positions]]\npoint = [{x}, {y}]\nangle = {angle}\n"
        text += "tolerance = 3\nangle_tolerance = 2\n"
    text += '[wanted]\ninput = "turns fully"\n[rank]\ndeliver = 1\n'
    weights = "by = { transmission = 1, size = 1, error = 1 }\n"
    own, even = (
        json.loads(_printed(text + ranked, tmp_path, "--json"))["designs"][0]
        for ranked in ("", weights)
    )
    assert own["error"] == 0.0
    assert even["error"] > 2.0
    assert even["transmission"] > own["transmission"]


def test_of_several_goals_the_miss_of_each_is_printed(tmp_path: Path) -> None:
    text = """
format = 1
task = "improve"
mechanism = "slider-crank"
[improve]
starts = 1
vary = ["O2 A"]
[[improve.goals]]
of = "stroke(d)"
target = 70
[[improve.goals]]
of = "max(d)"
target = 90
"""
    shown = _printed(text, tmp_path, "-o", str(tmp_path / "out"))
    assert "Design 1 misses its goals by" in shown
    misses = {name: float(v) for name, v in re.findall(r"^  (\w+\(d\)) +([\d.]+)$", shown, re.M)}
    d = lw.load(next((tmp_path / "out").glob("*-01.toml"))).sweep()["d"]
    # five digits are printed
    assert misses["stroke(d)"] == pytest.approx(abs(np.ptp(d) - 70.0), rel=1e-4)
    assert misses["max(d)"] == pytest.approx(abs(d.max() - 90.0), rel=1e-4)
    alone = "[[improve.goals]]".join(text.split("[[improve.goals]]")[:2])
    assert "misses its goals" not in _printed(alone, tmp_path)


def test_goals_without_values_are_named_instead_of_kinds(tmp_path: Path) -> None:
    text = 'format = 1\ntask = "improve"\nmechanism = "whitworth"\n[improve]\nstarts = 1\n'
    text += '[[improve.goals]]\nof = "time_ratio(ram)"\ntarget = 1.6\n'
    shown = " ".join(_printed(text, tmp_path, code=1).split())
    assert "No start leads to a design." in shown
    assert 'linkwork sweep whitworth --columns shows the values of "time_ratio(ram)".' in shown


def test_a_transmission_angle_is_refused_where_there_is_none(tmp_path: Path) -> None:
    """The six-bar driven at the far crank is one group of four links without dyads."""
    text = 'format = 1\ntask = "improve"\nmechanism = "stephenson-far-crank"\n[improve]\n'
    text += 'starts = 1\n[[improve.goals]]\nof = "stroke(rod)"\ntarget = 50\n'
    path = tmp_path / "task.toml"
    path.write_text(text + "[wanted]\ntransmission = { least = 25 }\n")
    done = CliRunner().invoke(linkwork, ["synthesize", str(path)])
    assert done.exit_code == 2
    told = " ".join(done.output.split())
    assert "line 10 wanted.transmission" in told
    assert "has no dyad of pins and no transmission angle: leave it out" in told


def test_a_dead_point_before_the_first_pose_is_outside_the_table_of_the_design(
    tmp_path: Path,
) -> None:
    _printed(_TASK + _GIVEN, tmp_path, "-o", str(tmp_path / "out"))
    design = str(next((tmp_path / "out").glob("*-01.toml")))
    shown = CliRunner().invoke(linkwork, ["sweep", design]).stdout
    # the table begins at 183.3°, and a turn less than 200.1° is -159.9°
    assert "dead point       crank = -159.869953123 deg, where" in shown
    assert "in line), outside the table" in " ".join(shown.split())
    changing = (
        CliRunner()
        .invoke(linkwork, ["sweep", "parallelogram", "--to", "180", "--from", "0"])
        .stdout
    )
    assert changing.count("  change point") == 2
    assert "outside the table" not in changing
