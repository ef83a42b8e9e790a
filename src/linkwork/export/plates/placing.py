"""Where plates are in a file: assembled in the first position, or in rows on a sheet."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from linkwork.export.plates.outline import Outline
from linkwork.export.plates.packages import shapely
from linkwork.export.plates.plate import Plate, PlateStack
from linkwork.foundation.errors import InputError

__all__ = ["PlacedPlate", "assembled", "in_rows"]

_NEAR, _ROOM = 0.25, 0.6  # of the letters' height; of the radius of the room for them
_SQUARE = 1.3  # of a sheet's width to the side of a square of the boxes' area


@dataclass(frozen=True, kw_only=True, eq=False)
class PlacedPlate:
    """A plate with its curves to cut, outline first, moved to its place.

    ``level``: of its lower face [mm]; ``layer``: its number.
    """

    plate: Plate
    curves: tuple[Outline, ...]
    layer: int
    level: float

    @property
    def name(self) -> str:
        """The name of its layer in files."""
        return f"{self.layer} {self.plate.name}"

    @property
    def polygon(self) -> Any:
        """The material as a polygon of shapely."""
        outer, *inner = ([(z.real, z.imag) for z in curve.polygon()] for curve in self.curves)
        return shapely().Polygon(outer, inner)

    def label(self, height: float) -> tuple[str, complex, float]:
        """Its name, where there is most room for it, and the height of its letters [mm]."""
        line = shapely().maximum_inscribed_circle(self.polygon, _NEAR * height)
        x, y = line.coords[0]
        return self.plate.name, complex(x, y), min(height, _ROOM * line.length)


def box(curves: Sequence[Outline]) -> tuple[complex, complex]:
    """The lower left and the upper right corner around curves."""
    z = np.concatenate([curve.polygon() for curve in curves])
    return (
        complex(z.real.min(), z.imag.min()),
        complex(z.real.max(), z.imag.max()),
    )


def assembled(stack: PlateStack) -> list[PlacedPlate]:
    """Plates where they are in the first position, one layer upon the other."""
    return [
        PlacedPlate(
            plate=plate,
            curves=tuple(c.moved(*stack.poses[plate.body]) for c in plate.cut(stack.sizes.kerf)),
            layer=stack.layer[plate.name],
            level=stack.layer[plate.name] * stack.sizes.thickness,
        )
        for plate in sorted(stack.plates, key=lambda plate: stack.layer[plate.name])
    ]


def in_rows(stack: PlateStack) -> list[PlacedPlate]:
    """Plates side by side in rows on a sheet, the highest first [mm].

    Raises
    ------
    InputError
        If a plate is wider than the sheet.
    """
    own = list(_lying(stack))
    apart = stack.sizes.width / 2.0 + stack.sizes.kerf
    sizes = [(high - low) for low, high in (box(item.curves[:1]) for item in own)]
    area = sum((size.real + apart) * (size.imag + apart) for size in sizes)
    widest = max(size.real for size in sizes) + 2.0 * apart
    width = stack.sizes.sheet
    if width is None:
        width = max(_SQUARE * math.sqrt(area), widest)
    elif width < widest:
        raise InputError(
            f"a sheet of {width:g} mm is too narrow: the widest plate needs {widest:.4g} mm"
        )
    order = sorted(range(len(own)), key=lambda k: (-sizes[k].imag, k))
    places: dict[int, complex] = {}
    corner, row = complex(apart, apart), 0.0
    for k in order:
        if corner.real > apart and corner.real + sizes[k].real + apart > width:
            corner, row = complex(apart, corner.imag + row + apart), 0.0
        places[k] = corner
        corner += sizes[k].real + apart
        row = max(row, sizes[k].imag)
    found = []
    for k, item in enumerate(own):
        shift = places[k] - box(item.curves[:1])[0]
        curves = tuple(curve.moved(shift, 1.0 + 0j) for curve in item.curves)
        found.append(PlacedPlate(plate=item.plate, curves=curves, layer=item.layer, level=0.0))
    return found


def _lying(stack: PlateStack) -> Iterator[PlacedPlate]:
    """Plates in the frames of their bodies, the longer side of their box along x."""
    for plate in stack.plates:
        curves = plate.cut(stack.sizes.kerf)
        low, high = box(curves[:1])
        turn = 1j if (high - low).imag > (high - low).real else 1.0 + 0j
        moved = tuple(curve.moved(0j, turn) for curve in curves)
        yield PlacedPlate(plate=plate, curves=moved, layer=stack.layer[plate.name], level=0.0)
