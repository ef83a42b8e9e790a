"""The coefficients of a mechanism's equations as a program of some of its numbers."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from linkwork.batch.building import build_design, family_base, write_equations
from linkwork.batch.design_sweep import TablePath
from linkwork.batch.pattern import Coefficients, Pattern
from linkwork.batch.recorded_number import Part, RecordedNumber, Recording, parts_of
from linkwork.foundation.arrays import Array
from linkwork.foundation.errors import InputError, LinkworkError
from linkwork.foundation.operand import NotElementwise
from linkwork.foundation.rounding import UNIT_ROUNDOFF
from linkwork.kernels.program.recorder import Recorder, Value
from linkwork.mechanism.description import Description
from linkwork.mechanism.varied_number import VariedNumber, number_named, with_numbers
from linkwork.motion import sweep
from linkwork.motion.model import Model
from linkwork.results.motion import Motion

__all__ = ["RecordedDesign", "record_design"]

_ON_PATH = 1e-12  # relative: rounding of the sketch and of the table
_PART = 0.03  # of a number: by how much motions are compared


@dataclass(frozen=True, kw_only=True, eq=False)
class RecordedDesign:
    """A mechanism whose coefficients are recorded.

    Parameters
    ----------
    base : Model
        Its structure; see :func:`~linkwork.batch.building.family_base`.
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
        As in :func:`linkwork.batch.designs_of`.

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
            motion = sweep(build_design(with_numbers(model.description, {quantity: other})))
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
        ranges = (which.start, which.stop, which.step)
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
