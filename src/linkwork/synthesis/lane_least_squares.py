"""Bounds of the parameters and of the row variables of a fit of lanes."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from linkwork.core.foundation.arrays import EPSILON, AnyArray, Array, Batch, BoolArray, IndexArray
from linkwork.core.foundation.loading import cores, share_out


@dataclass(frozen=True, kw_only=True, eq=False)
class Box:
    """Bounds of the parameters.

    Parameters
    ----------
    least, most : (P,)
    least_effect : float
        Parameters that change residuals less than this part of the largest change, each over its
        whole range, are damped as if they changed them so much.
    """

    least: Array
    most: Array
    least_effect: float = 0.0

    def inside(self, x: Array) -> Array:
        """The nearest parameters in the box."""
        return np.asarray(np.clip(x, self.least, self.most))

    def least_scale(self, scale: Array) -> Array:
        """What is added to the squares of effects (D, P) that damp parameters."""
        square = (self.most - self.least) ** 2
        ranged = np.isfinite(square) & (square > 0.0)
        most = np.where(ranged, scale * square, 0.0).max(axis=1, keepdims=True, initial=0.0)
        return np.where(ranged, self.least_effect**2 * most / square, 0.0)


@dataclass(frozen=True, kw_only=True)
class RowVariables:
    """Bounds and order of the row variables, of which each row has one.

    Parameters
    ----------
    least, most : float
        The bounds of all row variables.
    in_order : bool
        Whether they rise from row to row.
    gap, span : float
        Of variables in order: they rise by ``gap`` or more, and by less than ``span`` altogether.
    """

    least: float = -np.inf
    most: float = np.inf
    in_order: bool = False
    gap: float = 0.0
    span: float = np.inf

    def inside(self, t: Array) -> Array:
        """Variables (D, N) moved into order, each as little as those before it allow, and between
        the bounds.
        """
        low, high = self._bounds(t.shape[1])
        if self.in_order:
            steps = self.gap * np.arange(t.shape[1])
            t = np.maximum.accumulate(t - steps, axis=1) + steps
            t = np.minimum(t, t[:, :1] + self.span - steps[::-1])
        return np.asarray(np.clip(t, low, high))

    def held(self, t: Array, slope: Array) -> BoolArray:
        """Whether a row is at a bound that it would pass down the slope, (D, N)."""
        low, high = self._bounds(t.shape[1])
        return np.asarray(((t <= low) & (slope > 0.0)) | ((t >= high) & (slope < 0.0)))

    def together(self, t: Array, pull: Array) -> Array | None:
        """Which rows move as one, (D, N, N): those that touch and are pushed together."""
        if not self.in_order:
            return None
        contact = np.zeros(t.shape, dtype=bool)
        # down the slope the later row would come before the earlier one
        contact[:, 1:] = np.diff(t, axis=1) <= self.gap * (1.0 + 1e-3)
        contact[:, 1:] &= pull[:, 1:] >= pull[:, :-1]
        if not contact.any():
            return None
        group = np.cumsum(~contact, axis=1)
        return np.asarray((group[:, :, None] == group[:, None, :]).astype(float))

    def _bounds(self, count: int) -> tuple[Array, Array]:
        """Bounds of each row, which leave room for those before and after it."""
        steps = self.gap * np.arange(count)
        return np.asarray(self.least + steps), np.asarray(self.most - steps[::-1])


# ----------------------------------------------------------------------
# Bounded least squares of many starts at once, by Levenberg and Marquardt.
#
# A lane minimises |f(x, t)|² over parameters x (P,) in a box. The residuals come in N rows of m,
# and row k may have one row variable t_k, such as the input at which a curve comes nearest to
# a point. These variables are eliminated from every step, eq. (152), and may be kept in order.
#
# References
# ----------
# D. W. Marquardt, An algorithm for least-squares estimation of nonlinear parameters, SIAM Journal
# 11 (1963), doi:10.1137/0111030. G. H. Golub, V. Pereyra, Separable nonlinear least squares,
# Inverse Problems 19 (2003) R1, doi:10.1088/0266-5611/19/2/201.


_FIRST_DAMPING, _LESS, _MORE = 1e-3, 0.2, 4.0
_AFTER_MORE = 0.8  # less at the first step that gains: the failed step would fail again
_LARGEST_DAMPING, _SMALLEST_DAMPING = 1e10, 1e-14
_IDLE = 1e-13  # relative decrease of the sum of squares: rounding
_MOST_IDLE = 3  # steps in a row
_ROUNDINGS = 8.0 * EPSILON  # relative change of numbers: rounding
_SINGULAR = 1e-13  # of a diagonal entry: keeps the matrix regular


@dataclass(frozen=True, eq=False)
class Residuals(Batch):
    """Residuals of D lanes with their derivatives; NaN where they do not exist.

    Parameters
    ----------
    rows : (D, N, m)
    by_x : (D, N, m, P)
    by_t : (D, N, m), optional
        Each row by its row variable; ``None`` without row variables.
    shared : (D, K)
        Further residuals, of the parameters alone.
    shared_by_x : (D, K, P)
    """

    rows: Array
    by_x: Array
    by_t: Array | None
    shared: Array
    shared_by_x: Array

    def replaced(self, which: BoolArray, other: Residuals) -> Residuals:
        """Those of another place in some lanes."""
        there = other._arrays
        parts: Any = {name: _either(which, there[name], old) for name, old in self._arrays.items()}
        return replace(self, **parts)

    @property
    def total(self) -> Array:
        """The sums of squares, (D,); infinite where residuals do not exist."""
        flat = self.rows.reshape(len(self.rows), -1)
        with np.errstate(all="ignore"):
            total = np.einsum("dk,dk->d", flat, flat)
            total += np.einsum("dk,dk->d", self.shared, self.shared)
        return np.asarray(np.where(np.isfinite(total), total, np.inf))


#: Residuals of parameters (D, P) and row variables (D, N) of the lanes with these numbers, (D,).
Evaluate = Callable[[Array, Array, IndexArray], Residuals]


_ANYWHERE = RowVariables()


@dataclass(frozen=True, kw_only=True, eq=False)
class LaneFit(Batch):
    """Where D lanes are.

    Parameters
    ----------
    x : (D, P)
    t : (D, N)
        Own variables of the rows.
    total : (D,)
        The sum of squares; infinite where residuals do not exist.
    damping : (D,)
    failed : (D,) bool
        Whether the last step gained nothing.
    idle : (D,)
        The number of steps in a row that gained nothing.
    interrupted : bool
        Whether the user stopped the steps.
    """

    x: Array
    t: Array
    total: Array
    damping: Array
    failed: BoolArray
    idle: IndexArray
    interrupted: bool = False

    def __len__(self) -> int:
        return len(self.total)

    @property
    def done(self) -> BoolArray:
        """Lanes that gain nothing more."""
        return np.asarray(
            (self.idle >= _MOST_IDLE)
            | (self.damping > _LARGEST_DAMPING)
            | ~np.isfinite(self.total)
            | (self.total == 0.0)
        )

    def put(self, index: IndexArray, part: LaneFit) -> None:
        """Replace some of the lanes."""
        for name, x in self._arrays.items():
            x[index] = getattr(part, name)


def starts_of(x: Array, t: Array) -> LaneFit:
    """Lanes (D, P), (D, N) that have done no step yet."""
    count = len(x)
    return LaneFit(
        x=x,
        t=t,
        total=np.full(count, np.inf),
        damping=np.full(count, _FIRST_DAMPING),
        failed=np.zeros(count, dtype=bool),
        idle=np.zeros(count, dtype=np.intp),
    )


def minimise(
    evaluate: Evaluate,
    fit: LaneFit,
    box: Box,
    steps: int,
    *,
    row_variables: RowVariables = _ANYWHERE,
) -> LaneFit:
    """Lanes after some steps, or fewer where they gain nothing more.

    Parameters
    ----------
    evaluate : function of (D, P), (D, N) and the numbers of lanes
    fit : LaneFit
    box : Box
    steps : int
    row_variables : RowVariables

    Returns
    -------
    LaneFit
        As many lanes, in the same order.

    Notes
    -----
    An interruption (Ctrl-C) ends the steps; the lanes stay where they are then.
    """
    lanes = np.arange(len(fit))
    fitted = fit.take(lanes)
    x = box.inside(fit.x)
    t = row_variables.inside(fit.t)
    now = evaluate(x, t, lanes)
    # sums and damping of another problem are of no use here
    damping = np.minimum(fit.damping, _FIRST_DAMPING)
    idle = np.zeros_like(fit.idle)
    work = replace(fit, x=x, t=t, total=now.total, damping=damping, idle=idle)
    interrupted = False
    try:
        for _ in range(steps):
            done = work.done
            if done.any():
                fitted.put(lanes, work)
                left = ~done
                lanes, work, now = lanes[left], work.take(left), now.take(left)
            if not len(lanes):
                break
            work, now = _step(evaluate, work, now, lanes, box, row_variables)
    except KeyboardInterrupt:
        interrupted = True
    fitted.put(lanes, work)
    return replace(fitted, interrupted=interrupted or fit.interrupted)


def _step(
    evaluate: Evaluate,
    work: LaneFit,
    now: Residuals,
    lanes: IndexArray,
    box: Box,
    row_variables: RowVariables,
) -> tuple[LaneFit, Residuals]:
    """One step of every lane; those that gain nothing by it stay and are damped more."""
    dx, dt = _newton_step(work, now, box, row_variables)
    x, t = box.inside(work.x + dx), row_variables.inside(work.t + dt)
    there = evaluate(x, t, lanes)
    total = there.total
    better = total < work.total
    with np.errstate(invalid="ignore"):  # infinite sums have no difference
        change = np.abs(work.total - total)
    # a step that changes the sum by rounding alone gains nothing, in whichever direction
    still = (change <= _IDLE * work.total) | _unmoved(work.x, x) & _unmoved(work.t, t)
    idle = np.where(still, work.idle + 1, np.where(better, 0, work.idle))
    less = np.where(work.failed, _AFTER_MORE, _LESS)
    damping = np.where(
        better, np.maximum(work.damping * less, _SMALLEST_DAMPING), work.damping * _MORE
    )
    return (
        replace(
            work,
            x=_either(better, x, work.x),
            t=_either(better, t, work.t),
            total=np.where(better, total, work.total),
            damping=damping,
            failed=~better,
            idle=idle,
        ),
        now.replaced(better, there),
    )


def _unmoved(old: Array, new: Array) -> BoolArray:
    """Lanes whose numbers (D, K) change by rounding alone."""
    with np.errstate(invalid="ignore"):
        return np.asarray((np.abs(new - old) <= _ROUNDINGS * np.abs(old)).all(axis=1))


def _either(which: BoolArray, new: Array, old: Array) -> Array:
    return np.asarray(np.where(which.reshape(-1, *[1] * (new.ndim - 1)), new, old))


@np.errstate(all="ignore")  # lanes without residuals have no step
def _newton_step(
    work: LaneFit, now: Residuals, box: Box, rows: RowVariables
) -> tuple[Array, Array]:
    """Changes of x (D, P) and t (D, N)."""
    count, parameters = work.x.shape
    flat = now.by_x.reshape(count, -1, parameters)
    residuals = now.rows.reshape(count, -1, 1)
    transposed = flat.transpose(0, 2, 1)
    normal, gradient = transposed @ flat, (transposed @ residuals)[:, :, 0]
    if now.shared.shape[1]:
        across = now.shared_by_x.transpose(0, 2, 1)
        normal += across @ now.shared_by_x
        gradient += (across @ now.shared[:, :, None])[:, :, 0]
    scale = np.einsum("dpp->dp", normal)
    if now.by_t is None:
        dx = _solved(normal, gradient, scale, work, box)
        return dx, np.zeros_like(work.t)
    # eq. (152): the row variables, or those of rows that touch, are eliminated
    by_t = np.einsum("dnm,dnm->dn", now.by_t, now.by_t)
    slope = np.einsum("dnm,dnm->dn", now.by_t, now.rows)
    mixed = np.einsum("dnm,dnmp->dnp", now.by_t, now.by_x)
    curve = by_t * (1.0 + work.damping[:, None]) + EPSILON * (
        by_t.max(axis=1, keepdims=True) + 1e-300
    )
    together = rows.together(work.t, slope / curve)
    summed, slopes, mixtures = curve, slope, mixed
    if together is not None:
        summed = (together @ curve[:, :, None])[:, :, 0]
        slopes = (together @ slope[:, :, None])[:, :, 0]
        mixtures = together @ mixed
    held = rows.held(work.t, slopes)
    if together is not None:
        held = (together @ held[:, :, None])[:, :, 0] > 0.0
    shares = np.where(held[:, :, None], 0.0, mixtures / summed[:, :, None])
    normal = normal - mixed.transpose(0, 2, 1) @ shares
    gradient = gradient - (shares.transpose(0, 2, 1) @ slope[:, :, None])[:, :, 0]
    dx = _solved(normal, gradient, scale, work, box)
    dt = -(slopes + (mixtures @ dx[:, :, None])[:, :, 0]) / summed
    return dx, np.where(held, 0.0, dt)


def _solved(normal: Array, gradient: Array, scale: Array, work: LaneFit, box: Box) -> Array:
    """The damped step of x, which leaves parameters at their bounds that would pass them."""
    held = ((work.x <= box.least) & (gradient > 0.0)) | ((work.x >= box.most) & (gradient < 0.0))
    held |= box.least == box.most
    # parameters have different units; those without effect stay
    damped = scale + box.least_scale(scale)
    diagonal = work.damping[:, None] * damped + _SINGULAR * np.where(damped > 0.0, damped, 1.0)
    parameters = normal.shape[1]
    matrix = normal + diagonal[:, :, None] * np.eye(parameters)
    if held.any():
        free = ~held
        matrix = matrix * (free[:, :, None] & free[:, None, :])
        matrix += held[:, :, None] * np.eye(parameters)
        gradient = np.where(held, 0.0, gradient)
    wrong = ~np.asarray(np.isfinite(matrix).all(axis=(1, 2)) & np.isfinite(gradient).all(axis=1))
    matrix[wrong], right = np.eye(parameters), np.where(wrong[:, None], 0.0, -gradient)
    return np.asarray(np.linalg.solve(matrix, right[:, :, None])[:, :, 0])


# ----------------------------------------------------------------------
# Least squares and minimax of lanes in rounds, with constraints, on all cores.
#
# A :class:`LaneProblem` has the residuals of designs in lanes. Curves, functions, mechanisms and
# fronts are such problems: each chooses which lanes go on, for how many steps, and how residuals
# count.


# ----------------------------------------------------------------------
# Constraints of lanes, by the method of multipliers.
#
# A constraint h ≤ 0 adds the residual max(0, h + s), eq. (155). After a round of steps its shift s
# becomes max(0, h + s), so that in the end h ≤ 0 holds and not only nearly.
#
# References
# ----------
# M. J. D. Powell, A method for nonlinear constraints in minimization problems, in: Optimization,
# Academic Press 1969, 283-298.


class Multipliers:
    """The shifts of constraints of lanes, and the weight of their residuals.

    Parameters
    ----------
    shape : (int, ...)
        Lanes, then constraints.
    """

    def __init__(self, *shape: int) -> None:
        self.shift, self.weight = np.zeros(shape), 1.0
        self._new = np.zeros(shape)

    def weigh(self, weight: float) -> None:
        """Change the weight; the multipliers, weight² times the shifts, stay."""
        self.shift *= (self.weight / weight) ** 2
        self.weight = weight

    @np.errstate(invalid="ignore")  # where there is no position there is no number
    def residuals(
        self, lanes: IndexArray, h: Array, *slopes: AnyArray, unit: Any = 1.0
    ) -> tuple[Array, ...]:
        """How far constraints of lanes are broken, (D, ...), and the derivatives of that.

        ``slopes``: those of h, divided by a unit; of complex ones the real part counts.
        """
        over = np.maximum(0.0, h + self.shift[lanes])  # eq. (155)
        self._new[lanes] = np.nan_to_num(over)
        broken, factor = over > 0.0, self.weight * unit

        def kept(slope: AnyArray) -> Array:
            if slope.ndim == h.ndim:
                return np.where(broken, (factor * slope).real, 0.0)
            wide = factor if np.ndim(factor) == 0 else factor[..., None]
            return np.where(broken[..., None], (wide * slope).real, 0.0)

        return (self.weight * over, *map(kept, slopes))

    def update(self, lanes: IndexArray) -> None:
        """New shifts of lanes, of where their residuals were computed last."""
        self.shift[lanes] = self._new[lanes]


# ----------------------------------------------------------------------
# The largest miss, minimised as the limit of sums of growing powers.
#
# Least squares of residuals f |f|^(k-1) minimise the sum of |f|^(2k), eq. (158). Each power begins
# at the solution of the one before. The largest of N misses is then above the least possible by a
# factor N^(1/2k) at most.
#
# References
# ----------
# G. Pólya, Sur un algorithme toujours convergent pour obtenir les polynomes de meilleure
# approximation de Tchebycheff, Comptes Rendus 157 (1913) 840-843.


#: Powers k in their order.
POWERS = (2, 4, 8, 16, 32, 64, 128, 256, 512)


def largest_misses(residuals: Residuals, counted: BoolArray) -> Array:
    """The largest distance or counted shared residual of lanes, (D,)."""
    rows = np.sqrt(np.einsum("dnm,dnm->dn", residuals.rows, residuals.rows))
    every = np.concatenate([rows, np.abs(residuals.shared[:, counted])], axis=1)
    return np.asarray(every.max(axis=1, initial=0.0))


@np.errstate(all="ignore")  # lanes without residuals stay without
def powered(residuals: Residuals, power: int, largest: Array, counted: BoolArray) -> Residuals:
    """Residuals of powers, relative to the largest miss (D,) at the begin of their round.

    ``counted`` (K,): the shared residuals that are misses; the others, broken bounds, stay.
    """
    scale = largest[:, None]
    size = np.sqrt(np.einsum("dnm,dnm->dn", residuals.rows, residuals.rows))
    factor = (size / scale) ** (power - 1) / scale
    unit = residuals.rows / np.where(size > 0.0, size, 1.0)[:, :, None]

    def bent(slope: Array) -> Array:
        # eq. (158): |f|^(k-1) (I + (k - 1) u uᵀ) df
        along = np.einsum("dnm,dnm...->dn...", unit, slope)
        turned = np.einsum("dnm,dn...->dnm...", unit, along)
        whole = slope + (power - 1) * turned
        return np.asarray(factor.reshape(*factor.shape, *[1] * (slope.ndim - 2)) * whole)

    shared, by_x = residuals.shared / scale, residuals.shared_by_x / scale[:, :, None]
    factors = np.where(counted, np.abs(shared) ** (power - 1), 1.0)
    slope = np.where(counted, power * factors, 1.0)
    return Residuals(
        residuals.rows * factor[:, :, None],
        bent(residuals.by_x),
        None if residuals.by_t is None else bent(residuals.by_t),
        shared * factors,
        by_x * slope[:, :, None],
    )


# ----------------------------------------------------------------------
# Work on parts of lanes on all cores, with progress; the user may stop it.


_PART = 8  # lanes of one thread, of many rows
_ROWS = 4000  # of all lanes of a thread: fewer would take as long

#: Called with the finished fraction.
Progress = Callable[[float], None]


def part_of(progress: Progress | None, begin: float, share: float) -> Progress | None:
    """The progress of a part of the work, which begins at a fraction of it and has this share."""
    if progress is None:
        return None
    return lambda fraction: progress(begin + share * fraction)


#: Works on lanes, and calls its second argument before each step.
Work = Callable[[IndexArray, Callable[[], None]], None]


class LaneWork:
    """All work on the lanes of a fit.

    Parameters
    ----------
    rows : int
        Of each lane.
    most : int
        Lanes of one thread.

    Attributes
    ----------
    tell : callable, optional
        Called with the finished fraction.
    whole, done : float
        Steps, each of which counts for the share of lanes that go on.
    share_of_lanes : float
    stopped : bool
        Whether the user has stopped the work.
    """

    def __init__(self, rows: int, most: int) -> None:
        self.rows, self.most = rows, most
        self.tell: Progress | None = None
        self.whole, self.done, self.share_of_lanes = 1.0, 0.0, 1.0
        self.stopped = False

    def parts(self, lanes: IndexArray) -> list[IndexArray]:
        """Parts whose sizes do not depend on the number of cores; one at least."""
        size = min(max(_PART, _ROWS // max(1, self.rows)), self.most)
        return [lanes[k : k + size] for k in range(0, max(1, len(lanes)), size)]

    def share(self, lanes: IndexArray, steps: int, work: Work) -> None:
        """Work on lanes part by part, each of so many steps, until the user stops it."""
        parts = self.parts(lanes)
        done = np.zeros(len(parts))

        def part(k: int) -> None:
            def count() -> None:
                if self.stopped:
                    raise KeyboardInterrupt
                if self.tell is not None:
                    now = self.done + self.share_of_lanes * float(done.mean())
                    self.tell(min(1.0, now / self.whole))
                done[k] = min(done[k] + 1.0, steps)

            try:
                work(parts[k], count)
            except KeyboardInterrupt:
                self.stopped = True
                raise
            done[k] = steps

        try:
            share_out(part, range(len(parts)), cores())
        except KeyboardInterrupt:
            # while waiting for the other threads, which stop at their next step
            self.stopped = True
        self.done += self.share_of_lanes * steps


# ----------------------------------------------------------------------
# Problems, round by round.


class LaneProblem(ABC):
    """Residuals of designs in lanes, and how they count in a round.

    Parameters
    ----------
    box : Box
    row_variables : RowVariables
        Those of rows.
    lanes, rows : int
    counted : (K,) bool
        Of the shared residuals, those that are misses and no broken bounds.

    Attributes
    ----------
    power : int
        Of the misses, for the largest one.
    """

    #: Lanes of one thread, of few rows; more where residuals are soon computed.
    most_lanes = 64

    def __init__(
        self, box: Box, row_variables: RowVariables, lanes: int, rows: int, counted: BoolArray
    ) -> None:
        self.box, self.row_variables, self.lanes, self.counted = box, row_variables, lanes, counted
        self.power, self._largest = 1, np.ones(lanes)
        self.work = LaneWork(rows, self.most_lanes)

    @abstractmethod
    def evaluate(
        self, x: Array, t: Array, lanes: IndexArray, power: int | None = None
    ) -> Residuals:
        """Residuals of designs (D, P) in lanes; NaN where they have none."""

    @property
    def multipliers(self) -> Sequence[Multipliers]:
        """Those of all constraints."""
        return ()

    def raised(self, result: Residuals, lanes: IndexArray, power: int | None = None) -> Residuals:
        """Residuals of the power of the round, or of another one."""
        power = power or self.power
        if power == 1:
            return result
        return powered(result, power, self._largest[lanes], self.counted)

    def weigh(self, weight: float) -> None:
        """Change the weight of all constraints."""
        for multipliers in self.multipliers:
            multipliers.weigh(weight)

    def prepare(self, fit: LaneFit, lanes: IndexArray, count: Callable[[], None]) -> LaneFit:
        """Some lanes before the steps of a round."""
        return fit

    def further(self, fit: LaneFit, keep: IndexArray, steps: int) -> LaneFit:
        """Some lanes after more steps; new multipliers of their constraints."""
        if not len(keep):
            return fit
        every = fit.take(np.arange(len(fit)))

        def work(part: IndexArray, count: Callable[[], None]) -> None:
            start = self.prepare(fit.take(part), part, count)
            every.put(part, start)
            if self.power > 1:
                now = self.evaluate(start.x, start.t, part, 1)
                self._largest[part] = np.maximum(largest_misses(now, self.counted), 1e-300)
            begun = False

            def evaluate(x: Array, t: Array, lanes: IndexArray) -> Residuals:
                nonlocal begun
                if begun:  # starts are measured in any case
                    count()
                begun = True
                return self.evaluate(x, t, part[lanes])

            after = minimise(evaluate, start, self.box, steps, row_variables=self.row_variables)
            every.put(part, after)
            if after.interrupted:
                raise KeyboardInterrupt
            if self.multipliers:
                self.evaluate(after.x, after.t, part)
                for constraints in self.multipliers:
                    constraints.update(part)

        self.work.share(keep, steps, work)
        return replace(every, interrupted=self.work.stopped)


def different(measure: Array, alike: Callable[[list[int], int], BoolArray]) -> IndexArray:
    """Lanes that are different, by rising measure (D,), without those that have none.

    ``alike``: which of some lanes are like one.
    """
    chosen: list[int] = []
    for k in map(int, np.argsort(measure, kind="stable")):
        if np.isfinite(measure[k]) and not alike(chosen, k).any():
            chosen.append(k)
    return np.array(chosen, dtype=np.intp)
