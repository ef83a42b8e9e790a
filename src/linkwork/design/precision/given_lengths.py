"""Four-bars through positions with given lengths that leave freedoms, or many solutions.

Every four-bar through the positions and some drawn ones is moved along its family: the positions
stay, and the lengths go straight to those that are given. Conditions that are still missing keep
the numbers of the four-bar as they are. So the result is a sample; each four-bar is proved.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from linkwork.design.precision.cognates import exchange_legs
from linkwork.design.precision.four_bar_positions import FourBarPositions
from linkwork.design.precision.linkage_proof import prove_linkages
from linkwork.design.precision.position_equations import HeldValue
from linkwork.design.precision.positions import PrecisionPositions
from linkwork.design.precision.problem import CONDITIONS, PLACES
from linkwork.foundation.arrays import ComplexArray
from linkwork.foundation.stacked_systems import solutions
from linkwork.numerics.homotopy.parameter_path import as_batch
from linkwork.numerics.homotopy.path_tracking import relative_size
from linkwork.numerics.homotopy.polynomial_system import distinct_solutions

__all__ = ["four_bars_with_lengths"]

_STEPS = 16  # of the lengths, each with so many corrections,
_CORRECTIONS = 3
_POLISH = 12  # and at the end
_SETTLED = 1e-9  # relative: the last correction of a solution
_LEAST_SIZE = 0.1  # of the size of the positions: as for other precision positions
_DISTINCT = 1e-6  # relative difference of linkages
_MOST = 400  # four-bars that are moved, and
_PROVED = 120  # those that are proved


def four_bars_with_lengths(
    given: PrecisionPositions,
    found: Sequence[FourBarPositions],
    progress: Callable[[float], None] | None = None,
) -> FourBarPositions:
    """The four-bars with given lengths near those found, at most 120 different ones.

    Parameters
    ----------
    given : PrecisionPositions
        The positions of the task, without drawn ones, and its lengths.
    found : sequence of FourBarPositions
        Four-bars through these positions.
    progress : callable, optional
        Called with the finished fraction; may raise an error to end the work.
    """
    size = given.size
    starts = np.concatenate([_linkages(given, part) / size for part in found])
    if not len(given.pivots):
        # either leg may be the one whose length is given
        starts = np.concatenate([starts, exchange_legs(starts)])
    if len(starts) > _MOST:
        starts = starts[np.linspace(0, len(starts) - 1, _MOST).astype(int)]
    with np.errstate(all="ignore"):
        moved = _moved(given, starts)
    proofs = []
    for k, linkage in enumerate(moved):
        proof = prove_linkages(given, linkage[None] * size, _held(given, linkage))
        proofs.append(FourBarPositions.of(given, proof))
        if progress is not None:
            progress((k + 1) / len(moved))
    if not proofs:
        return found[0].take(np.zeros(0, dtype=np.intp))
    return FourBarPositions.joined(proofs)


def _linkages(given: PrecisionPositions, found: FourBarPositions) -> ComplexArray:
    """x, x̄, a, ā, y, ȳ, b, b̄ of proved four-bars, (B, 8) [length]."""
    first = int(given.order[0])
    pivots = (found.moving_a[:, first], found.fixed_a, found.moving_b[:, first], found.fixed_b)
    from_start = np.stack(pivots, axis=1)[found.proved] - given.start
    whole: ComplexArray = np.stack([from_start, from_start.conj()], axis=2).reshape(-1, CONDITIONS)
    return whole


def _moved(given: PrecisionPositions, linkage: ComplexArray) -> ComplexArray:
    """Different linkages with the lengths, (B, 8), from those that pass the positions."""
    free = list(given.problem.free)
    goal = np.array([entry.length / given.size for entry in given.lengths])
    begin = np.abs(_sides(given, linkage))
    for step in range(1, _STEPS + 1):
        wanted = begin + (goal - begin) * (step / _STEPS)
        for _ in range(_CORRECTIONS if step < _STEPS else _POLISH):
            f, jacobian = _conditions(given, list(wanted.T), linkage)
            # the shortest correction; rows of one size, since their squares are solved
            rows = np.linalg.norm(jacobian, axis=2)
            f, jacobian = f / rows, jacobian / rows[:, :, None]
            across = jacobian.conj().transpose(0, 2, 1)
            change = (across @ solutions(jacobian @ across, f[:, :, None]))[:, :, 0]
            linkage = linkage.copy()
            linkage[:, free] -= change
            # rounding grows where real linkages meet, and would lead to complex ones
            linkage = 0.5 * (linkage + linkage[:, np.arange(CONDITIONS) ^ 1].conj())
    settled = relative_size(change, linkage[:, free], _LEAST_SIZE) < _SETTLED
    kept = linkage[settled]
    good = given.problem.proper(kept[:, free], given.parameters(given.size))
    return distinct_solutions(kept[good], _DISTINCT)[:_PROVED]


def _sides(given: PrecisionPositions, linkage: ComplexArray) -> ComplexArray:
    """The vectors of given lengths, (B, L)."""
    places = {name: linkage[:, k] for name, k in PLACES.items()} | {"P": np.zeros(len(linkage))}
    sides: ComplexArray = np.stack(
        [places[entry.one] - places[entry.other] for entry in given.lengths], axis=1
    ).astype(complex)
    return sides


def _conditions(
    given: PrecisionPositions, wanted: Sequence[Any], linkage: ComplexArray
) -> tuple[ComplexArray, ComplexArray]:
    """What linkages (B, 8) leave of positions and lengths, (B, M), and its slopes (B, M, n)."""
    problem = given.problem
    c = given.parameters(given.size).tolist()
    c[len(c) - len(wanted) :] = [length**2 for length in wanted]
    columns = list(np.ascontiguousarray(linkage[:, list(problem.free)].T))
    f, jacobian, _ = as_batch(len(linkage), problem.equations(columns, c, [0.0] * len(c)))
    return f, jacobian


def _held(given: PrecisionPositions, linkage: ComplexArray) -> tuple[HeldValue, ...]:
    """Coordinates that keep their values so that the others are determined: place, value [length].

    One for each freedom, along which it changes most.
    """
    size = given.size
    _, jacobian = _conditions(given, [x.length / size for x in given.lengths], linkage[None])
    slopes = jacobian[0, :, 0::2]
    real = np.stack([2.0 * slopes.real, -2.0 * slopes.imag], axis=2).reshape(len(slopes), -1)
    _, _, right = np.linalg.svd(real)
    null = right[len(slopes) :].T.copy()
    values = linkage[list(given.problem.free)][0::2] * size
    found = []
    for _ in range(null.shape[1]):
        place = int(np.linalg.norm(null, axis=1).argmax())
        z = values[place // 2]
        found.append((place, float(z.imag if place % 2 else z.real)))
        along = null[place] / np.linalg.norm(null[place])
        null -= np.outer(null @ along, along)
    return tuple(found)
