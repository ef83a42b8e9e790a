"""Followers of cams given by the follower's motion: position over the cam's angle."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from linkwork.equations.cam_program import FollowerPath, program
from linkwork.equations.frames import Frames
from linkwork.foundation.arrays import Array, ComplexArray
from linkwork.foundation.elementwise import copysign, phase, plain_value
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
    constant: float
    sign: float
    length: str = ""
    angles: tuple[tuple[str, float], ...] = ()


def program_of(cam: Cam, linkage: Linkage) -> Piecewise:
    """The follower's motion over one turn, [length] or [rad]."""
    numbers, radians = linkage.numbers, linkage.angle.radians
    scale = 1.0 if cam.slider is not None else radians
    return program(
        [
            (part.law, numbers(part.over) * radians, numbers(part.lift) * scale)
            for part in cam.segments
        ]
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
    numbers = linkage.numbers
    local = linkage.shapes.local[guide.on]
    a, b = (local[p] for p in guide.line)
    along: complex = (b - a) / abs(b - a)
    center = (local[cam.center] - a) * along.conjugate()
    offset = numbers(guide.offset) if isinstance(guide, Slider) else 0.0
    e = offset - center.imag
    base, roller = numbers(cam.base or 0), numbers(cam.radius)
    sign = plain_value(copysign(1.0, frames.start[guide.name] - center.real))
    flat = cam.contact == "flat"
    if not flat and base + roller <= abs(e):
        return (
            f"is too small: the follower passes the centre at a distance of {abs(e):.6g}, the "
            f"base circle{' with the roller' if roller else ''} reaches only {base + roller:.6g}"
        )
    # the difference of squares in two factors, which do not overflow
    reach = base + roller
    low = base if flat else math.sqrt(reach - abs(e)) * math.sqrt(reach + abs(e))
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
        constant=-(center.real + sign * low),
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
    local, own = linkage.shapes.local[frame], linkage.shapes.local[cam.link]
    arm = own[cam.point] - own[cam.pivot]
    ground = local[cam.center] - local[cam.pivot]
    base, roller = numbers(cam.base or 0), numbers(cam.radius)
    a, d = abs(arm), abs(ground)
    flat = cam.contact == "flat"
    reach = base + roller
    cosine = 0.5 * (a / d + d / a - reach / a * (reach / d))
    if (flat and base >= d) or (not flat and abs(cosine) >= 1.0):
        return (
            f"does not fit: a follower whose arm of {a:.6g} swings about a pivot {d:.6g} away from "
            f"the cam's centre cannot touch a circle of {base + roller:.6g}"
        )
    low = math.asin(base / d) if flat else math.acos(cosine)
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
    line = phase(ground)

    def place(s: Array, s1: Array, s2: Array) -> tuple[ComplexArray, ...]:
        way = np.exp(1j * (line + sign * (low + s)))
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
        constant=phase(arm) - line - sign * low,
        sign=sign,
        angles=((cam.link, 1.0), (frame, -1.0)),
    )
