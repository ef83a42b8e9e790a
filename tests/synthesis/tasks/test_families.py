"""Four, three and two poses: curves and families, with pivots that are given."""

from __future__ import annotations

import math

import numpy as np
import pytest

import linkwork as lw
from linkwork.core.foundation.arrays import Array, ComplexArray
from linkwork.core.textfile.writer import write_tables, write_text
from linkwork.synthesis.poses.burmester import centre_points, sampled_dyads, sliding_dyad
from linkwork.synthesis.poses.guiding_linkage import linkage_of
from linkwork.synthesis.solvers.result import SynthesizedDesign

_POSES = [(0, 0, 0), (200, 100, 15), (320, 260, 40), (300, 420, 75)]


def _random(seed: int) -> tuple[ComplexArray, Array]:
    rng = np.random.default_rng(seed)
    return rng.normal(size=4) + 1j * rng.normal(size=4), rng.uniform(0.0, 6.0, 4)


def test_arcs_end_where_closely_spaced_lines_begin_to_miss_the_curve() -> None:
    numbers = set()
    for seed in range(120):
        curve = centre_points(*_random(seed))
        assert curve is not None
        assert all(arc.proved for arc in curve.arcs)
        directions = np.linspace(0.0, np.pi, 3001) + 1e-4
        met = np.isfinite(curve.points(directions)).all(axis=1)
        inside = np.zeros(len(directions), dtype=bool)
        for arc in curve.arcs:
            inside |= np.mod(directions - arc.start, np.pi) < arc.stop - arc.start
        # one line on either side of an end may be rounded to the other
        assert (met != inside).sum() <= 2 * len(curve.arcs)
        numbers.add((len(curve.arcs), sum(arc.closed for arc in curve.arcs)))
    assert numbers == {(1, 0), (1, 1), (2, 2)}


def test_points_of_the_curve_are_fixed_pivots_of_four_poses() -> None:
    for seed in range(10):
        points, angles = _random(seed)
        found = sampled_dyads(points, angles)
        pinned = found.take(found.kind == 0)
        assert len(pinned) > 20
        arms = points + pinned.moving[:, None] * np.exp(1j * angles) - pinned.fixed[:, None]
        size = 1.0 + np.abs(pinned.moving) + np.abs(pinned.fixed)
        assert (np.ptp(np.abs(arms), axis=1) <= 2.0 * pinned.error + 1e-12 * size).all()
        curve = centre_points(points, angles)
        assert curve is not None
        near = curve.points(np.angle(pinned.fixed - curve.pole))
        missed = np.abs(near - pinned.fixed[:, None]).min(axis=1)
        assert np.median(missed) < 1e-9


def test_one_slider_and_one_sliding_body_pass_four_poses() -> None:
    points, angles = _random(3)
    (slider,) = [sliding_dyad(points, angles)]
    pin = points + slider.moving * np.exp(1j * angles) - slider.fixed
    assert np.abs((pin * slider.normal.conj()).real).max() <= slider.error[0]
    assert slider.error[0] < 1e-10
    found = sampled_dyads(points, angles)
    body = found.take(found.kind == 2)
    assert len(body) == 1
    arm = (points - body.fixed) * np.exp(-1j * angles) + body.moving
    assert np.abs((arm * body.normal.conj()).real).max() < 1e-9


def _misses(found: lw.synthesis.Synthesis, poses: list[tuple[float, float, float]]) -> float:
    """The largest distance of delivered designs from poses."""
    worst = 0.0
    for design in found.delivered:
        mechanism = lw.Mechanism(design.linkage)
        start = None
        for value, (x, y, angle) in zip(design.inputs, poses, strict=True):
            position = mechanism.solve(at=value)
            place = position.points[mechanism.description.trace[0]]
            start = position["coupler"] - angle if start is None else start
            turn = np.mod(position["coupler"] - start - angle + 180.0, 360.0) - 180.0
            worst = max(worst, abs(place[0] - x), abs(place[1] - y), abs(turn))
    return worst


_KINDS = ("four-bar", "slider-crank", "inverted-slider-crank", "rapson-slide")


@pytest.mark.parametrize(
    ("mechanism", "count"),
    [
        *((mechanism, count) for mechanism in _KINDS for count in (2, 3)),
        *((mechanism, 4) for mechanism in _KINDS[:3]),
        *((mechanism, k) for mechanism in ("double-slider", "oldham-coupling") for k in (2, 3)),
    ],
)
def test_delivered_designs_pass_the_poses(mechanism: str, count: int) -> None:
    task = lw.Task.motion(
        _POSES[:count], mechanism=mechanism, rank={"deliver": 3}, wanted={"lengths": {"most": 2000}}
    )
    found = task.solve()
    assert len(found.delivered) == 3
    assert {design.mechanism for design in found.delivered} == {mechanism}
    assert _misses(found, list(_POSES[:count])) < 1e-6


def test_a_body_that_slides_through_a_pivot_is_found_from_five_and_more_poses() -> None:
    """The coupler of an inverted slider-crank, whose pivots are planted."""
    block, offset = 150.0 - 40.0j, 25.0
    crank = 50.0 * np.exp(1j * np.radians([10, 40, 75, 110, 160, 200]))
    away = block - crank
    line = away / (np.sqrt(np.abs(away) ** 2 - offset**2) + 1j * offset)
    points, angles = crank + (30 + 60j) * line, np.degrees(np.angle(line))
    poses = np.column_stack([points.real, points.imag, angles]).tolist()
    found = lw.Task.motion(poses[:5], mechanism="inverted-slider-crank").solve()
    kinds = [dyad.kind for dyad in found.dyads]
    assert kinds.count("RP") == 1
    pivot = found.dyads[kinds.index("RP")].fixed
    assert pivot == pytest.approx((block.real, block.imag), abs=1e-6)
    planted = [d for d in found.delivered if abs(d.points["A0"]) < 1e-6]
    # the block swings back within the positions
    assert [d.driven for d in planted] == ["A0"]
    assert _misses(found, [tuple(pose) for pose in poses[:5]]) < 1e-6
    tables = [{"point": [x, y], "angle": angle, "tolerance": 0.01} for x, y, angle in poses]
    text = "format = 1\ntask = 'motion'\nmechanism = 'inverted-slider-crank'\n" + "".join(
        "[[positions]]\n" + "".join(f"{key} = {value}\n" for key, value in table.items())
        for table in tables
    )
    again = lw.Task.loads(text).solve()
    assert {abs(d.points["A0"]) < 1e-6 for d in again.delivered} == {True}
    assert all(d.error < 1e-6 for d in again.delivered)


def test_a_pivot_on_a_line_and_a_line_through_a_pivot_are_found_from_five_and_more_poses() -> None:
    """Rapson's slide, planted: A on a line through 0, the body's line through a fixed pivot."""
    block, offset, along = 90.0 + 120.0j, 20.0, np.exp(0.3j)
    a = along * np.array([-60.0, -20.0, 15.0, 60.0, 110.0, 140.0])
    away = block - a
    line = away / (np.sqrt(np.abs(away) ** 2 - offset**2) + 1j * offset)
    points, angles = a + (30 + 60j) * line, np.degrees(np.angle(line))
    poses = np.column_stack([points.real, points.imag, angles]).tolist()
    found = lw.Task.motion(poses[:5], mechanism="rapson-slide").solve()
    kinds = [dyad.kind for dyad in found.dyads]
    assert (kinds.count("PR"), kinds.count("RP")) == (1, 1)
    assert {design.driven for design in found.delivered} == {"slider at A", "B0"}
    assert {design.linkage.inputs[0].column for design in found.delivered} == {"slide_a", "block"}
    assert _misses(found, [tuple(pose) for pose in poses[:5]]) < 1e-6
    # without being named it is not made
    assert all(
        design.mechanism != "rapson-slide" for design in lw.Task.motion(poses[:5]).solve().designs
    )
    tables = [{"point": [x, y], "angle": g, "tolerance": 0.01} for x, y, g in poses]
    task = lw.Task._of("motion", positions=tables, mechanism="rapson-slide")
    again = task.solve().delivered
    assert again
    assert all(design.error < 1e-6 for design in again)


def test_parallel_guides_make_no_mechanism_and_given_pivots_are_those_of_cranks() -> None:
    found = lw.Task.motion(_POSES[:2], mechanism="double-slider").solve()
    assert found.linkages == 66
    given = {"fixed_pivots": [(100, -200)]}
    none = lw.Task.motion(_POSES[:3], mechanism="double-slider", given=given).solve()
    assert (len(none.designs), "are those of cranks" in none.message) == (0, True)
    with pytest.raises(lw.MechanismError, match=r'for task = "path", got .oldham-coupling.'):
        lw.Task.path([(0, 0), (1, 1), (3, 1)], mechanism=["four-bar", "oldham-coupling"])


def test_three_poses_of_one_angle_have_parallelograms_only_and_on_a_line_none() -> None:
    found = lw.Task.motion([(0, 0, 30), (10, 2, 30), (20, 3, 30)]).solve()
    assert "every four-bar is a parallelogram" in found.message
    assert found.designs
    for design in found.designs:
        at = design.points
        assert at["A"] - at["A0"] == pytest.approx(at["B"] - at["B0"], rel=1e-9)
    turned = lw.Task.motion([(0, 0, 30), (10, 2, 31), (20, 3, 30)]).solve()
    assert "parallelogram" not in turned.message
    with pytest.raises(lw.MechanismError, match="have one angle and lie on a line: a slider"):
        lw.Task.motion([(0, 0, 5), (10, 2, 5), (30, 6, 5)]).solve()


def test_two_given_fixed_pivots_and_three_poses_make_one_four_bar() -> None:
    pivots = [(100, -200), (400, -100)]
    found = lw.Task.motion(_POSES[:3], mechanism="four-bar", given={"fixed_pivots": pivots}).solve()
    assert found.linkages == 1
    points = found.designs[0].points
    assert (points["A0"], points["B0"]) == (100 - 200j, 400 - 100j)


def test_a_given_pivot_is_in_every_design() -> None:
    given = {"moving_pivots": [(50, 20)]}
    found = lw.Task.motion(_POSES[:3], given=given, mechanism="four-bar").solve()
    assert found.linkages > 10
    assert {design.points["A"] for design in found.designs} == {50 + 20j}


def test_a_timed_crank_turns_by_the_given_angles() -> None:
    inputs = (0, 30, 70)
    positions = [
        {"point": [x, y], "angle": angle, "input": value}
        for (x, y, angle), value in zip(_POSES, inputs, strict=False)
    ]
    text = "format = 1\ntask = 'motion'\nmechanism = 'four-bar'\n" + "".join(
        f"[[positions]]\npoint = {p['point']}\nangle = {p['angle']}\ninput = {p['input']}\n"
        for p in positions
    )
    found = lw.Task.loads(text).solve()
    assert found.designs
    for design in found.designs[:20]:
        turned = np.array(design.inputs) - design.inputs[0]
        assert np.mod(turned - inputs + 180.0, 360.0) - 180.0 == pytest.approx(0.0, abs=1e-6)


def test_moving_pivots_of_four_poses_are_circle_points() -> None:
    poses = [(5, 0, 20), *_POSES[1:]]
    found = lw.Task.motion(poses).solve()
    one, other = found.dyads[10], found.dyads[30]
    first = 5 + complex(*one.moving) * np.exp(1j * np.radians(20))
    own = {"moving_pivots": [(first.real, first.imag)], "fixed_pivots": [other.fixed]}
    bars = lw.Task.motion(poses, mechanism="four-bar", given=own).solve()
    assert (bars.linkages, bars.proved) == (1, 2)
    pivots = bars.designs[0].points
    assert sorted([pivots["A0"].real, pivots["B0"].real]) == pytest.approx(
        sorted([one.fixed[0], other.fixed[0]]), rel=1e-8
    )
    with pytest.raises(lw.MechanismError, match="is not on the circle-point curve") as caught:
        lw.Task.motion(poses, given={"moving_pivots": [(first.real + 1, first.imag)]}).solve()
    near = complex(*map(float, str(caught.value).split("[")[-1].split("]")[0].split(",")))
    assert abs(near - first) < 2.0
    parallel = [(0, 0, 0), (9, 4, 0), (20, 30, 0), (4, 30, 50)]
    with pytest.raises(lw.MechanismError, match="of which three are parallel"):
        lw.Task.motion(parallel, given={"fixed_pivots": [(0, 0)]}).solve()


@pytest.mark.parametrize("key", ["fixed_pivots", "moving_pivots"])
def test_designs_with_given_pivots_are_proved_through_all_four_poses(key: str) -> None:
    """A pivot of five decimals is off its curve: the design has the proved one on the curve."""
    poses = [(5, 0, 20), *_POSES[1:]]
    own = lw.Task.motion(poses).solve().dyads[10]
    exact = complex(*own.fixed)
    if key == "moving_pivots":
        exact = 5 + complex(*own.moving) * np.exp(1j * np.radians(20))
    pivot = round(exact.real, 5), round(exact.imag, 5)
    found = lw.Task.motion(poses, mechanism="four-bar", given={key: [pivot]}).solve()
    assert found.dyads[0].proved
    assert found.dyads[0].error < 1e-9
    assert found.linkages > 5
    for design in found.of_loops:
        given, k = design.group.candidates, design.index
        crank = np.abs(given.moving_a[k] - given.fixed_a[k])
        # both pivots and their distance are known to the error, and with them all four poses
        assert np.ptp(crank) <= 4.0 * given.error[k] + 1e-12
        there = given.fixed_a[k] if key == "fixed_pivots" else given.moving_a[k, 0]
        assert abs(there - complex(*pivot)) < 1e-4
        assert abs(there - exact) < 1e-4


def test_a_pivot_off_the_curve_of_four_poses_is_refused_with_the_nearest_point() -> None:
    with pytest.raises(lw.MechanismError, match="is not on the centre-point curve"):
        lw.Task.motion(_POSES, given={"fixed_pivots": [(0, 0)]}).solve()


def test_tolerances_give_designs_within_them_and_more_than_five_poses() -> None:
    rng = np.random.default_rng(4)
    crank = 60.0 * np.exp(1j * np.radians(np.arange(20, 161, 20)))
    base = 160.0 - crank
    cosine = (140.0**2 + np.abs(base) ** 2 - 120.0**2) / (2.0 * 140.0 * np.abs(base))
    angles = np.angle(base) + np.arccos(cosine)
    points = crank + (40 + 28j) * np.exp(1j * angles) + rng.normal(size=8) * 0.02
    table = "".join(
        f"[[positions]]\npoint = [{z.real}, {z.imag}]\nangle = {np.degrees(t)}\ntolerance = 0.5\n"
        for z, t in zip(points, angles, strict=True)
    )
    found = lw.Task.loads(f"format = 1\ntask = 'motion'\n{table}[rank]\ndeliver = 2\n").solve()
    assert found.delivered
    assert found.completeness is lw.Completeness.SAMPLED
    for design in found.delivered:
        assert 0.0 < design.error <= 0.5
        mechanism = lw.Mechanism(design.linkage)
        for value, wanted in zip(design.inputs, points, strict=True):
            x, y = mechanism.solve(at=value).points["P"]
            assert abs(x + 1j * y - wanted) <= design.error + 1e-6


_SIX = [(0, 0, 0), (60, 40, 15), (120, 60, 30), (190, 60, 50), (250, 40, 70), (300, 0, 95)]


def test_six_poses_are_missed_less_within_a_tolerance_of_their_angles() -> None:
    errors = {}
    for swing in (0.0, 3.0):
        poses = [
            {"point": [x, y], "angle": g, "tolerance": 8.0, "angle_tolerance": swing * (g > 0)}
            for x, y, g in _SIX
        ]
        tables = {"format": 1, "task": "motion", "mechanism": "four-bar", "positions": poses}
        found = lw.Task.loads(write_tables(tables)).solve()
        sound = [design for design in found.designs if not design.kinds]
        errors[swing] = min((d.error for d in sound), default=math.inf), len(sound)
        for design in sound[:8]:
            mechanism = lw.Mechanism(design.linkage)
            turns = []
            for value, (x, y, g) in zip(design.inputs, _SIX, strict=True):
                at = mechanism.solve(at=value).points
                assert abs(complex(*at["P"]) - complex(x, y)) <= design.error + 1e-6 <= 8.0 + 1e-6
                arm = complex(*at["P"]) - complex(*at["A"])
                turns.append(np.degrees(np.angle(arm * np.exp(-1j * np.radians(g)))))
            off = (np.array(turns) - turns[0] + 180.0) % 360.0 - 180.0
            assert np.abs(off).max() <= swing + 1e-6
            assert swing == 0.0 or np.abs(off).max() > 1e-3
    assert errors[3.0][0] < 0.9 * errors[0.0][0]
    assert errors[3.0][1] > errors[0.0][1]


def test_a_pivot_on_the_line_of_a_slider_is_one_point_of_its_file() -> None:
    found = lw.Task.motion([(0, 0, 0), (40, 20, 30)], mechanism="slider-crank").solve()
    own = [one.design for one in found.designs if isinstance(one, SynthesizedDesign)]
    shared = [one for one in own if one.points["A0"] == one.points["S"]]
    assert shared
    for design in shared[:3]:
        linkage = linkage_of(design, found.task, "in line")
        assert linkage.links["ground"] == ("A0", "T")
        assert linkage.sliders[0].line == ("A0", "T")
        position = lw.loads(write_text(linkage)).solve(at=float(np.degrees(design.inputs[0])))
        assert np.allclose(position.points["P"], (0.0, 0.0), atol=1e-9)


@pytest.mark.parametrize("timed", [False, True])
def test_few_poses_are_met_within_their_tolerances(timed: bool) -> None:
    poses = [(0.0, 0.0, 0.0), (40.0, -40.0, 10.0), (100.0, -80.0, 25.0)]

    def solved(reach: float, swing: float) -> lw.synthesis.Synthesis:
        positions = [
            {"point": [x, y], "angle": a, "tolerance": reach, "angle_tolerance": swing}
            | ({"input": 30.0 * k} if timed else {})
            for k, (x, y, a) in enumerate(poses)
        ]
        given = {"fixed_pivots": [[0.0, -200.0]]} | ({} if timed else {"moving_pivots": [[30, 30]]})
        tables = {"task": "motion", "positions": positions, "given": given}
        return lw.Task.loads(write_tables({"format": 1, "mechanism": "four-bar", **tables})).solve()

    exact, near = solved(0.0, 0.0), solved(30.0, 8.0)
    assert len(near.designs) > 20 * len(exact.designs)
    assert "within the tolerances, the exact one first" in near.message
    if not timed:
        assert not exact.delivered
    assert near.delivered
    for design in near.delivered[:8]:
        motion = lw.Mechanism(design.linkage).sweep()
        lead, path = next(iter(motion.inputs.values())), motion.trace("P")
        side = motion.trace("B") - motion.trace("A")
        rows = [int(np.abs(lead - at).argmin()) for at in design.inputs]
        step = np.abs(np.diff(path)).max()
        turns = np.degrees(np.angle(side[rows] / side[rows[0]]))
        for k, (x, y, angle) in enumerate(poses):
            assert abs(path[rows[k]] - complex(x, y)) <= 30.0 + step
            assert abs(turns[k] - angle) <= 2 * 8.0 + 1.0
    assert 0.0 < max(design.error for design in near.designs) <= 30.0
