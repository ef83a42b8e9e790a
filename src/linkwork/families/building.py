"""The structure of equations without coefficients, which all designs of a family share."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from typing import Any, cast
from weakref import WeakKeyDictionary

import numpy as np

from linkwork.core.equations.compiling import Compiled, compile_equations
from linkwork.core.equations.from_description import read_loops, read_plain_equations, write_loops
from linkwork.core.equations.input_motion import driven_by_time
from linkwork.core.equations.model import LawEquation, LoopEquations, Term
from linkwork.core.foundation.arrays import (
    AnyArray,
    Array,
    BoolArray,
    ComplexArray,
    FrozenDict,
    IndexArray,
)
from linkwork.core.foundation.errors import InputError, LinkworkError
from linkwork.core.foundation.lanes import LaneArithmetic, NotElementwise, is_batched
from linkwork.core.foundation.values import as_told, check_class
from linkwork.core.mechanism.description import Description
from linkwork.core.mechanism.linkage import Linkage
from linkwork.core.mechanism.loops import Loops, PlainEquations
from linkwork.core.mechanism.varied_numbers import VariedNumber, number_named, with_numbers
from linkwork.core.motion.model import Model, model_of

#: The variable length and the weighted angles of a term.
TermKey = tuple[str | None, tuple[tuple[str, float], ...]]


@dataclass(frozen=True, kw_only=True)
class Coefficients:
    """The numbers of one set of equations in the order of a :class:`Pattern`; floats or lanes."""

    loops: Sequence[complex]
    points: Sequence[complex]
    linear: Sequence[float]
    link_angles: Sequence[float]
    start: Sequence[float]
    numbers: Sequence[float]
    redundant: Sequence[float]
    length_scale: Sequence[float]


@dataclass(frozen=True, kw_only=True)
class Pattern:
    """The parts of equations other than coefficients.

    Parameters
    ----------
    rest : tuple
        Variables, linear rows without constants, parents of points, variables of link angles,
        named numbers, redundant lengths; compared for equality.
    loops, points : tuple of tuple of TermKey
        The terms of every row.
    laws : tuple of LawEquation
        Laws of cams and curves; their numbers cannot vary in a family and must be equal.
    """

    rest: tuple[object, ...]
    loops: tuple[tuple[TermKey, ...], ...]
    points: tuple[tuple[TermKey, ...], ...]
    laws: tuple[LawEquation, ...]

    @classmethod
    def of(cls, equations: LoopEquations) -> Pattern:
        """The pattern of a set of equations."""
        return cls(
            rest=(
                tuple((v.symbol, v.kind) for v in equations.variables),
                len(equations.inputs),
                tuple((e.terms, e.kind) for e in equations.linear),
                tuple((name, path.parent) for name, path in equations.points.items()),
                tuple((link, angle.variable) for link, angle in equations.links.items()),
                tuple(equations.dimensions),
                tuple(part.variable for part in equations.redundant),
                equations.real,
            ),
            loops=tuple(_keys(loop.terms) for loop in equations.loops),
            points=tuple(_keys(path.terms) for path in equations.points.values()),
            laws=equations.laws,
        )

    @classmethod
    def with_coefficients(cls, equations: LoopEquations) -> tuple[Pattern, Coefficients]:
        """The pattern of a set of equations, and their own coefficients."""
        own = cls.of(equations)
        found = own._ordered(equations, own)
        assert found is not None
        return own, found

    def coefficients(self, equations: LoopEquations) -> Coefficients | None:
        """The coefficients in the order of this pattern; ``None`` if they do not match it.

        A term missing in the equations, such as that of an offset of 0, has the coefficient 0.
        """
        return self._ordered(equations, Pattern.of(equations))

    def _ordered(self, equations: LoopEquations, own: Pattern) -> Coefficients | None:
        if own.rest != self.rest or not _same_laws(own.laws, self.laws):
            return None
        loops = _in_order([loop.terms for loop in equations.loops], own.loops, self.loops)
        paths = [path.terms for path in equations.points.values()]
        points = _in_order(paths, own.points, self.points)
        if loops is None or points is None:
            return None
        return Coefficients(
            loops=loops,
            points=points,
            linear=[equation.constant for equation in equations.linear],
            link_angles=[angle.constant for angle in equations.links.values()],
            start=list(equations.start),
            numbers=list(equations.dimensions.values()),
            redundant=[part.length for part in equations.redundant],
            length_scale=[equations.length_scale],
        )


def _keys(terms: Iterable[Term]) -> tuple[TermKey, ...]:
    return tuple((term.length, term.phase) for term in terms)


def _in_order(
    rows: Sequence[Sequence[Term]],
    keys: Sequence[Sequence[TermKey]],
    wanted: Sequence[Sequence[TermKey]],
) -> list[complex] | None:
    """The values of all terms by key; like terms of a row keep their order."""
    if len(rows) != len(wanted):
        return None
    values: list[complex] = []
    for terms, own, want in zip(rows, keys, wanted, strict=True):
        if own == want:
            values += [term.value for term in terms]
            continue
        left: dict[TermKey, list[complex]] = {}
        for key, term in zip(own, terms, strict=True):
            left.setdefault(key, []).append(term.value)
        values += [left[key].pop(0) if left.get(key) else 0j for key in want]
        if any(left.values()):
            return None
    return values


def _same_laws(laws: Sequence[LawEquation], others: Sequence[LawEquation]) -> bool:
    return len(laws) == len(others) and all(map(_same_law, laws, others))


def _same_law(a: LawEquation, b: LawEquation) -> bool:
    return (
        (a.terms, a.inner, a.kind) == (b.terms, b.inner, b.kind)
        and bool(a.constant == b.constant)
        and bool(a.offset == b.offset)
        and all(
            np.array_equal(getattr(a.law, numbers), getattr(b.law, numbers))
            for numbers in ("breaks", "powers", "sines")
        )
    )


# ----------------------------------------------------------------------
# Build the equations of many designs by running the builder of one design on arrays.
#
# A pass runs the builder on all remaining designs and takes every decision as for one of them, the
# leader (the mechanism itself in the first pass); the results are valid for the designs with the
# same decisions. Most families need one pass. Designs that the builder cannot process as arrays
# (cams, shapes that need Gauss-Newton) are built one at a time.


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
            model = model_of(with_numbers(self.base.description, numbers))
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


# ----------------------------------------------------------------------
# A family: many designs of one topology as arrays of coefficients.


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Designs:
    """B designs of one topology as arrays.

    Arrays are in Fortran order: a coefficient of all designs is contiguous in memory. Rows of
    designs with a problem are NaN.

    Parameters
    ----------
    base : Model
        The mechanism itself: structure, blocks, names. Varied numbers keep their terms even if they
        are 0 in the mechanism, such as the offset of a slider.
    dimensions : Mapping[str, (B,)]
        The varied numbers, in file units, by the names given.
    quantities : tuple of VariedNumber
        The corresponding numbers of the description, in the same order.
    loops : (B, T) complex
        Coefficients of ``base.compiled.table.loops``, in the order of its terms, [length].
    linear : (B, R)
        Constants of ``base.compiled.table.linear``, [rad] or [length].
    points : (B, P) complex
        Coefficients of ``base.compiled.points.rows``, [length].
    link_angles : (B, links)
        Constants of ``base.equations.links``, [rad].
    start : (B, N)
        Guess of the unknowns, then its inputs, [rad] or [length].
    numbers : (B, D)
        All named dimensions, in the order of ``base.equations.dimensions``, in file units, for
        outputs and constants of plain equations.
    redundant : (B, r)
        Lengths of ``base.equations.redundant``.
    length_scale : (B,)
        The longest link.
    problem : (B,)
        Index of a design's problem in ``problems``; 0 for none.
    problems : tuple of str
        Distinct problems, the first one empty. Numbers that differ between designs are omitted:
        :meth:`message` contains those of one design.
    """

    base: Model
    dimensions: Mapping[str, Array]
    quantities: tuple[VariedNumber, ...]
    loops: ComplexArray
    linear: Array
    points: ComplexArray
    link_angles: Array
    start: Array
    numbers: Array
    redundant: Array
    length_scale: Array
    problem: IndexArray
    problems: tuple[str, ...] = ("",)

    def __len__(self) -> int:
        return len(self.problem)

    def __repr__(self) -> str:
        bad = int(np.count_nonzero(self.problem))
        varied = ", ".join(self.dimensions)
        return (
            f'<Designs of "{self.base.description.name}": {len(self)} with varied {varied}; '
            f"{bad} with a problem>"
        )

    def take(self, index: Sequence[int] | IndexArray | BoolArray | slice) -> Designs:
        """Some of the designs, in the order of ``index`` (integers, a mask or a slice)."""
        rows: dict[str, AnyArray] = {
            part.name: array[index]
            for part in fields(self)
            if isinstance(array := getattr(self, part.name), np.ndarray)
        }
        dimensions = {name: values[index] for name, values in self.dimensions.items()}
        return replace(self, dimensions=FrozenDict(dimensions), **rows)  # type: ignore[arg-type]

    def description(self, k: int) -> Description:
        """The description of the k-th design.

        Raises
        ------
        MechanismError
            If its description has a problem.
        """
        columns = zip(self.quantities, self.dimensions.values(), strict=True)
        numbers = {quantity: float(values[k]) for quantity, values in columns}
        return with_numbers(self.base.description, numbers)

    def design(self, k: int) -> Model:
        """The compiled model of the k-th design.

        Raises
        ------
        MechanismError
            If it has a problem.
        """
        return model_of(self.description(k))

    def message(self, k: int) -> str:
        """The problem of the k-th design, with its numbers; empty if there is none."""
        if not self.problem[k]:
            return ""
        try:
            self.design(k)
        except (LinkworkError, ArithmeticError) as error:
            return str(error)
        return self.problems[int(self.problem[k])]


def designs_of(mechanism: object, dimensions: Mapping[str, object]) -> Designs:
    """Designs of a mechanism with some numbers varied.

    Parameters
    ----------
    mechanism : Model, or an object with a model
    dimensions : Mapping[str, number or (B,)]
        The varied numbers, in file units: a name of ``[dimensions]``; an entry of ``[lengths]``
        (``"O2 A"``) or ``[angles]`` (``"B A P"``); a coordinate (``"O4.x"``); the offset of a
        slider (``"s16.offset"``); in loops and plain equations a name of ``[guess]``. A plain
        number holds for all designs.

    Raises
    ------
    UnknownNameError
        If a name is not a number of the mechanism.
    InputError
        If an entry is not a number or array of numbers, or arrays differ in length.

    Notes
    -----
    A design that cannot be built has a problem; no error is raised. The equations equal those of
    the design compiled separately, to rounding. If the mechanism names a configuration, all designs
    start from it: a search for this configuration in every design would take too long.

    Examples
    --------
    >>> import linkwork as lw
    >>> from linkwork.families import designs_of
    >>> designs = designs_of(lw.example("four-bar"), {"O2 A": [38, 40, -1]})
    >>> designs.problem.tolist(), designs.loops.shape[0]
    ([0, 0, 1], 3)
    """
    found: object = getattr(mechanism, "model", mechanism)
    check_class("the mechanism of a family", found, Model)
    model = cast(Model, found)
    if not isinstance(dimensions, Mapping):
        raise InputError(
            "a family needs a mapping of names and their values, as in "
            f'{{"a2": [40, 50]}}, got {as_told(dimensions)}'
        )
    quantities = tuple(number_named(model.description, name) for name in dimensions)
    _check_different(dict(zip(dimensions, quantities, strict=True)))
    columns = _columns(dimensions)
    base, together = family_base(model, quantities)
    builder = Builder(base, dict(zip(quantities, columns.values(), strict=True)), together)
    builder.run()
    arrays: dict[str, Any] = builder.arrays
    if model.description.configuration:
        # see the notes: all designs start from the configuration of the mechanism
        arrays["start"][builder.problem == 0] = model.equations.start
    return Designs(
        base=base,
        dimensions=FrozenDict(columns),
        quantities=quantities,
        problem=builder.problem,
        problems=tuple(builder.problems),
        **arrays | {"length_scale": arrays["length_scale"][:, 0]},
    )


def _check_different(named: Mapping[str, VariedNumber]) -> None:
    if not named:
        raise InputError("this family varies no numbers: give a dimension and its values")
    first: dict[VariedNumber, str] = {}
    for name, quantity in named.items():
        if first.setdefault(quantity, name) != name:
            raise InputError(f'"{first[quantity]}" and "{name}" are the same number: give it once')


def _columns(dimensions: Mapping[str, object]) -> dict[str, Array]:
    """Every entry as an array (B,), read-only."""
    given = {name: _numeric(name, values) for name, values in dimensions.items()}
    lengths = {name: len(values) for name, values in given.items() if values.ndim}
    if len(set(lengths.values())) > 1:
        told = ", ".join(f"{name}: {count}" for name, count in lengths.items())
        raise InputError(f"arrays of a family need equal lengths, got {told}")
    count = max(lengths.values(), default=1)
    return {name: np.broadcast_to(values, (count,)) for name, values in given.items()}


def _numeric(name: str, values: object) -> Array:
    if np.ma.is_masked(values):
        raise InputError(
            f'"{name}" holds masked values: fill them (with NaN those designs are not found), '
            "or leave these designs out"
        )
    try:
        array = np.asarray(values)
    except ValueError:
        raise InputError(f'"{name}" needs a number or an array of numbers, got rows') from None
    if array.dtype.kind not in "iuf":
        raise InputError(f'"{name}" needs a number or an array of numbers, got {as_told(values)}')
    if array.ndim > 1:
        shape = " × ".join(map(str, array.shape))
        raise InputError(f'"{name}" needs a number or an array of one axis, got {shape} numbers')
    found = np.array(array, dtype=np.float64)
    # a copy, read-only: the numbers of a family cannot change behind its results
    found.flags.writeable = False
    return found


# ----------------------------------------------------------------------
# Designs whose loops cannot close at the start, told from lengths alone.


_SURE = 1e-6  # of the longest link: far more than a solver leaves of a closed loop


def stay_open(designs: Designs) -> BoolArray:
    """Whether a loop of a design lacks length to close at the inputs of its start, (D,).

    The terms of a loop are sides of a polygon; those that only inputs turn, or the same unknowns,
    form one side. No polygon has a side longer than all others together.
    """
    loops, n = designs.base.compiled.table.loops, designs.base.compiled.table.unknowns
    weights = loops.weight_matrix
    vectors = designs.loops * np.exp(1j * (designs.start[:, n:] @ weights[n:]))
    found = np.zeros(len(designs), dtype=bool)
    for row in range(loops.rows):
        terms = np.flatnonzero(loops.row == row)
        # a sliding length can be as long as it must be
        if (loops.length[terms] >= 0).any():
            continue
        _, side = np.unique(weights[:n, terms], axis=1, return_inverse=True)
        sums = vectors[:, terms] @ (side.ravel()[:, None] == np.arange(side.max() + 1))
        lengths = np.abs(sums)
        lack = 2.0 * lengths.max(axis=1) - lengths.sum(axis=1)
        found |= lack > _SURE * designs.length_scale
    return found
