"""A block's equations as functions of numbers: Newton-Raphson, rates, proof of a position.

The arithmetic of a block is recorded once and written as Python for its *shape*: blocks of one
shape differ in numbers only, which are an argument of its functions. One form takes floats, for
positions that follow each other; the other takes arrays, for many positions at once.

A shape holds everything that is written into its functions, so that blocks of one shape may share
them.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from typing import Any

import numpy as np

from linkwork.core.foundation.arrays import FAR, SMALLEST_RATIO
from linkwork.core.foundation.statuses import Status
from linkwork.core.record.block_proof import BlockProof
from linkwork.core.record.closure import (
    BlockPart,
    Closure,
    add_rates,
    condition_of,
    inverse_of,
    solve_linear,
    weighted_norm,
)
from linkwork.core.record.printing import ARRAYS, FLOATS, Form, KeptCode, Statements, local_name
from linkwork.core.record.recorder import Op, Recorder, Value
from linkwork.core.table.loop_table import LoopTable
from linkwork.core.table.rows import LawRow

#: Unknowns of the largest block that is recorded: its elimination is written out.
MOST_UNKNOWNS = 12

Number = Value | float


class _Numbers(Closure):
    """The equations of a whole block; numbers that are 0 or 1 are written out."""

    def __init__(self, table: LoopTable, ones: frozenset[str], zeros: frozenset[str]) -> None:
        rec = Recorder()
        count = table.loops.rows + len(table.linear.constant) + len(table.functions)
        part = BlockPart(equations=tuple(range(count)), unknowns=tuple(range(table.unknowns)))
        variables = [rec.input(f"v{k}") for k in range(table.variables)]
        super().__init__(table, part, rec, variables, zeros)
        self.ones = ones
        self.n, self.known_variables = table.unknowns, range(table.unknowns, table.variables)

    def number(self, name: str) -> Number:
        return 1.0 if name in self.ones else super().number(name)

    def printed_constant(self, variable: int) -> Number | None:
        return self.number(f"p{variable}") if self.table.is_angle[variable] else None

    def scale(self, variable: int) -> Value:
        """The weight of a variable."""
        number = self.number(f"w{variable}")
        return number if isinstance(number, Value) else self.rec.constant(number)

    @cached_property
    def equation_scales(self) -> list[Number]:
        """The scales that divide residuals."""
        return [self.number(f"s{r}") for r in range(self.n)]


def numbers_of(table: LoopTable) -> dict[str, float]:
    """The numbers of a block by name.

    ``c0.re`` a coefficient, ``k0`` a linear row's constant, ``s0`` an equation's scale, ``w0`` a
    variable's weight, ``p0`` the constant that an angle is printed with, ``f0.bend`` one of a law.
    """
    found: dict[str, float] = {}
    for term, c in enumerate(table.loops.coefficient.tolist()):
        found[f"c{term}.re"], found[f"c{term}.im"] = c.real, c.imag
    found |= {f"k{row}": x for row, x in enumerate(table.linear.constant.tolist())}
    found |= {f"s{row}": x for row, x in enumerate(table.equation_scale.tolist())}
    found |= {f"w{k}": x for k, x in enumerate(table.variable_scale.tolist())}
    for k, x in enumerate(table.printed_constant[: table.unknowns]):
        if x == x:
            found[f"p{k}"] = x
    for i, row in enumerate(table.functions):
        assert isinstance(row, LawRow)
        steeper = 50.0 * row.error * len(row.law.powers) / row.law.period
        own = {
            "constant": row.constant, "offset": row.offset, "bend": row.bend, "error": row.error,
            "steeper": steeper,
        }  # fmt: skip
        found |= {f"f{i}.{name}": float(x) for name, x in own.items()}
    return found


def _laws(table: LoopTable, form: Form) -> dict[str, Callable[..., Any]]:
    """The functions of a block by name."""
    found: dict[str, Callable[..., Any]] = {}
    for i, row in enumerate(table.functions):
        assert isinstance(row, LawRow)
        law = row.law
        if form is ARRAYS:
            found[f"f{i}"], found[f"f{i}.rounding"] = law.jet, law.rounding
        else:
            found[f"f{i}"] = law.jet_at
            found[f"f{i}.rounding"] = lambda x, law=law: [
                float(part[0]) for part in law.rounding(np.array([x]))
            ]
    return found


@dataclass(frozen=True)
class Shape:
    """What blocks have in common whose functions are the same."""

    sizes: tuple[int, ...]
    parts: tuple[tuple[float, ...], ...]
    zeros: frozenset[str]
    ones: frozenset[str]

    @property
    def key(self) -> str:
        """The same in every process: sets have no order."""
        return f"{self.sizes} {self.parts} {sorted(self.zeros)} {sorted(self.ones)}"

    @classmethod
    def of(cls, table: LoopTable, numbers: Mapping[str, Any]) -> Shape:
        loops, lines = table.loops, table.linear
        parts = [
            loops.row, loops.length, loops.phase_term, loops.phase_variable, loops.phase_weight,
            lines.row, lines.variable, lines.weight, table.is_angle,
        ]  # fmt: skip
        laws = [row.terms for row in table.functions if isinstance(row, LawRow)]
        return cls(
            (table.unknowns, table.variables, loops.rows, len(lines.constant), len(laws)),
            (
                *(tuple(part.tolist()) for part in parts),
                *(tuple(x for term in terms for x in term) for terms in laws),
            ),
            frozenset(name for name, x in numbers.items() if np.all(x == 0.0)),
            frozenset(name for name, x in numbers.items() if name[0] in "sw" and np.all(x == 1.0)),
        )


class ShapeWriter:
    """Writes the functions of a shape in one form; see :class:`BlockFunctions`."""

    def __init__(self, table: LoopTable, shape: Shape, form: Form) -> None:
        self._table, self._shape, self._form = table, shape, form
        self.n, self.variables = table.unknowns, [f"v{k}" for k in range(table.variables)]
        numbers = numbers_of(table)
        self.names = [
            *(name for name in numbers if name not in shape.zeros | shape.ones),
            *(f"f{i}{kind}" for i in range(len(table.functions)) for kind in ("", ".rounding")),
        ]

    def _closure(self) -> _Numbers:
        return _Numbers(self._table, self._shape.ones, self._shape.zeros)

    # ------------------------------------------------------------- Newton-Raphson

    def _correction(self) -> tuple[Recorder, list[int], list[int]]:
        """Newton's step: the largest residual, all of them; the largest correction and turn, all
        corrections.
        """
        closure = self._closure()
        rec, unknowns = closure.rec, closure.part.unknowns
        f = closure.residual()
        error = rec.largest(
            rec.divide(rec.absolute(x), s) for x, s in zip(f, closure.equation_scales, strict=True)
        )
        change = solve_linear(rec, closure.jacobian(unknowns), [f]).columns[0]
        size = rec.largest(
            rec.divide(rec.absolute(x), closure.scale(k))
            for x, k in zip(change, unknowns, strict=True)
        )
        angles = [x for x, k in zip(change, unknowns, strict=True) if self._table.is_angle[k]]
        turn = rec.largest(rec.absolute(x) for x in angles) if angles else rec.constant(0.0)
        return rec, [x.number for x in (error, *f)], [x.number for x in (size, turn, *change)]

    def solve(self) -> str:
        """Newton-Raphson, of floats."""
        rec, first, second = self._correction()
        fixed = _unmoved(rec, {f"v{k}" for k in range(self.n)}, [*first, *second])
        text = Statements(rec, self._form, [fixed, first, second])
        before, evidence, correct = (text.stage(k) for k in range(3))
        error, (size, turn, *change) = text.text(first[0]), map(text.text, second)
        unknowns = self.variables[: self.n]
        loop = [
            *evidence,
            f"error = {error}",
            f"if not error < inf or (last > {FAR!r} and count):",
            f"    status = {Status.DIVERGED.code}",
            "    break",
            "if error <= equation_tolerance or last <= solution_tolerance:  # eq. (8)",
            "    break",
            "if count == most:",
            f"    status = {Status.STEP_LIMIT.code}",
            "    break",
            *correct,
            f"size = {size}",
            "if not size < inf:",
            f"    status = {Status.SINGULAR_JACOBIAN.code}",
            "    break",
            f"if {turn} > largest_turn:",
            "    share = largest_turn / " + turn,
            *(f"    {v} -= share * {x}" for v, x in zip(unknowns, change, strict=True)),
            "    size *= share  # eq. (7)",
            "else:",
            *(f"    {v} -= {x}  # eq. (6)" for v, x in zip(unknowns, change, strict=True)),
            "if count:",
            f"    if size > {SMALLEST_RATIO!r}:",
            "        ratio = size / last",
            "        contraction = ratio if ratio > contraction else contraction",
            "else:",
            "    first = size",
            "last = size",
            "count += 1",
        ]
        body = [
            self._unpack,
            f"status, count = {Status.CONVERGED.code}, 0",
            "error = last = inf",
            "first = contraction = 0.0",
            "try:",
            *(f"    {line}" for line in before),
            "    while True:",
            *(f"        {line}" for line in loop),
            "except ZeroDivisionError:",
            f"    status = {Status.SINGULAR_JACOBIAN.code}",
            "except (ValueError, OverflowError):",
            f"    status, error = {Status.DIVERGED.code}, nan",
            f"return status, count, error, first, contraction, {_listed(unknowns)}",
        ]
        limits = ["most", "equation_tolerance", "solution_tolerance", "largest_turn"]
        return self._function("solve", [*self.variables, *limits], body)

    def correct(self) -> str:
        """One step of Newton-Raphson."""
        rec, first, second = self._correction()
        error, (size, turn, *change) = first[0], second
        return self._plain("correct", (rec, [error, size, turn, *change]), self.variables)

    # ------------------------------------------------------------- rates

    def _rate_values(self, closure: _Numbers) -> list[int]:
        """Rates of the unknowns, then condition and determinant."""
        rec, unknowns = closure.rec, closure.part.unknowns
        first: dict[int, Number] = {k: rec.input(f"r{k}") for k in closure.known_variables}
        second: dict[int, Number] = {k: rec.input(f"b{k}") for k in closure.known_variables}
        add_rates(closure, first, second)
        condition, determinant = condition_of(closure, closure.equation_scales)
        both = [rec.add(which[k], 0.0) for which in (first, second) for k in unknowns]
        return [x.number for x in (*both, condition, determinant)]

    def balanced(self) -> str:
        """The condition with all columns of J equally long."""
        closure = self._closure()
        rec, unknowns = closure.rec, closure.part.unknowns
        matrix, scales = closure.jacobian(unknowns), closure.equation_scales
        inverse, _ = inverse_of(rec, matrix)
        scaled = [
            [rec.divide(rec.absolute(x), s) for x in row]
            for row, s in zip(matrix, scales, strict=True)
        ]
        longest = [rec.largest(column) for column in zip(*scaled, strict=True)]
        shares = [rec.divide(1.0, x) for x in longest]
        found = rec.multiply(
            weighted_norm(rec, matrix, shares, scales), weighted_norm(rec, inverse, scales, shares)
        )
        return self._plain("balanced", (rec, [found.number]), self.variables)

    def rates(self) -> str:
        """Rates, condition and determinant."""
        closure = self._closure()
        recorded = closure.rec, self._rate_values(closure)
        return self._plain("rates", recorded, [*self.variables, *self._of_known("rb")])

    # ------------------------------------------------------------- proof

    @cached_property
    def _proof(self) -> tuple[Recorder, list[int], _Numbers, BlockProof]:
        """What a proof needs of a position, whatever the errors of the known variables.

        And the proof as numbers of another recorder, in which these are inputs ``q0``, ``q1``, ….
        """
        closure = self._closure()
        proof, later = BlockProof(closure), self._closure()
        places: dict[int, int] = {}

        def moved(x: Number) -> Value:
            known = closure.rec.known_value(x)
            if known is not None:
                return later.rec.constant(known)
            assert isinstance(x, Value)
            return later.rec.input(f"q{places.setdefault(x.number, len(places))}")

        after = proof.moved_to(later, moved)
        return closure.rec, list(places), later, after

    def place(self) -> str:
        """What proofs need of a position."""
        rec, needed, _, _ = self._proof
        return self._plain("place", (rec, needed), self.variables)

    def within(self) -> str:
        """The proof for known variables within some distance."""
        _, needed, closure, proof = self._proof
        arguments = [*(f"q{i}" for i in range(len(needed))), *self._of_known("e")]
        return self._plain("within", (closure.rec, _radii(closure, proof, "e")), arguments)

    def rates_and_proofs(self) -> str:
        """Rates, then proofs for known variables within two distances, all in one."""
        closure = self._closure()
        values = self._rate_values(closure)
        proof = BlockProof(closure)
        values += _radii(closure, proof, "e") + _radii(closure, proof, "g")
        arguments = [*self.variables, *self._of_known("rbeg")]
        return self._plain("rates_and_proofs", (closure.rec, values), arguments)

    def _of_known(self, kinds: str) -> list[str]:
        """Arguments for each of the known variables."""
        return [f"{kind}{k}" for kind in kinds for k in range(self.n, len(self.variables))]

    # ------------------------------------------------------------- writing

    @property
    def _unpack(self) -> str:
        return f"{_listed(map(local_name, self.names))} = numbers" if self.names else "pass"

    def _plain(
        self, name: str, recorded: tuple[Recorder, list[int]], arguments: Sequence[str]
    ) -> str:
        """A function that gives some recorded values."""
        recorder, values = recorded
        text = Statements(recorder, self._form, [values])
        lines = text.stage(0)
        found = _listed(text.text(k) for k in values)
        return self._function(name, arguments, [self._unpack, *lines, f"return {found}"])

    def _function(self, name: str, arguments: Sequence[str], body: Sequence[str]) -> str:
        statements = "\n    ".join(body)
        return f"def {name}(numbers, {', '.join(arguments)}):\n    {statements}\n"


def _radii(closure: _Numbers, proof: BlockProof, kind: str) -> list[int]:
    """A proof for known variables within distances: whether it holds, and its radii."""
    found = proof.within({k: closure.rec.input(f"{kind}{k}") for k in closure.known_variables})
    values = [
        found.holds, found.radius, found.uniqueness_radius, *found.error_bound,
        *found.isolation_radius,
    ]  # fmt: skip
    return [x.number for x in values]


def _listed(names: Iterable[str]) -> str:
    """Names as a tuple."""
    return "".join(f"{name}, " for name in names).removesuffix(" ") or "()"


def _unmoved(rec: Recorder, moving: set[str], values: Sequence[int]) -> list[int]:
    """The computed numbers that no moving input changes, but others use."""
    changed: list[bool] = []
    for op, sources, payload in zip(rec.ops, rec.arguments, rec.payload, strict=True):
        changed.append(payload in moving if op is Op.INPUT else any(changed[a] for a in sources))
    plain = (Op.INPUT, Op.CONSTANT)
    found: dict[int, None] = {}
    seen, stack = set[int](), list(values)
    while stack:
        k = stack.pop()
        if k in seen:
            continue
        seen.add(k)
        if not changed[k]:
            if rec.ops[k] not in plain:
                found[k] = None
            continue
        stack += rec.arguments[rec.arguments[k][0]] if rec.ops[k] is Op.COS else rec.arguments[k]
    return sorted(found)


class ShapeFunctions:
    """The functions of a shape in one form, each written when it is first needed."""

    def __init__(self, table: LoopTable, shape: Shape, form: Form) -> None:
        self._writer, self._form = ShapeWriter(table, shape, form), form
        self._code = KeptCode(f"{form.name} {shape.key}")
        self.names = self._writer.names

    def __getattr__(self, name: str) -> Callable[..., Any]:
        if name.startswith("_"):  # copies ask for these
            raise AttributeError(name)
        code = self._code.get(name, lambda: getattr(self._writer, name)())
        function = self._form.function(code, name)
        setattr(self, name, function)
        return function


_FORMS = FLOATS, ARRAYS
#: The functions of every shape that this process has met, by form.
_FUNCTIONS: dict[Shape, tuple[ShapeFunctions, ...]] = {}


class BlockFunctions:
    """The functions of one block in one form; see :class:`BlockRecord`."""

    def __init__(self, shared: ShapeFunctions, numbers: tuple[Any, ...]) -> None:
        self._shared, self._numbers = shared, numbers

    def __getattr__(self, name: str) -> Callable[..., Any]:
        if name.startswith("_"):
            raise AttributeError(name)
        function = partial(getattr(self._shared, name), self._numbers)
        setattr(self, name, function)
        return function


def functions_of(
    table: LoopTable, numbers: Mapping[str, Any], form: Form, shape: Shape | None = None
) -> BlockFunctions:
    """The functions of blocks like ``table`` with given numbers, one each or (D,)."""
    shape = Shape.of(table, numbers) if shape is None else shape
    if shape not in _FUNCTIONS:
        _FUNCTIONS[shape] = tuple(ShapeFunctions(table, shape, own) for own in _FORMS)
    shared = _FUNCTIONS[shape][_FORMS.index(form)]
    named = {**numbers, **_laws(table, form)}
    return BlockFunctions(shared, tuple(named[name] for name in shared.names))


class BlockRecord:
    """The functions of a block, :attr:`of_floats` and :attr:`of_arrays` (B,).

    All take the block's variables first, unknowns before known ones.

    ``solve(*v, most, equation_tolerance, solution_tolerance, largest_turn)``, of floats
        status, iterations, residual, first correction, contraction, then the unknowns
    ``correct(*v)``
        residual, size of the correction, its largest turn, then the corrections
    ``rates(*v, *first, *second)``, of the known variables
        first and second derivatives of the unknowns, condition, determinant
    ``balanced(*v)``
        condition with all columns of the Jacobian equally long
    ``place(*v)``
        what proofs need of a position
    ``within(*place, *errors)``, of the known variables
        whether a position is proved, radius, radius of uniqueness, then of each unknown how far
        it may be off, then how far other solutions are
    ``rates_and_proofs(*v, *first, *second, *errors, *farther)``
        what ``rates`` gives, then what ``within`` gives for both distances
    """

    def __init__(self, table: LoopTable) -> None:
        self.table = table
        numbers = numbers_of(table)
        shape = Shape.of(table, numbers)
        self.of_floats, self.of_arrays = (
            functions_of(table, numbers, form, shape) for form in _FORMS
        )

    def __reduce__(self) -> tuple[type[BlockRecord], tuple[LoopTable]]:
        return BlockRecord, (self.table,)


def record_of(table: LoopTable) -> BlockRecord | None:
    """The functions of a block; ``None`` with rows of any formula, or with many unknowns."""
    if not table.has_curvature_bound or not 0 < table.unknowns <= MOST_UNKNOWNS:
        return None
    return BlockRecord(table)
