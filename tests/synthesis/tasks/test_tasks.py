"""Task files: every bad task is refused with its place and reason."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import jsonschema
import pytest

import linkwork as lw
from linkwork.core.textfile.keys import schema_of
from linkwork.core.textfile.toml_text import data_of
from linkwork.synthesis.defects import by_circuits
from linkwork.synthesis.tasks.task_file import read_task_text
from linkwork.synthesis.tasks.task_keys import TASK

_EXAMPLES = sorted((Path(__file__).parents[3] / "examples" / "tasks").glob("*.toml"))
_POSES = "".join(
    f"[[positions]]\npoint = [{x}, {y}]\nangle = {angle}\n"
    for x, y, angle in ((0, 0, 0), (40, -40, 10), (100, -80, 25), (170, -110, 45), (260, -140, 75))
)
_MOTION = f"format = 1\ntask = 'motion'\n{_POSES}"
_FUNCTION = "format = 1\ntask = 'function'\n[function]\n"


def _points(count: int, entry: str = "") -> str:
    rows = "".join(f"[[positions]]\npoint = [{k * k}, {k}]\n{entry}\n" for k in range(count))
    return "format = 1\ntask = 'path'\n" + rows.replace("\n\n", "\n")


@pytest.mark.parametrize("path", _EXAMPLES, ids=lambda path: path.stem)
def test_the_examples_have_sound_designs_and_fit_the_schema(path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    jsonschema.validate(data_of(text, "task"), schema_of(TASK))
    assert lw.Task.load(path).solve().delivered
    json.dumps(schema_of(TASK))


@pytest.mark.parametrize(
    ("text", "line", "key", "message"),
    [
        ("format = 1\ntask = 'motion'\n", None, "positions", "is missing"),
        (_MOTION.replace("[40, -40]", "[0, 0]").replace("angle = 10", "angle = 360"), 6,
         "positions[2]", "is the same as position 1: leave one out"),
        (_MOTION.split("[[positions]]\npoint = [40")[0], 3, "positions",
         "is only one: a task needs two or more"),
        (_MOTION.replace("angle = 25\n", ""), 9, "positions[3].angle",
         "is missing: a motion task is a list of poses"),
        (_MOTION.replace("'motion'", "'path'"), 5, "positions[1].angle", 'belongs to poses'),
        (_MOTION + "[[positions]]\npoint = [300, -150]\nangle = 90\n", 3, "positions",
         "6 exact poses leave no four-bar in general"),
        (_MOTION.replace("angle = 45\n", "angle = 45\ninput = 20\n"), 3, "positions[1].input",
         "is missing: time all positions or none"),
        (_points(4).replace("path", "motion").replace("point", "input = 5\nangle = 1\npoint"), 8,
         "positions[2].input", "has the input of position 1: move one of them"),
        (_points(4).replace("'path'", "'path'\nmechanism = 'slider-crank'"), 3, "mechanism",
         'solved for the "four-bar" only: with [improve] starts = 1000 other kinds are fitted'),
        (_MOTION + "[wanted]\nlengths = { least = 50, most = 20 }\n", 19, "wanted.lengths",
         "least = 50 and most = 20 contradict each other"),
        (_MOTION + "[rank]\ndeliver = 2000000\n", 19, "rank.deliver",
         "must be a whole number of at most 1000000, got 2000000"),
        (_MOTION + "[wanted]\nlengths = { least = -5 }\n", 19, "wanted.lengths.least",
         "must not be negative, got -5"),
        (_MOTION + "[wanted]\ntransmission = { least = 90 }\n", 19, "wanted.transmission.least",
         "must be at least 0 and below 90, got 90"),
        (_MOTION + "[wanted]\ninput = { from = 20, to = 20 }\n", 19, "wanted.input",
         "begins and ends at 20"),
        (_MOTION + "[wanted]\ninput = 'turns'\n", 19, "wanted.input", 'must be "turns fully" or'),
        (_MOTION + "[wanted]\nclear_of = [[100, -75, 20]]\n", 19, "wanted.clear_of[1]",
         "contains the point of position 3"),
        (_MOTION + "[wanted]\nfixed_pivots = { inside = [[0, 0], [1, 1], [2, 2]] }\n", 19,
         "wanted.fixed_pivots.inside", "encloses no area"),
        (_MOTION + "[wanted]\norder = 'none'\n", 19, "wanted.order", 'must be "as given" or "any"'),
        (_MOTION.replace("point = [0, 0]", "point = [0]"), 4, "positions[1].point",
         "needs two coordinates, got 1"),
        (_MOTION.replace("[40, -40]", "[40, -1e40]"), 7, "positions[2].point[2]",
         "-1e+40 is beyond ±1e12: choose a larger unit"),
        (_FUNCTION + "of = 'log10(x)'\n", None, "function.x", "is missing: a formula needs"),
        (_FUNCTION + "of = 'ln(x)'\nx = [-1, 1]\ninput = [0, 60]\noutput = [0, 60]\n", 4,
         "function.of", "ln(-1) is not a real number"),
        (_FUNCTION + "of = 'y^2'\nx = [0, 1]\ninput = [0, 60]\noutput = [0, 60]\n", 4,
         "function.of", "the variable is \"x\", got 'y'"),
        (_FUNCTION + "of = 'x*(1-x)'\nx = [0, 1]\ninput = [0, 60]\noutput = [0, 60]\n", 4,
         "function.of", "has the value 0 at both ends"),
        (_FUNCTION + "of = 'x'\nx = [0, 1]\ninput = [0, 60]\noutput = [0, 60]\npositions = 5\n", 8,
         "function.positions", "5 precision points leave no four-bar with given start angles"),
        (_FUNCTION + "of = 'x'\nx = [0, 1]\ninput = [0, 60]\noutput = [0, 60]\npositions = 5\n", 8,
         "function.positions", "free start angles meet 5: input = 60 is a range that begins"),
        (_FUNCTION + "pairs = [[0, 0], [10, 5], [10, 9]]\n", 4, "function.pairs[3]",
         "has the input 10 of pair 2"),
        (_FUNCTION + "pairs = [[0, 0], [10, 5]]\n", 4, "function.pairs", "needs at least three"),
        (_MOTION + "[given]\nfixed_pivots = [[0, 0]]\n", 18, "given",
         "leaves no freedom for 5 poses"),
        (_MOTION.replace("'motion'", "'mixed'").replace("angle = 25\n", "angle_tolerance = 1\n"),
         11, "positions[3].angle_tolerance", "has no effect on points"),
        (_MOTION.replace("'motion'", "'mixed'"), 2, "task",
         'has poses only: write task = "motion"'),
        (_points(7).replace("path", "mixed").replace("point", "angle = 1\npoint", 2)
         + "[given]\nfixed_pivots = [[0, 9]]\n", None, "positions",
         "and fixed pivots are 9 conditions, but a four-bar meets at most 8"),
        (_FUNCTION.replace("[function]", "mechanism = ['slider-crank', 'four-bar']\n[function]")
         + "pairs = [[0, 0], [10, 5], [20, 9]]\n", 3, "mechanism", "of a function is one kind"),
        (_points(10, "tolerance = 0.5") + "[[positions]]\npoint = [99, 0]\n", 33,
         "positions[11].tolerance", "is missing: points that are met by least squares all have"),
        (_points(4) + "[given]\nlengths = { 'A0 C' = 4 }\n", 12, 'given.lengths."A0 C"',
         'is no length: these are "A0 A", "A B", "B0 B", "A0 B0", "A P", "B P"'),
        (_points(10) + "[given]\nlengths = { 'A P' = 4 }\n", 24, 'given.lengths."A P"',
         'is no length of a fit: these are "A0 A", "A B", "B0 B"'),
        (_points(4) + "[given]\nlengths = { 'A0 A' = -4 }\n", 12, 'given.lengths."A0 A"',
         "must be positive, got -4"),
        (_points(4) + "[given]\nlengths = { 'A0 A' = 4 }\n[wanted]\nlengths = { most = 3 }\n", 12,
         'given.lengths."A0 A"', "4 is out of the bounds of [wanted]"),
        (_points(4) + "[given]\nfixed_pivots = [[0, 9], [5, 9]]\nlengths = { 'A0 B0' = 5 }\n", 13,
         'given.lengths."A0 B0"', "is fixed by the given pivots"),
        (_points(3) + "[given]\nlengths = { 'A B' = 4, 'A P' = 9, 'B P' = 4.9 }\n", 10,
         "given.lengths", "A B, A P and B P are no triangle: leave one out"),
        (_points(3) + "[given]\nlengths = { 'A B' = 4, 'A P' = 9, 'B P' = 5 }\n", 10,
         "given.lengths", "put P on the line of A and B, where all solutions are double: change"),
        (_MOTION + "[given]\nlengths = { 'A0 A' = 4 }\n", 19, "given.lengths",
         "belongs to points: leave it out"),
        (_FUNCTION + "of = 'x^2'\nx = [0, 1]\ninput = [0, 60]\noutput = [0, 60]\n"
         "fit = 'minimax'\nspacing = 'even'\n", 9, "function.spacing", "has no effect on a fit"),
        (_FUNCTION + "pairs = [[0, 0], [10, 5], [20, 9]]\nx = [0, 1]\n", 5, "function.x",
         "has no effect on pairs"),
        (_MOTION + "[rank]\nby = { size = -1, error = 1 }\n", 19, "rank.by.size",
         "must not be negative, got -1"),
        (_MOTION + "[rank]\nby = { size = 0 }\n", 19, "rank.by", "has no weight above 0"),
        ("format = 1\ntask = 'path'\n[curve]\nfile = 'no.csv'\n", 4, "curve.file",
         '"no.csv": there is no such file'),
        (_MOTION + "[curve]\nfile = 'foot.csv'\n", 18, "curve",
         'has no effect on task = "motion"'),
        (_FUNCTION + "pairs = [[0, 0], [10, 5], [20, 9]]\n[given]\nfixed_pivots = [[0, 0]]\n", 6,
         "given.fixed_pivots", "must be two pivots on a level line"),
    ],
)  # fmt: skip
def test_a_bad_task_is_refused_with_its_place(
    text: str, line: int | None, key: str, message: str
) -> None:
    with pytest.raises(lw.MechanismFileError) as caught:
        read_task_text(text, "task.toml")
    problems = caught.value.problems
    from linkwork.core.foundation.errors import key_text

    found = [p for p in problems if key_text(p.key) == key]
    assert found, [(key_text(p.key), p.message) for p in problems]
    assert message in found[0].message
    if line is not None:
        assert found[0].line == line


def test_tasks_of_python_are_those_of_files() -> None:
    poses = [(0, 0, 0), (40, -40, 10), (100, -80, 25), (170, -110, 45), (260, -140, 75)]
    made = lw.Task.motion(poses, wanted={"transmission": {"least": 30}})
    again = read_task_text(made.described.text)
    assert again.positions == made.described.positions
    assert again.wanted == made.described.wanted
    with pytest.raises(lw.MechanismError, match="is not a key of"):
        lw.Task.motion(poses, wanted={"transmision": {"least": 30}})
    for wrong, told in (
        ([(0, 0), *poses], r"positions\[1\].angle  is missing: a motion task is a list of poses"),
        ([(0, 0, 0, 1), *poses], r"positions\[1\].point"),
    ):
        with pytest.raises(lw.MechanismError, match=told):
            lw.Task.motion(wrong)
    with pytest.raises(lw.MechanismError, match=r"positions\[2\].angle  belongs to poses"):
        lw.Task.path([(0, 0), (1, 1, 5)])
    with pytest.raises(lw.InputError, match=r'^"function" is made of the other arguments: give'):
        lw.Task.function("x^2", x=(0, 1), input=(30, 120), output=(60, 150), function={})


def test_a_task_of_points_and_poses_is_that_of_its_file() -> None:
    rows = [(0, 0), (40, -40, 10), (100, -80), (170, -110, 45)]
    task = lw.Task.mixed(rows, given={"fixed_pivots": [(0, 90)]}).described
    assert task.kind == "mixed"
    assert [(*p.point, p.angle) for p in task.positions] == [
        (*row[:2], row[2] if len(row) == 3 else None) for row in rows
    ]
    with pytest.raises(lw.MechanismError, match=r"positions\[1\].point  needs two coordinates"):
        lw.Task.mixed([(0,), *rows])


def test_a_range_of_more_than_a_turn_is_refused_of_cranks_alone() -> None:
    wanted = {"input": {"from": 20, "to": 500}}
    told = 'wanted.input  spans 480, more than a turn of 360: write input = "turns fully"'
    points, poses = [(0, 0), (1, 1), (3, 0)], [(0, 0, 0), (40, -40, 10), (100, -80, 25)]
    with pytest.raises(lw.MechanismError, match=told):
        lw.Task.path(points, wanted=wanted)
    with pytest.raises(lw.MechanismError, match=told):
        lw.Task.motion(poses, mechanism="four-bar", wanted=wanted)
    lw.Task.motion(poses, wanted=wanted)
    lw.Task.improve("four-bar", wanted=wanted)
    lw.Task.path(points, wanted={"input": {"from": 20, "to": 380}})


def test_parallel_poses_and_poses_about_one_point_are_refused() -> None:
    translated = [(0, 0, 5), (40, -40, 5), (100, -80, 5), (170, -110, 5), (260, -140, 5)]
    with pytest.raises(lw.MechanismError, match="two guides"):
        lw.Task.motion(translated).solve()
    with pytest.raises(lw.MechanismError, match="two guides"):
        lw.Task.motion(translated[:4]).solve()
    with pytest.raises(lw.MechanismError, match="have one angle and lie on a line"):
        lw.Task.motion([(0, 0, 5), (40, -40, 5), (80, -80, 5)]).solve()
    three = lw.Task.motion(translated[:2] + translated[3:4]).solve()
    assert three.designs
    assert {kind.name for design in three.designs for kind in design.kinds} == {"NOT_PROVED"}
    turned = [(1, 2, angle) for angle in (0, 10, 30, 50, 90)]
    with pytest.raises(lw.MechanismError, match=r"a rotation about \[1, 2\]"):
        lw.Task.motion(turned).solve()
    for place in ((1, 2), (1e6 + 0.1, 0.3), (0.1, -0.7)):
        with pytest.raises(lw.MechanismError, match=r"a rotation about \["):
            lw.Task.motion([(*place, angle) for angle in (0, 10, 30)]).solve()
    rolled = [(0, 0, 0), (1, 0, 90), (1, 1, 180), (0, 1, 270)]
    with pytest.raises(lw.MechanismError, match=r"a rotation about \[0.5, 0.5\]"):
        lw.Task.motion(rolled).solve()


def test_designs_with_a_link_of_no_length_are_refused_without_warnings(
    recwarn: pytest.WarningsRecorder,
) -> None:
    task = lw.Task.loads("""format = 1
task = "mixed"
mechanism = "four-bar"
given = { fixed_pivots = [[0, 0], [400, 0]] }
positions = [
  { point = [0, 0] }, { point = [0.1, -40] }, { point = [100, -80] },
  { point = [170, -110], angle = 45 },
]
""")
    first = task.solve().designs[0]
    assert repr(first) == "<SynthesizedDesign 1: four-bar driven at A0, not proved>"
    assert not recwarn.list


def test_a_mechanism_of_any_kind_is_judged_by_its_circuits() -> None:
    bar = lw.example("four-bar")
    there = [bar.solve(at=angle).points["B"] for angle in (0, 90, 180)]
    crossed = bar.solve(at=180, configuration="crossed").points["B"]
    assert lw.Task.path(there).defects_of(bar, (0, 90, 180), point="B") == ()
    (defect,) = lw.Task.path([*there[:2], crossed]).defects_of(bar, (0, 90, 180), point="B")
    assert (defect.kind.name, defect.between) == ("CIRCUIT", (2, 3))
    # a point off the path is judged by the nearest branch
    near = [(x + 1e-3, y) for x, y in there]
    assert lw.Task.path(near).defects_of(bar, (0, 90, 180), point="B") == ()
    with pytest.raises(lw.InputError, match="3 positions need as many inputs, got 2"):
        lw.Task.path(there).defects_of(bar, (0, 90), point="B")


def test_a_mechanism_that_passes_its_positions_is_judged_without_its_circuits(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    legs = lw.example("klann-leg")
    point = legs.description.trace[0]
    inputs = (10.4, 41.2, 222.2)
    places = [legs.solve(at=angle).points[point] for angle in inputs]
    monkeypatch.setattr(by_circuits, "FollowedCircuit", lambda *_: pytest.fail("not needed"))
    assert lw.Task.path(places).defects_of(legs, inputs, point=point) == ()


def test_wishes_that_some_design_has_are_not_refused() -> None:
    """Sliders have no ground, fits may miss points."""
    square: dict[str, Any] = {"x": (0, 1), "input": (30, 120), "output": (10, 20)}
    square["given"] = {"fixed_pivots": [(0, 0), (100, 0)]}
    square["wanted"] = {"lengths": {"most": 90}}
    assert lw.Task.function("x^2", mechanism="slider-crank", **square).solve().delivered
    points = [(10 * i, i * i % 7) for i in range(12)]
    lw.Task.path(points, improve={"starts": 40}, wanted={"clear_of": [[0, 0.02, 0.03]]})
    poses = [(0, 0, 0), (40, -40, 10), (100, -80, 25)]
    bow = [[0, -50], [50, 0], [50, -50], [0, 0]]
    crosses = r"crosses itself between corners 1, 2 and 3, 4: list them around the region"
    with pytest.raises(lw.MechanismError, match=crosses):
        lw.Task.motion(poses, wanted={"fixed_pivots": {"inside": bow}})
    around = [[0, 0], [0, -50], [50, -50], [20, -20], [50, 0]]
    lw.Task.motion(poses, wanted={"fixed_pivots": {"inside": around}})
    # the fourth corner is on the first side
    touching = [[-7, 2.6], [1, 10.6], [-15, 26.6], [-4.6, 5.0], [-23, 18.6]]
    lw.Task.motion(poses, wanted={"fixed_pivots": {"inside": touching}})
    # rounding of a pivot at the origin is no size
    lw.Task.motion(poses, given={"fixed_pivots": [[6e-17, 0]]})
    with pytest.raises(lw.MechanismError, match="encloses no area"):
        lw.Task.motion(poses, wanted={"fixed_pivots": {"inside": [[0, 0], [1, 1], [3, 3]]}})


def test_given_numbers_that_no_design_has_are_refused() -> None:
    points: list[tuple[float, float]] = [(0, 0), (1, 1), (4, 2), (9, 3)]
    with pytest.raises(lw.MechanismError, match="is the same place as the first"):
        lw.Task.path(points, given={"fixed_pivots": [(1, 1), (1, 1)]}, improve={"starts": 40})
