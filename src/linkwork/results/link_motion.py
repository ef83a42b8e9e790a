"""The motion of links in the plane: position and velocity of their frames."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from linkwork.foundation.arrays import Array, ComplexArray
from linkwork.foundation.errors import InputError, UnknownNameError, choices
from linkwork.foundation.names import GROUND
from linkwork.results.motion import Motion
from linkwork.results.position import Position

__all__ = ["LinkMotion", "link_motion", "link_motions"]


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
    if isinstance(of, Motion):
        return of.trace(name), of.trace(f"{name}.d1")
    rate = complex(*(of.first.get(f"{name}.{axis}", np.nan) for axis in "xy"))
    return np.array([complex(*of.points[name])]), np.array([rate])


def _angle(of: Position | Motion, link: str) -> tuple[ComplexArray, Array]:
    """The direction and the rate of a link's own angle, shape (N,)."""
    if isinstance(of, Motion):
        value, rate = of.links[link].value, of.links[link].first
    else:
        value, rate = np.array([of.links[link]]), np.array([of.first.get(link, np.nan)])
    turn: ComplexArray = np.exp(1j * value * of.units.angle.radians)
    return turn, rate


def _direction(
    of: Position | Motion,
    link: str,
    points: tuple[str, ...],
    first: tuple[ComplexArray, ComplexArray],
) -> tuple[ComplexArray, Array]:
    """The direction from a link's first point to another one, and its rate."""
    for place, rate in _places(of, points[1:]):
        along, rates = place - first[0], rate - first[1]
        # two points that coincide in some row give no direction there
        if np.nanmin(np.abs(along), initial=np.inf) > 0.0:
            with np.errstate(invalid="ignore"):  # rows that were not found are NaN, and stay so
                return along / np.abs(along), (rates / along).imag
    raise InputError(
        f'the rotation of link "{link}" is not known: give it two points, or name its angle'
    )


def _places(
    of: Position | Motion, names: tuple[str, ...]
) -> Iterator[tuple[ComplexArray, ComplexArray]]:
    for name in names:
        yield _point(of, name)
