"""The interface between equations and the numerical methods that solve and prove them."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cache
from typing import Any, NoReturn, Protocol, Self, dataclass_transform

import numpy as np

from linkwork.core.foundation.arrays import (
    EPSILON,
    FAR,
    SMALLEST_RATIO,
    AnyArray,
    Array,
    BoolArray,
    CountArray,
    IndexArray,
    StatusArray,
    solutions,
)
from linkwork.core.foundation.statuses import CONVERGED, Certification, Status
from linkwork.core.foundation.values import check_values
from linkwork.core.table.loop_table import Curvature


class SmallSystem(Protocol):
    """Equations F(v) = 0 with v = (unknowns, inputs), batched over the first axis of v (B, N)."""

    @property
    def unknowns(self) -> int:
        """The number n of unknowns, which are the first variables."""

    @property
    def equation_scale(self) -> Array:
        """(m,) scales that divide residuals before these are compared."""

    @property
    def variable_scale(self) -> Array:
        """(N,) weights of the variables."""

    def residual_and_jacobian(self, v: Array) -> tuple[Array, Array]:
        """F, (B, m), and dF/dv, (B, m, N)."""

    def hessians(self, v: Array, weights: Array) -> Array:
        """Second derivatives of K sums of equations at one position v (N,), (K, N, N); ``weights``
        (K, m): the factor of every equation in each sum.
        """


class System(SmallSystem, Protocol):
    """Equations with the further functions that path following and proofs need."""

    @property
    def is_angle(self) -> BoolArray:
        """(N,) which variables are angles."""

    def residual(self, v: Array) -> Array:
        """F, (B, m)."""

    def exact_residual(self, v: Array) -> tuple[Array, Array]:
        """F at one position v (N,), (m,), with as little rounding as the equations allow, and a
        bound of its error.
        """

    def jacobian(self, v: Array) -> Array:
        """dF/dv, (B, m, N)."""

    def second_directional_derivative(self, v: Array, d: Array) -> Array:
        """D²F[d, d], (B, m)."""

    @property
    def has_curvature_bound(self) -> bool:
        """Whether :meth:`curvature` gives a bound."""

    @property
    def is_enclosed(self) -> bool:
        """Whether :meth:`enclosure` gives bounds."""

    def enclosure(self, v: Array, box: Array) -> tuple[Array, Array]:
        """Lowest and highest F, (2, B, m), and dF/dv, (2, B, m, N), over boxes around v (B, N)
        with half widths ``box`` (B, N), with all rounding.
        """

    def curvature(self, v: Array, matrix: Array) -> Curvature:
        """Moduli of the second derivatives multiplied by a matrix (B, n, m)."""


class BlockFunctions(Protocol):
    """A block's arithmetic as functions; see :mod:`linkwork.core.record.block_record`."""

    def __getattr__(self, name: str) -> Callable[..., Any]:
        """``solve``, ``correct``, ``rates``, ``balanced``, ``place`` or ``within``."""


class Recorded(Protocol):
    """A block whose arithmetic is recorded."""

    @property
    def of_floats(self) -> BlockFunctions:
        """Its functions of floats."""

    @property
    def of_arrays(self) -> BlockFunctions:
        """Its functions of arrays."""


# ----------------------------------------------------------------------
# Rows with named columns; positions of one mechanism with everything that is known of each.


#: A column that has not been computed: empty.
UNKNOWN: Any = np.empty(0)


@dataclass_transform(kw_only_default=True, frozen_default=True)
class Columns:
    """Arrays over the same rows by name, read-only; one that is not given keeps its default.

    A data class would set each of twenty columns one by one, which takes longer than a step of
    Newton-Raphson on a small block.
    """

    def __init__(self, **columns: AnyArray) -> None:
        for column in columns.values():
            column.setflags(write=False)
        vars(self).update(columns)

    def __setattr__(self, name: str, value: object) -> NoReturn:
        raise TypeError("columns are read-only: make others with set, put or with_columns")

    @property
    def columns(self) -> dict[str, AnyArray]:
        """The columns that have been computed, by name."""
        return dict(vars(self))

    def with_columns(self, **columns: AnyArray) -> Self:
        """The rows with some columns added or replaced."""
        return type(self)(**(vars(self) | columns))

    def take(self, where: IndexArray | slice) -> Self:
        """Some rows, in the order of ``where``."""
        return type(self)(**{name: column[where] for name, column in vars(self).items()})

    @classmethod
    def concatenate(cls, parts: Sequence[Self]) -> Self:
        """Rows one after the other, with the columns that all parts have."""
        columns = [part.columns for part in parts]
        names = [name for name in columns[0] if all(name in other for other in columns)]
        return cls(**{name: np.concatenate([c[name] for c in columns]) for name in names})

    def put(self, where: IndexArray, others: Self) -> Self:
        """The rows with some replaced by others one by one; columns unknown of those stay."""
        changed = self.columns
        for name in changed.keys() & others.columns.keys():
            changed[name] = changed[name].copy()
            changed[name][where] = getattr(others, name)
        return type(self)(**changed)

    def set(self, where: Any = slice(None), **values: Any) -> Self:
        """The rows with values of some columns set at the rows ``where``."""
        changed = self.columns
        for name, value in values.items():
            changed[name] = changed[name].copy()
            changed[name][where] = value
        return type(self)(**changed)


class SolvedRows(Columns):
    """B positions of one mechanism in internal units; every column is read-only.

    A step of the solution computes some columns; the others are ``UNKNOWN``.

    Parameters
    ----------
    v : (B, N)
        Unknowns followed by the inputs, NaN where there is no position.
    t : (B,)
        Values of the path's parameter.
    status, iterations, residual : (B,)
        How Newton-Raphson ended; the largest scaled residual.
    first_step, contraction : (B,)
        Of Newton-Raphson: weighted size of the first correction; largest ratio of successive
        corrections that were above rounding.
    failed_block : (B,)
        The block that did not converge, -1 where all did.
    first, second : (B, N)
        Derivatives by t, NaN where they do not exist.
    condition, nearness : (B,)
        Largest over the blocks of ‖J‖·‖J⁻¹‖ (largest norm, weighted); how near to a singular
        position: the condition itself unless lengths differ much.
    orientation : (B, blocks)
        Sign of det J, 0 where J is singular.
    input_radius : (B, p)
        How far the intended inputs may be from those in v.
    certification, radius, uniqueness_radius : (B,)
        Codes of :class:`Certification`; a true position lies within the one radius, no other
        within the other (weighted), NaN without a proof.
    inputs : (B, p)
        The inputs asked for, in file units.
    branch, limit : (B,)
        Names, or "".
    """

    v: Array
    t: Array = UNKNOWN
    status: StatusArray = UNKNOWN
    iterations: CountArray = UNKNOWN
    residual: Array = UNKNOWN
    first_step: Array = UNKNOWN
    contraction: Array = UNKNOWN
    failed_block: CountArray = UNKNOWN
    first: Array = UNKNOWN
    second: Array = UNKNOWN
    condition: Array = UNKNOWN
    nearness: Array = UNKNOWN
    orientation: StatusArray = UNKNOWN
    input_radius: Array = UNKNOWN
    certification: StatusArray = UNKNOWN
    radius: Array = UNKNOWN
    uniqueness_radius: Array = UNKNOWN
    inputs: Array = UNKNOWN
    branch: AnyArray = UNKNOWN
    limit: AnyArray = UNKNOWN

    def __len__(self) -> int:
        return len(self.v)

    @classmethod
    def blank(
        cls,
        inputs: Array,
        variables: int,
        status: Status,
        certification: Certification = Certification.NO_POSITION,
    ) -> SolvedRows:
        """Rows of a table without positions, all for one reason."""
        count = len(inputs)
        nothing, unknown = np.full((count, variables), np.nan), np.full(count, np.nan)
        names = np.full(count, "", dtype=object)
        return cls(
            inputs=np.array(inputs, dtype=float),
            v=nothing,
            first=nothing,
            second=nothing,
            status=np.full(count, status.code, dtype=np.int8),
            iterations=np.zeros(count, dtype=np.int64),
            residual=unknown,
            condition=unknown,
            certification=np.full(count, certification.code, dtype=np.int8),
            radius=unknown,
            uniqueness_radius=unknown,
            branch=names,
            limit=names,
        )

    @property
    def asks_for_proofs(self) -> bool:
        """Whether the rows of a table are to be proved."""
        return not (self.certification == Certification.NOT_ASKED.code).any()

    def demote(self, standing: Certification) -> SolvedRows:
        """The rows with those that are certified on their branch limited to ``standing``."""
        return self.set(
            self.certification == Certification.CERTIFIED.code, certification=standing.code
        )


# ----------------------------------------------------------------------
# Newton-Raphson for many starts at once, with the two tolerances of the textbook.


@dataclass(frozen=True, kw_only=True)
class NewtonOptions:
    """Stopping criteria of Newton-Raphson, and the limit of one step.

    Parameters
    ----------
    equation_tolerance : float
        ε_e: stop when every scaled residual is at most this.
    solution_tolerance : float
        ε_s: stop when every weighted change is at most this.
    max_steps : int
        m: stop without a solution after this many steps.
    largest_turn : float
        A step that turns an angle further than this [rad] is shortened as a whole; ``inf`` gives
        the plain textbook method.

    Examples
    --------
    >>> import linkwork as lw
    >>> options = lw.NewtonOptions(max_steps=1)
    >>> lw.example("four-bar").solve(at=60, from_guess=True, options=options).status.name
    'STEP_LIMIT'
    """

    equation_tolerance: float = 1e-14
    solution_tolerance: float = 1e-9
    max_steps: int = 50
    largest_turn: float = math.radians(40.0)

    def __post_init__(self) -> None:
        check_values(self)


@cache
def sharp(options: NewtonOptions) -> NewtonOptions:
    """The same, iterated down to rounding."""
    return replace(options, equation_tolerance=EPSILON)


@cache
def unlimited(options: NewtonOptions, max_steps: int, tolerance: float) -> NewtonOptions:
    """The same for predictions: few plain steps, to a solution tolerance."""
    return replace(
        options, max_steps=max_steps, largest_turn=math.inf, solution_tolerance=tolerance
    )


Watch = Callable[[int, Array, Array, Array | None], None]


def newton(
    system: System,
    start: Array,
    options: NewtonOptions | None = None,
    watch: Watch | None = None,
) -> SolvedRows:
    """Solve F(v) = 0 for the first n variables from every row of ``start``.

    Parameters
    ----------
    system : System
    start : (B, N)
        Guesses of the unknowns followed by the inputs.
    options : NewtonOptions
    watch : callable, optional
        Called as ``watch(k, v, residual, change)`` at every iterate, for showing a single start.

    Returns
    -------
    SolvedRows
        ``v``, ``status``, ``iterations``, ``residual``, ``first_step``, ``contraction``; the loop's
        exit is the status.

    Notes
    -----
    Quadratic at regular solutions. Rows that are done leave the batch.
    """
    opt = options or NewtonOptions()
    with np.errstate(all="ignore"):
        return _Iteration(system, start, opt, watch).run()


class _Iteration:
    """The state of a batch: rows that are done leave ``live``."""

    def __init__(
        self, system: System, start: Array, options: NewtonOptions, watch: Watch | None
    ) -> None:
        count, n = len(start), system.unknowns
        self.system, self.options, self.watch = system, options, watch
        self.v = start.copy()
        self.status = np.full(count, CONVERGED, dtype=np.int8)
        self.iterations = np.zeros(count, dtype=np.int64)
        self.residual = np.full(count, np.inf)
        self.first = np.zeros(count)
        self.contraction = np.zeros(count)
        self.live = np.arange(count)
        self.last = np.full(count, np.inf)  # weighted size of each live row's latest correction
        self.weights = system.variable_scale[:n]
        # steps are shortened by angles only: lengths have no natural limit
        turns = system.is_angle[:n]
        self.turns = turns if turns.any() and not math.isinf(options.largest_turn) else None

    def run(self) -> SolvedRows:
        """Iterate until every row has left."""
        for k in range(self.options.max_steps + 1):
            self._step(k)
            if not len(self.live):
                break
        return SolvedRows(
            v=self.v,
            status=self.status,
            iterations=self.iterations,
            residual=self.residual,
            first_step=self.first,
            contraction=self.contraction,
        )

    def _step(self, k: int) -> None:
        system, opt, n = self.system, self.options, self.system.unknowns
        # a copy of the whole batch is saved as long as no row has left
        whole = len(self.live) == len(self.v)
        here = self.v if whole else self.v[self.live]
        if (self.last <= opt.solution_tolerance).all():  # all done: only the evidence is missing
            f, jacobian = system.residual(here), None
        else:
            f, jacobian = system.residual_and_jacobian(here)
        error = np.abs(f / system.equation_scale).max(axis=1, initial=0.0)
        self.residual[self.live] = error
        # "not <" instead of ">=": an error of NaN is lost too
        lost = ~(error < np.inf) | (self.last > FAR) & (k > 0)
        done = (error <= opt.equation_tolerance) | (self.last <= opt.solution_tolerance)  # eq. (8)
        if jacobian is None or k == opt.max_steps or lost.any() or done.any():
            self._leave(lost, Status.DIVERGED)
            late = ~(lost | done) & (k == opt.max_steps)
            self._leave(late, Status.STEP_LIMIT)
            stay = ~(lost | done | late)
            if self.watch is not None and not stay[0]:
                self.watch(k, here, f, None)
            self._keep(stay)
            if jacobian is None or not len(self.live):
                return
            here, f, jacobian = here[stay], f[stay], jacobian[stay]
        change = self._correct(k, here, f, jacobian[:, :, :n])
        if not len(self.live):
            return
        self.v[self.live, :n] += change  # eq. (6)
        self.iterations[self.live] += 1
        size = np.abs(change / self.weights).max(axis=1, initial=0.0)
        if k == 0:
            self.first[self.live] = size
        else:
            ratio = np.where(size > SMALLEST_RATIO, size / self.last, 0.0)
            self.contraction[self.live] = np.maximum(self.contraction[self.live], ratio)
        self.last = size

    def _correct(self, k: int, here: Array, f: Array, jacobian: Array) -> Array:
        """The corrections of the live rows; rows with a singular Jacobian leave."""
        change, singular = corrections(jacobian, f)
        if singular.any():
            self._leave(singular, Status.SINGULAR_JACOBIAN)
            if self.watch is not None:
                self.watch(k, here, f, None)
            self._keep(~singular)
            change = change[~singular]
        if self.turns is not None:
            change = _shorten(change, self.turns, self.options.largest_turn)
        if self.watch is not None and len(change):
            self.watch(k, here, f, change)
        return change

    def _leave(self, rows: BoolArray, status: Status) -> None:
        if rows.any():
            self.status[self.live[rows]] = status.code

    def _keep(self, rows: BoolArray) -> None:
        self.live, self.last = self.live[rows], self.last[rows]


def corrections(jacobian: Array, f: Array) -> tuple[Array, BoolArray]:
    """-J⁻¹F per lane, and the lanes where J is singular to rounding."""
    change: Array = -solutions(jacobian, f[:, :, None])[:, :, 0]  # eq. (6)
    singular: BoolArray = np.logical_not(np.isfinite(change).all(axis=1))
    return change, singular


def _shorten(change: Array, turns: BoolArray, largest: float) -> Array:
    """Corrections scaled down so that no angle turns further than allowed."""
    turn = np.abs(change[:, turns]).max(axis=1)
    if not (turn > largest).any():
        return change
    # eq. (7)
    shortened: Array = change * np.minimum(1.0, largest / np.maximum(turn, 1e-300))[:, None]
    return shortened


# ----------------------------------------------------------------------
# The nearest miss: where a system that may have no solution comes closest to one.
#
# Levenberg-Marquardt (Marquardt 1963, doi:10.1137/0111030) on scaled residuals and variables. Where
# much is missing, its model JᵀJ of the curvature is too poor for more than slow progress; the last
# stretch then uses Newton's method with all of the curvature, JᵀJ + Σ r_k ∇²r_k.


_MOST_UNKNOWNS = 40  # of a system whose whole curvature is formed
_NEWTON_STEPS = 30
_CLOSED = 1e-20  # sum of squares of a position: there is nothing to refine


def nearest_miss(system: System, start: Array, steps: int = 200) -> tuple[Array, Array]:
    """Minimise the sum of squares of the scaled residuals from one start.

    Parameters
    ----------
    start : (N,)
        Guess of the unknowns followed by the inputs.

    Returns
    -------
    v, f : (N,), (m,)
        The minimiser found and the unscaled residuals there.
    """
    n = system.unknowns
    v = start[None, :].copy()
    scale, weights = system.equation_scale, system.variable_scale[:n]
    damping = 1e-3
    f, jacobian = system.residual_and_jacobian(v)
    r = f[0] / scale
    for _ in range(steps):
        j = jacobian[0, :, :n] * weights / scale[:, None]
        gradient = j.T @ r
        if not np.isfinite(gradient).all() or np.abs(gradient).max(initial=0.0) < 1e-15:
            break
        normal = j.T @ j
        try:
            change = -np.linalg.solve(normal + damping * np.eye(n), gradient)  # eq. (9)
        except np.linalg.LinAlgError:  # so little damping is lost to rounding
            damping *= 5.0
            continue
        trial = v.copy()
        trial[0, :n] += change * weights
        f_trial, j_trial = system.residual_and_jacobian(trial)
        r_trial = f_trial[0] / scale
        if np.isfinite(r_trial).all() and r_trial @ r_trial < r @ r:
            v, f, jacobian, r = trial, f_trial, j_trial, r_trial
            # a good step is followed by one nearer to Newton, a bad one by one nearer to the
            # gradient
            damping = max(damping * 0.2, 1e-15)
            if np.abs(change).max() < 1e-14:
                break
        else:
            damping *= 5.0
            if damping > 1e12:
                break
    if n <= _MOST_UNKNOWNS and np.isfinite(r).all() and r @ r > _CLOSED:
        v, f = _refine_minimum(system, v, f)
    return v[0], f[0]


def _refine_minimum(system: System, v: Array, f: Array) -> tuple[Array, Array]:
    """Newton's method for the minimum near v (1, N); stops where it would lead uphill."""
    n = system.unknowns
    scale, weights = system.equation_scale, system.variable_scale[:n]
    for _ in range(_NEWTON_STEPS):
        r = f[0] / scale
        j = system.jacobian(v)[0, :, :n] * weights / scale[:, None]
        gradient = j.T @ r
        bends = system.hessians(v[0], (r / scale)[None, :])[0, :n, :n]
        hessian = j.T @ j + weights[:, None] * bends * weights  # eq. (10)
        try:
            # only a positive definite Hessian leads downhill, and then to a minimum
            np.linalg.cholesky(hessian)
            change = -np.linalg.solve(hessian, gradient)
        except np.linalg.LinAlgError:
            break
        trial = v.copy()
        trial[0, :n] += change * weights
        f_trial = system.residual(trial)
        r_trial = f_trial[0] / scale
        if not (np.isfinite(r_trial).all() and r_trial @ r_trial < r @ r):
            break
        v, f = trial, f_trial
        if np.abs(change).max() < 1e-14:
            break
    return v, f
