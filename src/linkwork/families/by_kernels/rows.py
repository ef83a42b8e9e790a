"""Decide whether compiled kernels can solve a mechanism faster than NumPy."""

from __future__ import annotations

from collections.abc import Hashable, Mapping
from dataclasses import dataclass, field
from functools import lru_cache

import numpy as np

from linkwork.core.foundation.arrays import Array, CountArray
from linkwork.core.foundation.statuses import Certification, Status
from linkwork.core.motion.following import Drive
from linkwork.core.motion.model import Model
from linkwork.core.numerics.branch_tracking import Node
from linkwork.core.numerics.system import SolvedRows
from linkwork.families.compiled.execution import Execution
from linkwork.families.gpu.kernel import DeviceKernel
from linkwork.families.march.closure import BlockPart
from linkwork.families.march.rate_programs import PlaceProgram, along_rows, row_program
from linkwork.families.march.sweep_kernel import Steps, SweepKernel

# ----------------------------------------------------------------------
# The equations of a mechanism as input of compiled kernels.


def block_parts(model: Model) -> list[BlockPart]:
    """The blocks of a mechanism in the order in which they are solved."""
    return [
        BlockPart(equations=block.equations, unknowns=tuple(block.unknowns.tolist()))
        for block in model.compiled.solver.blocks
    ]


def lines_of_lengths(model: Model) -> set[int]:
    """The linear rows that are equations of lengths."""
    return {k for k, line in enumerate(model.equations.linear) if line.kind == "length"}


def own_coefficients(model: Model) -> dict[str, Array]:
    """A mechanism's own coefficients, constants and weights, (1,) each, by register."""
    table = model.compiled.table
    found = {"length": model.equations.length_scale}
    for term, c in enumerate(table.loops.coefficient.tolist()):
        found[f"c{term}.re"], found[f"c{term}.im"] = c.real, c.imag
    found |= {f"k{row}": x for row, x in enumerate(table.linear.constant.tolist())}
    weights = table.variable_scale.tolist()
    found |= {f"scale{k}": weights[k] for k in np.flatnonzero(~table.is_angle).tolist()}
    return {name: np.array([value]) for name, value in found.items()}


def zero_names(coefficients: Mapping[str, Array]) -> frozenset[str]:
    """Names of those that are zero."""
    return frozenset(name for name, values in coefficients.items() if not values.any())


# ----------------------------------------------------------------------
# The kernels of topologies, each made once; this module loads compiled code.


_KEPT = 128  # kernels; one takes a hundredth of a second to make, and some 100 kB


@dataclass(frozen=True)
class _Topology:
    """A mechanism as all with the same ``key`` are: their equations differ in numbers only.

    ``zeros``: coefficients that are zero, by register.
    """

    key: Hashable
    zeros: frozenset[str]
    model: Model = field(compare=False)

    @classmethod
    def of(cls, model: Model, zeros: frozenset[str]) -> _Topology:
        blocks = tuple((tuple(p.equations), p.unknowns) for p in block_parts(model))
        lengths = tuple(sorted(lines_of_lengths(model)))
        return cls((model.compiled.table.structure, blocks, lengths), zeros, model)


def kernel_of(
    model: Model, zeros: frozenset[str], certify: bool, device: str = "cpu"
) -> SweepKernel:
    """The kernel of a mechanism's topology.

    Parameters
    ----------
    zeros : frozenset of str
        Coefficients that are zero, by register.
    """
    return _kernel(_Topology.of(model, zeros), certify, device)


def row_program_of(model: Model, zeros: frozenset[str], certify: bool) -> PlaceProgram:
    """The program that computes rates and evidence of the rows of a mechanism's topology."""
    return _row_program(_Topology.of(model, zeros), certify)


@lru_cache(maxsize=_KEPT)
def _kernel(topology: _Topology, certify: bool, device: str) -> SweepKernel:
    kind = DeviceKernel if device == "gpu" else SweepKernel
    model = topology.model
    return kind(model.compiled.table, block_parts(model), topology.zeros, certify)


@lru_cache(maxsize=_KEPT)
def _row_program(topology: _Topology, certify: bool) -> PlaceProgram:
    model = topology.model
    table, parts = model.compiled.table, block_parts(model)
    return row_program(table, parts, lines_of_lengths(model), topology.zeros, certified=certify)


# ----------------------------------------------------------------------
# Rows of one mechanism computed by the compiled kernels.
#
# A kernel computes rows along a straight path of inputs from one known position. It predicts them
# from each other, proves every position, and proves that no branch was changed on the way. This
# module loads compiled code.


_TWICE = 1e-6  # of the distance between rows: values of t so near to each other are refused


def kernel_rows(drive: Drive, anchor: Node, t: Array, spread: Array) -> SolvedRows | None:
    """Proved rows at values of t (B,), all joined to the anchor by proved steps.

    ``None`` where the kernels do not find all of them.

    Parameters
    ----------
    spread : (p,)
        How far inputs may be from their exact values, besides their rounding.
    """
    order = np.argsort(t, kind="stable")
    times = t[order]
    gaps = np.diff(times)
    if gaps.min(initial=np.inf) <= _TWICE * (times[-1] - times[0]) / len(t):
        return None
    model, path = drive.model, drive.path
    coefficients = own_coefficients(model)
    zeros = zero_names(coefficients)
    for j, (origin, rate) in enumerate(zip(path.origin, path.rate, strict=True)):
        own = {"origin": origin, "rate": rate, "spread": spread[j]}
        coefficients |= {f"u{j}.{name}": np.array([value]) for name, value in own.items()}
    work = _Kernel(drive, anchor, kernel_of(model, zeros, True), coefficients, zeros)
    rows = work.rows(times)
    return rows.take(np.argsort(order)) if rows is not None and work.join(rows, times) else None


@dataclass(frozen=True, eq=False)
class _Kernel:
    """A kernel with the coefficients of one mechanism, and where its rows begin."""

    drive: Drive
    anchor: Node
    kernel: SweepKernel
    coefficients: dict[str, Array]
    zeros: frozenset[str]

    def rows(self, t: Array) -> SolvedRows | None:
        """Rows at rising values of t, if all of them are found and proved."""
        drive, n = self.drive, self.drive.solver.unknowns
        self.kernel.choose_execution(Execution(positions=len(t)))
        steps = Steps().times(drive.path.size)
        begin = self.anchor.v[:n], self.anchor.t
        march = self.kernel.prepare_single(self.coefficients, *begin, t, steps)
        done = march.run()
        if done is None:
            return None
        v = np.vstack([done[0][:, :, 0], drive.path.at(t).T])
        program = row_program_of(drive.model, self.zeros, True)
        read = along_rows(program, self.coefficients, v)
        rows = _solved(read, v, drive.path.rate, march.counts)
        return rows if np.isfinite(rows.radius).all() else None

    def join(self, rows: SolvedRows, t: Array) -> bool:
        """Whether the rows at t are proved to lie on the anchor's branch.

        They are joined to the kernel's own start. Its row at the anchor's value of t has to be the
        anchor: within the distance in which there is no other solution. That row is joined to the
        row nearest to it.
        """
        near = int(np.abs(t - self.anchor.t).argmin())
        if t[near] == self.anchor.t:
            return self._same(rows.v[near], self.anchor.v, rows, near)
        both = np.sort([t[near], self.anchor.t])
        pair = self.rows(both)
        if pair is None:
            return False
        here = int(both[1] == self.anchor.t)
        return self._same(pair.v[here], self.anchor.v, pair, here) and self._same(
            rows.v[near], pair.v[1 - here], rows, near
        )

    def _same(self, one: Array, other: Array, rows: SolvedRows, row: int) -> bool:
        """Whether two positions are one: no other solution is nearer to the row than twice that."""
        away = float((np.abs(one - other) / self.drive.solver.variable_scale).max())
        return 2.0 * away < float(rows.uniqueness_radius[row])


def _solved(read: Array, v: Array, rate: Array, counts: CountArray) -> SolvedRows:
    """The values that the row program gives at positions v (N, R)."""
    rows, inputs = v.shape[1], len(rate)
    n = len(v) - inputs
    moving = np.repeat(rate[:, None], rows, axis=1)
    condition, residual, radius, uniqueness_radius = read[2 * n :]
    return SolvedRows(
        v=v.T,
        first=np.concatenate([read[:n], moving]).T,
        second=np.concatenate([read[n : 2 * n], np.zeros_like(moving)]).T,
        status=np.full(rows, Status.CONVERGED.code, dtype=np.int8),
        condition=condition,
        residual=residual,
        iterations=counts,
        certification=np.full(rows, Certification.CERTIFIED.code, dtype=np.int8),
        radius=radius,
        uniqueness_radius=uniqueness_radius,
    )
