"""Gradients of every quantity of the library by every number, against independent references.

The first reference states the equations of the file anew, in seventy digits
(``tests/oracles/stated_equations.py``). Forces, and cams, curves and gears by splines, are not
stated there: for these the second reference differentiates the product's own positions, which
shares formulas of quantities with the tape, but neither its rules of derivatives nor the implicit
function theorem.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

import linkwork as lw
from linkwork.core.foundation.arrays import Array, BoolArray
from linkwork.core.foundation.errors import InputError, LinkworkError
from linkwork.core.mechanism.linkage import Linkage
from linkwork.core.mechanism.loops import Loops
from linkwork.core.mechanism.varied_numbers import VariedNumber, with_numbers
from linkwork.core.motion.model import Model, leading_input, model_of
from linkwork.core.motion.positions import RowValues
from linkwork.core.results.quantity import Kind
from linkwork.design.derivatives.forces import LoadedRows
from linkwork.design.derivatives.rows import chosen_numbers
from tests.design.extrapolated import own_position
from tests.forces.random_loads import loaded
from tests.library_mechanisms import driven_examples, read_example
from tests.oracles.stated_equations import NotStated
from tests.oracles.stated_quantities import StatedRow

__all__ = ["EVERY", "gradient_campaign"]

#: All driven mechanisms of the library, and the same with random loads.
EVERY = 2 * len(driven_examples())

_AGREE = 1e-9  # of the scale of a derivative
_DECIDED = 1e-10  # the reference must be known ten times better
_BINS = (1e-13, 1e-12, 1e-11, 1e-10, 1e-9)
_RATES = ("", ".d1", ".d2", ".velocity", ".acceleration")
_PLACES = (0.31, 0.73)  # of the table; the inputs lie between its rows
_BETWEEN = 0.37
_MOST_CONDITION = 1e4
_STEP = 1.5e-3  # of the size of a number
#: Multiples of the step; three rules of the order twelve, each twice as wide as the one before.
_NODES = (1, 2, 3, 4, 6, 8, 12, 16, 24, 32)
_RULES = ((1, 2, 3, 4, 6, 8), (2, 4, 6, 8, 12, 16), (4, 8, 12, 16, 24, 32))


@dataclass(frozen=True)
class _Rows:
    """Well-conditioned rows of a mechanism, and the quantities to compare in them."""

    model: Model
    v: Array
    wanted: tuple[str, ...]

    def values(self, model: Model) -> Array:
        """The quantities of another design at the positions next to these, (Q, B)."""
        here = own_position(model, self.v)
        rates = model.compiled.solver.rates(here, leading_input(model.rows)[1])
        found = np.ones(len(here), dtype=bool)
        rows = RowValues(model, here, rates.first, rates.second, found)
        values = [model.quantities.find(name).values(rows, model.speed) for name in self.wanted]
        return np.stack([np.broadcast_to(x, len(here)) for x in values])

    @cached_property
    def _here(self) -> RowValues:
        rates = self.model.compiled.solver.rates(self.v, leading_input(self.model.rows)[1])
        found = np.ones(len(self.v), dtype=bool)
        return RowValues(self.model, self.v, rates.first, rates.second, found)

    def stated(self, row: int) -> StatedRow:
        """A row by the equations that the file states, from here as a first guess."""
        model, known = self.model, len(self.model.equations.unknowns)
        guess = {}
        for name, asked in model.quantities.own.items():
            value = np.broadcast_to(asked.jet(self._here).v, len(self.v))[row]
            angle = asked.own.kind is Kind.ANGLE
            guess[name] = float(value) * (model.units.scale(Kind.ANGLE) if angle else 1.0)
        return StatedRow(model, guess, self.v[row, known:], leading_input(model.rows)[1])

    def varied(self, number: VariedNumber, to: float) -> Array:
        """The quantities with another value of one number."""
        return self.values(model_of(with_numbers(self.model.description, {number: to})))


def gradient_campaign(part: int) -> tuple[Counter[str], list[str]]:
    """Counts and false claims of one mechanism."""
    counts: Counter[str] = Counter()
    names = driven_examples()
    mechanism, forced = read_example(names[part % len(names)]), part >= len(names)
    if forced:
        if not isinstance(mechanism.description, Linkage | Loops):
            return counts, []
        mechanism = loaded(mechanism, seed=part)
    with np.errstate(all="ignore"):
        rows = _rows(mechanism, forced)
        if rows is None:
            counts["open: no well-conditioned row"] += 1
            return counts, []
        own, numbers = _gradients(rows)
        counts["mechanisms"] += 1
        counts["rows"] += len(rows.v)
        counts["numbers"] += len(numbers)
        counts["quantities"] += len(rows.wanted)
        false = list(_compare(rows, numbers, own, counts))
    return counts, [f"{mechanism.name}{' with loads' if forced else ''}: {x}" for x in false]


def _rows(mechanism: lw.Mechanism, forced: bool) -> _Rows | None:
    model = mechanism.model
    motion = mechanism.sweep(certify=False)
    inputs = np.stack([motion.inputs[x.name] for x in model.equations.inputs], axis=1)
    table = np.hstack([motion.q, inputs * model.input_scale])
    fine = np.flatnonzero(motion.found & (motion.condition <= _MOST_CONDITION))
    if not len(fine):
        return None
    which = sorted({int(fine[int(place * len(fine))]) for place in _PLACES})
    v = table[which]
    known = len(model.equations.unknowns)
    if len(table) > 1:
        ahead = np.minimum(np.array(which) + 1, len(table) - 1)
        v[:, known:] += _BETWEEN * (table[ahead] - v)[:, known:]
    v = own_position(model, v)
    v = v[np.isfinite(v).all(axis=1)]
    return _Rows(model, v, tuple(_wanted(model, forced))) if len(v) else None


def _wanted(model: Model, forced: bool) -> Iterator[str]:
    """Every quantity with its rates; ``forced``: only those of forces."""
    known, of_forces = model.quantities, set(model.quantities.names.further)
    plain = [own.name for own in known.own.values() if not forced]
    plain += [own.name for own in known.derived.values() if own.row in of_forces or not forced]
    for name in plain:
        for rate in _RATES:
            try:
                asked = known.find(f"{name}{rate}")
                asked.check_rate(model.speed)
            except LinkworkError:
                continue
            if asked.needs <= 2:
                yield asked.name


def _gradients(rows: _Rows) -> tuple[Array, tuple[VariedNumber, ...]]:
    """The derivatives of the product, (Q, P, B): NaN for quantities whose are not known."""
    model = rows.model
    numbers, _ = chosen_numbers(model, None)
    taped = LoadedRows(model, numbers, rows.v, 2)
    fits = np.ones(len(numbers), dtype=bool)
    for rates in taped.tape.forward(taped.misfits):
        fits &= (np.abs(rates) < _AGREE).all(axis=1)
    found = np.full((len(rows.wanted), len(numbers), len(rows.v)), np.nan)
    for k, name in enumerate(rows.wanted):
        try:
            result = model.quantities.find(name).values(taped, taped.speed)
        except InputError:
            continue
        found[k] = taped.tape.backward(result)
    kept = tuple(q for q, fit in zip(numbers, fits, strict=True) if fit)
    return found[:, fits], kept


def _compare(
    rows: _Rows, numbers: tuple[VariedNumber, ...], own: Array, counts: Counter[str]
) -> Iterator[str]:
    here = rows.values(rows.model)
    sizes = np.array([_size(rows.model, number) for number in numbers])
    stated, false = _stated(rows, numbers, here)
    yield from false
    references, errors = _differences(rows, numbers, sizes, ~np.isfinite(stated))
    exact = np.isfinite(stated)
    references = np.where(exact, stated, references)
    errors = np.where(exact, 0.0, errors)
    scale = _scale(rows, here, own, references, sizes)
    apart = np.abs(own - references)
    apart = np.divide(apart, scale, out=apart, where=apart != 0.0)  # forces may all be 0
    decided = errors <= _DECIDED * scale
    for place in np.ndindex(own.shape):
        q, k, b = place
        if not np.isfinite(here[q, b]):
            counts["no value in the row"] += 1
        elif np.isinf(errors[place]):
            counts["open: changed designs are refused"] += 1
        elif not np.isfinite(own[place]):
            counts["open: no derivative"] += 1
        elif not decided[place]:
            counts["open: reference"] += 1
            counts["of these equal to 1e-6"] += int(apart[place] <= 1e-6)
        else:
            counts["compared"] += 1
            counts["of these with stated equations"] += int(exact[place])
            worst = next((edge for edge in _BINS if apart[place] <= edge), None)
            counts["differ more" if worst is None else f"equal to {worst:.0e}"] += 1
            if worst is None:
                yield (
                    f"d {rows.wanted[q]} / d {numbers[k].name}: {own[place]!r}, "
                    f"reference {references[place]!r}, apart {apart[place]:.1e}"
                )


def _stated(rows: _Rows, numbers: tuple[VariedNumber, ...], here: Array) -> tuple[Array, list[str]]:
    """Derivatives by the equations of the file, (Q, P, B), NaN where it has none; wrong values."""
    found = np.full((len(rows.wanted), len(numbers), len(rows.v)), np.nan)
    false: list[str] = []
    for b in range(len(rows.v)):
        try:
            row = rows.stated(b)
            values = np.array(row.values(rows.wanted))
        except NotStated:
            continue
        off = np.abs(values - here[:, b]) > 1e-9 * np.fmax(_floor(rows, here), np.abs(values))
        false += [
            f"{rows.wanted[q]} is {here[q, b]!r}, by the equations of the file {values[q]!r}"
            for q in np.flatnonzero(off & np.isfinite(here[:, b]))
        ]
        for k, number in enumerate(numbers):
            try:
                found[:, k, b] = row.slopes(rows.wanted, number)
            except NotStated:
                continue
    return found, false


def _differences(
    rows: _Rows, numbers: tuple[VariedNumber, ...], sizes: Array, wanted: BoolArray
) -> tuple[Array, Array]:
    """Derivatives by differences where wanted, and their errors; infinite for refused designs."""
    references, errors = np.full(wanted.shape, np.nan), np.full(wanted.shape, np.nan)
    for k, (number, size) in enumerate(zip(numbers, sizes, strict=True)):
        if not wanted[:, k].any():
            continue
        try:
            references[:, k], errors[:, k] = _reference(rows, number, float(size))
        except InputError:
            errors[:, k] = np.inf  # dimensions of ground agree to first order only
    return references, errors


def _reference(rows: _Rows, number: VariedNumber, size: float) -> tuple[Array, Array]:
    """The derivative by differences, and how far the two rules that agree best lie apart."""
    at, step = float(number.of(rows.model.description)), _STEP * size
    slopes: dict[int, Array] = {}
    for node in _NODES:
        up, down = at + node * step, at - node * step
        slopes[node] = (rows.varied(number, up) - rows.varied(number, down)) / (up - down)
    small, middle, wide = (_extrapolated(slopes, rule) for rule in _RULES)
    return middle, np.fmin(np.abs(small - middle), np.abs(wide - middle))


def _extrapolated(slopes: Mapping[int, Array], rule: tuple[int, ...]) -> Array:
    """Central differences at several steps as a polynomial of their squares, at 0."""
    total: Array = np.zeros(())
    for a in rule:
        weight = np.prod([b * b / (b * b - a * a) for b in rule if b != a])
        total = total + weight * slopes[a]
    return total


def _size(model: Model, number: VariedNumber) -> float:
    """How far a number can change before the mechanism is another one."""
    kinds = {x.name: x.kind for x in model.equations.variables}
    unit = number.unit(model.description, kinds)
    if number.table == "dimensions":
        return abs(float(number.of(model.description))) or 1.0
    if unit == model.description.angle.value:
        return 1.0 / model.units.scale(Kind.ANGLE)
    return model.equations.length_scale


def _scale(rows: _Rows, here: Array, own: Array, references: Array, sizes: Array) -> Array:
    """The largest change of each quantity by any number, or itself, per size of each number."""
    changes = np.fmax(np.abs(own), np.where(np.isfinite(own), np.abs(references), 0.0))
    changes = changes * sizes[:, None]
    largest = np.nanmax(changes, axis=1, initial=0.0)
    whole = np.fmax(np.fmax(largest, np.abs(here)), _floor(rows, here)[:, None])
    return np.asarray(whole[:, None] / sizes[:, None])


def _floor(rows: _Rows, here: Array) -> Array:
    """The size of a quantity that vanishes: that of a link, a radian, the largest of its kind."""
    model, found = rows.model, np.zeros(len(here))
    asked = [model.quantities.find(name) for name in rows.wanted]
    size = model.equations.length_scale
    plain = {Kind.LENGTH: size, Kind.PER_LENGTH: 1.0 / size, Kind.NUMBER: 1.0}
    for k, one in enumerate(asked):
        same: BoolArray = np.array([other.unit == one.unit for other in asked])
        rate = abs(model.speed or 1.0) ** one.rate.order if one.rate else 1.0
        unit = 1.0 if one.rate else 1.0 / model.units.scale(one.own.kind)
        alike = np.nanmax(np.abs(here[same]), initial=0.0)
        found[k] = plain.get(one.own.kind, unit) * rate if one.own.kind in (
            *plain, Kind.ANGLE) else alike  # fmt: skip
    return found
