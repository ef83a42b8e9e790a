"""What holds for every mechanism, whatever its dimensions."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations

import numpy as np
import numpy.typing as npt
import pytest

import linkwork as lw
from linkwork.core.foundation.units import AngleUnit
from linkwork.core.mechanism.linkage import Linkage
from linkwork.core.mechanism.part.index import PARTS
from linkwork.core.results.motion import table_of
from linkwork.core.results.quantity import Kind
from tests.core.laws.agreement import CLOSE, agree, angles_of, internal, series_of
from tests.core.laws.mechanisms import NAMES, mechanism_of, motion_of, size_of
from tests.core.laws.transforms import mirrored, scaled, turned
from tests.thinned import thinned

Array = npt.NDArray[np.float64]
every = pytest.mark.parametrize("name", thinned(NAMES, 3))


@every
def test_every_row_closes_its_loops(name: str) -> None:
    motion = motion_of(name)
    assert motion.found.sum() > 20  # rockers swing through as little as 26°
    assert motion.residual[motion.found].max() <= 1e-12


@every
def test_distances_between_points_of_one_link_hold_over_the_cycle(name: str) -> None:
    mechanism, motion = mechanism_of(name), motion_of(name)
    description = mechanism.description
    checked = 0
    for points in getattr(description, "links", {}).values():
        for a, b in combinations(points, 2):
            span = np.abs(motion.trace(a) - motion.trace(b))[motion.found]
            wanted = span[0]
            if isinstance(description, Linkage):
                given = description.lengths.get(f"{a} {b}", description.lengths.get(f"{b} {a}"))
                wanted = wanted if given is None else description.numbers(given)
            # 1e-12 of the longest link: closure errors pass from loop to loop
            np.testing.assert_allclose(span, wanted, rtol=0, atol=1e-12 * size_of(mechanism))
            checked += 1
    assert checked


@every
def test_the_mirrored_mechanism_has_the_mirrored_motion(name: str) -> None:
    one, other = motion_of(name), mirrored(mechanism_of(name)).sweep()
    agree(one, other, -1.0, 0.0, 1.0)
    after = angles_of(other)
    for angle, before in angles_of(one).items():
        np.testing.assert_allclose(
            np.exp(1j * after[angle]), np.exp(-1j * before), rtol=0, atol=CLOSE
        )


#: Wheels and cams without a direction of their own, and phases, are counted from ground's x axis.
UNTURNED = frozenset(
    name
    for name in NAMES
    if any(getattr(mechanism_of(name).description, kind, ()) for kind in list(PARTS)[3:])
)
#: The third derivative of a spline jumps; Dixon's bars change too fast for these steps.
UNEVEN = frozenset(
    {"curved-slot", "dixon-one", "dixon-two", "eccentric-cam", "garage-door", "oval-gears"}
)


@pytest.mark.parametrize("name", [name for name in NAMES if name not in UNTURNED])
def test_the_turned_mechanism_has_the_turned_motion(name: str) -> None:
    turn = 0.7
    agree(motion_of(name), turned(mechanism_of(name), turn).sweep(), 1.0, turn, 1.0)


@every
@pytest.mark.parametrize("factor", thinned([0.003, 2500.0]))
def test_the_scaled_mechanism_has_the_same_angles(name: str, factor: float) -> None:
    one, other = motion_of(name), scaled(mechanism_of(name), factor).sweep()
    agree(one, other, 1.0, 0.0, factor)
    after = angles_of(other)
    for angle, before in angles_of(one).items():
        np.testing.assert_allclose(
            np.exp(1j * after[angle]), np.exp(1j * before), rtol=0, atol=CLOSE
        )


def along(name: str, start: float, stop: float, step: float) -> lw.Motion:
    """A sweep over these values of the first input; further inputs move along with it."""
    mechanism, motion = mechanism_of(name), motion_of(name)
    given = [values[motion.asked] for values in motion.inputs.values()]
    if len(given) == 1:
        return mechanism.sweep(from_=start, to=stop, step=step)
    inputs = []
    for which, values in zip(mechanism.description.inputs, given, strict=True):
        rate = (values[1] - values[0]) / (given[0][1] - given[0][0])
        first, last = (values[0] + rate * (at - given[0][0]) for at in (start, stop))
        inputs.append(replace(which, from_=first, to=last, step=(step * rate) or None))
    return mechanism.changed(inputs=tuple(inputs)).sweep()


@every
def test_the_reversed_sweep_retraces(name: str) -> None:
    forth = motion_of(name)
    values = next(iter(forth.inputs.values()))
    back = along(name, values[-1], values[0], values[0] - values[1])
    assert back.status == forth.status[::-1]
    for one, other in zip(series_of(forth), series_of(back), strict=True):
        scale = max(1.0, float(np.nanmax(np.abs(one.value))))
        np.testing.assert_allclose(other.value[::-1], one.value, rtol=0, atol=1e-10 * scale)
        scale = max(1.0, float(np.nanmax(np.abs(one.first))))
        np.testing.assert_allclose(other.first[::-1], one.first, rtol=0, atol=1e-9 * scale)


# central difference of eighth order
SLOPE = np.array([1 / 280, -4 / 105, 1 / 5, -4 / 5, 0, 4 / 5, -1 / 5, 4 / 105, -1 / 280])


def inner_rows(motion: lw.Motion, seed: int) -> list[int]:
    """Five rows of the table, each with five found neighbours of the table at both sides."""
    found = motion.found & motion.asked
    inner = [k for k in range(5, len(motion) - 5) if found[k - 5 : k + 6].all()]
    rng = np.random.default_rng(seed)
    return [int(k) for k in rng.choice(inner, size=5, replace=False)]


@pytest.mark.parametrize("name", thinned(name for name in NAMES if name not in UNEVEN))
def test_derivatives_are_the_slopes_of_the_sweep(name: str) -> None:
    mechanism, motion = mechanism_of(name), motion_of(name)
    values = next(iter(motion.inputs.values()))
    kind = mechanism.loop_equations.inputs[0].kind
    unit = motion.units.scale(Kind(kind))
    # 0.2°, or a thousandth of the longest link: h⁸ is 2e-20, rounding is divided by h
    h = 1e-3 * size_of(mechanism) if kind == "length" else 3.5e-3 / unit
    for row in inner_rows(motion, seed=7):
        window = along(name, values[row] - 4 * h, values[row] + 4 * h, h)
        assert len(window) == 9
        assert window.found.all()
        for series in series_of(window):
            scale = max(1.0, float(np.abs(internal(window, series)).max()))
            scale *= max(1.0, float(np.abs(window.condition).max()))
            for lower, higher in (
                (internal(window, series), series.first),
                (series.first, series.second),
            ):
                # values of regular positions carry rounding of about 1e-15 times the condition
                steps = h * unit
                tolerance = 1e-12 * scale / steps + 1e-9 * float(np.abs(higher).max())
                assert SLOPE @ lower / steps == pytest.approx(higher[4], rel=0, abs=tolerance), (
                    series.quantity.name
                )


@every
def test_one_position_equals_its_row(name: str) -> None:
    mechanism, motion = mechanism_of(name), motion_of(name)
    row = inner_rows(motion, seed=8)[0]
    position = mechanism.solve({which: values[row] for which, values in motion.inputs.items()})
    assert position.status is lw.Status.CONVERGED
    assert position.residual <= 1e-12
    for point, (x, y) in position.points.items():
        assert complex(x, y) == pytest.approx(
            complex(motion.trace(point)[row]), rel=0, abs=CLOSE * size_of(mechanism)
        )
    for series in series_of(motion):
        key = series.quantity.name
        scale = max(1.0, float(np.nanmax(np.abs(series.first))))
        assert position.first[key] == pytest.approx(series.first[row], rel=0, abs=1e-9 * scale)
        scale = max(1.0, float(np.nanmax(np.abs(series.second))))
        assert position.second[key] == pytest.approx(series.second[row], rel=0, abs=1e-8 * scale)


SPEEDS = {"four-bar": 25.0, "crank-slider": -30.0, "four-bar 3": 2.0, "slider-crank 1": 2 * np.pi}


@pytest.mark.parametrize("name", SPEEDS)
def test_velocity_is_the_derivative_times_the_speed(name: str) -> None:
    motion, speed = motion_of(name), SPEEDS[name]
    table = table_of(motion)
    named = {
        s.quantity.name: s for s in series_of(motion) if f"{s.quantity.name}.d1" in table.columns
    }
    assert set(motion.unknowns) <= set(named)
    for key, series in named.items():
        np.testing.assert_array_equal(table[f"{key}.d1"], series.first)
        np.testing.assert_array_equal(table[f"{key}.d2"], series.second)
        np.testing.assert_allclose(table[f"{key}.velocity"], speed * series.first, rtol=1e-15)
        np.testing.assert_allclose(
            table[f"{key}.acceleration"], speed**2 * series.second, rtol=1e-15
        )
    (values,) = motion.inputs.values()
    row = inner_rows(motion, seed=9)[0]
    position = mechanism_of(name).solve(values[row])
    for key in position.first:
        assert position.velocity[key] == pytest.approx(speed * position.first[key], rel=1e-15)
        assert position.acceleration[key] == pytest.approx(
            speed**2 * position.second[key], rel=1e-15
        )


def test_without_a_speed_there_are_no_velocities() -> None:
    motion = motion_of("rapier-drive")
    assert motion.speed is None
    assert not any(key.endswith((".velocity", ".acceleration")) for key in table_of(motion).columns)
    assert dict(mechanism_of("rapier-drive").solve().velocity) == {}


def test_both_angle_units_are_among_the_mechanisms() -> None:
    units = {mechanism_of(name).description.angle for name in NAMES}
    assert units == {AngleUnit.DEGREE, AngleUnit.RADIAN}
