"""A quantity: its name, its kind, and its computation from solved positions."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from enum import Enum
from functools import cached_property
from typing import Any, Protocol

import numpy as np

from linkwork.core.expression.derivatives import Jet
from linkwork.core.foundation.arrays import (
    EPSILON,
    EQUAL_ROWS,
    Array,
    BoolArray,
    FrozenDict,
    IndexArray,
)
from linkwork.core.foundation.errors import UnknownNameError
from linkwork.core.foundation.units import FULL_TURN
from linkwork.core.mechanism.skeleton import Dyad, Skeleton, dyads_of
from linkwork.core.results.quantity import Kind, Quantity, Rate, Units

#: The derivative of a quantity whose derivative would need a third one of the positions.
UNKNOWN = np.array(np.nan)


@dataclass(frozen=True, kw_only=True)
class MechanismNames:
    """The parts of a mechanism that have quantities of their own.

    Parameters
    ----------
    units : Units
    skeleton : Skeleton
    inputs, unknowns, outputs : Mapping[str, Kind]
        By name, with the kind of quantity.
    output_needs : Mapping[str, int]
        The number of derivatives of the positions that the value of each output needs.
    links, sliders, points : tuple of str
    by : str
        The unit of the input in derivatives: ``rad`` or the length unit; "" without an input.
    lead : str
        The leading input, the first one that changes from row to row; "" without an input.
    driven : str
        Where time leads: the input that moves the mechanism, "" if several do.
    further : tuple of RowQuantity
        Quantities that this mechanism alone has, of no part: those of its forces.
    series : callable, optional
        From solved positions, the requested quantity and an order: its derivatives with respect to
        the leading input from the first to this one, in radians and lengths, (order, B).
    """

    units: Units
    skeleton: Skeleton
    inputs: Mapping[str, Kind] = FrozenDict()
    unknowns: Mapping[str, Kind] = FrozenDict()
    links: tuple[str, ...] = ()
    sliders: tuple[str, ...] = ()
    outputs: Mapping[str, Kind] = FrozenDict()
    output_needs: Mapping[str, int] = FrozenDict()
    points: tuple[str, ...] = ()
    by: str = ""
    lead: str = ""
    driven: str = ""
    further: tuple[RowQuantity, ...] = ()
    series: Callable[[Solved, Any, int], Array] | None = None

    @cached_property
    def dyads(self) -> tuple[Dyad, ...]:
        """The dyads of the skeleton, found once."""
        return dyads_of(self.skeleton)


class Solved(Protocol):
    """Solved positions as arrays of one shape S: one position, the rows of a motion, of a family.

    Derivatives are with respect to the leading input, with angles in radians.
    """

    def own(self, name: str) -> Jet:
        """A variable or output of the mechanism by its exact name; values in file units."""

    def place(self, point: str) -> Jet:
        """A point by its exact name, as x + iy."""


@dataclass(frozen=True, kw_only=True)
class RowQuantity:
    """A quantity that every position has: ``B.transmission``.

    Parameters
    ----------
    word : str
        The last part of its name, behind the part of the mechanism that has it.
    about : str
        A line for lists, without the name of the part.
    needs : int
        How many derivatives of the positions its value needs; so many fewer than two it has itself.
    of : callable
        The parts of a mechanism that have it, with the kind of its value.
    evaluate : callable
        From names, solved positions and the part; angles in radians.
    of_path : bool
        Whether it is about the path of a point: pages list it for traced points only.
    kind : Kind
        What formulas take it for.
    pin : tuple of str
        Of a component of a force on a point: the point, the link on which the force acts and the
        one that exerts it, "" if it is none or several.
    """

    word: str
    about: str
    needs: int
    of: Callable[[MechanismNames], Mapping[str, Kind]]
    evaluate: Callable[[MechanismNames, Solved, str], Jet]
    of_path: bool = False
    kind: Kind = Kind.NUMBER
    pin: tuple[str, ...] = ()


@dataclass(frozen=True, kw_only=True)
class MotionRows:
    """A quantity, or the path of a point, over the rows of a motion or of a family.

    Parameters
    ----------
    input : array (R,)
        The leading input, [rad] or [length].
    value : array (…, R)
        In the file's units, a path as x + iy; NaN where there is no position.
    first, second : array (…, R)
        Its derivatives with respect to the leading input, in the same units; NaN if not requested.
    unit : float
        [rad] or [length] per unit of the input in files.
    turn : float
        A full turn of the leading input [rad], 0 if it is no angle.
    joined : array of bool (R - 1,), optional
        Between which neighbouring rows of the only motion positions can be solved.
    """

    input: Array
    value: Array
    first: Array
    second: Array
    unit: float
    turn: float
    joined: BoolArray | None = None

    def ascending(self) -> MotionRows | None:
        """The rows in order of increasing input; ``None`` if the input reverses between them."""
        steps = np.diff(self.input)
        if (steps >= 0.0).all():
            return self
        if (steps > 0.0).any():
            return None
        value, first, second = (x[..., ::-1] for x in (self.value, self.first, self.second))
        joined = None if self.joined is None else self.joined[::-1]
        return replace(
            self, input=self.input[::-1], value=value, first=first, second=second, joined=joined
        )

    @property
    def cycle(self) -> BoolArray:
        """Which motions return after one turn of the input, at the last row, (…,)."""
        span = self.input[-1] - self.input[0]
        # a turn in radians is no float, and rows come from degrees
        around = self.turn > 0.0 and abs(abs(span) - self.turn) <= EQUAL_ROWS * self.turn
        size = np.fmax.reduce(np.abs(self.value), axis=-1)
        same = np.abs(self.value[..., -1] - self.value[..., 0]) <= EQUAL_ROWS * size
        found: BoolArray = around & same & np.isfinite(self.value).all(axis=-1)
        return found

    @property
    def moves(self) -> BoolArray:
        """Which motions change the quantity by more than rounding, (…,)."""
        high, low = (each.reduce(self.value, axis=-1) for each in (np.fmax, np.fmin))
        found: BoolArray = high - low > EQUAL_ROWS * np.fmax(np.abs(high), np.abs(low))
        return found


def cubic_weights(s: Array | float) -> tuple[tuple[Any, Any], tuple[Any, Any]]:
    """The weights of ends and slopes in Hermite's cubic at s from 0 to 1."""
    r = 1.0 - s
    return (r**2 * (1.0 + 2.0 * s), s**2 * (1.0 + 2.0 * r)), (r**2 * s, -(s**2) * r)


def cubic_weight_slopes(s: Array | float) -> tuple[tuple[Any, Any], tuple[Any, Any]]:
    """The derivatives of :func:`cubic_weights` by s."""
    r = 1.0 - s
    return (-6.0 * r * s, 6.0 * r * s), (r * (r - 2.0 * s), s * (s - 2.0 * r))


def cubic(s: Array | float, ends: tuple[Array, Array], slopes: tuple[Array, Array]) -> Array:
    """Hermite's cubic at s from 0 to 1; ``slopes`` are derivatives with respect to s."""
    r = 1.0 - s
    value: Array = r**2 * ((1.0 + 2.0 * s) * ends[0] + s * slopes[0]) + s**2 * (
        (1.0 + 2.0 * r) * ends[1] - r * slopes[1]
    )
    return value


def folded(angle: Jet, period: float) -> Jet:
    """The size of an angle modulo a period, from 0 to half the period [rad]."""
    rest = angle.v - period * np.round(angle.v / period)
    # where the angle is zero its size has a corner, and no derivative
    side = np.sign(rest)
    return Jet(np.abs(rest), side * angle.d1, side * angle.d2)


@dataclass(frozen=True, kw_only=True, eq=False)
class RowSlopes:
    """The derivatives of a number of one motion by what :class:`MotionRows` has, (R,) each.

    For a path x + iy that by x plus i times that by y.
    """

    value: Array
    first: Array | float = 0.0
    second: Array | float = 0.0

    def in_order_of(self, rows: MotionRows) -> RowSlopes:
        """Derivatives by rows of increasing input as those by the rows as they are."""
        if len(rows.input) and rows.input[-1] >= rows.input[0]:
            return self
        parts = (np.broadcast_to(x, len(rows.input)) for x in (self.value, self.first, self.second))
        value, first, second = (part[::-1] for part in parts)
        return RowSlopes(value=value, first=first, second=second)


_RESTS = 1e-4  # of the range of the input: an extreme over more is a rest
#: Places between rows: the row before each, and the part of the step from there on.
Places = tuple[IndexArray, Array]


@dataclass(frozen=True, kw_only=True)
class MotionQuantity:
    """A number of a whole motion: ``stroke(s16)``.

    Parameters
    ----------
    word : str
        The word before the parenthesis.
    about : str
        A line for lists.
    evaluate : callable
        From rows and the further numbers in the parentheses, shape (…,).
    of_point : bool
        Whether it is asked of a point instead of a quantity.
    numbers : tuple of str
        What further numbers are called; each of them is positive.
    needs : int
        How many derivatives of the quantity it needs.
    measures : str
        ``quantity``: the same as the quantity; ``input``: the same as the leading input;
        ``number``.
    slopes : callable
        As ``evaluate``, its derivatives for one motion, (R,).
    places : callable, optional
        As ``evaluate``, where further rows make the number of one motion exact: none once it is.
    sides : (float, ...)
        Of an extreme: 1 for the largest value, -1 for the smallest, both for their difference.
    """

    word: str
    about: str
    evaluate: Callable[[MotionRows, tuple[float, ...]], Array]
    slopes: Callable[[MotionRows, tuple[float, ...]], RowSlopes]
    of_point: bool = False
    numbers: tuple[str, ...] = ()
    needs: int = 0
    measures: str = "quantity"
    places: Callable[[MotionRows, tuple[float, ...]], Places] | None = None
    sides: tuple[float, ...] = ()


#: Steps of a turn, or of a table of lengths or times, that show all extremes of smooth quantities.
CLOSE_ROWS = 72


def at_extreme(rows: MotionRows, side: float) -> Array:
    """1 in the row with the largest value, for a negative side the smallest; NaN where several
    positions have it, and if it is infinite, (R,).
    """
    value = side * rows.value
    best = np.fmax.reduce(value)
    if np.isinf(best):
        return np.full(len(value), np.nan)
    there = np.flatnonzero(value >= best - EQUAL_ROWS * np.abs(best))
    # neighbouring rows show one extreme, unless the quantity rests there
    runs = np.split(there, np.flatnonzero(np.diff(there) > 1) + 1)
    peaks = [run[value[run] >= best - 8.0 * EPSILON * np.abs(best)] for run in runs]
    spans = [float(np.ptp(rows.input[peak])) for peak in peaks if len(peak)]
    rests = max(spans, default=0.0) > _RESTS * np.ptp(rows.input)
    if len(runs) == 2 and there[0] == 0 and there[-1] == len(value) - 1 and rows.cycle:
        runs = [there]  # the first and the last row of a turn are one position
    weight = np.zeros(len(value))
    # of rows that are equal to rounding the one at which the quantity turns
    highest = there[value[there] >= best - 8.0 * EPSILON * np.abs(best)]
    turning = np.nan_to_num(np.abs(rows.first[highest]), nan=np.inf).argmin()
    weight[highest[turning]] = 1.0 if len(runs) == 1 and not rests else np.nan
    return weight


# ----------------------------------------------------------------------
# Requested quantities: their unit, kind and values.


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
