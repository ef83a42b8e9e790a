"""Transmission angles, a measure of the transmission of force at the pin of a dyad.

Between two pinned links it is the angle of their arms at the common pin; between a link and a
block, the angle between the link and the normal of the block's line. All of the force is
transmitted at a right angle, none at 0 and at π.

References
----------
H. Alt, Der Übertragungswinkel und seine Bedeutung für das Konstruieren periodischer Getriebe,
Werkstattstechnik 26 (1932) 61-64.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from linkwork.core.expression.derivatives import Jet
from linkwork.core.foundation.arrays import Array, BoolArray, ComplexArray
from linkwork.core.foundation.lanes import replaced
from linkwork.core.foundation.rounding import REST
from linkwork.core.foundation.units import FULL_TURN
from linkwork.core.mechanism.bodies import CamOutline, Follower
from linkwork.core.mechanism.skeleton import Dyad
from linkwork.core.results.quantities.definition import (
    UNKNOWN,
    MechanismNames,
    RowQuantity,
    Solved,
    folded,
)
from linkwork.core.results.quantity import Kind

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
