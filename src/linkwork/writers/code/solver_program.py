"""Names of a file as identifiers of a language: ``O2 A`` becomes ``O2_A``, ``θ12`` ``theta12``."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Set
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from linkwork.core.foundation.arrays import Array
from linkwork.core.foundation.errors import InputError
from linkwork.core.foundation.names import canonical
from linkwork.core.motion.model import Model, leading_input
from linkwork.core.results.motion import Motion
from linkwork.core.results.quantity import Kind
from linkwork.writers.formulas.closure_formulas import BlockFormulas, ClosureFormulas, UniqueNames
from linkwork.writers.formulas.rate_formulas import Pair, RateFormulas, rate_key
from linkwork.writers.formulas.traced import Dimension, traced

_ODD = re.compile(r"[^A-Za-z0-9]+")
_IDENTIFIERS_LONGEST = 60


class Identifiers(UniqueNames):
    """Identifiers by key.

    Parameters
    ----------
    reserved : set of str
        Words that are taken, in lower case.
    """

    def __init__(self, reserved: Set[str]) -> None:
        super().__init__()
        self.reserved = reserved

    def is_taken(self, name: str) -> bool:
        """Whether a name is used or a word of the language."""
        return super().is_taken(name) or name.lower() in self.reserved

    def stem(self, preferred: str) -> str:
        """Letters without accents, digits and underscores, a letter first."""
        plain = unicodedata.normalize("NFKD", canonical(preferred).replace("'", "_prime"))
        stem = _ODD.sub("_", plain.encode("ascii", "ignore").decode()).strip("_")
        stem = stem[:_IDENTIFIERS_LONGEST]
        return stem if stem[:1].isalpha() else f"x_{stem}".rstrip("_")


# ----------------------------------------------------------------------
# The solver of one mechanism, ready to be written in any language: names, formulas, numbers.


_SOLVER_PROGRAM_LONGEST = 200_000  # characters of a formula
_MOST_UNKNOWNS = 400  # of a block


@dataclass(frozen=True, kw_only=True)
class SolvedBlock:
    """A block of equations that are solved together: its titles, formulas and right-hand sides."""

    titles: tuple[str, ...]
    formulas: BlockFormulas
    sides: tuple[Pair, ...]


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
        self._claim_names()

    def _claim_names(self) -> None:
        """Identifiers: variables first, which keep their names most exactly."""
        claim, variables = self.names.claim, self.model.equations.variables
        claim("program", self.name)
        for variable in variables:
            claim(variable.symbol, variable.name)
        for quantity in self.closure.quantities:
            if quantity.of == "link":  # before dimensions of their names
                claim(quantity.key, quantity.shown)
        for dimension in self.dimensions:
            claim(dimension.key, dimension.name)
        for part in self.closure.coefficients.values():
            claim(part.key, part.wanted)
        for quantity in self.closure.quantities:
            claim(quantity.key, quantity.shown)
        for order in (1, 2):
            for key in (*(v.symbol for v in variables), *self.rates.of):
                claim(rate_key(key, order), f"{self.names.of[key]}_d{order}")

    # Numbers

    @cached_property
    def dimensions(self) -> list[Dimension]:
        """The dimensions that formulas use, ordered so that each follows those in its formula."""
        return [d for d in self.closure.traced.dimensions if d.key in self.rates.used]

    @cached_property
    def units(self) -> tuple[float, ...]:
        """Internal units (radians, the file's length) per file unit of the unknowns."""
        units = self.model.units
        return tuple(units.scale(Kind(v.kind)) for v in self.model.equations.unknowns)

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
        scale = [self.model.units.scale(Kind(v.kind)) for v in self.model.equations.inputs]
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
    def blocks(self) -> list[SolvedBlock]:
        """The blocks in the order in which they are solved."""
        labels, form = self.model.equations.labels, self.model.compiled.form
        return [
            SolvedBlock(titles=tuple(labels[k] for k in numbers), formulas=block, sides=sides)
            for (numbers, _), block, sides in zip(
                form.blocks, self.closure.blocks, self.rates.sides, strict=True
            )
            if block.unknowns
        ]
