"""Points inside a polygon from points of the unit square, in equal shares of its area.

Corners cut a polygon into level strips, in each of which its width is linear. A first share chooses
the strip and the height in it by area, a second one the place along the width.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from importlib.util import find_spec
from itertools import pairwise
from pathlib import Path
from typing import Protocol

import numpy as np

from linkwork.circuits.homotopy.monodromy import Family, Member, first_of_each
from linkwork.circuits.homotopy.parameter_roots import ParameterRoots, roots_at
from linkwork.circuits.homotopy.path_tracking import (
    QUICK,
    SURE,
    ParameterPath,
    ParametrizedSystem,
    PathOptions,
    Paths,
    StraightHomotopy,
    Tracker,
    polish_ends,
    track,
)
from linkwork.core.foundation.arrays import (
    ALMOST_REAL,
    AnyArray,
    Array,
    BoolArray,
    ComplexArray,
    IndexArray,
)
from linkwork.core.foundation.errors import InputError
from linkwork.core.foundation.loading import cores
from linkwork.core.foundation.statuses import Completeness
from linkwork.families import paths
from linkwork.families.compiled.code_cache import PATH_LOOP, is_compiled, is_loaded
from linkwork.synthesis.loops.limits import Candidates, LoopKind
from linkwork.synthesis.precision.positions import (
    GivenLength,
    PrecisionPositions,
    ProvedLinkages,
    prove_linkages,
)
from linkwork.synthesis.precision.problem import CONDITIONS, PrecisionProblem, cognates


def points_in_polygon(corners: ComplexArray, shares: Array) -> ComplexArray:
    """Points (D,) for shares (D, 2) from 0 to 1; evenly spread ones give evenly spread points.

    ``corners`` (K,) in order; of sides that cross, every second interval is inside, and the spread
    is even approximately.
    """
    levels = np.unique(corners.imag)
    start, end = corners, np.roll(corners, -1)
    low, high = np.minimum(start.imag, end.imag), np.maximum(start.imag, end.imag)
    strips = []
    for below, above in pairwise(levels):
        sides = (low <= below) & (high >= above) & (low < high)
        one, other = start[sides], end[sides]
        slope = (other.real - one.real) / (other.imag - one.imag)
        at = [one.real + (y - one.imag) * slope for y in (below, above)]
        order = np.argsort(at[0] + at[1], kind="stable")
        strips.append((below, above, at[0][order], at[1][order]))
    widths = [[np.sum(x[1::2] - x[::2]) for x in (left, right)] for _, _, left, right in strips]
    width = np.maximum(np.array(widths), 0.0)
    parts = np.concatenate([[0.0], np.cumsum(width.sum(axis=1) * np.diff(levels))])
    points = np.zeros(len(shares), dtype=complex)
    for k, (first, second) in enumerate(shares):
        area = first * parts[-1]
        n = min(int(np.searchsorted(parts, area, side="right")) - 1, len(strips) - 1)
        share = (area - parts[n]) / (parts[n + 1] - parts[n])
        w0, w1 = width[n]
        # the height below which this share of the strip lies
        height = share * (w0 + w1) / (w0 + np.sqrt(w0**2 + share * (w1**2 - w0**2)) or 1.0)
        below, above, left, right = strips[n]
        x = left + height * (right - left)
        points[k] = _along(x, second) + 1j * (below + height * (above - below))
    return points


def _along(ends: Array, share: float) -> float:
    """The place at a share of the intervals between every two ends."""
    widths = np.maximum(ends[1::2] - ends[::2], 0.0)
    length = np.concatenate([[0.0], np.cumsum(widths)])
    n = min(int(np.searchsorted(length, share * length[-1], side="right")) - 1, len(widths) - 1)
    return float(ends[2 * n] + share * length[-1] - length[n])


# ----------------------------------------------------------------------
# Positions that leave freedoms: the missing conditions are drawn at random, task by task.
#
# A fixed pivot takes two conditions, and is drawn first; further points take the rest,
# drawn between positions of the task.


_PIVOTS = 2.0  # times the task's size: the spread of drawn fixed pivots about its centre
_POINTS = 0.2  # and that of drawn points about the way from one position to the next


def positions_with_samples(
    points: ComplexArray,
    angles: Array,
    pivots: ComplexArray,
    samples: int,
    rng: np.random.Generator,
    region: ComplexArray | None = None,
    lengths: Sequence[GivenLength] = (),
) -> Iterator[PrecisionPositions]:
    """Tasks with eight conditions: one if the task gives eight, else ``samples`` without the
    lengths.

    Parameters
    ----------
    points : (J,) complex
        The traced point in the positions [length].
    angles : (J,)
        The coupler's angles [rad], NaN where they are free.
    pivots : (0, 1 or 2,) complex
        Given fixed pivots [length].
    samples : int
    rng : numpy.random.Generator
    region : (K,) complex, optional
        Corners of the rectangle's diagonal, or of a polygon, around drawn pivots [length].
    lengths : sequence of GivenLength, optional

    Raises
    ------
    InputError
        For positions that are equal, too many conditions, or poses alone.
    """
    missing = _missing(points, angles, pivots)
    if missing == len(lengths):
        yield PrecisionPositions.of(points, angles, pivots, lengths)
        return
    drawn = min(2 - len(pivots), missing // 2)
    extra = missing - 2 * drawn
    size = float(np.abs(points - points.mean()).max())
    for _ in range(samples):
        # the centre of a normal distribution, unless there is a region
        z = points.mean() + _PIVOTS * size * rng.normal(size=(drawn, 2)) @ [1.0, 1.0j]
        if region is not None and len(region):
            z = points_in_polygon(_polygon(region), rng.uniform(size=(drawn, 2)))
        before = rng.integers(0, max(1, len(points) - 1), extra)
        way = points[(before + 1) % len(points)] - points[before]
        off = _POINTS * size * rng.normal(size=(extra, 2)) @ [1.0, 1.0j]
        more = points[before] + rng.uniform(size=extra) * way + off
        positions = PrecisionPositions.of(
            np.concatenate([points, more]),
            np.concatenate([angles, np.full(extra, np.nan)]),
            np.concatenate([pivots, z]),
        )
        yield replace(positions, listed=len(points))


def _polygon(region: ComplexArray) -> ComplexArray:
    """The corners of a region; of a rectangle two opposite ones are given."""
    if len(region) != 2:
        return region
    one, other = region
    corners = [one, complex(other.real, one.imag), other, complex(one.real, other.imag)]
    return np.array(corners)


def _missing(points: ComplexArray, angles: Array, pivots: ComplexArray) -> int:
    """How many conditions the positions leave."""
    poses = int((~np.isnan(angles)).sum())
    if len(points) < 2 or len(np.unique(points[np.isnan(angles)])) < len(points) - poses:
        raise InputError("a four-bar needs at least two positions, and points that differ")
    if poses == len(points):
        raise InputError("positions that all have an angle are met by dyads: give a point as well")
    posed, free = max(poses - 1, 0), len(points) - max(poses, 1)
    conditions = 2 * posed + free + 2 * len(pivots)
    if conditions > CONDITIONS:
        raise InputError(
            f"a four-bar meets at most {CONDITIONS} conditions, these are {conditions}: a pose "
            "after the first position and a fixed pivot are two, a point is one"
        )
    return CONDITIONS - conditions


# ----------------------------------------------------------------------
# The tracker of solution paths: compiled where that saves time, else in batches of NumPy.
#
# NumPy steps all paths of a batch at once, and a round takes nearly as long for one path as for
# many:
# of paths that creep towards infinity, the rounds count, not the paths.


# A path takes about 0.3 ms compiled and 2 ms in NumPy, where a round of a batch takes 0.8 ms.
_FEW = 100  # paths: recording a program takes as long in NumPy
_LOADING = 500  # paths in NumPy take as long as loading compiled code,
_COMPILING = 4000  # and these as long as compiling it
_AT_A_TIME = 400  # compiled, between reports
_ROUND = 0.4  # paths in NumPy: the least time of a round
_KERNELS = dict[ParametrizedSystem, "paths.PathKernel"]()
_FOLLOWED = [0.0]  # paths that a process has followed in NumPy


class CompiledTracker:
    """Follows solution paths in the lanes of compiled code, on all cores."""

    def __init__(self, threads: int | None = None) -> None:
        self.threads = threads or cores()

    def __call__(self, path: ParameterPath, start: ComplexArray, options: PathOptions, /) -> Paths:
        """Follow every start (B, n), a solution at σ = 1, to σ = 0."""
        kernel = _KERNELS.get(path.system)
        if kernel is None:
            kernel = _KERNELS[path.system] = paths.PathKernel(StraightHomotopy(path.system))
        more = SURE if options is QUICK else None
        w, near, state, attempts = kernel.follow(path.ends, start, options, self.threads, more)
        return Paths(w=w, near=near, state=state, steps=int(attempts.max(initial=0)))


class SparingTracker:
    """Follows paths in NumPy until compiled code saves time; decided anew before every batch.

    Parameters
    ----------
    expected : int
        Paths that will be followed, unless some need more care.
    progress : callable, optional
        Called with the finished fraction of each batch; may raise an error to end the work.
    """

    def __init__(self, expected: int, progress: Callable[[float], None] | None = None) -> None:
        self._expected, self._progress = expected, progress

    def __call__(self, path: ParameterPath, start: ComplexArray, options: PathOptions, /) -> Paths:
        """Follow every start (B, n), a solution at σ = 1, to σ = 0."""
        if compiled_pays(self._expected):
            return self._compiled(path, start, options)
        ends = track(path, start, options, self._progress)
        _FOLLOWED[0] += max(len(start), _ROUND * ends.steps)
        return ends

    def _compiled(self, path: ParameterPath, start: ComplexArray, options: PathOptions) -> Paths:
        follow, count = CompiledTracker(), math.ceil(len(start) / _AT_A_TIME)
        if self._progress is None or count < 2:
            return follow(path, start, options)
        followed = []
        for part in np.array_split(start, count):
            followed.append(follow(path, part, options))
            self._progress(len(followed) / count)
        return Paths(
            w=np.concatenate([one.w for one in followed]),
            near=np.concatenate([one.near for one in followed]),
            state=np.concatenate([one.state for one in followed]),
            steps=max(one.steps for one in followed),
        )


def compiled_pays(expected: int) -> bool:
    """Whether compiled code saves time for this many paths, after those followed in NumPy so far.

    Where there is no Numba, NumPy follows all of them.
    """
    if expected < _FEW or find_spec("numba") is None:
        return False
    if is_loaded(PATH_LOOP):
        return True
    least = _LOADING if is_compiled(PATH_LOOP) else _COMPILING
    return expected + _FOLLOWED[0] >= least


# ----------------------------------------------------------------------
# Solved random members of the families of precision positions, shipped with the package.
#
# ``scripts/start_linkages`` computes them by monodromy and confirms them by the trace test. The
# solutions are kept in single precision and polished when they are read, so that no file is trusted
# with a number.


SHIPPED = Path(__file__).with_name("start_linkages.npz")
#: All families with a point; poses alone are solved by dyads.
SHIPPED_PROBLEMS = tuple(
    PrecisionProblem(poses=poses, points=points, pivots=pivots)
    for pivots in range(3)
    for poses in range(CONDITIONS)
    if (points := CONDITIONS - 2 * poses - 2 * pivots) > 0
)


class NamedFamily(Family, Protocol):
    """A family whose solved member is shipped."""

    @property
    def name(self) -> str:
        """The name of its start set."""

    @property
    def last(self) -> slice:
        """The parameters of the last equation."""


def as_arrays(problem: NamedFamily, member: Member) -> dict[str, AnyArray]:
    """A solved member as arrays of the shipped file."""
    name = problem.name
    return {
        f"{name}.parameters": member.parameters,
        f"{name}.x": member.x.astype(np.complex64),
    }


@cache
def start_member(problem: PrecisionProblem) -> Member:
    """The shipped solved member of a family; raises like :func:`stored_member`."""
    return stored_member(problem, SHIPPED)


def stored_member(problem: NamedFamily, path: Path) -> Member:
    """The solved member of a family in a shipped file.

    Raises
    ------
    InputError
        If the installation is damaged: the file lacks the family, or has wrong numbers.
    """
    try:
        with np.load(path) as stored:
            return member_of_arrays(problem, stored)
    except (OSError, KeyError, ValueError):
        raise InputError(f"{path} is damaged: install Linkwork again") from None


def member_of_arrays(problem: NamedFamily, arrays: Mapping[str, AnyArray]) -> Member:
    """The member of :func:`as_arrays`, its solutions polished.

    Raises
    ------
    KeyError, ValueError
        If these are no arrays of a solved member.
    """
    parameters, x = (arrays[f"{problem.name}.{field}"] for field in ("parameters", "x"))
    path = ParameterPath(system=problem, start=parameters, goal=parameters)
    sharp = polish_ends(path, x.astype(complex))
    if not sharp.regular.all() or len(
        first_of_each(problem.fingerprint(sharp.x, parameters))
    ) < len(x):
        raise ValueError("some solutions are none, or equal")
    return Member(parameters=parameters, x=sharp.x)


# ----------------------------------------------------------------------
# All four-bars through precision positions: solved, counted, and proved where they are real.


_SEED = 19_920_301  # of detours; every run gives the same answer
_LEAST_SIZE = 0.1  # of the size of the positions: numbers are compared relative to at least this


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class PrecisionFourBars(Candidates):
    """Real four-bars through positions, and how many solutions there are.

    Parameters
    ----------
    triple : (D,) int
        Equal for four-bars that are cognates of each other.
    real : int
        Real solutions, a triple of cognates counted once.
    roots : ParameterRoots
        All complex solutions, and the outcome of every path.
    """

    triple: IndexArray
    real: int
    roots: ParameterRoots

    @property
    def proved(self) -> BoolArray:
        """Which four-bars are proved, (D,): errors of the others are infinite."""
        return np.isfinite(self.error)

    def __repr__(self) -> str:
        roots = self.roots
        return (
            f"Four-bars through {self.guided.shape[1]} positions\n"
            f"  solutions {len(roots.x):5}   of {roots.paths} paths; {roots.at_infinity} to "
            f"infinity, {len(roots.singular)} singular, {roots.lost} lost\n"
            f"  real      {self.real:5}\n"
            f"  four-bars {len(self):5}   {int(self.proved.sum())} of them proved\n"
            f"  {self.completeness.value}"
        )

    @property
    def completeness(self) -> Completeness:
        """Whether all four-bars are listed."""
        return self.roots.graded(self.proved)


def four_bars_through(
    positions: PrecisionPositions,
    tracker: Tracker | None = None,
    *,
    member: Member | None = None,
    alike: int = 1,
    progress: Callable[[float], None] | None = None,
) -> PrecisionFourBars:
    """All four-bars through positions that determine a finite number of them.

    Parameters
    ----------
    positions : PrecisionPositions
        With two conditions for every pose and every fixed pivot, one for every point and length,
        not counting the first position: eight in all, at least one of them a point.
    tracker : Tracker, optional
        By default compiled where that saves time.
    member : Member, optional
        A solved member to start from, needed with given lengths; by default the shipped one.
    alike : int
        How many tasks of this kind will be solved, this one included.
    progress : callable, optional
        Called with the finished fraction of the paths; may raise an error to end the work.
    """
    problem, size = positions.problem, positions.size
    member = member or start_member(problem)
    goal, rng = positions.parameters(size), np.random.default_rng(_SEED)
    tracker = tracker or SparingTracker(alike * len(member.x), progress)
    roots = roots_at(problem, member, goal, tracker, rng)
    apart = np.abs(problem.mirrored(roots.x) - roots.x) / (_LEAST_SIZE + np.abs(roots.x))
    real = problem.linkages(roots.x[apart.max(axis=1, initial=0.0) < ALMOST_REAL], goal)
    count = len(real)
    triple = np.arange(count)
    if not (problem.poses or problem.lengths or problem.pivots == 2):
        # with one pivot given the second cognate, which lacks it, is none
        others = cognates(real)[: 2 - problem.pivots]
        real, triple = np.concatenate([real, *others]), np.tile(triple, 1 + len(others))
    proofs = prove_linkages(positions, real * size)
    bars = four_bars_of(positions, proofs)
    return PrecisionFourBars(**vars(bars), triple=triple, real=count, roots=roots)


def four_bars_of(positions: PrecisionPositions, proofs: ProvedLinkages) -> Candidates:
    """Linkages with their proofs as four-bars in the positions, in the order of the task."""
    x, a, y, b = proofs.legs.T
    points = np.concatenate([[positions.start], positions.poses, positions.points])
    moving = np.concatenate([np.stack([x, y], axis=1)[:, None], proofs.moving], axis=1)
    places = np.argsort(positions.order)[: positions.listed]
    moving = (moving + points[:, None])[:, places]
    return Candidates(
        kind=LoopKind.FOUR_BAR,
        fixed_a=positions.start + a,
        fixed_b=positions.start + b,
        direction=np.zeros(len(moving), dtype=complex),
        moving_a=moving[:, :, 0],
        moving_b=moving[:, :, 1],
        guided=np.broadcast_to(points[places], moving.shape[:2]).copy(),
        error=proofs.error,
        miss=np.zeros(len(moving)),
    )
