"""Plates as DXF in millimetres, with arcs, by ezdxf."""

from __future__ import annotations

import io
import re
from collections.abc import Sequence
from typing import Any

from linkwork.export.plates.packages import ezdxf
from linkwork.export.plates.placing import PlacedPlate
from linkwork.export.plates.plate import PlateStack

__all__ = ["dxf_of"]

_MILLIMETRES = 4  # $INSUNITS
_ENGRAVE = "engrave"


def dxf_of(stack: PlateStack, placed: Sequence[PlacedPlate]) -> str:
    """The document: a layer for every plate, closed polylines and circles."""
    package = ezdxf()
    former = package.options.write_fixed_meta_data_for_testing
    # without times and random identifiers the same plates give the same bytes
    package.options.write_fixed_meta_data_for_testing = True
    try:
        document = package.new("R2010", units=_MILLIMETRES)
        space = document.modelspace()
        for number, item in enumerate(placed):
            _write(document, space, item, number % 6 + 1)
        if stack.sizes.labels:
            document.layers.add(_ENGRAVE, color=5)
            for item in placed:
                text, place, height = item.label(stack.sizes.width / 3.0)
                entity = space.add_text(text, height=height, dxfattribs={"layer": _ENGRAVE})
                entity.set_placement((place.real, place.imag), align=_middle())
        stream = io.StringIO()
        document.write(stream)
    finally:
        package.options.write_fixed_meta_data_for_testing = former
    return stream.getvalue()


def _middle() -> Any:
    from ezdxf.enums import TextEntityAlignment

    return TextEntityAlignment.MIDDLE_CENTER


def _write(document: Any, space: Any, item: PlacedPlate, colour: int) -> None:
    layer = re.sub(r'[<>/\\":;?*|=`,]', "_", item.name)  # characters that DXF forbids
    document.layers.add(layer, color=colour)
    for curve in item.curves:
        disc = curve.as_circle
        if disc is not None:
            center, radius = disc
            space.add_circle((center.real, center.imag), radius, dxfattribs={"layer": layer})
            continue
        corners = zip(curve.corners, curve.bulges, strict=True)
        space.add_lwpolyline(
            [(float(z.real), float(z.imag), float(bulge)) for z, bulge in corners],
            format="xyb",
            close=True,
            dxfattribs={"layer": layer},
        )
