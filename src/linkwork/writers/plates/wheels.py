"""Plates of gears and cams: wheels with holes, rings, and their fastening to another plate."""

from __future__ import annotations

import cmath
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from linkwork.core.drawing.links import convex_outline
from linkwork.core.drawing.wheels import ADDENDUM, DEDENDUM
from linkwork.core.foundation.arrays import Array, ComplexArray
from linkwork.core.foundation.errors import InputError
from linkwork.core.foundation.lanes import phase
from linkwork.core.mechanism.bodies import DiscFigure
from linkwork.core.mechanism.linkage import Linkage
from linkwork.core.mechanism.part.gears import ToothedPart
from linkwork.writers.plates.bodies import Guideway, RigidBody
from linkwork.writers.plates.gears import (
    FEWEST,
    Wheel,
    involute_outline,
    touch_within_a_pitch,
    touching_teeth,
)
from linkwork.writers.plates.outlines import Outline, circle, shapely, shapes_of
from linkwork.writers.plates.plate import Opening, Plate, Sizes, round_holes

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
