"""Tolerances of a quantity: what deviations of dimensions and clearances of pins do to it."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from linkwork.foundation.arrays import AnyArray
from linkwork.foundation.frozen import FrozenDict
from linkwork.foundation.presenting import presenter
from linkwork.results.sensitivity import SensitivityStatus
from linkwork.results.summary import Summary, driven_text
from linkwork.results.table import Table

__all__ = ["Contribution", "Sampled", "Tolerance", "tolerance_summary"]


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
    >>> crank.tolerance("d", at=60, deviations={"B A": 0.05}).contributions[0].name
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


@dataclass(frozen=True, kw_only=True)
class Sampled:
    """A quantity in randomly drawn designs.

    Parameters
    ----------
    designs, found : int
        How many were drawn, and how many have the quantity.
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
    >>> found = crank.tolerance("d", at=60, deviations={"B A": 0.05}, samples=1000)
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
class Tolerance:
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
        Monte Carlo, if asked for.

    Examples
    --------
    >>> import linkwork as lw
    >>> deviations = {"O2 A": 0.02, "B A": 0.05, "d.offset": 0.03}
    >>> found = lw.example("slider-crank").tolerance("d", at=60, deviations=deviations)
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

    def __repr__(self) -> str:
        return str(tolerance_summary(self))

    def _repr_html_(self) -> str:
        """A short table, for notebooks."""
        return presenter(Tolerance._repr_html_)(self)


def tolerance_summary(found: Tolerance) -> Summary:
    """The tolerance and its largest contributions, for terminals."""
    at = f" at {found.where}" if found.where else ""
    head = f"Tolerance of {found.of} of {found.mechanism}{at}"
    if found.status is not SensitivityStatus.FOUND:
        return Summary(head, (("status", found.status.value),))
    unit = found.unit
    rows = [
        ("value", f"{found.value:.10g} {unit}".rstrip()),
        ("worst case", f"± {found.worst_case:.6g} {unit}".rstrip()),
        ("root sum square", f"{found.root_sum_square:.6g} {unit}".rstrip()),
    ]
    if found.sampled is not None:
        drawn = found.sampled
        rows.append(("sampled", f"{drawn.deviation:.6g} {unit}, {drawn.found} designs"))
    rows += [
        (part.name if part.kind == "dimension" else f"pin {part.name}", f"{100 * part.share:.1f} %")
        for part in found.contributions
    ]
    return Summary(head, tuple(rows))
