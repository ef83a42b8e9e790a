"""Every operation of the machine against NumPy, sine and cosine against ball arithmetic."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import numpy.typing as npt
import pytest
from flint import arb, ctx

from linkwork.core.record.recorder import LANES, Op
from linkwork.families.compiled.interpreter import run

Array = npt.NDArray[np.float64]
ODD = (0.0, -0.0, 1.0, -1.0, 2.5, -3.75, 1e-300, 1e300, math.inf, -math.inf, math.nan)


def done(op: Op, *sources: Array) -> Array:
    """What an operation leaves, lane by lane; for a sine its cosine as well, (2, M)."""
    count = len(sources[0])
    found = np.empty((2, count))
    target = len(sources)
    registers = [*range(len(sources)), *[target] * (3 - len(sources))]
    if op is Op.SIN:
        registers[2] = target + 1
    code = np.array([[op, target, *registers]], dtype=np.uint32)
    for first in range(0, count, LANES):
        here = slice(first, min(first + LANES, count))
        space = np.zeros((target + 2, LANES))
        for k, values in enumerate(sources):
            space[k, : here.stop - first] = values[here]
        run(code, space)
        found[:, here] = space[target:, : here.stop - first]
    return found if op is Op.SIN else found[0]


def triples() -> tuple[Array, Array, Array]:
    """Everything odd with everything odd."""
    a, b, c = np.meshgrid(ODD, ODD, ODD)
    return a.ravel(), b.ravel(), c.ravel()


MEANING: dict[Op, tuple[int, Callable[..., Array]]] = {
    Op.COPY: (1, lambda a: a),
    Op.ADD: (2, np.add),
    Op.SUB: (2, np.subtract),
    Op.MUL: (2, np.multiply),
    Op.DIV: (2, np.divide),
    Op.NEG: (1, np.negative),
    Op.ABS: (1, np.abs),
    Op.MAX: (2, np.maximum),  # of NumPy's two kinds that which passes on what is not a number
    Op.MIN: (2, np.minimum),
    Op.SQRT: (1, np.sqrt),
    Op.LE: (2, lambda a, b: np.where(a <= b, 1.0, 0.0)),
}


@pytest.mark.parametrize("op", MEANING, ids=lambda op: op.name)
def test_operations_do_what_numpy_does_with_odd_numbers_too(op: Op) -> None:
    count, meaning = MEANING[op]
    sources = triples()[:count]
    with np.errstate(all="ignore"):
        np.testing.assert_array_equal(done(op, *sources), meaning(*sources))


@pytest.mark.parametrize(
    ("op", "meaning"),
    [
        (Op.FMA, lambda a, b, c: a * b + c),
        (Op.FMS, lambda a, b, c: a * b - c),
        (Op.FNMA, lambda a, b, c: c - a * b),
    ],
    ids=["FMA", "FMS", "FNMA"],
)
def test_products_in_sums_round_once_or_twice(op: Op, meaning: Callable[..., Array]) -> None:
    rng = np.random.default_rng(1)
    a, b, c = rng.normal(size=(3, 1000))
    size = np.abs(a * b) + np.abs(c)
    assert (np.abs(done(op, a, b, c) - meaning(a, b, c)) <= 2.0**-52 * size).all()
    a, b, c = triples()
    with np.errstate(all="ignore"):
        expected, found = meaning(a, b, c), done(op, a, b, c)
        large = np.abs(a * b) == math.inf  # a product that overflows only if it is rounded
    fused = large & np.isfinite(a) & np.isfinite(b)
    np.testing.assert_allclose(found[~fused], expected[~fused], rtol=1e-15, atol=1e-16)


def test_masks() -> None:
    a, b, c = triples()
    np.testing.assert_array_equal(done(Op.WHERE, np.ones_like(a), b, c), b)
    np.testing.assert_array_equal(done(Op.WHERE, np.zeros_like(a), b, c), c)
    np.testing.assert_array_equal(done(Op.WHERE, np.full_like(a, np.nan), b, c), c)
    x, y = (part.ravel() for part in np.meshgrid([0.0, 1.0], [0.0, 1.0]))
    np.testing.assert_array_equal(done(Op.AND, x, y), np.minimum(x, y))


def test_operations_may_write_over_what_they_read() -> None:
    rng = np.random.default_rng(2)
    a = rng.normal(size=(3, LANES))
    for row, expected in (
        ([Op.FMA, 0, 0, 1, 2], a[0] * a[1] + a[2]),
        ([Op.SUB, 1, 0, 1, 1], a[0] - a[1]),
        ([Op.WHERE, 2, 0, 1, 2], np.where(a[0] > 0.5, a[1], a[2])),
    ):
        space = a.copy()
        run(np.array([row], dtype=np.uint32), space)
        np.testing.assert_allclose(space[row[1]], expected, rtol=0, atol=1e-15)


def near_quarters(rng: np.random.Generator, count: int) -> Array:
    """Floats next to multiples of π/4 up to a million."""
    ctx.prec = 200
    quarters = [
        float((arb.pi() / 4 * int(k)).mid()) for k in rng.integers(-1270000, 1270000, count)
    ]
    x = np.array(quarters)
    moved = x + rng.choice([-1.0, 0.0, 1.0], count) * np.spacing(np.abs(x))
    return np.where(rng.random(count) < 0.8, moved, x + 1e-6 * rng.normal(size=count))


@pytest.mark.parametrize("kind", ["any", "small", "scales", "near multiples of π/4"])
def test_sine_and_cosine_are_as_exact_as_they_claim(kind: str) -> None:
    rng = np.random.default_rng(3)
    x = {
        "any": rng.uniform(-1e6, 1e6, 4000),
        "small": rng.uniform(-4.0, 4.0, 4000),
        "scales": 10.0 ** rng.uniform(-300, 6, 4000) * rng.choice([-1, 1], 4000),
        "near multiples of π/4": near_quarters(rng, 4000),
    }[kind]
    ctx.prec = 200
    worst = worst_places = 0.0
    for angle, pair in zip(x, done(Op.SIN, x).T, strict=True):
        exact = arb(float(angle))
        for value, true in zip(pair, (exact.sin(), exact.cos()), strict=True):
            off = float(abs(true - arb(float(value))).mid())
            worst = max(worst, off)
            worst_places = max(worst_places, off / float(np.spacing(abs(value))))
    assert worst < 2.5 * 2.0**-53
    assert worst_places < 3.0


def test_sine_and_cosine_of_what_is_too_large_are_not_numbers() -> None:
    large = np.array([2e6, -1e7, 1e15, 1e300, math.inf, -math.inf, math.nan])
    assert np.isnan(done(Op.SIN, large)).all()
    np.testing.assert_array_equal(done(Op.SIN, np.zeros(1))[:, 0], [0.0, 1.0])
