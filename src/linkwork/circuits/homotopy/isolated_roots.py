"""All isolated solutions of a system, from the stored solutions of a random one of its family.

Almost every member of a linear family has the same number of isolated solutions, and a straight
path from a random complex member to any other one leads to all isolated solutions of the latter
(Morgan & Sommese 1989, Appl. Math. Comput. 29, 123; Sommese & Wampler 2005, ch. 7). The random
member is solved once from products of linear forms, until closed paths lead to no new solution.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, Generic, Protocol, TypeVar

import numpy as np

from linkwork.circuits.homotopy.bilinear_homotopy import (
    SAME_ROOT,
    ClosureSystem,
    ParameterHomotopy,
    PolynomialSystem,
    Roots,
    StartHomotopy,
    distinct_solutions,
    nearest_solution,
    polish_roots,
)
from linkwork.circuits.homotopy.counts import (
    SolutionBound,
    Theorem,
    bound_by_products,
    bound_by_sums,
)
from linkwork.circuits.homotopy.dead_points import Renaming, Topology, norm_of
from linkwork.circuits.homotopy.parameter_roots import StartSet, read_sets, write_set
from linkwork.circuits.homotopy.path_tracking import (
    ARRIVED,
    BOLD,
    CAREFUL,
    SINGULAR,
    Ends,
    Homotopy,
    PathOptions,
    Paths,
    track,
)
from linkwork.core.foundation.arrays import Array, BoolArray, ComplexArray, IndexArray
from linkwork.core.numerics.bilinear import BilinearSystem, columns_of, random_closures, sums_hold

#: All random numbers follow from this one, so that every run gives the same answer.
SEED = 20_210_501

_FINITE = 1e-8  # smallest homogenising coordinate, of vectors of length 1, of a finite solution
_FADING = 0.5  # a singular path whose homogenising coordinate shrinks so much runs to infinity
_FINITE_MULTIPLE = 1e-5  # the smallest one of a finite multiple solution, which is known roughly
_ATTEMPTS = 5
_FEW = 8  # paths that seldom meet, so that following them twice costs less than care
_LOOPS = 2  # closed paths without a new solution after which a set counts as complete
_STEPS_TO_MULTIPLE = 30  # of Gauss-Newton; each halves the distance to a double solution
_TRIES = 30  # closed paths at most


S = TypeVar("S", bound=ClosureSystem)


class _ToSystem(Homotopy, Protocol):
    def points(self, w: ComplexArray) -> tuple[ComplexArray, Array]:
        """The system's unknowns, (B, n), and how far from infinity, from 0 to 1, (B,)."""


class HomotopyFromProducts(_ToSystem, Protocol):
    """From products of linear forms to a system."""

    def starts(self) -> ComplexArray:
        """All solutions at σ = 1."""


class HomotopyFromRelative(_ToSystem, Protocol):
    """From one member of a family to another."""

    def starts(self, x: ComplexArray) -> ComplexArray:
        """Solutions x (B, n) of the first member as points at σ = 1."""


@dataclass(frozen=True)
class RootFamily(Topology, ABC, Generic[S]):
    """Systems of one topology: they differ in free coefficients only."""

    @abstractmethod
    def complete(self, found: int) -> bool:
        """Whether this many solutions of a member are all, by a theorem."""

    @abstractmethod
    def member(self, left: ComplexArray, right: ComplexArray) -> S:
        """The member with these closures (L, K)."""

    @abstractmethod
    def from_products(self, goal: S, rng: np.random.Generator) -> HomotopyFromProducts:
        """Paths to all isolated solutions of a member."""

    @abstractmethod
    def between(
        self, start: S, goal: S, rng: np.random.Generator, *, nearest: bool = False
    ) -> HomotopyFromRelative:
        """Paths from member to member: random ones, or those with the ``nearest`` start."""

    @cached_property
    def topology(self) -> Topology:
        """The products, sums and rates that all members have."""
        return Topology(rows=self.rows, columns=self.columns, own=self.own, slots=self.slots)

    def random(self, rng: np.random.Generator) -> S:
        """A member with random complex free coefficients."""
        return self.member(*(random_closures(self.columns, rng) for _ in range(2)))

    def rename(self, x: ComplexArray, renaming: Renaming) -> ComplexArray:
        """Solutions (B, n) of another family's member as those of the same member of this one."""
        halves = renaming.halves
        rates = x[:, len(halves) + renaming.rates]
        normed = rates / (rates @ norm_of(self.own))[:, None]
        return np.concatenate([x[:, halves], normed], axis=1)

    def generator(self, purpose: int) -> np.random.Generator:
        """Random numbers of the family's own, the same in every run and in any order of calls."""
        flat = [k for row in self.rows for k in row]
        flat += [w + 1 for column in self.columns for entry in column for w in (*entry, 2)]
        if not self.own:
            return np.random.default_rng([SEED, purpose, *flat])
        rates = [abs(round(w)) for slot in self.slots for w in slot]
        return np.random.default_rng([SEED, 1, purpose, self.own, *flat, *rates])


@dataclass(frozen=True)
class _Goal:
    """The end of a homotopy as a system in the coordinates of its patches."""

    homotopy: Homotopy

    def residual_and_jacobian(self, x: ComplexArray) -> tuple[ComplexArray, ComplexArray]:
        """H and ∂H/∂w at σ = 0."""
        value, jacobian, _ = self.homotopy.evaluate(x, np.zeros(len(x)))
        return value, jacobian


@dataclass(frozen=True, kw_only=True, eq=False)
class Solved(Generic[S]):
    """A random member of a family with its solutions; ``sure`` that these are all."""

    system: S
    x: ComplexArray
    sure: bool = False

    def as_start_set(self, topology: Topology) -> StartSet:
        """The set that is kept on disk."""
        closures = {"left": self.system.left, "right": self.system.right}
        return StartSet(topology=topology, x=self.x, sure=self.sure, **closures)


_KNOWN: dict[RootFamily[Any], Solved[Any]] = {}


def isolated_roots(system: S, family: RootFamily[S], known: ComplexArray | None = None) -> Roots:
    """All isolated solutions of a member of a family.

    Paths that were lost, or that met, are followed again with more care and along other systems.
    Where fewer solutions are found than random systems of the family have, a second set of paths
    has to confirm it. No member has more isolated solutions than almost all have: if regular ones
    ``known`` (R, n) are as many, these are all, and no path is followed.
    """
    generic = random_member(family)
    if known is not None and len(known) == len(generic.x):
        no = np.zeros(len(known), dtype=bool)
        return _roots(system, Ends(x=known, regular=~no, infinite=no, singular=no), generic)
    rng = family.generator(1)
    expected = len(generic.x)
    best: Ends | None = None
    for attempt in range(_ATTEMPTS):
        care = CAREFUL if attempt else BOLD if expected <= _FEW else PathOptions()
        ends = _follow_paths(family, generic, system, rng, care, nearest=not attempt)
        if best is None or _quality(ends) >= _quality(best):
            # two independent sets of paths that agree: missing solutions are at infinity
            agreed = best is not None and _agree(ends, best)
            best = ends
            if ends.regular.all() or (agreed and not ends.lost.any()):
                break
    assert best is not None
    return _roots(system, best, generic)


def _quality(ends: Ends) -> tuple[int, int]:
    return (-int(ends.lost.sum()), int(ends.regular.sum()))


def _agree(a: Ends, b: Ends) -> bool:
    """Whether two sets of paths found the same regular solutions."""
    x, y = a.x[a.regular], b.x[b.regular]
    return len(x) == len(y) == len(distinct_solutions(np.concatenate([x, y])))


def random_member(family: RootFamily[S]) -> Solved[S]:
    """The stored random member; read from disk, or solved when it is first wanted."""
    if family not in _KNOWN:
        known = _read_member(family)
        if known is None:
            known = solve_random_member(family)
            write_set(known.as_start_set(family.topology))
        _KNOWN[family] = known
    return _KNOWN[family]


def _read_member(family: RootFamily[S]) -> Solved[S] | None:
    """A member that is kept on disk, if all its solutions are solutions."""
    for kept in read_sets(family.topology):
        renaming = family.topology.renaming(kept.topology)
        if renaming is None:
            continue
        closures = (renaming.loops @ side[:, renaming.order] for side in (kept.left, kept.right))
        system = family.member(*closures)
        x, steps = kept.x, np.zeros(0, dtype=np.int64)
        if len(x):
            with np.errstate(all="ignore"):  # of a file that is damaged
                x, steps = polish_roots(system, family.rename(x, renaming))
        if (steps >= 0).all() and len(distinct_solutions(x)) == len(x):
            return Solved(system=system, x=x, sure=kept.sure)
    return None


def solve_random_member(family: RootFamily[S], purpose: int = 0) -> Solved[S]:
    """A random member, solved from products of linear forms and completed by closed paths.

    Another ``purpose`` takes other random numbers.
    """
    rng = family.generator(purpose)
    system = family.random(rng)
    x = np.zeros((0, 0), dtype=complex)
    clean = 0
    for attempt in range(_ATTEMPTS):
        start = family.from_products(system, rng)
        ends = _classify_ends(system, start, track(start, start.starts(), CAREFUL))
        found = ends.x[ends.regular]
        x = distinct_solutions(np.concatenate([x, found])) if attempt else distinct_solutions(found)
        clean += not (ends.lost | ends.singular | _meeting(ends)).any()
        if (clean and len(x)) or clean == _LOOPS:
            break
    # without solutions closed paths prove nothing: all paths have to run to infinity twice
    nothing = not len(x) and clean == _LOOPS
    return _close_paths(family, Solved(system=system, x=x, sure=nothing), rng)


def _close_paths(family: RootFamily[S], known: Solved[S], rng: np.random.Generator) -> Solved[S]:
    """Solutions added until closed paths of systems lead to no new ones."""
    quiet = tries = 0
    while quiet < _LOOPS and tries < _TRIES and len(known.x) and not family.complete(len(known.x)):
        # a closed path of systems permutes the solutions, and so may lead to missing ones
        away = family.random(rng)
        there = _follow_paths(family, known, away, rng, CAREFUL)
        back = Solved(system=away, x=distinct_solutions(there.x[there.regular]))
        ends = _follow_paths(family, back, known.system, rng, CAREFUL)
        x = distinct_solutions(np.concatenate([known.x, ends.x[ends.regular]]))
        whole = len(x) == len(known.x) and there.regular.all() and ends.regular.all()
        quiet = quiet + 1 if whole else 0
        tries += 1
        known = Solved(system=known.system, x=x)
    sure = known.sure or quiet == _LOOPS or family.complete(len(known.x))
    return replace(known, sure=sure)


def _follow_paths(
    family: RootFamily[S],
    generic: Solved[S],
    goal: S,
    rng: np.random.Generator,
    options: PathOptions,
    *,
    nearest: bool = False,
) -> Ends:
    """Paths from all solutions of one system; those that were lost or met once more, with care."""
    homotopy = family.between(generic.system, goal, rng, nearest=nearest)
    start = homotopy.starts(generic.x)
    paths = track(homotopy, start, options)
    ends = _classify_ends(goal, homotopy, paths)
    again = ends.lost | _meeting(ends)
    if again.any() and options is not CAREFUL:
        once_more = track(homotopy, start[again], CAREFUL)
        w, near, state = paths.w.copy(), paths.near.copy(), paths.state.copy()
        w[again], near[again], state[again] = once_more.w, once_more.near, once_more.state
        joined = Paths(w=w, near=near, state=state, steps=paths.steps + once_more.steps)
        ends = _classify_ends(goal, homotopy, joined)
        again = ends.lost | _meeting(ends)
    return replace(
        ends,
        regular=ends.regular & ~again,
        infinite=ends.infinite & ~again,
        singular=ends.singular & ~again,
    )


def _classify_ends(system: PolynomialSystem, homotopy: _ToSystem, paths: Paths) -> Ends:
    """Ends of paths in the system's unknowns: regular, infinite, singular or failed."""
    (x, scale), (_, before) = homotopy.points(paths.w), homotopy.points(paths.near)
    singular = paths.state == SINGULAR
    # on its patch a path to infinity ends regularly, with a vanishing homogenising coordinate
    infinite = (paths.state == ARRIVED) & (scale < _FINITE)
    infinite |= singular & (scale < _FADING * before)
    finite = (paths.state == ARRIVED) & ~infinite
    regular = np.zeros(len(x), dtype=bool)
    if finite.any():
        with np.errstate(all="ignore"):
            better, steps = polish_roots(system, x[finite])
        moved = np.abs(better - x[finite]).max(axis=1) < 1e-3 * (1 + np.abs(better).max(axis=1))
        # slow convergence marks a multiple solution, a long way another one
        regular[finite] = (steps > 0) & (steps <= 6) & moved
        x[np.flatnonzero(finite)[regular[finite]]] = better[regular[finite]]
    for k in np.flatnonzero(finite & ~regular):
        infinite[k] = _multiple_at_infinity(homotopy, paths.w[k], float(scale[k]))
    finite &= ~infinite
    return Ends(
        x=x,
        regular=regular,
        infinite=infinite,
        singular=(singular & ~infinite) | (finite & ~regular),
    )


def _multiple_at_infinity(homotopy: _ToSystem, w: ComplexArray, scale: float) -> bool:
    """Whether a path that jumped to a multiple solution w (n,) ended at infinity.

    Such an end is off by a root of the rounding, so a homogenising coordinate that ought to vanish
    does not. In the coordinates of the patches the solution is finite and can be sharpened.
    """
    end = nearest_solution(_Goal(homotopy), w, _STEPS_TO_MULTIPLE)
    _, sharp = homotopy.points(end[None])
    return bool(sharp[0] < max(_FINITE_MULTIPLE, _FADING * scale))


def _meeting(ends: Ends) -> BoolArray:
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
    close = gap < SAME_ROOT * np.minimum(size[:, None], size[None, :])
    np.fill_diagonal(close, False)
    near: BoolArray = close.any(axis=1)
    return near


def _roots(system: S, ends: Ends, generic: Solved[S]) -> Roots:
    multiple = distinct_solutions(ends.x[ends.singular], 1e-2)
    curved = np.array([_on_a_curve(system, x) for x in multiple], dtype=bool)
    return Roots(
        x=ends.x[ends.regular],
        multiple=multiple[~curved],
        paths=len(generic.x),
        at_infinity=int(ends.infinite.sum()),
        singular=int(ends.singular.sum()),
        failed=int(ends.lost.sum()),
        expected=len(generic.x),
        sure=generic.sure,
        continuum=bool(curved.any()),
        curves=multiple[curved],
    )


def _on_a_curve(system: PolynomialSystem, x: ComplexArray) -> bool:
    """Whether a singular solution can move: a step along the null direction leads to others."""
    reach = 1e-2
    with np.errstate(all="ignore"):
        # singular ends are known roughly: Gauss-Newton finds the curve again, at half the distance
        # a step
        x = nearest_solution(system, x, 30)
        _, jacobian = system.residual_and_jacobian(x[None])
        _, _, rows = np.linalg.svd(jacobian[0])
        size = 1.0 + float(np.abs(x).max())
        away = nearest_solution(system, x + reach * size * rows[-1].conj(), 8)
        f, _ = system.residual_and_jacobian(away[None])
    moved = float(np.abs(away - x).max()) / size
    return bool(np.abs(f).max() < 1e-11 * size * size and moved > 0.1 * reach)


# ----------------------------------------------------------------------
# Families of bilinear systems: mechanisms with the same structure.
#
# Systems with the same products, the same zeros and the same sums within the columns of their
# closure matrices (a link with three joints enters three loops with a, b and a + b) form a family.


@dataclass(frozen=True)
class Structure(RootFamily[BilinearSystem]):
    """The structure of a family of systems: products, and columns as sums of free coefficients."""

    def bound(self, found: int) -> SolutionBound:
        """The bound that ``found`` solutions reach, else the smallest one known."""
        simple = bound_by_products(self.rows)
        if found == simple.number:  # the other one takes longer
            return simple
        sharper = bound_by_sums(self.rows, self.columns)
        return simple if sharper is None or sharper.number >= simple.number else sharper

    def bound_of(self, system: BilinearSystem, spread: Array, found: int) -> SolutionBound:
        """The same for one member whose ``left`` (L, M + 1) is known within ``spread``.

        Its sums have to hold within rounding.
        """
        best = self.bound(found)
        if best.theorem is Theorem.LAMAN and not sums_hold(self.columns, system.left, spread):
            return bound_by_products(self.rows)
        return best

    def complete(self, found: int) -> bool:
        """Whether this many solutions of a member are all, by a theorem."""
        return found == self.bound(found).number

    def member(self, left: ComplexArray, right: ComplexArray) -> BilinearSystem:
        """The member with these closures."""
        return BilinearSystem(left=left, right=right, rows=np.array(self.rows))

    def from_products(self, goal: BilinearSystem, rng: np.random.Generator) -> StartHomotopy:
        """C(2L, L) paths to all isolated solutions of a member."""
        return StartHomotopy.of(goal, rng)

    def between(
        self,
        start: BilinearSystem,
        goal: BilinearSystem,
        rng: np.random.Generator,
        *,
        nearest: bool = False,
    ) -> ParameterHomotopy:
        """Paths from member to member."""
        return ParameterHomotopy.between(start, goal, rng, nearest=nearest)


def structure_of(system: BilinearSystem) -> Structure:
    """The family of a system."""
    return Structure(rows=system.products, columns=columns_of(system.left))


# ----------------------------------------------------------------------
# Bilinear systems of one loop in closed form, many at once.
#
# On the null spaces û, v̂ ∈ C² the two products are ûᵀ M_r v̂ = 0, so ûᵀM_1 and ûᵀM_2 are parallel:
# a quadratic form in û.


_DOUBLE = 1e-14  # discriminant, relative to its parts, that is zero within rounding
_NOTHING = 1e-13  # coefficients, relative to the products they come from, that are
_FINITE_OF_TWO = (
    1e-9  # smallest homogenising coordinate, of vectors of length 1, of a finite solution
)
_ANY_U, _ANY_V = np.array([0.6, 0.8j]), np.array([0.8, 0.6j])


def quadratic_roots(systems: BilinearSystem) -> list[Roots]:
    """All solutions of each of B systems with one loop: two, unless there is a curve of them."""
    nu, nv = _null_spaces(systems.left), _null_spaces(systems.right)
    forms, size = _forms(nu, nv, systems.rows)
    a, b, c, d = (forms[:, r, k] for r in (0, 1) for k in (0, 1))
    quadratic = np.stack([_det(a, c), _det(a, d) + _det(b, c), _det(b, d)], axis=1)  # eq. (46)
    everywhere = np.abs(quadratic).max(axis=1) <= _NOTHING * size
    u, double = _zeros(quadratic)
    # any û has its v̂: one of them shows whether the curve is finite
    u[everywhere], double = _ANY_U, double & ~everywhere
    with np.errstate(all="ignore"):  # of zeros that do not count
        w = u[:, :, None, :1] * forms[:, None, :, 0] + u[:, :, None, 1:] * forms[:, None, :, 1]
    # both are parallel; the longer one is rounded less
    lengths = np.linalg.norm(w, axis=3)
    longer = lengths.argmax(axis=2)[:, :, None]
    length = np.take_along_axis(lengths, longer, axis=2)
    w = np.take_along_axis(w, longer[..., None], axis=2)[:, :, 0]
    free = length <= _NOTHING * np.sqrt(size)[:, None, None]  # any v̂ will do
    with np.errstate(all="ignore"):
        v = np.where(free, _ANY_V, np.stack([-w[..., 1], w[..., 0]], axis=2) / length)
        # (B, 2, 2, 3): of every zero, (U, 1) and (V, 1) but for their factors
        ends = np.stack([u @ nu.swapaxes(1, 2), v @ nv.swapaxes(1, 2)], axis=2)
        x = (ends[..., :2] / ends[..., 2:]).reshape(len(u), 2, 4)
    once = np.stack([np.ones_like(double), ~(double | everywhere)], axis=1)
    finite = once & (np.abs(ends[..., 2]).min(axis=2) > _FINITE_OF_TWO)
    beyond = once & free[..., 0] & (np.abs(ends[:, :, 0, 2]) > _FINITE_OF_TWO)
    curve = np.where(everywhere, finite.any(axis=1), beyond.any(axis=1))
    expected = bound_by_products(systems.products).number
    return [
        _roots_of_two(x[k, finite[k]], bool(double[k]), bool(curve[k]), expected)
        for k in range(len(x))
    ]


def _null_spaces(closures: ComplexArray) -> ComplexArray:
    """Orthonormal bases (B, 3, 2) of the null spaces of closures (B, 1, 3)."""
    _, _, rows = np.linalg.svd(closures)
    return np.asarray(rows[:, 1:].conj().swapaxes(1, 2))


def _forms(nu: ComplexArray, nv: ComplexArray, rows: IndexArray) -> tuple[ComplexArray, Array]:
    """Linear forms in v̂, (B, 2, 2, 2): per product those that belong to û_0 and û_1; the size of
    their determinants, (B,).
    """
    p, q, p1, q1 = rows
    forms = nu[:, p, :, None] * nv[:, q, None, :] - nu[:, p1, :, None] * nv[:, q1, None, :]
    u, v = np.linalg.norm(nu, axis=2), np.linalg.norm(nv, axis=2)
    return forms, (u[:, p] * v[:, q] + u[:, p1] * v[:, q1]).prod(axis=1)


def _det(a: ComplexArray, b: ComplexArray) -> ComplexArray:
    return a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]


def _zeros(quadratic: ComplexArray) -> tuple[ComplexArray, BoolArray]:
    """Zeros (û_0, û_1), (B, 2, 2), of length 1, of q0 û_0² + q1 û_0 û_1 + q2 û_1²; whether both
    coincide, and only the first one counts.
    """
    q0, q1, q2 = quadratic.T
    square = q1 * q1 - 4.0 * q0 * q2
    double = np.abs(square) <= _DOUBLE * (np.abs(q1) ** 2 + 4.0 * np.abs(q0 * q2))
    root = np.where(double, 0.0, np.sqrt(square))
    # the root without cancellation; the other one follows from their product
    far = np.where(np.abs(q1 + root) >= np.abs(q1 - root), q1 + root, q1 - root)
    pair = np.array([[-far, 2.0 * q0], [-2.0 * q2, far]]).transpose(2, 0, 1)
    # where both coincide one of them may be zero: the other one comes first
    shorter = double & (np.abs(q0) < np.abs(q2))
    pair[shorter, 0] = np.stack([2.0 * q2, -q1], axis=1)[shorter]
    with np.errstate(all="ignore"):  # zeros that do not count may have no length
        return pair / np.linalg.norm(pair, axis=2)[..., None], double


def _roots_of_two(x: ComplexArray, double: bool, curve: bool, expected: int) -> Roots:
    count = (2 if double else 1) * len(x)
    nothing = x[:0]
    return Roots(
        x=nothing if double or curve else x,
        multiple=x if double and not curve else nothing,
        paths=2,
        at_infinity=0 if curve else 2 - count,
        singular=2 if curve else count if double else 0,
        failed=0,
        expected=expected,
        sure=True,
        continuum=curve,
        curves=x if curve else nothing,
    )
