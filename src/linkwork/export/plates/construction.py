"""The plates and pins of a linkage: what every body consists of, before layers are chosen."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from linkwork.drawing.link_symbols import convex_outline
from linkwork.export.plates.motion_boxes import BodyPoses, variables_of
from linkwork.export.plates.options import PlateOptions, Sizes, sizes_of
from linkwork.export.plates.outline import Outline, circle, rounded
from linkwork.export.plates.packages import shapely
from linkwork.export.plates.plate import Opening, Pin, Plate
from linkwork.export.plates.rigid_bodies import Guideway, RigidBody, guideways, rigid_bodies
from linkwork.foundation.errors import InputError
from linkwork.foundation.names import GROUND
from linkwork.mechanism.linkage import Linkage
from linkwork.motion.model import Model
from linkwork.results.motion import Motion

__all__ = ["BASE", "Construction"]

#: The plate of the ground.
BASE = "base"


@dataclass
class Construction:
    """Plates and pins of a linkage.

    ``travel``: the first and the last displacement of each guide [mm]. ``ways``: its guides.
    """

    linkage: Linkage
    millimetres: float
    sizes: Sizes
    bodies: dict[str, RigidBody]
    ways: tuple[Guideway, ...]
    travel: dict[str, tuple[float, float]]
    holes: dict[str, dict[str, complex]] = field(default_factory=dict)
    plates: list[Plate] = field(default_factory=list)
    pins: list[Pin] = field(default_factory=list)

    @classmethod
    def of(cls, model: Model, motion: Motion, options: PlateOptions, mm: float) -> Construction:
        """The plates for a motion; ``mm``: millimetres per length unit of the file.

        Raises
        ------
        InputError
            If a part cannot be made, or openings of a plate overlap or are too near to each other.
        """
        linkage = model.description
        assert isinstance(linkage, Linkage)
        longest = mm * model.equations.length_scale
        first = variables_of(model, motion)[:1]
        placed = BodyPoses(model, list(linkage.links), mm).of(first)
        poses = {link: (complex(z[0]), complex(turn[0])) for link, (z, turn) in placed.items()}
        bodies = rigid_bodies(linkage, mm, poses)
        holes = {name: dict(_holes(model, own, bodies)) for name, own in _distinct(bodies)}
        gaps = [
            abs(a - b) for own in holes.values() for a, b in itertools.combinations(own.values(), 2)
        ]
        sizes = sizes_of(options, mm, longest, min(gaps, default=longest))
        found = motion.found
        values = {name: mm * own.value[found] for name, own in motion.sliders.items()}
        now = {name: float(own[0]) for name, own in values.items()}
        ways = tuple(guideways(linkage, bodies, poses, now, sizes.width))
        ends = {name: (float(own.min()), float(own.max())) for name, own in values.items()}
        travel = {way.name: ends[way.name] for way in ways}
        made = cls(linkage, mm, sizes, bodies, ways, travel, holes)
        made._make()
        return made

    def _make(self) -> None:
        for name, body in _distinct(self.bodies):
            self.plates.append(self._main_plate(name, body))
        plate_of = {plate.body: plate.name for plate in self.plates}
        joined: dict[str, set[str]] = {}
        for point in self.linkage.points:
            bodies = {self.bodies[link].name for link in self.linkage.bodies_at(point)}
            joined[point] = {plate_of[body] for body in bodies}
        for way in self.ways:
            if way.reach == 0.0:
                joined[way.point].add(plate_of[way.on])
                continue
            own = frozenset({plate_of[way.on], plate_of[way.runner]})
            for k, place in enumerate(way.places, start=1):
                self.pins.append(
                    Pin(name=f"{way.name} {k}", body=way.runner, place=place, plates=own)
                )
        for point, plates in joined.items():
            if len(plates) > 1:
                body = self.bodies[next(self.linkage.bodies_at(point))]
                pin = Pin(
                    name=point, body=body.name, place=body.places[point], plates=frozenset(plates)
                )
                self.pins.append(pin)

    def _main_plate(self, name: str, body: RigidBody) -> Plate:
        """The plate around the holes and slots of a body."""
        sizes, core, openings = self.sizes, [], []
        for point, place in self.holes[name].items():
            core.append(place)
            openings.append(Opening(name=point, outline=circle(place, sizes.hole / 2.0)))
        for way in self.ways:
            if way.runner == name and way.reach:
                for k, place in enumerate(way.places, start=1):
                    core.append(place)
                    hole = circle(place, sizes.hole / 2.0)
                    openings.append(Opening(name=f"{way.name} {k}", outline=hole))
            if way.on == name:
                ends = self.slot_ends(way)
                core += ends
                openings.append(Opening(name=way.name, outline=rounded(ends, sizes.hole / 2.0)))
        own = BASE if name == GROUND else name
        if not core:
            raise InputError(f'nothing is joined to "{name}": it has no plate')
        hull = convex_outline(core)
        plate = Plate(
            name=own,
            body=name,
            outline=rounded(hull, sizes.width / 2.0),
            openings=tuple(openings),
            core=np.array(hull if hull[0] != hull[-1] else hull[:1]),
            radius=sizes.width / 2.0,
        )
        check_webs(plate, sizes)
        return plate

    def slot_ends(self, way: Guideway) -> tuple[complex, complex]:
        """The centres of a pin at both ends of a slot, in the frame of its body."""
        low, high = self.travel[way.name]
        more = way.reach + self.sizes.play
        return way.origin + (low - more) * way.along, way.origin + (high + more) * way.along


def check_webs(plate: Plate, sizes: Sizes) -> None:
    """Refuse openings that overlap, or leave too little between them.

    Raises
    ------
    InputError
        With both openings and the distance.
    """
    shapes = [_polygon(own.outline) for own in plate.openings]
    for (a, one), (b, other) in itertools.combinations(enumerate(shapes), 2):
        web = shapely().distance(one, other)
        if web < sizes.web:
            names = f"{plate.openings[a].name} and {plate.openings[b].name}"
            what = "overlap" if web == 0.0 else f"leave {web:.3g} mm between them"
            raise InputError(
                f'the openings {names} of plate "{plate.name}" {what}, at least {sizes.web:.3g} mm '
                "are needed: choose smaller pins, or other dimensions"
            )


def _polygon(outline: Outline) -> object:
    z = outline.polygon()
    return shapely().polygons(np.stack([z.real, z.imag], axis=-1))


def _distinct(bodies: dict[str, RigidBody]) -> Iterator[tuple[str, RigidBody]]:
    """The bodies, each once, ground first."""
    seen = set()
    for body in bodies.values():
        if body.name not in seen:
            seen.add(body.name)
            yield body.name, body


def _holes(
    model: Model, body: RigidBody, bodies: dict[str, RigidBody]
) -> Iterator[tuple[str, complex]]:
    """The points of a body that have a hole in its plate.

    Joints have one, ends of springs and points that are traced; so have all other points of moving
    links unless they only lay a line.
    """
    skeleton, linkage = model.skeleton, model.description
    assert isinstance(linkage, Linkage)
    lines = {point for guide in skeleton.guides for point in guide.line}
    held = {point for figure in skeleton.figures for point in figure.ends}
    held |= {guide.point for guide in skeleton.guides if not guide.block} | set(linkage.trace)
    taken: list[complex] = []
    for point, place in body.places.items():
        here = {bodies[link].name for link in linkage.bodies_at(point)}
        free = body.name != GROUND and point not in lines
        # points that coincide share one hole
        apart = all(abs(place - other) > 1e-9 * abs(place) for other in taken)
        if (len(here) > 1 or point in held or free) and apart:
            taken.append(place)
            yield point, place
