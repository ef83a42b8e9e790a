"""Requested quantities: their unit, kind and values."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

import numpy as np

from linkwork.expression.jets import Jet
from linkwork.foundation.angles import FULL_TURN
from linkwork.foundation.arrays import Array
from linkwork.foundation.errors import UnknownNameError
from linkwork.results.quantities.definition import (
    UNKNOWN,
    MechanismNames,
    MotionQuantity,
    MotionRows,
    RowQuantity,
    Solved,
)
from linkwork.results.quantity import Kind, Quantity, Rate

__all__ = ["Asked", "AskedOfMotion", "Group"]


class Group(Enum):
    """Where a quantity comes from."""

    INPUT = "input"
    UNKNOWN = "unknown"
    LINK = "link"
    SLIDER = "slider"
    OUTPUT = "output"
    COORDINATE = "coordinate"
    DERIVED = "derived"
    EVIDENCE = "evidence"
    POINT = "point"


@dataclass(frozen=True, kw_only=True)
class Asked:
    """A quantity of every row, requested by name.

    Parameters
    ----------
    own : Quantity
        Itself; of ``B.velocity`` the point.
    group : Group
    rate : Rate, optional
        Which of its rates is meant.
    row : RowQuantity, optional
        How a derived quantity is evaluated; ``part`` has it.
    """

    names: MechanismNames
    own: Quantity
    group: Group
    rate: Rate | None = None
    row: RowQuantity | None = None
    part: str = ""

    @property
    def name(self) -> str:
        """The name as the mechanism spells it, with the rate."""
        return self.own.name if self.rate is None else f"{self.own.name}.{self.rate.value}"

    @property
    def unit(self) -> str:
        """The unit of its values; "" for none."""
        units = self.names.units
        if self.rate is None:
            return units.of(self.own.kind)
        return self.rate.unit(self.own.kind, units, self.names.by)

    @property
    def measure(self) -> str:
        """The measured dimension as a word; "" for a plain number."""
        if self.own.kind is Kind.NUMBER:
            return ""
        return self.own.kind.value if self.rate is None else self.rate.measure

    @property
    def needs(self) -> int:
        """The number of derivatives of the positions that its values need."""
        own = self.row.needs if self.row else self.names.output_needs.get(self.own.name, 0)
        return own + (self.rate.order if self.rate else 0)

    @property
    def has_series(self) -> bool:
        """Whether it has derivatives of any order."""
        plain = (Group.UNKNOWN, Group.LINK, Group.SLIDER, Group.COORDINATE)
        return self.names.series is not None and self.group in plain

    def derivatives(self, solved: Solved, order: int, speed: Array | float) -> Array:
        """The derivatives with respect to time from the first to an order, (order, B)."""
        assert self.names.series is not None
        found = self.names.series(solved, self, order)
        return np.stack([part * speed**k for k, part in enumerate(found, start=1)])

    def check_rate(self, speed: Array | float | None) -> None:
        """Raise an error for an unknown rate, or for a time derivative without a speed.

        Raises
        ------
        UnknownNameError
            With the name of the derivative with respect to the input.
        """
        if self.rate is None:
            return
        self.rate.check(self.own.name, speed)
        if self.rate.needs_series and self.has_series:
            return
        # checked by name, before anything is computed
        if self.needs > 2:
            raise UnknownNameError(
                f'"{self.name}" is not known: positions have two derivatives, '
                f'and "{self.own.name}" itself takes {self.needs - self.rate.order}'
            )

    def jet(self, solved: Solved) -> Jet:
        """The quantity itself: values in the file's units, derivatives in radians and lengths."""
        if self.row is None:
            return solved.own(self.own.name)
        with np.errstate(all="ignore"):
            jet = self.row.evaluate(self.names, solved, self.part)
        # a quantity may give one NaN for derivatives that it does not know
        rates = (np.broadcast_to(rate, np.shape(jet.v)) for rate in (jet.d1, jet.d2))
        return Jet(jet.v / self.names.units.scale(self.own.kind), *rates)

    def values(self, solved: Solved, speed: Array | float | None) -> Array:
        """The values of the quantity, or of its rate if one was requested."""
        if self.rate is not None and self.rate.needs_series:
            assert speed is not None
            found: Array = self.derivatives(solved, self.rate.order, speed)[-1]
            return found if np.ndim(solved.own(self.own.name).v) else found[0]
        if self.group is Group.POINT:
            assert self.rate is not None
            place = solved.place(self.own.name)
            x = self.rate.of(place.d1.real, place.d2.real, speed)
            size: Array = np.hypot(x, self.rate.of(place.d1.imag, place.d2.imag, speed))
            return size
        jet = self.jet(solved)
        return jet.v if self.rate is None else self.rate.of(jet.d1, jet.d2, speed)


@dataclass(frozen=True, kw_only=True)
class AskedOfMotion:
    """A number of a whole motion, requested by name: ``dwell(s16, 0.5)``."""

    names: MechanismNames
    quantity: MotionQuantity
    of: Asked
    numbers: tuple[float, ...] = ()

    @property
    def unit(self) -> str:
        """The unit of the number; "" for none."""
        match self.quantity.measures:
            case "input":
                return self.names.units.of(self.names.inputs[self.names.lead])
            case "quantity":
                return self.names.units.length if self.quantity.of_point else self.of.unit
            case _:
                return ""

    @property
    def needs(self) -> int:
        """The number of derivatives of the positions that it needs."""
        return self.of.needs + self.quantity.needs

    @property
    def follows(self) -> bool:
        """Whether it needs derivatives or the path of a point, not only values."""
        return self.quantity.of_point or self.quantity.needs > 0

    def columns(
        self, solved: Solved, speed: Array | float | None = None
    ) -> tuple[Array, Array, Array]:
        """The quantity and both derivatives with respect to the leading input, in file units;
        derivatives only where the number :attr:`follows` them.
        """
        if not self.follows:
            return self.of.values(solved, speed), UNKNOWN, UNKNOWN
        if self.quantity.of_point:
            place = solved.place(self.of.name)
            return place.v, place.d1, place.d2
        jet, scale = self.of.jet(solved), self.names.units.scale(self.of.own.kind)
        return jet.v, jet.d1 / scale, jet.d2 / scale

    def evaluate(
        self, leading: Array, value: Array, first: Array = UNKNOWN, second: Array = UNKNOWN
    ) -> Array:
        """The number of every motion, (…,).

        Parameters
        ----------
        leading : (R,)
            The leading input, [rad] or [length].
        value, first, second : (…, R)
            See :meth:`columns`.
        """
        return self.number(self.rows(leading, value, first, second))

    def number(self, rows: MotionRows) -> Array:
        """The number of every motion, (…,)."""
        with np.errstate(all="ignore"):
            return np.asarray(self.quantity.evaluate(rows, self.numbers), dtype=float)

    def rows(
        self, leading: Array, value: Array, first: Array = UNKNOWN, second: Array = UNKNOWN
    ) -> MotionRows:
        """What the number is computed from; parameters as of :meth:`evaluate`."""
        units, kind = self.names.units, self.names.inputs[self.names.lead]
        return MotionRows(
            input=leading,
            value=value,
            first=np.broadcast_to(first, value.shape),
            second=np.broadcast_to(second, value.shape),
            unit=units.scale(kind),
            turn=FULL_TURN if kind is Kind.ANGLE else 0.0,
        )
