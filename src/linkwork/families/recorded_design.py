"""A number that records its arithmetic as a program while the equations are built from it.

The builder of a mechanism's equations computes with floats and complex numbers. A recorded number
passes through it as :class:`~linkwork.core.foundation.lanes.Lanes` of one design do. Every decision
is taken by its value and recorded as a condition: where all conditions hold, the program gives the
coefficients of the design with other numbers.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, cast

import numpy as np

from linkwork.core.expression.values import least, most
from linkwork.core.foundation.arrays import UNIT_ROUNDOFF, AnyArray, Array, BoolArray
from linkwork.core.foundation.errors import InputError, LinkworkError
from linkwork.core.foundation.lanes import (
    Consensus,
    Lanes,
    NotElementwise,
    Truths,
    remainders,
    with_parts,
)
from linkwork.core.mechanism.description import Description
from linkwork.core.mechanism.varied_numbers import VariedNumber, number_named, with_numbers
from linkwork.core.motion.model import Model, model_of
from linkwork.core.motion.sweeping import sweep
from linkwork.core.record.recorder import Recorder, Value
from linkwork.core.results.motion import Motion
from linkwork.families.building import (
    Coefficients,
    Pattern,
    family_base,
    write_equations,
)
from linkwork.families.design_sweep import TablePath

Part = Value | float
Parts = tuple[Part, Part]

_POWERS = range(-4, 5)
_ROUNDING = 1.5 * 2.0**52  # added and taken away again, it leaves the nearest whole number


class Recording(Consensus):
    """What the recorded numbers of one mechanism have in common.

    Attributes
    ----------
    recorder : Recorder
    conditions : list of Value
        Masks of the decisions; all hold where the program serves.
    """

    def __init__(self) -> None:
        super().__init__(1, widest=True)
        self.recorder = Recorder()
        self.conditions: list[Value] = []

    def number(self, name: str, value: float) -> float:
        """A real number that the program reads from a named register."""
        return cast(float, self.make([value], self.recorder.input(name)))

    def make(self, values: Any, re: Part, im: Part = 0.0) -> RecordedNumber:
        """A number, values (1,), with its recorded parts."""
        return RecordedNumber(np.asarray(values), self, self.plainly(re), self.plainly(im))

    def plainly(self, part: Part) -> Part:
        """A recorded constant as a float."""
        known = self.recorder.known_value(part)
        return part if known is None else known

    def plain(self, number: complex) -> RecordedNumber:
        """A plain number."""
        z = complex(number)
        return self.make([number], z.real, z.imag)

    def pick(self, truths: Truths, yes: complex, no: complex) -> float:
        """One of two plain numbers."""
        return cast(float, self._choose(truths, yes, no))

    def settle(self, number: RecordedNumber) -> Any:
        """A number that all designs must share."""
        if isinstance(number.re, Value) or isinstance(number.im, Value):
            raise NotElementwise
        return super().settle(number)

    def decide(self, truths: Any) -> bool:
        """The answer; that it stays the same becomes a condition."""
        answer = bool(truths.values[0] if isinstance(truths, Truths) else truths[0])
        if isinstance(truths, _RecordedTruths) and isinstance(truths.mask, Value):
            rec = self.recorder
            self.conditions.append(truths.mask if answer else rec.subtract(1.0, truths.mask))
        return answer

    def apply(self, function: Callable[..., Any], *numbers: object) -> RecordedNumber:
        """A function that can be recorded."""
        if function is np.where:
            return self._choose(*numbers)
        if function not in _FUNCTIONS:
            raise NotElementwise
        given = [self.operand(number) for number in numbers]
        values = function(*(number.values for number in given))
        if not any(isinstance(part, Value) for number in given for part in (number.re, number.im)):
            return self.plain(values[0].item())
        return self.make(values, *_FUNCTIONS[function](self.recorder, *given))

    def _choose(self, condition: object, yes: object, no: object) -> RecordedNumber:
        x: RecordedNumber = self.operand(yes)
        y: RecordedNumber = self.operand(no)
        if not isinstance(condition, _RecordedTruths) or not isinstance(condition.mask, Value):
            return x if cast(Truths, condition) else y
        values = np.where(condition.values, x.values, y.values)
        rec, mask = self.recorder, condition.mask
        return self.make(values, rec.where(mask, x.re, y.re), rec.where(mask, x.im, y.im))

    def add(self, x: RecordedNumber, y: RecordedNumber) -> RecordedNumber:
        """x + y."""
        rec = self.recorder
        return self.make(x.values + y.values, rec.add(x.re, y.re), rec.add(x.im, y.im))

    def negate(self, x: RecordedNumber) -> RecordedNumber:
        """-x."""
        return self.make(-x.values, self.recorder.negate(x.re), self.recorder.negate(x.im))

    def multiply(self, x: RecordedNumber, y: RecordedNumber) -> RecordedNumber:
        """x y."""
        rec = self.recorder
        re = rec.subtract(rec.multiply(x.re, y.re), rec.multiply(x.im, y.im))
        im = rec.add(rec.multiply(x.re, y.im), rec.multiply(x.im, y.re))
        return self.make(x.values * y.values, re, im)

    def divide(self, x: RecordedNumber, y: RecordedNumber) -> RecordedNumber:
        """x / y."""
        if y.im != 0.0:
            return x * y.conjugate() / (y * y.conjugate()).real
        rec = self.recorder
        return self.make(x.values / y.values, rec.divide(x.re, y.re), rec.divide(x.im, y.re))

    def power(self, x: RecordedNumber, y: RecordedNumber) -> RecordedNumber:
        """x to the power of 1/2 or a small whole number."""
        if y.re == 0.5:
            return self.apply(np.sqrt, x)
        if isinstance(y.re, Value) or y.im != 0.0 or y.re not in _POWERS:
            raise NotElementwise
        if y.re < 0.0:
            return self.plain(1.0) / x**-y.re
        product = self.plain(1.0)
        for _ in range(int(y.re)):
            product = product * x
        return product

    def absolute(self, x: RecordedNumber) -> RecordedNumber:
        """|x|."""
        return self.apply(np.abs, x)


class _RecordedTruths(Truths):
    """A condition with its mask."""

    __slots__ = ("mask",)
    consensus: Recording

    def __init__(self, values: BoolArray, recording: Recording, mask: Part) -> None:
        super().__init__(values, recording)
        self.mask = mask

    def __bool__(self) -> bool:
        return self.consensus.decide(self)

    def __and__(self, other: object) -> Truths:
        values, mask = self._other(other)
        both = self.consensus.recorder.multiply(self.mask, mask)
        return _RecordedTruths(self.values & values, self.consensus, both)

    def __or__(self, other: object) -> Truths:
        values, mask = self._other(other)
        either = self.consensus.recorder.largest([self.mask, mask])
        return _RecordedTruths(self.values | values, self.consensus, either)

    def _other(self, other: object) -> tuple[BoolArray, Part]:
        if isinstance(other, _RecordedTruths):
            return other.values, other.mask
        if isinstance(other, Truths):
            raise NotElementwise
        return np.array([bool(other)]), float(bool(other))

    def __eq__(self, other: object) -> Any:
        raise NotElementwise

    def __ne__(self, other: object) -> Any:
        raise NotElementwise

    __hash__ = None
    __rand__ = __and__
    __ror__ = __or__


class RecordedNumber(Lanes):
    """A number with the recorded parts ``re`` and ``im``."""

    __slots__ = ("im", "re")
    arithmetic: Recording

    def __init__(self, values: AnyArray, recording: Recording, re: Part, im: Part) -> None:
        super().__init__(values, recording)
        self.re, self.im = re, im

    def _at_most(self, other: object, turned: bool, strict: bool) -> Truths:
        """self <= other; ``turned``: other <= self; ``strict``: not that."""
        rec, x, y = self.arithmetic.recorder, self, self.arithmetic.operand(other)
        if turned:
            x, y = y, x
        values, mask = x.values <= y.values, rec.at_most(x.re, y.re)
        if strict:
            values, mask = ~values, rec.subtract(1.0, mask)
        return _RecordedTruths(values, self.arithmetic, mask)

    def __lt__(self, other: object) -> Truths:
        return self._at_most(other, True, True)

    def __le__(self, other: object) -> Truths:
        return self._at_most(other, False, False)

    def __gt__(self, other: object) -> Truths:
        return self._at_most(other, False, True)

    def __ge__(self, other: object) -> Truths:
        return self._at_most(other, True, False)

    def __eq__(self, other: object) -> Any:
        rec, y = self.arithmetic.recorder, self.arithmetic.operand(other)
        far = [rec.absolute(rec.subtract(a, b)) for a, b in ((self.re, y.re), (self.im, y.im))]
        mask = rec.at_most(rec.largest(far), 0.0)
        return _RecordedTruths(self.values == y.values, self.arithmetic, mask)

    def __ne__(self, other: object) -> Any:
        equal = self == other
        mask = self.arithmetic.recorder.subtract(1.0, equal.mask)
        return _RecordedTruths(~equal.values, self.arithmetic, mask)

    def __bool__(self) -> bool:
        return bool(self != 0.0)

    __hash__ = Lanes._refuse  # comparing numbers would otherwise remove it


def parts_of(z: object) -> Parts:
    """The recorded real and imaginary part of a coefficient."""
    if isinstance(z, RecordedNumber):
        return z.re, z.im
    assert isinstance(z, int | float | complex)
    plain = complex(z)
    return plain.real, plain.imag


# Functions: from the recorder and the arguments, the parts


def _real(x: RecordedNumber) -> Part:
    if x.im != 0.0:
        raise NotElementwise
    return x.re


def _size(rec: Recorder, x: Part, y: Part) -> Part:
    if not isinstance(y, Value) and y == 0.0:
        return rec.absolute(x)
    if not isinstance(x, Value) and x == 0.0:
        return rec.absolute(y)
    return rec.sqrt(rec.add(rec.multiply(x, x), rec.multiply(y, y)))


def _root(rec: Recorder, x: RecordedNumber) -> Parts:
    part = _real(x)
    assert isinstance(part, Value)
    return rec.sqrt(part), 0.0


def _turned(rec: Recorder, x: RecordedNumber, which: int) -> Parts:
    angle = _real(x)
    assert isinstance(angle, Value)
    return rec.sin_cos(angle)[which], 0.0


def _rounded(rec: Recorder, x: Part) -> Value:
    return rec.subtract(rec.add(x, _ROUNDING), _ROUNDING)


def _remainder(rec: Recorder, x: RecordedNumber, period: RecordedNumber) -> Parts:
    turns = _rounded(rec, rec.divide(_real(x), _real(period)))
    return rec.subtract(_real(x), rec.multiply(turns, _real(period))), 0.0


def _signed(rec: Recorder, x: RecordedNumber, sign: RecordedNumber) -> Parts:
    size = rec.absolute(_real(x))
    return rec.where(rec.at_most(0.0, _real(sign)), size, rec.negate(size)), 0.0


def _inverse(rec: Recorder, x: RecordedNumber, cosine: bool) -> Parts:
    part = _real(x)
    other = rec.sqrt(rec.constant(1.0) - rec.multiply(part, part))
    return (rec.direction(other, part) if cosine else rec.direction(part, other)), 0.0


def _sign(rec: Recorder, x: RecordedNumber) -> Parts:
    part = _real(x)
    below, above = rec.at_most(part, 0.0), rec.at_most(0.0, part)
    return rec.subtract(above, below), 0.0


def _called(method: Callable[[Recorder, list[Part]], Value]) -> Callable[..., Parts]:
    return lambda rec, *numbers: (method(rec, [_real(x) for x in numbers]), 0.0)


_FUNCTIONS: dict[Callable[..., Any], Callable[..., Parts]] = {
    np.angle: lambda rec, z: (rec.direction(z.im, z.re), 0.0),
    np.cos: lambda rec, x: _turned(rec, x, 1),
    np.sin: lambda rec, x: _turned(rec, x, 0),
    with_parts: lambda rec, x, y: (_real(x), _real(y)),
    np.sqrt: _root,
    np.copysign: _signed,
    np.rint: lambda rec, x: (_rounded(rec, _real(x)), 0.0),
    remainders: _remainder,
    np.abs: lambda rec, x: (_size(rec, x.re, x.im), 0.0),
    np.fabs: lambda rec, x: (_size(rec, _real(x), 0.0), 0.0),
    np.hypot: lambda rec, x, y: (_size(rec, _real(x), _real(y)), 0.0),
    np.round: lambda rec, x: (_rounded(rec, _real(x)), 0.0),
    np.sign: _sign,
    np.arccos: lambda rec, x: _inverse(rec, x, True),
    np.arcsin: lambda rec, x: _inverse(rec, x, False),
    np.arctan: lambda rec, x: (rec.direction(_real(x), 1.0), 0.0),
    np.arctan2: lambda rec, y, x: (rec.direction(_real(y), _real(x)), 0.0),
    np.conjugate: lambda rec, x: (x.re, rec.negate(x.im)),
    np.real: lambda rec, x: (x.re, 0.0),
    np.imag: lambda rec, x: (x.im, 0.0),
    np.fmax: _called(Recorder.largest),
    np.fmin: _called(Recorder.smallest),
    most: _called(Recorder.largest),
    least: _called(Recorder.smallest),
}


# ----------------------------------------------------------------------
# The coefficients of a mechanism's equations as a program of some of its numbers.


_ON_PATH = 1e-12  # relative: rounding of the sketch and of the table
_PART = 0.03  # of a number: by how much motions are compared


@dataclass(frozen=True, kw_only=True, eq=False)
class RecordedDesign:
    """A mechanism whose coefficients are recorded.

    Parameters
    ----------
    base : Model
        Its structure; see :func:`~linkwork.families.building.family_base`.
    path : TablePath
    quantities : tuple of VariedNumber
        The numbers that vary; the program reads them as ``number0``, ``number1``, …
    recorder : Recorder
        Records ``fits``, 1.0 where the equations keep their form, and the numbers in ``parts``.
    parts : Mapping[str, float or Value]
        Coefficients by register; ``point<term>.re`` and ``.im``, ``link<k>`` of links,
        ``dimension<k>``, ``length``, ``guess<k>`` and ``start``.
    """

    base: Model
    path: TablePath
    quantities: tuple[VariedNumber, ...]
    recorder: Recorder
    parts: Mapping[str, Part]

    @property
    def rates(self) -> Array:
        """The rate of every input by the leading one."""
        return self.path.rate

    @property
    def fixed(self) -> dict[str, float]:
        """Coefficients that do not vary."""
        return {name: part for name, part in self.parts.items() if not isinstance(part, Value)}

    def changed(self) -> list[Motion | None]:
        """A sweep with another value of each number that varies; ``None`` where none is found."""
        return [_changed(self.base, quantity) for quantity in self.quantities]


def record_design(model: Model, names: Sequence[str]) -> RecordedDesign:
    """Record how the coefficients of a mechanism follow from some of its numbers.

    Parameters
    ----------
    model : Model
    names : sequence of str
        As in :func:`linkwork.families.designs_of`.

    Raises
    ------
    UnknownNameError
        If a name is not a number of the mechanism.
    InputError
        If a number is named twice, kernels do not serve the mechanism, or the equations cannot
        follow a number without being built again.
    """
    description = model.description
    quantities = tuple(number_named(description, name) for name in names)
    for k, quantity in enumerate(quantities):
        if quantity in quantities[:k]:
            raise InputError(f'"{names[k]}" is named twice: give each number once')
    path = TablePath.of(model)
    if path is None:
        raise InputError(f"{description.name} {_why_unserved(model)}: a page cannot solve it")
    base, together = family_base(model, quantities)
    if not together:
        raise InputError(
            f"the equations of {description.name} are chosen by its numbers (released links, or "
            "speeds of several inputs): a page cannot solve it"
        )
    for quantity in quantities:  # which one cannot vary is worth knowing
        _coefficients(base, [quantity])
    recording, found = _coefficients(base, quantities)
    rec, parts = recording.recorder, _named_parts(base, found)
    n = len(base.equations.unknowns)
    start = [parts_of(x)[0] for x in found.start]
    if description.configuration:
        start = [float(x) for x in model.equations.start]
    if not _on_path(path, start[n:]):
        start = _first_row(base, path)
    parts |= {f"guess{k}": start[k] for k in range(n)}
    parts["start"] = start[n + path.lead]
    parts |= _inputs(path, rec, parts["start"])
    rec.write("fits", rec.all_of(recording.conditions) if recording.conditions else 1.0)
    for name, part in parts.items():
        if isinstance(part, Value):
            rec.write(name, part)
    return RecordedDesign(base=base, path=path, quantities=quantities, recorder=rec, parts=parts)


def _why_unserved(model: Model) -> str:
    """The reason why a mechanism has no line of inputs that kernels follow."""
    if not model.equations.inputs:
        return "has no input, so nothing moves"
    if model.equations.redundant:
        names = ", ".join(dict.fromkeys(part.link for part in model.equations.redundant))
        return f"has redundant links ({names}), which fit no other lengths than their own"
    return "has cams, curves or formulas among its equations, and the printed solver has loops only"


def _changed(model: Model, quantity: VariedNumber) -> Motion | None:
    value = float(quantity.of(model.description))
    step = _PART * (abs(value) or model.equations.length_scale)
    for other in (value + step, value - step):
        try:
            motion = sweep(model_of(with_numbers(model.description, {quantity: other})))
        except LinkworkError:
            continue
        if motion.found.any():
            return motion
    return None


def _coefficients(
    base: Model, quantities: Sequence[VariedNumber]
) -> tuple[Recording, Coefficients]:
    """The coefficients in the order of the base, with some numbers recorded."""
    recording, description = Recording(), base.description
    numbers = {
        quantity: recording.number(f"number{k}", float(quantity.of(description)))
        for k, quantity in enumerate(quantities)
    }
    found = None
    try:
        with np.errstate(all="ignore"):
            recorded = with_numbers(description, numbers)
            fixed = _has_plain_inputs(recorded)
            found = Pattern.of(base.equations).coefficients(write_equations(recorded))
    except NotElementwise:
        fixed = True
    if not fixed:
        raise InputError(
            f"{_told(quantities)} changes the range or the speed of an input: a page keeps these"
        )
    if found is None:
        raise InputError(
            f"{_told(quantities)} changes the form of the equations, such as a ratio of wheels: "
            "it cannot have a slider; --set gives it another value"
        )
    return recording, found


def _told(quantities: Sequence[VariedNumber]) -> str:
    return " and ".join(f'"{quantity.name}"' for quantity in quantities)


def _has_plain_inputs(description: Description) -> bool:
    """Whether ranges and speeds of inputs do not follow a recorded number."""
    for which in description.inputs:
        ranges = (which.from_, which.to, which.step)
        known = [description.numbers(number) for number in ranges if number is not None]
        if any(isinstance(number, RecordedNumber) for number in known):
            return False
        if isinstance(description.speed(which), RecordedNumber):
            return False
    return True


def _named_parts(base: Model, found: Coefficients) -> dict[str, Part]:
    parts: dict[str, Part] = {}
    for letter, terms in (("c", found.loops), ("point", found.points)):
        for term, z in enumerate(terms):
            parts[f"{letter}{term}.re"], parts[f"{letter}{term}.im"] = parts_of(z)
    several = {"k": found.linear, "link": found.link_angles, "dimension": found.numbers}
    for letter, numbers in several.items():
        parts |= {f"{letter}{row}": parts_of(x)[0] for row, x in enumerate(numbers)}
    parts["length"] = parts_of(found.length_scale[0])[0]
    for k, turns in enumerate(base.compiled.table.is_angle):
        if not turns:
            parts[f"scale{k}"] = parts["length"]
    return parts


def _inputs(path: TablePath, rec: Recorder, start: Part) -> dict[str, Part]:
    """The line of inputs, and how far rows are from it; see :meth:`TablePath.input_radius`."""
    parts: dict[str, Part] = {}
    known = np.array([0.0 if isinstance(start, Value) else start])
    gap = path.input_radius(known)
    for j, (origin, rate) in enumerate(zip(path.origin, path.rate, strict=True)):
        parts[f"u{j}.origin"], parts[f"u{j}.rate"] = float(origin), float(rate)
        parts[f"u{j}.spread"] = float(gap[j])
        if isinstance(start, Value) and origin and rate:
            more = rec.multiply(rec.absolute(start), 4.0 * UNIT_ROUNDOFF * abs(float(rate)))
            parts[f"u{j}.spread"] = rec.add(more, float(gap[j]))
    return parts


def _on_path(path: TablePath, inputs: Sequence[Part]) -> bool:
    """Whether inputs are on the line of the table's, where the march begins."""
    if len(inputs) == 1:
        return True
    own = np.array([x for x in inputs if not isinstance(x, Value)])
    if len(own) < len(inputs):
        return False
    away = float(np.abs(own - (path.origin + path.rate * own[path.lead])).max())
    return away <= _ON_PATH * max(1.0, float(np.abs(path.origin).max()))


def _first_row(model: Model, path: TablePath) -> list[Part]:
    """Unknowns and inputs in the first row of the table that has a position.

    Raises
    ------
    InputError
        If no row has one.
    """
    motion = sweep(model)
    if not motion.found.any():
        raise InputError(
            f"no row of the table of {model.description.name} has a position: a page that solves "
            "starts from one"
        )
    row = int(np.flatnonzero(motion.found)[0])
    lead = float(model.rows[row, path.lead])
    return [*map(float, motion.q[row]), *map(float, path.origin + path.rate * lead)]
