"""Toothed wheels of plates: numbers of teeth, involute outlines, and the proof of a mesh."""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

import numpy as np

from linkwork.core.drawing.links import convex_outline
from linkwork.core.drawing.wheels import ADDENDUM, DEDENDUM, mesh_phases
from linkwork.core.foundation.arrays import Array, ComplexArray
from linkwork.core.foundation.errors import InputError
from linkwork.core.foundation.lanes import phase
from linkwork.core.mechanism.bodies import DiscFigure, Mesh
from linkwork.core.mechanism.linkage import Linkage
from linkwork.core.mechanism.part.gears import ToothedPart
from linkwork.core.mechanism.skeleton import Skeleton
from linkwork.writers.plates.outlines import (
    Guideway,
    Outline,
    RigidBody,
    circle,
    shapely,
    shapes_of,
)
from linkwork.writers.plates.plate import Opening, Plate, Sizes, round_holes

#: Teeth of gears given by radii, at least: no undercut at 20 degrees.
FEWEST = 18
_LARGEST_RATIO = 1000  # of whole numbers that stand for a ratio of radii
_WHOLE = 1e-9  # of a ratio
_FLANK = 16  # points along a flank
_IN_GAP = 1e-6  # of a pitch
_STEPS = 4096  # positions within one pitch, at most


@dataclass(frozen=True, kw_only=True)
class Wheel:
    """A gear: ``disc`` with its teeth, ``module`` [mm], ``phase``: the direction of its first tooth
    (of a ring: gap) from its link [rad], ``pressure`` angle [rad], ``backlash`` [mm].
    """

    disc: DiscFigure
    module: float
    phase: float
    pressure: float
    backlash: float

    @classmethod
    def of(
        cls, disc: DiscFigure, millimetres: float, pressure: float, sizes: Sizes, phase: float = 0.0
    ) -> Wheel:
        """A disc with teeth, of the length unit of the file in millimetres."""
        assert disc.teeth is not None
        module = 2.0 * millimetres * disc.radius / disc.teeth
        backlash = sizes.backlash_of(module)
        return cls(disc=disc, module=module, phase=phase, pressure=pressure, backlash=backlash)

    @property
    def teeth(self) -> int:
        """The number of teeth."""
        assert self.disc.teeth is not None
        return self.disc.teeth

    @property
    def radii(self) -> tuple[float, float]:
        """The least and the largest radius of the outline: root and tip, of a ring the reverse."""
        up, down = (DEDENDUM, ADDENDUM) if self.disc.ring else (ADDENDUM, DEDENDUM)
        pitch = 0.5 * self.module * self.teeth
        return pitch - down * self.module, pitch + up * self.module


#: The name of a mesh and its two wheels.
GearMesh = tuple[str, Wheel, Wheel]


def gear_meshes(
    linkage: Linkage,
    skeleton: Skeleton,
    sizes: Sizes,
    millimetres: float,
    angles: Mapping[str, float],
    points: Mapping[str, complex],
) -> list[GearMesh]:
    """The meshes of the gears of a mechanism.

    Parameters
    ----------
    angles : Mapping[str, float]
        The angle of every link in one position [rad].
    points : Mapping[str, complex]
        All points in that position.

    Raises
    ------
    InputError
        If radii have no ratio of whole numbers, or teeth touch.
    """
    figures = skeleton.of(Mesh)
    if not figures:
        return []
    toothed = dict(_with_teeth([mesh.discs for mesh in figures], sizes, millimetres))
    pairs = [(toothed[a], toothed[b]) for a, b in (mesh.discs for mesh in figures)]
    phases = mesh_phases(pairs, angles.__getitem__, points)
    steep = {
        part.name: part.pressure(linkage) for part in linkage.parts if isinstance(part, ToothedPart)
    }
    wheels: dict[DiscFigure, Wheel] = {}
    for mesh, pair in zip(figures, pairs, strict=True):
        for disc in pair:
            phase = phases[disc] - angles[disc.link]
            wheel = Wheel.of(disc, millimetres, steep[mesh.name], sizes, phase)
            wheels.setdefault(disc, wheel)
    for mesh, pair in zip(figures, pairs, strict=True):
        _check_mesh(mesh, pair, phases, wheels, points, millimetres)
    return [(mesh.name, wheels[a], wheels[b]) for mesh, (a, b) in zip(figures, pairs, strict=True)]


def _check_mesh(
    mesh: Mesh,
    pair: tuple[DiscFigure, DiscFigure],
    phases: Mapping[DiscFigure, float],
    wheels: Mapping[DiscFigure, Wheel],
    points: Mapping[str, complex],
    millimetres: float,
) -> None:
    """Refuse teeth that do not fall into the gaps of a closed train, and teeth that touch."""
    one, other = pair
    assert other.teeth is not None
    meshing = mesh_phases([pair], lambda _: phases[one], points)[other]
    pitches = (phases[other] - meshing) * other.teeth / math.tau
    if abs(pitches - round(pitches)) > _IN_GAP:
        raise InputError(
            f'the teeth of "{mesh.name}" do not fall into the gaps: change the numbers of teeth '
            "of the closed train"
        )
    apart = millimetres * abs(points[other.center] - points[one.center])
    if touches(wheels[one], wheels[other], apart):
        raise touching_teeth(mesh.name, f"{one.teeth} and {other.teeth} teeth")


def touching_teeth(name: str, teeth: str) -> InputError:
    """Teeth of a mesh touch."""
    return InputError(
        f'the teeth of "{name}" touch where they should not, with {teeth}: give more teeth, or '
        "more backlash"
    )


def _with_teeth(
    meshes: Sequence[tuple[DiscFigure, DiscFigure]], sizes: Sizes, millimetres: float
) -> Iterator[tuple[DiscFigure, DiscFigure]]:
    """Every disc with its teeth; those of trains given by radii are chosen."""
    trains: list[set[DiscFigure]] = []
    for pair in meshes:
        joined = [train for train in trains if train & set(pair)]
        trains = [train for train in trains if train not in joined]
        trains.append(set(pair).union(*joined))
    order = list(dict.fromkeys(disc for pair in meshes for disc in pair))
    for train in trains:
        discs = [disc for disc in order if disc in train]
        if all(disc.teeth is not None for disc in discs):
            yield from ((disc, disc) for disc in discs)
            continue
        counts = _whole(discs)
        least = min(counts)
        times = math.ceil(FEWEST / least)
        if sizes.module is not None:
            teeth = 2.0 * millimetres * discs[counts.index(least)].radius / sizes.module
            times = max(1, round(teeth / least))
        known = next((d for d in discs if d.teeth is not None), None)
        if known is not None and known.teeth is not None:
            # the module of a wheel with teeth applies to the other wheels
            times = round(Fraction(known.teeth, counts[discs.index(known)]))
        for disc, count in zip(discs, counts, strict=True):
            yield disc, replace(disc, teeth=times * count)


def _whole(discs: Sequence[DiscFigure]) -> list[int]:
    """The least whole numbers in the ratio of the radii."""
    ratios = [disc.radius / discs[0].radius for disc in discs]
    fractions = [Fraction(ratio).limit_denominator(_LARGEST_RATIO) for ratio in ratios]
    if any(abs(float(f) - r) > _WHOLE * r for f, r in zip(fractions, ratios, strict=True)):
        raise InputError(
            f'the radii of gears "{discs[0].name}" have no ratio of whole numbers: give their teeth'
        )
    common = math.lcm(*(number.denominator for number in fractions))
    whole = [int(number * common) for number in fractions]
    divisor = math.gcd(*whole)
    return [number // divisor for number in whole]


def involute_outline(wheel: Wheel, center: complex) -> Outline:
    """The outline of a gear about a place of its body; that of a ring is its inner edge.

    Raises
    ------
    InputError
        If its teeth are pointed.

    Notes
    -----
    The half width of a tooth at radius ρ is π/(2z) + inv α0 - inv α, cos α = r cos α0/ρ, less a
    quarter of the backlash over r. Below the base circle flanks are straight towards the centre.

    References
    ----------
    R. L. Norton, Design of Machinery, section 9.3 (involute tooth form).
    """
    pitch = 0.5 * wheel.module * wheel.teeth
    root, tip = wheel.radii
    base = pitch * math.cos(wheel.pressure)
    thinner = wheel.backlash / (4.0 * pitch) * (-1.0 if wheel.disc.ring else 1.0)
    radii = np.linspace(max(root, base), tip, _FLANK)
    half = math.pi / (2 * wheel.teeth) + _involute(np.array(wheel.pressure)) - thinner
    halves = half - _involute(np.arccos(np.minimum(base / radii, 1.0)))
    if root < base:
        radii, halves = np.append(root, radii), np.append(halves[0], halves)
    if halves.min() <= 0.0 or halves.max() >= math.pi / wheel.teeth:
        raise InputError(
            f'gear "{wheel.disc.link}" with {wheel.teeth} teeth has pointed teeth: '
            "more teeth, or less backlash, are needed"
        )
    flank = radii * np.exp(1j * halves)
    tooth = np.concatenate([flank.conj(), flank[::-1]])
    bulges = np.zeros(len(tooth))
    bulges[len(flank) - 1] = math.tan(halves[-1] / 2.0)  # over the tip
    bulges[-1] = math.tan((math.pi / wheel.teeth - halves[0]) / 2.0)  # along the root
    steps = np.exp(1j * (wheel.phase + math.tau * np.arange(wheel.teeth) / wheel.teeth))
    return Outline(
        corners=center + (steps[:, None] * tooth).ravel(), bulges=np.tile(bulges, wheel.teeth)
    )


def _involute(angle: Array) -> Array:
    involute: Array = np.tan(angle) - angle
    return involute


def touches(first: Wheel, second: Wheel, apart: float) -> bool:
    """Whether two gears in mesh touch anywhere within one pitch, and so in any position.

    Notes
    -----
    Both are rotated about fixed centres, in so small steps that no point moves more than the least
    distance so far.
    """
    if second.disc.ring:
        first, second = second, first
    inside = first.disc.ring
    pair = [replace(wheel, phase=phase) for wheel, phase in _in_mesh(first, second)]
    shapes = [involute_outline(wheel, 0j).polygon() for wheel in pair]
    ways = (1.0, 1.0 if inside else -1.0)

    def distance(pitches: Array) -> float:
        one, other = (
            shapes_of(place + np.exp(1j * way * math.tau * pitches / wheel.teeth)[:, None] * shape)
            for place, way, wheel, shape in zip((0j, apart), ways, pair, shapes, strict=True)
        )
        if not inside:
            return float(shapely().distance(one, other).min())
        if not shapely().contains(one, other).all():
            return 0.0
        return float(shapely().distance(shapely().boundary(one), other).min())

    return touch_within_a_pitch(
        distance, math.pi * sum(wheel.radii[1] / wheel.teeth for wheel in pair)
    )


def touch_within_a_pitch(distance: Callable[[Array], float], reach: float) -> bool:
    """Whether two parts touch somewhere in a pitch; if that takes too many steps, they count so.

    Parameters
    ----------
    distance : callable
        The least distance at some fractions of a pitch.
    reach : float
        How far points of both move at most, together, in half a pitch.
    """
    count = 64
    while count <= _STEPS:
        least = distance(np.arange(count) / count)
        if least <= 0.0:
            return True
        if reach / count < least:
            return False
        count = math.ceil(1.1 * reach / least)
    return True


def _in_mesh(first: Wheel, second: Wheel) -> Iterable[tuple[Wheel, float]]:
    """Both wheels with phases of mesh on a line of centres along x."""
    pair = (
        replace(first.disc, center="1", link="1"),
        replace(second.disc, center="2", link="2"),
    )
    phases = mesh_phases([pair], lambda _: 0.0, {"1": 0j, "2": 1.0 + 0j})
    return zip((first, second), (phases[disc] for disc in pair), strict=True)


# ----------------------------------------------------------------------
# Plates of gears and cams: wheels with holes, rings, and their fastening to another plate.


_FASTENERS = 3  # of a ring


@dataclass(frozen=True, kw_only=True, eq=False)
class Blank:
    """A wheel without holes about ``center``; ``low``: the least radius of its outline.

    ``core`` and ``radius`` as of a plate.
    """

    kind: str
    center: complex
    outline: Outline
    low: float
    core: tuple[ComplexArray, ...]
    radius: float


@dataclass(frozen=True, kw_only=True)
class WheelPlate:
    """A wheel's plate; ``fastened``: holes for fasteners to the body's main plate."""

    plate: Plate
    fastened: Mapping[str, complex]


def gear_blank(wheel: Wheel, body: RigidBody) -> Blank:
    """A gear in the frame of its body."""
    center, (low, high) = body.places[wheel.disc.center], wheel.radii
    return Blank(
        kind="gear",
        center=center,
        outline=involute_outline(wheel, center),
        low=low,
        core=(np.array([center]),),
        radius=high,
    )


def cam_blank(center: complex, points: ComplexArray) -> Blank:
    """A cam through points about its centre, in the frame of its body."""
    area = (points.conj() * np.roll(points, -1)).imag.sum()
    corners = center + (points if area > 0.0 else points[::-1])
    return Blank(
        kind="cam",
        center=center,
        outline=Outline(corners=corners, bulges=np.zeros(len(corners))),
        low=float(np.abs(points).min()),
        core=(np.array(convex_outline(corners.tolist())),),
        radius=0.0,
    )


def wheel_plate(
    blank: Blank, body: RigidBody, holes: Mapping[str, complex], sizes: Sizes, *, guided: bool
) -> WheelPlate:
    """The plate of a gear or cam.

    Parameters
    ----------
    holes : Mapping[str, complex]
        The holes of the body by point [mm].
    guided : bool
        Whether the body has slots or guides, or is the ground: its main plate holds them.

    Raises
    ------
    InputError
        If the wheel is too small for its hole.
    """
    hole, center = sizes.hole / 2.0, blank.center
    room = blank.low - hole - sizes.wall
    if room < 0.0:
        raise InputError(
            f'the {blank.kind} of "{body.name}" is too small for its hole of {sizes.hole:g} mm: '
            "choose smaller pins"
        )
    within = {point: z for point, z in holes.items() if abs(z - center) <= room}
    whole = len(within) == len(holes) and not guided
    name, fastened = body.name if whole else f"{body.name} {blank.kind}", {}
    if not whole and len(within) < 2:
        away = max(holes.values(), key=lambda z: abs(z - center)) - center
        # as far out as there is room, or half-way to the next hole
        free = abs(away) - room >= sizes.hole + sizes.web
        reach = room if free else min(room, abs(away) / 2.0)
        fastened = {f"{name} 1": center + cmath.rect(reach, phase(away))}
    plate = Plate(
        name=name,
        body=body.name,
        outline=blank.outline,
        openings=round_holes(within | fastened, sizes),
        core=blank.core,
        radius=blank.radius,
    )
    return WheelPlate(plate=plate, fastened=fastened)


def ring_plate(wheel: Wheel, body: RigidBody, sizes: Sizes) -> WheelPlate:
    """The plate of a ring gear, with holes for fasteners in its rim."""
    blank, name = gear_blank(wheel, body), f"{body.name} gear"
    rim = blank.radius + sizes.width / 2.0
    turns = wheel.phase + math.tau * (np.arange(_FASTENERS) + 0.5) / _FASTENERS
    places = (blank.center + rim * np.exp(1j * turns)).tolist()
    fastened = {f"{name} {k}": place for k, place in enumerate(places, start=1)}
    outer = rim + sizes.width / 2.0
    plate = Plate(
        name=name,
        body=body.name,
        outline=circle(blank.center, outer),
        openings=(Opening(name="teeth", outline=blank.outline), *round_holes(fastened, sizes)),
        core=blank.core,
        radius=outer,
        inner=blank.low,
    )
    return WheelPlate(plate=plate, fastened=fastened)


# ----------------------------------------------------------------------
# Racks of plates: straight teeth along the slider that a pinion drives.


_BEYOND = 2.5  # pitches of a rack beyond its contacts
_TEETH = 5  # of a rack to either side of a contact that are checked


@dataclass(frozen=True, kw_only=True)
class RackMesh:
    """A pinion and the guide of its rack; ``side``: 1 if the pinion is to the left of it."""

    name: str
    pinion: Wheel
    guide: str
    side: float


def rack_meshes(
    linkage: Linkage, wheels: Sequence[Wheel], sizes: Sizes, millimetres: float
) -> Iterator[RackMesh]:
    """The racks of a mechanism; a pinion that is a gear of a train keeps its teeth.

    Raises
    ------
    InputError
        If teeth touch.
    """
    known = {wheel.disc.key: wheel for wheel in wheels}
    for part in linkage.parts:
        pairs = part.pairs(linkage)
        if not isinstance(part, ToothedPart) or pairs is None:
            continue
        for coupling in pairs.couplings:
            if not coupling.slides:
                continue
            disc = next(f for f in part.figures(linkage, {}) if isinstance(f, DiscFigure))
            size = 2.0 * millimetres * disc.radius
            teeth = FEWEST if sizes.module is None else max(1, round(size / sizes.module))
            blank = Wheel.of(replace(disc, teeth=teeth), millimetres, part.pressure(linkage), sizes)
            pinion = known.get(disc.key, blank)
            if _touch(pinion):
                raise touching_teeth(part.name, f"{pinion.teeth} teeth of the pinion")
            name, factor = coupling.slides[0]
            yield RackMesh(name=part.name, pinion=pinion, guide=name, side=-factor)


def rack_plate(
    mesh: RackMesh,
    way: Guideway,
    center: complex,
    tooth: complex,
    travel: tuple[float, float],
    now: float,
    sizes: Sizes,
) -> WheelPlate:
    """The plate of a rack, with two fasteners, in the frame of the sliding body.

    Parameters
    ----------
    center, tooth : complex
        The centre of the pinion, and the direction of its first tooth in the first position, in
        the frame of the body on which the rack slides.
    travel : (float, float)
        The least and the largest displacement [mm].
    now : float
        The displacement in the first position [mm].
    """
    wheel, side = mesh.pinion, mesh.side
    pitch, radius = math.pi * wheel.module, 0.5 * wheel.module * wheel.teeth
    middle = sum(way.places) / len(way.places)
    along = (way.places[-1] - way.places[0]) / abs(way.places[-1] - way.places[0])
    seen = (center - way.origin) * way.along.conjugate()
    line = seen.imag - side * radius
    # the tooth of the pinion on the line of centres fills a gap
    turned = phase(tooth / (-1j * side * way.along))
    gap = seen.real - now + side * radius * turned
    low, high = (seen.real - end for end in (travel[1], travel[0]))
    low, high = low - _BEYOND * pitch, high + _BEYOND * pitch
    first, last = math.ceil((low - gap) / pitch), math.floor((high - gap) / pitch)
    teeth = gap + _teeth(wheel, first, last)
    back = -DEDENDUM * wheel.module - sizes.width
    ends = np.array([complex(teeth[-1].real, back), complex(teeth[0].real, back)])
    local = np.concatenate([teeth, ends])
    core = np.array([
        complex(x, y) for x, y in (
            (teeth[0].real, back), (teeth[-1].real, back),
            (teeth[-1].real, ADDENDUM * wheel.module), (teeth[0].real, ADDENDUM * wheel.module),
        )
    ])  # fmt: skip
    rim, name = back + sizes.width / 2.0, f"{way.runner} rack"
    edge = sizes.width / 2.0
    places = [complex(teeth[0].real + edge, rim), complex(teeth[-1].real - edge, rim)]

    def placed(z: ComplexArray) -> ComplexArray:
        mirrored = z.real + 1j * (line + side * z.imag)
        points: ComplexArray = middle + along * mirrored
        # clockwise teeth become counter-clockwise
        return points[::-1] if side > 0.0 else points

    holes = placed(np.array(places)).tolist()
    fastened = {f"{name} {k}": z for k, z in enumerate(holes, start=1)}
    corners = placed(local)
    plate = Plate(
        name=name,
        body=way.runner,
        outline=Outline(corners=corners, bulges=np.zeros(len(corners))),
        openings=round_holes(fastened, sizes),
        core=(placed(core),),
        radius=0.0,
    )
    return WheelPlate(plate=plate, fastened=fastened)


def _teeth(wheel: Wheel, first: int, last: int) -> ComplexArray:
    """Corners of teeth about the pitch line, from gap ``first`` to gap ``last``; a gap is at 0."""
    pitch, steep = math.pi * wheel.module, math.tan(wheel.pressure)
    half = (pitch - wheel.backlash) / 4.0
    top, root = ADDENDUM * wheel.module, -DEDENDUM * wheel.module
    corners = []
    for number in range(first, last):
        middle = (number + 0.5) * pitch
        for x, y in ((-1.0, root), (-1.0, top), (1.0, top), (1.0, root)):
            corners.append(complex(middle + x * (half - y * steep), y))
    ends = complex(first * pitch, root), complex(last * pitch, root)
    return np.array([ends[0], *corners, ends[1]])


def _touch(wheel: Wheel) -> bool:
    """Whether pinion and rack touch anywhere within one pitch; as of two gears."""
    radius, tip = 0.5 * wheel.module * wheel.teeth, wheel.radii[1]
    shape = involute_outline(replace(wheel, phase=-math.pi / 2.0), 0j).polygon()
    teeth = _teeth(wheel, -_TEETH, _TEETH)
    back = -3.0 * wheel.module
    bar = np.append(teeth, [complex(teeth[-1].real, back), complex(teeth[0].real, back)])

    def distance(pitches: Array) -> float:
        turn = math.tau / wheel.teeth * pitches
        pinion = shapes_of(1j * radius + np.exp(1j * turn)[:, None] * shape)
        rack = shapes_of(radius * turn[:, None] + bar)
        return float(shapely().distance(pinion, rack).min())

    return touch_within_a_pitch(distance, math.pi / wheel.teeth * (tip + radius))
