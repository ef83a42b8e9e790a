"""Results: sensitivities and tolerances."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from linkwork.core.foundation.arrays import AnyArray, Array, FrozenDict, read_only
from linkwork.core.foundation.errors import UnknownNameError, choices
from linkwork.core.foundation.names import find_spelling
from linkwork.core.foundation.statuses import CodedEnum
from linkwork.core.results.listing import Column, fixed, short, significant
from linkwork.core.results.tables import Summary, Table, driven_text
from linkwork.design.results import Summarized

# ----------------------------------------------------------------------
# Sensitivities: how much a quantity changes with each number of a mechanism.


_ROUNDING = 1e-12  # of the largest derivative


class SensitivityStatus(CodedEnum):
    """How a sensitivity ended in a row; the value is a sentence with a next step.

    Examples
    --------
    >>> import linkwork as lw
    >>> lw.design.sensitivity(lw.example("slider-crank"), "d", at=60).status.name
    'FOUND'
    """

    FOUND = "all sensitivities found"
    CORNER = (
        "the quantity has a corner or no finite value there, so that some of its derivatives do "
        "not exist: ask for another input value, or sample its tolerance"
    )
    DEAD_POINT = (
        "at a dead point or change point positions have no finite sensitivity at a fixed input: "
        "ask for another input value, or for limit.lower or limit.upper"
    )
    NO_POSITION = "there is no position: see the status of the position"


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Sensitivity(Summarized):
    """The derivatives of a quantity by numbers of a mechanism, at one position, in the R rows of a
    motion, or of a number of the whole motion.

    ``found["B A"]`` is ∂quantity/∂number in file units, a number or (R,); NaN where there is none.

    Parameters
    ----------
    mechanism, of : str
        The names of the mechanism and of the quantity.
    unit : str
        The unit of the quantity.
    inputs : Mapping[str, array]
        The values of the inputs in file units; empty for a number of a whole motion.
    value : array
        The quantity itself.
    derivatives : Mapping[str, array]
        By number.
    units : Mapping[str, str]
        The unit of every number; "" where it is not known.
    numbers : Mapping[str, float]
        The values of the numbers, in file units.
    statuses : tuple of SensitivityStatus
        One for each row.
    refused : Mapping[str, str]
        Numbers that cannot vary alone, with the reason.

    Examples
    --------
    >>> import linkwork as lw
    >>> found = lw.design.sensitivity(lw.example("slider-crank"), "d", at=60, by=["O2 A", "B A"])
    >>> round(found["O2 A"], 6), round(found["B A"], 6)
    (0.057082, 1.123196)
    """

    mechanism: str
    of: str
    unit: str
    inputs: Mapping[str, Array]
    input_units: Mapping[str, str]
    value: Array
    derivatives: Mapping[str, Array]
    units: Mapping[str, str]
    numbers: Mapping[str, float]
    statuses: tuple[SensitivityStatus, ...]
    refused: Mapping[str, str] = FrozenDict()

    def __post_init__(self) -> None:
        for name in ("inputs", "derivatives"):
            table = {key: read_only(array) for key, array in getattr(self, name).items()}
            object.__setattr__(self, name, FrozenDict(table))

    def __len__(self) -> int:
        return len(self.statuses)

    def __getitem__(self, name: str) -> Array | float:
        """The derivative by a number: a number itself, or (R,).

        Raises
        ------
        UnknownNameError
            Lists the numbers.
        """
        spelled = find_spelling(name, self.derivatives)
        if spelled not in self.derivatives:
            raise UnknownNameError(
                f'there is no derivative by "{name}" {choices("numbers", self.derivatives, name)}'
            )
        value = self.derivatives[spelled]
        return float(value) if value.ndim == 0 else value

    @property
    def status(self) -> SensitivityStatus:
        """That of the only row, or the first one that is not ``FOUND``."""
        wrong = [status for status in self.statuses if status is not SensitivityStatus.FOUND]
        return wrong[0] if wrong else SensitivityStatus.FOUND

    @property
    def effective(self) -> tuple[str, ...]:
        """The numbers that change the quantity, the largest derivative first."""
        sizes = {name: _size(rows) for name, rows in self.derivatives.items()}
        # in sums of terms that cancel only rounding is left
        least = _ROUNDING * max((s for s in sizes.values() if np.isfinite(s)), default=0.0)
        return tuple(sorted((n for n in sizes if sizes[n] > least), key=lambda n: -sizes[n]))

    def unit_by(self, name: str) -> str:
        """The unit of the derivative by a number."""
        return per(self.unit, self.units[name])

    def table(self) -> Table:
        """Columns of all rows with units: the inputs, the quantity, the derivatives by number."""
        columns: dict[str, AnyArray] = {n: np.atleast_1d(v) for n, v in self.inputs.items()}
        units = dict(self.input_units)
        columns[self.of] = np.atleast_1d(self.value)
        units[self.of] = self.unit
        for name, rows in self.derivatives.items():
            columns[f"by {name}"], units[f"by {name}"] = np.atleast_1d(rows), self.unit_by(name)
        columns["status"] = np.array([status.name for status in self.statuses])
        units["status"] = ""
        return Table(columns=columns, units=units, index=next(iter(columns)))

    @property
    def summary(self) -> Summary:
        """The derivatives, the largest first."""
        rows = []
        if self.status is not SensitivityStatus.FOUND:
            rows.append(("status", self.status.value))
        # without a position there is nothing but the reason
        names = self.effective if np.isfinite(self.value).any() else ()
        for name in names:
            value, unit = self.derivatives[name], self.unit_by(name)
            most = value.item() if value.ndim == 0 else _size(value)
            many = "" if value.ndim == 0 else "at most "
            rows.append((name, f"{many}{most:.6g} {unit}".rstrip()))
        at = f" at {self.where}" if self.where else ""
        return Summary(f"Sensitivity of {self.of} of {self.mechanism}{at}", tuple(rows))

    @property
    def where(self) -> str:
        """The inputs of a single position as text, else ""."""
        if not self.inputs or self.value.ndim:
            return ""
        at = {name: float(value) for name, value in self.inputs.items()}
        return driven_text(at, self.input_units)


def _size(rows: Array) -> float:
    """The largest size in any row; infinite where there is no number."""
    sizes = np.abs(np.atleast_1d(rows))
    if not np.isfinite(sizes).any():
        return np.inf
    return float(np.nanmax(sizes))


def per(unit: str, other: str) -> str:
    """The unit of a quotient, such as ``mm/deg``; "" for a plain number."""
    if unit == other:
        return ""
    if not other:
        return unit
    return f"{unit or '1'}/{other}"


# ----------------------------------------------------------------------
# Tolerances of a quantity: how deviations of dimensions and clearances of pins affect it.


@dataclass(frozen=True, kw_only=True)
class Contribution:
    """What one dimension, or the clearance of one pin, does to a quantity.

    Parameters
    ----------
    name : str
        The number, or the pin's point.
    kind : str
        ``dimension`` or ``clearance``.
    sensitivity : float
        ∂quantity/∂number; of a pin the force in it for a unit load at the quantity, which is the
        largest derivative by a displacement of its centre.
    deviation : float
        The standard deviation of the number, or the clearance of the pin.
    worst : float
        The largest change of the quantity for one deviation, or for the pin anywhere in its hole.
    standard : float
        The standard deviation that it gives the quantity.
    share : float
        Of the variance of the quantity, 0 to 1.

    Examples
    --------
    >>> import linkwork as lw
    >>> crank = lw.example("slider-crank")
    >>> lw.design.tolerance(crank, "d", at=60, deviations={"B A": 0.05}).contributions[0].name
    'B A'
    """

    name: str
    kind: str
    sensitivity: float
    unit: str
    deviation: float
    deviation_unit: str
    worst: float
    standard: float
    share: float

    @property
    def number(self) -> str:
        """The number or pin in words."""
        return self.name if self.kind == "dimension" else f"pin {self.name}"


@dataclass(frozen=True, kw_only=True)
class Sampled:
    """A quantity in randomly drawn designs.

    Parameters
    ----------
    designs, found : int
        The number of drawn designs, and of designs that have the quantity.
    seed : int
    mean, deviation : float
        Of the quantity.
    error : float
        The standard error of the deviation.
    low, high : float
        The smallest and the largest value.

    Examples
    --------
    >>> import linkwork as lw
    >>> crank = lw.example("slider-crank")
    >>> found = lw.design.tolerance(crank, "d", at=60, deviations={"B A": 0.05}, samples=1000)
    >>> found.sampled.found
    1000
    """

    designs: int
    found: int
    seed: int
    mean: float
    deviation: float
    error: float
    low: float
    high: float


@dataclass(frozen=True, kw_only=True, repr=False)
class Tolerance(Summarized):
    """The tolerance of a quantity at one position, or of a number of a whole motion.

    Parameters
    ----------
    mechanism, of : str
        The names of the mechanism and of the quantity.
    unit : str
        The unit of the quantity.
    inputs : Mapping[str, float]
        The values of the inputs in file units; empty for a number of a whole motion.
    value : float
        The quantity itself.
    contributions : tuple of Contribution
        The largest share first.
    worst_case : float
        ``Σ |∂q/∂p| deviation + Σ clearance · force``, the largest change to first order if every
        number is off by its deviation and every pin lies at the edge of its hole.
    root_sum_square : float
        The standard deviation to first order, for independent numbers and pins that lie at the
        edge of their holes in any direction.
    status : SensitivityStatus
    sampled : Sampled, optional
        Monte Carlo, if requested.

    Examples
    --------
    >>> import linkwork as lw
    >>> deviations = {"O2 A": 0.02, "B A": 0.05, "d.offset": 0.03}
    >>> found = lw.design.tolerance(lw.example("slider-crank"), "d", at=60, deviations=deviations)
    >>> round(found.root_sum_square, 6), round(found.contributions[0].share, 3)
    (0.058229, 0.93)
    """

    mechanism: str
    of: str
    unit: str
    inputs: Mapping[str, float]
    input_units: Mapping[str, str]
    value: float
    contributions: tuple[Contribution, ...]
    status: SensitivityStatus
    sampled: Sampled | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "inputs", FrozenDict(self.inputs))

    @property
    def worst_case(self) -> float:
        """The sum of the largest changes."""
        return math.fsum(part.worst for part in self.contributions)

    @property
    def root_sum_square(self) -> float:
        """The standard deviation to first order."""
        return math.hypot(*(part.standard for part in self.contributions))

    @property
    def where(self) -> str:
        """The inputs as text; "" for a number of a whole motion."""
        return driven_text(self.inputs, self.input_units) if self.inputs else ""

    def table(self) -> Table:
        """The contributions as a table, the largest share first."""
        parts = self.contributions
        numbers = ("sensitivity", "deviation", "worst", "standard", "share")
        columns: dict[str, AnyArray] = {
            "name": np.array([part.name for part in parts]),
            "kind": np.array([part.kind for part in parts]),
        }
        columns |= {name: np.array([getattr(part, name) for part in parts]) for name in numbers}
        units = dict.fromkeys(columns, "") | {"worst": self.unit, "standard": self.unit}
        return Table(columns=columns, units=units, index="name")

    @property
    def summary(self) -> Summary:
        """The tolerance and its largest contributions."""
        at = f" at {self.where}" if self.where else ""
        rows = [*tolerance_fields(self)]
        if self.status is SensitivityStatus.FOUND:
            rows += [(part.number, f"{100 * part.share:.1f} %") for part in self.contributions]
        return Summary(f"Tolerance of {self.of} of {self.mechanism}{at}", tuple(rows))


def tolerance_fields(tolerance: Tolerance) -> Iterator[tuple[str, str]]:
    """Value, worst case and standard deviation, or why there are none; then random designs."""
    unit = tolerance.unit
    if tolerance.status is SensitivityStatus.FOUND:
        yield "value", f"{short(tolerance.value)} {unit}".rstrip()
        yield "worst case", f"± {significant(tolerance.worst_case)} {unit}".rstrip()
        yield "root sum square", f"{significant(tolerance.root_sum_square)} {unit}".rstrip()
    else:
        yield "why", tolerance.status.value
    if (drawn := tolerance.sampled) is not None:
        yield (
            "sampled",
            f"deviation {significant(drawn.deviation)} ± {significant(drawn.error, 2)} {unit}, "
            f"mean {short(drawn.mean)} {unit}, from {short(drawn.low)} to {short(drawn.high)} "
            f"{unit}; {drawn.found} of {drawn.designs} found, seed {drawn.seed}",
        )


def contribution_columns(tolerance: Tolerance) -> list[Column]:
    """The share of each number and pin."""
    parts = tolerance.contributions

    def column(header: str, cells: list[str], units: list[str] | None = None) -> Column:
        return Column(header=header, cells=cells, align="point", units=units or ())

    deviations = [short(part.deviation) for part in parts]
    sensitivities = [significant(part.sensitivity) for part in parts]
    return [
        Column(header="number", cells=[part.number for part in parts]),
        column("deviation", deviations, [part.deviation_unit for part in parts]),
        column("sensitivity", sensitivities, [part.unit for part in parts]),
        column("change", [significant(p.worst) for p in parts], [tolerance.unit] * len(parts)),
        column("share %", [fixed(100.0 * part.share, 1) for part in parts]),
    ]
