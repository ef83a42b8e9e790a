"""Where plates are in a file: assembled in the first position, or in rows on a sheet."""

from __future__ import annotations

import io
import itertools
import math
import re
import struct
import tempfile
import zipfile
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any
from xml.sax.saxutils import escape, quoteattr

import numpy as np

from linkwork.core.api.mechanism import Mechanism
from linkwork.core.drawing.scene import LIGHT
from linkwork.core.foundation.arrays import Array, IndexArray
from linkwork.core.foundation.errors import InputError
from linkwork.core.foundation.files import as_path, save_bytes, suffix_of
from linkwork.core.foundation.values import check_flags, given_or
from linkwork.core.results.motion import Motion
from linkwork.writers.plates.outlines import Outline, build123d, ezdxf, shapely
from linkwork.writers.plates.plate import Plate, PlateOptions, PlateStack
from linkwork.writers.plates.stack import stack_of

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
    lying = list(_lying(stack))
    apart = stack.sizes.width / 2.0 + stack.sizes.kerf
    sizes = [(high - low) for low, high in (box(item.curves[:1]) for item in lying)]
    area = sum((size.real + apart) * (size.imag + apart) for size in sizes)
    widest = max(size.real for size in sizes) + 2.0 * apart
    width = stack.sizes.sheet
    if width is None:
        width = max(_SQUARE * math.sqrt(area), widest)
    elif width < widest:
        raise InputError(
            f"a sheet of {width:g} mm is too narrow: the widest plate needs {widest:.4g} mm"
        )
    order = sorted(range(len(lying)), key=lambda k: (-sizes[k].imag, k))
    corner, row = complex(apart, apart), 0.0
    for k in order:
        if corner.real > apart and corner.real + sizes[k].real + apart > width:
            corner, row = complex(apart, corner.imag + row + apart), 0.0
        shift = corner - box(lying[k].curves[:1])[0]
        curves = tuple(curve.moved(shift, 1.0 + 0j) for curve in lying[k].curves)
        lying[k] = replace(lying[k], curves=curves)
        corner += sizes[k].real + apart
        row = max(row, sizes[k].imag)
    return lying


def _lying(stack: PlateStack) -> Iterator[PlacedPlate]:
    """Plates in the frames of their bodies, the longer side of their box along x."""
    for plate in stack.plates:
        curves = plate.cut(stack.sizes.kerf)
        low, high = box(curves[:1])
        turn = 1j if (high - low).imag > (high - low).real else 1.0 + 0j
        moved = tuple(curve.moved(0j, turn) for curve in curves)
        yield PlacedPlate(plate=plate, curves=moved, layer=stack.layer[plate.name], level=0.0)


# ----------------------------------------------------------------------
# Plates as DXF in millimetres, with arcs, by ezdxf.


_MILLIMETRES = 4  # $INSUNITS
_DXF_ENGRAVE = "engrave"


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
            document.layers.add(_DXF_ENGRAVE, color=5)
            for item in placed:
                text, place, height = item.label(stack.sizes.width / 3.0)
                entity = space.add_text(text, height=height, dxfattribs={"layer": _DXF_ENGRAVE})
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
        space.add_lwpolyline(
            [(float(z.real), float(z.imag), float(bulge)) for z, _, bulge in curve.sides],
            format="xyb",
            close=True,
            dxfattribs={"layer": layer},
        )


# ----------------------------------------------------------------------
# Plates as SVG in millimetres at true scale.


_LINE = 0.1  # mm: the width of lines to cut
_CUT, _SVG_ENGRAVE = "#ff0000", "#0000ff"  # colours that laser cutters distinguish
_OPACITY = 0.55


def svg_of(stack: PlateStack, placed: Sequence[PlacedPlate], *, filled: bool) -> str:
    """The document; plates of an assembly are ``filled`` with the colour of their layer."""
    low, high = box([item.curves[0] for item in placed])
    margin = stack.sizes.width / 2.0
    low, high = low - complex(margin, margin), high + complex(margin, margin)
    size = high - low
    # y grows downwards in SVG
    view = " ".join(_number(x) for x in (low.real, -high.imag, size.real, size.imag))
    lines = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{_number(size.real)}mm" '
        f'height="{_number(size.imag)}mm" viewBox="{view}">',
        f"<title>{escape(stack.mechanism)}</title>",
    ]
    for item in placed:
        lines += _group(stack, item, filled)
    return "\n".join([*lines, "</svg>", ""])


def _group(stack: PlateStack, item: PlacedPlate, filled: bool) -> Iterator[str]:
    colour = LIGHT.tones[item.layer % len(LIGHT.tones)]
    style = f'fill="{colour}" fill-opacity="{_OPACITY}"' if filled else 'fill="none"'
    yield f"<g id={quoteattr(item.name)}>"
    path = " ".join(map(_path, item.curves))
    yield (
        f'<path d="{path}" {style} fill-rule="evenodd" stroke="{_CUT}" '
        f'stroke-width="{_number(_LINE)}"/>'
    )
    if stack.sizes.labels:
        text, place, height = item.label(stack.sizes.width / 3.0)
        yield (
            f'<text x="{_number(place.real)}" y="{_number(height / 3.0 - place.imag)}" '
            f'font-size="{_number(height)}" font-family="sans-serif" '
            f'text-anchor="middle" fill="{_SVG_ENGRAVE}">{escape(text)}</text>'
        )
    yield "</g>"


def _path(curve: Outline) -> str:
    """A closed path of lines and arcs."""
    start = curve.corners[0]
    parts = [f"M{_number(start.real)} {_number(-start.imag)}"]
    for begin, end, bulge in curve.sides:
        to = f"{_number(end.real)} {_number(-end.imag)}"
        if bulge == 0.0:
            parts.append(f"L{to}")
            continue
        angle = 4.0 * math.atan(bulge)
        radius = _number(abs(end - begin) / (2.0 * abs(math.sin(angle / 2.0))))
        large, sweep = int(abs(angle) > math.pi), int(bulge < 0.0)
        parts.append(f"A{radius} {radius} 0 {large} {sweep} {to}")
    return "".join(parts) + "Z"


def _number(x: float) -> str:
    """A number that reads back within a billionth of a millimetre."""
    return f"{x + 0.0:.10g}"


# ----------------------------------------------------------------------
# Plates as closed surfaces of triangles: STL and 3MF.


_HEADER = b"Linkwork plates, millimetres".ljust(80)
_SOLIDS_FIRST_DAY = (1980, 1, 1, 0, 0, 0)  # of ZIP files: the same plates give the same bytes
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
    parts = [_HEADER, struct.pack("<I", sum(len(mesh.triangles) for mesh in meshes))]
    for mesh in meshes:
        corners = mesh.corners[mesh.triangles]
        normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        normal /= np.linalg.norm(normal, axis=1, keepdims=True)
        rows = np.zeros(len(corners), dtype=[("numbers", "<f4", 12), ("attributes", "<u2")])
        rows["numbers"] = np.concatenate([normal, corners.reshape(-1, 9)], axis=1)
        parts.append(rows.tobytes())
    return b"".join(parts)


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
            archive.writestr(zipfile.ZipInfo(name, _SOLIDS_FIRST_DAY), text, zipfile.ZIP_DEFLATED)
    return stream.getvalue()


# ----------------------------------------------------------------------
# Plates as STEP solids with true arcs, by build123d.


_TIME = re.compile(rb"(FILE_NAME\('[^']*',)'[^']*'")
_STEP_FIRST_DAY = rb"\1'1980-01-01T00:00:00'"
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
        content = _TIME.sub(_STEP_FIRST_DAY, file.read_bytes(), count=1)
    # without the time and a counter of the process the same plates give the same bytes
    number = itertools.count(1)
    return _OCCURRENCE.sub(lambda match: b"%s%d'" % (match[1], next(number)), content)


def _wire(cad: Any, curve: Outline) -> Any:
    """A closed wire of lines and arcs."""
    disc = curve.as_circle
    if disc is not None:
        center, radius = disc
        plane = cad.Plane((center.real, center.imag, 0))
        return cad.Wire([cad.Edge.make_circle(radius, plane)])
    edges = []
    for start, finish, bulge in curve.sides:
        begin, end = complex(start), complex(finish)
        ends = [(z.real, z.imag, 0) for z in (begin, end)]
        if bulge == 0.0:
            edges.append(cad.Edge.make_line(*ends))
            continue
        # the middle of an arc is a bulge of half chords to the right of it
        middle = (begin + end) / 2.0 - 0.5j * (end - begin) * bulge
        edges.append(cad.Edge.make_three_point_arc(ends[0], (middle.real, middle.imag, 0), ends[1]))
    return cad.Wire(edges)


# ----------------------------------------------------------------------
# A stack of plates as a file, in the format of its suffix.


_FORMATS = (".dxf", ".svg", ".stl", ".3mf", ".step")
#: Packages that formats need, in addition to that of outlines.
_WRITERS = {".dxf": ezdxf, ".step": build123d}


def check_plate_file(file: Path) -> str:
    """The suffix of a file of plates, if this installation can write it.

    Raises
    ------
    InputError
        If the format does not exist.
    MissingPackageError
        If a package is not installed.
    """
    suffix = suffix_of(file, "plates", _FORMATS)
    shapely()
    if suffix in _WRITERS:
        _WRITERS[suffix]()
    return suffix


def plates_of(stack: PlateStack, file: Path, *, layout: bool = False) -> bytes:
    """The content of a file of plates.

    Parameters
    ----------
    stack : PlateStack
    file : Path
        Its suffix selects the format.
    layout : bool
        Whether plates are side by side on a sheet; otherwise they are assembled.

    Raises
    ------
    InputError
        If the format does not exist, or a plate is wider than the sheet.
    MissingPackageError
        If the package that writes the format is not installed.
    """
    suffix = check_plate_file(file)
    placed = in_rows(stack) if layout else assembled(stack)
    thickness = stack.sizes.thickness
    match suffix:
        case ".svg":
            return svg_of(stack, placed, filled=not layout).encode()
        case ".dxf":
            return dxf_of(stack, placed).encode()
        case ".step":
            return step_of(stack.mechanism, placed, thickness)
    meshes = [mesh_of(item, thickness) for item in placed]
    named = list(zip([item.name for item in placed], meshes, strict=True))
    if suffix == ".3mf":
        return three_mf_of(named)
    return stl_of(meshes) if layout else separate_stl_of(named)


def write_plates(
    mechanism: Mechanism,
    path: str | Path,
    motion: Motion | None = None,
    *,
    options: PlateOptions | None = None,
    layout: bool = False,
    progress: Callable[[float], None] | None = None,
) -> PlateStack:
    """Write the links as plates to cut or print, in layers in which nothing collides.

    Parameters
    ----------
    path : str or Path
        The file; its suffix selects the format: ``.dxf``, ``.svg``, ``.stl``, ``.3mf`` or
        ``.step``.
    motion : Motion, optional
        The sweep in which nothing may collide; by default :meth:`~linkwork.Mechanism.sweep`.
    options : PlateOptions, optional
        Widths, pins, clearance, kerf and thickness.
    layout : bool
        Put the plates side by side on a sheet; otherwise they are assembled.
    progress : callable, optional
        Called with the finished fraction, 0 to 1.

    Returns
    -------
    PlateStack
        The layers, the bill of materials, and the proof of no collisions.

    Raises
    ------
    InputError
        If a part cannot be made of plates, there is no order of layers, or the file cannot be
        written.
    MissingPackageError
        If the package that writes the format is not installed.

    Examples
    --------
    >>> import linkwork as lw, tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     stack = lw.example("slider-crank").write(f"{folder}/plates.dxf", layout=True)
    >>> stack.layers, stack.proved
    (3, True)
    """
    file, chosen = as_path(path), given_or(PlateOptions(), "options", options)
    check_flags(progress, layout=layout)
    check_plate_file(file)
    cycle = mechanism.sweep() if motion is None else motion
    stack = stack_of(mechanism.model, cycle, chosen, progress)
    save_bytes(plates_of(stack, file, layout=layout), path)
    return stack
