"""Places and directions of bodies in positions, and how far they may be from them in boxes."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from linkwork.core.foundation.arrays import Array, ComplexArray
from linkwork.core.foundation.errors import InputError
from linkwork.core.foundation.names import GROUND
from linkwork.core.mechanism.bodies import DiscFigure
from linkwork.core.mechanism.linkage import Linkage
from linkwork.core.mechanism.part.part import Pair, PairKind, Part
from linkwork.core.motion.extremes import Boxes, motions_of_points, variables_of
from linkwork.core.motion.model import Model
from linkwork.core.results.motion import Motion
from linkwork.forces.reactions.geometry import Geometry

_SLACK = 1.0 + 1e-9  # covers the rounding of a few products


def variables_of_all(model: Model, motion: Motion) -> Array:
    """All variables of the mechanism with its inputs, also where time drives it, (B, N)."""
    if model.untimed is not None:
        return Geometry(model, motion).variables[motion.found]
    return variables_of(model, motion)


class BodyPoses:
    """Places and directions of bodies in positions, and how far they may be in boxes.

    Parameters
    ----------
    model : Model
    first : Mapping[str, str]
        The link in whose frame a body is described, by body.
    millimetres : float
        Per length unit of the file.
    """

    def __init__(self, model: Model, first: Sequence[str], millimetres: float) -> None:
        self.model, self.millimetres = model.untimed or model, millimetres
        self.bodies = [body for body in first if body != GROUND]
        equations = self.model.equations
        numbered = tuple(enumerate(equations.variables))
        index = {v.symbol: k for k, v in numbered} | {v.name: k for k, v in numbered}
        angles = {body: equations.links[body] for body in self.bodies}
        self._angle = {
            body: (None if angle.variable is None else index[angle.variable], angle.constant)
            for body, angle in angles.items()
        }

    @cached_property
    def _origin(self) -> Mapping[str, int]:
        """The number of the first point of every body."""
        links = self.model.description.links  # type: ignore[attr-defined]
        names = self.model.compiled.points.names
        return {body: names.index(links[body][0]) for body in self.bodies}

    def of(self, v: Array) -> dict[str, tuple[ComplexArray, ComplexArray]]:
        """Origin [mm] and direction of every body in positions (B, N)."""
        places = self.millimetres * self.model.compiled.points.places(v)
        one = np.ones(len(v), dtype=complex)
        poses: dict[str, tuple[ComplexArray, ComplexArray]] = {GROUND: (one - one, one)}
        for body in self.bodies:
            k, constant = self._angle[body]
            turn = np.full(len(v), constant) if k is None else constant + v[:, k]
            poses[body] = (places[:, self._origin[body]], np.cos(turn) + 1j * np.sin(turn))
        return poses

    @np.errstate(all="ignore")  # bounds of boxes without a proof are infinite
    def spread(self, boxes: Boxes) -> dict[str, tuple[Array, Array]]:
        """How far every body's origin moves [mm] and turns [rad] at most in boxes, (B,) each."""
        points = self.millimetres * motions_of_points(self.model, boxes).moved
        nothing = np.zeros(len(boxes))
        spreads = {GROUND: (nothing, nothing)}
        for body in self.bodies:
            k, _ = self._angle[body]
            turn = nothing if k is None else boxes.bound[:, k] * _SLACK
            spreads[body] = (points[:, self._origin[body]], np.minimum(turn, math.pi))
        return spreads


# ----------------------------------------------------------------------
# Rigid bodies to be made of plates, and the straight slots in which bodies slide.


_TOGETHER = 1e-9  # of a distance
#: Origin [mm] and direction of links in one position, by link.
Poses = Mapping[str, tuple[complex, complex]]


@dataclass
class RigidBody:
    """A link, with those welded to it, in the frame of the first; ``places`` of points [mm]."""

    name: str
    places: dict[str, complex] = field(default_factory=dict)


def rigid_bodies(linkage: Linkage, millimetres: float, poses: Poses) -> dict[str, RigidBody]:
    """The body of every link, by link; ground first."""
    bodies: dict[str, RigidBody] = {}
    for link in (GROUND, *(link for link in linkage.links if link != GROUND)):
        local = linkage.shapes.local[link]
        bodies[link] = RigidBody(link, {p: millimetres * complex(z) for p, z in local.items()})
    for pair in _pairs(linkage):
        if pair.kind is not PairKind.FIXED:
            continue
        order = sorted(pair.bodies, key=list(bodies).index)
        one, other = (bodies[link] for link in order)
        for point, place in other.places.items():
            one.places.setdefault(point, _seen(poses, other.name, one.name, place))
        bodies.update({link: one for link, body in bodies.items() if body is other})
    return bodies


def _pairs(linkage: Linkage) -> Iterator[Pair]:
    """The pairs of all parts.

    Raises
    ------
    InputError
        If a part is no pair of plates.
    """
    for part in linkage.parts:
        if not _is_made(part, linkage):
            raise InputError(f'"{part.label}" ({part.title.lower()}) cannot be made of plates')
        pairs = part.pairs(linkage)
        yield from () if pairs is None else pairs.pairs


def _is_made(part: Part, linkage: Linkage) -> bool:
    """Whether plates are known for a part: pins, slides, gears, racks, cams with rollers."""
    pairs = part.pairs(linkage)
    kinds = {figure.kind for figure in part.figures(linkage, {}) if isinstance(figure, DiscFigure)}
    if pairs is None:
        return kinds == {"roller"}
    geared = not pairs.couplings or kinds == {"gear"}
    return geared and all(body.on for body in pairs.bodies)


def same_place(a: complex, b: complex) -> bool:
    """Whether two points coincide, up to rounding."""
    return abs(a - b) <= _TOGETHER * max(abs(a), abs(b))


def _seen(poses: Poses, body: str, other: str, place: complex) -> complex:
    """A place in the frame of a body, in that of another one."""
    (origin, turn), (there, by) = poses[body], poses[other]
    return (origin + turn * place - there) * by.conjugate()


@dataclass(frozen=True, kw_only=True)
class Guideway:
    """A straight slot in the body ``on``: displacement s is at ``origin`` + s · ``along`` [mm].

    ``runner`` slides in it with pins at ``places`` in its frame; ``reach``: how far these are
    before and behind the place of displacement s.
    """

    name: str
    on: str
    origin: complex
    along: complex
    runner: str
    point: str
    places: tuple[complex, ...]
    reach: float


def guideways(
    linkage: Linkage,
    bodies: Mapping[str, RigidBody],
    poses: Poses,
    displacements: Mapping[str, float],
    apart: float,
) -> Iterator[Guideway]:
    """The slots of all sliders and pins in slots.

    Parameters
    ----------
    displacements : Mapping[str, float]
        By guide, in the position of the poses [mm].
    apart : float
        Distance of the two pins of a slider from its point [mm].
    """
    pairs = list(_pairs(linkage))
    for pair in pairs:
        if pair.kind is not PairKind.SLIDE:
            continue
        assert pair.line is not None
        on = bodies[pair.bodies[0]]
        first, second = (on.places[point] for point in pair.line)
        along = (second - first) / abs(second - first)
        # a pin in a slot has a block, which turns on the pin
        block = [p for p in pairs if p.kind is PairKind.PIN and p.bodies[0] == pair.bodies[1]]
        runner = bodies[block[0].bodies[1] if block else pair.bodies[1]]
        place = runner.places[pair.point]
        direction = along * poses[on.name][1] * poses[runner.name][1].conjugate()
        reach = 0.0 if block else apart
        yield Guideway(
            name=pair.name,
            on=on.name,
            origin=_seen(poses, runner.name, on.name, place) - displacements[pair.name] * along,
            along=along,
            runner=runner.name,
            point=pair.point,
            places=(place,) if block else (place - reach * direction, place + reach * direction),
            reach=reach,
        )
