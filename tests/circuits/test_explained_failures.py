"""What would help where loops do not close, what is within reach, and what exists elsewhere."""

from __future__ import annotations

import json
import math
from collections import Counter
from collections.abc import Mapping

import numpy as np
import pytest
from click.testing import CliRunner

import linkwork as lw
from linkwork.circuits.failure import failing, remedies
from linkwork.circuits.failure.reach import Elsewhere
from linkwork.circuits.failure.remedies import ChangeableLength, model_with
from linkwork.core.commands.main import linkwork
from linkwork.core.motion.model import Model
from linkwork.core.results.failure import Failure
from tests.core.failures.test_positions_that_do_not_exist import four_bar
from tests.thinned import thinned

EXACT = 1e-11  # relative: what closed form and fold differ by is rounding


def failure_of(position: lw.Position) -> Failure:
    assert position.failure is not None
    return position.failure


def needed_of(position: lw.Position) -> dict[str, float]:
    return {remedy.length: remedy.needed for remedy in failure_of(position).remedies}


def diagonal(crank: float, ground: float, theta: float) -> float:
    return float(abs(crank * np.exp(1j * theta) - ground))


@pytest.mark.parametrize("seed", thinned(range(25)))
def test_every_length_that_would_close_a_four_bar_is_the_one_of_the_closed_form(seed: int) -> None:
    rng = np.random.default_rng(seed)
    while True:
        crank, coupler, rocker, ground = rng.uniform(5, 100, 4)
        at = float(rng.uniform(0, 360))
        d = diagonal(crank, ground, math.radians(at))
        reach = (abs(coupler - rocker), coupler + rocker)
        gap = max(d - reach[1], reach[0] - d)
        if gap > 1:
            break
    position = four_bar(crank, coupler, rocker, ground, at=at).solve()
    failure = failure_of(position)
    assert position.status is lw.Status.CANNOT_CLOSE
    assert failure.gap == pytest.approx(gap, rel=EXACT)
    short = d > reach[1]
    wanted = {}
    if short or coupler < rocker:
        wanted["A B"] = coupler + gap
    elif coupler > gap:
        wanted["A B"] = coupler - gap
    if short or rocker < coupler:
        wanted["O4 B"] = rocker + gap
    elif rocker > gap:
        wanted["O4 B"] = rocker - gap
    # |c e^{iθ} - g| = the limit passed: a quadratic in the crank, and one in the ground
    limit = reach[1] if short else reach[0]
    for name, own, other in (("O2 A", crank, ground), ("O2 O4", ground, crank)):
        middle = other * math.cos(math.radians(at))
        square = limit**2 - (other * math.sin(math.radians(at))) ** 2
        if square > 0:
            roots = [middle + s * math.sqrt(square) for s in (1, -1)]
            between = [r for r in roots if r > 0]
            if between:
                wanted[name] = min(between, key=lambda r: abs(r - own))
    needed = needed_of(position)
    for name, value in needed.items():
        assert value == pytest.approx(wanted[name], rel=EXACT)
    assert {"A B", "O4 B"} & set(wanted) <= set(needed)
    changes = [abs(remedy.change) for remedy in failure.remedies]
    assert changes == sorted(changes, key=lambda change: float(f"{change:.9e}"))
    assert all(remedy.exact for remedy in failure.remedies)


def slider_crank(rod: float, offset: float = 0.0) -> lw.Mechanism:
    return lw.linkage(
        name="slider-crank",
        points={"O": (0, 0), "T": (200, 0), "A": (0, 40), "B": (rod, offset)},
        links={"ground": ["O", "T"], "crank": ["O", "A"], "rod": ["A", "B"], "block": ["B"]},
        lengths={"O A": 40, "A B": rod},
        sliders=[
            lw.Slider(name="s", link="block", points=("B",), on="ground", line=("O", "T"),
                      offset=offset)
        ],
        inputs=lw.Input(link="crank"),
    )  # fmt: skip


@pytest.mark.parametrize("offset", [0.0, 5.0, -5.0])
def test_a_rod_too_short_for_its_slide_asks_for_the_exact_rod_crank_or_offset(
    offset: float,
) -> None:
    # at 90° the crank's end is 40 - offset above the slide
    position = slider_crank(30, offset).solve(at=90)
    gap = 40 - offset - 30
    assert failure_of(position).gap == pytest.approx(gap, rel=EXACT)
    assert needed_of(position) == pytest.approx(
        {"A B": 30 + gap, "O A": 40 - gap, "offset of s": offset + gap}, rel=EXACT
    )
    # 90° lies halfway between both dead points: the one ahead is named
    reached = 180 - math.degrees(math.asin((30 + offset) / 40))
    assert failure_of(position).nearest_input["crank"] == pytest.approx(reached, rel=1e-12)
    assert failure_of(position).nearest_kind == "dead point"
    assert failure_of(position).nearest_proved
    assert failure_of(position).complete
    assert failure_of(position).configurations == ()


def test_an_arm_longer_than_the_distance_of_its_pivot_asks_for_the_exact_arm() -> None:
    # the slot's line keeps the distance c from the pivot at d; the crank's end comes within d - a
    mechanism = lw.loops(
        name="arm",
        loops={"O A Q": "a*e^(i*φ) = d + (s + i*c)*e^(i*θ)"},
        dimensions={"a": 3, "d": 5, "c": 2.5},
        guess={"φ": 0, "θ": 100, "s": 1},
        inputs=lw.Input(variable="φ"),
    )
    position = mechanism.solve()
    assert failure_of(position).gap == pytest.approx(0.5, rel=EXACT)
    assert needed_of(position) == pytest.approx({"c": 2, "a": 2.5, "d": 5.5}, rel=EXACT)
    # |3 e^{iφ} - 5| = 2.5
    reached = math.degrees(math.acos((9 + 25 - 6.25) / 30))
    assert failure_of(position).nearest_input["φ"] == pytest.approx(reached, rel=1e-12)


def just_closes(mechanism: lw.Mechanism, at: float, name: str, needed: float, opens: float) -> None:
    """Whether a position exists a little behind the value and none a little before it."""
    for side, exists in ((1, True), (-1, False)):
        changed = mechanism.with_dimensions(**{name: needed * (1 + side * opens * 1e-7)})
        position = changed.solve(at=at, from_guess=True)
        ok = position.status.ok or bool(position.failure and position.failure.configurations)
        assert ok is exists


@pytest.mark.extended
def test_lengths_that_close_coupled_loops_were_solved_again() -> None:
    mechanism = lw.example("rapier-drive-limited")
    position = mechanism.solve(at=170, from_guess=True)
    failure = failure_of(position)
    assert position.status is lw.Status.CANNOT_CLOSE
    assert {"A0 A B C C0", "C0 C D E"} == set(failure.loops)
    assert len(failure.remedies) >= 6
    assert not any(remedy.exact for remedy in failure.remedies)
    assert "the loops just close near the guess with a5 = " in position.message
    for remedy in failure.remedies:
        opens = math.copysign(1.0, remedy.change * remedy.now)
        just_closes(mechanism, 170, remedy.length, remedy.needed, opens)
    assert failure.nearest_input["θ12"] == pytest.approx(149.617278637485, abs=1e-11)
    assert failure.nearest_proved


def test_a_length_of_an_earlier_loop_can_close_a_later_one() -> None:
    # rocker 80 of the first four-bar drives the second one through a fixed angle of 0
    mechanism = lw.loops(
        name="two four-bars",
        loops={
            "first": "a*e^(i*φ) + b*e^(i*θ3) = d + c*e^(i*θ4)",
            "second": "l*e^(i*θ4) + f*e^(i*θ5) = g + h*e^(i*θ6)",
        },
        dimensions={"a": 40, "b": 120, "c": 80, "d": 100, "l": 50, "f": 20, "g": 90, "h": 30},
        guess={"φ": 60, "θ3": 20, "θ4": 65, "θ5": 0, "θ6": 90},
        inputs=lw.Input(variable="φ"),
    )
    position = mechanism.solve()
    failure = failure_of(position)
    assert failure.loops == ("second",)
    theta4 = mechanism.with_dimensions(f=90).solve()["θ4"]
    d = diagonal(50, 90, math.radians(theta4))
    assert failure.gap == pytest.approx(d - 50, rel=EXACT)
    needed = needed_of(position)
    assert needed["f"] == pytest.approx(d - 30, rel=EXACT)
    assert {"a", "b", "c", "d"} & set(needed)
    for name in set("abcd") & set(needed):
        changed = mechanism.with_dimensions(**{name: needed[name]}, f=25).solve()
        reach = diagonal(50, 90, math.radians(changed["θ4"]))
        assert reach == pytest.approx(50, rel=1e-9)


def test_dimensions_that_are_angles_are_no_lengths() -> None:
    mechanism = lw.loops(
        name="bent",
        loops={"L": "a*e^(i*φ) + b*e^(i*θ3) = d*e^(i*α) + c*e^(i*θ4)"},
        dimensions={"a": 40, "b": 20, "c": 45, "d": 100, "α": 30},
        guess={"φ": 90, "θ3": 0, "θ4": 90},
        inputs=lw.Input(variable="φ"),
    )
    assert set(needed_of(mechanism.solve())) == {"b", "c", "d"}


def test_beyond_a_dead_point_other_configurations_are_told() -> None:
    # the third circuit of the rapier drive ends at 155.2278°; two others turn on
    guess = {"θ12": 60, "θ13": 244.6, "θ14": 218.1, "θ15": 326.1, "s16": -1172}
    start = lw.example("rapier-drive").changed(guess=guess)
    position = start.solve(at=170)
    failure = failure_of(position)
    assert position.status is lw.Status.OUT_OF_REACH
    assert failure.nearest_input["θ12"] == pytest.approx(155.227836297534, abs=1e-11)
    there = sorted(c["s16"] for c in failure.configurations)
    assert len(there) == 2
    assert failure.complete
    for configuration in failure.configurations:
        follows = lw.example("rapier-drive").changed(guess={**configuration, "θ12": 170})
        assert follows.solve()["s16"] == pytest.approx(configuration["s16"], abs=1e-9)


STEPHENSON = {
    "points": {
        "O2": (0, 0),
        "A": (-53.6, 10.6),
        "B": (-28.7, 78.2),
        "O4": (100, 0),
        "P": (108.8, 36.9),
        "D": (-58, -45.9),
        "O6": (33.1, 119.5),
    },
    "links": {
        "ground": ["O2", "O4", "O6"],
        "l2": ["O2", "A"],
        "l3": ["A", "B", "P"],
        "l4": ["O4", "B"],
        "l5": ["P", "D"],
        "l6": ["O6", "D"],
    },
}


def test_where_the_circuit_reaches_the_value_on_another_branch_that_is_told() -> None:
    mechanism = lw.linkage(name="six-bar", **STEPHENSON, inputs=lw.Input(link="l6"))
    position = mechanism.solve(at=230)
    failure = failure_of(position)
    assert position.status is lw.Status.OUT_OF_REACH
    limits = [limit.input for limit in mechanism.sweep().limits]
    assert failure.nearest_kind == ""
    away = [math.remainder(failure.through["l6"] - limit, 360) for limit in limits]
    assert min(map(abs, away)) < 1e-9
    assert "; the circuit reaches this input through the dead point at l6 = " in position.message
    assert len(failure.configurations) == 2


def test_without_a_position_at_the_guess_what_exists_at_the_value_asked_is_told() -> None:
    mechanism = four_bar(40, 30, 40, 100)
    failure = failure_of(mechanism.solve(at=10))
    assert failure.what.startswith("the motion starts at the input value of the guess, where ")
    assert dict(failure.asked) == {"crank": 10.0}
    assert failure.configuration_names == ("open", "crossed")
    assert not failure.nearest_input
    beyond = failure_of(mechanism.solve(at=60))
    assert dict(beyond.asked) == {"crank": 60.0}
    assert not beyond.configurations
    assert beyond.nearest_input["crank"] == pytest.approx(33.1229402, abs=1e-7)


def test_an_input_of_a_slider_says_the_length_that_can_be_reached() -> None:
    mechanism = lw.linkage(
        name="pushed crank",
        points={"O": (0, 0), "A": (0, 40), "B": (113.137085, 0), "T": (300, 0)},
        links={"ground": ["O", "T"], "crank": ["O", "A"], "rod": ["A", "B"], "block": ["B"]},
        lengths={"O A": 40, "A B": 120},
        sliders=[
            lw.Slider(name="s", link="block", points=("B",), angle=0, on="ground", line=("O", "T"))
        ],
        inputs=lw.Input(slider="s", from_=100, to=200, step=10),
    )
    position = mechanism.solve(at=200)
    failure = failure_of(position)
    assert dict(failure.nearest_input) == {"s": 160.0}
    assert position.message.endswith(
        "; nearest reachable input: s = 160 mm (dead point); no configuration exists there"
    )
    below = failure_of(mechanism.solve(at=10))
    assert dict(below.nearest_input) == {"s": 80.0}


def test_of_two_equally_near_values_the_one_ahead_is_named_and_whole_turns_are_kept() -> None:
    mechanism = four_bar(2, 5, 2, 4)
    dead = math.degrees(math.acos(11 / 16))
    for at, nearest in ((0, dead), (-1, -dead), (350, 360 - dead), (361, 360 + dead)):
        failure = failure_of(mechanism.solve(at=at))
        assert failure.nearest_input["crank"] == pytest.approx(nearest, rel=1e-13)


def test_the_positions_elsewhere_are_asked_of_one_function(monkeypatch: pytest.MonkeyPatch) -> None:
    v = np.radians([[10.0, 20.0, 0.0]])
    found = Elsewhere(v=v, complete=True)
    monkeypatch.setattr(failing, "positions_elsewhere", lambda model, inputs: found)
    position = four_bar(2, 5, 2, 4).solve(at=0)
    assert position.message.endswith("; 1 configuration exists there: coupler = 10°, rocker = 20°")
    none = Elsewhere(v=v[:0], complete=True, likely=True)
    monkeypatch.setattr(failing, "positions_elsewhere", lambda model, inputs: none)
    position = four_bar(2, 5, 2, 4).solve(at=0)
    assert position.message.endswith("; no configuration exists there (with probability one)")
    monkeypatch.setattr(failing, "positions_elsewhere", lambda model, inputs: None)
    position = four_bar(2, 5, 2, 4).solve(at=0)
    assert position.message.endswith("; nearest reachable input: crank = 46.56746344° (dead point)")


def test_the_explanation_is_in_the_json_of_a_position() -> None:
    failure = failure_of(four_bar(40, 30, 40, 100).solve())
    data = four_bar(40, 30, 40, 100).solve().to_dict()["failure"]
    assert json.loads(json.dumps(data)) == data
    assert data["loops"] == ["O2 A B O4"]
    assert data["gap"] == failure.gap
    first = failure.remedies[0]
    assert data["remedies"][0] == {
        "length": "A B",
        "now": 30.0,
        "needed": first.needed,
        "change": first.change,
        "exact": True,
    }
    assert data["nearest_input"] == dict(failure.nearest_input)
    assert data["nearest_kind"] == "dead point"
    assert data["nearest_proved"] is True
    assert (data["configurations"], data["configurations_complete"]) == ([], True)
    assert data["trouble"] is None


PAGE = """\
four-bar
No position found at crank = 90 deg
  why        loop "O2 A B O4" cannot be closed at crank = 90°: near the guess a
             gap of at least 37.7033 mm remains
  remedy     the loops just close with "A B" = 67.7033 mm (37.7033 longer) or
             "O4 B" = 77.7033 mm (37.7033 longer) or "O2 O4" = 57.4456 mm
             (42.5544 shorter)
  nearest    nearest reachable input: crank = {angle:.10g}° (dead point)
  elsewhere  no configuration exists there
"""


def test_the_page_of_a_position_tells_every_part_in_its_own_line(tmp_path: object) -> None:
    path = f"{tmp_path}/short.toml"
    four_bar(40, 30, 40, 100).save(path)
    result = CliRunner().invoke(linkwork, ["solve", path])
    assert result.exit_code == 1
    angle = math.degrees(math.acos((40**2 + 100**2 - 70**2) / (2 * 40 * 100)))
    assert result.output == PAGE.format(angle=angle)


def test_a_position_other_than_the_one_beside_the_guess_is_found_and_says_so() -> None:
    guess = {"θ2": 60, "θ3": 117.657, "θ4": 138.787}
    mechanism = lw.loops(
        name="four-bar",
        loops={"L": "2*e^(i*θ2) + 5*e^(i*θ3) = 4 + 3.5*e^(i*θ4)"},
        guess=guess,
        inputs=lw.Input(variable="θ2"),
    )
    position = mechanism.solve()
    assert position.status is lw.Status.CONVERGED
    assert position.certificate.certified
    failure = failure_of(position)
    assert failure.trouble is lw.NewtonTrouble.ANOTHER_ROOT
    assert failure.meant == pytest.approx({"θ3": 14.40014098, "θ4": 58.22758874}, abs=1e-8)
    assert position["θ3"] == pytest.approx(-74.40014098, abs=1e-8)
    assert len(failure.configurations) == 2
    nearer = mechanism.changed(guess=replace_values(guess, failure.meant))
    assert nearer.solve().failure is None


def replace_values(guess: dict[str, float], values: Mapping[str, float]) -> dict[str, float]:
    return {**guess, **values}


def test_library_mechanisms_find_the_position_beside_their_guess() -> None:
    named = [n for n in lw.examples() if not n.startswith("newton-")]
    assert {name: lw.example(name).solve().failure for name in named} == dict.fromkeys(named)


def test_equations_are_written_a_few_times_for_every_length(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    asked: list[str] = []

    def counted(length: ChangeableLength, value: float) -> Model | None:
        asked.append(length.name)
        return model_with(length, value)

    monkeypatch.setattr(remedies, "model_with", counted)
    position = lw.example("double-four-bar").with_dimensions(b3=480).solve()
    assert position.status is lw.Status.CANNOT_CLOSE
    # near the present value, at the first estimate, 15 steps to the fold, and beyond it
    assert max(Counter(asked).values()) <= 19
