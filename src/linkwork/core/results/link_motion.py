"""The motion of links in the plane: position and velocity of their frames."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations

import numpy as np

from linkwork.core.foundation.arrays import Array, ComplexArray
from linkwork.core.foundation.errors import InputError, UnknownNameError, choices
from linkwork.core.foundation.names import GROUND
from linkwork.core.results.motion import Motion
from linkwork.core.results.position import Position


@dataclass(frozen=True, kw_only=True)
class LinkMotion:
    """The frame of a link over N positions, with its derivatives with respect to the input.

    The frame's origin is the link's first point, and it turns with the link: a point ``m`` of the
    link is at ``origin + turn · m`` and moves at ``shift + i · spin · (place)``.

    Parameters
    ----------
    link : str
    points : tuple of str
        The points that it carries.
    origin, turn : array (N,), complex
        The first point's place and the link's direction, a unit vector.
    shift : array (N,), complex
        The rate of the link's own point that is at the origin of the plane [length/input].
    spin : array (N,)
        The rate of its angle [rad/input].
    """

    link: str
    points: tuple[str, ...]
    origin: ComplexArray
    turn: ComplexArray
    shift: ComplexArray
    spin: Array


def link_motions(of: Position | Motion) -> list[LinkMotion]:
    """Ground first, then every link that carries a point."""
    return [link_motion(of, name) for name in _links(of)]


def link_motion(of: Position | Motion, link: str) -> LinkMotion:
    """The motion of one link.

    Raises
    ------
    UnknownNameError
        If there is no such link with points.
    InputError
        If neither an angle nor two points determine its direction.
    """
    links = _links(of)
    if link not in links:
        raise UnknownNameError(f'there is no link "{link}" {choices("links", links, link)}')
    points = links[link]
    if link == GROUND:
        count = len(of) if isinstance(of, Motion) else 1
        still: ComplexArray = np.zeros(count, dtype=complex)
        turn: ComplexArray = np.ones(count, dtype=complex)
        spin: Array = np.zeros(count)
        return LinkMotion(link=link, points=points, origin=still, turn=turn, shift=still, spin=spin)
    origin, rate = _point(of, points[0])
    if link in of.links:
        turn, spin = _angle(of, link)
    else:
        turn, spin = _direction(of, link, points, (origin, rate))
    # v(z) = a + iωz at the link's first point, solved for a
    shift: ComplexArray = rate - 1j * spin * origin
    return LinkMotion(link=link, points=points, origin=origin, turn=turn, shift=shift, spin=spin)


def _links(of: Position | Motion) -> dict[str, tuple[str, ...]]:
    bars = {bar.name: bar.points for bar in of.skeleton.bars if bar.points}
    return {GROUND: of.skeleton.fixed} | bars


def _point(of: Position | Motion, name: str) -> tuple[ComplexArray, ComplexArray]:
    """The place and the rate of a point, shape (N,)."""
    jet = of.place(name)
    return np.atleast_1d(jet.v), np.atleast_1d(jet.d1)


def _angle(of: Position | Motion, link: str) -> tuple[ComplexArray, Array]:
    """The direction and the rate of a link's own angle, shape (N,)."""
    jet = of.own(link)
    turn: ComplexArray = np.exp(1j * np.atleast_1d(jet.v) * of.units.angle.radians)
    return turn, np.atleast_1d(jet.d1)


def _direction(
    of: Position | Motion,
    link: str,
    points: tuple[str, ...],
    first: tuple[ComplexArray, ComplexArray],
) -> tuple[ComplexArray, Array]:
    """The direction from a link's first point to another one, and its rate."""
    for place, rate in (_point(of, name) for name in points[1:]):
        along, rates = place - first[0], rate - first[1]
        # two points that coincide in some row give no direction there
        if np.nanmin(np.abs(along), initial=np.inf) > 0.0:
            with np.errstate(invalid="ignore"):  # rows that were not found are NaN, and stay so
                return along / np.abs(along), (rates / along).imag
    raise InputError(
        f'the rotation of link "{link}" is not known: give it two points, or name its angle'
    )


# ----------------------------------------------------------------------
# Instant centres, at which two links have the same velocity, and centrodes.
#
# A link's points move at ``v(z) = a + iωz``, so links 1 and 2 agree at
# ``z = i (a₁ - a₂) / (ω₁ - ω₂)``. Of three links, the three centres lie in one line: the theorem of
# Aronhold and Kennedy.
#
# References
# ----------
# R. L. Norton, Design of Machinery, 6th ed., McGraw-Hill 2020, sections 6.3 and 6.4.


_PARALLEL = 1e-9  # relative: links that turn at rates as near as this have their centre at infinity


@dataclass(frozen=True, kw_only=True)
class InstantCentre:
    """The place at which two links have the same velocity.

    Parameters
    ----------
    links : (str, str)
        In the order of the mechanism, ground first.
    place : complex, optional
        x + iy; ``None`` at infinity.
    direction : complex, optional
        A unit vector towards a centre at infinity.
    permanent : bool
        Whether it is a pin of both links and stays one.
    """

    links: tuple[str, str]
    place: complex | None
    direction: complex | None = None
    permanent: bool = False


@dataclass(frozen=True, kw_only=True, eq=False)
class Centrodes:
    """The paths of a link's instant centre against ground, over N positions.

    Parameters
    ----------
    link : str
    fixed : array (N,), complex
        In the plane; NaN where the centre is at infinity or there is no position.
    moving : array (N,), complex
        In the link's frame: at its first point, in the direction of its angle (without a named
        angle, towards its second point). It rolls on the fixed one.
    """

    link: str
    fixed: ComplexArray
    moving: ComplexArray


def instant_centres(position: Position) -> tuple[InstantCentre, ...]:
    """The centres of all pairs of links that move relative to each other.

    Raises
    ------
    InputError
        If the position was not found, or has no derivatives with respect to the input: at a dead
        point, or without a moving input.
    """
    if not position.status.ok:
        raise InputError(f'"{position.mechanism}" has no position here: {position.message}')
    bodies = link_motions(position)
    if len(bodies) < 2:
        raise InputError(f'"{position.mechanism}" has no links with points, so no instant centres')
    lost = [b.link for b in bodies if not (np.isfinite(b.shift[0]) and np.isfinite(b.spin[0]))]
    if lost:
        raise InputError(
            f'"{position.mechanism}" has no instant centres here: '
            f"the rates of {', '.join(lost)} with respect to the input are not finite or not known"
        )
    size = max((abs(complex(*place)) for place in position.points.values()), default=1.0)
    fastest = max(max(abs(b.shift[0]), abs(b.spin[0]) * size) for b in bodies)
    found = (_centre(position, one, two, size, fastest) for one, two in combinations(bodies, 2))
    return tuple(centre for centre in found if centre is not None)


def _centre(
    position: Position, one: LinkMotion, two: LinkMotion, size: float, fastest: float
) -> InstantCentre | None:
    """The centre of two links; ``None`` if they do not move relative to each other."""
    links = (one.link, two.link)
    shared = [point for point in one.points if point in two.points]
    if shared:
        place = complex(*position.points[shared[0]])
        return InstantCentre(links=links, place=place, permanent=True)
    shift = complex(one.shift[0] - two.shift[0])
    spin = float(one.spin[0] - two.spin[0])
    if abs(spin) * size > _PARALLEL * fastest:
        return InstantCentre(links=links, place=1j * shift / spin)  # eq. (56)
    # links that turn alike have their centre at infinity, across the difference of velocities
    if abs(shift) > _PARALLEL * fastest:
        return InstantCentre(links=links, place=None, direction=1j * shift / abs(shift))
    return None


def centrodes(motion: Motion, link: str) -> Centrodes:
    """The fixed and the moving centrode of a link.

    Raises
    ------
    UnknownNameError
        If there is no such link.
    InputError
        If it is the ground, or has no centre because it does not turn.
    """
    if link == GROUND:
        raise InputError("the ground has no centrodes: name a link that moves")
    body = link_motion(motion, link)
    size = float(np.nanmax(np.abs(body.origin), initial=0.0)) or 1.0
    fastest = np.maximum(np.abs(body.shift), np.abs(body.spin) * size)
    turns = motion.found & (np.abs(body.spin) * size > _PARALLEL * fastest)
    if not turns.any():
        raise InputError(f'the link "{link}" does not turn: its instant centre is at infinity')
    nowhere = complex(np.nan, np.nan)
    # without a division by zero where the link does not turn
    # eq. (56) with the ground at rest
    fixed = np.where(turns, 1j * body.shift / np.where(turns, body.spin, 1.0), nowhere)
    moving: ComplexArray = (fixed - body.origin) * body.turn.conj()
    return Centrodes(link=link, fixed=fixed, moving=moving)
