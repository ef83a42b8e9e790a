"""Rigid bodies to be made of plates, and the straight slots in which others slide."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

from linkwork.foundation.errors import InputError
from linkwork.foundation.names import GROUND
from linkwork.mechanism.figures import Disc
from linkwork.mechanism.linkage import Linkage
from linkwork.mechanism.part.pairs import Pair, PairKind
from linkwork.mechanism.part.part import Part

__all__ = ["Guideway", "RigidBody", "guideways", "rigid_bodies", "same_place"]

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
        found = part.pairs(linkage)
        yield from () if found is None else found.pairs


def _is_made(part: Part, linkage: Linkage) -> bool:
    """Whether plates are known for a part: pins, slides, gears, racks, cams with rollers."""
    found = part.pairs(linkage)
    kinds = {figure.kind for figure in part.figures(linkage, {}) if isinstance(figure, Disc)}
    if found is None:
        return kinds == {"roller"}
    geared = not found.couplings or kinds == {"gear"}
    return geared and all(body.on for body in found.bodies)


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

    ``runner`` slides in it with pins at ``places`` of its own frame; ``reach``: how far these are
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
        # a pin in a slot has a block of its own, which turns on the pin
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
