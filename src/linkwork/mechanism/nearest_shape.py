"""The shape of a link that has given dimensions and is nearest to its sketch."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import combinations

import numpy as np

from linkwork.foundation.elementwise import choose, detached, everywhere, largest, vector
from linkwork.foundation.lanes import Rest, is_batched, rest_of
from linkwork.foundation.precise import Precise
from linkwork.foundation.rounding import EPSILON
from linkwork.mechanism.least_norm import independent, least_norm
from linkwork.mechanism.link_dimension import (
    AGREE,
    Distance,
    Given,
    ShapeError,
    VertexAngle,
    compared,
    fits,
)

__all__ = ["REDUNDANT", "nearest_shape"]

#: Relative, or [rad]: by how much a redundant dimension may differ from what the others give.
REDUNDANT = 1e-14
_HELD = 2.0 * EPSILON  # the same of dimensions that determine the shape: their rounding

_MOST_STEPS = 60
_POLISHES = 3
_SMALL = 1e-10  # relative: Newton's last step
_FIRST_STEPS = 6  # most shapes need four


def nearest_shape(
    points: tuple[str, ...], exact: Mapping[str, Precise], rows: Sequence[Given]
) -> tuple[dict[str, Precise], list[Distance]]:
    """Solve the dimensions together, nearest to the sketch; measure there what they leave open.

    Those that follow from others in whatever place the points are, are compared only.
    """
    sketch = {p: place.high for p, place in exact.items()}
    # the sketch selects a shape; only what is measured in it enters its dimensions
    start = {p: detached(sketch[p]) for p in points}
    given = rows
    rows, missing = _determining(points, given)
    held = _detached(rows)
    placed = _gauss_newton(start, held, _MOST_STEPS)
    varies = any(own is not row for own, row in zip(held, rows, strict=True))
    if missing:
        placed = _nearest(placed, sketch, held, rows)
    elif varies:
        # one exact step from the solution has its derivatives (implicit function theorem)
        errors = [row.error(placed) for row in rows]
        placed = _moved(placed, least_norm(_slopes(placed, held), errors))
    found = {p: Precise(place) for p, place in placed.items()}
    wrong = [row for row in rows if not row.agrees(placed, AGREE)]
    if not wrong:
        found = _polished(placed, rows) if rows else dict(exact)
        wrong = [row for row in rows if not fits(row, found, _HELD)]
        wrong += [row for row in given if not fits(row, found, _explained(row, placed, rows))]
    if wrong:
        raise ShapeError(
            "no link has these dimensions near the sketch; "
            f"nearest has {compared(wrong[0], found)}",
            wrong[0].table,
            wrong[0].key,
        )
    return found, [Distance(a, b, abs(found[b] - found[a]).high) for a, b in missing]


def _explained(row: Given, z: Mapping[str, complex], held: Sequence[Given]) -> float:
    """By how much rounding of the dimensions that determine a shape changes another one."""
    if any(map(is_batched, z.values())):
        return REDUNDANT
    follows = np.array(_slopes(z, [row])[0]) @ np.linalg.pinv(np.array(_slopes(z, held)))
    return REDUNDANT + 4.0 * _HELD * float(np.abs(follows).sum())


def _polished(z: Mapping[str, complex], rows: Sequence[Given]) -> dict[str, Precise]:
    """The points of a shape that satisfies all rows to rounding, as exact as these are."""
    found = {p: Precise(place) for p, place in z.items()}
    if not all(place.has_rest for place in found.values()):
        return found
    slopes = _slopes(z, rows)
    for _ in range(_POLISHES):
        errors = [row.precise_error(found).high for row in rows]
        step = _moved(dict.fromkeys(z, 0j), least_norm(slopes, errors))
        found = {p: place + step[p] for p, place in found.items()}
    return found


def _determining(
    points: tuple[str, ...], rows: Sequence[Given]
) -> tuple[list[Given], list[tuple[str, str]]]:
    """The rows that do not follow from those before, and pairs whose distances complete them, in
    whatever place the points of a link are.
    """
    places = np.random.default_rng(len(points)).normal(size=(len(points), 2)) @ [1.0, 1j]
    z = dict(zip(points, map(complex, places), strict=True))
    across = {frozenset((row.a, row.b)) for row in rows if isinstance(row, VertexAngle)}
    pairs = sorted(combinations(points, 2), key=lambda pair: frozenset(pair) in across)
    unit = [Distance(row.a, row.b, 1.0) if isinstance(row, Distance) else row for row in rows]
    candidates = [Distance(a, b, 1.0) for a, b in pairs]
    found = independent(_slopes(z, [*unit, *candidates]))
    held = [rows[k] for k in found if k < len(rows)]
    return held, [pairs[k - len(rows)] for k in found if k >= len(rows)]


def _nearest(
    z: dict[str, complex],
    sketch: Mapping[str, complex],
    held: Sequence[Given],
    rows: Sequence[Given],
) -> dict[str, complex]:
    """The shape with given dimensions whose points are nearest to the sketched ones.

    Newton's method for the least sum of squares under conditions: the points, and a multiplier for
    every dimension. ``held``: the rows without derivatives.
    """
    size = largest(abs(z[b] - z[a]) for a, b in combinations(z, 2))
    weights: Sequence[float] = [0.0] * len(rows)
    small = False
    for _ in range(_MOST_STEPS):
        start = {p: detached(sketch[p]) for p in z}
        step = _lagrange_step(z, start, held, held, weights, size)
        moved = _moved(z, step)
        z = {p: choose(small, place, moved[p]) for p, place in z.items()}
        weights = [w - change for w, change in zip(weights, step[2 * len(z) :], strict=True)]
        # the error after a step is about its square
        small = largest(map(abs, step[: 2 * len(z)])) <= _SMALL * size
        if everywhere(small):
            # one exact step from the solution has its derivatives (implicit function theorem)
            return _moved(z, _lagrange_step(z, sketch, held, rows, weights, size))
    raise np.linalg.LinAlgError


def _lagrange_step(
    z: Mapping[str, complex],
    sketch: Mapping[str, complex],
    held: Sequence[Given],
    rows: Sequence[Given],
    weights: Sequence[float],
    size: float,
) -> Sequence[float]:
    """Newton's step of x, y and multipliers, to be subtracted.

    Stationary: z - sketch + Σ w ∇(size · error) = 0; dimensions: size · error = 0.
    """
    count, many = 2 * len(z), len(rows)
    slopes = [[size * slope for slope in row] for row in _slopes(z, held)]
    bend = _bend(z, held, [size * w for w in weights])
    matrix = [[*bend[k], *(row[k] for row in slopes)] for k in range(count)]
    matrix += [[*row, *[0.0] * many] for row in slopes]
    pull = _slopes(z, rows)
    away = [z[p] - sketch[p] for p in z]
    right = [d.real for d in away] + [d.imag for d in away]
    for k, w in enumerate(weights):
        right = [r + size * w * slope for r, slope in zip(right, pull[k], strict=True)]
    return least_norm(matrix, [*right, *(size * row.error(z) for row in rows)])


def _bend(
    z: Mapping[str, complex], rows: Sequence[Given], weights: Sequence[float]
) -> list[list[float]]:
    """The identity plus the second derivatives of weighted errors, x then y: 2n rows of 2n."""
    names, count = list(z), len(z)
    found = [[float(i == k) for k in range(2 * count)] for i in range(2 * count)]
    for row, weight in zip(rows, weights, strict=True):
        for point in row.points:
            for axis, unit in ((0, 1.0 + 0j), (count, 1j)):
                for other, change in row.bend(z, point, unit).items():
                    i, k = names.index(other), names.index(point) + axis
                    found[i][k] = found[i][k] + weight * change.real
                    found[i + count][k] = found[i + count][k] + weight * change.imag
    return found


def _gauss_newton(
    z: dict[str, complex], rows: Sequence[Given], steps: int, first: int = _FIRST_STEPS
) -> dict[str, complex]:
    """Points that satisfy all rows, or the result of the last step.

    Designs that have not converged after ``first`` steps continue separately.
    """
    for k in range(steps):
        errors = [row.error(z) for row in rows]
        done = largest(abs(error) for error in errors) <= 1e-14
        if everywhere(done):
            break
        # in a family most designs need few steps: the others continue separately
        if k == first and (rest := rest_of(done)) is not None:
            return _gone_on(z, rows, steps - k, rest)
        moved = _moved(z, least_norm(_slopes(z, rows), errors))
        z = {p: choose(done, place, moved[p]) for p, place in z.items()}
    return z


def _moved(z: Mapping[str, complex], step: Sequence[float]) -> dict[str, complex]:
    """Points less a step of their coordinates, x then y."""
    count = len(z)
    return {p: place - vector(step[k], step[k + count]) for k, (p, place) in enumerate(z.items())}


def _detached(rows: Sequence[Given]) -> list[Given]:
    """Dimensions without the derivatives of their numbers."""
    return [row.detached() for row in rows]


def _gone_on(
    z: Mapping[str, complex], rows: Sequence[Given], steps: int, rest: Rest
) -> dict[str, complex]:
    """Further steps of the designs that have not converged."""
    own = {point: rest.narrow(place) for point, place in z.items()}
    try:
        found = _gauss_newton(own, [row.narrow(rest) for row in rows], steps, first=steps)
    finally:
        rest.leave()
    return {point: rest.widen(place, found[point]) for point, place in z.items()}


def _slopes(z: Mapping[str, complex], rows: Sequence[Given]) -> list[list[float]]:
    """Derivatives of the rows' errors with respect to all coordinates, x then y: rows of 2n."""
    found = []
    for row in rows:
        by = row.gradients(z)
        at = [by.get(point, 0j) for point in z]
        found.append([g.real for g in at] + [g.imag for g in at])
    return found
