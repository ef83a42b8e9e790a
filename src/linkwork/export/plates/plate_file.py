"""A stack of plates as a file, in the format of its suffix."""

from __future__ import annotations

from pathlib import Path

from linkwork.export.plates import packages
from linkwork.export.plates.dxf import dxf_of
from linkwork.export.plates.placing import assembled, in_rows
from linkwork.export.plates.plate import PlateStack
from linkwork.export.plates.solids import mesh_of, separate_stl_of, stl_of, three_mf_of
from linkwork.export.plates.step import step_of
from linkwork.export.plates.svg import svg_of
from linkwork.foundation.paths import suffix_of

__all__ = ["check_plate_file", "plates_of"]

_FORMATS = (".dxf", ".svg", ".stl", ".3mf", ".step")
#: Packages that formats need, in addition to that of outlines.
_WRITERS = {".dxf": packages.ezdxf, ".step": packages.build123d}


def check_plate_file(file: Path) -> str:
    """The suffix of a file of plates, if this installation can write it.

    Raises
    ------
    InputError
        If there is no such format.
    MissingPackageError
        If a package is not installed.
    """
    suffix = suffix_of(file, "plates", _FORMATS)
    packages.shapely()
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
        If there is no such format, or a plate is wider than the sheet.
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
