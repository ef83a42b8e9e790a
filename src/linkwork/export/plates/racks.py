"""Racks of plates: straight teeth along the slider that a pinion drives."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from linkwork.drawing.tooth_outline import ADDENDUM, DEDENDUM
from linkwork.export.plates.gears import FEWEST, STEPS, Wheel, involute_outline, polygons
from linkwork.export.plates.options import Sizes
from linkwork.export.plates.outline import Outline, circle
from linkwork.export.plates.packages import shapely
from linkwork.export.plates.plate import Opening, Plate
from linkwork.export.plates.rigid_bodies import Guideway
from linkwork.export.plates.wheel_plates import WheelPlate
from linkwork.foundation.arrays import ComplexArray
from linkwork.foundation.elementwise import phase
from linkwork.foundation.errors import InputError
from linkwork.mechanism.figures import Disc
from linkwork.mechanism.linkage import Linkage
from linkwork.mechanism.part.toothed import ToothedPart

__all__ = ["RackMesh", "rack_meshes", "rack_plate"]

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
        found = part.pairs(linkage)
        if not isinstance(part, ToothedPart) or found is None:
            continue
        for coupling in found.couplings:
            if coupling.slide is None:
                continue
            disc = next(f for f in part.figures(linkage, {}) if isinstance(f, Disc))
            size = 2.0 * millimetres * disc.radius
            teeth = FEWEST if sizes.module is None else max(1, round(size / sizes.module))
            own = Wheel(
                disc=replace(disc, teeth=teeth),
                module=size / teeth,
                phase=0.0,
                pressure=part.pressure(linkage),
                backlash=sizes.backlash_of(size / teeth),
            )
            pinion = known.get(disc.key, own)
            if _touch(pinion):
                raise InputError(
                    f'the teeth of "{part.name}" touch where they should not, with '
                    f"{pinion.teeth} teeth of the pinion: give more teeth, or more backlash"
                )
            name, factor = coupling.slide
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
        found: ComplexArray = middle + along * mirrored
        # clockwise teeth become counter-clockwise
        return found[::-1] if side > 0.0 else found

    holes = placed(np.array(places)).tolist()
    fastened = {f"{name} {k}": z for k, z in enumerate(holes, start=1)}
    corners = placed(local)
    plate = Plate(
        name=name,
        body=way.runner,
        outline=Outline(corners=corners, bulges=np.zeros(len(corners))),
        openings=tuple(
            Opening(name=own, outline=circle(z, sizes.hole / 2.0)) for own, z in fastened.items()
        ),
        core=(placed(core),),
        radius=0.0,
    )
    return WheelPlate(plate=plate, fastened=fastened, whole=False)


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
    count = 64
    while count <= STEPS:
        turn = math.tau / wheel.teeth * np.arange(count) / count
        pinion = polygons(1j * radius + np.exp(1j * turn)[:, None] * shape)
        rack = polygons(radius * turn[:, None] + bar)
        distance = float(shapely().distance(pinion, rack).min())
        if distance <= 0.0:
            return True
        moved = math.pi / wheel.teeth * (tip + radius) / count
        if moved < distance:
            return False
        count = math.ceil(1.1 * count * moved / distance)
    return True
