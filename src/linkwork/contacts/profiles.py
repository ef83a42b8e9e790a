"""Profiles of cams, and splines."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import accumulate
from typing import Any

import numpy as np

from linkwork.contacts.cams import Cam, follower_frame
from linkwork.core.equations.frames import Frames
from linkwork.core.foundation.arrays import AnyArray, Array, ComplexArray
from linkwork.core.foundation.lanes import copysign, plain_value
from linkwork.core.foundation.precise import PI, Precise, acos, asin, phase, precise, sqrt
from linkwork.core.mechanism.inputs import pieces_of
from linkwork.core.mechanism.linkage import Linkage
from linkwork.core.mechanism.part.guides import GuidePart, Slider, guide_named
from linkwork.core.table.rows import Piecewise

# ----------------------------------------------------------------------
# Smooth curves through given points: cubic splines parametrised by chord length.


_OUTLINE_SAMPLES = 16  # samples per piece for the nearest point
_FINE = 64  # samples per piece for the smallest curvature


@dataclass(frozen=True, kw_only=True, eq=False)
class Outline:
    """x(u) and y(u); u is an angle from 0 to 2π if the curve is closed, else chord length."""

    x: Piecewise
    y: Piecewise

    @classmethod
    def through(cls, points: Sequence[complex], *, closed: bool) -> Outline:
        """The curve through points in order.

        A closed curve has two continuous derivatives everywhere and is counter-clockwise; an open
        curve has no curvature at its ends and continues straight ("natural" spline).
        """
        z = np.array(points)
        if closed:
            # twice the area: negative if the points run clockwise
            area = (z.conj() * np.roll(z, -1)).imag.sum()
            z = z if area >= 0 else np.concatenate([z[:1], z[:0:-1]])
            z = np.append(z, z[0])
        chords = abs(_differences(_exactly(z)))
        sums = list(accumulate(map(Precise, chords.high, chords.low), initial=Precise(0.0)))
        if closed:
            turn = PI * 2.0 / sums[-1]
            # the last one exactly, so that the period is one turn
            sums = [*(part * turn for part in sums[:-1]), PI * 2.0]
        u = Precise(*np.array([(part.high, part.low) for part in sums]).T)
        return cls(x=spline(u, z.real, closed), y=spline(u, z.imag, closed))

    def at(self, u: Array) -> ComplexArray:
        """Points x + iy."""
        z: ComplexArray = self.x(u) + 1j * self.y(u)
        return z

    def samples(self, count: int = 0) -> Array:
        """Parameters along the whole curve, both ends included."""
        breaks = self.x.breaks
        return np.linspace(breaks[0], breaks[-1], count or _OUTLINE_SAMPLES * (len(breaks) - 1) + 1)

    def slope(self, u: float) -> complex:
        """The derivative of the point by the parameter, x' + iy'."""
        at = np.array([u])
        return complex(float(self.x.slope()(at)[0]), float(self.y.slope()(at)[0]))

    def bend(self, u: Array) -> Array:
        """Curvature [1/length], positive where the curve turns to the left."""
        x, y = self.x.jet(u), self.y.jet(u)
        across: Array = x[1] * y[2] - y[1] * x[2]
        bend: Array = across / np.hypot(x[1], y[1]) ** 3
        return bend

    def deepest(self) -> tuple[complex, float]:
        """Parameter of the smallest (most concave) curvature of a closed curve, and this curvature.

        The minimum of 64 samples per piece; it is not proved.
        """
        u = self.samples(_FINE * (len(self.x.breaks) - 1) + 1)
        bend = self.bend(u)
        k = int(bend.argmin())
        return complex(self.at(u[k : k + 1])[0]), float(bend[k])

    def nearest(self, point: complex) -> float:
        """The parameter of the sample nearest to a point."""
        u = self.samples()
        return float(u[np.abs(self.at(u) - plain_value(point)).argmin()])


def spline(u: Array | Precise, values: Array, closed: bool) -> Piecewise:
    """The cubic spline with two continuous derivatives (de Boor, A Practical Guide to Splines).

    Its coefficients are rounded once.
    """
    u = u if isinstance(u, Precise) else _exactly(u)
    h = _differences(u)
    chords = _differences(_exactly(values)) / h
    low, high = (_each(h, np.roll, 1), h) if closed else (h.part(slice(-1)), h.part(slice(1, None)))
    bent = chords - _each(chords, np.roll, 1) if closed else _differences(chords)
    middle, ends = (low + high) * 2.0, (0, 1) if closed else (1, 1)
    solve = _solve_cyclic if closed else _solve_open
    second = _exactly(np.zeros(len(bent.high)))
    for _ in range(2):  # once, and for what rounding has left
        around = _each(second, np.pad, 1, "wrap" if closed else "constant")
        before, after = around.part(slice(-2)), around.part(slice(2, None))
        left = bent * 6.0 - (low * before + middle * second + high * after)  # eq. (69)
        second = second + solve(low.high, middle.high, high.high, left.high)
    second = _each(second, np.pad, ends, "wrap" if closed else "constant")
    begin, end = second.part(slice(-1)), second.part(slice(1, None))
    slope = chords - h * (begin * 2.0 + end) / 6.0
    powers = [values[:-1], slope.high, begin.high / 2.0, ((end - begin) / (h * 6.0)).high]
    none = np.zeros((len(powers[0]), 3))
    return Piecewise(breaks=u.high, powers=np.stack(powers, axis=1), sines=none, periodic=closed)


def _exactly(numbers: AnyArray) -> Precise:
    return Precise(numbers, np.zeros_like(numbers))


def _each(numbers: Precise, change: Callable[..., Any], *how: object) -> Precise:
    """Both parts of numbers moved to other places."""
    return Precise(change(numbers.high, *how), change(numbers.low, *how))


def _differences(numbers: Precise) -> Precise:
    return numbers.part(slice(1, None)) - numbers.part(slice(-1))


def _solve_open(low: Array, middle: Array, high: Array, right: Array) -> Array:
    return _solve_tridiagonal(low, middle, high, right[:, None])[:, 0]


def _solve_tridiagonal(low: Array, middle: Array, high: Array, right: Array) -> Array:
    """x (K, R) of low_k x_{k-1} + middle_k x_k + high_k x_{k+1} = right_k, (K, R).

    Elimination without pivoting, since the matrix is diagonally dominant.
    """
    middle, right = middle.copy(), right.copy()
    for k in range(1, len(middle)):
        factor = low[k] / middle[k - 1]
        middle[k] -= factor * high[k - 1]
        right[k] -= factor * right[k - 1]
    for k in range(len(middle) - 1, -1, -1):
        if k + 1 < len(middle):
            right[k] -= high[k] * right[k + 1]
        right[k] /= middle[k]
    return right


def _solve_cyclic(low: Array, middle: Array, high: Array, right: Array) -> Array:
    """Solve the cyclic system, in which the first and the last unknown are neighbours: x (K,)."""
    corner = np.zeros(len(middle) - 1)
    corner[0], corner[-1] = low[0], corner[-1] + high[-2]
    inner = np.stack([right[:-1], corner], axis=1)
    own, by_last = _solve_tridiagonal(low[:-1], middle[:-1], high[:-1], inner).T
    last = right[-1] - low[-1] * own[-1] - high[-1] * own[0]
    last /= middle[-1] - low[-1] * by_last[-1] - high[-1] * by_last[0]
    return np.append(own - by_last * last, last)


# ----------------------------------------------------------------------
# The motion of a cam's follower over one turn of the cam, and the resulting outline.


_CAM_PROGRAM_SAMPLES = 1440  # points of the drawn outline
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
        drawn = np.linspace(0.0, 2.0 * np.pi, _CAM_PROGRAM_SAMPLES, endpoint=False)
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


# ----------------------------------------------------------------------
# Followers of cams given by the follower's motion: position over the cam's angle.


@dataclass(frozen=True, kw_only=True, eq=False)
class Follower:
    """``length`` + Σ weight · angle of body + ``constant`` = ``sign`` · motion(cam's angle).

    ``frame`` is the link on which cam and follower move; ``path`` the motion of the follower around
    the cam.
    """

    path: FollowerPath
    frame: str
    constant: Precise
    sign: float
    length: str = ""
    angles: tuple[tuple[str, float], ...] = ()


def program_of(cam: Cam, linkage: Linkage) -> Piecewise:
    """The follower's motion over one turn, [length] or [rad]."""
    numbers = linkage.numbers
    lift = numbers.precise_angle if cam.slider is None else numbers.precise
    return program(
        [(part.law, numbers.precise_angle(part.over), lift(part.lift)) for part in cam.segments]
    )


def follower_of(cam: Cam, frames: Frames, motion: Piecewise) -> Follower | str:
    """The follower of a cam; raises an error if the base circle does not fit."""
    if cam.slider is None:
        return _swinging(cam, frames, motion)
    guide = guide_named(frames.linkage, cam.slider)
    assert guide is not None
    return _sliding(cam, guide, frames, motion)


def _sliding(cam: Cam, guide: GuidePart, frames: Frames, motion: Piecewise) -> Follower | str:
    """s = foot ± (√((base + roller)² - e²) + motion), a flat face s = foot ± (base + motion)."""
    linkage = frames.linkage
    numbers, shapes = linkage.numbers, linkage.shapes
    direction = shapes.direction(guide.on, guide.line)
    origin = shapes.place(guide.on, guide.line[0])
    center = (shapes.place(guide.on, cam.center) - origin) * direction.conjugate()
    offset = numbers.precise(guide.offset if isinstance(guide, Slider) else 0)
    away = offset - center.imag
    reach = numbers.precise(cam.base or 0) + numbers.precise(cam.radius)
    roller = numbers(cam.radius)
    sign = plain_value(copysign(1.0, frames.start[guide.name] - center.high.real))
    flat = cam.contact == "flat"
    between = abs(away)
    if not flat and (reach - between).high <= 0.0:
        return (
            f"is too small: the follower passes the centre at a distance of {between.high:.6g}, "
            f"the base circle{' with the roller' if roller else ''} reaches only {reach.high:.6g}"
        )
    foot = numbers.precise(cam.base or 0) if flat else sqrt((reach - between) * (reach + between))
    # designs without a common outline are built one at a time
    low = foot.high if flat else float(foot.high)
    along, e = direction.high, away.high
    deepest = float(motion(motion.breaks).min())
    if low + deepest <= 0.0:
        return (
            f"is too small: the segments move the follower {-deepest:.6g} towards the cam's "
            f"centre, which is only {low:.6g} away"
        )

    def place(s: Array, s1: Array, s2: Array) -> tuple[ComplexArray, ...]:
        path: list[ComplexArray] = [
            np.asarray(along * way, dtype=complex)
            for way in (sign * (low + s) + 1j * e, sign * s1, sign * s2)
        ]
        if not flat:
            return tuple(path)
        return (*path, np.full(len(s), 1j * along), np.zeros(len(s), dtype=complex))

    return Follower(
        path=FollowerPath(motion=motion, place=place, roller=roller, flat=flat),
        frame=guide.on,
        constant=-(center.real + foot * sign),
        sign=sign,
        length=guide.name,
    )


def _swinging(cam: Cam, frames: Frames, motion: Piecewise) -> Follower | str:
    """Angle of the arm = angle of pivot-centre ± (angle on the base circle + motion)."""
    linkage = frames.linkage
    numbers = linkage.numbers
    assert cam.link is not None
    assert cam.pivot is not None
    assert cam.point is not None
    frame = follower_frame(linkage, cam)
    shapes = linkage.shapes
    arm = shapes.place(cam.link, cam.point) - shapes.place(cam.link, cam.pivot)
    line = shapes.place(frame, cam.center) - shapes.place(frame, cam.pivot)
    base, roller = numbers.precise(cam.base or 0), numbers(cam.radius)
    along, across = abs(arm), abs(line)
    flat = cam.contact == "flat"
    reach = base + numbers.precise(cam.radius)
    # each quotient is finite, unlike squares of large lengths
    cosine = (along / across + across / along - reach / along * (reach / across)) * 0.5
    a, d = along.high, across.high
    if (flat and base.high >= d) or (not flat and abs(cosine.high) >= 1.0):
        return (
            f"does not fit: a follower whose arm of {a:.6g} swings about a pivot {d:.6g} away from "
            f"the cam's centre cannot touch a circle of {reach.high:.6g}"
        )
    begin = asin(base / across) if flat else acos(cosine)
    low = float(begin.high)  # designs without a common outline are built one at a time
    swing = low + motion(motion.breaks)
    # across the line of centres the angle would be that of the mirrored follower
    if swing.min() <= 0.0 or swing.max() >= math.pi:
        unit = linkage.angle
        return (
            f"does not fit: there the arm is at {unit.from_radians(low):.6g} {unit.value} from "
            "the line from the pivot to the cam's centre, and the segments swing it across that "
            "line"
        )
    pivot, center, tip = (linkage.sketched(q) for q in (cam.pivot, cam.center, cam.point))
    sign = plain_value(copysign(1.0, ((tip - pivot) * (center - pivot).conjugate()).imag))
    way_of_centres = phase(line)
    ground = line.high

    def place(s: Array, s1: Array, s2: Array) -> tuple[ComplexArray, ...]:
        way = np.exp(1j * (way_of_centres.high + sign * (low + s)))
        nothing = np.zeros(len(s), dtype=complex)
        if flat:
            return nothing - ground, nothing, nothing, way, 1j * sign * s1 * way
        return (
            a * way - ground,
            1j * sign * a * s1 * way,
            a * way * (1j * sign * s2 - s1**2),
        )

    return Follower(
        path=FollowerPath(motion=motion, place=place, roller=roller, flat=flat),
        frame=frame,
        constant=phase(arm) - way_of_centres - begin * sign,
        sign=sign,
        angles=((cam.link, 1.0), (frame, -1.0)),
    )
