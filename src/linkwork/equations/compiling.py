"""Loop equations as arrays: the loop table in blocks, points, links and outputs."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from linkwork.equations.directions import DirectionForm, NoDirectionForm, direction_form
from linkwork.equations.leader_solvers import LeaderSolvers
from linkwork.equations.model import LawEquation, LoopEquations, Term
from linkwork.equations.real_rows import FormulaRow
from linkwork.expression.tree import names_in
from linkwork.foundation.arrays import Array, ComplexArray, IndexArray
from linkwork.foundation.elementwise import display_value
from linkwork.foundation.errors import MechanismError, Problem
from linkwork.foundation.names import canonical
from linkwork.kernels.law_row import LawRow
from linkwork.kernels.loop_table import LoopTable
from linkwork.kernels.phasor_rows import PhasorRows
from linkwork.kernels.real_rows import LinearRows
from linkwork.kernels.single.quick_rows import quick_rows
from linkwork.kernels.table_splitter import TableSplitter
from linkwork.numerics.block_solver import Block, BlockSolver
from linkwork.numerics.decomposition import BlockForm, block_form

__all__ = ["Compiled", "compile_equations"]


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
    n = len(equations.unknowns)
    pattern = [[k for k in used if k < n] for used in table.pattern()]
    loops = len(equations.loops)
    form = block_form(pattern, [2] * loops + [1] * (len(pattern) - loops), n)
    if not form.square:
        raise MechanismError(_mismatch(equations, form), where)
    splitter = TableSplitter(table)
    blocks = []
    for members, unknowns in form.blocks:
        part, known = splitter.part(list(members), list(unknowns))
        blocks.append(
            Block(
                system=part,
                equations=members,
                unknowns=np.array(unknowns, dtype=np.intp),
                variables=np.array([*unknowns, *known], dtype=np.intp),
            )
        )
    solver = BlockSolver(blocks, n, table.variables, table.variable_scale, make_quick=quick_rows)
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
