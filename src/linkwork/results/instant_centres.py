"""Instant centres, at which two links have the same velocity, and centrodes.

A link's points move at ``v(z) = a + iωz``, so links 1 and 2 agree at
``z = i (a₁ - a₂) / (ω₁ - ω₂)``. Of three links, the three centres lie in one line: the theorem of
Aronhold and Kennedy.

References
----------
R. L. Norton, Design of Machinery, 6th ed., McGraw-Hill 2020, sections 6.3 and 6.4.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations

import numpy as np

from linkwork.foundation.arrays import ComplexArray
from linkwork.foundation.errors import InputError
from linkwork.foundation.names import GROUND
from linkwork.results.link_motion import LinkMotion, link_motion, link_motions
from linkwork.results.motion import Motion
from linkwork.results.position import Position

__all__ = ["Centrodes", "InstantCentre", "centrodes", "instant_centres"]

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
