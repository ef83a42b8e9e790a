"""Four-bars through positions with given lengths that leave freedoms, or many solutions.

Every four-bar through the positions and some drawn ones is moved along its family: the positions
stay, and the lengths go straight to those that are given. Conditions that are still missing keep
the numbers of the four-bar as they are. So the result is a sample; each four-bar is proved.
"""

from __future__ import annotations

import zipfile
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from linkwork.circuits.homotopy.bilinear_homotopy import distinct_solutions
from linkwork.circuits.homotopy.monodromy import Member, solve_and_confirm
from linkwork.circuits.homotopy.path_tracking import (
    ParameterPath,
    PathOptions,
    Paths,
    as_batch,
    relative_size,
)
from linkwork.core.foundation.arrays import ComplexArray, solutions
from linkwork.core.foundation.files import cache_folder, keep_arrays
from linkwork.synthesis.loops.limits import Candidates
from linkwork.synthesis.precision.positions import HeldValue, PrecisionPositions, prove_linkages
from linkwork.synthesis.precision.problem import CONDITIONS, PLACES, PrecisionProblem, exchange_legs
from linkwork.synthesis.precision.solving import (
    PrecisionFourBars,
    SparingTracker,
    as_arrays,
    compiled_pays,
    four_bars_of,
    member_of_arrays,
)

_STEPS = 16  # of the lengths, each with so many corrections,
_CORRECTIONS = 3
_POLISH = 12  # and at the end
_SETTLED = 1e-9  # relative: the last correction of a solution
_LEAST_SIZE = 0.1  # of the size of the positions: as for other precision positions
_DISTINCT = 1e-6  # relative difference of linkages
_MOST_STARTS = 400  # four-bars that are moved, and
_PROVED = 120  # those that are proved


def four_bars_with_lengths(
    positions: PrecisionPositions,
    solved: Sequence[PrecisionFourBars],
    progress: Callable[[float], None] | None = None,
) -> Candidates:
    """The four-bars with given lengths near solved ones, at most 120 different ones.

    Parameters
    ----------
    positions : PrecisionPositions
        The positions of the task, without drawn ones, and its lengths.
    solved : sequence of PrecisionFourBars
        Four-bars through these positions.
    progress : callable, optional
        Called with the finished fraction; may raise an error to end the work.
    """
    size = positions.size
    starts = np.concatenate([_linkages(positions, part) / size for part in solved])
    if not len(positions.pivots):
        # either leg may be the one whose length is given
        starts = np.concatenate([starts, exchange_legs(starts)])
    if len(starts) > _MOST_STARTS:
        starts = starts[np.linspace(0, len(starts) - 1, _MOST_STARTS).astype(int)]
    with np.errstate(all="ignore"):
        moved = _moved(positions, starts)
    proofs = []
    for k, linkage in enumerate(moved):
        proof = prove_linkages(positions, linkage[None] * size, _held(positions, linkage))
        proofs.append(four_bars_of(positions, proof))
        if progress is not None:
            progress((k + 1) / len(moved))
    if not proofs:
        return solved[0].take(np.zeros(0, dtype=np.intp))
    return Candidates.joined(proofs)


def _linkages(positions: PrecisionPositions, bars: PrecisionFourBars) -> ComplexArray:
    """x, x̄, a, ā, y, ȳ, b, b̄ of proved four-bars, (B, 8) [length]."""
    first = int(positions.order[0])
    pivots = (bars.moving_a[:, first], bars.fixed_a, bars.moving_b[:, first], bars.fixed_b)
    from_start = np.stack(pivots, axis=1)[bars.proved] - positions.start
    whole: ComplexArray = np.stack([from_start, from_start.conj()], axis=2).reshape(-1, CONDITIONS)
    return whole


def _moved(positions: PrecisionPositions, linkage: ComplexArray) -> ComplexArray:
    """Different linkages with the lengths, (B, 8), from those that pass the positions."""
    free = list(positions.problem.free)
    goal = np.array([entry.length / positions.size for entry in positions.lengths])
    begin = np.abs(_sides(positions, linkage))
    for step in range(1, _STEPS + 1):
        lengths = begin + (goal - begin) * (step / _STEPS)
        for _ in range(_CORRECTIONS if step < _STEPS else _POLISH):
            f, jacobian = _conditions(positions, list(lengths.T), linkage)
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
    good = positions.problem.proper(kept[:, free], positions.parameters(positions.size))
    return distinct_solutions(kept[good], _DISTINCT)[:_PROVED]


def _sides(positions: PrecisionPositions, linkage: ComplexArray) -> ComplexArray:
    """The vectors of given lengths, (B, L)."""
    places = {name: linkage[:, k] for name, k in PLACES.items()} | {"P": np.zeros(len(linkage))}
    sides: ComplexArray = np.stack(
        [places[entry.one] - places[entry.other] for entry in positions.lengths], axis=1
    ).astype(complex)
    return sides


def _conditions(
    positions: PrecisionPositions, lengths: Sequence[Any], linkage: ComplexArray
) -> tuple[ComplexArray, ComplexArray]:
    """What linkages (B, 8) leave of positions and lengths, (B, M), and its slopes (B, M, n)."""
    problem = positions.problem
    c = positions.parameters(positions.size).tolist()
    c[len(c) - len(lengths) :] = [length**2 for length in lengths]
    columns = list(np.ascontiguousarray(linkage[:, list(problem.free)].T))
    f, jacobian, _ = as_batch(len(linkage), problem.equations(columns, c, [0.0] * len(c)))
    return f, jacobian


def _held(task: PrecisionPositions, linkage: ComplexArray) -> tuple[HeldValue, ...]:
    """Coordinates that keep their values so that the others are determined: place, value [length].

    One for each freedom, along which it changes most.
    """
    size = task.size
    _, jacobian = _conditions(task, [x.length / size for x in task.lengths], linkage[None])
    slopes = jacobian[0, :, 0::2]
    real = np.stack([2.0 * slopes.real, -2.0 * slopes.imag], axis=2).reshape(len(slopes), -1)
    _, _, right = np.linalg.svd(real)
    null = right[len(slopes) :].T.copy()
    values = linkage[list(task.problem.free)][0::2] * size
    held = []
    for _ in range(null.shape[1]):
        place = int(np.linalg.norm(null, axis=1).argmax())
        z = values[place // 2]
        held.append((place, float(z.imag if place % 2 else z.real)))
        along = null[place] / np.linalg.norm(null[place])
        null -= np.outer(null @ along, along)
    return tuple(held)


# ----------------------------------------------------------------------
# Solved random members of families with given lengths, stored in the user's cache.
#
# There are hundreds of such families, so none is shipped: a member is solved when the first task
# asks for it, by closed paths until the trace test confirms it. A budget of paths, not of time,
# bounds the work, so that the answer does not depend on the machine.


_FOLDER, _VERSION = "start_linkages", 1  # of the random members and of the data stored of them
_SEED = 11
_SMALL = 100  # paths that are expected; more of them are compiled as soon as that saves time
_MOST_PATHS = 250_000  # paths, up to a minute and a half of two cores compiled,
_MOST_IN_NUMPY = 10_000  # and as long without a compiler
_ROUNDS, _DIRECTIONS = 8, 2  # trace tests, and directions of each
_SINGULAR = 1e12  # condition number of a random member
_SPENT = "spent"  # paths that did not suffice, and the number of their solutions
_UNKNOWN = "not all solutions of a random task of this kind are known: "


@dataclass(frozen=True, kw_only=True, eq=False)
class SolvedMember:
    """A solved member, or ``None`` and the reason in a clause."""

    member: Member | None
    reason: str = ""


class _SpentError(Exception):
    """The budget of paths is spent."""


class _Budget:
    """A tracker of at most so many paths in all, which reports the part that it has followed."""

    def __init__(self, most: int, progress: Callable[[float], None] | None) -> None:
        self.most, self.followed, self._progress = most, 0, progress

    def __call__(self, path: ParameterPath, start: ComplexArray, options: PathOptions, /) -> Paths:
        """Follow every start (B, n), a solution at σ = 1, to σ = 0."""
        before, count = self.followed, len(start)
        if before + count > self.most:
            raise _SpentError
        self.followed += count

        def tell(fraction: float) -> None:
            if self._progress is not None:
                self._progress((before + fraction * count) / self.most)

        return SparingTracker(max(count, _SMALL), tell)(path, start, options)


def solved_member(
    problem: PrecisionProblem, progress: Callable[[float], None] | None = None
) -> SolvedMember:
    """The solved member of a family with given lengths, from the cache or solved now.

    ``progress``: called with the spent part of the budget; may raise an error to end the work.
    """
    known = _KNOWN.get(problem)
    if known is None:
        most = _MOST_PATHS if compiled_pays(_MOST_PATHS) else _MOST_IN_NUMPY
        known = _stored(problem, most) or _solved(problem, most, progress)
        _KNOWN[problem] = known
    return known


_KNOWN = dict[PrecisionProblem, SolvedMember]()


def _solved(
    problem: PrecisionProblem, most: int, progress: Callable[[float], None] | None
) -> SolvedMember:
    rng, tracker, grown = np.random.default_rng(_SEED), _Budget(most, progress), [1]
    if _is_singular(problem):
        reason = "in general some of the conditions contradict each other, and others are missing"
        return SolvedMember(member=None, reason=reason)
    try:
        with np.errstate(all="ignore"):
            result = solve_and_confirm(
                problem, rng, tracker, grown.append, idle=1, directions=_DIRECTIONS, rounds=_ROUNDS
            )
    except _SpentError:
        keep_arrays(_path(problem), {_SPENT: np.array([most, grown[-1]])})
        return _spent(most, grown[-1])
    if not result.confirmed:
        reason = f"the trace test denies that {grown[-1]} are all"
        return SolvedMember(member=None, reason=_UNKNOWN + reason)
    keep_arrays(_path(problem), as_arrays(problem, result.member))
    return SolvedMember(member=result.member)


def _is_singular(problem: PrecisionProblem) -> bool:
    """Whether the solutions of random members are not isolated: too many conditions of one leg."""
    c, x = problem.random_member(np.random.default_rng(_SEED))
    path = ParameterPath(system=problem, start=c, goal=c)
    _, jacobian = path.residual_and_jacobian(x[None])
    rows = jacobian[0] / np.linalg.norm(jacobian[0], axis=1, keepdims=True)
    return bool(np.linalg.cond(rows) > _SINGULAR)


def _spent(followed: int, solutions: int) -> SolvedMember:
    reason = f"after {followed} paths with {solutions} solutions"
    return SolvedMember(member=None, reason=_UNKNOWN + reason)


def _stored(problem: PrecisionProblem, most: int) -> SolvedMember | None:
    """The member that is kept, or that so many paths do not find one; a file that cannot be read
    is written again.
    """
    with (
        suppress(OSError, ValueError, KeyError, zipfile.BadZipFile),
        np.load(_path(problem)) as stored,
    ):
        if _SPENT in stored:
            followed, solutions = stored[_SPENT].tolist()
            return None if followed < most else _spent(followed, solutions)
        return SolvedMember(member=member_of_arrays(problem, stored))
    return None


def _path(problem: PrecisionProblem) -> Path:
    return cache_folder(_FOLDER) / f"{problem.name}-{_VERSION}.npz"
