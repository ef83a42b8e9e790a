"""All isolated solutions of a bilinear system, from the stored solutions of a random one like it.

Systems with the same zeros and the same sums within the columns of their closure matrices (a link
with three joints enters three loops with a, b and a + b) form a family. Almost every member of a
family has the same number of isolated solutions, and a straight path from a random complex member
to any other one leads to all isolated solutions of the latter (Morgan & Sommese 1989, Appl. Math.
Comput. 29, 123; Sommese & Wampler 2005, ch. 7). The random member is solved once per process from
C(2L, L) products of linear forms, and its set of solutions is completed until closed paths of
systems lead to no new one.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from linkwork.foundation.arrays import BoolArray, ComplexArray
from linkwork.numerics.bilinear import BilinearSystem, Roots, polished
from linkwork.numerics.bilinear_homotopy import ParameterHomotopy, StartHomotopy
from linkwork.numerics.homotopy import (
    ARRIVED,
    BOLD,
    CAREFUL,
    LOST,
    SINGULAR,
    Paths,
    TrackOptions,
    track,
)

__all__ = ["SEED", "Structure", "isolated_roots", "structure_of"]

#: All random numbers follow from this one, so that every run gives the same answer.
SEED = 20_210_501

_SAME_SUM = 1e-11  # relative: two sums of coefficients are the same by construction
_SAME = 1e-6  # two solutions are the same one
_FINITE = 1e-8  # smallest homogenising coordinate, of vectors of length 1, of a finite solution
_FADING = 0.5  # a singular path whose homogenising coordinate shrinks so much runs to infinity
_LARGEST_FREE = 6  # coefficients of a column among which sums are looked for
_ATTEMPTS = 5
_FEW = 8  # paths that seldom meet, so that following them twice costs less than care
_LOOPS = 2  # closed paths without a new solution after which a set counts as complete
_TRIES = 30  # closed paths at most


@dataclass(frozen=True)
class Structure:
    """What systems of one family share: products, and columns as sums of free coefficients.

    ``columns``: for every column of the closure matrix the L coefficients as tuples of weights of
    the column's free ones.
    """

    rows: tuple[tuple[int, ...], ...]
    columns: tuple[tuple[tuple[int, ...], ...], ...]

    def random(self, rng: np.random.Generator) -> BilinearSystem:
        """A member with random complex free coefficients."""
        both = []
        for _ in range(2):
            parts = []
            for column in self.columns:
                weights = np.array(column, dtype=float)
                free = rng.normal(size=weights.shape[1]) + 1j * rng.normal(size=weights.shape[1])
                parts.append(weights @ free)
            both.append(np.stack(parts, axis=1))
        return BilinearSystem(left=both[0], right=both[1], rows=np.array(self.rows))

    def generator(self, purpose: int) -> np.random.Generator:
        """Random numbers of the family's own, the same in every run and in any order of calls."""
        flat = [k for row in self.rows for k in row]
        flat += [w + 1 for column in self.columns for entry in column for w in (*entry, 2)]
        return np.random.default_rng([SEED, purpose, *flat])


def structure_of(system: BilinearSystem) -> Structure:
    """The family of a system."""
    columns = tuple(_sums(column.tolist()) for column in system.left.T)
    return Structure(rows=tuple(map(tuple, system.rows.tolist())), columns=columns)


def _sums(column: list[complex]) -> tuple[tuple[int, ...], ...]:
    """Every coefficient of a column as a sum, with weights -1, 0 and 1, of earlier free ones."""
    size = max(map(abs, column))
    free: list[complex] = []
    found: list[tuple[int, ...]] = []
    for value in column:
        few = free[:_LARGEST_FREE]
        for weights in product((0, 1, -1), repeat=len(few)):
            rest = value - sum(w * c for w, c in zip(weights, few, strict=True))
            if abs(rest) <= _SAME_SUM * size:
                found.append(weights)
                break
        else:
            found.append((*(0 for _ in free), 1))
            free.append(value)
    width = len(free)
    return tuple((*weights, *(0 for _ in range(width - len(weights)))) for weights in found)


@dataclass(frozen=True, kw_only=True, eq=False)
class _Ends:
    """Where paths ended, in (U, V): finite regular, infinite, singular, failed."""

    x: ComplexArray
    regular: BoolArray
    infinite: BoolArray
    singular: BoolArray
    failed: BoolArray


@dataclass(frozen=True, kw_only=True, eq=False)
class _Generic:
    """A random member of a family with its solutions; ``sure`` that these are all."""

    system: BilinearSystem
    x: ComplexArray
    sure: bool = False


_KNOWN: dict[Structure, _Generic] = {}


def isolated_roots(system: BilinearSystem) -> Roots:
    """All isolated solutions of a system with at least two loops.

    Paths that were lost, or that met, are followed again with more care and along other systems.
    Where fewer solutions are found than random systems of the family have, a second set of paths
    has to confirm it.
    """
    structure = structure_of(system)
    generic = _generic(structure)
    rng = structure.generator(1)
    expected = len(generic.x)
    best: _Ends | None = None
    for attempt in range(_ATTEMPTS):
        care = CAREFUL if attempt else BOLD if expected <= _FEW else TrackOptions()
        ends = _followed(generic, system, rng, care, nearest=not attempt)
        if best is None or _quality(ends) >= _quality(best):
            agreed = best is not None and _agree(system, ends, best)
            best = ends
            if ends.regular.all() or (agreed and not ends.failed.any()):
                break
    assert best is not None
    return _roots(system, best, generic)


def _quality(ends: _Ends) -> tuple[int, int]:
    return (-int(ends.failed.sum()), int(ends.regular.sum()))


def _agree(system: BilinearSystem, a: _Ends, b: _Ends) -> bool:
    """Whether two sets of paths found the same regular solutions."""
    x, y = a.x[a.regular], b.x[b.regular]
    return len(x) == len(y) == len(_distinct(np.concatenate([x, y])))


def _generic(structure: Structure) -> _Generic:
    """The stored random member; solved when it is first wanted."""
    if structure not in _KNOWN:
        rng = structure.generator(0)
        system = structure.random(rng)
        x = np.zeros((0, 2 * system.size), dtype=complex)
        for _ in range(_ATTEMPTS):
            start = StartHomotopy.of(system, rng)
            paths = track(start, start.starts(), CAREFUL)
            ends = _read(system, start, start.spaces, paths)
            x = _distinct(np.concatenate([x, ends.x[ends.regular]]))
            if not (ends.failed | ends.singular | _meeting(ends)).any():
                break
        _KNOWN[structure] = _closed(structure, _Generic(system=system, x=x), rng)
    return _KNOWN[structure]


def _closed(structure: Structure, known: _Generic, rng: np.random.Generator) -> _Generic:
    """Solutions added until closed paths of systems lead to no new ones."""
    quiet = tries = 0
    while quiet < _LOOPS and tries < _TRIES and len(known.x) and len(known.x) < known.system.bound:
        away = structure.random(rng)
        there = _followed(known, away, rng, CAREFUL)
        back = _Generic(system=away, x=_distinct(there.x[there.regular]))
        ends = _followed(back, known.system, rng, CAREFUL)
        x = _distinct(np.concatenate([known.x, ends.x[ends.regular]]))
        whole = len(x) == len(known.x) and there.regular.all() and ends.regular.all()
        quiet = quiet + 1 if whole else 0
        tries += 1
        known = _Generic(system=known.system, x=x)
    sure = quiet == _LOOPS or len(known.x) == known.system.bound
    return replace(known, sure=sure)


def _followed(
    generic: _Generic,
    goal: BilinearSystem,
    rng: np.random.Generator,
    options: TrackOptions,
    *,
    nearest: bool = False,
) -> _Ends:
    """Paths from all solutions of one system; those that were lost or met once more, with care."""
    homotopy = ParameterHomotopy.between(generic.system, goal, rng, nearest=nearest)
    start = homotopy.starts(generic.x)
    paths = track(homotopy, start, options)
    ends = _read(goal, homotopy, homotopy.spaces, paths)
    again = ends.failed | _meeting(ends)
    if again.any() and options is not CAREFUL:
        once_more = track(homotopy, start[again], CAREFUL)
        w, near, state = paths.w.copy(), paths.near.copy(), paths.state.copy()
        w[again], near[again], state[again] = once_more.w, once_more.near, once_more.state
        joined = Paths(w=w, near=near, state=state, steps=paths.steps + once_more.steps)
        ends = _read(goal, homotopy, homotopy.spaces, joined)
        again = ends.failed | _meeting(ends)
    if not again.any():
        return ends
    return _Ends(
        x=ends.x,
        regular=ends.regular & ~again,
        infinite=ends.infinite & ~again,
        singular=ends.singular & ~again,
        failed=again,
    )


def _read(
    system: BilinearSystem,
    homotopy: StartHomotopy | ParameterHomotopy,
    spaces: tuple[ComplexArray, ComplexArray],
    paths: Paths,
) -> _Ends:
    """Ends of paths in (U, V), sorted by what they are."""
    loops, m = system.loops, system.size

    def homogeneous(w: ComplexArray, which: int) -> ComplexArray:
        half = w[:, :loops] if which == 0 else w[:, loops:]
        found: ComplexArray = homotopy.off_patch(which, half) @ spaces[which].T
        return found

    ends = [homogeneous(paths.w, k) for k in range(2)]
    scale = np.minimum(*(np.abs(z[:, m]) for z in ends))
    before = np.minimum(*(np.abs(homogeneous(paths.near, k)[:, m]) for k in range(2)))
    singular = paths.state == SINGULAR
    infinite = (paths.state == ARRIVED) & (scale < _FINITE)
    infinite |= singular & (scale < _FADING * before)
    with np.errstate(all="ignore"):
        x = np.concatenate([z[:, :m] / z[:, m:] for z in ends], axis=1)
    finite = (paths.state == ARRIVED) & ~infinite
    regular = np.zeros(len(x), dtype=bool)
    if finite.any():
        with np.errstate(all="ignore"):
            better, steps = polished(system, x[finite])
        moved = np.abs(better - x[finite]).max(axis=1) < 1e-3 * (1 + np.abs(better).max(axis=1))
        regular[finite] = (steps > 0) & (steps <= 6) & moved
        x[np.flatnonzero(finite)[regular[finite]]] = better[regular[finite]]
    return _Ends(
        x=x,
        regular=regular,
        infinite=infinite,
        singular=(singular & ~infinite) | (finite & ~regular),
        failed=paths.state == LOST,
    )


def _meeting(ends: _Ends) -> BoolArray:
    """Paths that ended at the same regular solution: one of them has jumped."""
    met = np.zeros(len(ends.x), dtype=bool)
    place = np.flatnonzero(ends.regular)
    met[place] = _near_another(ends.x[place])
    return met


def _near_another(x: ComplexArray) -> BoolArray:
    """Which rows have an equal one among the others."""
    if len(x) < 2:
        return np.zeros(len(x), dtype=bool)
    size = 1.0 + np.abs(x).max(axis=1)
    gap = np.abs(x[:, None, :] - x[None, :, :]).max(axis=2)
    close = gap < _SAME * np.minimum(size[:, None], size[None, :])
    np.fill_diagonal(close, False)
    near: BoolArray = close.any(axis=1)
    return near


def _distinct(x: ComplexArray, same: float = _SAME) -> ComplexArray:
    """The rows without repetitions, first ones kept."""
    kept: list[int] = []
    for k in range(len(x)):
        size = 1.0 + np.abs(x[k]).max()
        if not kept or np.abs(x[kept] - x[k]).max(axis=1).min() >= same * size:
            kept.append(k)
    return x[kept]


def _roots(system: BilinearSystem, ends: _Ends, generic: _Generic) -> Roots:
    multiple = _distinct(ends.x[ends.singular], 1e-2)
    continuum = [_on_a_curve(system, x) for x in multiple]
    return Roots(
        x=ends.x[ends.regular],
        multiple=multiple[~np.array(continuum, dtype=bool)] if continuum else multiple,
        paths=len(generic.x),
        at_infinity=int(ends.infinite.sum()),
        singular=int(ends.singular.sum()),
        failed=int(ends.failed.sum()),
        expected=len(generic.x),
        sure=generic.sure,
        continuum=any(continuum),
    )


def _on_a_curve(system: BilinearSystem, x: ComplexArray) -> bool:
    """Whether a singular solution can move: a step along the null direction leads to others."""
    reach = 1e-2
    with np.errstate(all="ignore"):
        x = _nearest(system, x, 30)
        _, jacobian = system.residual_and_jacobian(x[None])
        _, _, rows = np.linalg.svd(jacobian[0])
        size = 1.0 + float(np.abs(x).max())
        away = _nearest(system, x + reach * size * rows[-1].conj(), 8)
        f, _ = system.residual_and_jacobian(away[None])
    moved = float(np.abs(away - x).max()) / size
    return bool(np.abs(f).max() < 1e-11 * size * size and moved > 0.1 * reach)


def _nearest(system: BilinearSystem, x: ComplexArray, steps: int) -> ComplexArray:
    """Gauss-Newton with the shortest corrections."""
    for _ in range(steps):
        f, jacobian = system.residual_and_jacobian(x[None])
        if not math.isfinite(float(np.abs(f).max())):
            break
        x = x - np.linalg.lstsq(jacobian[0], f[0], rcond=1e-7)[0]
    return x
