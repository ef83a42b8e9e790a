"""Equations of a cam, given by the follower's law of motion or by its outline."""

from __future__ import annotations

import cmath
import math

import numpy as np

from linkwork.equations.cam_follower import follower_of, program_of
from linkwork.equations.cam_program import Undercut
from linkwork.equations.frames import Place
from linkwork.equations.model import LawEquation, LoopEquation, Term
from linkwork.equations.outline import Outline
from linkwork.equations.part.curve import add_law, on_outline
from linkwork.equations.part_rows import PartRows
from linkwork.expression.tree import Name
from linkwork.foundation.elementwise import phase as phase_of, uniform_value
from linkwork.foundation.names import canonical
from linkwork.foundation.precise import PI, joined, sin_cos
from linkwork.mechanism.description import Key
from linkwork.mechanism.part.cam import Cam
from linkwork.mechanism.part.guide import guide_named
from linkwork.mechanism.part.slider import Slider

__all__ = ["write"]


def write(cam: Cam, key: Key, rows: PartRows) -> None:
    """Write the equations for a given motion or a given outline."""
    (_programmed if cam.segments else _outlined)(rows, cam, key)


def _programmed(rows: PartRows, cam: Cam, key: Key) -> None:
    """A length or an angle of the follower is a function of the cam's angle."""
    frames = rows.frames
    motion = program_of(cam, frames.linkage)
    found = follower_of(cam, frames, motion)
    if isinstance(found, str):
        rows.problems.add((*key, "base"), found)
        return
    start = frames.linkage.numbers.precise_angle(cam.start)
    turned, at = frames.angles_of([(cam.cam, 1.0), (found.frame, -1.0)])
    swung, off = frames.angles_of(found.angles)
    if not turned:
        rows.held(cam.cam, found.frame, (*key, "cam"))
        return
    if not found.length and not swung:
        rows.held(str(cam.link), found.frame, (*key, "link"))
        return
    constant = found.constant + off
    if not found.length:  # equal angles may differ by whole turns
        now = (frames.sketched_sum(swung) + constant).high
        constant = constant - PI * (2.0 * round(now / math.tau))
    weights = {**({found.length: 1.0} if found.length else {}), **swung}
    rows.laws.append(
        LawEquation(
            label=cam.name,
            terms=tuple((canonical(name), weight) for name, weight in weights.items()),
            constant=uniform_value(constant.high),
            law=motion.times(found.sign),
            shown=cam.name,
            meaning=_motion_text(cam, found.sign),
            inner=tuple((canonical(name), weight) for name, weight in turned.items()),
            offset=uniform_value((at - start).high),
            kind="length" if found.length else "angle",
        )
    )
    try:
        outline = found.path.outline() * cmath.exp(-1j * start.high)
    except Undercut as cut:
        where = frames.linkage.angle.from_radians(cut.where)
        roller = " or a smaller roller" if cam.contact == "roller" else ""
        rows.problems.add(
            (*key, "segments"),
            f"undercut the cam {where:.4g} {frames.linkage.angle.value} after their start: "
            f"its outline would intersect itself; use a larger base circle{roller}",
        )
        return
    rows.outlines[cam.name] = (cam.cam, cam.center, outline)


def _outlined(rows: PartRows, cam: Cam, key: Key) -> None:
    """A cam given by its outline."""
    linkage = rows.frames.linkage
    numbers = linkage.numbers
    outline = Outline.through(
        [complex(numbers(x), numbers(y)) for x, y in cam.profile], closed=True
    )
    point = cam.point
    if cam.slider is not None:
        guide = guide_named(linkage, cam.slider)
        assert guide is not None
        point = guide.point_on_line
    assert point is not None
    _check_hollows(rows, cam, outline, (*key, "profile"))
    at = (cam.cam, cam.center)
    if cam.contact == "flat":
        _flat(rows, cam, at, point, outline, key)
        return
    place = on_outline(rows, cam.name, at, point, outline, True)
    if cam.contact == "roller":
        place = _beside(rows, cam, at, point, place, outline)
    rows.put(cam.cam, point, place, key)


def _check_hollows(rows: PartRows, cam: Cam, outline: Outline, key: Key) -> None:
    """Reject concave outlines that a face or large roller would touch at two points."""
    place, bend = outline.deepest()
    where = f"({place.real:.4g}, {place.imag:.4g})"
    if cam.contact == "flat" and bend <= 0.0:
        rows.problems.add(
            key, f"is concave at {where}, where a flat face cannot follow: make it convex"
        )
    size = rows.frames.linkage.numbers(cam.radius)
    if 1.0 + size * bend <= 0.0:
        rows.problems.add(
            key,
            f"is too concave at {where}: its radius of curvature is {-1.0 / bend:.4g}, "
            "smaller than that of the roller",
        )


def _direction(rows: PartRows, name: str, outline: Outline, tangent: Term) -> None:
    """The curve's derivative as a direction times its magnitude T, the speed along the curve."""
    u = np.array([rows.frames.start[name]])
    slopes = {"dx": outline.x.slope(), "dy": outline.y.slope()}
    for axis, law in slopes.items():
        rows.unknown(f"{name}_{axis}", "length", float(law(u)[0]))
        add_law(rows, f"{name} {axis}", f"{name}_{axis}", law, (name, axis[1], 1))
    speed = math.hypot(*(rows.frames.start[f"{name}_{axis}"] for axis in slopes))
    rows.unknown(f"{name}_speed", "length", speed)
    rows.loops.append(
        LoopEquation(
            label=f"{name} direction",
            left=(tangent,),
            right=(
                Term(value=1.0 + 0j, length=canonical(f"{name}_dx")),
                Term(value=1j, turn=math.pi / 2.0, length=canonical(f"{name}_dy")),
            ),
        )
    )


def _beside(
    rows: PartRows, cam: Cam, at: tuple[str, str], point: str, place: Place, outline: Outline
) -> Place:
    """The centre of a roller: offset by its radius along the outward normal β."""
    frames = rows.frames
    radius = frames.linkage.numbers(cam.radius)
    u = np.array([frames.start[cam.name]])
    along = complex(float(outline.x.slope()(u)[0]), float(outline.y.slope()(u)[0]))
    normal = rows.unknown(f"{cam.name}_normal", "angle", phase_of(along / 1j))
    speed = canonical(f"{cam.name}_speed")
    tangent = Term(value=1j, turn=math.pi / 2, length=speed, phase=((normal, 1.0),))
    _direction(rows, cam.name, outline, tangent)
    size = canonical(f"{cam.name}_roller")
    frames.symbols[size] = radius
    arm = frames.vector_term(radius + 0j, Name(size, size), at[0])
    arm = Term(
        value=arm.value,
        magnitude=arm.magnitude,
        sign=arm.sign,
        turn=arm.turn,
        phase=(*arm.phase, (normal, 1.0)),
    )
    return Place(place.fixed, (*place.sliding, arm), base=place.base)


def _flat(
    rows: PartRows, cam: Cam, at: tuple[str, str], point: str, outline: Outline, key: Key
) -> None:
    """A face that touches the outline: common point and common direction."""
    frames, linkage = rows.frames, rows.frames.linkage
    contact = f"{cam.name}_contact"
    place = on_outline(rows, cam.name, at, point, outline, True)
    rows.put(cam.cam, contact, place, key)
    if cam.slider is not None:
        guide = guide_named(linkage, cam.slider)
        assert isinstance(guide, Slider)
        body, base = guide.link, point
        frame, line = guide.on, linkage.shapes.direction(guide.on, guide.line) * 1j
    else:
        assert cam.link is not None
        assert cam.pivot is not None
        body = frame = cam.link
        base = cam.pivot
        line = linkage.shapes.direction(body, (base, point))
    direction = complex(line.high)
    way = f"{cam.name}_way"
    term = frames.vector_term(line, None, frame, way)
    angle, other = frames.angle[frame], frames.angle[cam.cam]
    facing = direction * cmath.exp(1j * (angle.constant - other.constant))
    facing *= cmath.exp(1j * (frames.now(angle) - frames.now(other)))
    away = rows.sketched_in(at[0], cam.center, base)
    outwards = math.copysign(1.0, -(away * (1j * facing).conjugate()).real)
    samples = outline.samples()
    u = float(samples[(outwards * (outline.at(samples) / (1j * facing)).real).argmin()])
    frames.start[cam.name] = u
    here = complex(outline.at(np.array([u]))[0])
    frames.start[f"{cam.name}_x"], frames.start[f"{cam.name}_y"] = here.real, here.imag
    slope = complex(
        float(outline.x.slope()(np.array([u]))[0]), float(outline.y.slope()(np.array([u]))[0])
    )
    sign = 1.0 if (slope * facing.conjugate()).real > 0 else -1.0
    phase: dict[str, float] = {}
    for part, weight in ((angle, 1.0), (other, -1.0)):
        if part.variable is not None:
            symbol = canonical(part.variable)
            phase[symbol] = phase.get(symbol, 0.0) + weight
    sine, cosine = sin_cos(frames.constant[frame] - frames.constant[cam.cam])
    unit = line * joined(cosine, sine) * sign
    tangent = Term.vector(
        unit.high,
        None,
        canonical(f"{cam.name}_speed"),
        tuple((n, w) for n, w in phase.items() if w),
    )
    _direction(rows, cam.name, outline, tangent)
    turned = cmath.exp(1j * (other.constant + frames.now(other)))
    touch = linkage.sketched(cam.center) + here * turned
    face = direction * cmath.exp(1j * (angle.constant + frames.now(angle)))
    start = ((touch - linkage.sketched(base)) * face.conjugate()).real
    rows.unknown(way, "length", start)
    own_place = frames.places[body][base]
    frames.places[body][contact] = Place(own_place.fixed, (*own_place.sliding, term), base=base)


def _motion_text(cam: Cam, sign: float) -> str:
    """The follower's motion in words."""
    parts = [
        f"{part.law} over {part.over}" + (f" by {part.lift}" if part.law != "dwell" else "")
        for part in cam.segments
    ]
    way = "in the negative direction, " if sign < 0 else ""
    return f"{cam.name} is the follower's motion {way}as the cam turns: {', '.join(parts)}"
