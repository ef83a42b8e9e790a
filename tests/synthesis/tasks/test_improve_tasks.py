"""Tasks that improve a mechanism of any kind: their files, wishes, designs and refusals."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import linkwork as lw
from linkwork.core.foundation.errors import MechanismFileError
from linkwork.core.mechanism.linkage import Linkage
from linkwork.synthesis.commands import synthesis_lines
from linkwork.synthesis.defects.verdicts import JudgedDesign
from linkwork.synthesis.designs_folder import FolderOptions, write_designs
from linkwork.synthesis.loops.limits import Drive
from linkwork.synthesis.solvers import improvement as improvement_synthesis
from linkwork.synthesis.solvers.result import relative_misses
from linkwork.synthesis.solvers.solving import advice_of, remarks_on, wishes_of
from linkwork.synthesis.solvers.swept_design import SweptDesign

_HEAD = 'format = 1\ntask = "improve"\nmechanism = "four-bar"\n'
_HERE = '[improve]\npoint = "{}"\n[[positions]]\npoint = [1, 2]\n[[positions]]\npoint = [{}, {}]\n'
_GOAL = '[[improve.goals]]\nof = "rocker"\nat = [0, 90, 180]\nvalues = [60, 80, 100]\n'


def test_a_file_improves_a_mechanism_beside_it_along_a_curve(tmp_path: Path) -> None:
    (tmp_path / "bar.toml").write_text(lw.example_text("four-bar"))
    wanted = lw.example("four-bar").with_dimensions({"A B": 124.0})
    rows = [(*wanted.solve(at=a).points["B"], a) for a in (0.0, 60.0, 120.0, 200.0, 290.0)]
    (tmp_path / "curve.csv").write_text("".join(f"{x!r},{y!r},{a!r}\n" for x, y, a in rows))
    task = _HEAD.replace("four-bar", "bar.toml")
    task += '[curve]\nfile = "curve.csv"\ntiming = "as given"\n'
    task += '[improve]\npoint = "B"\nvary = ["A B"]\nstarts = 2\n'
    (tmp_path / "task.toml").write_text(task)
    found = lw.Task.load(tmp_path / "task.toml").solve()
    (best,) = found.delivered
    assert best.numbers["A B"] == pytest.approx(124.0, abs=1e-9)
    assert best.error < 1e-9
    files = found.save(tmp_path / "designs")
    assert lw.load(files[0]).sweep().certified.all()
    assert isinstance(best.linkage, Linkage)
    assert best.linkage.lengths["A B"] == best.numbers["A B"]
    data = found.to_dict()["designs"][0]
    assert (data["drive"], data["delivered"], data["defects"]) == ("crank", True, [])


def test_a_wished_transmission_angle_holds_and_costs_exactness() -> None:
    goals = [{"of": "rocker", "at": [0, 90, 180], "values": [60, 80, 100]}]
    given = {"goals": goals, "vary": ["A B", "O4 B"], "starts": 1}
    free = lw.Task.improve("four-bar", **given).solve()
    wished = lw.Task.improve("four-bar", **given, wanted={"transmission": {"least": 30}}).solve()
    assert free.delivered[0].transmission < 29.9
    assert wished.delivered[0].transmission >= 30.0
    assert wished.delivered[0].error > free.delivered[0].error
    assert wished.message.endswith("; transmission proved on the whole motion")
    assert "proved" not in free.message
    data = [found.to_dict()["designs"][0] for found in (free, wished)]
    assert [own["proved_in_motion"] for own in data] == [[], ["transmission"]]
    assert [own["tested_in_rows"] for own in data] == [[], []]


def _moved_crank(tmp_path: Path, step: int, **wanted: object) -> JudgedDesign:
    """A slider-crank in coarse rows of which only the place is improved."""
    text = lw.example_text("slider-crank").replace("step = 1\n", f"step = {step}\n")
    (tmp_path / "crank.toml").write_text(text)
    goal = {"of": "A.x", "at": [0], "values": [lw.example("slider-crank").solve(at=0)["A.x"]]}
    task = lw.Task.improve(
        tmp_path / "crank.toml", goals=[goal], vary=["O2.x"], starts=1, wanted=wanted
    )
    (design,) = task.solve().designs
    return design


def test_what_breaks_a_wish_between_two_rows_is_found(tmp_path: Path) -> None:
    """The transmission angle is 60° at 90°, and 60.4° at least in rows 40° apart."""
    design = _moved_crank(tmp_path, 40, transmission={"least": 60.2})
    assert isinstance(design, SweptDesign)
    motion = design.improved.motion
    assert motion is not None
    rows = motion["B.transmission"]
    assert np.minimum(rows, 180.0 - rows).min() > 60.2
    (defect,) = design.defects
    assert defect.kind.name == "TRANSMISSION"
    assert re.fullmatch(
        r"transmission angle down to 60\S*° at crank = .*°, wanted 60.2°", defect.message
    )
    assert not _moved_crank(tmp_path, 40, transmission={"least": 59.9}).defects
    # a thin obstacle on the way of the crank's end, and one that it passes
    end = complex(*lw.example("slider-crank").solve(at=60).points["A"])
    (defect,) = _moved_crank(tmp_path, 40, clear_of=[[end.real, end.imag, 0.1]]).defects
    assert defect.kind.name == "OBSTACLE"
    assert re.fullmatch('"(crank|rod)" meets an obstacle at crank = .*°', defect.message)
    top = lw.example("slider-crank").solve(at=90).points["A"][1]
    clear = _moved_crank(tmp_path, 40, clear_of=[[0, top + 0.11, 0.1]])
    assert not clear.defects
    assert clear.to_dict()["proved_in_motion"] == ["clear_of"]


def test_wishes_of_a_mechanism_driven_in_time_are_tested_in_rows(tmp_path: Path) -> None:
    """Inputs between the rows of a law are not known."""
    text = lw.example_text("slider-crank").replace("to   = 360\nstep = 1\n", "to = 2\nstep = 0.1\n")
    (tmp_path / "crank.toml").write_text(
        text.replace('link = "crank"\n', 'link = "crank"\nlaw = "9 * t"\n')
    )
    found = lw.Task.improve(
        tmp_path / "crank.toml", goals=[{"of": "max(d)", "most": 170}], vary=["O2 A"], starts=1,
        wanted={"transmission": {"least": 5}, "clear_of": [[0, 500, 3]]},
    ).solve()  # fmt: skip
    words = (
        "transmission and clear_of tested in the rows of the table, all else on the whole motion"
    )
    assert found.message.endswith(f"; {words}")
    assert found.designs[0].to_dict()["tested_in_rows"] == ["transmission", "clear_of"]


def test_designs_that_break_wishes_are_refused_and_the_most_restrictive_is_named() -> None:
    goals = [{"of": "rocker", "at": [0, 90, 180], "values": [60, 80, 100]}]
    found = lw.Task.improve(
        "four-bar", goals=goals, vary=["A B", "O4 B"], starts=1, wanted={"clear_of": [[60, 60, 9]]}
    ).solve()
    assert not found.delivered
    assert [kind.name for kind in found.defects] == ["OBSTACLE"]
    assert found.most_restrictive == ("clear_of", 1)


def test_a_wished_range_is_the_table_of_the_designs() -> None:
    task = lw.Task.improve(
        "four-bar",
        goals=[{"of": "rocker", "at": [30, 90], "values": [60, 80]}],
        vary=["A B"],
        starts=1,
        wanted={"input": {"from": 20, "to": 140}},
    )
    design = task.solve().designs[0]
    assert np.array(lw.Mechanism(design.linkage).sweep().inputs["crank"])[[0, -1]] == (
        pytest.approx([20.0, 140.0])
    )


@pytest.mark.parametrize(
    ("mechanism", "point", "rows"),
    [("whitworth", "A", 361), ("pendulum", "A", 73), ("double-pendulum", "B", 37)],
)
def test_turning_fully_is_wished_of_mechanisms_of_all_kinds(
    mechanism: str, point: str, rows: int
) -> None:
    """Without pins of two links, without loops, and with inputs that move in lock-step."""
    goal = {"of": f"max({point}.x)", "least": -1e6}
    task = lw.Task.improve(mechanism, goals=[goal], starts=1, wanted={"input": "turns fully"})
    (design,) = task.solve().delivered
    motion = lw.Mechanism(design.linkage).sweep(certify=False)
    lead = next(iter(motion.inputs.values()))
    assert len(motion) == rows
    assert abs(lead[-1] - lead[0]) == pytest.approx(360.0)
    assert np.isnan(design.transmission)


def test_ranges_of_several_inputs_have_as_many_rows_as_the_mechanism(tmp_path: Path) -> None:
    text = "".join(
        line
        for line in lw.example_text("double-pendulum").splitlines(keepends=True)
        if not line.startswith(("from", "to ", "step"))
    )
    (tmp_path / "free.toml").write_text(text)
    goal = {"of": "max(B.x)", "least": -1e6}
    wanted = {"input": {"from": 0, "to": 90}}
    task = lw.Task.improve(tmp_path / "free.toml", goals=[goal], starts=1, wanted=wanted)
    (design,) = task.solve().delivered
    motion = lw.Mechanism(design.linkage).sweep(certify=False)
    lead = next(iter(motion.inputs.values()))
    assert len(lead) == 361
    assert lead[[0, -1]] == pytest.approx([0.0, 90.0])


def test_an_input_that_does_not_turn_fully_is_a_defect() -> None:
    goal = {"of": "max(P.x)", "least": -1e6}
    task = lw.Task.improve("evans", goals=[goal], starts=1, wanted={"input": "turns fully"})
    (design,) = task.solve().designs
    assert design.defects[0].message.startswith("the input does not turn fully: ")


@pytest.mark.parametrize(
    ("text", "line", "message"),
    [
        (_HEAD + '[improve]\nvary = ["A B", "A X"]\n' + _GOAL, 5, '"A X" is not a number'),
        (_HEAD + '[improve]\nvary = ["A B"]\n' + _GOAL.replace("rock", "rokc"), 7, "rocker"),
        (_HEAD + '[improve.bounds]\n"A X" = [1, 2]\n', 5, '"A X" is not a number'),
        (_HEAD.replace("four-bar", "fuor-bar") + "[improve]\n" + _GOAL, 3, "four-bar"),
        (
            _HEAD + "[improve]\n" + _GOAL.replace("values", "least = 4\nmost = 3\n#"),
            8, "contradict",
        ),
        (
            _HEAD + "[improve]\n" + _GOAL.replace("90", "0"),
            8, r"is another value than 60 at 0: leave one out",
        ),
        (_HEAD + _HERE.format("C", 3, 4), 5, 'no point "C"'),
        (_HEAD + _HERE.format("B", 1, 2), 8, "same as position 1"),
        (
            _HEAD + '[improve]\npoint = "B"\nvary = ["A B"]\n[[positions]]\npoint = [1, 2]\n'
            "[[positions]]\npoint = [90, 500]\n",
            10, "is 508.035 from O2, out of reach: B comes at most 180 away",
        ),
        (_HEAD + "[improve]\nfront = 9\n" + _GOAL, 5, "between two goals or more, and 1 is given"),
        (
            _HEAD + "[improve]\nfront = 9\n" + _GOAL + _GOAL + "weight = 3\n",
            14, "has no effect on a front",
        ),
        (_HEAD + "[improve]\nfront = 9\n" + _GOAL + "[rank]\ndeliver = 2\n", 10, "as a whole"),
        (
            _HEAD + '[improve.bounds]\n"A B" = [200, 300]\n[wanted.lengths]\nmost = 150\n' + _GOAL,
            5, "excludes",
        ),
        (
            _HEAD + '[improve]\nvary = ["A B", "O4.x"]\n' + _GOAL,
            5, r'give lengths."O2 O4": .* \(numbers that can vary: O2 A, A B, O4 B\)',
        ),
        (
            _HEAD + "[improve]\nstarts = 2\n[[positions]]\npoint = [1, 2]\n[[positions]]\n"
            "point = [3, 4]\n",
            4, r"traces no point; name .* \(points: O2, O4, A, B\)",
        ),
    ],
)  # fmt: skip
def test_a_wrong_task_is_refused_with_its_line(
    tmp_path: Path, text: str, line: int, message: str
) -> None:
    (tmp_path / "task.toml").write_text(text)
    with pytest.raises(MechanismFileError, match=message) as caught:
        lw.Task.load(tmp_path / "task.toml").solve()
    assert line in [problem.line for problem in caught.value.problems]


def test_a_front_is_delivered_in_its_order_and_drawn(tmp_path: Path) -> None:
    crank = lw.example_text("slider-crank").replace("step = 1\n", "step = 30\n")
    (tmp_path / "crank.toml").write_text(crank)
    goals = [{"of": "stroke(d)", "target": 70}, {"of": "max(d)", "target": 60}]
    task = lw.Task.improve(
        tmp_path / "crank.toml", goals=goals, vary=["O2 A"], front=3, starts=1,
        wanted={"lengths": {"least": 15}},
    )  # fmt: skip
    found = task.solve()
    improved = [design for design in found.delivered if isinstance(design, SweptDesign)]
    misses = [(design.goals["stroke(d)"], design.goals["max(d)"]) for design in improved]
    assert [design.number for design in found.delivered] == [1, 2, 3]
    assert misses == sorted(misses)
    assert [b for _, b in misses] == sorted((b for _, b in misses), reverse=True)
    # the wish holds for every design, and ends the front
    assert found.delivered[-1].numbers["O2 A"] == pytest.approx(15.0, abs=1e-6)
    assert found.to_dict()["designs"][0]["goals"] == improved[0].goals
    assert list(found.table()["miss of max(d)"]) == [b for _, b in misses]
    lines = synthesis_lines(found)
    assert any("goal 1: the miss of stroke(d)" in line for line in lines)
    assert max(map(len, lines)) <= 80
    write_designs(found, tmp_path / "designs", FolderOptions(draw=True, html=True))
    picture = (tmp_path / "designs" / "front.svg").read_text()
    stations = picture.partition('id="station"')[2].partition("</g>\n   </g>")[0]
    assert stations.count("<use ") == 3
    assert "<!-- miss of max(d) -->" in picture
    page = (tmp_path / "designs" / "index.html").read_text()
    assert 'id="trade-off"' in page
    assert "miss of stroke(d)" in page


def test_points_are_passed_within_the_driven_range() -> None:
    """Without bounds of the inputs the best design passes the last point at 147 degrees."""
    mechanism, given = lw.example("four-bar"), {"point": "B", "vary": ["O2 A", "O4 B"]}
    places = [mechanism.solve(at=float(a)).points["B"] for a in np.linspace(100.0, 170.0, 4)]
    positions = [{"point": [1.02 * x, 1.01 * y]} for x, y in places]
    for order in ("as given", "any"):
        wanted = {"input": {"from": 60.0, "to": 130.0}, "order": order}
        found = lw.Task.improve(
            "four-bar", positions=positions, starts=1, wanted=wanted, **given
        ).solve()
        assert found.delivered[0].error < 1.0
        for design in found.delivered:
            assert min(design.inputs) >= 60.0
            assert max(design.inputs) <= 130.0
    # a page improves what it has at hand towards any inputs, and says what is wrong with them
    timed = [{**own, "input": at} for own, at in zip(positions, range(70, 140, 20), strict=True)]
    wanted = {"input": {"from": 60.0, "to": 125.0}}
    task = lw.Task.improve("four-bar", positions=timed, starts=1, wanted=wanted, **given).described
    description = improvement_synthesis.mechanism_of(task)
    wishes = wishes_of(task, Drive.A0)
    designs = improvement_synthesis.improve_description(description, task, wishes, None)[0]
    message = designs[0].defects[0].message
    assert message == "position 4 is passed at 130, outside the driven range from 60 to 125"


@pytest.mark.parametrize(
    ("table", "key"),
    [
        (_HERE.format("B", 3, 4).replace("= [1, 2]", "= [1, 2]\ninput = 40") + "input = 420\n",
         "positions[1].input"),
        ("[improve]\n" + _GOAL.replace("[0, 90, 180]", "[90, 201, 420]"), "improve.goals[1].at[2]"),
    ],
)  # fmt: skip
def test_inputs_outside_the_driven_range_are_refused_before_solving(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, table: str, key: str
) -> None:
    def solved(*_: object, **__: object) -> None:
        raise AssertionError("solved")

    monkeypatch.setattr(improvement_synthesis, "improved_designs", solved)
    wanted = "[wanted]\ninput = { from = 60, to = 200 }\n"
    (tmp_path / "task.toml").write_text(_HEAD + wanted + table)
    with pytest.raises(MechanismFileError) as caught:
        lw.Task.load(tmp_path / "task.toml").solve()
    told = "is outside the driven range from 60 to 200: move it, or widen [wanted] input"
    assert re.fullmatch(
        rf"1 problem in .*\n  line \d+  {re.escape(key)}  {re.escape(told)}", str(caught.value)
    )


@pytest.mark.parametrize(("target", "least"), [(170, 50), (170, 60), (300, 60)])
def test_a_transmission_angle_that_binds_is_held(target: float, least: float) -> None:
    text = "format = 1\ntask = 'improve'\nmechanism = 'slider-crank'\n"
    text += f"[wanted]\ntransmission = {{ least = {least} }}\n[improve]\nvary = ['O2 A']\n"
    text += f"starts = 2\n[[improve.goals]]\nof = 'stroke(d)'\ntarget = {target}\n"
    (best, *_) = lw.Task.loads(text).solve().delivered
    assert least <= best.transmission < least + 0.02


def test_problems_of_the_mechanism_are_those_of_its_own_file(tmp_path: Path) -> None:
    (tmp_path / "bar.toml").write_text(lw.example_text("four-bar").replace('"crank"', '"crnk"'))
    (tmp_path / "task.toml").write_text(_HEAD.replace("four-bar", "bar.toml") + _GOAL)
    with pytest.raises(MechanismFileError) as caught:
        lw.Task.load(tmp_path / "task.toml").solve()
    assert caught.value.where == str(tmp_path / "bar.toml")


def test_a_driven_range_that_no_wish_names_costs_no_designs() -> None:
    """The rocker turns so far, but no crank within these bounds does."""
    goal = {"of": "rocker", "at": [60, 80, 100], "values": [80, 90, 105]}
    task: dict[str, Any] = {"goals": [goal], "vary": ["O2 A"], "bounds": {"O2 A": [90, 110]}}
    found = lw.Task.improve("four-bar", starts=3, **task).solve()
    assert [kind.name for kind in found.defects] == ["RANGE"]
    assert found.most_restrictive is None
    assert advice_of(found) == (
        "The driven range is the table of four-bar. Try more starts, wider bounds, targets nearer "
        "to its present values, or a part of the range: [wanted] input = { from = …, to = … }."
    )
    task["wanted"] = {"input": "turns fully"}
    wished = lw.Task.improve("four-bar", starts=3, **task).solve()
    assert wished.most_restrictive == ("the driven range", 1)


def test_goals_that_are_missing_are_named_by_their_key() -> None:
    with pytest.raises(lw.MechanismError, match=r"improve.goals  are missing: add a goal"):
        lw.Task.improve("four-bar").solve()


def test_scores_of_goals_do_not_depend_on_the_unit_of_length(tmp_path: Path) -> None:
    scores = []
    for size in (1.0, 1024.0):
        text = f"""format = 1
            points.A0 = [0, 0]
            points.A = [{20 * size}, {34.6 * size}]
            points.B = [{127 * size}, {-20 * size}]
            points.S = [0, {-20 * size}]
            points.T = [{160 * size}, {-20 * size}]
            links.ground = ["A0", "S", "T"]
            links.crank = ["A0", "A"]
            links.rod = ["A", "B"]
            links.block = ["B"]
            lengths = {{ "A0 A" = {40 * size}, "A B" = {120 * size} }}
            input = {{ link = "crank", from = 0, to = 360, step = 5 }}
            [[sliders]]
            name = "d"
            link = "block"
            points = ["B"]
            on = "ground"
            line = ["S", "T"]
        """
        (tmp_path / "crank.toml").write_text(text)
        goals = [{"of": "stroke(d)", "target": 70 * size}, {"of": "max(d)", "target": 400 * size}]
        task = lw.Task.improve(tmp_path / "crank.toml", goals=goals, vary=["A0 A"], starts=3)
        scores.append([design.score for design in task.solve().designs])
    assert scores[1] == pytest.approx(scores[0], rel=1e-6)
    assert 0.1 < min(scores[0]) < 0.9


def test_misses_of_goals_of_different_units_count_by_what_is_wanted() -> None:
    """A ratio that is missed by a fifth is worse than a stroke that is missed by a hundredth."""
    goals = [{"of": "stroke(d)", "target": 80}, {"of": "time_ratio(d)", "target": 1.3}]
    task = lw.Task.improve(
        "slider-crank", goals=goals, vary=["O2 A", "O2.y"], starts=3, bounds={"O2.y": (-45, 45)},
        spread=0.5, rank={"by": {"error": 1}},
    )  # fmt: skip
    found = task.solve()
    assert found.designs
    for design in found.designs:
        stroke, ratio = design.goals.values()
        assert relative_misses(design) == {"stroke(d)": stroke / 80, "time_ratio(d)": ratio / 1.3}
        assert design.score == pytest.approx(1.0 / (1.0 + max(stroke / 80, ratio / 1.3)))


def test_a_goal_that_no_design_meets_is_named() -> None:
    bounds = {"O2 A": [20, 60]}
    task = lw.Task.improve(
        "slider-crank", goals=[{"of": "stroke(d)", "target": 5000}], vary=["O2 A"], starts=1,
        bounds=bounds,
    )  # fmt: skip
    (told,) = [text for text in remarks_on(task.solve()) if "misses" in text]
    assert told.startswith("Every delivered design misses stroke(d) by 4")
    met = lw.Task.improve(
        "slider-crank", goals=[{"of": "stroke(d)", "target": 75}], vary=["O2 A"], starts=1
    )
    assert not [text for text in remarks_on(met.solve()) if "misses" in text]
    goals = [{"of": "stroke(d)", "target": 5000}, {"of": "max(d)", "target": 60}]
    front = lw.Task.improve(
        "slider-crank", goals=goals, vary=["O2 A"], starts=1, front=2, bounds=bounds
    ).solve()
    assert front.delivered
    assert not [text for text in remarks_on(front) if "misses" in text]


def test_bounds_that_are_kept_miss_nothing() -> None:
    goals = [{"of": "stroke(d)", "least": 60}]
    by_error = {"by": {"error": 1}}
    task = lw.Task.improve("slider-crank", goals=goals, vary=["O2 A"], starts=1, rank=by_error)
    (design,) = task.solve().delivered
    assert design.score == 1.0


@pytest.mark.parametrize(
    ("bound", "told"),
    [
        ({"of": "max(d)", "most": 100}, r"goal max\(d\) comes up to 128\.\d+, wanted at most 100"),
        ({"of": "d", "least": 300}, r"goal d comes down to 1?\d\d\.\d+, wanted at least 300"),
    ],
)
def test_a_broken_bound_of_a_goal_refuses_a_design(bound: dict[str, Any], told: str) -> None:
    goals = [{"of": "stroke(d)", "target": 70}, bound]
    for front in ({}, {"front": 2}):
        more = [{"of": "mean(d)", "target": 100}] if front else []
        task = lw.Task.improve("slider-crank", goals=goals + more, vary=["O2 A"], starts=2, **front)
        found = task.solve()
        assert not found.delivered
        (defect,) = found.designs[0].defects
        assert defect.kind is lw.synthesis.DefectKind.BOUND
        assert re.fullmatch(told, defect.message)
    design = lw.synthesis.improve(lw.example("slider-crank"), goals, vary=["O2 A"], starts=2)[0]
    assert not design.sound
    assert re.search(told, design.message)


def test_a_bound_that_binds_is_kept() -> None:
    goals = [{"of": "stroke(d)", "target": 70}, {"of": "stroke(d)", "most": 60}]
    (design,) = (
        lw.Task.improve("slider-crank", goals=goals, vary=["O2 A"], starts=2).solve().designs
    )
    assert design.defects == ()
    stroke = lw.Mechanism(design.linkage).sweep().value("stroke(d)")
    assert stroke == pytest.approx(60, abs=1e-4)


def test_a_task_has_the_units_of_the_mechanism_it_improves(tmp_path: Path) -> None:
    text = lw.example_text("four-bar").replace('"mm"', '"in"').replace('"deg"', '"rad"')
    text = re.sub(r"step += +\d+", "step = 0.02", re.sub(r"to += +360", "to = 6.28", text))
    (tmp_path / "bar.toml").write_text(text)
    task = _HEAD.replace("four-bar", "bar.toml") + "[improve]\nstarts = 2\n[[improve.goals]]\n"
    task += 'of = "stroke(rocker)"\ntarget = 1.0\n'
    (tmp_path / "task.toml").write_text(task)
    found = lw.Task.load(tmp_path / "task.toml").solve()
    assert (found.task.length, found.task.angle.value) == ("in", "rad")
    assert found.delivered
    assert 0 < found.delivered[0].transmission < 1.571
    for key, unit, own in (("length", "mm", "in"), ("angle", "deg", "rad")):
        wrong = task.replace("[improve]", f'{key} = "{unit}"\n[improve]', 1)
        (tmp_path / "task.toml").write_text(wrong)
        with pytest.raises(MechanismFileError, match=f"write all numbers in {own}") as caught:
            lw.Task.load(tmp_path / "task.toml")
        assert [problem.line for problem in caught.value.problems] == [4]
    # what is wrong with the mechanism is told of its own file
    (tmp_path / "task.toml").write_text(task)
    for wrong in (text.replace('"rad"', '"grad"'), "x = ["):
        (tmp_path / "bar.toml").write_text(wrong)
        with pytest.raises(MechanismFileError, match=r"in .*bar\.toml"):
            lw.Task.load(tmp_path / "task.toml").solve()
    absent = task.replace("bar.toml", "none.toml").replace(
        "[improve]", 'length = "in"\n[improve]', 1
    )
    (tmp_path / "task.toml").write_text(absent)
    with pytest.raises(MechanismFileError, match="is no file in the folder of the task"):
        lw.Task.load(tmp_path / "task.toml").solve()
