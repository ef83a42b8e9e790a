"""Columns of tables of text."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence, Sized
from dataclasses import dataclass
from decimal import ROUND_FLOOR, Context

import numpy as np

from linkwork.core.foundation.arrays import Array, FrozenDict
from linkwork.core.foundation.statuses import Certification, Status
from linkwork.core.results.motion import Motion, is_in_table
from linkwork.core.results.position import Certificate, NewtonStep, NewtonTrail
from linkwork.core.results.quantities.definition import Asked
from linkwork.core.results.quantity import Kind, Units


@dataclass(frozen=True, kw_only=True)
class Column:
    """A column of text; ``align`` is ``left``, ``right`` or ``point`` (the decimal point).

    ``units``, if given, are printed after the cells, one for each cell.
    """

    header: str
    cells: Sequence[str]
    align: str = "left"
    units: Sequence[str] = ()


# ----------------------------------------------------------------------
# Numbers as text: sensible digits, no negative zeros, a dash for what is missing.


_ANGLE_DECIMALS = 6
_LENGTH_DIGITS = 6
#: Printed for a missing number.
NOTHING = "-"


def fixed(value: float, decimals: int = _ANGLE_DECIMALS) -> str:
    """A number with the given decimals, without a negative zero."""
    if not math.isfinite(value):
        return NOTHING
    text = f"{value:.{decimals}f}"
    # rounding -0.0000001 gives "-0.000000"
    return text.lstrip("-") if float(text) == 0 else text


def lengths(values: Iterable[float]) -> list[str]:
    """Lengths with common decimals; the largest has six significant digits."""
    numbers = list(values)
    largest = max((abs(v) for v in numbers if math.isfinite(v)), default=0.0)
    # fixed decimals would show only zeros, or meaningless digits
    if largest and not 1e-6 <= largest < 1e9:
        return [significant(v, _LENGTH_DIGITS) for v in numbers]
    decimals = max(_LENGTH_DIGITS - 1 - _exponent(largest), 0)
    return [fixed(v, decimals) for v in numbers]


def significant(value: float, digits: int = 6, noise: float = 0.0) -> str:
    """A number with the given significant digits; 0 if it is at most ``noise``."""
    if not math.isfinite(value):
        return NOTHING
    if abs(value) <= noise:
        return "0"
    exponent = _exponent(value)
    if -4 <= exponent < max(digits, 7):
        return f"{value:.{max(digits - 1 - exponent, 0)}f}"
    return f"{value:.{digits - 1}e}"


def short(value: float, digits: int = 10) -> str:
    """A number with at most the given significant digits, without trailing zeros."""
    return f"{value:.{digits}g}" if math.isfinite(value) else NOTHING


def rounded_down(value: float, digits: int) -> float:
    """The largest number of so many significant digits that is not above a lower bound."""
    return float(Context(prec=digits, rounding=ROUND_FLOOR).create_decimal_from_float(value))


def _exponent(value: float) -> int:
    """The decimal exponent after rounding to six digits: 2 for 100 and for 99.99999."""
    return int(f"{value:.{_LENGTH_DIGITS - 1}e}".partition("e")[2])


# ----------------------------------------------------------------------
# Values, evidence and iterations of a position as columns and sentences.


_SYSTEM_DIGITS = 6
_NOISE = 1e-15  # of the largest derivative: rounding of cosines, printed as 0
_NUMBER_DIGITS = 10  # for a number without a unit


@dataclass(frozen=True, kw_only=True)
class Row:
    """One named number of a table and its kind (length, angle, number)."""

    name: str
    kind: Kind
    value: float


def value_cells(rows: Sequence[Row], decimals: int = 6) -> list[str]:
    """Values as text: angles with the given decimals, lengths six digits, numbers ten."""
    sizes = iter(lengths(row.value for row in rows if row.kind is Kind.LENGTH))
    texts = []
    for row in rows:
        match row.kind:
            case Kind.LENGTH:
                texts.append(next(sizes))
            case Kind.ANGLE:
                texts.append(fixed(row.value, decimals))
            case Kind.NUMBER:
                texts.append(significant(row.value, _NUMBER_DIGITS))
            case _:
                texts.append(significant(row.value))
    return texts


def listed_links(redundant: Mapping[str, float]) -> str:
    """``the redundant links a, b``."""
    return f"the redundant link{'s' if len(redundant) > 1 else ''} {', '.join(redundant)}"


def redundant_lines(redundant: Mapping[str, float]) -> Iterator[tuple[str, str]]:
    """How far the length of each redundant link is from its given value."""
    for link, gap in redundant.items():
        size = significant(gap, 2)
        yield "redundant", f"{link}: its length holds to {size} of the longest link, not proved"


def radius_measure(loops: Sized, formulas: Sized) -> str:
    """The measure of radii, printed after the number: of loops, or of plain equations."""
    if len(formulas):
        return " of the size of the guess"
    return " of the longest link" if len(loops) else ""


def certificate_text(certificate: Certificate, measure: str) -> str:
    """The certificate of the position in one line, or why there is none."""
    proved = certificate.certified or (certificate.certification is Certification.SUBSET_CERTIFIED)
    if not proved or certificate.radius is None:
        return f"none: {certificate.certification.value}"
    radius = significant(certificate.radius, 2)
    alone = certificate.unique_within or 0.0
    where = "anywhere" if math.isinf(alone) else f"within {significant(alone, 2)}"
    return f"true position within {radius}{measure}; no other {where}"


def inputs_text(values: Mapping[str, float], units: Mapping[str, str]) -> str:
    """``at θ12 = 60 deg``, or nothing without an input."""
    parts = [f"{name} = {short(value)} {units[name]}".rstrip() for name, value in values.items()]
    return f"at {', '.join(parts)}" if parts else ""


def trail_columns(trail: NewtonTrail, kinds: Mapping[str, Kind], units: Units) -> list[Column]:
    """The iterates of a block: its unknowns, the size of F and of the step."""
    steps = trail.steps
    columns = [Column(header="k", cells=[str(step.k) for step in steps], align="right")]
    for name in steps[0].unknowns:
        kind = kinds[name]
        unit = f" [{units.of(kind)}]" if units.of(kind) else ""
        rows = [Row(name=name, kind=kind, value=step.unknowns[name]) for step in steps]
        columns.append(Column(header=f"{name}{unit}", cells=value_cells(rows), align="point"))
    residuals = [f"{step.residual:.2e}" for step in steps]
    changes = ["" if step.step is None else f"{step.step:.2e}" for step in steps]
    columns.append(Column(header="|F|", cells=residuals, align="right"))
    columns.append(Column(header="step", cells=changes, align="right"))
    return columns


def changes_text(step: NewtonStep, kinds: Mapping[str, Kind], units: Units) -> str:
    """The change Δ of every unknown."""
    return ", ".join(
        f"{name} {significant(change, _SYSTEM_DIGITS)} {units.of(kinds[name])}".rstrip()
        for name, change in step.changes.items()
    )


def system_columns(trail: NewtonTrail, step: NewtonStep) -> list[Column]:
    """F and J of one iterate as columns."""

    largest = max((abs(slope) for row in step.jacobian for slope in row), default=0.0)

    def column(header: str, numbers: Sequence[float], noise: float = 0.0) -> Column:
        cells = [significant(number, _SYSTEM_DIGITS, noise) for number in numbers]
        return Column(header=header, cells=cells, align="point")

    slopes = zip(step.unknowns, zip(*step.jacobian, strict=True), strict=True)
    return [
        Column(header=f"k = {step.k}", cells=trail.rows),
        column("F", step.values),
        *(column(f"∂F/∂{name}", slope, _NOISE * largest) for name, slope in slopes),
    ]


# ----------------------------------------------------------------------
# A motion as columns and sentences: counts of positions, limits, evidence, ranges.


_MOST_RUNS = 4  # ranges of failed rows that are listed
_EQUAL = 1e-9  # relative difference of values that are equal but for rounding
_STILL = 1e-10  # relative range below which a value counts as constant, without located extremes


def how_many(motion: Motion) -> str:
    """``361 positions, 2 more at limits and 269 on further branches``."""
    asked = int(motion.asked.sum())
    home = {branch for branch, a in zip(motion.branch, motion.asked, strict=True) if a}
    away = sum(b not in home for b, a in zip(motion.branch, motion.added, strict=True) if a)
    near = int(motion.added.sum()) - away
    more = [f"{near} more at limits"] if near else []
    more += [f"{away}{'' if near else ' more'} on further branches"] if away else []
    return f"{asked} positions" + (f", {' and '.join(more)}" if more else "")


def range_text(motion: Motion) -> str:
    """``θ12 from 0 to 360 deg by 1``; several inputs one after the other."""
    parts = []
    for name, all_values in motion.inputs.items():
        values = all_values[motion.asked]
        unit = motion.input_units[name]
        text = f"{name} from {short(values[0])} to {short(values[-1])} {unit}".rstrip()
        by = f" by {short((values[-1] - values[0]) / (len(values) - 1))}" if len(values) > 1 else ""
        parts.append(text + by)
    return ", ".join(parts)


def status_fields(motion: Motion) -> Iterator[tuple[str, str]]:
    """The number of rows with each status; for failures, also the input values and the reason."""
    counts = motion.counts
    yield "found", str(counts[Status.CONVERGED])
    for status in Status:
        if status.ok or not counts[status]:
            continue
        rows = f"{counts[status]} at {_runs(motion, status)}"
        if status is Status.NO_START and motion.failure is not None:
            yield status.label, rows
            yield from motion.failure.sentences()
            continue
        reason = motion.message if status is Status.NO_START else status.value
        yield status.label, f"{rows}: {reason}"


def _runs(motion: Motion, status: Status) -> str:
    """The input values of all rows with this status: ``118 to 121, 200 deg``."""
    name, values = _lead(motion)
    here = np.array([s is status for s in motion.status])
    edges = np.flatnonzero(np.diff(here, prepend=False, append=False))
    runs = list(zip(edges[0::2], edges[1::2] - 1, strict=True))
    shown = [
        short(values[a]) if a == b else f"{short(values[a])} to {short(values[b])}"
        for a, b in runs[:_MOST_RUNS]
    ]
    more = f" and {len(runs) - _MOST_RUNS} more ranges" if len(runs) > _MOST_RUNS else ""
    return f"{', '.join(shown)} {motion.input_units[name]}".rstrip() + more


def limit_fields(motion: Motion) -> Iterator[tuple[str, str]]:
    """Dead points and other ends of the branch, one to a line."""
    name, _ = _lead(motion)
    unit = motion.input_units[name]
    # two ends of a branch may coincide
    told: dict[tuple[str, str], None] = {}
    for limit in motion.limits:
        place = "" if is_in_table(limit, motion) else ", outside the table"
        told[limit.kind.word, limit.told(name, unit) + place] = None
    yield from told
    for extreme in motion.output_limits:
        value = f"{extreme.value:.10g} {motion.quantity(extreme.name).unit}".rstrip()
        text = f"{extreme.name} = {value} at {name} = {extreme.input:.12g} {unit}".rstrip()
        yield extreme.kind, text
    if motion.circuit is not None:
        yield "circuit", motion.circuit.value


def evidence_fields(motion: Motion, measure: str) -> Iterator[tuple[str, str]]:
    yield from _certified(motion)
    yield "worst residual", _worst(motion, motion.residual, measure)
    regular = np.where(np.isfinite(motion.condition), motion.condition, np.nan)
    if not np.isnan(regular).all():  # at dead points it is infinite
        yield "worst condition", _worst(motion, regular, "")


def _certified(motion: Motion) -> Iterator[tuple[str, str]]:
    """How many rows are proved, and why the others are not."""
    found = int(motion.found.sum())
    proved = int(motion.certified.sum())
    why = Counter(
        c.value
        for c, here in zip(motion.certification, motion.found, strict=True)
        if here and c not in (Certification.CERTIFIED, Certification.SUBSET_CERTIFIED)
    )
    partly = motion.certification.count(Certification.SUBSET_CERTIFIED)
    if partly:
        yield "certified", f"{partly}, without {listed_links(motion.redundant)}"
    elif proved or not why:
        yield "certified", str(proved)
    for reason, count in why.items():
        yield "not certified", f"{count if count < found else 'all'}: {reason}"
    yield from redundant_lines(motion.redundant)


def _worst(motion: Motion, values: Array, measure: str) -> str:
    name, inputs = _lead(motion)
    finite = np.where(np.isfinite(values), values, -np.inf)  # ∞ at limits
    # the first of those that are equal but for rounding
    row = int(np.argmax(finite >= (1.0 - _EQUAL) * finite.max()))
    size = f"{values[row]:.2g}{measure}"
    return f"{size}, at {name} = {short(inputs[row])} {motion.input_units[name]}".rstrip()


@dataclass(frozen=True)
class _Range:
    quantity: Asked
    value: Array


def range_columns(
    motion: Motion,
    columns: Sequence[str] = (),
    decimals: int = 6,
    between: Mapping[str, Array] = FrozenDict(),
) -> list[Column]:
    """Smallest and largest value of every unknown, output and traced point, and where; of all
    moving points where there is none of these.

    ``between``: further values of inputs and columns, in the same order.
    """
    traced = (f"{point}.{axis}" for point in motion.skeleton.traced for axis in "xy")
    usual = [*motion.unknowns, *motion.riding, *motion.outputs, *traced]
    names = columns or usual or coordinates_off_ground(motion)
    none = np.zeros(0)
    found = [
        _Range(motion.quantity(name), np.append(motion[name], between.get(name, none)))
        for name in names
    ]
    if not found:
        return []
    lead, inputs = _lead(motion)
    inputs = np.append(inputs, between.get(lead, none))
    low = [int(np.argmin(_filled(series.value, np.inf))) for series in found]
    high = [int(np.argmax(_filled(series.value, -np.inf))) for series in found]
    numbers = [
        Row(name=s.quantity.name, kind=_kind(s.quantity), value=float(s.value[row]))
        for rows in (low, high)
        for s, row in zip(found, rows, strict=True)
    ]
    cells = value_cells(numbers, decimals)  # both columns together, for the same number of decimals

    def places(rows: list[int]) -> Column:
        moving = [
            s.value[b] - s.value[a] > _STILL * max(1.0, abs(s.value[a]), abs(s.value[b]))
            for s, a, b in zip(found, low, high, strict=True)
        ]
        cells = [short(inputs[r] if m else np.nan) for r, m in zip(rows, moving, strict=True)]
        return Column(header="at", cells=cells, align="point")

    return [
        Column(header="range of rows", cells=[s.quantity.name for s in found]),
        Column(header="minimum", cells=cells[: len(found)], align="point"),
        places(low),
        Column(header="maximum", cells=cells[len(found) :], align="point"),
        places(high),
        Column(header="unit", cells=[s.quantity.unit for s in found]),
    ]


def whole_energy(motion: Motion) -> Array:
    """The kinetic and stored energy of a loaded mechanism, flywheels included, (N,)."""
    found: Array = motion["kinetic_energy"] + motion["stored_energy"]
    return found if motion.flywheel_energy is None else found + motion.flywheel_energy


def coordinates_off_ground(motion: Motion) -> tuple[str, ...]:
    """What there is to show of a motion without unknowns, outputs and traced points."""
    moving = [point for point in motion.points if point not in motion.skeleton.fixed]
    return tuple(f"{point}.{axis}" for point in moving for axis in "xy")


def _kind(asked: Asked) -> Kind:
    return asked.own.kind if asked.rate is None else Kind.NUMBER


def _filled(values: Array, filling: float) -> Array:
    """The values with ``filling`` for those that are missing."""
    return np.where(np.isnan(values), filling, values)


def _lead(motion: Motion) -> tuple[str, Array]:
    """The first input, whose values name the rows."""
    return next(iter(motion.inputs.items()))
