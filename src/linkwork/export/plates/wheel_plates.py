"""Plates of gears and cams: wheels with holes, rings, and what fastens them to another plate."""

from __future__ import annotations

import cmath
import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from linkwork.drawing.link_symbols import convex_outline
from linkwork.export.plates.gears import Wheel, involute_outline
from linkwork.export.plates.options import Sizes
from linkwork.export.plates.outline import Outline, circle
from linkwork.export.plates.plate import Opening, Plate
from linkwork.export.plates.rigid_bodies import RigidBody
from linkwork.foundation.arrays import ComplexArray
from linkwork.foundation.elementwise import phase
from linkwork.foundation.errors import InputError

__all__ = ["Blank", "WheelPlate", "cam_blank", "gear_blank", "ring_plate", "wheel_plate"]

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
    """A wheel's plate; ``fastened``: holes for fasteners to the body's main plate.

    ``whole``: the body has no other plate.
    """

    plate: Plate
    fastened: Mapping[str, complex]
    whole: bool


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
    openings = (within | fastened).items()
    plate = Plate(
        name=name,
        body=body.name,
        outline=blank.outline,
        openings=tuple(Opening(name=p, outline=circle(z, hole)) for p, z in openings),
        core=blank.core,
        radius=blank.radius,
    )
    return WheelPlate(plate=plate, fastened=fastened, whole=whole)


def ring_plate(wheel: Wheel, body: RigidBody, sizes: Sizes) -> WheelPlate:
    """The plate of a ring gear, with holes for fasteners in its rim."""
    blank, name = gear_blank(wheel, body), f"{body.name} gear"
    rim = blank.radius + sizes.width / 2.0
    turns = wheel.phase + math.tau * (np.arange(_FASTENERS) + 0.5) / _FASTENERS
    places = (blank.center + rim * np.exp(1j * turns)).tolist()
    fastened = {f"{name} {k}": place for k, place in enumerate(places, start=1)}
    holes = (Opening(name=own, outline=circle(z, sizes.hole / 2.0)) for own, z in fastened.items())
    outer = rim + sizes.width / 2.0
    plate = Plate(
        name=name,
        body=body.name,
        outline=circle(blank.center, outer),
        openings=(Opening(name="teeth", outline=blank.outline), *holes),
        core=blank.core,
        radius=outer,
        inner=blank.low,
    )
    return WheelPlate(plate=plate, fastened=fastened, whole=False)
