"""Followers of cams given by the follower's motion: position over the cam's angle."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from linkwork.equations.cam_program import FollowerPath, program
from linkwork.equations.frames import Frames
from linkwork.foundation.arrays import Array, ComplexArray
from linkwork.foundation.elementwise import copysign, plain_value
from linkwork.foundation.precise import Precise, acos, asin, phase, sqrt
from linkwork.kernels.piecewise import Piecewise
from linkwork.mechanism.linkage import Linkage
from linkwork.mechanism.part.cam import Cam, follower_frame
from linkwork.mechanism.part.guide import GuidePart, guide_named
from linkwork.mechanism.part.slider import Slider

__all__ = ["Follower", "follower_of", "program_of"]


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
    reach, roller = (
        numbers.precise(cam.base or 0) + numbers.precise(cam.radius),
        numbers(cam.radius),
    )
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
