"""Independent checks of plates: files read back, and solids placed by the motion's points."""

from __future__ import annotations

import io
import itertools
from functools import cache
from importlib import import_module
from typing import Any

import numpy as np

import linkwork as lw
from linkwork.core.foundation.arrays import ComplexArray, IndexArray
from linkwork.core.results.motion import Motion
from linkwork.forces.reactions.geometry import Geometry
from linkwork.writers.plates.files import Mesh, PlacedPlate, assembled, in_rows, mesh_of
from linkwork.writers.plates.plate import Plate, PlateOptions, PlateStack
from linkwork.writers.plates.stack import stack_of

__all__ = ["hole_error", "made", "overlaps", "simple", "solid_error"]

shapely: Any = import_module("shapely")


@cache
def made(mechanism: lw.Mechanism, **sizes: Any) -> tuple[PlateStack, Motion]:
    """The plates of a mechanism's own sweep."""
    motion = mechanism.sweep()
    return stack_of(mechanism.model, motion, PlateOptions(**sizes)), motion


def simple(stack: PlateStack) -> bool:
    """Whether every outline is one closed curve without self-crossing around all its openings."""
    return all(item.polygon.is_valid for item in (*assembled(stack), *in_rows(stack)))


def hole_error(mechanism: lw.Mechanism, stack: PlateStack, text: str) -> float:
    """The largest error of distances between holes of links in a DXF file, in millimetres."""
    document = import_module("ezdxf").read(io.StringIO(text))
    linkage: Any = mechanism.description
    local, worst = linkage.shapes.local, 0.0
    millimetres = {"mm": 1.0, "cm": 10.0, "m": 1000.0, "in": 25.4}[linkage.length]
    for plate in stack.plates:
        if plate.body not in local:
            continue
        layer = f"{stack.layer[plate.name]} {plate.name}"
        circles = document.modelspace().query(f'CIRCLE[layer=="{layer}"]')
        places = [complex(own.dxf.center.x, own.dxf.center.y) for own in circles]
        if plate.outline.as_circle is not None:
            del places[0]  # a plate around one hole
        points = local[plate.body]
        names = [own.name for own in plate.openings if own.outline.as_circle is not None]
        assert len(names) == len(places)
        known = [(name, z) for name, z in zip(names, places, strict=True) if name in points]
        for (a, one), (b, other) in itertools.combinations(known, 2):
            wanted = millimetres * abs(points[a] - points[b])
            worst = max(worst, abs(abs(one - other) - wanted))
    return worst


def overlaps(
    mechanism: lw.Mechanism, stack: PlateStack, motion: Motion, every: int = 1
) -> list[str]:
    """Pairs of plates of one layer that touch in a row of the motion, by the points of this."""
    geometry = Geometry(mechanism.model, motion)
    rows = np.flatnonzero(motion.found)[::every]
    millimetres = {"mm": 1.0, "cm": 10.0, "m": 1000.0, "in": 25.4}[mechanism.description.length]
    found = []
    for one, other in itertools.combinations(stack.plates, 2):
        if stack.layer[one.name] != stack.layer[other.name]:
            continue
        first, second = (_polygons(geometry, plate, millimetres, rows) for plate in (one, other))
        together = shapely.intersects(first, second)
        if (one.name, other.name) in stack.contacts:
            # a roller touches its cam in every position, up to the arcs of their polygons
            area = shapely.area(shapely.intersection(first, second))
            size = shapely.area(second)
            together = shapely.distance(first, second) > 1e-3 * np.sqrt(size)
            together |= area > 1e-4 * size
        if together.any():
            found.append(f"{one.name} and {other.name}")
    return found


def _polygons(geometry: Geometry, plate: Plate, millimetres: float, rows: IndexArray) -> Any:
    """A plate in some rows, a ring with its inner edge, other plates with their holes filled."""
    edges = [own.outline for own in plate.openings if own.name == "teeth"]
    rings = []
    for outline in (plate.outline, *edges):
        local = outline.polygon() / millimetres
        if plate.body == "ground":
            placed: ComplexArray = np.tile(local, (len(rows), 1))
        else:
            origin = geometry.place(geometry.links[plate.body][0]).v[rows, None]
            placed = origin + geometry.direction(plate.body).v[rows, None] * local
        rings.append(shapely.linearrings(np.stack([placed.real, placed.imag], axis=-1)))
    return shapely.polygons(rings[0], rings[1][:, None] if edges else None)


def solid_error(stack: PlateStack, item: PlacedPlate) -> float:
    """The relative error of a solid's volume; infinite if its surface is not closed."""
    thickness = stack.sizes.thickness
    mesh: Mesh = mesh_of(item, thickness)
    solid = import_module("trimesh").Trimesh(mesh.corners, mesh.triangles, process=False)
    if not (solid.is_watertight and solid.is_winding_consistent):
        return np.inf
    outer, *inner = item.curves
    exact = thickness * (outer.area - sum(curve.area for curve in inner))
    return abs(float(solid.volume) - exact) / exact
