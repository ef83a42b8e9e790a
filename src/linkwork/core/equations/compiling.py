"""Blocks of loop equations as bilinear systems: unknown directions e^{iθ} instead of angles.

Every term c s e^{i(Σ w θ + known)} of a block must have one unknown direction, or none. Linear rows
between angles are solved first; then the sums of angles in the terms become the unknown directions.
This requires as many sums as remaining angles, and angles that follow from them with integer
weights. Otherwise the block has no such form, and the error gives the reason.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from linkwork.core.equations.model import FormulaRow, LawEquation, LoopEquations, Term
from linkwork.core.expression.tree import names_in
from linkwork.core.foundation.arrays import (
    UNIT_ROUNDOFF,
    Array,
    BoolArray,
    ComplexArray,
    IndexArray,
)
from linkwork.core.foundation.errors import MechanismError, Problem
from linkwork.core.foundation.lanes import display_value
from linkwork.core.foundation.names import canonical
from linkwork.core.numerics.bilinear import BilinearSystem
from linkwork.core.numerics.block_solver import Block, BlockSolver
from linkwork.core.numerics.branch_tracking import InputPath, Parametrization
from linkwork.core.numerics.decomposition import BlockForm, block_form
from linkwork.core.record.block_record import record_of
from linkwork.core.table.loop_table import LoopTable, TableSplitter
from linkwork.core.table.rows import LawRow, LinearRows, PhasorRows

_MOST_LOOPS = 6  # C(12, 6) = 924 paths for a random system
_DEPENDENT = 1e-12  # smallest singular value of a closure matrix, relative to the largest
_WHOLE = 1e-12  # tolerance of integer weights


class NoDirectionForm(Exception):
    """A block has no such form; the message continues a sentence after "its equations"."""


@dataclass(frozen=True, kw_only=True, eq=False)
class DirectionForm:
    """A block over M unknown directions and lengths, for any values of its known variables.

    Parameters
    ----------
    table : LoopTable
        The block, with n unknowns.
    column : (T,) int
        The column of each term: a direction, then the lengths, M for known terms.
    rows : (4, M) int
        The products of :class:`~linkwork.core.numerics.bilinear.BilinearSystem`.
    angles : (A, D)
        Unknown angles = ``angles`` · directions + ``shift`` · (known variables, 1).
    shift : (A, p + 1)
    tied : (A, D)
        Turns of the angles per turn of the ``free`` (D,) ones, by linear rows.
    along : tuple of int
        The direction of each unknown length, -1 if it is known.
    """

    table: LoopTable
    column: IndexArray
    rows: IndexArray
    angles: Array
    shift: Array
    tied: Array
    free: IndexArray
    along: tuple[int, ...]

    @property
    def directions(self) -> int:
        """D, the number of unknown directions."""
        return int(self.angles.shape[1])

    @cached_property
    def turning(self) -> IndexArray:
        """The unknowns of the block that are angles."""
        return np.flatnonzero(self.table.is_angle[: self.table.unknowns])

    @cached_property
    def sliding(self) -> IndexArray:
        """The unknowns of the block that are lengths."""
        return np.flatnonzero(~self.table.is_angle[: self.table.unknowns])

    def closures(self, known: Array, spread: Array) -> tuple[ComplexArray, Array]:
        """``left`` of the bilinear systems, (B, L, M + 1), and bounds of its errors.

        Parameters
        ----------
        known, spread : (B, p)
            Values of the known variables and bounds of their errors.
        """
        table, loops = self.table, self.table.loops
        n, scale = table.unknowns, table.variable_scale
        ones = np.ones((len(known), 1))
        shifted = np.concatenate([known, ones], axis=1) @ self.shift.T
        shifted_off = np.concatenate([spread, 0.0 * ones], axis=1) @ np.abs(self.shift).T
        v = np.zeros((len(known), table.variables))
        v[:, self.turning], v[:, n:] = shifted, known
        off = np.zeros_like(v)
        off[:, self.turning], off[:, n:] = shifted_off, spread
        size = float(table.equation_scale[0])
        weights = loops.weight_matrix
        phase = v @ weights
        turned = np.abs(v) @ np.abs(weights)
        slack = off @ np.abs(weights) + UNIT_ROUNDOFF * (4.0 * turned + 16.0 + len(loops.row))
        length = np.ones(phase.shape)
        length_off = np.zeros(phase.shape)
        for t, j in enumerate(loops.length):
            if j >= n:
                length[:, t], length_off[:, t] = v[:, j], off[:, j]
            elif j >= 0:
                length[:, t] = scale[j]
        term = loops.coefficient * length * np.exp(1j * phase) / size
        error = np.abs(loops.coefficient) / size * (np.abs(length) * slack + length_off)
        left = np.zeros((len(known), loops.rows, self.rows.shape[1] + 1), dtype=complex)
        away = np.zeros(left.shape)
        for t, (row, column) in enumerate(zip(loops.row, self.column, strict=True)):
            left[:, row, column] += term[:, t]
            away[:, row, column] += error[:, t]
        return left, away

    def system(self, left: ComplexArray) -> BilinearSystem:
        """The bilinear system of one closure matrix (L, M + 1), or those of stacked ones.

        Raises
        ------
        NoDirectionForm
            If the loops are not independent.
        """
        check_independent(left)
        return BilinearSystem(left=left, right=left.conj(), rows=self.rows)

    def unknowns(self, x: ComplexArray, known: Array, near: Array) -> Array:
        """The block's unknowns (R, n) of real solutions (U, V) (R, 2M) for known values (R, p).

        Angles are within half a turn of ``near`` (n,) unless a linear row prevents it.
        """
        count, m = self.directions, self.rows.shape[1]
        # the mean of e^{iθ} from U and from V
        psi = np.angle(x[:, :count] + x[:, m : m + count].conj())
        ones = np.ones((len(x), 1))
        angles = psi @ self.angles.T + np.concatenate([known, ones], axis=1) @ self.shift.T
        away = angles[:, self.free] - near[self.turning][self.free]
        # whole turns of the free angles; dependent ones follow
        turns = np.floor((away + np.pi) / (2.0 * np.pi))
        found = np.zeros((len(x), self.table.unknowns))
        found[:, self.turning] = angles - 2.0 * np.pi * (turns @ self.tied.T)
        for k, (j, a) in enumerate(zip(self.sliding, self.along, strict=True)):
            z = x[:, count + k]
            turned = z * np.exp(-1j * psi[:, a]) if a >= 0 else z
            found[:, j] = turned.real * self.table.variable_scale[j]
        return found


def check_independent(left: ComplexArray) -> None:
    """Reject closures (..., L, M + 1) that are not independent.

    Raises
    ------
    NoDirectionForm
        If the loops are not independent.
    """
    sizes = np.linalg.svd(left, compute_uv=False)
    if (sizes[..., -1] <= _DEPENDENT * sizes[..., 0]).any():
        raise NoDirectionForm("are not independent: one follows from the others")


def direction_form(table: LoopTable, free: int = 0) -> DirectionForm:
    """The form of a block, or of several blocks with ``free`` undetermined unknowns.

    Raises
    ------
    NoDirectionForm
        If the block has no such form.
    """
    if table.functions:
        cams = table.has_curvature_bound
        raise NoDirectionForm(
            "contain a law of a cam or curve" if cams else "are plain equations, not loops"
        )
    n, loops = table.unknowns, table.loops
    turning = np.flatnonzero(table.is_angle[:n])
    sliding = np.flatnonzero(~table.is_angle[:n])
    reduce, shift, free_angles = _solve_lines(table, turning, sliding)
    if np.abs(loops.weight_matrix[sliding]).max(initial=0.0) > 0.0:
        raise NoDirectionForm("relate an angle to a length, as racks and rolling wheels do")
    sums = loops.weight_matrix[turning].T @ reduce
    directions, number = _directions(sums)
    angles = reduce @ _inverse(directions, reduce.shape[1])
    along = _along(table, number, sliding)
    if loops.rows > _MOST_LOOPS:
        raise NoDirectionForm(
            f"are {loops.rows} coupled loops; paths are followed for at most {_MOST_LOOPS}"
        )
    size = len(directions) + len(sliding)
    if size != 2 * loops.rows + free:
        raise NoDirectionForm("do not have two unknown directions or lengths for every loop")
    place = {int(j): len(directions) + k for k, j in enumerate(sliding)}
    column = np.where(number < 0, size, number)
    column = np.array(
        [place.get(int(j), int(c)) for j, c in zip(loops.length, column, strict=True)],
        dtype=np.intp,
    )
    one = size
    products = [(k, k, one, one) for k in range(len(directions))]
    for k, a in enumerate(along, len(directions)):
        products.append((k, one, one, k) if a < 0 else (k, a, a, k))
    return DirectionForm(
        table=table,
        column=column,
        rows=np.array(products, dtype=np.intp).reshape(size, 4).T,
        angles=angles,
        shift=shift,
        tied=reduce,
        free=np.array(free_angles, dtype=np.intp),
        along=along,
    )


def _solve_lines(
    table: LoopTable, turning: IndexArray, sliding: IndexArray
) -> tuple[Array, Array, list[int]]:
    """Solve linear rows: angles = first · (remaining angles) + second · (known, 1)."""
    n, lines = table.unknowns, table.linear
    rows = np.zeros((len(lines.constant), table.variables + 1))
    np.add.at(rows, (lines.row, lines.variable), lines.weight)
    rows[:, -1] = lines.constant
    _check_lengths_untied(rows, turning, sliding)
    own = rows[:, turning].copy()
    rest = np.concatenate([rows[:, n:-1], rows[:, -1:]], axis=1)
    pivots = _eliminate(own, rest)
    free = [j for j in range(len(turning)) if j not in pivots]
    reduce = np.zeros((len(turning), len(free)))
    shift = np.zeros((len(turning), rest.shape[1]))
    for column, j in enumerate(free):
        reduce[j, column] = 1.0
    for k, j in enumerate(pivots):
        reduce[j] = -own[k, free]
        shift[j] = -rest[k]
    return reduce, shift, free


def _check_lengths_untied(rows: Array, turning: IndexArray, sliding: IndexArray) -> None:
    tied = np.abs(rows[:, sliding]).max(axis=1, initial=0.0) > 0.0
    if not tied.any():
        return
    lengths_only = (rows[np.ix_(tied, turning)] == 0.0).all()
    if lengths_only and ((rows[np.ix_(tied, sliding)] != 0.0).sum(axis=1) > 1).all():
        raise NoDirectionForm("relate two lengths, as inputs driven together do")
    raise NoDirectionForm("relate an angle to a length, as racks and rolling wheels do")


def _eliminate(own: Array, rest: Array) -> list[int]:
    """Solve lines own · angles + rest · known = 0 in place, each for one angle; returns these.

    An angle that depends on known variables only may have any ratio. Otherwise a turn of one angle
    must be an integer number of turns of the other.
    """
    pivots: list[int] = []
    for k in range(len(own)):
        j = int(np.argmax(np.abs(own[k])))
        if abs(own[k, j]) <= _WHOLE:
            raise NoDirectionForm("relate the same angles twice")
        pivots.append(j)
        _solve_for(own, rest, k, j)
    for k, j in enumerate(pivots):
        others = [i for i in np.flatnonzero(np.abs(own[k]) > _WHOLE).tolist() if i != j]
        for choice in (j, *others) if others else ():
            turns = own[k] / own[k, choice]
            if np.abs(turns - np.round(turns)).max() <= _WHOLE:
                pivots[k] = choice
                _solve_for(own, rest, k, choice)
                break
        else:
            if others:
                raise NoDirectionForm("relate angles with ratios other than 1, as gears do")
    return pivots


def _solve_for(own: Array, rest: Array, row: int, angle: int) -> None:
    """Eliminate one angle from all rows but one, where its weight is 1."""
    own[row], rest[row] = own[row] / own[row, angle], rest[row] / own[row, angle]
    for other in range(len(own)):
        if other != row and own[other, angle]:
            factor = own[other, angle]
            own[other] -= factor * own[row]
            rest[other] -= factor * rest[row]


def _directions(sums: Array) -> tuple[list[tuple[float, ...]], IndexArray]:
    """The distinct sums of angles in the terms, and each term's index, -1 for none."""
    rows = [tuple(row) for row in sums.tolist()]
    # in the order of the angles, independent of the order of the terms
    found = sorted({row for row in rows if any(row)}, reverse=True)
    place = {row: k for k, row in enumerate(found)}
    # its direction would be needed in U and V
    if any(tuple(-w for w in row) in place for row in found):
        raise NoDirectionForm("contain an angle both forwards and backwards")
    number = np.array([place.get(row, -1) for row in rows], dtype=np.intp)
    return found, number


def _inverse(directions: list[tuple[float, ...]], angles: int) -> Array:
    """Angles in terms of directions: an integer inverse."""
    if len(directions) > angles:
        raise NoDirectionForm("contain more sums of angles than angles, as gears do")
    if len(directions) < angles:
        raise NoDirectionForm("do not determine an angle")
    matrix = np.array(directions, dtype=float).reshape(angles, angles)
    # only a unimodular matrix has an integer inverse
    if angles and abs(abs(float(np.linalg.det(matrix))) - 1.0) > 1e-9:
        raise NoDirectionForm("contain angles with ratios other than 1, as gears do")
    inverse = np.linalg.inv(matrix)
    whole = np.asarray(np.round(inverse), dtype=float)
    if (
        np.abs(inverse - whole).max(initial=0.0) > 1e-9
        or np.abs(matrix - np.round(matrix)).max(initial=0.0) > _WHOLE
    ):
        raise NoDirectionForm("contain angles with ratios other than 1, as gears do")
    return whole


def _along(table: LoopTable, number: IndexArray, sliding: IndexArray) -> tuple[int, ...]:
    """The direction of each unknown length, -1 for a known one."""
    found = []
    for j in sliding:
        mine: BoolArray = table.loops.length == j
        ways = set(number[mine].tolist())
        if len(ways) != 1:
            raise NoDirectionForm("use one length along several directions")
        found.append(int(ways.pop()))
    return tuple(found)


# ----------------------------------------------------------------------
# The solvers of a table's equations, by the variable that is known.


class LeaderSolvers:
    """The solvers of a table's equations with any variable as the known one, made when first asked
    for.

    Parameters
    ----------
    table : LoopTable
    solver : BlockSolver, optional
        Of the table with one input.
    """

    def __init__(self, table: LoopTable, solver: BlockSolver | None = None) -> None:
        self.table, self._solver = table, solver
        self._splitter = TableSplitter(table)
        self._found: dict[int, tuple[BlockSolver, IndexArray] | None] = {}
        if solver is not None:
            self._found[table.unknowns] = solver, np.arange(table.variables)

    def __reduce__(self) -> tuple[type[LeaderSolvers], tuple[object, ...]]:
        """Copies by pickle make their own."""
        return LeaderSolvers, (self.table, self._solver)

    def led_by(self, lead: int) -> tuple[BlockSolver, IndexArray] | None:
        """A solver, and the variables (N,) in its order; ``None`` if one does not determine all."""
        # a curve changes its parameter many times, but among few variables
        if lead not in self._found:
            self._found[lead] = self._make(lead)
        return self._found[lead]

    def _make(self, lead: int) -> tuple[BlockSolver, IndexArray] | None:
        order = [*(k for k in range(self.table.variables) if k != lead), lead]
        _, solver = _solver_of(self.table, order, len(order) - 1, self._splitter)
        return None if solver is None else (solver, np.array(order, dtype=np.intp))


def _solver_of(
    table: LoopTable, order: Sequence[int], unknowns: int, splitter: TableSplitter
) -> tuple[BlockForm, BlockSolver | None]:
    """The block form of a table, and a solver unless the blocks are not square.

    ``order`` (N,): the table's variables in the solver's order, the first ones unknown.
    """
    place = {old: new for new, old in enumerate(order)}
    pattern = [[place[k] for k in used if place[k] < unknowns] for used in table.pattern()]
    loops = table.loops.rows
    form = block_form(pattern, [2] * loops + [1] * (len(pattern) - loops), unknowns)
    if not form.square:
        return form, None
    blocks = []
    for members, numbers in form.blocks:
        mine = [order[k] for k in numbers]
        part, known = splitter.part(list(members), mine)
        blocks.append(
            Block(
                system=part,
                equations=members,
                unknowns=np.array(numbers, dtype=np.intp),
                variables=np.array([place[k] for k in (*mine, *known)], dtype=np.intp),
                record=record_of(part),
            )
        )
    scale = table.variable_scale[np.array(order, dtype=np.intp)]
    return form, BlockSolver(blocks, unknowns, table.variables, scale)


class ParametrizedTable:
    """A table along a path of inputs, solvable with any variable as parameter.

    Parameters
    ----------
    table : LoopTable
        n unknowns and p inputs.
    path : InputPath
        The common motion of the inputs.
    parameter : int
        Index of the input that parametrises the path (0 … p-1).
    solvers : LeaderSolvers, optional
        Of the table; they serve a single input.
    """

    def __init__(
        self,
        table: LoopTable,
        path: InputPath,
        parameter: int,
        solvers: LeaderSolvers | None = None,
    ) -> None:
        self.parameter = table.unknowns + parameter
        self.table = _lock_inputs(table, path, parameter)
        self.scale = self.table.variable_scale
        self.is_angle = self.table.is_angle
        self.repeats_after = self.table.repeats_after
        own = solvers if self.table is table else None
        self._solvers = own or LeaderSolvers(self.table)
        self._leads: dict[int, Parametrization | None] = {}

    def with_parameter(self, lead: int) -> Parametrization | None:
        """The equations with one variable known; ``None`` if it does not determine the others."""
        if lead not in self._leads:
            found = self._solvers.led_by(lead)
            self._leads[lead] = found and Parametrization(
                lead=lead, solver=found[0], order=found[1]
            )
        return self._leads[lead]

    def jacobian(self, v: Array) -> Array:
        """The scaled Jacobian with respect to all variables but the path parameter, (B, m, m)."""
        table = self.table
        slope = table.jacobian(v) * table.variable_scale / table.equation_scale[:, None]
        return np.delete(slope, self.parameter, axis=2)

    def weakening(self, v: Array, rates: Array) -> float:
        """The rate of the smallest singular value σ of the scaled Jacobian at a position v (N,).

        dσ = uᵀ dJ w with the singular vectors u and w (Golub & Van Loan, Matrix Computations, 8.6),
        and uᵀ dJ w is that sum of second derivatives of the equations along w and ``rates`` (N,).
        """
        table = self.table
        left, _, right = np.linalg.svd(self.jacobian(v[None, :])[0])
        w = np.insert(right[-1], self.parameter, 0.0) * table.variable_scale
        bend = table.hessians(v, (left[:, -1] / table.equation_scale)[None, :])[0]
        return float(rates @ bend @ w)  # eq. (16)


def _lock_inputs(table: LoopTable, path: InputPath, parameter: int) -> LoopTable:
    """The table with a linear row for every other input: u_j = origin_j + rate_j t."""
    n = table.unknowns
    others = [j for j in range(len(path.rate)) if j != parameter]
    if not others:
        return table
    lines, old = table.linear, len(table.linear.constant)
    ratio = path.rate / path.rate[parameter]
    # u_j = origin_j + ratio_j (u_lead - origin_lead)
    offset = path.origin - ratio * path.origin[parameter]
    entries = [
        entry
        for row, j in enumerate(others)
        for entry in ((old + row, n + j, 1.0), (old + row, n + parameter, -ratio[j]))
        if entry[2] != 0.0
    ]
    at = 2 * table.loops.rows + old
    return replace(
        table,
        linear=LinearRows(
            constant=np.concatenate([lines.constant, [-offset[j] for j in others]]),
            row=np.concatenate([lines.row, [row for row, _, _ in entries]]).astype(np.intp),
            variable=np.concatenate([lines.variable, [k for _, k, _ in entries]]).astype(np.intp),
            weight=np.concatenate([lines.weight, [w for _, _, w in entries]]),
        ),
        equation_scale=np.insert(
            table.equation_scale, at, table.variable_scale[[n + j for j in others]]
        ),
    )


# ----------------------------------------------------------------------
# Loop equations as arrays: the loop table in blocks, points, links and outputs.


@dataclass(frozen=True, kw_only=True, eq=False)
class Compiled:
    """Compiled equations: the whole ``table``, a ``solver`` by blocks, ``points``."""

    equations: LoopEquations
    table: LoopTable
    form: BlockForm
    solver: BlockSolver
    points: PointTable

    @cached_property
    def leaders(self) -> LeaderSolvers:
        """The equations with any variable as the known one."""
        single = self.table.variables == self.table.unknowns + 1
        return LeaderSolvers(self.table, self.solver if single else None)

    def direction_form(self, number: int) -> DirectionForm:
        """A block over unknown directions, by its number in solving order.

        Raises
        ------
        NoDirectionForm
            If the block has no such form.
        """
        if number not in self._direction_forms:
            table = self.solver.blocks[number].system
            if not isinstance(table, LoopTable):
                raise NoDirectionForm("are not loops")
            self._direction_forms[number] = direction_form(table)
        return self._direction_forms[number]

    @cached_property
    def _direction_forms(self) -> dict[int, DirectionForm]:
        return {}


@dataclass(frozen=True)
class PointTable:
    """Points as phasor rows added to their parents' positions, level by level."""

    names: tuple[str, ...]
    rows: PhasorRows
    levels: tuple[tuple[IndexArray, IndexArray], ...]

    @classmethod
    def of(cls, equations: LoopEquations, index: Mapping[str, int]) -> PointTable:
        """The table of all points."""
        names = tuple(equations.points)
        number = {name: k for k, name in enumerate(names)}
        depth: dict[str, int] = {}
        levels: dict[int, list[tuple[int, int]]] = {}
        for name, path in equations.points.items():
            depth[name] = 0 if path.parent is None else depth[path.parent] + 1
            if path.parent is not None:
                levels.setdefault(depth[name], []).append((number[name], number[path.parent]))
        rows = phasor_rows([path.terms for path in equations.points.values()], index)
        return cls(
            names,
            rows,
            tuple(
                (np.array([c for c, _ in level]), np.array([p for _, p in level]))
                for _, level in sorted(levels.items())
            ),
        )

    def places(self, v: Array) -> ComplexArray:
        """Positions x + iy, (B, points)."""
        with np.errstate(all="ignore"):  # too far away for floats
            return self._from_parents(self.rows.value(v))

    def _from_parents(self, part: ComplexArray) -> ComplexArray:
        for child, parent in self.levels:
            # level by level: the parents are complete
            part[:, child] += part[:, parent]
        return part

    def jet(self, v: Array, first: Array, second: Array) -> tuple[ComplexArray, ...]:
        """Positions x + iy with first and second derivatives along a path, (B, points) each."""
        with np.errstate(all="ignore"):  # too far away or too fast for floats
            return tuple(map(self._from_parents, self.rows.jet(v, first, second)))


def phasor_rows(rows: Sequence[Iterable[Term]], index: Mapping[str, int]) -> PhasorRows:
    """Terms as arrays; ``index`` numbers the variables by symbol.

    Where values are those of several designs, the coefficients are those of the first one.
    """
    terms = [(k, term) for k, row in enumerate(rows) for term in row]
    phases = [
        (t, index[name], weight) for t, (_, term) in enumerate(terms) for name, weight in term.phase
    ]
    return PhasorRows(
        rows=len(rows),
        variables=len(index),
        row=np.array([k for k, _ in terms], dtype=np.intp),
        coefficient=np.array([display_value(term.value) for _, term in terms], dtype=complex),
        length=np.array(
            [-1 if t.length is None else index[t.length] for _, t in terms], dtype=np.intp
        ),
        phase_term=np.array([t for t, _, _ in phases], dtype=np.intp),
        phase_variable=np.array([k for _, k, _ in phases], dtype=np.intp),
        phase_weight=np.array([w for _, _, w in phases], dtype=float),
    )


def compile_equations(equations: LoopEquations, where: str) -> Compiled:
    """Arrays and blocks of a set of equations.

    Raises
    ------
    MechanismError
        If equations and unknowns do not match; names free unknowns and conflicting equations.
    """
    index = {v.symbol: k for k, v in enumerate(equations.variables)}
    table = _table(equations, index)
    form, solver = _solver_of(table, range(table.variables), table.unknowns, TableSplitter(table))
    if solver is None:
        raise MechanismError(_mismatch(equations, form), where)
    return Compiled(
        equations=equations,
        table=table,
        form=form,
        solver=solver,
        points=PointTable.of(equations, index),
    )


def _plain_scales(equations: LoopEquations, functions: Sequence[FormulaRow]) -> tuple[Array, Array]:
    """Scales of plain equations and of their variables, from the guess.

    The scale of a variable is its guess; that of an equation is the change of its terms when every
    variable changes by its scale; 1 if the guess gives none.
    """
    variables = np.abs(equations.start)
    # a guess of zero gives no scale of a variable
    variables[variables == 0.0] = 1.0
    sizes = []
    for row in functions:
        value, gradient = row.value_and_gradient(equations.start[None, :])
        with np.errstate(over="ignore", invalid="ignore"):  # then the guess gives no scale
            size = np.abs(gradient[0]) @ variables[list(row.variables)]
        size = max(float(size), abs(float(value[0])))
        sizes.append(size if np.isfinite(size) and size > 0.0 else 1.0)
    return np.array(sizes), variables


def _table(equations: LoopEquations, index: Mapping[str, int]) -> LoopTable:
    linear_entries = [
        (row, index[name], weight)
        for row, equation in enumerate(equations.linear)
        for name, weight in equation.terms
    ]
    scale = equations.length_scale
    formulas = tuple(_formula_row(e.left, e.right, equations, index) for e in equations.real)
    sizes, amounts = _plain_scales(equations, formulas)
    laws = tuple(_law_row(law, index) for law in equations.laws)
    law_sizes = [scale if law.kind == "length" else 1.0 for law in equations.laws]
    weights = [
        {"length": scale, "angle": 1.0}.get(v.kind, float(amount))
        for v, amount in zip(equations.variables, amounts, strict=True)
    ]
    return LoopTable(
        unknowns=len(equations.unknowns),
        loops=phasor_rows([loop.terms for loop in equations.loops], index),
        linear=LinearRows(
            constant=np.array([e.constant for e in equations.linear], dtype=float),
            row=np.array([row for row, _, _ in linear_entries], dtype=np.intp),
            variable=np.array([k for _, k, _ in linear_entries], dtype=np.intp),
            weight=np.array([w for _, _, w in linear_entries], dtype=float),
        ),
        functions=(*formulas, *laws),
        equation_scale=np.array(
            [scale] * (2 * len(equations.loops))
            + [scale if e.kind == "length" else 1.0 for e in equations.linear]
            + sizes.tolist()
            + law_sizes
        ),
        variable_scale=np.array(weights, dtype=float),
        is_angle=np.array([v.kind == "angle" for v in equations.variables], dtype=bool),
        link_constant=_link_constants(equations, index),
    )


def _link_constants(equations: LoopEquations, index: Mapping[str, int]) -> Array:
    """Half a turn for variables with which a link turns at an angle, as designs may have it."""
    found = np.zeros(len(index))
    for link in equations.links.values():
        if link.variable is not None and display_value(link.constant):
            found[index[canonical(link.variable)]] = np.pi
    return found


def _law_row(law: LawEquation, index: Mapping[str, int]) -> LawRow:
    weights, inner = dict(law.terms), dict(law.inner)
    names = list(dict.fromkeys([*weights, *inner]))
    return LawRow(
        variables=tuple(index[name] for name in names),
        weights=np.array([weights.get(name, 0.0) for name in names]),
        constant=law.constant,
        law=law.law,
        inner=np.array([inner.get(name, 0.0) for name in names]),
        offset=law.offset,
        error=law.error,
    )


def _formula_row(
    left: object, right: object, equations: LoopEquations, index: Mapping[str, int]
) -> FormulaRow:
    used = dict.fromkeys(
        node.name
        for side in (left, right)
        for node in names_in(side)  # type: ignore[arg-type]
    )
    names = tuple(name for name in used if name in index)
    return FormulaRow(
        left=left,  # type: ignore[arg-type]
        right=right,  # type: ignore[arg-type]
        names=names,
        variables=tuple(index[name] for name in names),
        constants=tuple((n, equations.symbols[n]) for n in used if n in equations.symbols),
        unit=equations.angle,
    )


def _mismatch(equations: LoopEquations, form: BlockForm) -> list[Problem]:
    """The message if equations and unknowns do not match."""
    names = [v.name for v in equations.unknowns]
    labels = equations.labels
    table = "equations" if equations.real else "loops"
    found = []
    if form.missing and not equations.inputs and not equations.real:
        free = ", ".join(names[k] for k in form.underdetermined)
        plural = "s" if form.missing > 1 else ""
        found.append(
            Problem(
                key=("input",),
                message=f'is missing: name the driven variable, variable = "{names[0]}" '
                f"({form.missing} unknown{plural} more than equations; not determined: {free})",
            )
        )
    elif form.missing:
        free = ", ".join(names[k] for k in form.underdetermined)
        found.append(
            Problem(
                key=(table,),
                message=f"{form.missing} unknown{'s' if form.missing > 1 else ''} too many "
                f"for the equations: add an equation or an input (not determined: {free})",
            )
        )
    if form.surplus:
        members = ", ".join(f'"{labels[k]}"' for k in form.overdetermined)
        unknowns = ", ".join(names[k] for k in form.conflict_unknowns) or "no unknown"
        found.append(
            Problem(
                key=(table,),
                message=f"{form.surplus} equation{'s' if form.surplus > 1 else ''} too many: "
                f"{members} together contain only {unknowns}; "
                "remove an equation or an input",
            )
        )
    return found


def coordinate_name(point: str, axis: str) -> str:
    """The name of a coordinate in formulas."""
    return canonical(f"{point}.{axis}")
