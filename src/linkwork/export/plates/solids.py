"""Plates as closed surfaces of triangles: STL and 3MF."""

from __future__ import annotations

import io
import struct
import zipfile
from collections.abc import Sequence
from dataclasses import dataclass
from xml.sax.saxutils import quoteattr

import numpy as np

from linkwork.export.plates.packages import shapely
from linkwork.export.plates.placing import PlacedPlate
from linkwork.foundation.arrays import Array, IndexArray

__all__ = ["Mesh", "mesh_of", "separate_stl_of", "stl_of", "three_mf_of"]

_HEADER = b"Linkwork plates, millimetres".ljust(80)
_FIRST_DAY = (1980, 1, 1, 0, 0, 0)  # of ZIP files: the same plates give the same bytes
_TYPES = (
    '<?xml version="1.0" encoding="UTF-8"?>\n'
    '<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types">'
    '<Default Extension="rels" '
    'ContentType="application/vnd.openxmlformats-package.relationships+xml"/>'
    '<Default Extension="model" '
    'ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/></Types>'
)
_RELATIONS = (
    '<?xml version="1.0" encoding="UTF-8"?>\n'
    '<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships">'
    '<Relationship Target="/3D/3dmodel.model" Id="rel0" '
    'Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>'
)


@dataclass(frozen=True, kw_only=True, eq=False)
class Mesh:
    """A closed surface: corners (V, 3) [mm], triangles (T, 3), counter-clockwise from outside."""

    corners: Array
    triangles: IndexArray


def mesh_of(item: PlacedPlate, thickness: float) -> Mesh:
    """The solid of a plate, its arcs as inscribed polygons.

    Notes
    -----
    Both faces are triangulated between the corners of the curves alone, so that faces and edges
    share their corners.
    """
    rings = [curve.polygon() for curve in item.curves]
    flat = np.concatenate(rings)
    count = len(flat)
    number = {(z.real, z.imag): k for k, z in enumerate(flat.tolist())}
    faces = []
    for triangle in shapely().get_parts(shapely().constrained_delaunay_triangles(item.polygon)):
        a, b, c = (number[x, y] for x, y in triangle.exterior.coords[:3])
        left = ((flat[b] - flat[a]).conjugate() * (flat[c] - flat[a])).imag > 0.0
        faces.append((a, b, c) if left else (a, c, b))
    top = np.array(faces, dtype=np.intp)
    sides, begin = [], 0
    for k, ring in enumerate(rings):
        here = begin + np.arange(len(ring))
        there = np.roll(here, -1)
        if k:  # openings run counter-clockwise too, and have the material outside
            here, there = there, here
        sides += [
            np.stack([here, there, there + count], axis=1),
            np.stack([here, there + count, here + count], axis=1),
        ]
        begin += len(ring)
    low, high = np.full(count, item.level), np.full(count, item.level + thickness)
    return Mesh(
        corners=np.stack(
            [np.tile(flat.real, 2), np.tile(flat.imag, 2), np.concatenate([low, high])], axis=1
        ),
        triangles=np.concatenate([top[:, ::-1], top + count, *sides]),
    )


def stl_of(meshes: Sequence[Mesh]) -> bytes:
    """All solids in one binary STL file, which does not separate solids that touch."""
    found = [_HEADER, struct.pack("<I", sum(len(mesh.triangles) for mesh in meshes))]
    for mesh in meshes:
        corners = mesh.corners[mesh.triangles]
        normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        normal /= np.linalg.norm(normal, axis=1, keepdims=True)
        rows = np.zeros(len(corners), dtype=[("numbers", "<f4", 12), ("attributes", "<u2")])
        rows["numbers"] = np.concatenate([normal, corners.reshape(-1, 9)], axis=1)
        found.append(rows.tobytes())
    return b"".join(found)


def separate_stl_of(named: Sequence[tuple[str, Mesh]]) -> bytes:
    """A text STL file with one named solid for each plate, however they touch."""
    lines = []
    for name, mesh in named:
        # readers expect one line of ASCII
        plain = " ".join(name.encode("ascii", "replace").decode().split())
        lines.append(f"solid {plain}")
        for corners in mesh.corners[mesh.triangles] + 0.0:
            normal = np.cross(corners[1] - corners[0], corners[2] - corners[0])
            x, y, z = (normal / np.linalg.norm(normal) + 0.0).tolist()
            lines += [f"facet normal {x:.6g} {y:.6g} {z:.6g}", "outer loop"]
            lines += [f"vertex {x:.9g} {y:.9g} {z:.9g}" for x, y, z in corners.tolist()]
            lines += ["endloop", "endfacet"]
        lines.append(f"endsolid {plain}")
    return "\n".join([*lines, ""]).encode()


def three_mf_of(named: Sequence[tuple[str, Mesh]]) -> bytes:
    """A 3MF file with one named object for each solid."""
    objects, items = [], []
    for k, (name, mesh) in enumerate(named, start=1):
        vertices = "".join(
            f'<vertex x="{x:.9g}" y="{y:.9g}" z="{z:.9g}"/>' for x, y, z in mesh.corners + 0.0
        )
        triangles = "".join(
            f'<triangle v1="{a}" v2="{b}" v3="{c}"/>' for a, b, c in mesh.triangles.tolist()
        )
        objects.append(
            f'<object id="{k}" type="model" name={quoteattr(name)}><mesh>'
            f"<vertices>{vertices}</vertices><triangles>{triangles}</triangles></mesh></object>"
        )
        items.append(f'<item objectid="{k}"/>')
    model = (
        '<?xml version="1.0" encoding="UTF-8"?>\n<model unit="millimeter" xml:lang="en-US" '
        'xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02">'
        f"<resources>{''.join(objects)}</resources><build>{''.join(items)}</build></model>"
    )
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, text in (
            ("[Content_Types].xml", _TYPES),
            ("_rels/.rels", _RELATIONS),
            ("3D/3dmodel.model", model),
        ):
            archive.writestr(zipfile.ZipInfo(name, _FIRST_DAY), text, zipfile.ZIP_DEFLATED)
    return stream.getvalue()
