"""The packages of plates, loaded on first use: shapely for distances and triangles, ezdxf for DXF,
build123d for STEP.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from importlib import import_module
from typing import Any

import numpy as np

from linkwork.core.drawing.links import convex_outline
from linkwork.core.foundation.arrays import Array, ComplexArray
from linkwork.core.foundation.errors import InputError
from linkwork.core.foundation.lanes import phase
from linkwork.core.foundation.loading import installed_with
from linkwork.core.foundation.names import GROUND
from linkwork.core.mechanism.bodies import DiscFigure
from linkwork.core.mechanism.linkage import Linkage
from linkwork.core.mechanism.part.part import Pair, PairKind, Part
from linkwork.core.motion.extremes import Boxes, motions_of_points, variables_of
from linkwork.core.motion.model import Model
from linkwork.core.results.motion import Motion
from linkwork.forces.reactions.geometry import Geometry


def shapely() -> Any:
    """shapely.

    Raises
    ------
    MissingPackageError
        If it is not installed.
    """
    return _loaded("shapely", "plates")


def ezdxf() -> Any:
    """ezdxf; raises like :func:`shapely`."""
    return _loaded("ezdxf", "plates")


def build123d() -> Any:
    """build123d; raises like :func:`shapely`."""
    return _loaded("build123d", "step")


def _loaded(package: str, extra: str) -> Any:
    with installed_with(extra, f"plates need {package}"):
        return import_module(package)


def shapes_of(z: ComplexArray) -> Any:
    """Points, lines or polygons of shapely with corners (B, n)."""
    coordinates = np.stack([z.real, z.imag], axis=-1)
    if z.shape[-1] == 1:
        return shapely().points(coordinates[..., 0, :])
    make = shapely().linestrings if z.shape[-1] == 2 else shapely().polygons
    return make(coordinates)


# ----------------------------------------------------------------------
# Closed outlines of straight lines and circular arcs.


_FLAT = 1e-12  # bulge below which a side is straight
_ARC = math.tau / 256  # of an arc, in one side of its polygon: 0.01 % of a circle's area


@dataclass(frozen=True, kw_only=True, eq=False)
class Outline:
    """A closed counter-clockwise curve: side k leads from corner k to the next one.

    ``corners`` (K,) [mm]; ``bulges`` (K,): the tangent of a quarter of the side's angle, 0 for a
    line, positive for an arc to the left.
    """

    corners: ComplexArray
    bulges: Array

    @property
    def ends(self) -> ComplexArray:
        """The corner at which each side ends."""
        return np.roll(self.corners, -1)

    @property
    def sides(self) -> Iterator[tuple[complex, complex, float]]:
        """Start, end and bulge of every side."""
        return zip(self.corners, self.ends, self.bulges, strict=True)

    @property
    def area(self) -> float:
        """The enclosed area [mm²]."""
        chord = np.abs(self.ends - self.corners)
        angle = 4.0 * np.arctan(self.bulges)
        bent = np.abs(self.bulges) > _FLAT
        radius = np.zeros(len(chord))
        radius[bent] = chord[bent] / (2.0 * np.sin(angle[bent] / 2.0))
        segments = 0.5 * radius**2 * (angle - np.sin(angle))
        return float(0.5 * (self.corners.conj() * self.ends).imag.sum() + segments.sum())

    @property
    def as_circle(self) -> tuple[complex, float] | None:
        """Centre and radius, if the outline is a circle."""
        if len(self.corners) != 2 or not np.allclose(self.bulges, 1.0, rtol=0.0, atol=_FLAT):
            return None
        first, second = self.corners.tolist()
        return (first + second) / 2.0, abs(second - first) / 2.0

    def moved(self, origin: complex, turn: complex) -> Outline:
        """The outline turned by the unit vector ``turn`` and moved by ``origin``."""
        return Outline(corners=origin + turn * self.corners, bulges=self.bulges)

    def grown(self, by: float) -> Outline:
        """The parallel curve at the distance ``by`` [mm], outside if positive.

        Exact where sides are tangent to each other; at other corners the tangents are shifted.
        """
        if by == 0.0:
            return self
        quarter = np.exp(2j * np.arctan(self.bulges))
        chord = self.ends - self.corners
        along = chord / np.abs(chord)
        leaving, arriving = along / quarter, np.roll(along * quarter, 1)
        shift = -1j * (leaving + arriving) / (1.0 + (leaving * arriving.conj()).real)
        return Outline(corners=self.corners + by * shift, bulges=self.bulges)

    def polygon(self) -> ComplexArray:
        """Corners of the inscribed polygon, without the repeated first one."""
        parts = []
        for start, end, bulge in self.sides:
            angle = 4.0 * math.atan(bulge)
            count = max(1, math.ceil(abs(angle) / _ARC)) if abs(bulge) > _FLAT else 1
            if count == 1:
                parts.append(np.array([start]))
                continue
            # the centre is to the left of an arc with a positive bulge
            radius = (end - start) / (2.0 * math.sin(angle / 2.0))
            centre = start + 1j * radius * np.exp(-0.5j * angle)
            parts.append(centre + (start - centre) * np.exp(1j * angle * np.arange(count) / count))
        return np.concatenate(parts)


def circle(center: complex, radius: float) -> Outline:
    """A circle [mm]."""
    return Outline(corners=np.array([center + radius, center - radius]), bulges=np.ones(2))


def rounded(points: Iterable[complex], radius: float) -> Outline:
    """The outline at a distance around the convex hull of points: a bar around two [mm]."""
    hull = convex_outline(points)
    distinct = [z for k, z in enumerate(hull) if k == 0 or z != hull[0]]
    if len(distinct) == 1:
        return circle(distinct[0], radius)
    z = np.array(distinct)
    along = np.roll(z, -1) - z
    along /= np.abs(along)
    before = np.roll(along, 1)
    turn = np.angle(along / before) if len(z) > 2 else np.full(2, math.pi)
    corners = np.stack([z - 1j * radius * before, z - 1j * radius * along], axis=1).ravel()
    bulges = np.stack([np.tan(turn / 4.0), np.zeros(len(z))], axis=1).ravel()
    return Outline(corners=corners, bulges=bulges)


# ----------------------------------------------------------------------
# Arms of plates: bars along the shortest tree between holes, inner corners rounded by fillets.


_EQUAL = 9  # decimals of a length over the longest: equal ones are taken in the order of the file
_STRAIGHT = 1e-9  # rad: arms that continue each other have no corner, those in one line no room
_ROOM = 1.0 - 1e-6  # of an arm, for the fillets at both ends

#: The numbers of the places at both ends of an arm.
Ends = tuple[int, int]


@dataclass(frozen=True, kw_only=True, eq=False)
class Arms:
    """The outline of a plate with arms; ``core``: convex pieces whose neighbourhood it fills."""

    outline: Outline
    core: tuple[ComplexArray, ...]


@dataclass(frozen=True, kw_only=True)
class _Corner:
    """Where the way around the arms goes from one to the next at ``place``.

    ``arriving``, ``leaving``: unit vectors; ``angle``: outside of the plate, between the arms
    [rad]; ``reach``: how far its fillet goes along both arms, 0 at an outer corner.
    """

    place: complex
    arriving: complex
    leaving: complex
    angle: float
    reach: float


def arms_between(
    places: Sequence[complex], slots: Collection[Ends], radius: float, fillet: float
) -> Arms | None:
    """The plate whose arms join places, with corners rounded; ``None`` without room for fillets.

    Parameters
    ----------
    places : sequence of complex
        Three or more, not in a line [mm].
    slots : collection of (int, int)
        Pairs of places that an arm has to join.
    radius, fillet : float
        Half the width of arms, and the radius of inner corners [mm].

    Notes
    -----
    Arms without a common end are farther apart than the width and twice the fillet, and fillets at
    both ends of an arm do not meet: then the outline does not cross itself.
    """
    arms, out = _tree(places, slots), radius + fillet
    lines = [shapes_of(np.array([places[a], places[b]])) for a, b in arms]
    for (one, first), (other, second) in itertools.combinations(zip(arms, lines, strict=True), 2):
        if not set(one) & set(other) and shapely().distance(first, second) < 2.0 * out:
            return None
    corners = list(_around(places, arms, out))
    for start, end in zip(corners, corners[1:] + corners[:1], strict=True):
        if start.reach + end.reach > _ROOM * abs(end.place - start.place):
            return None
    sides = [side for corner in corners for side in _sides(corner, radius)]
    fillets = (
        [c.place - c.reach * c.arriving, c.place, c.place + c.reach * c.leaving]
        for c in corners
        if c.reach
    )
    pieces = [[places[a], places[b]] for a, b in arms]
    return Arms(
        outline=Outline(
            corners=np.array([z for z, _ in sides]), bulges=np.array([b for _, b in sides])
        ),
        core=tuple(np.array(piece) for piece in (*pieces, *fillets)),
    )


def _tree(places: Sequence[complex], slots: Collection[Ends]) -> list[Ends]:
    """The shortest tree that joins all places and has the slots (Kruskal)."""
    pairs = list(itertools.combinations(range(len(places)), 2))
    length = {pair: abs(places[pair[1]] - places[pair[0]]) for pair in pairs}
    longest = max(length.values())
    pairs.sort(key=lambda pair: (pair not in slots, round(length[pair] / longest, _EQUAL)))
    group, edges = list(range(len(places))), []
    for a, b in pairs:
        old, new = group[b], group[a]
        if old != new:
            edges.append((a, b))
            group = [new if label == old else label for label in group]
    return edges


def _around(places: Sequence[complex], arms: Sequence[Ends], out: float) -> Iterator[_Corner]:
    """The corners of the way around all arms, with these to the left."""
    near = {a: [b for arm in arms if a in arm for b in arm if b != a] for a in range(len(places))}

    def angle(before: int, here: int, after: int) -> float:
        if after == before:
            return math.tau
        back, onward = (places[k] - places[here] for k in (before, after))
        return phase(onward / back) % math.tau

    begin = before, here = arms[0]
    while True:
        turned, after = min((angle(before, here, k), k) for k in near[here])
        arriving, leaving = places[here] - places[before], places[after] - places[here]
        inner = turned < math.pi - _STRAIGHT
        yield _Corner(
            place=places[here],
            arriving=arriving / abs(arriving),
            leaving=leaving / abs(leaving),
            angle=turned,
            reach=out / math.tan(max(turned, _STRAIGHT) / 2.0) if inner else 0.0,
        )
        before, here = here, after
        if (before, here) == begin:
            return


def _sides(corner: _Corner, radius: float) -> Iterator[tuple[complex, float]]:
    """The arc at a corner and the line that leaves it: their starts, with bulges."""
    bent = corner.angle - math.pi
    if abs(bent) <= _STRAIGHT:
        return
    yield corner.place - (corner.reach + 1j * radius) * corner.arriving, math.tan(bent / 4.0)
    yield corner.place + (corner.reach - 1j * radius) * corner.leaving, 0.0


# ----------------------------------------------------------------------
# Places and directions of bodies in positions, and how far they may be from them in boxes.


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
