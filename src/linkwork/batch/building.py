"""Build the equations of many designs by running the builder of one design on arrays.

A pass runs the builder on all remaining designs and takes every decision as for one of them, the
leader (the mechanism itself in the first pass); the results are valid for the designs with the same
decisions. Most families need one pass. Designs that the builder cannot process as arrays (cams,
shapes that need Gauss-Newton) are built one at a time.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from weakref import WeakKeyDictionary

import numpy as np

from linkwork.batch.pattern import Coefficients, Pattern
from linkwork.equations.compiling import Compiled, compile_equations
from linkwork.equations.from_linkage import write_loops
from linkwork.equations.from_loops import read_loops, read_plain_equations
from linkwork.equations.input_motion import driven_by_time
from linkwork.equations.model import LoopEquations
from linkwork.foundation.arrays import AnyArray, Array, IndexArray
from linkwork.foundation.errors import LinkworkError
from linkwork.foundation.lanes import LaneArithmetic, is_batched
from linkwork.foundation.operand import NotElementwise
from linkwork.mechanism.description import Description
from linkwork.mechanism.linkage import Linkage
from linkwork.mechanism.loops import Loops, PlainEquations
from linkwork.mechanism.varied_number import VariedNumber, with_numbers
from linkwork.motion.model import Model, model_of

__all__ = ["Builder", "build_design", "family_base", "write_equations"]

_BLOCK = 1 << 14  # designs built together: their arrays fit into the processor's cache
_MOST_PASSES = 100
_COMPLEX = ("loops", "points")


def write_equations(description: Description) -> LoopEquations:
    """The equations of a description; its numbers may be arrays of designs."""
    equations = _own_equations(description)
    return driven_by_time(equations, description) if description.timed else equations


def _own_equations(description: Description) -> LoopEquations:
    match description:
        case Linkage():
            return write_loops(description)
        case Loops():
            return read_loops(description)
        case PlainEquations():
            return read_plain_equations(description)
        case _:
            raise TypeError(f"no equations are known for {type(description).__name__}")


@dataclass
class Builder:
    """Builds designs into arrays.

    Parameters
    ----------
    base : Model
        The family's structure; see :func:`family_base`.
    values : Mapping[VariedNumber, (B,)]
        The varied numbers, in file units.
    together : bool
        Whether designs can be built in passes; otherwise one at a time.

    Attributes
    ----------
    arrays : dict[str, (B, ...)]
        The fields of :class:`Coefficients`; NaN where there is a problem.
    problem : (B,)
        Index of a design's problem in ``problems``; 0 for none.
    """

    base: Model
    values: Mapping[VariedNumber, Array]
    together: bool
    arrays: dict[str, AnyArray] = field(default_factory=dict)
    problem: IndexArray = field(default_factory=lambda: np.zeros(0, dtype=np.intp))
    problems: list[str] = field(default_factory=lambda: [""])

    def __post_init__(self) -> None:
        equations = self.base.equations
        self.pattern, own = Pattern.with_coefficients(equations)
        count = len(next(iter(self.values.values())))
        for name, values in _named(own).items():
            kind = complex if name in _COMPLEX else float
            # Fortran order: passes write one coefficient of all designs at a time
            self.arrays[name] = np.full((len(values), count), np.nan, dtype=kind).T
        self.problem = np.zeros(count, dtype=np.intp)
        self._number = {"": 0}
        self._numbers_of_base = {q: q.of(self.base.description) for q in self.values}

    def run(self) -> None:
        """Build all designs."""
        count = len(self.problem)
        for start in range(0, count, _BLOCK):
            left = np.arange(start, min(start + _BLOCK, count))
            passes = 0
            while self.together and left.size and passes < _MOST_PASSES:
                left = self._pass(left, first=passes == 0)
                passes += 1
            for k in left:
                self._alone(int(k))
        self._check_finite()

    def _pass(self, rows: IndexArray, *, first: bool) -> IndexArray:
        """Build the designs with the leader's decisions; returns the others."""
        # lane 0 is the mechanism; later passes follow a design that disagreed with it
        consensus = LaneArithmetic(1 + len(rows), leader=0 if first else 1)
        numbers = {
            quantity: consensus.lanes(
                np.concatenate([[self._numbers_of_base[quantity]], values[rows]])
            )
            for quantity, values in self.values.items()
        }
        found: Coefficients | None = None
        problem = self._another_structure
        alone = False
        with np.errstate(all="ignore"):
            try:
                equations = write_equations(with_numbers(self.base.description, numbers))
                found = self.pattern.coefficients(equations)
            except NotElementwise:
                alone = True
            except LinkworkError as error:
                problem = str(error)
        agreeing, apart = consensus.agreeing[1:], consensus.apart[1:]
        if alone:
            for k in rows[agreeing]:
                self._alone(int(k))
        elif found is None:
            self._mark(rows[agreeing], problem)
        else:
            self._write(rows, agreeing & ~apart, found)
            self._mark(rows[agreeing & apart], self._another_structure)
        return rows[~agreeing]

    def _alone(self, k: int) -> None:
        """Build one design separately."""
        numbers = {quantity: float(values[k]) for quantity, values in self.values.items()}
        rows = np.array([k])
        try:
            model = build_design(with_numbers(self.base.description, numbers))
        except (LinkworkError, ArithmeticError) as error:
            self._mark(rows, str(error))
            return
        found = self.pattern.coefficients(model.equations)
        if found is None:
            self._mark(rows, self._another_structure)
        else:
            self._write(rows, np.ones(1, dtype=bool), found)

    def _write(self, rows: IndexArray, which: AnyArray, found: Coefficients) -> None:
        """Store the coefficients of the designs ``rows[which]``."""
        # slices are written much faster than single elements
        whole = bool(which.all()) and len(rows) == rows[-1] - rows[0] + 1
        at: slice | IndexArray = slice(rows[0], rows[-1] + 1) if whole else rows[which]
        for name, values in _named(found).items():
            columns = self.arrays[name].T
            for column, value in zip(columns, values, strict=True):
                if not is_batched(value):
                    column[at] = value
                else:
                    own = value.values[1:]
                    column[at] = own if whole else own[which]

    def _mark(self, rows: IndexArray, problem: str) -> None:
        if not rows.size:
            return
        if problem not in self._number:
            self._number[problem] = len(self.problems)
            self.problems.append(problem)
        self.problem[rows] = self._number[problem]

    @property
    def _another_structure(self) -> str:
        return (
            f"has another structure than {self.base.description.name}: other terms, ratios or laws"
        )

    def _check_finite(self) -> None:
        """Rebuild designs without finite coefficients separately; reject those still not finite."""
        odd = np.flatnonzero(~self._finite() & (self.problem == 0))
        if odd.size:
            for k in odd:
                self._alone(int(k))
            odd = odd[~self._finite()[odd] & (self.problem[odd] == 0)]
            self._mark(odd, "its equations have no finite coefficients")
        if self.problem.any():
            for array in self.arrays.values():
                array[self.problem != 0] = np.nan

    def _finite(self) -> AnyArray:
        finite = np.ones(len(self.problem), dtype=bool)
        for array in self.arrays.values():
            finite &= np.isfinite(array).all(axis=1)
        return finite


def _named(found: Coefficients) -> dict[str, Sequence[object]]:
    return {part.name: getattr(found, part.name) for part in fields(found)}


def build_design(description: Description) -> Model:
    """The model of one design, compiled like any mechanism."""
    return model_of(description)


def family_base(model: Model, varied: Sequence[VariedNumber]) -> tuple[Model, bool]:
    """The structure of a family, and whether designs can be built in passes.

    The structure is that of the mechanism, except that varied numbers keep their terms at the value
    0, such as the offset of a slider.
    """
    description = model.description
    spoken = sum(which.speed is not None for which in description.inputs)
    # released links and contradicting speeds depend on numbers, and are decided design by design;
    # so do the pieces of laws
    if model.equations.surplus is not None or spoken > 1 or description.timed:
        return model, False
    known = _WIDENED.setdefault(model.compiled, {})
    key = tuple(varied)
    if key not in known:
        known[key] = _widened(model, varied)
    wider = known[key]
    if wider is None:
        return model, True
    equations = wider.within(model.equations)
    return Model(description, equations, wider.compiled, model.skeleton, model.branch), True


@dataclass(frozen=True, kw_only=True, eq=False)
class _Widened:
    """Equations with the terms that varied numbers can bring, and these compiled."""

    equations: LoopEquations
    compiled: Compiled

    def within(self, own: LoopEquations) -> LoopEquations:
        """A mechanism's own equations with these terms."""
        wide = self.equations
        return replace(own, loops=wide.loops, points=wide.points, symbols=wide.symbols)


#: What families of the same mechanism share: by the numbers that they vary; ``None`` if its own
#: equations have all terms.
_WIDENED: WeakKeyDictionary[Compiled, dict[tuple[VariedNumber, ...], _Widened | None]] = (
    WeakKeyDictionary()
)


def _widened(model: Model, varied: Sequence[VariedNumber]) -> _Widened | None:
    description = model.description
    consensus = LaneArithmetic(1, widest=True)
    numbers = {q: consensus.lanes(np.array([q.of(description)])) for q in varied}
    try:
        with np.errstate(all="ignore"):
            equations = write_equations(with_numbers(description, numbers))
    except NotElementwise:
        return None
    own, wider = Pattern.of(model.equations), Pattern.of(equations)
    if (own.loops, own.points) == (wider.loops, wider.points):
        return None
    first = equations.mapped(_first)
    plain = replace(model.equations, loops=first.loops, points=first.points, symbols=first.symbols)
    compiled = compile_equations(plain, f'mechanism "{description.name}"')
    return _Widened(equations=plain, compiled=compiled)


def _first(number: complex) -> complex:
    return number.values[0].item() if is_batched(number) else number
