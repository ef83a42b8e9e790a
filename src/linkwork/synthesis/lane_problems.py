"""Least squares and minimax of lanes in rounds, with constraints, on all cores.

A :class:`LaneProblem` has the residuals of designs in lanes. Curves, functions, mechanisms and
fronts are such problems: each chooses which lanes go on, for how many steps, and how residuals
count.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from linkwork.core.foundation.arrays import AnyArray, Array, BoolArray, IndexArray
from linkwork.core.foundation.loading import cores, share_out
from linkwork.synthesis.lane_least_squares import Box, LaneFit, Residuals, RowVariables, minimise

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
