"""The plates and pins of every body of a linkage, before layers are chosen."""

from __future__ import annotations

import cmath
import itertools
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from linkwork.core.drawing.links import convex_outline
from linkwork.core.foundation.errors import InputError
from linkwork.core.foundation.lanes import phase
from linkwork.core.foundation.names import GROUND
from linkwork.core.mechanism.bodies import Contour, DiscFigure
from linkwork.core.mechanism.linkage import Linkage
from linkwork.core.mechanism.skeleton import Skeleton
from linkwork.core.motion.model import Model
from linkwork.core.results.motion import Motion
from linkwork.writers.plates.outlines import (
    BodyPoses,
    Guideway,
    RigidBody,
    arms_between,
    circle,
    guideways,
    rigid_bodies,
    rounded,
    same_place,
    shapely,
    shapes_of,
    variables_of_all,
)
from linkwork.writers.plates.plate import (
    BASE,
    Opening,
    Pin,
    Plate,
    PlateOptions,
    Sizes,
    round_holes,
    sizes_of,
)
from linkwork.writers.plates.wheels import (
    Blank,
    GearMesh,
    RackMesh,
    Wheel,
    WheelPlate,
    cam_blank,
    gear_blank,
    gear_meshes,
    rack_meshes,
    rack_plate,
    ring_plate,
    wheel_plate,
)

_GEAR = 0.8  # of a gear's radius: bars this wide leave room for a pin and a fastener


@dataclass
class Construction:
    """Plates and pins of a linkage.

    ``ways``: its guides; ``travel``: the least and the largest displacement of each [mm].
    ``holes`` of points and ``more`` of fasteners, by body; ``meshes``: plates in contact, which
    share a layer; ``contacts``: cams with their rollers, at the points ``rollers``.
    """

    linkage: Linkage
    millimetres: float
    sizes: Sizes
    bodies: dict[str, RigidBody]
    ways: tuple[Guideway, ...]
    travel: dict[str, tuple[float, float]]
    holes: dict[str, dict[str, complex]] = field(default_factory=dict)
    more: dict[str, dict[str, complex]] = field(default_factory=dict)
    meshes: list[frozenset[str]] = field(default_factory=list)
    contacts: list[tuple[str, str]] = field(default_factory=list)
    rollers: set[str] = field(default_factory=set)
    notes: list[str] = field(default_factory=list)
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
        first = variables_of_all(model, motion)[:1]
        placed = BodyPoses(model, list(linkage.links), mm).of(first)
        poses = {link: (complex(z[0]), complex(turn[0])) for link, (z, turn) in placed.items()}
        bodies = rigid_bodies(linkage, mm, poses)
        holes = {name: dict(_holes(model, each, bodies)) for name, each in _distinct(bodies)}
        gaps = [
            abs(a - b)
            for each in holes.values()
            for a, b in itertools.combinations(each.values(), 2)
        ]
        gaps += [
            _GEAR * mm * disc.radius for disc in model.skeleton.of(DiscFigure) if not disc.ring
        ]
        sizes = sizes_of(options, mm, longest, min(gaps, default=longest))
        solved = motion.found
        values = {name: mm * each.value[solved] for name, each in motion.sliders.items()}
        now = {name: float(each[0]) for name, each in values.items()}
        ways = tuple(guideways(linkage, bodies, poses, now, sizes.width))
        ends = {name: (float(each.min()), float(each.max())) for name, each in values.items()}
        travel = {way.name: ends[way.name] for way in ways}
        made = cls(linkage, mm, sizes, bodies, ways, travel, holes)
        turns = {link: phase(turn) for link, (_, turn) in poses.items()}
        points = {point: complex(motion.place(point).v[solved][0]) for point in linkage.points}
        meshes = gear_meshes(linkage, model.skeleton, sizes, mm, turns, points)
        wheels = list(dict.fromkeys(wheel for _, *pair in meshes for wheel in pair))
        racks = list(rack_meshes(linkage, wheels, sizes, mm))
        names = made._gears([*wheels, *(mesh.pinion for mesh in racks)], meshes, turns)
        made._racks(racks, names, poses, now)
        made._cams(model.skeleton, turns)
        made._main_plates()
        for plate in made.plates:
            check_webs(plate, sizes)
        made._join()
        return made

    def _gears(
        self, wheels: Sequence[Wheel], meshes: Sequence[GearMesh], turns: Mapping[str, float]
    ) -> dict[Wheel, str]:
        """Add the gears; returns the names of their plates."""
        names: dict[Wheel, str] = {}
        for wheel in dict.fromkeys(wheels):
            body = self.bodies[wheel.disc.link]
            turned = replace(wheel, phase=wheel.phase + turns[wheel.disc.link] - turns[body.name])
            plate = (
                ring_plate(turned, body, self.sizes)
                if wheel.disc.ring
                else self._wheel(gear_blank(turned, body), body)
            )
            names[wheel] = self._add(plate)
        for name, one, other in meshes:
            self.meshes.append(frozenset((names[one], names[other])))
            self.notes.append(f"{name}: {one.teeth} and {other.teeth} teeth, {_gearing(one)}")
        return names

    def _racks(
        self,
        racks: Sequence[RackMesh],
        names: Mapping[Wheel, str],
        poses: Mapping[str, tuple[complex, complex]],
        now: Mapping[str, float],
    ) -> None:
        for mesh in racks:
            way = next(way for way in self.ways if way.name == mesh.guide)
            pinion = mesh.pinion
            turn = poses[pinion.disc.link][1] * poses[way.on][1].conjugate()
            center = self.bodies[way.on].places[pinion.disc.center]
            plate = rack_plate(
                mesh, way, center, turn * cmath.exp(1j * pinion.phase), self.travel[way.name],
                now[way.name], self.sizes,
            )  # fmt: skip
            self.meshes.append(frozenset((names[pinion], self._add(plate))))
            self.notes.append(f"{mesh.name}: pinion of {pinion.teeth} teeth, {_gearing(pinion)}")

    def _cams(self, skeleton: Skeleton, turns: Mapping[str, float]) -> None:
        """Cams with rollers; these turn freely on their pins."""
        rollers = {disc.name: disc for disc in skeleton.of(DiscFigure) if disc.kind == "roller"}
        for contour in skeleton.of(Contour):
            roller, body = rollers[contour.name], self.bodies[contour.link]
            turn = cmath.exp(1j * (turns[contour.link] - turns[body.name]))
            points = self.millimetres * turn * np.array(contour.points)
            cam = self._add(self._wheel(cam_blank(body.places[contour.center], points), body))
            carrier, radius = self.bodies[roller.link], self.millimetres * roller.radius
            center, name = carrier.places[roller.center], f"{roller.name} roller"
            if radius < self.sizes.hole / 2.0 + self.sizes.web:
                raise InputError(
                    f'the roller of "{roller.name}" is too small for its hole of '
                    f"{self.sizes.hole:g} mm: choose smaller pins"
                )
            plate = Plate(
                name=name,
                body=carrier.name,
                outline=circle(center, radius),
                openings=round_holes({roller.center: center}, self.sizes),
                core=(np.array([center]),),
                radius=radius,
            )
            self.plates.append(plate)
            self.meshes.append(frozenset((cam, name)))
            self.contacts.append((cam, name))
            self.rollers.add(roller.center)

    def _wheel(self, blank: Blank, body: RigidBody) -> WheelPlate:
        slides = any(body.name in (way.on, way.runner) for way in self.ways)
        guided = slides or body.name == GROUND
        return wheel_plate(blank, body, self.holes[body.name], self.sizes, guided=guided)

    def _add(self, wheel: WheelPlate) -> str:
        """Add a wheel's plate with its fasteners; returns its name."""
        body, name = wheel.plate.body, wheel.plate.name
        self.plates.append(wheel.plate)
        self.more.setdefault(body, {}).update(wheel.fastened)
        for point, place in wheel.fastened.items():
            plates = frozenset((name, body))
            self.pins.append(Pin(name=point, body=body, place=place, plates=plates, fixed=True))
        return name

    def _main_plates(self) -> None:
        """The other plates of all bodies, the base plate first."""
        whole = {plate.name for plate in self.plates}
        main = [
            self._plate(name, name, self.holes[name], slotted=True)
            for name, _ in _distinct(self.bodies)
            if name not in whole
        ]
        self.plates = main + self.plates

    def _join(self) -> None:
        """The pins of all joints and guides."""
        with_hole: dict[tuple[str, str], set[str]] = {}
        for plate in self.plates:
            for opening in plate.openings:
                with_hole.setdefault((plate.body, opening.name), set()).add(plate.name)
        joined: dict[str, set[str]] = {}
        for point in self.linkage.points:
            bodies = {self.bodies[link].name for link in self.linkage.bodies_at(point)}
            held = {name: with_hole.get((name, self._hole(name, point)), set()) for name in bodies}
            joined[point] = set().union(*held.values())
            if sum(map(bool, held.values())) < 2 and point not in self.rollers:
                joined[point] = set()
        for way in self.ways:
            slotted = with_hole[way.on, way.name]
            if way.reach == 0.0:
                held_by = with_hole[way.runner, self._hole(way.runner, way.point)]
                joined[way.point] |= slotted | held_by
                continue
            for k, place in enumerate(way.places, start=1):
                name = f"{way.name} {k}"
                plates = frozenset(slotted | with_hole[way.runner, name])
                self.pins.append(Pin(name=name, body=way.runner, place=place, plates=plates))
        for point, through_plates in joined.items():
            if through_plates:
                body = self.bodies[next(self.linkage.bodies_at(point))]
                place = body.places[point]
                through = frozenset(through_plates)
                self.pins.append(Pin(name=point, body=body.name, place=place, plates=through))

    def _hole(self, body: str, point: str) -> str:
        """The name of the hole of a point: points that coincide share one."""
        holes, place = self.holes[body], self.bodies[body].places[point]
        return next((p for p, z in holes.items() if same_place(z, place)), point)

    def ground_plate(self, name: str, holes: Mapping[str, complex]) -> Plate:
        """A plate of the ground with some of its holes; slots are in the base plate."""
        return self._plate(name, GROUND, holes, slotted=name == BASE)

    def _plate(self, name: str, body: str, holes: Mapping[str, complex], *, slotted: bool) -> Plate:
        sizes, slots, guided = self.sizes, {}, dict(holes)
        if slotted:
            guided |= self.more.get(body, {})
            for way in self.ways:
                if way.runner == body and way.reach:
                    guided |= {f"{way.name} {k}": z for k, z in enumerate(way.places, start=1)}
                if way.on == body:
                    slots[way.name] = self.slot_ends(way)
        core = [*guided.values(), *itertools.chain.from_iterable(slots.values())]
        openings = [
            *round_holes(guided, sizes),
            *(Opening(name=k, outline=rounded(z, sizes.hole / 2.0)) for k, z in slots.items()),
        ]
        if not core:
            raise InputError(f'nothing is joined to "{body}": it has no plate')
        hull, radius = convex_outline(core), sizes.width / 2.0
        ends = [(k, k + 1) for k in range(len(guided), len(core), 2)]
        with_arms = len(hull) > 2 and body != GROUND
        arms = arms_between(core, ends, radius, sizes.fillet) if with_arms else None
        filled = np.array(hull if hull[0] != hull[-1] else hull[:1])
        return Plate(
            name=name,
            body=body,
            outline=rounded(hull, radius) if arms is None else arms.outline,
            openings=tuple(openings),
            core=(filled,) if arms is None else arms.core,
            radius=radius,
        )

    def slot_ends(self, way: Guideway) -> tuple[complex, complex]:
        """The centres of a pin at both ends of a slot, in the frame of its body."""
        low, high = self.travel[way.name]
        more = way.reach + self.sizes.play
        return way.origin + (low - more) * way.along, way.origin + (high + more) * way.along


def _gearing(wheel: Wheel) -> str:
    return (
        f"module {wheel.module:.6g} mm, pressure angle {math.degrees(wheel.pressure):g} deg, "
        f"backlash {wheel.backlash:.3g} mm"
    )


def check_webs(plate: Plate, sizes: Sizes) -> None:
    """Refuse openings that overlap, or leave too little between them.

    Raises
    ------
    InputError
        With both openings and the distance.
    """
    shapes = [shapes_of(opening.outline.polygon()) for opening in plate.openings]
    for (a, one), (b, other) in itertools.combinations(enumerate(shapes), 2):
        web = shapely().distance(one, other)
        if web < sizes.web:
            names = f"{plate.openings[a].name} and {plate.openings[b].name}"
            what = "overlap" if web == 0.0 else f"leave {web:.3g} mm between them"
            raise InputError(
                f'the openings {names} of plate "{plate.name}" {what}, at least {sizes.web:.3g} mm '
                "are needed: choose smaller pins, or other dimensions"
            )


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
        apart = not any(same_place(place, other) for other in taken)
        if (len(here) > 1 or point in held or free) and apart:
            taken.append(place)
            yield point, place
