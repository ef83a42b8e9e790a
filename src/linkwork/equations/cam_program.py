"""The motion of a cam's follower over one turn of the cam, and the resulting outline."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from linkwork.foundation.arrays import Array, ComplexArray
from linkwork.foundation.precise import PI, Precise, precise
from linkwork.kernels.piecewise import Piecewise
from linkwork.mechanism.motion_laws import pieces_of

__all__ = ["FollowerPath", "Undercut", "program"]

_SAMPLES = 1440  # points of the drawn outline
_PARTS = 16  # additional checks of the outline per piece of the motion


def program(segments: Sequence[tuple[str, float | Precise, float | Precise]]) -> Piecewise:
    """The follower's motion as a function of the cam's angle from 0 to 2π.

    ``segments``: law, angle of the cam [rad] and lift, in order. Angles are scaled to a total of
    one turn and the last lift is adjusted to return the follower, so that the function is periodic;
    the given numbers must nearly satisfy this.
    """
    breaks, powers, sines, height = [Precise(0.0)], [], [], Precise(0.0)
    exact = [(law, precise(over), precise(lift)) for law, over, lift in segments]
    stretch = PI * 2.0 / sum((over for _, over, _ in exact), Precise(0.0))
    last = max((k for k, (_, _, lift) in enumerate(exact) if lift.high), default=-1)
    for number, (law, given, rise) in enumerate(exact):
        # the last rise closes the motion, since sums of given lifts are rounded
        over, lift = given * stretch, -height if number == last else rise
        begin = breaks[-1]
        done = 0.0
        for piece in pieces_of(law):
            done += piece.over
            breaks.append(begin + over * min(done, 1.0))
            row = np.zeros(8)
            factor = lift
            for k, c in enumerate(piece.powers):
                row[k] = (factor * c + (height if k == 0 else 0.0)).high
                factor = factor / over
            powers.append(row)
            a, w, p = piece.sine
            sines.append(((lift * a).high, (w / over).high, p))
        height = height + lift
    rounded = np.array([place.high for place in breaks])
    # exactly one turn
    rounded[-1] = 2.0 * math.pi
    return Piecewise(breaks=rounded, powers=np.array(powers), sines=np.array(sines))


class Undercut(Exception):
    """The outline would intersect itself at the cam angle ``where`` [rad]."""

    def __init__(self, where: float) -> None:
        super().__init__(where)
        self.where = where


@dataclass(frozen=True, kw_only=True, eq=False)
class FollowerPath:
    """The motion of a follower around a cam turned by φ, relative to the cam's centre on the frame.

    Parameters
    ----------
    motion : Piecewise
        The follower's displacement or angle over the cam's turn.
    place : callable
        Maps the motion and its first and second derivative with respect to φ (K,) to the point w
        and its derivatives w', w'' (K,), for a flat face also to its direction and the derivative.
    roller : float
        Radius of the roller, 0 for a knife edge.
    flat : bool
    """

    motion: Piecewise
    place: Callable[[Array, Array, Array], tuple[ComplexArray, ...]]
    roller: float = 0.0
    flat: bool = False

    def outline(self) -> ComplexArray:
        """The cam's outline in its frame about its centre, at φ = 0, (K,).

        Raises
        ------
        Undercut
            If no outline produces this motion.

        Notes ----- Undercut is checked at every quarter of a degree of the cam's angle and sixteen
        times in every piece of the motion; between these samples it is not detected. Nothing is
        proved.
        """
        drawn = np.linspace(0.0, 2.0 * np.pi, _SAMPLES, endpoint=False)
        pieces = np.diff(self.motion.breaks)[:, None] * (np.arange(_PARTS) + 0.5) / _PARTS
        phi = np.union1d(drawn, self.motion.breaks[:-1, None] + pieces)
        surface = self._face(phi) if self.flat else self._beside(phi)
        return surface[np.isin(phi, drawn)]

    def _beside(self, phi: Array) -> ComplexArray:
        """The outline for a knife edge or roller: a parallel curve to the path of its centre."""
        back = np.exp(-1j * phi)
        w, w1, w2 = self.place(*self.motion.jet(phi))
        z, z1 = w * back, (w1 - 1j * w) * back
        z2 = (w2 - 2j * w1 - w) * back
        # the path is clockwise around the centre, so it is convex where it bends clockwise
        speed = np.abs(z1)
        # divided one by one: powers of large lengths overflow
        bend = -(z1.conj() / speed * (z2 / speed)).imag / speed
        if self.roller:
            worst = int(bend.argmax())
            if bend[worst] * self.roller >= 1.0:
                raise Undercut(float(phi[worst]))
        surface: ComplexArray = z - self.roller * 1j * z1 / speed  # eq. (66)
        return surface

    def _face(self, phi: Array) -> ComplexArray:
        """The outline for a flat face: its envelope."""
        back = np.exp(-1j * phi)
        w, w1, _, d, d1 = self.place(*self.motion.jet(phi))
        z1 = w1 - 1j * w
        turned = (d.conj() * (d1 - 1j * d)).imag  # angular rate of the face relative to the cam
        still = np.flatnonzero(turned >= 0.0)
        if len(still):
            raise Undercut(float(phi[still[0]]))
        surface: ComplexArray = (w - (d.conj() * z1).imag / turned * d) * back  # eq. (67)
        ways = ((np.roll(surface, -1) - np.roll(surface, 1)) * (d * back).conj()).real
        # the contact moves along the face in one direction; where it reverses, the envelope is
        # undercut
        majority = np.sign(np.median(ways))
        wrong = np.flatnonzero(ways * majority <= 0.0)
        if len(wrong):
            raise Undercut(float(phi[wrong[0]]))
        return surface
