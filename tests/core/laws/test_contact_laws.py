"""What holds for every weld, gear, belt, rack, rolling wheel, cam and curve."""

from __future__ import annotations

from functools import cache
from itertools import combinations

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

import linkwork as lw
from linkwork.core.mechanism.linkage import Linkage
from tests.core.laws.agreement import CLOSE, agree, angles_of, internal, series_of
from tests.core.laws.contacts import KINDS, contact
from tests.core.laws.transforms import mirrored, scaled
from tests.thinned import thinned

seeds = st.integers(0, 10**6)
every = pytest.mark.parametrize("kind", thinned(KINDS, 4))
some = settings(max_examples=3)


@cache
def motion_of(kind: str, seed: int) -> lw.Motion:
    return contact(kind, seed).sweep()


@every
@some
@given(seed=seeds)
def test_every_row_is_found_and_proved_and_closes_its_loops(kind: str, seed: int) -> None:
    motion = motion_of(kind, seed)
    assert motion.found.all()
    assert motion.certified.all()
    assert motion.residual.max() <= 1e-12
    # a radius that says something: 1e-9 of the longest link or of a radian
    size = contact(kind, seed).loop_equations.length_scale
    assert motion.radius.max() < 1e-9 * max(1.0, size)


@every
@some
@given(seed=seeds)
def test_distances_inside_a_link_hold(kind: str, seed: int) -> None:
    mechanism, motion = contact(kind, seed), motion_of(kind, seed)
    description = mechanism.description
    assert isinstance(description, Linkage)
    size = mechanism.loop_equations.length_scale
    for link, points in description.links.items():
        for a, b in combinations(points, 2):
            span = np.abs(motion.trace(a) - motion.trace(b))
            local = description.shapes.local[link]
            wanted = abs(local[a] - local[b])
            np.testing.assert_allclose(span, wanted, rtol=0, atol=1e-11 * size)


@every
@some
@given(seed=seeds)
def test_the_mirrored_mechanism_has_the_mirrored_motion(kind: str, seed: int) -> None:
    one, other = motion_of(kind, seed), mirrored(contact(kind, seed)).sweep()
    agree(one, other, -1.0, 0.0, 1.0)
    after = angles_of(other)
    for angle, before in angles_of(one).items():
        np.testing.assert_allclose(
            np.exp(1j * after[angle]), np.exp(-1j * before), rtol=0, atol=CLOSE
        )


@every
@some
@given(seed=seeds, factor=st.sampled_from([0.003, 2500.0]))
def test_the_scaled_mechanism_has_the_same_angles(kind: str, seed: int, factor: float) -> None:
    one, other = motion_of(kind, seed), scaled(contact(kind, seed), factor).sweep()
    agree(one, other, 1.0, 0.0, factor)
    after = angles_of(other)
    for angle, before in angles_of(one).items():
        np.testing.assert_allclose(
            np.exp(1j * after[angle]), np.exp(1j * before), rtol=0, atol=CLOSE
        )


@every
@some
@given(seed=seeds)
def test_the_reversed_sweep_retraces(kind: str, seed: int) -> None:
    forth = motion_of(kind, seed)
    (values,) = forth.inputs.values()
    back = contact(kind, seed).sweep(from_=values[-1], to=values[0], step=values[0] - values[1])
    assert back.status == forth.status[::-1]
    for one, other in zip(series_of(forth), series_of(back), strict=True):
        scale = max(1.0, float(np.nanmax(np.abs(one.value))))
        np.testing.assert_allclose(other.value[::-1], one.value, rtol=0, atol=1e-10 * scale)
        scale = max(1.0, float(np.nanmax(np.abs(one.first))))
        np.testing.assert_allclose(other.first[::-1], one.first, rtol=0, atol=1e-9 * scale)


@every
@some
@given(seed=seeds, part=st.floats(0.02, 0.98))
def test_derivatives_are_the_slopes_of_the_sweep(kind: str, seed: int, part: float) -> None:
    """Second order only: laws and splines have jumps in their third derivatives."""
    mechanism = contact(kind, seed)
    (values,) = motion_of(kind, seed).inputs.values()
    middle = float(values[0] + part * (values[-1] - values[0]))
    h = 0.01  # degrees
    window = mechanism.sweep(from_=middle - h, to=middle + h, step=h)
    assert window.found.all()
    steps = np.radians(h)
    for series in series_of(window):
        value = internal(window, series)
        size = 1.0 + float(
            np.abs(value).max() + np.abs(series.first).max() + np.abs(series.second).max()
        )
        slope = (value[2] - value[0]) / (2 * steps)
        bend = (series.first[2] - series.first[0]) / (2 * steps)
        # h² times third derivatives up to 200 of the size; rounding is 1e-13/h
        assert slope == pytest.approx(series.first[1], rel=0, abs=1e-5 * size)
        assert bend == pytest.approx(series.second[1], rel=0, abs=2e-2 * size)


@every
@some
@given(seed=seeds)
def test_the_jacobian_is_that_of_the_differences(kind: str, seed: int) -> None:
    table = contact(kind, seed).model.compiled.table
    rng = np.random.default_rng(seed)
    motion = motion_of(kind, seed)
    v = np.concatenate([motion.q[:1], contact(kind, seed).model.rows[:1]], axis=1)
    v = v + 0.01 * rng.normal(size=v.shape)
    jacobian = table.jacobian(v)[0]
    for k in range(table.variables):
        h = 1e-5 * table.variable_scale[k]
        step = np.zeros_like(v)
        step[0, k] = h
        slope = (table.residual(v + step) - table.residual(v - step))[0] / (2 * h)
        # lengths here are tens: second differences of splines and laws are below 1e4
        np.testing.assert_allclose(
            jacobian[:, k], slope, rtol=1e-6, atol=1e-5 * (1 + np.abs(jacobian[:, k]).max())
        )


@every
@some
@given(seed=seeds)
def test_one_position_equals_its_row(kind: str, seed: int) -> None:
    motion = motion_of(kind, seed)
    (values,) = motion.inputs.values()
    row = int(np.random.default_rng(seed).integers(len(values)))
    position = contact(kind, seed).solve(values[row])
    assert position.status is lw.Status.CONVERGED
    size = contact(kind, seed).loop_equations.length_scale
    for point, (x, y) in position.points.items():
        assert complex(x, y) == pytest.approx(
            complex(motion.trace(point)[row]), rel=0, abs=CLOSE * size
        )
