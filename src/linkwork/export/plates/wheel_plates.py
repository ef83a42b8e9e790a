"""Plates of gears: a wheel with holes, or a ring, and what fastens it to the body's other plate."""

from __future__ import annotations

import cmath
import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from linkwork.export.plates.gears import Wheel, involute_outline
from linkwork.export.plates.options import Sizes
from linkwork.export.plates.outline import circle
from linkwork.export.plates.plate import Opening, Plate
from linkwork.export.plates.rigid_bodies import RigidBody
from linkwork.foundation.errors import InputError

__all__ = ["WheelPlate", "wheel_plate"]

_FASTENERS = 3  # of a ring


@dataclass(frozen=True, kw_only=True)
class WheelPlate:
    """A gear's plate; ``fastened``: holes for fasteners to the body's main plate.

    ``whole``: the body has no other plate.
    """

    plate: Plate
    fastened: Mapping[str, complex]
    whole: bool


def wheel_plate(
    wheel: Wheel, body: RigidBody, holes: Mapping[str, complex], sizes: Sizes, *, guided: bool
) -> WheelPlate:
    """The plate of a gear.

    Parameters
    ----------
    wheel : Wheel
        Its phase is that in the frame of the body.
    holes : Mapping[str, complex]
        The holes of the body by point [mm].
    guided : bool
        Whether the body has slots or guides, or is the ground: its main plate holds them.

    Raises
    ------
    InputError
        If the gear is too small for its hole.
    """
    center = body.places[wheel.disc.center]
    outline, name = involute_outline(wheel, center), f"{body.name} gear"
    low, high = wheel.radii
    hole = sizes.hole / 2.0
    if wheel.disc.ring:
        rim = high + sizes.width / 2.0
        turns = wheel.phase + math.tau * (np.arange(_FASTENERS) + 0.5) / _FASTENERS
        places = (center + rim * np.exp(1j * turns)).tolist()
        fastened = {f"{name} {k}": place for k, place in enumerate(places, start=1)}
        openings = [Opening(name="teeth", outline=outline)]
        outline, outer, inner, whole = circle(center, rim + sizes.width / 2.0), rim, low, False
        outer += sizes.width / 2.0
    else:
        room = low - hole - sizes.wall
        if room < 0.0:
            raise InputError(
                f'the gear of "{wheel.disc.link}" is too small for its hole of {sizes.hole:g} mm: '
                "choose smaller pins"
            )
        within = {point: z for point, z in holes.items() if abs(z - center) <= room}
        whole = len(within) == len(holes) and not guided
        name = body.name if whole else name
        openings = [Opening(name=p, outline=circle(z, hole)) for p, z in within.items()]
        fastened, outer, inner = {}, high, 0.0
        if not whole and len(within) < 2:
            away = max(holes.values(), key=lambda z: abs(z - center)) - center
            # as far out as there is room, or half-way to the next hole
            free = abs(away) - room >= sizes.hole + sizes.web
            reach = room if free else min(room, abs(away) / 2.0)
            place = center + cmath.rect(reach, cmath.phase(away))
            fastened = {f"{name} 1": place}
    openings += [Opening(name=own, outline=circle(z, hole)) for own, z in fastened.items()]
    plate = Plate(
        name=name,
        body=body.name,
        outline=outline,
        openings=tuple(openings),
        core=np.array([center]),
        radius=outer,
        inner=inner,
    )
    return WheelPlate(plate=plate, fastened=fastened, whole=whole)
