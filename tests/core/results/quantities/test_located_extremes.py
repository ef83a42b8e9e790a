"""Numbers of a motion are those of the motion, whatever rows its table has."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

import linkwork as lw
from linkwork.core.results.quantities import rows as located_rows
from tests.campaigns.extremes import extreme_campaign

STEPS = (1.0, 5.0, 10.0)
SLIDER = """
format = 1
length = "mm"
[dimensions]
a = 63
b = 130
c = 52
[loops]
L = "a*e^(i*θ2) - b*e^(i*θ3) = d + i*c"
[guess]
"θ2" = 55
"θ3" = 180
d = 160
[input]
variable = "θ2"
from = 0
to = 360
step = {step}
"""
BAR = {"O2 A": 40, "A B": 120, "O4 B": 80}


def slider(step: float) -> lw.Mechanism:
    return lw.loads(SLIDER.format(step=step))


def bar(step: float, **further: object) -> lw.Mechanism:
    return lw.linkage(
        length="mm",
        points={"O2": (0, 0), "A": (35, 20), "B": (146, 66), "O4": (100, 0)},
        links={
            "ground": ["O2", "O4"],
            "crank": ["O2", "A"],
            "coupler": ["A", "B"],
            "rocker": ["O4", "B"],
        },
        lengths=BAR,
        inputs=lw.Input(link="crank", from_=0, to=360, step=step, speed="10 rad/s"),
        **further,
    )


@pytest.mark.parametrize("step", STEPS)
def test_the_stroke_of_an_offset_slider_and_its_sensitivities_are_closed_forms(step: float) -> None:
    far, near = math.sqrt(193.0**2 - 52.0**2), math.sqrt(67.0**2 - 52.0**2)
    mechanism = slider(step)
    found = lw.design.sensitivity(mechanism, "stroke(d)")
    assert float(found.value) == pytest.approx(far - near, rel=1e-13)
    expected = {"a": 193.0 / far + 67.0 / near, "b": 193.0 / far - 67.0 / near,
                "c": -52.0 / far + 52.0 / near}  # fmt: skip
    # the located input is known to 1e-12
    assert {name: found[name] for name in "abc"} == pytest.approx(expected, rel=1e-11)
    at = [math.asin(52.0 / 193.0), math.pi + math.asin(52.0 / 67.0)]
    part = at[1] - at[0]
    ratio = max(part, math.tau - part) / min(part, math.tau - part)
    assert mechanism.sweep().value("time_ratio(d)") == pytest.approx(ratio, rel=1e-11)
    assert mechanism.family({"c": [50.0, 52.0]}).sweep().value("stroke(d)")[1] == pytest.approx(
        far - near, rel=1e-11
    )


@pytest.mark.parametrize("step", STEPS)
def test_the_swing_of_a_rocker_and_its_sensitivities_are_those_of_its_dead_centres(
    step: float,
) -> None:
    def angle(sign: float, a: complex, b: complex, c: complex) -> complex:
        return complex(math.pi - np.arccos((c**2 + 100.0**2 - (b + sign * a) ** 2) / (200.0 * c)))

    def swing(a: complex, b: complex, c: complex) -> complex:
        return math.degrees(1.0) * (angle(-1.0, a, b, c) - angle(1.0, a, b, c))

    found = lw.design.sensitivity(bar(step), "stroke(rocker)")
    assert float(found.value) == pytest.approx(swing(40, 120, 80).real, rel=1e-13)
    for k, name in enumerate(BAR):
        numbers: list[complex] = [40.0, 120.0, 80.0]
        numbers[k] += 1e-30j
        assert found[name] == pytest.approx(swing(*numbers).imag * 1e30, rel=1e-11)
    # B moves on a circle, back and forth
    there_and_back = 2.0 * 80.0 * math.radians(swing(40, 120, 80).real)
    assert bar(step).sweep().value("path_length(B)") == pytest.approx(there_and_back, rel=1e-11)


@pytest.mark.parametrize(
    "name",
    [
        "max(rocker.d1)", "min(rocker.velocity)", "stroke(coupler.acceleration)",
        "max(crank.effort)", "min(A.force.y)", "min(B.transmission)", "dwell(rocker, 5)",
        "path_length(P)",
    ],
)  # fmt: skip
def test_a_number_of_a_motion_is_the_same_at_every_step(name: str) -> None:
    masses = {"coupler": lw.Mass(mass=2.0, center=(60, 5), inertia=100.0)}
    coarse, fine = (
        bar(step, masses=masses).sweep()
        if name != "path_length(P)"
        else lw.example("hoeken").sweep(step=step)
        for step in (10.0, 0.25)
    )
    # the rows of the fine table miss less than their step squared of an extreme
    assert coarse.value(name) == pytest.approx(fine.value(name), rel=1e-10)


def test_the_higher_of_two_extremes_is_found_though_the_lower_one_is_a_row() -> None:
    text = SLIDER.format(step=9)
    wave = '[outputs]\nw = "cos(3*θ2) + 0.001*(1 - cos(θ2)) + 0.0001*sin(θ2)"\n'
    mechanism = lw.loads(text + wave)
    dense = np.radians(np.linspace(119.9, 120.1, 200_001))
    most = (np.cos(3 * dense) + 0.001 * (1 - np.cos(dense)) + 0.0001 * np.sin(dense)).max()
    assert mechanism.sweep().value("max(w)") == pytest.approx(most, abs=1e-13)
    assert mechanism.family({"a": [63.0, 64.0]}).sweep().value("max(w)")[0] == pytest.approx(
        most, abs=1e-12
    )


def test_an_extreme_at_a_dead_point_is_that_of_the_dead_point() -> None:
    motion = bar(10.0).with_dimensions({"O2 A": 90.0}).sweep()
    ends = [motion["crank"][motion.found][k] for k in (0, -1)]
    assert sorted(limit.input for limit in motion.limits) == pytest.approx(sorted(ends))
    fine = bar(0.5).with_dimensions({"O2 A": 90.0}).sweep()
    for name in ("max(rocker)", "stroke(coupler)", "path_length(B)"):
        assert motion.value(name) == pytest.approx(fine.value(name), rel=1e-9)


def test_designs_have_their_extremes_as_they_have_them_alone() -> None:
    four = bar(10.0)
    lengths = [38.0, 40.0, 90.0]  # the last one has dead points in the table
    family = four.family({"O2 A": lengths}).sweep()
    for name in ("max(rocker)", "min(B.transmission)", "stroke(rocker.velocity)"):
        alone = [bar(0.5).with_dimensions({"O2 A": a}).sweep().value(name) for a in lengths[:2]]
        assert family.value(name)[:2] == pytest.approx(alone, rel=1e-11)


def test_limits_of_rates_and_efforts_are_located() -> None:
    loaded = bar(10.0, masses={"coupler": lw.Mass(mass=2.0, center=(60, 5), inertia=100.0)})
    motion = loaded.sweep(limits_of=["rocker.d1", "crank.effort"])
    found = {(limit.name, limit.kind): limit for limit in motion.output_limits}
    assert found["rocker.d1", "maximum"].value == pytest.approx(motion.value("max(rocker.d1)"))
    lowest = found["crank.effort", "minimum"]
    assert lowest.value == pytest.approx(motion.value("min(crank.effort)"), rel=1e-13)
    row = motion.limit.index("minimum of crank.effort")
    assert motion.certified[row] or motion.certified[row + 1]
    with pytest.raises(lw.InputError, match="measures how a position was found"):
        loaded.sweep(limits_of="condition")


def test_a_pole_is_no_extreme() -> None:
    motion = bar(10.0).sweep(limits_of="rocker.mechanical_advantage")
    assert motion.value("max(rocker.mechanical_advantage)") == math.inf
    assert all(abs(limit.value) < 10.0 for limit in motion.output_limits)


def test_a_goal_of_a_stroke_is_met_by_the_stroke_of_the_motion() -> None:
    best = lw.synthesis.improve(
        slider(3.0), {"of": "stroke(d)", "target": 150.0}, vary=["a"], starts=1
    )[0]
    # polynomials through nine rows three degrees apart
    a = best.numbers["a"]
    stroke = math.sqrt((130.0 + a) ** 2 - 52.0**2) - math.sqrt((130.0 - a) ** 2 - 52.0**2)
    assert stroke == pytest.approx(150.0, rel=1e-10)


def test_random_mechanisms_have_the_extremes_of_closed_forms_and_of_finer_tables() -> None:
    counts, false = extreme_campaign(0, 4)
    assert false == []
    assert counts["numbers of designs with two extremes between rows"] == 0


CAM = """
format = 1
[points]
O = [0, 0]
S = [0, -50]
T = [0, 100]
P = [0, 40]
[links]
ground = ["O", "S", "T"]
disc = ["O"]
follower = ["P"]
[[sliders]]
name = "s"
link = "follower"
points = ["P"]
angle = 90
on = "ground"
line = ["S", "T"]
[[cams]]
name = "cam"
cam = "disc"
center = "O"
slider = "s"
base = 40
segments = [
  {{ law = "cycloidal", over = {rise}, lift = 10 }},
  {{ law = "dwell", over = 101 }},
  {{ law = "cycloidal", over = {rise}, lift = -10 }},
  {{ law = "dwell", over = {rest} }},
]
[input]
link = "disc"
from = {start}
to = {stop}
step = {step}
"""


def cam(rise: float, step: float, start: float = 0.0) -> lw.Mechanism:
    rest = 259.0 - 2.0 * rise
    return lw.loads(CAM.format(rise=rise, rest=rest, step=step, start=start, stop=start + 360.0))


@pytest.mark.parametrize("step", [30.0, 60.0, 90.0, 180.0])
def test_extremes_are_found_where_the_quantity_is_zero_in_all_rows(step: float) -> None:
    wave = '[outputs]\nw = "c/52*sin(6*θ2)"\n'
    mechanism = lw.loads(SLIDER.format(step=step) + wave)
    motion = mechanism.sweep()
    assert np.abs(motion["w"]).max() < 1e-12
    assert motion.value("max(w)") == pytest.approx(1.0, rel=1e-13)
    assert motion.value("stroke(w)") == pytest.approx(2.0, rel=1e-13)
    assert mechanism.family({"c": [52.0, 26.0]}).sweep().value("stroke(w)") == pytest.approx(
        [2.0, 1.0], rel=1e-12
    )
    # six equal extremes have no derivative
    assert math.isnan(lw.design.sensitivity(mechanism, "max(w)")["c"])


@pytest.mark.parametrize(("rise", "step"), [(8.0, 20.0), (8.0, 30.0), (1.5, 30.0), (1.5, 5.0)])
def test_short_pieces_of_cams_between_rows_are_seen(rise: float, step: float) -> None:
    motion = cam(rise, step, 259.0 - rise).sweep()
    # the extremes of the cycloidal law
    angle = math.radians(rise)
    expected = {"stroke(s)": 10.0, "max(s.d1)": 20.0 / angle, "min(s.d1)": -20.0 / angle,
                "max(s.d2)": 20.0 * math.pi / angle**2}  # fmt: skip
    found = {name: motion.value(name) for name in expected}
    assert found == pytest.approx(expected, rel=1e-9)


def test_a_short_movement_between_two_rows_of_time_is_seen() -> None:
    there, back = (
        lw.LawSegment(law="3-4-5", over=t, by=s * 90) for t, s in ((0.04, 1), (0.05, -1))
    )
    rests = [lw.LawSegment(law="dwell", over=t) for t in (0.01, 0.9)]
    law = (there, rests[0], back, rests[1])
    coarse, fine = (
        bar(1.0).changed(inputs=lw.Input(link="crank", law=law, from_=0, to=1, step=step)).sweep()
        for step in (0.1, 0.001)
    )
    assert np.ptp(coarse["rocker"]) < 1e-9
    for name in ("stroke(rocker)", "max(rocker.velocity)", "min(rocker.velocity)"):
        assert coarse.value(name) == pytest.approx(fine.value(name), rel=1e-10)


def test_an_extreme_just_before_the_last_row_is_found_by_values_alone() -> None:
    masses = {"coupler": lw.Mass(mass=2.0, center=(60, 5), inertia=100.0)}
    fine = bar(0.1, masses=masses)
    highest = 0.1 * int(np.argmax(fine.sweep()["crank.effort"]))
    for beyond in (0.05, 0.1, 0.7):
        stop = highest + beyond
        most, less = (
            fine.sweep(from_=stop - 60.0, to=stop, step=step).value("max(crank.effort)")
            for step in (0.1, 10.0)
        )
        assert less == pytest.approx(most, rel=1e-11)


@pytest.mark.parametrize("step", [1.0, 30.0])
def test_extremes_next_to_a_change_point_are_on_their_turn(step: float) -> None:
    a, b, c, d = 1.0, 3.000001, 3.0, 1.000003
    start = math.radians(120.0)
    diagonal = d - a * np.exp(1j * start)

    def coupler(u: np.ndarray) -> np.ndarray:
        away = d - a * np.exp(1j * u)
        size = np.abs(away)
        turn = np.arccos((b**2 + size**2 - c**2) / (2.0 * b * size))
        return np.asarray(np.degrees(np.angle(away) + turn))

    q = float(coupler(np.array(start)))
    p = math.degrees(float(np.angle(b * np.exp(1j * math.radians(q)) - diagonal)))
    mechanism = lw.loads(f"""
format = 1
[loops]
L = "{a}*e^(i*t) + {b}*e^(i*q) = {d} + {c}*e^(i*p)"
[guess]
t = 120
q = {q!r}
p = {p!r}
[input]
variable = "t"
from = 0
to = 360
step = {step}
""")
    near = 10.0 ** np.linspace(-5.0, 0.0, 200_001)
    most = float(max(coupler(near).max(), coupler(-near).max()))
    # cosines of angles near 180 degrees are rounded
    assert mechanism.sweep().value("max(q)") == pytest.approx(most, abs=1e-5)


@pytest.mark.parametrize("step", [1.0, 10.0, 60.0])
def test_sharp_extremes_of_designs_are_no_poles_and_poles_are_infinite(step: float) -> None:
    text = '[outputs]\nsharp = "1/((d - 150)^2 + 1e-3)"\npole = "1/(d - 150)"\n'
    mechanism = lw.loads(SLIDER.format(step=step) + text)
    family = mechanism.family({"c": [52.0, 51.0]}).sweep()
    assert family.value("max(sharp)") == pytest.approx([1e3, 1e3], rel=1e-11)
    assert mechanism.sweep().value("max(sharp)") == pytest.approx(1e3, rel=1e-11)
    assert (family.value("max(pole)") == math.inf).all()


@pytest.mark.parametrize("step", [1.0, 10.0, 30.0])
def test_extremes_at_corners_between_rows_are_exact(step: float) -> None:
    text = '[outputs]\nfar = "-abs(d - 150.123)"\nlower = "min(sin(θ2 - 17.3), cos(θ2 - 5.1))"\n'
    mechanism = lw.loads(SLIDER.format(step=step) + text)
    # the sines cross half-way between their phases
    expected = math.sin(math.radians(0.5 * (17.3 + 90.0 + 5.1) - 17.3))
    motion, family = mechanism.sweep(), mechanism.family({"c": [52.0, 51.0]}).sweep()
    assert motion.value("max(far)") == pytest.approx(0.0, abs=1e-9)
    assert motion.value("max(lower)") == pytest.approx(expected, rel=1e-11)
    assert family.value("max(far)") == pytest.approx([0.0, 0.0], abs=1e-8)
    # polynomials across a corner are compared by their last terms
    assert family.value("max(lower)") == pytest.approx([expected] * 2, rel=1e-9)


@pytest.mark.parametrize(
    ("name", "link"), [("parallel-cranks", "rod"), ("scissor-three-bars", "low")]
)
def test_the_rounding_of_a_constant_angle_is_not_resolved(
    name: str, link: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    longest = 0
    columns = located_rows.columns_of

    def counted(asked: Any, solved: Any, speed: float | None) -> Any:
        nonlocal longest
        longest += len(solved.found)
        assert longest < 20_000
        return columns(asked, solved, speed)

    motion = lw.example(name).sweep(step=30)
    monkeypatch.setattr(located_rows, "columns_of", counted)
    assert motion.value(f"stroke({link})") == pytest.approx(0.0, abs=1e-12)
    assert longest > 0
