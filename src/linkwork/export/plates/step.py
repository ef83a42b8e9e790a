"""Plates as STEP solids with true arcs, by build123d."""

from __future__ import annotations

import itertools
import re
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from linkwork.export.plates.outline import Outline
from linkwork.export.plates.packages import build123d
from linkwork.export.plates.placing import PlacedPlate

__all__ = ["step_of"]

_TIME = re.compile(rb"(FILE_NAME\('[^']*',)'[^']*'")
_FIRST_DAY = rb"\1'1980-01-01T00:00:00'"
_OCCURRENCE = re.compile(rb"(NEXT_ASSEMBLY_USAGE_OCCURRENCE\(')\d+'")


def step_of(name: str, placed: Sequence[PlacedPlate], thickness: float) -> bytes:
    """An assembly with one named solid for each plate."""
    cad = build123d()
    solids = []
    for item in placed:
        face = cad.Face(_wire(cad, item.curves[0]), [_wire(cad, c) for c in item.curves[1:]])
        solid = cad.Solid.extrude(face, cad.Vector(0, 0, thickness))
        solid.position = cad.Vector(0, 0, item.level)
        solid.label = item.plate.name
        solids.append(solid)
    whole = cad.Compound(label=name, children=solids)
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder, "plates.step")
        cad.export_step(whole, str(file))
        content = _TIME.sub(_FIRST_DAY, file.read_bytes(), count=1)
    # without the time and a counter of the process the same plates give the same bytes
    number = itertools.count(1)
    return _OCCURRENCE.sub(lambda own: b"%s%d'" % (own[1], next(number)), content)


def _wire(cad: Any, curve: Outline) -> Any:
    """A closed wire of lines and arcs."""
    disc = curve.as_circle
    if disc is not None:
        center, radius = disc
        plane = cad.Plane((center.real, center.imag, 0))
        return cad.Wire([cad.Edge.make_circle(radius, plane)])
    edges = []
    for begin, end, bulge in zip(
        curve.corners.tolist(), curve.ends.tolist(), curve.bulges.tolist(), strict=True
    ):
        ends = [(z.real, z.imag, 0) for z in (begin, end)]
        if bulge == 0.0:
            edges.append(cad.Edge.make_line(*ends))
            continue
        # the middle of an arc is a bulge of half chords to the right of it
        middle = (begin + end) / 2.0 - 0.5j * (end - begin) * bulge
        edges.append(cad.Edge.make_three_point_arc(ends[0], (middle.real, middle.imag, 0), ends[1]))
    return cad.Wire(edges)
