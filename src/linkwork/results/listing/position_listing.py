"""Values, evidence and iterations of a position as columns and sentences."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence, Sized
from dataclasses import dataclass

from linkwork.foundation.certification import Certification
from linkwork.results.listing.column import Column
from linkwork.results.listing.number_text import fixed, lengths, short, significant
from linkwork.results.position import Certificate, NewtonStep, NewtonTrail
from linkwork.results.quantity import Kind, Units

__all__ = [
    "Row",
    "certificate_text",
    "changes_text",
    "inputs_text",
    "listed_links",
    "radius_measure",
    "redundant_lines",
    "system_columns",
    "trail_columns",
    "value_cells",
]

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
