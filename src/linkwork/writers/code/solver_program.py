"""Names of a file as identifiers of a language: ``O2 A`` becomes ``O2_A``, ``θ12`` ``theta12``."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterator, Set
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from linkwork.core.equations.compiling import coordinate_name
from linkwork.core.expression.tree import Binary, Call, Name, Negative, Node, names_in
from linkwork.core.foundation.arrays import Array
from linkwork.core.foundation.errors import InputError
from linkwork.core.foundation.names import canonical
from linkwork.core.motion.model import Model, leading_input
from linkwork.core.results.motion import Motion
from linkwork.core.results.quantity import Kind
from linkwork.writers.formulas.closure_formulas import CellFormula, ClosureFormulas
from linkwork.writers.formulas.rate_formulas import RateFormulas, rate_key
from linkwork.writers.formulas.traced import Dimension, traced

_ODD = re.compile(r"[^A-Za-z0-9]+")
_IDENTIFIERS_LONGEST = 60


@dataclass
class Identifiers:
    """Unique identifiers by key, which differ in more than upper and lower case.

    Parameters
    ----------
    reserved : set of str
        Words that are taken, in lower case.
    """

    reserved: Set[str]
    of: dict[str, str] = field(default_factory=dict)
    _used: set[str] = field(default_factory=set)

    def claim(self, key: str, preferred: str) -> str:
        """An identifier for ``key``, as similar as possible to the preferred one."""
        plain = unicodedata.normalize("NFKD", canonical(preferred).replace("'", "_prime"))
        stem = _ODD.sub("_", plain.encode("ascii", "ignore").decode()).strip("_")[
            :_IDENTIFIERS_LONGEST
        ]
        if not stem or not stem[0].isalpha():
            stem = f"x_{stem}".rstrip("_")
        name, count = stem, 1
        while name.lower() in self._used or name.lower() in self.reserved:
            count += 1
            name = f"{stem}_{count}"
        self._used.add(name.lower())
        self.of[key] = name
        return name


# ----------------------------------------------------------------------
# The solver of one mechanism, ready to be written in any language: names, formulas, numbers.


_SOLVER_PROGRAM_LONGEST = 200_000  # characters of a formula
_MOST_UNKNOWNS = 400  # of a block
_FEW = 2  # formulas that use a sine or cosine before it gets a name


@dataclass(frozen=True, kw_only=True)
class Lets:
    """Sines and cosines by their names in formulas, and the formulas that use these names."""

    named: tuple[tuple[str, CellFormula], ...] = ()
    formulas: tuple[CellFormula, ...] = ()


@dataclass(frozen=True, kw_only=True)
class BlockProgram:
    """A block of equations that are solved together.

    Parameters
    ----------
    titles : tuple of str
        Of its loops and other equations.
    unknowns : tuple of int
    closure : Lets
        F of every row; then the derivatives by every unknown, row by row.
    sides : Lets
        First, then second derivatives of every row with the rates of the block at 0.
    """

    titles: tuple[str, ...]
    unknowns: tuple[int, ...]
    closure: Lets
    sides: Lets


@dataclass(frozen=True, kw_only=True)
class Derived:
    """A number computed from the unknowns: its name in formulas, column, identifier, unit, formula
    and derivatives.
    """

    key: str
    title: str
    name: str
    unit: str
    formula: CellFormula
    rates: tuple[CellFormula, CellFormula] | None


@dataclass(frozen=True, kw_only=True)
class Stretch:
    """Rows of the table that lie on one branch: the first and the last one, and the unknowns of the
    first.
    """

    first: int
    last: int
    unknowns: tuple[float, ...]


@dataclass
class SolverProgram:
    """All parts of a program that solves a mechanism.

    Parameters
    ----------
    model : Model
    motion : Motion
        The sweep of the mechanism's table, whose rows the program computes again.
    name : str
        The name of the program, as that of its file without the suffix.
    reserved : set of str
        Words of the language and of its fixed parts, in lower case.

    Raises
    ------
    InputError
        If there are equations without formulas: cams, curves, laws.
    """

    model: Model
    motion: Motion
    name: str
    reserved: Set[str]
    names: Identifiers = field(init=False)

    def __post_init__(self) -> None:
        self.closure = ClosureFormulas(
            self.model,
            traced(self.model.description),
            longest=_SOLVER_PROGRAM_LONGEST,
            most_unknowns=_MOST_UNKNOWNS,
        )
        self.rates = RateFormulas(self.closure)
        for block, sides in zip(self.closure.blocks, self.rates.sides, strict=True):
            if block.unknowns and (not block.rows or not sides):
                raise InputError(
                    f"no program for {self.model.description.name}: "
                    f"{block.reason or 'its rates have no formulas'}"
                )
        self.names = Identifiers(self.reserved)
        self.names.claim("program", self.name)
        self._claim_names()

    def _claim_names(self) -> None:
        """Identifiers: variables first, which keep their names most exactly."""
        claim = self.names.claim
        for variable in self.model.equations.variables:
            claim(variable.symbol, variable.name)
        for link in self.closure.links:
            claim(canonical(link), link)
        for dimension in self.dimensions:
            claim(dimension.key, dimension.name)
        for part in self.closure.coefficients.values():
            claim(part.key, part.wanted)
        for point in self.closure.points:
            for axis in "xy":
                claim(coordinate_name(point, axis), f"{point}_{axis}")
        for name in self.closure.outputs:
            claim(f"output {name}", name)
        for order in (1, 2):
            for key in [v.symbol for v in self.model.equations.variables] + list(self.rates.of):
                claim(rate_key(key, order), f"{self.names.of[key]}_d{order}")

    # Numbers

    @cached_property
    def dimensions(self) -> list[Dimension]:
        """The dimensions that formulas use, ordered so that each follows those in its formula."""
        used = {node.name for formula in self._formulas() for node in names_in(formula.node)}
        for dimension in reversed(self.closure.traced.dimensions):
            if dimension.key in used and dimension.formula is not None:
                used |= {node.name for node in names_in(dimension.formula)}
        return [d for d in self.closure.traced.dimensions if d.key in used]

    def _formulas(self) -> Iterator[CellFormula]:
        closure = self.closure
        yield from (part.formula for part in closure.coefficients.values())
        yield from (formula for pair in closure.points.values() for formula in pair)
        yield from (*closure.links.values(), *closure.outputs.values())
        yield from (stated for _, stated in closure.released)
        yield from (formula for pair in self.rates.of.values() for formula in pair)
        for block, sides in zip(closure.blocks, self.rates.sides, strict=True):
            yield from (formula for pair in sides for formula in pair)
            for row in block.rows:
                yield from (row.formula, *row.slopes)

    @cached_property
    def units(self) -> tuple[float, ...]:
        """Internal units (radians, the file's length) per file unit of the unknowns."""
        angle = self.model.equations.angle.radians
        return tuple(angle if v.kind == "angle" else 1.0 for v in self.model.equations.unknowns)

    @cached_property
    def sizes(self) -> tuple[float, ...]:
        """By which changes of the unknowns [rad, length] are judged: 1, a length of the
        mechanism.
        """
        scales = self.model.compiled.solver.variable_scale
        return tuple(float(x) for x in scales[: len(self.model.equations.unknowns)])

    @cached_property
    def inputs(self) -> Array:
        """The inputs of the table's rows in file units, (R, M)."""
        rows = [self.motion.inputs[v.name] for v in self.model.equations.inputs]
        return np.stack(rows, axis=1)[self.motion.asked]

    @cached_property
    def input_rates(self) -> tuple[float, ...]:
        """Derivatives of the inputs with respect to the leading one."""
        kinds = [v.kind == "angle" for v in self.model.equations.inputs]
        scale = np.where(kinds, self.model.equations.angle.radians, 1.0)
        return tuple(float(x) for x in leading_input(self.inputs * scale)[1])

    @cached_property
    def stretches(self) -> tuple[Stretch, ...]:
        """The rows with a position, branch by branch."""
        solved, stretches = self.motion.found[self.motion.asked], []
        branch = np.array(self.motion.branch)[self.motion.asked]
        q = self.motion.q[self.motion.asked] / np.array(self.units)
        first = 0
        for k in range(1, len(solved) + 1):
            goes_on = k < len(solved) and solved[k] and branch[k] == branch[k - 1]
            if not goes_on or not solved[first]:
                if solved[first]:
                    unknowns = tuple(map(float, q[first]))
                    stretches.append(Stretch(first=first, last=k - 1, unknowns=unknowns))
                first = k
        return tuple(stretches)

    # Formulas

    @cached_property
    def blocks(self) -> tuple[BlockProgram, ...]:
        """The blocks in the order in which they are solved."""
        labels = self.model.equations.labels
        return tuple(
            BlockProgram(
                titles=tuple(labels[k] for k in numbers),
                unknowns=tuple(block.unknowns),
                closure=self._lets(
                    [row.formula for row in block.rows]
                    + [slope for row in block.rows for slope in row.slopes]
                ),
                sides=self._lets([pair[order] for order in (0, 1) for pair in sides]),
            )
            for (numbers, _), block, sides in zip(
                self.model.compiled.form.blocks, self.closure.blocks, self.rates.sides, strict=True
            )
            if block.unknowns
        )

    def _lets(self, formulas: list[CellFormula]) -> Lets:
        """Name the sines and cosines that occur more than once."""
        counted: dict[Call, int] = {}
        for formula in formulas:
            for node in _turned(formula.node):
                counted[node] = counted.get(node, 0) + 1
        names: dict[Node, Node] = {}
        lets: list[tuple[str, CellFormula]] = []
        for node, count in counted.items():
            if count < _FEW:
                continue
            key = f"let {node.function} {node.arguments[0]!r}"
            if key not in self.names.of:
                self.names.claim(key, f"{node.function}_{self._stem(node.arguments[0])}")
            names[node] = Name(key)
            lets.append((key, CellFormula(node)))
        replaced = tuple(CellFormula(_replaced(f.node, names), f.unit) for f in formulas)
        return Lets(named=tuple(lets), formulas=replaced)

    def _stem(self, node: Node) -> str:
        """A short name of an angle: that of the variables in it."""
        return "_".join(dict.fromkeys(self.names.of.get(x.name, "") for x in names_in(node)))

    @cached_property
    def derived(self) -> tuple[Derived, ...]:
        """Links that turn with other links, points and outputs, each after its operands."""
        closure, derived = self.closure, []
        for link, formula in closure.links.items():
            derived.append(self._derived(link, canonical(link), Kind.ANGLE, formula))
        for point, pair in closure.points.items():
            for axis, formula in zip("xy", pair, strict=True):
                key = coordinate_name(point, axis)
                derived.append(self._derived(f"{point}.{axis}", key, Kind.LENGTH, formula))
        for name, formula in closure.outputs.items():
            kind = Kind(self.model.equations.outputs[name].kind)
            derived.append(self._derived(name, f"output {name}", kind, formula))
        return tuple(derived)

    def _derived(self, title: str, key: str, kind: Kind, formula: CellFormula) -> Derived:
        return Derived(
            key=key,
            title=title,
            name=self.names.of[key],
            unit=self.model.units.of(kind),
            formula=formula,
            rates=self.rates.of.get(key),
        )


def _turned(node: Node) -> Iterator[Call]:
    """Sines and cosines in a formula."""
    match node:
        case Call():
            if node.function in ("sin", "cos"):
                yield node
            for argument in node.arguments:
                yield from _turned(argument)
        case Negative():
            yield from _turned(node.operand)
        case Binary():
            yield from _turned(node.left)
            yield from _turned(node.right)


def _replaced(node: Node, names: dict[Node, Node]) -> Node:
    """A formula with some of its parts replaced by names."""
    if node in names:
        return names[node]
    match node:
        case Call():
            return Call(node.function, tuple(_replaced(x, names) for x in node.arguments))
        case Negative():
            return Negative(_replaced(node.operand, names))
        case Binary():
            left, right = (_replaced(x, names) for x in (node.left, node.right))
            return Binary(node.operator, left, right)
        case _:
            return node
