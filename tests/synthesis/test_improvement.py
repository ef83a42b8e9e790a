"""Improved numbers of mechanisms: gradients in lanes, goals, bounds, refusals."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import linkwork as lw
from linkwork.core.foundation.errors import InputError, MechanismError
from linkwork.core.mechanism.varied_numbers import number_named
from linkwork.core.results.motion import branch_end
from linkwork.synthesis.improvement import improving
from linkwork.synthesis.improvement.fit_problem import Fitting, fit_numbers
from linkwork.synthesis.improvement.lanes import DesignWriter, SolvedLanes
from linkwork.synthesis.improvement.settings import Goal
from linkwork.synthesis.lane_least_squares import Box


def test_gradients_of_lanes_are_those_of_the_single_mechanism() -> None:
    bar = lw.example("four-bar")
    names = ("O2 A", "A B", "O4 B")
    numbers = [number_named(bar.description, name) for name in names]
    x = np.array([q.of(bar.description) for q in numbers])
    position = bar.solve(at=50.0)
    writer = DesignWriter(bar.model, numbers)
    lanes = SolvedLanes(writer, x, position.q[None], np.radians([50.0]), 2)
    found = lanes.at(writer.written(np.array([x, x])), np.arange(2))
    slopes = found.values([found.rows.place("B").v.real])[1][:, 0, 0]
    expected = [lw.design.gradient(bar, "B.x", by=names, at=50.0)[name] for name in names]
    # both solve the same linear equations: a few roundings
    assert slopes == pytest.approx(np.array([expected, expected]), rel=1e-11)


def test_a_stroke_is_met_to_rounding_and_all_rows_are_proved() -> None:
    crank = lw.example("slider-crank")
    goal = {"of": "stroke(d)", "target": 70.0}
    best = lw.synthesis.improve(crank, goal, vary=["O2 A"], starts=2)[0]
    assert best.sound
    assert lw.Mechanism(best.description).sweep().value("stroke(d)") == pytest.approx(
        70.0, abs=1e-9
    )


def test_a_coordinate_of_zero_varies_by_itself() -> None:
    """With both lengths and the stroke 90 known, the offset of an inline crank follows."""
    best = lw.synthesis.improve(
        lw.example("slider-crank"), {"of": "stroke(d)", "target": 90.0}, vary=["O2.y"], starts=2
    )[0]
    offset = 20.0 + best.numbers["O2.y"]
    stroke = np.sqrt(160.0**2 - offset**2) - np.sqrt(80.0**2 - offset**2)
    # the table has rows of one degree
    assert stroke == pytest.approx(90.0, abs=0.05)
    assert best.total < 1e-12


def test_timed_points_of_a_changed_mechanism_give_its_lengths_back() -> None:
    bar = lw.example("four-bar")
    wanted = bar.with_dimensions({"O2 A": 38.0, "A B": 124.0})
    inputs = [0.0, 60.0, 120.0, 200.0, 290.0]
    points = [wanted.solve(at=a).points["B"] for a in inputs]
    best = lw.synthesis.improve(bar, {"point": "B", "points": points, "inputs": inputs}, starts=2)[
        0
    ]
    assert best.rms < 1e-9
    bounded = lw.synthesis.improve(
        bar,
        {"point": "B", "points": points, "inputs": inputs},
        starts=2,
        bounds={"A B": (100, 122)},
    )[0]
    assert bounded.numbers["A B"] <= 122.0
    assert bounded.rms > best.rms


def test_a_mechanism_that_cannot_reach_all_points_yet_is_improved_until_it_does() -> None:
    """The crank of the start does not turn fully: a third of its positions do not exist."""
    points = {"A0": (0, 0), "A": (20, 5), "B": (80, 60), "B0": (100, 0), "P": (60, 70)}
    lengths = {"A0 A": 25, "A B": 80, "B0 B": 60, "A P": 60, "B P": 30}
    bar = lw.linkage(
        points=points, lengths=lengths, trace=["P"],
        links={"ground": ["A0", "B0"], "crank": ["A0", "A"], "coupler": ["A", "B", "P"],
               "rocker": ["B0", "B"]},
        inputs=lw.Input(link="crank", from_=0, to=350, step=10),
    )  # fmt: skip
    motion = bar.sweep()
    path = motion.trace("P")
    goal = {
        "point": "P",
        "points": np.stack([path.real, path.imag], axis=1),
        "inputs": motion.inputs["crank"],
    }
    start = bar.with_dimensions({"A0 A": 60})
    assert not start.sweep(certify=False).found.all()
    best = lw.synthesis.improve(start, goal, vary=list(lengths), starts=1)[0]
    assert best.numbers == pytest.approx(lengths, abs=1e-9)
    assert best.sound
    assert repr(best) == f"<ImprovedDesign: total {best.total:.4g}, all rows are proved>"


def test_starts_that_cannot_be_built_are_left_out() -> None:
    """With a shorter side the coupler is no triangle any more."""
    points = {"A0": (0, 0), "A": (20, 5), "B": (80, 60), "B0": (100, 0), "P": (60, 70)}
    bar = lw.linkage(
        points=points, lengths={"A0 A": 25, "A B": 80, "B0 B": 60, "A P": 60, "B P": 30},
        links={"ground": ["A0", "B0"], "crank": ["A0", "A"], "coupler": ["A", "B", "P"],
               "rocker": ["B0", "B"]},
        inputs=lw.Input(link="crank", from_=0, to=350, step=10),
    )  # fmt: skip
    motion = bar.with_dimensions({"A P": 62.0}).sweep()
    path = motion.trace("P")
    goal = {
        "point": "P",
        "points": np.stack([path.real, path.imag], axis=1),
        "inputs": motion.inputs["crank"],
    }
    found = lw.synthesis.improve(bar, goal, vary=["A P", "B P"], starts=12, spread=0.6)
    assert found[0].numbers == pytest.approx({"A P": 62.0, "B P": 30.0}, abs=1e-9)
    assert all(design.motion is not None for design in found)


def test_a_mechanism_without_unknowns_is_improved() -> None:
    best = lw.synthesis.improve(
        lw.example("pendulum"), {"of": "max(A.x)", "target": 0.5}, vary=["O A"]
    )[0]
    assert best.numbers["O A"] == pytest.approx(0.5)


def test_goals_without_a_meaning_are_refused() -> None:
    bar = lw.example("four-bar")
    with pytest.raises(MechanismError, match="has no target"):
        lw.synthesis.improve(bar, {"of": "rocker"})
    with pytest.raises(MechanismError, match="contradict each other"):
        lw.synthesis.improve(bar, {"of": "rocker", "least": 3.0, "most": 2.0})
    with pytest.raises(MechanismError, match="need as many inputs"):
        lw.synthesis.improve(bar, {"point": "B", "points": [(1, 2), (3, 4)], "inputs": [1]})
    with pytest.raises(MechanismError, match="same as point 1"):
        lw.synthesis.improve(bar, {"point": "B", "points": [(1, 2), (1, 2)]})
    with pytest.raises(InputError, match="got 'least squares'; how misses count is fit ="):
        lw.synthesis.improve(bar, "least squares")  # type: ignore[arg-type]  # as a caller without types may
    with pytest.raises(MechanismError, match=r"is no key of a goal \(keys: target"):
        lw.synthesis.improve(bar, {"of": "rocker", "taget": 1.0})
    with pytest.raises(InputError, match="mixes numbers of the motion"):
        lw.synthesis.improve(bar, {"of": "stroke(rocker) - rocker", "target": 1.0})
    slot = lw.example("curved-slot")
    with pytest.raises(InputError, match=r'a fit cannot vary "O4\.x" of'):
        lw.synthesis.improve(
            slot, {"of": "max(A.y)", "least": 0.0}, vary=["O4.x", "O2 A"], starts=1
        )
    assert lw.synthesis.improve(slot, {"of": "max(A.y)", "least": 0.0}, vary=["O2 A"], starts=1)


@pytest.mark.parametrize(
    ("name", "of", "varied", "left_out"),
    [
        ("chebyshev", "stroke(P.x)", "A P", ""),
        ("garage-door", "stroke(M.y)", "L M", "G.x"),
        ("curved-slot", "stroke(A.y)", "O2 A", "O4.x"),
    ],
)
def test_numbers_that_a_fit_cannot_follow_do_not_vary_by_default(
    name: str, of: str, varied: str, left_out: str
) -> None:
    mechanism = lw.example(name)
    target = 1.01 * mechanism.sweep().value(of)
    best = lw.synthesis.improve(mechanism, {"of": of, "target": target}, starts=2)[0]
    assert best.sound
    assert best.total < 1e-9 * target**2
    assert varied in best.numbers
    assert left_out not in best.numbers
    if left_out:
        with pytest.raises(InputError, match=f'a fit cannot vary "{left_out}"'):
            lw.synthesis.improve(mechanism, {"of": of, "target": target}, vary=[left_out])


def test_a_mechanism_that_no_other_number_fits_is_not_improved() -> None:
    with pytest.raises(InputError, match="has no number that can vary alone"):
        lw.synthesis.improve(lw.example("parallel-cranks"), {"of": "stroke(A1.x)", "target": 1.0})


def test_starts_spread_numbers_that_are_zero_by_the_size_of_the_mechanism(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    found: list[np.ndarray] = []

    def caught(_given: object, starts: np.ndarray, **_: object) -> None:
        found.append(starts)
        raise InterruptedError

    monkeypatch.setattr(improving, "fit_numbers", caught)
    goal = {"of": "stroke(d)", "target": 90.0}
    with pytest.raises(InterruptedError):
        lw.synthesis.improve(lw.example("slider-crank"), goal, vary=["O2 A", "O2.y"], starts=400)
    start, others = found[0][0], found[0][1:]
    assert start == pytest.approx([40.0, 0.0])
    # 5 % of the crank, and of the longest link, 120
    assert np.abs(others - start).max(axis=0) == pytest.approx([2.0, 6.0], rel=0.02)
    assert np.abs(others.mean(axis=0) - start).max() < 1.0


def test_a_design_with_a_dead_point_between_two_rows_is_not_sound(tmp_path: Path) -> None:
    """The ground is at half a degree, and the crank's turn has a gap from 180.25 to 180.75 deg."""
    begin = np.radians(0.5)
    longest = np.sqrt(11600.0 + 8000.0 * np.cos(np.radians(0.25)))
    text = lw.example_text("four-bar")
    pivot = f"[{100.0 * np.cos(begin)}, {100.0 * np.sin(begin)}]"
    text = text.replace("[100, 0]", pivot).replace('"A B"   = 120', f'"A B" = {longest - 80.0}')
    bar = lw.loads(text)
    motion = bar.sweep()
    assert motion.certified.all()
    end = branch_end(motion)
    assert end is not None
    assert min(abs(end.input - place) for place in (180.25, 180.75)) < 1e-6
    goal = {"of": "rocker", "at": [90], "values": [float(bar.solve(at=90)["rocker"])]}
    (design,) = lw.synthesis.improve(bar, goal, vary=["A B"], starts=1)
    assert not design.sound
    assert design.whole_motion is None
    assert "all rows are proved; the branch ends at the dead point crank = 180." in design.message
    goals = {"goals": [goal], "vary": ["A B"], "starts": 1}
    (tmp_path / "bar.toml").write_text(text)
    (judged,) = lw.Task.improve(tmp_path / "bar.toml", **goals).solve().designs
    (defect,) = judged.defects
    assert defect.kind is lw.synthesis.DefectKind.RANGE
    assert defect.message.startswith("the driven range reaches the dead point crank = 180.")
    # limits that are not in the table do not count
    door = lw.example("garage-door").sweep()
    assert door.limits
    assert branch_end(door) is None
    assert branch_end(lw.loads(text.replace("to    = 360", "to = 180")).sweep()) is None


def test_a_start_that_leads_to_a_dead_point_is_led_again_kept_off_it() -> None:
    """Of 0.8 of its largest angle, the rocker's crank first comes so long that it hardly turns."""
    bar = lw.example("four-bar")
    goal = {"of": "max(rocker)", "target": 0.8 * bar.sweep().value("max(rocker)")}
    told: list[float] = []
    found = lw.synthesis.improve(bar, goal, starts=6, progress=told.append)
    met = [design for design in found if design.sound and design.total < 1e-12]
    angles = [lw.Mechanism(design.description).sweep()["B.transmission"] for design in met]
    assert min(np.minimum(a, 180.0 - a).min() for a in angles) > 0.24
    assert len(met) >= 5
    assert [design.sound for design in found] == sorted((d.sound for d in found), reverse=True)
    assert told == sorted(told)
    assert told[-1] <= 1.0

    def stop(fraction: float) -> None:
        if fraction > 0.65:
            raise KeyboardInterrupt

    kept = lw.synthesis.improve(bar, goal, starts=6, progress=stop)
    assert len(kept) >= 6
    assert all(design.message.startswith("interrupted") for design in kept)


@pytest.mark.extended
def test_designs_at_dead_points_are_replaced_by_those_of_the_same_start() -> None:
    leg = lw.example("jansen-leg")
    goal = {"of": "stroke(F.x)", "target": 1.2 * leg.sweep().value("stroke(F.x)")}
    found = lw.synthesis.improve(leg, goal, starts=3)
    # a start of which two lanes end alike has one design
    assert sum(design.sound for design in found) >= 2


def test_fits_name_the_starts_of_the_lanes_that_are_left() -> None:
    bar = lw.example("four-bar")
    numbers = improving.numbers_to_vary(bar.model, ["O2 A", "A B"])
    given = Fitting(
        model=bar.model,
        motion=bar.sweep(),
        numbers=numbers,
        box=Box(least=np.array([1.0, 1.0]), most=np.array([900.0, 900.0])),
        path=None,
        goals=[Goal(of="stroke(rocker)", target=60.0)],
    )
    # no row closes with the second
    starts = np.array([[40.0, 120.0], [900.0, 1.0], [38.0, 125.0]])
    fits = fit_numbers(given, starts)
    assert fits.start.tolist() == [0, 2]
    for x, k in zip(fits.x, fits.start, strict=True):
        assert x == pytest.approx(fit_numbers(given, starts[[k]]).x[0], rel=1e-9)
