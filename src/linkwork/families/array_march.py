"""Families solved with arrays, many designs side by side: where nothing is compiled.

All designs of a part are followed through the same nodes, the rows between them are corrected and
proved as those of one table are. Designs that some row leaves open are left to others.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from linkwork.core.foundation.arrays import UNIT_ROUNDOFF, Array, BoolArray
from linkwork.core.foundation.statuses import Certification, Status
from linkwork.core.numerics.branch_tracking import quintic
from linkwork.core.numerics.newton import SolvedRows
from linkwork.core.numerics.proved_rows import Part, Points, parts_of, solve_points
from linkwork.core.record.block_record import functions_of, numbers_of
from linkwork.core.record.printing import ARRAYS
from linkwork.core.table.loop_table import LoopTable
from linkwork.families.building import Designs
from linkwork.families.design_sweep import (
    DesignRows,
    TablePath,
    lines_of_lengths,
)

_FAR, _FAST = 0.3, 0.3  # weighted: the first correction of a node at most; ratio of the next one
_DESIGNS = 512  # followed side by side


_LANES = 8192  # positions proved side by side: arrays that fit the cache


_FINER = 4  # parts into which steps are divided where some are not proved


_STRIDE = 0.2  # between nodes, in natural steps of the path


_ROUNDS = 4  # corrections of a node


def fill(path: TablePath, designs: Designs, found: DesignRows, certify: bool) -> BoolArray:
    """Fill in the designs of which all rows are found and proved; returns their mask, (D,).

    Without proofs wanted they are made all the same: nothing else shows that no branch was changed.
    """
    solver = path.model.compiled.solver
    whole = np.zeros(len(designs), dtype=bool)
    begin, on_path = path.starts_of(designs)
    fine = np.flatnonzero((designs.problem == 0) & on_path & (begin == np.median(begin)))
    if not solver.is_recorded or not len(fine):
        return whole
    for first in range(0, len(fine), _DESIGNS):
        some = fine[first : first + _DESIGNS]
        whole[some] = _Part(path, designs, some).fill(found, certify)
    return whole


class _Part:
    """Some designs, followed side by side."""

    def __init__(self, path: TablePath, designs: Designs, which: Any) -> None:
        self.path, self.designs, self.which = path, designs, which
        self.model, self.solver = path.model, path.model.compiled.solver
        self.rates = [float(rate) for rate in path.rate]
        self.begin = float(np.median(designs.start[which, self.solver.unknowns + path.lead]))

    def _parts(self, which: Any) -> list[Part]:
        return parts_of(
            self.solver,
            [
                functions_of(table, self._numbers(table, block.equations, which), ARRAYS)
                for block in self.solver.blocks
                if isinstance(table := block.system, LoopTable)
            ],
            self.designs.length_scale[which],
        )

    def _numbers(self, table: LoopTable, equations: Sequence[int], which: Any) -> dict[str, Any]:
        """The numbers of a block by name, of some designs (d,)."""
        designs, whole = self.designs, self.model.compiled.table
        found: dict[str, Any] = dict(numbers_of(table))
        size, count = designs.length_scale[which], whole.loops.rows
        loops = [k for k in equations if k < count]
        lines = [k - count for k in equations if k >= count]
        terms = [t for row in loops for t in np.flatnonzero(whole.loops.row == row)]
        for new, term in enumerate(terms):
            column = designs.loops[which, term]
            found[f"c{new}.re"], found[f"c{new}.im"] = column.real.copy(), column.imag.copy()
        lengths = lines_of_lengths(self.model)
        for new, row in enumerate(lines):
            found[f"k{new}"] = designs.linear[which, row]
            found[f"s{2 * len(loops) + new}"] = size if row in lengths else 1.0
        found |= {f"s{k}": size for k in range(2 * len(loops))}
        found |= {f"w{k}": size for k in np.flatnonzero(~table.is_angle).tolist()}
        return found

    def fill(self, found: DesignRows, certify: bool) -> BoolArray:
        """Rows of the designs, into ``found``; which are complete."""
        t, done = self.model.rows[:, self.path.lead], np.zeros(len(self.which), dtype=bool)
        with np.errstate(all="ignore"):
            times, nodes, good = self._nodes(float(t.min()), float(t.max()))
            for finer in (1, _FINER):  # between points that are too far apart for a proof
                open_ = np.flatnonzero(good & ~done)
                inside = _between(np.unique(np.concatenate([times, t])), finer)
                points = np.concatenate([times, inside, t])
                order = np.argsort(points, kind="stable")
                rows = np.argsort(order)[-len(t) :]
                lanes = max(1, _LANES // len(points))
                for first in range(0, len(open_), lanes):
                    some = open_[first : first + lanes]
                    solved = self._solved(times, nodes[..., some], points[order], self.which[some])
                    sound = solved.sound & solved.connected.all(axis=0)
                    self._keep(solved, sound, rows, self.which[some[sound]], found, certify)
                    done[some] = sound
        return done

    def _solved(self, times: Array, nodes: Array, t: Array, which: Any) -> Points:
        """Some designs at rising values of t, between their nodes."""
        n = self.solver.unknowns
        left = np.searchsorted(times[1:-1], t, side="right")
        h = (times[left + 1] - times[left])[:, None, None]
        s = (t - times[left])[:, None, None] / h
        start = np.empty((n + len(self.rates), len(t), len(which)))
        between = quintic(s, h, _node_rows(nodes[left]), _node_rows(nodes[left + 1]))
        start[:n] = between.swapaxes(0, 1)
        start[n:] = (self.path.origin + np.outer(t, self.path.rate)).T[:, :, None]
        return solve_points(self._parts(which), start, self._radius(t), self.rates)

    def _keep(
        self,
        solved: Points,
        sound: BoolArray,
        rows: Any,
        which: Any,
        found: DesignRows,
        certify: bool,
    ) -> None:
        """Rows of the designs that are sound."""
        proof = Certification.CERTIFIED if certify else Certification.NOT_ASKED
        found.v[:, :, which] = solved.v[: self.solver.unknowns, rows][:, :, sound]
        found.status[:, which] = Status.CONVERGED.code
        found.certification[:, which] = proof.code
        found.limits[:, which] = [[-np.inf], [np.inf]]
        if certify:
            found.radius[:, which] = solved.radius[rows][:, sound]

    def _radius(self, points: Array) -> Array:
        """How far inputs may be from the intended ones, (p, P, 1)."""
        wide = self.path.input_radius(np.array([self.begin]))
        inputs = np.abs(self.path.origin + np.outer(points, self.path.rate))
        return (4.0 * UNIT_ROUNDOFF * inputs + wide).T[:, :, None]

    def _nodes(self, low: float, high: float) -> tuple[Array, Array, BoolArray]:
        """Times (K,), values and both rates of nodes (K, 3, n, d); which designs reach them all."""
        stride = _STRIDE * self.path.size
        low, high = min(low, self.begin), max(high, self.begin)
        if low == high:  # one row, at the start: a step needs two nodes
            high += stride
        down = int(np.ceil((self.begin - low) / stride))
        up = int(np.ceil((high - self.begin) / stride))
        times = np.concatenate(
            [np.linspace(low, self.begin, down + 1)[:-1], np.linspace(self.begin, high, up + 1)]
        )
        n, parts = self.solver.unknowns, self._parts(self.which)
        nodes = np.empty((len(times), 3, n, len(self.which)))
        good = np.ones(len(self.which), dtype=bool)
        guess = self.designs.start[self.which, :n].T
        self._node(parts, times[down], guess, nodes[down], good, first=True)
        for way in (range(down + 1, len(times)), range(down - 1, -1, -1)):
            before: int | None = None
            last = down
            for k in way:
                h = times[k] - times[last]
                if before is None:
                    x, a, b = nodes[last]
                    guess = x + h * a + (0.5 * h * h) * b  # eq. (17)
                else:  # the quintic through the last two nodes, continued
                    step = times[last] - times[before]
                    guess = quintic(
                        1.0 + h / step, step, _node_rows(nodes[before]), _node_rows(nodes[last])
                    )
                self._node(parts, times[k], guess, nodes[k], good)
                before, last = last, k
        return times, nodes, good

    def _node(
        self,
        parts: Sequence[Part],
        t: float,
        guess: Array,
        node: Array,
        good: BoolArray,
        *,
        first: bool = False,
    ) -> None:
        """Solve a node, in place, and take its rates; note designs that it is too far for."""
        n = self.solver.unknowns
        v, rate, bend = np.zeros((3, n + len(self.rates), guess.shape[1]))
        v[:n] = guess
        v[n:] = (self.path.origin + t * self.path.rate)[:, None]
        rate[n:] = self.path.rate[:, None]
        for functions, mine, known, _ in parts:
            m, size = len(mine), np.inf
            before: Any = None
            here = [*v[mine], *v[known]]
            for _ in range(20 if first else _ROUNDS):
                _, size, _, *change = functions.correct(*here)
                here[:m] = [x - y for x, y in zip(here, change, strict=False)]
                if not first:
                    good &= size <= (_FAR if before is None else np.maximum(_FAST * before, 1e-9))
                before = size
            good &= size <= 1e-7
            found = functions.rates(*here, *rate[known], *bend[known])
            for i, k in enumerate(mine):
                v[k], rate[k], bend[k] = here[i], found[i], found[m + i]
        node[:] = v[:n], rate[:n], bend[:n]
        good &= np.isfinite(node).all(axis=(0, 1))


def _between(t: Array, finer: int) -> Array:
    """Values that divide each step between rising ones into ``finer`` parts."""
    shares = np.arange(1, finer) / finer
    return (t[:-1, None] + np.diff(t)[:, None] * shares).ravel()


def _node_rows(nodes: Array) -> SolvedRows:
    """Values and both rates of nodes (..., 3, n, d), (..., n, d) each."""
    v, first, second = np.moveaxis(nodes, -3, 0)
    return SolvedRows(v=v, first=first, second=second)
