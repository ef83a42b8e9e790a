"""Where a quantity is largest or smallest between the rows of one motion."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from linkwork.core.expression.derivatives import Jet
from linkwork.core.foundation.arrays import (
    EPSILON,
    EQUAL_ROWS,
    REST,
    Array,
    BoolArray,
    ComplexArray,
    IndexArray,
)
from linkwork.core.foundation.lanes import replaced
from linkwork.core.foundation.units import FULL_TURN
from linkwork.core.mechanism.bodies import CamOutline, Follower
from linkwork.core.mechanism.skeleton import Dyad
from linkwork.core.results.quantities.definition import (
    UNKNOWN,
    AskedOfMotion,
    Group,
    MechanismNames,
    MotionRows,
    Places,
    RowQuantity,
    Solved,
    cubic,
    folded,
)
from linkwork.core.results.quantity import Kind

#: No places.
NOWHERE: Places = np.zeros(0, dtype=np.intp), np.zeros(0)

_HALVINGS = 52
_SAMPLES = np.linspace(0.0, 1.0, 9)  # of a step between rows
_POOR = 1e-2  # of the change over a step: cubics that miss so much are no guide
_FINE = 2.6  # degrees, or parts of the range of which 360 are a turn
_EIGHTHS = np.arange(1, 8) / 8.0
_BEYOND = 0.5  # of a step: an extreme of the parabola so near behind the last row may be before it


def joined_places(*places: Places) -> Places:
    """Several places as one."""
    rows, parts = zip(*places, strict=True)
    return np.concatenate(rows), np.concatenate(parts)


def extreme_places(rows: MotionRows, side: float) -> Places:
    """Where the largest value of one motion may lie, with a negative side the smallest.

    Places are zeros of the derivative, on the cubic through it and its slope at the rows; where the
    quantity has no derivatives, the vertex and the eighths of the steps next to the highest rows.
    """
    if rows.joined is None or not np.isfinite(rows.value).any():
        return NOWHERE
    step, value = np.diff(rows.input), side * rows.value
    rates, bends = side * step * rows.first[:-1], side * step**2 * rows.second[:-1]
    ends = rates, side * step * rows.first[1:]
    slopes = bends, side * step**2 * rows.second[1:]
    # without a second derivative the first one is linear
    begin, end = (np.where(np.isnan(x), ends[1] - ends[0], x) for x in slopes)
    slopes = begin, end
    smooth = rows.joined & np.isfinite(sum((*ends, *slopes)))
    with np.errstate(all="ignore"):
        if not smooth.any():
            fine = math.radians(_FINE) if rows.turn else np.ptp(rows.input) * _FINE / 360.0
            coarse = np.flatnonzero(rows.joined & (np.abs(step) > fine))
            if len(coarse):  # values alone do not show what is between rows
                return coarse, np.full(len(coarse), 0.5)
            return _next_to_peaks(rows, value)
        return joined_places(
            _zeros(value, ends, slopes, smooth), _towards_dead_points(rows, value, ends, smooth)
        )


_Ends = tuple[Array, Array]


def _zeros(value: Array, ends: _Ends, slopes: _Ends, smooth: BoolArray) -> Places:
    """Where the derivative passes zero downwards, in steps that may hold the largest value."""
    best = np.fmax.reduce(value)
    top = np.maximum(value[:-1], value[1:])
    rate = cubic(_SAMPLES[:, None], ends, slopes)
    # what the cubic of the derivative misses of the change of the value
    missed = np.abs(np.diff(value) - 0.5 * (ends[0] + ends[1]) - (slopes[0] - slopes[1]) / 12.0)
    rise = np.maximum(rate, 0.0).max(axis=0)
    may = smooth & (top + rise + missed >= best)
    rounding = 16.0 * EPSILON * np.abs(top)
    poor = may & (missed > _POOR * np.abs(rate).max(axis=0) + rounding)
    row = np.flatnonzero(may & ((rate[:-1] > 0.0) & (rate[1:] <= 0.0)).any(axis=0) & ~poor)
    falls = ((rate[:-1] > 0.0) & (rate[1:] <= 0.0))[:, row].argmax(axis=0)
    own = (ends[0][row], ends[1][row]), (slopes[0][row], slopes[1][row])
    part = roots_of_cubics(*own, _SAMPLES[falls], _SAMPLES[falls + 1])
    middle = np.flatnonzero(poor)
    corner = np.flatnonzero(poor & (ends[0] > 0.0) & (ends[1] < 0.0))
    # where the tangents of both ends meet
    up, down = ends[0][corner], ends[1][corner]
    meet = (np.diff(value)[corner] - down) / (up - down)
    return joined_places(
        (row, part), (middle, np.full(len(middle), 0.5)), (corner, np.clip(meet, 0.0, 1.0))
    )


def roots_of_cubics(ends: _Ends, slopes: _Ends, low: Array, high: Array) -> Array:
    """Where cubics that are positive at ``low`` pass zero before ``high``."""
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        ahead = cubic(middle, ends, slopes) > 0.0
        low, high = np.where(ahead, middle, low), np.where(ahead, high, middle)
    return high


def _towards_dead_points(rows: MotionRows, value: Array, ends: _Ends, smooth: BoolArray) -> Places:
    """The middle of steps without rates at one end, where the quantity turns before that."""
    assert rows.joined is not None
    change = np.diff(value)
    turns = np.where(np.isfinite(ends[0]), (ends[0] > 0.0) & (change < 0.0),
                     (ends[1] < 0.0) & (change > 0.0))  # fmt: skip
    row = np.flatnonzero(rows.joined & ~smooth & turns)
    return row, np.full(len(row), 0.5)


def _next_to_peaks(rows: MotionRows, value: Array) -> Places:
    """Vertex and eighths of the steps next to rows that are higher than their neighbours."""
    assert rows.joined is not None
    before = np.append(False, rows.joined)
    after = np.append(rows.joined, False)
    left = np.where(before, np.roll(value, 1), -np.inf)
    right = np.where(after, np.roll(value, -1), -np.inf)
    best = np.fmax.reduce(value)
    inner = before & after
    bend = np.where(inner, 2.0 * value - left - right, 0.0)
    peaks = (value >= left) & (value >= right) & (value + bend >= best)
    peaks &= bend > 16.0 * EPSILON * np.abs(best)
    found = [NOWHERE]
    for k in np.flatnonzero(peaks).tolist():
        found += [(np.full(len(_EIGHTHS), row), _EIGHTHS) for row in (k - 1, k)]
        row, part = _vertex(rows.input[k - 1 : k + 2], value[k - 1 : k + 2], k)
        found.append((row, np.clip(part, 0.0, 1.0)))
    return joined_places(*found, *_next_to_ends(rows, value, best, inner))


def _next_to_ends(
    rows: MotionRows, value: Array, best: float, inner: BoolArray
) -> Iterator[Places]:
    """The vertex in the first or last step of rows that are joined, if the parabola has one."""
    for k in np.flatnonzero(inner & ~(np.roll(inner, 1) & np.roll(inner, -1))).tolist():
        f, u = value[k - 1 : k + 2], rows.input[k - 1 : k + 2]
        row, part = _vertex(u, f, k)
        behind = row[0] == k
        beside = inner[k + 1] if behind else inner[k - 1]
        concave = 2.0 * f[1] > f[0] + f[2] + 16.0 * EPSILON * np.abs(f).max()
        near = -_BEYOND < part[0] < 1.0 + _BEYOND
        if concave and near and not beside and f.max() + np.ptp(f) >= best:
            yield row, np.clip(part, _EIGHTHS[0], _EIGHTHS[-1])


def _vertex(u: Array, f: Array, row: int) -> Places:
    """The vertex of the parabola through three rows, of which the middle one is the highest."""
    a, b = (f[1] - f[0]) / (u[1] - u[0]), (f[2] - f[1]) / (u[2] - u[1])
    at = 0.5 * (u[0] + u[1]) - 0.5 * a * (u[2] - u[0]) / (b - a)
    below = (at - u[1]) * (u[2] - u[0]) < 0.0
    one: IndexArray = np.array([row - 1 if below else row])
    begin, end = (u[0], u[1]) if below else (u[1], u[2])
    return one, np.array([(at - begin) / (end - begin)])


# ----------------------------------------------------------------------
# Rows in addition to those of a motion's table, at which a number of the motion is exact.


_MOST_PASSES, _SHARP = 16, 40  # the latter for extremes that are no poles so far
_POLE = 1e3  # times the values of the table: there may be a pole instead of an extreme,
_GROWS = 0.1  # of the value, where it still changes so much up to the nearest row
_MOST = 10_000  # further rows for one number: one of more than that is rounding of a constant
_AT_ROW = 1e-12  # of the input: places so near to a row are that row


class SolvedTable(Solved, Protocol):
    """Solved positions, some of which may be missing."""

    @property
    def found(self) -> BoolArray:
        """Whether a row has a position, (K,)."""


class Between(Protocol):
    """Solves positions between the rows of a motion."""

    @property
    def joined(self) -> BoolArray:
        """Between which neighbouring rows positions can be solved, (R - 1,)."""

    @property
    def switches(self) -> Array:
        """Leading inputs just before and just behind the switches of loads, rising, (K,)."""

    @property
    def far(self) -> float:
        """The largest step that shows all extremes of smooth quantities [rad or length]."""

    def __call__(self, row: IndexArray, at: Array) -> SolvedTable:
        """Positions at leading inputs (K,) [rad or length] between rows (K,) and the next ones."""


@dataclass(frozen=True, kw_only=True, eq=False)
class LocatedRows:
    """The rows of a motion with further ones in their places.

    ``further``: the solutions that were added. ``order``: the place of each row among those of the
    motion followed by all further ones.
    """

    rows: MotionRows
    further: Sequence[SolvedTable]
    order: IndexArray


def columns_of(
    asked: AskedOfMotion, solved: Solved, speed: float | None
) -> tuple[Array, Array, Array]:
    """The quantity and its derivatives by the leading input, NaN if it has none, in file units."""
    of, rate = asked.of, asked.of.rate
    if asked.quantity.of_point or (rate is None and of.group is not Group.EVIDENCE):
        return replace(asked, quantity=replace(asked.quantity, needs=2)).columns(solved, speed)
    value = of.values(solved, speed)
    if rate is None or rate.order > 1 or of.group is Group.POINT:
        return value, UNKNOWN, UNKNOWN
    return value, rate.of(of.jet(solved).d2, UNKNOWN, speed), UNKNOWN


def locate_rows(
    asked: AskedOfMotion, rows: MotionRows, between: Between | None, speed: float | None
) -> LocatedRows:
    """The rows with those that make the number exact, as far as positions can be solved there."""
    order, further = np.arange(len(rows.input)), list[SolvedTable]()
    places = asked.quantity.places
    still = asked.of.group in (Group.EVIDENCE, Group.INPUT)
    if between is None or places is None or still or len(order) < 2:
        return LocatedRows(rows=rows, further=further, order=order)
    rows, before, count = replace(rows, joined=between.joined), order, len(order)
    first = order
    most = _POLE * np.nanmax(np.abs(rows.value), initial=0.0)
    row, part = _places_within(rows, between.far)
    if any(each.word == asked.of.own.name for each in asked.names.further):
        row, part = joined_places((row, part), _places_of(rows, between.switches))
    sides = asked.quantity.sides
    for k in range(_SHARP if sides else _MOST_PASSES):
        if k == _MOST_PASSES and any(_poles(rows, side, most) for side in sides):
            break
        if k or not len(row):
            row, part = places(rows, asked.numbers)
        step = np.abs(rows.input[row + 1] - rows.input[row])
        size = np.maximum(np.ptp(rows.input), np.abs(rows.input[row]))
        fresh = np.minimum(part, 1.0 - part) * step > _AT_ROW * size
        at = np.unique(np.stack([row[fresh], part[fresh]]), axis=1)
        row, part = at[0].astype(np.intp), at[1]
        if not len(row) or (k and count + len(row) > len(first) + _MOST):
            break
        at = rows.input[row] + part * (rows.input[row + 1] - rows.input[row])
        more = between(before[row], at)
        there = np.flatnonzero(more.found)
        if not len(there):
            break
        own = [np.broadcast_to(x, len(at))[there] for x in columns_of(asked, more, speed)]
        behind = row[there] + 1
        rows = _inserted(rows, behind, at[there], own)
        order = np.insert(order, behind, count + there)
        before = np.insert(before, behind, before[row[there]])
        further.append(more)
        count += len(at)
    poles = [k for side in sides for k in _poles(rows, side, most)]
    if poles:
        value = rows.value.copy()
        value[poles] *= np.inf
        rows = replace(rows, value=value)
    return LocatedRows(rows=rows, further=further, order=order)


def _places_within(rows: MotionRows, far: float) -> Places:
    """Where further rows are wanted, so that none is farther from the next one."""
    assert rows.joined is not None
    parts = np.where(rows.joined, np.ceil(np.abs(np.diff(rows.input)) / far - EQUAL_ROWS), 1.0)
    more = np.maximum(parts.astype(np.intp) - 1, 0)
    row = np.repeat(np.arange(len(more)), more)
    number = np.arange(len(row)) - np.repeat(np.cumsum(more) - more, more)
    return row, (number + 1.0) / parts[row]


def _poles(rows: MotionRows, side: float, most: float) -> list[int]:
    """The row of the largest value, for a negative side the smallest, if its size is above ``most``
    and still grows from row to row: rows next to an extreme are so close that it does not.
    """
    k = int(np.nan_to_num(side * rows.value, nan=-np.inf).argmax())
    size = abs(float(rows.value[k]))
    beside = [j for j in (k - 1, k + 1) if 0 <= j < len(rows.value)]
    grown = abs(float(rows.first[k])) * np.abs(rows.input[beside] - rows.input[k]).min()
    if not np.isfinite(grown):
        grown = np.fmin.reduce(np.abs(rows.value[beside] - rows.value[k]))
    return [k] if size > most and not grown <= _GROWS * size else []


def _places_of(rows: MotionRows, at: Array) -> Places:
    """Between which rows leading inputs (K,) lie, and the part of the step there."""
    order = np.argsort(rows.input, kind="stable")
    k = np.clip(rows.input[order].searchsorted(at, side="right") - 1, 0, len(order) - 2)
    row = np.minimum(order[k], order[k + 1])
    return row, (at - rows.input[row]) / (rows.input[row + 1] - rows.input[row])


def _inserted(rows: MotionRows, behind: IndexArray, at: Array, own: Sequence[Array]) -> MotionRows:
    value, first, second = (
        np.insert(column, behind, new)
        for column, new in zip((rows.value, rows.first, rows.second), own, strict=True)
    )
    assert rows.joined is not None
    joined = np.insert(rows.joined, behind - 1, True)
    given = np.insert(rows.input, behind, at)
    return replace(rows, input=given, value=value, first=first, second=second, joined=joined)


# ----------------------------------------------------------------------
# Transmission angles, a measure of the transmission of force at the pin of a dyad.
#
# Between two pinned links it is the angle of their arms at the common pin; between a link and a
# block, the angle between the link and the normal of the block's line. All of the force is
# transmitted at a right angle, none at 0 and at π.
#
# References
# ----------
# H. Alt, Der Übertragungswinkel und seine Bedeutung für das Konstruieren periodischer Getriebe,
# Werkstattstechnik 26 (1932) 61-64.


#: Recommended angles, 40° to 140° [rad].
RECOMMENDED = (2 * np.pi / 9, 7 * np.pi / 9)


def _pins(names: MechanismNames) -> Mapping[str, Kind]:
    return {dyad.pin: Kind.ANGLE for dyad in names.dyads}


def _transmission_angle(names: MechanismNames, solved: Solved, pin: str) -> Jet:
    dyad = next(dyad for dyad in names.dyads if dyad.pin == pin)
    place = solved.place(pin)
    one = (solved.place(dyad.arms[0]) - place).direction()
    if dyad.guide is None:
        other = (solved.place(dyad.arms[1]) - place).direction()
    else:
        # the block passes its force on across its line
        start, end = (solved.place(point) for point in dyad.guide.line)
        other = (end - start).direction() + np.pi / 2
    return folded(one - other, FULL_TURN)  # eq. (57)


TRANSMISSION_ANGLE = RowQuantity(
    word="transmission",
    about="transmission angle at the pin, 0 to half a turn",
    kind=Kind.ANGLE,
    needs=0,
    of=_pins,
    evaluate=_transmission_angle,
)
TRANSMISSION = (TRANSMISSION_ANGLE,)


# ----------------------------------------------------------------------
# Mechanical advantage: the force or moment at a part for one at the input, without friction.
#
# Virtual work of forces in balance: Q δx = P δu, so that Q/P = du/dx. Where the part is at rest to
# rounding while the input moves, as at the dead centre of a press, it is infinite and has no
# derivatives; at dead points of the input, where no such derivative exists, it is NaN.
#
# References
# ----------
# R. L. Norton, Design of Machinery, 6th ed., McGraw-Hill 2020, section 6.5.


def _driver(names: MechanismNames) -> str:
    """The input that moves the parts: the leading one, or the only one where time leads."""
    return names.driven if names.lead and names.inputs[names.lead] is Kind.TIME else names.lead


def _parts(names: MechanismNames) -> Mapping[str, Kind]:
    """Links and sliders, or all unknowns where nothing else is named, with what it measures."""
    driver = _driver(names)
    own = {**names.unknowns, **names.inputs}.get(driver, Kind.NUMBER)
    if own is Kind.NUMBER:
        return {}
    by_angle = own is Kind.ANGLE
    other = Kind.PER_LENGTH if by_angle else Kind.LENGTH
    of_angle, of_length = (Kind.NUMBER, other) if by_angle else (other, Kind.NUMBER)
    parts = {*names.links, *names.sliders} if names.links else {*names.unknowns}
    return {
        part: of_angle if kind is Kind.ANGLE else of_length
        for part, kind in names.unknowns.items()
        if part in parts and part != driver and kind is not Kind.NUMBER
    }


def _advantage(names: MechanismNames, solved: Solved, part: str) -> Jet:
    moved = solved.own(part)
    if _driver(names) != names.lead:
        return _in_time(names, solved, part, moved)
    rests = _rests(names, solved, part, moved)
    value = np.where(rests, np.inf, 1.0 / moved.d1)  # eq. (61)
    rate = np.where(rests, np.nan, -moved.d2 / moved.d1**2)
    return Jet(value, rate, UNKNOWN)


def _in_time(names: MechanismNames, solved: Solved, part: str, moved: Jet) -> Jet:
    """The same where time leads, from the rates of part and input."""
    driver = solved.own(names.driven)
    # a motion that begins at rest has the ratio of its accelerations
    still = driver.d1 == 0.0
    first = np.where(still, moved.d2, moved.d1) / np.where(still, driver.d2, driver.d1)
    second = np.where(still, 0.0, (moved.d2 - first * driver.d2) / driver.d1**2)
    rests = _rests(names, solved, part, Jet(moved.v, first, second))
    rate = np.where(rests | still, np.nan, -second / first**2 * driver.d1)
    return Jet(np.where(rests, np.inf, 1.0 / first), rate, UNKNOWN)


def _rests(names: MechanismNames, solved: Solved, part: str, moved: Jet) -> BoolArray:
    """Whether the rate of a part is 0 to the accuracy of the input and of its own position."""
    driver = _driver(names)
    angle = {**names.unknowns, **names.inputs}[driver] is Kind.ANGLE
    reach = 1.0 if angle else np.nanmax(np.abs(solved.own(driver).v), initial=0.0)
    size = 1.0 if names.unknowns[part] is Kind.ANGLE else np.abs(moved.v)
    own = size / reach if reach else 0.0
    found: BoolArray = np.abs(moved.d1) <= REST * (reach * np.abs(moved.d2) + own)
    return found


MECHANICAL_ADVANTAGE = (
    RowQuantity(
        word="mechanical_advantage",
        about="its force or moment for one at the input, no friction",
        needs=1,
        of=_parts,
        evaluate=_advantage,
    ),
)


# ----------------------------------------------------------------------
# The curvature of the path of a point, and its centre of curvature.
#
# κ = (x' y'' - y' x'') / |F'|³, positive where the path bends to the left of its direction for a
# growing input; the centre lies at F + n/κ. Where the path is straight to rounding, κ is 0 and the
# centre lies at infinity and is NaN. Where the point does not move (a cusp, a dwell) the path has
# no direction, and all of them are NaN.
#
# References
# ----------
# O. Bottema, B. Roth, Theoretical Kinematics, North-Holland 1979, chapter 8.


_STRAIGHT = 1e-12  # relative: a normal acceleration below this part of the whole is rounding


def _moving(names: MechanismNames) -> dict[str, Kind]:
    points = names.points if names.lead else ()
    return dict.fromkeys((p for p in points if p not in names.skeleton.fixed), Kind.LENGTH)


def _curved(names: MechanismNames) -> Mapping[str, Kind]:
    return dict.fromkeys(_moving(names), Kind.PER_LENGTH)


def _bend(
    names: MechanismNames, solved: Solved, point: str
) -> tuple[ComplexArray, ComplexArray, Array, BoolArray]:
    """Place, first derivative, cross product of both derivatives; where there is a direction."""
    place = solved.place(point)
    cross = (place.d1.conj() * place.d2).imag
    still, bent = np.abs(place.d1), np.abs(place.d2)
    # of a straight path only rounding is left of the cross product
    cross = replaced(np.where(np.abs(cross) <= _STRAIGHT * still * bent, 0.0, cross), cross)
    reach = 1.0 if names.by == "rad" else np.nanmax(np.abs(place.v), initial=0.0)
    return place.v, place.d1, cross, still > REST * reach * bent


def _curvature(names: MechanismNames, solved: Solved, point: str) -> Jet:
    _, rate, cross, moves = _bend(names, solved, point)
    return Jet(np.where(moves, cross / np.abs(rate) ** 3, np.nan), UNKNOWN, UNKNOWN)  # eq. (59)


def _centre(names: MechanismNames, solved: Solved, point: str) -> ComplexArray:
    place, rate, cross, moves = _bend(names, solved, point)
    # eq. (60)
    away = 1j * rate * np.abs(rate) ** 2 / np.where(moves & (cross != 0.0), cross, np.nan)
    found: ComplexArray = place + away
    return found


def _centre_x(names: MechanismNames, solved: Solved, point: str) -> Jet:
    return Jet(_centre(names, solved, point).real, UNKNOWN, UNKNOWN)


def _centre_y(names: MechanismNames, solved: Solved, point: str) -> Jet:
    return Jet(_centre(names, solved, point).imag, UNKNOWN, UNKNOWN)


PATH_CURVATURE = (
    RowQuantity(
        word="curvature",
        about="curvature of the point's path, positive to the left",
        needs=2,
        of=_curved,
        evaluate=_curvature,
        of_path=True,
    ),
    RowQuantity(
        word="centre.x",
        about="centre of curvature of the point's path",
        kind=Kind.LENGTH,
        needs=2,
        of=_moving,
        evaluate=_centre_x,
        of_path=True,
    ),
    RowQuantity(
        word="centre.y",
        about="centre of curvature of the point's path",
        kind=Kind.LENGTH,
        needs=2,
        of=_moving,
        evaluate=_centre_y,
        of_path=True,
    ),
)


# ----------------------------------------------------------------------
# Pressure angles: between the force on a guided part and the direction in which it can move.
#
# On a follower with a knife edge or a roller the cam acts along the normal of the path that the
# follower's point has on the cam: normal to its velocity relative to the cam. A link that moves a
# block acts along its own line. Where the point does not move on the cam the angle is NaN.
#
# References
# ----------
# R. L. Norton, Cam Design and Manufacturing Handbook, 2nd ed., Industrial Press 2009, chapter 7.


_QUARTER = np.pi / 2  # between a line and its normal


def _followers(names: MechanismNames) -> dict[str, Follower]:
    """Followers that touch the cam at one point of their own, by the name of the cam."""
    followers = names.skeleton.of(Follower) if names.lead else ()
    return {f.name: f for f in followers if f.contact != "flat"}


def _blocks(names: MechanismNames) -> dict[str, Dyad]:
    return {dyad.guide.name: dyad for dyad in names.dyads if dyad.guide is not None}


def _guided(names: MechanismNames) -> Mapping[str, Kind]:
    return dict.fromkeys([*_followers(names), *_blocks(names)], Kind.ANGLE)


def _pressure_angle_angle(names: MechanismNames, solved: Solved, part: str) -> Jet:
    followers = _followers(names)
    if part in followers:
        follower = followers[part]
        force = _sliding(names, solved, follower).direction() + _QUARTER
        if follower.pivot is None:
            way = _line(names, solved, follower.slider or "")
        else:
            arm = solved.place(follower.point) - solved.place(follower.pivot)
            way = arm.direction() + _QUARTER
    else:
        dyad = _blocks(names)[part]
        force = (solved.place(dyad.pin) - solved.place(dyad.arms[0])).direction()
        way = _line(names, solved, part)
    return folded(force - way, np.pi)  # eq. (58)


def _line(names: MechanismNames, solved: Solved, guide: str) -> Jet:
    line = next(g.line for g in names.skeleton.guides if g.name == guide)
    start, end = (solved.place(point) for point in line)
    return (end - start).direction()


def _sliding(names: MechanismNames, solved: Solved, follower: Follower) -> Jet:
    """The follower point's velocity relative to the cam, per unit of the input."""
    outlines = names.skeleton.of(CamOutline)
    cam = next(outline for outline in outlines if outline.name == follower.name)
    turning = solved.own(cam.link)
    arm = solved.place(follower.point) - solved.place(cam.center)
    # less the velocity of the cam's own point at the same place
    rate = arm.d1 - 1j * turning.d1 * arm.v
    bend = arm.d2 - 1j * (turning.d2 * arm.v + turning.d1 * arm.d1)
    return Jet(rate, bend, UNKNOWN)


PRESSURE_ANGLE = (
    RowQuantity(
        word="pressure_angle",
        about="between the force on the guided part and its way",
        kind=Kind.ANGLE,
        needs=1,
        of=_guided,
        evaluate=_pressure_angle_angle,
    ),
)
