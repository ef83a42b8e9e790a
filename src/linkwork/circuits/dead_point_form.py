"""Dead points of blocks as polynomial systems with the input as an unknown."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from linkwork.circuits.homotopy.dead_points import DeadPointSystem, Slot
from linkwork.core.equations.compiling import (
    DirectionForm,
    NoDirectionForm,
    ParametrizedTable,
    check_independent,
    direction_form,
)
from linkwork.core.foundation.arrays import Array, ComplexArray, IndexArray
from linkwork.core.foundation.lanes import phase
from linkwork.core.numerics.block_solver import BlockSolver
from linkwork.core.numerics.branch_tracking import InputPath
from linkwork.core.numerics.decomposition import closure_of
from linkwork.core.table.loop_table import LoopTable, TableSplitter

_DEPENDENT = 1e-9  # smallest singular value of the lengths' columns, relative to the largest


@dataclass(frozen=True, kw_only=True, eq=False)
class DeadPointForm:
    """The dead points of one block as a system of polynomials.

    Parameters
    ----------
    form : DirectionForm
        Form of the block and all blocks it depends on; the leading input is the last unknown.
    system : DeadPointSystem
    variables : (n,) int
        Indices of the form's unknowns among the variables of the mechanism.
    poles : tuple of float, optional
        Input angles φ at which lengths of the block run to infinity while those it depends on stay
        finite; ``None`` if unknown.
    """

    form: DirectionForm
    system: DeadPointSystem
    variables: IndexArray
    known: Array
    poles: tuple[float, ...] | None

    def positions(self, x: ComplexArray, near: Array) -> Array:
        """The unknowns (R, n) at real solutions x; angles within half a turn of ``near`` (N,)."""
        known = np.repeat(self.known[None, :], len(x), axis=0)
        return self.form.unknowns(x[:, : 2 * self.system.size], known, near[self.variables])

    def lead(self, x: ComplexArray) -> tuple[ComplexArray, ComplexArray]:
        """The leading input at a solution x (n,), in terms of U and of V, and both gradients.

        Returns
        -------
        value, slope : (2,), (2, n)
            e^{iθ} up to a constant factor, or a length; conjugates of each other if real.
        """
        form, m = self.form, self.system.size
        number = form.table.unknowns - 1
        value, slope = np.zeros(2, dtype=complex), np.zeros((2, len(x)), dtype=complex)
        for side, begin in enumerate((0, m)):
            if number in form.turning:
                weights = form.angles[form.turning.tolist().index(number)]
                used = begin + np.flatnonzero(weights)
                power = weights[weights != 0.0]
                value[side] = np.prod(x[used] ** power)
                slope[side, used] = value[side] * power / x[used]
                continue
            k = form.sliding.tolist().index(number)
            here, along = begin + form.directions + k, form.along[k]
            way = complex(x[begin + along]) if along >= 0 else 1.0
            value[side] = x[here] / way
            slope[side, here] = 1.0 / way
            if along >= 0:
                slope[side, begin + along] = -value[side] / way
        return value, slope


def dead_point_form(
    leads: ParametrizedTable, solver: BlockSolver, path: InputPath, number: int
) -> DeadPointForm | None:
    """The form of a block; ``None`` if the block cannot lock or the input does not move it.

    Raises
    ------
    NoDirectionForm
        If this form does not exist.
    """
    members = closure_of(solver, number)
    blocks = [solver.blocks[k] for k in members]
    own = blocks[-1]
    table = own.system
    used = {int(k) for block in blocks for k in block.variables[len(block.unknowns) :]}
    n = solver.unknowns
    # without a varying input the block is constant
    inputs = [k - n for k in sorted(used) if k >= n and path.rate[k - n]]
    if not isinstance(table, LoopTable) or not table.loops.rows or not inputs:
        return None
    lead = leads.parameter
    others = [n + j for j in inputs if n + j != lead]
    # linear rows for the other inputs follow those of the table
    whole = leads.table
    waiting = [j for j in range(len(path.rate)) if n + j != lead]
    lines = len(whole.pattern()) - len(whole.functions) - len(waiting)
    equations = [e for block in blocks for e in block.equations]
    equations += [lines + waiting.index(k - n) for k in others]
    unknowns = [*(int(u) for block in blocks for u in block.unknowns), *others, lead]
    part, known = TableSplitter(whole).part(equations, unknowns)
    form = direction_form(part, free=1)
    at = path.at(0.0)
    values = np.array([at[k - n] for k in known])
    left, _ = form.closures(values[None, :], np.zeros((1, len(known))))
    check_independent(left[0])
    place = {u: k for k, u in enumerate(unknowns)}
    mine = [place[int(u)] for u in own.unknowns]
    return DeadPointForm(
        form=form,
        system=DeadPointSystem(
            left=left[0],
            right=left[0].conj(),
            rows=form.rows,
            own=table.loops.rows,
            slots=_slots(form, mine, table.loops.rows),
        ),
        variables=np.array(unknowns, dtype=np.intp),
        known=values,
        poles=_poles(form, left[0][-table.loops.rows :], mine),
    )


def _slots(form: DirectionForm, own: list[int], loops: int) -> tuple[Slot, ...]:
    """The terms of the rates of the block's unknowns, with all others constant."""
    count, size = form.directions, form.rows.shape[1]
    still = [k for k, j in enumerate(form.turning.tolist()) if j not in own]
    turns = _null_space(form.angles[still])  # of the directions
    lengths = [k for k, j in enumerate(form.sliding.tolist()) if j in own]
    if turns.shape[1] + len(lengths) != 2 * loops:
        raise NoDirectionForm("do not have two unknown directions or lengths for every loop")
    slots: list[Slot] = []
    for number, column in enumerate(turns.T.tolist()):
        slots += [(d, d, number, w, w) for d, w in enumerate(column) if w]
        for k, a in enumerate(form.along):
            if a >= 0 and column[a]:
                slots.append((count + k, count + k, number, column[a], column[a]))
    for number, k in enumerate(lengths, turns.shape[1]):
        a = form.along[k]
        slots.append((count + k, a if a >= 0 else size, number, 1.0, -1.0))
    return tuple(slots)


def _null_space(rows: Array) -> Array:
    """A basis (D, K) of the null space of an integer matrix (R, D), by elimination."""
    rows = rows.copy()
    pivots: list[int] = []
    for column in range(rows.shape[1]):
        begin = len(pivots)
        if begin == len(rows):
            break
        best = begin + int(np.argmax(np.abs(rows[begin:, column])))
        if abs(rows[best, column]) < 1e-9:
            continue
        rows[[begin, best]] = rows[[best, begin]]
        rows[begin] /= rows[begin, column]
        for k in range(len(rows)):
            if k != begin:
                rows[k] -= rows[k, column] * rows[begin]
        pivots.append(column)
    free = [k for k in range(rows.shape[1]) if k not in pivots]
    basis = np.zeros((rows.shape[1], len(free)))
    for number, k in enumerate(free):
        basis[k, number] = 1.0
        for row, pivot in enumerate(pivots):
            # 0.0 - x, as -x would leave -0.0
            basis[pivot, number] = 0.0 - rows[row, k]
    return basis


def _poles(form: DirectionForm, closures: ComplexArray, own: list[int]) -> tuple[float, ...] | None:
    """Input angles at which lengths of the block's closures (l, M + 1) can run to infinity."""
    lengths = [k for k, j in enumerate(form.sliding.tolist()) if j in own]
    along = [form.along[k] for k in lengths]
    columns = closures[:, [form.directions + k for k in lengths]]
    # much larger lengths cannot close the loop, so they stay finite
    if not lengths or _closed_by_nothing(columns, along):
        return ()
    if len(columns) == 1 and len(lengths) == 2 and form.directions == 1 and sum(along) == -1:
        # one along the input, one along a fixed line: parallel twice per turn
        turning = along.index(0)
        ratio = complex(columns[0, 1 - turning] / columns[0, turning])
        angle = phase(ratio)
        shift = float((form.angles @ np.array([angle]))[-1] + form.shift[-1, -1])
        return (shift, shift + math.pi)
    return None


def _closed_by_nothing(columns: ComplexArray, along: list[int]) -> bool:
    """Whether lengths much larger than all others violate a closure for all directions."""
    real = []
    for column, a in zip(columns.T, along, strict=True):
        real.append(np.concatenate([column.real, column.imag]))
        if a >= 0:
            real.append(np.concatenate([-column.imag, column.real]))
    if len(real) > len(real[0]):
        return False
    sizes = np.linalg.svd(np.array(real), compute_uv=False)
    return bool(sizes[-1] > _DEPENDENT * sizes[0])
