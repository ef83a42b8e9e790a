"""Solved random members of families with given lengths, kept in the user's cache.

There are hundreds of such families, so none is shipped: a member is solved when the first task
asks for it, by closed paths until the trace test confirms it. A budget of paths, not of time,
bounds the work, so that the answer does not depend on the machine.
"""

from __future__ import annotations

import zipfile
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from linkwork.design.precision.path_tracking import SparingTracker, compiled_pays
from linkwork.design.precision.problem import PrecisionProblem
from linkwork.design.precision.start_sets import as_arrays, member_of_arrays
from linkwork.foundation.arrays import ComplexArray
from linkwork.foundation.cache_folder import cache_folder, keep_arrays
from linkwork.marching.solution_path import PathOptions
from linkwork.numerics.homotopy.confirmed_member import solve_and_confirm
from linkwork.numerics.homotopy.monodromy import Member
from linkwork.numerics.homotopy.parameter_path import ParameterPath
from linkwork.numerics.homotopy.path_tracking import Paths

__all__ = ["OwnMember", "own_member"]

_FOLDER, _VERSION = "start_linkages", 1  # of the random members and of the data stored of them
_SEED = 11
_SMALL = 100  # paths that are expected; more of them are compiled as soon as that saves time
_MOST = 250_000  # paths, up to a minute and a half of two cores compiled,
_MOST_IN_NUMPY = 10_000  # and as long without a compiler
_ROUNDS, _DIRECTIONS = 8, 2  # trace tests, and directions of each
_SINGULAR = 1e12  # condition number of a random member
_SPENT = "spent"  # paths that did not suffice, and the solutions that they found
_UNKNOWN = "not all solutions of a random task of this kind are known: "


@dataclass(frozen=True, kw_only=True, eq=False)
class OwnMember:
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


def own_member(
    problem: PrecisionProblem, progress: Callable[[float], None] | None = None
) -> OwnMember:
    """The solved member of a family with given lengths, solved now if it is not kept.

    ``progress``: called with the spent part of the budget; may raise an error to end the work.
    """
    known = _KNOWN.get(problem)
    if known is None:
        most = _MOST if compiled_pays(_MOST) else _MOST_IN_NUMPY
        known = _stored(problem, most) or _solved(problem, most, progress)
        _KNOWN[problem] = known
    return known


_KNOWN = dict[PrecisionProblem, OwnMember]()


def _solved(
    problem: PrecisionProblem, most: int, progress: Callable[[float], None] | None
) -> OwnMember:
    rng, tracker, grown = np.random.default_rng(_SEED), _Budget(most, progress), [1]
    if _is_singular(problem):
        told = "in general some of the conditions contradict each other, and others are missing"
        return OwnMember(member=None, reason=told)
    try:
        with np.errstate(all="ignore"):
            found = solve_and_confirm(
                problem, rng, tracker, grown.append, idle=1, directions=_DIRECTIONS, rounds=_ROUNDS
            )
    except _SpentError:
        keep_arrays(_path(problem), {_SPENT: np.array([most, grown[-1]])})
        return _spent(most, grown[-1])
    if not found.confirmed:
        told = f"the trace test denies that {grown[-1]} are all"
        return OwnMember(member=None, reason=_UNKNOWN + told)
    keep_arrays(_path(problem), as_arrays(problem, found.member))
    return OwnMember(member=found.member)


def _is_singular(problem: PrecisionProblem) -> bool:
    """Whether the solutions of random members are not isolated: too many conditions of one leg."""
    c, x = problem.random_member(np.random.default_rng(_SEED))
    path = ParameterPath(system=problem, start=c, goal=c)
    _, jacobian = path.residual_and_jacobian(x[None])
    rows = jacobian[0] / np.linalg.norm(jacobian[0], axis=1, keepdims=True)
    return bool(np.linalg.cond(rows) > _SINGULAR)


def _spent(followed: int, found: int) -> OwnMember:
    told = f"after {followed} paths, which found {found}"
    return OwnMember(member=None, reason=_UNKNOWN + told)


def _stored(problem: PrecisionProblem, most: int) -> OwnMember | None:
    """The member that is kept, or that so many paths do not find one; a file that cannot be read
    is written again.
    """
    with (
        suppress(OSError, ValueError, KeyError, zipfile.BadZipFile),
        np.load(_path(problem)) as stored,
    ):
        if _SPENT in stored:
            followed, found = stored[_SPENT].tolist()
            return None if followed < most else _spent(followed, found)
        return OwnMember(member=member_of_arrays(problem, stored))
    return None


def _path(problem: PrecisionProblem) -> Path:
    return cache_folder(_FOLDER) / f"{problem.name}-{_VERSION}.npz"
