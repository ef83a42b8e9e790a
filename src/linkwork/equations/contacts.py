"""Equations of parts in contact: wheels, cams and curves.

Wheels are linear rows. A cam given by its follower's motion ties one variable to a function of the
cam's angle. A point that runs along a curve x(u), y(u) has the variable lengths X, Y in the frame
of the curve's body, and X = x(u), Y = y(u); a roller and a flat face need the curve's direction as
well: T i e^{iβ} = x'(u) + i y'(u).
"""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass, field

import numpy as np

from linkwork.equations.cam_follower import follower_of, program_of
from linkwork.equations.cam_program import Undercut
from linkwork.equations.frames import Frames, Place
from linkwork.equations.model import LawEquation, LinearEquation, LoopEquation, Term
from linkwork.equations.outline import Outline
from linkwork.equations.wheels import wheels_in_mesh
from linkwork.expression.tree import Name
from linkwork.foundation.arrays import ComplexArray
from linkwork.foundation.lanes import settled
from linkwork.foundation.names import canonical
from linkwork.kernels.piecewise import Piecewise
from linkwork.mechanism.description import Problems
from linkwork.mechanism.part.cam import Cam
from linkwork.mechanism.part.curve import Curve
from linkwork.mechanism.part.guide import guide_named
from linkwork.mechanism.part.slider import Slider

__all__ = ["Contacts"]

Key = tuple[str | int, ...]


@dataclass
class Contacts:
    """What contacts add to a linkage whose frames are known.

    ``variables`` are unknowns besides angles of bodies and lengths of slides, (name, kind);
    ``outlines`` cams and curves for pictures: name → (body, centre, points about it in the body's
    frame).
    """

    frames: Frames
    problems: Problems
    loops: list[LoopEquation] = field(default_factory=list)
    linear: list[LinearEquation] = field(default_factory=list)
    laws: list[LawEquation] = field(default_factory=list)
    variables: list[tuple[str, str]] = field(default_factory=list)
    outlines: dict[str, tuple[str, str, ComplexArray]] = field(default_factory=dict)

    @classmethod
    def of(cls, frames: Frames, problems: Problems) -> Contacts:
        """All contacts of a linkage; ``frames`` gets the places and rods that they add."""
        contacts = cls(frames, problems)
        linkage = frames.linkage
        contacts.linear += wheels_in_mesh(frames, problems)
        for k, cam in enumerate(linkage.cams):
            if cam.segments:
                contacts._programmed(cam, ("cams", k))
            else:
                contacts._outlined(cam, ("cams", k))
        for k, curve in enumerate(linkage.curves):
            contacts._curve(curve, ("curves", k))
        return contacts

    # Cams by the motion of their follower

    def _programmed(self, cam: Cam, key: Key) -> None:
        """A length or an angle of the follower is a function of the cam's angle."""
        frames = self.frames
        radians = frames.linkage.angle.radians
        motion = program_of(cam, frames.linkage)
        found = follower_of(cam, frames, motion)
        if isinstance(found, str):
            self.problems.add((*key, "base"), found)
            return
        start = frames.linkage.numbers(cam.start) * radians
        turned, at = frames.angles_of([(cam.cam, 1.0), (found.frame, -1.0)])
        swung, off = frames.angles_of(found.angles)
        if not turned:
            self._held(cam.cam, found.frame, (*key, "cam"))
            return
        if not found.length and not swung:
            self._held(str(cam.link), found.frame, (*key, "link"))
            return
        constant = found.constant + off
        if not found.length:  # the same angle may be so many turns away
            now = sum(weight * frames.start[name] for name, weight in swung.items())
            constant -= math.tau * round((now + constant) / math.tau)
        weights = {**({found.length: 1.0} if found.length else {}), **swung}
        self.laws.append(
            LawEquation(
                label=cam.name,
                terms=tuple((canonical(name), weight) for name, weight in weights.items()),
                constant=settled(constant),
                law=motion.times(found.sign),
                shown=cam.name,
                meaning=_motion_text(cam, found.sign),
                inner=tuple((canonical(name), weight) for name, weight in turned.items()),
                offset=settled(at - start),
                kind="length" if found.length else "angle",
            )
        )
        try:
            outline = found.path.outline() * cmath.exp(-1j * start)
        except Undercut as cut:
            where = frames.linkage.angle.from_radians(cut.where)
            roller = " or a smaller roller" if cam.contact == "roller" else ""
            self.problems.add(
                (*key, "segments"),
                f"undercut the cam {where:.4g} {frames.linkage.angle.value} after they begin: "
                f"its outline would cut into itself; take a larger base circle{roller}",
            )
            return
        self.outlines[cam.name] = (cam.cam, cam.center, outline)

    def _held(self, link: str, frame: str, key: Key) -> None:
        self.problems.add(
            key, f'"{link}" cannot turn against "{frame}": a slider or a weld holds its angle'
        )

    # Curves

    def _curve(self, curve: Curve, key: Key) -> None:
        numbers = self.frames.linkage.numbers
        points = [complex(numbers(x), numbers(y)) for x, y in curve.through]
        outline = Outline.through(points, closed=curve.closed)
        place = self._on_outline(
            curve.name, (curve.on, curve.origin), curve.point, outline, curve.closed
        )
        self._put(curve.on, curve.point, place, key)

    def _outlined(self, cam: Cam, key: Key) -> None:
        """A cam by its outline."""
        linkage = self.frames.linkage
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
        self._check_hollows(cam, outline, (*key, "profile"))
        at = (cam.cam, cam.center)
        if cam.contact == "flat":
            self._flat(cam, at, point, outline, key)
            return
        place = self._on_outline(cam.name, at, point, outline, True)
        if cam.contact == "roller":
            place = self._beside(cam, at, point, place, outline)
        self._put(cam.cam, point, place, key)

    def _check_hollows(self, cam: Cam, outline: Outline, key: Key) -> None:
        """A face or a large roller bridges a hollow and would touch it in two places."""
        place, bend = outline.deepest()
        where = f"({place.real:.4g}, {place.imag:.4g})"
        if cam.contact == "flat" and bend <= 0.0:
            self.problems.add(
                key, f"is hollow at {where}: a flat face bridges it; round the outline there"
            )
        size = self.frames.linkage.numbers(cam.radius)
        if 1.0 + size * bend <= 0.0:
            self.problems.add(
                key,
                f"is too hollow at {where}: its radius there is {-1.0 / bend:.4g}, smaller than "
                "that of the roller",
            )

    def _put(self, body: str, point: str, place: Place, key: Key) -> None:
        if point in self.frames.places[body]:
            self.problems.add(key, f'point "{point}" is led by "{body}" already')
            return
        self.frames.places[body][point] = place

    def _sketched_in(self, body: str, origin: str, point: str) -> complex:
        """Where the sketch has a point in a body's frame, about a point of it."""
        frames = self.frames
        turned = frames.angle[body].constant + frames.now(frames.angle[body])
        linkage = frames.linkage
        return (linkage.sketched(point) - linkage.sketched(origin)) * cmath.exp(-1j * turned)

    def _unknown(self, name: str, kind: str, start: float) -> str:
        """Another unknown; its symbol."""
        self.variables.append((name, kind))
        self.frames.start[name] = start
        return canonical(name)

    def _law(
        self, label: str, coordinate: str, law: Piecewise, shown: tuple[str, str, int]
    ) -> None:
        """coordinate - law(u) = 0; ``shown``: the curve, x or y, and which derivative."""
        name, axis, primes = shown
        count, called = len(law.breaks) - 1, f"{axis}_{name}"
        spline = f"{called} is the curve's {axis}, a cubic spline of {count} pieces"
        slope = f"{called}' is the derivative of {called}"
        self.laws.append(
            LawEquation(
                label=label,
                terms=((canonical(coordinate), 1.0),),
                constant=0.0,
                law=law,
                shown=f"{axis}_{canonical(name)}",
                inner=((canonical(name), 1.0),),
                offset=0.0,
                meaning=slope if primes else spline,
                primes=primes,
            )
        )

    def _on_outline(
        self, name: str, at: tuple[str, str], point: str, outline: Outline, closed: bool
    ) -> Place:
        """The place of a point on a curve of a body: its centre, then X and Y in its frame."""
        body, origin = at
        frames = self.frames
        u = outline.nearest(self._sketched_in(body, origin, point))
        self._unknown(name, "angle" if closed else "length", u)
        here = complex(outline.at(np.array([u]))[0])
        terms = []
        for axis, start, law, unit in (
            ("x", here.real, outline.x, 1.0 + 0j),
            ("y", here.imag, outline.y, 1j),
        ):
            coordinate = f"{name}_{axis}"
            self._unknown(coordinate, "length", start)
            terms.append(frames.turned(unit, None, body, coordinate))
            self._law(f"{name} {axis}", coordinate, law, (name, axis, 0))
        self.outlines[name] = (body, origin, outline.at(outline.samples()))
        return Place(frames.places[body][origin].fixed, tuple(terms), base=origin)

    def _direction(self, name: str, outline: Outline, tangent: Term) -> None:
        """T times a direction is the curve's derivative; T itself is the speed along it."""
        u = np.array([self.frames.start[name]])
        slopes = {"dx": outline.x.slope(), "dy": outline.y.slope()}
        for axis, law in slopes.items():
            self._unknown(f"{name}_{axis}", "length", float(law(u)[0]))
            self._law(f"{name} {axis}", f"{name}_{axis}", law, (name, axis[1], 1))
        speed = math.hypot(*(self.frames.start[f"{name}_{axis}"] for axis in slopes))
        self._unknown(f"{name}_speed", "length", speed)
        self.loops.append(
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
        self, cam: Cam, at: tuple[str, str], point: str, place: Place, outline: Outline
    ) -> Place:
        """The centre of a roller: its radius further along the outward normal β."""
        frames = self.frames
        radius = frames.linkage.numbers(cam.radius)
        u = np.array([frames.start[cam.name]])
        along = complex(float(outline.x.slope()(u)[0]), float(outline.y.slope()(u)[0]))
        normal = self._unknown(f"{cam.name}_normal", "angle", cmath.phase(along / 1j))
        speed = canonical(f"{cam.name}_speed")
        tangent = Term(value=1j, turn=math.pi / 2, length=speed, phase=((normal, 1.0),))
        self._direction(cam.name, outline, tangent)
        size = canonical(f"{cam.name}_roller")
        frames.symbols[size] = radius
        arm = frames.turned(radius + 0j, Name(size, size), at[0])
        arm = Term(
            value=arm.value,
            magnitude=arm.magnitude,
            sign=arm.sign,
            turn=arm.turn,
            phase=(*arm.phase, (normal, 1.0)),
        )
        return Place(place.fixed, (*place.sliding, arm), base=place.base)

    def _flat(self, cam: Cam, at: tuple[str, str], point: str, outline: Outline, key: Key) -> None:
        """A face that touches the outline: common point and common direction."""
        frames, linkage = self.frames, self.frames.linkage
        contact = f"{cam.name}_contact"
        place = self._on_outline(cam.name, at, point, outline, True)
        self._put(cam.cam, contact, place, key)
        if cam.slider is not None:
            guide = guide_named(linkage, cam.slider)
            assert isinstance(guide, Slider)
            body, base = guide.link, point
            a, b = (linkage.shapes.local[guide.on][p] for p in guide.line)
            frame, direction = guide.on, 1j * (b - a) / abs(b - a)
        else:
            assert cam.link is not None
            assert cam.pivot is not None
            body = frame = cam.link
            base = cam.pivot
            own = linkage.shapes.local[body]
            direction = (own[point] - own[base]) / abs(own[point] - own[base])
        way = f"{cam.name}_way"
        term = frames.turned(direction, None, frame, way)
        angle, other = frames.angle[frame], frames.angle[cam.cam]
        facing = direction * cmath.exp(1j * (angle.constant - other.constant))
        facing *= cmath.exp(1j * (frames.now(angle) - frames.now(other)))
        away = self._sketched_in(at[0], cam.center, base)
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
        unit = sign * direction * cmath.exp(1j * (angle.constant - other.constant))
        tangent = Term.vector(
            unit, None, canonical(f"{cam.name}_speed"), tuple((n, w) for n, w in phase.items() if w)
        )
        self._direction(cam.name, outline, tangent)
        turned = cmath.exp(1j * (other.constant + frames.now(other)))
        touch = linkage.sketched(cam.center) + here * turned
        face = direction * cmath.exp(1j * (angle.constant + frames.now(angle)))
        start = ((touch - linkage.sketched(base)) * face.conjugate()).real
        self._unknown(way, "length", start)
        own_place = frames.places[body][base]
        frames.places[body][contact] = Place(own_place.fixed, (*own_place.sliding, term), base=base)


def _motion_text(cam: Cam, sign: float) -> str:
    """The follower's motion in words."""
    parts = [
        f"{part.law} over {part.over}" + (f" by {part.lift}" if part.law != "dwell" else "")
        for part in cam.segments
    ]
    way = "against the direction of its measure, " if sign < 0 else ""
    return f"{cam.name} is the follower's motion {way}as the cam turns: {', '.join(parts)}"
