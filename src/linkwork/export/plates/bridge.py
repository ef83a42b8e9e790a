"""A bridge: a second plate of the ground above all others, on columns, for some of its pins."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from linkwork.export.plates.construction import Construction
from linkwork.export.plates.plate import BASE, BRIDGE, Pin, Plate
from linkwork.foundation.arrays import ComplexArray
from linkwork.foundation.names import GROUND

__all__ = ["bridged", "columns_around"]


def columns_around(
    made: Construction, poses: dict[str, tuple[ComplexArray, ComplexArray]]
) -> tuple[complex, ...]:
    """Places of columns at the corners of the box in which all moving plates stay [mm]."""
    places = [
        (
            poses[plate.body][0][:, None]
            + poses[plate.body][1][:, None] * np.concatenate(plate.core),
            plate.radius,
        )
        for plate in made.plates
        if plate.body != GROUND
    ]
    ends = [
        [f(z.real) + s * r for z, r in places] + [f(z.imag) + s * r for z, r in places]
        for f, s in ((np.min, -1.0), (np.max, 1.0))
    ]
    count, room = len(places), made.sizes.spacer / 2.0 + 2.0 * made.sizes.gap
    x = min(ends[0][:count]) - room, max(ends[1][:count]) + room
    y = min(ends[0][count:]) - room, max(ends[1][count:]) + room
    return tuple(complex(a, b) for a, b in itertools.product(x, y))


def bridged(
    made: Construction, corners: Sequence[complex]
) -> Iterator[tuple[list[Plate], list[Pin]]]:
    """The plates and pins with a bridge, for every choice of pins that it holds, few first.

    The bridge is the last plate; columns are the last pins.
    """
    own = [
        pin.name
        for pin in made.pins
        if BASE in pin.plates and pin.name in made.holes[GROUND] and not pin.fixed
    ]
    columns = {f"column {k}": place for k, place in enumerate(corners, start=1)}
    both = frozenset((BASE, BRIDGE))
    held = [
        Pin(name=name, body=GROUND, place=place, plates=both, fixed=True)
        for name, place in columns.items()
    ]
    for count in range(1, len(own) + 1):
        for chosen in itertools.combinations(own, count):
            holes = {name: made.holes[GROUND][name] for name in chosen}
            below = {name: z for name, z in made.holes[GROUND].items() if name not in chosen}
            base = made.ground_plate(BASE, below | columns)
            bridge = made.ground_plate(BRIDGE, holes | columns)
            pins = [
                replace(pin, plates=(pin.plates - {BASE}) | {BRIDGE}) if pin.name in chosen else pin
                for pin in made.pins
            ]
            yield [base, *made.plates[1:], bridge], [*pins, *held]
