"""Plates of library mechanisms, read back by ezdxf and trimesh, moved through the sweep."""

from __future__ import annotations

import io
import re
import tempfile
from importlib import import_module
from pathlib import Path

import linkwork as lw
from linkwork.core.foundation.errors import InputError
from linkwork.writers.plates.files import assembled, plates_of
from linkwork.writers.plates.plate import PlateStack
from tests.writers.plate_checks import hole_error, made, overlaps, simple, solid_error

__all__ = ["READERS", "compared_plates"]

#: Packages that read the formats.
READERS = {".dxf": "ezdxf", ".step": "build123d"}


def compared_plates(name: str, suffix: str) -> str:
    """Errors of holes and volumes, and plates that touch; or why there are no plates."""
    mechanism = lw.example(name)
    try:
        stack, motion = made(mechanism)
    except InputError as error:
        return f"refused: {error}"
    if suffix == ".step":
        return _stepped(stack)
    text = plates_of(stack, Path("a.dxf")).decode()
    holes = hole_error(mechanism, stack, text)
    volume = max(solid_error(stack, item) for item in assembled(stack))
    touching = overlaps(mechanism, stack, motion)
    faults = import_module("ezdxf").read(io.StringIO(text)).audit().errors
    fine = holes <= 1e-9 and volume <= 1e-3 and simple(stack) and not touching and not faults
    proved = "proved" if stack.proved else "checked"
    found = (
        f"{len(stack.plates)} plates, {stack.layers} layers, holes {holes:.0e} mm, volume "
        f"{volume:.1e}, {int(motion.found.sum())} positions, {proved}"
    )
    return found + ("" if fine else f" WRONG {touching}")


def _stepped(stack: PlateStack) -> str:
    """Volumes of the solids of a STEP file, read back, and the number of its arcs."""
    cad = import_module("build123d")
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder, "a.step")
        content = plates_of(stack, file)
        file.write_bytes(content)
        solids = cad.import_step(str(file)).solids()
    thickness = stack.sizes.thickness
    wanted = sorted(thickness * plate.area for plate in stack.plates)
    found = sorted(float(solid.volume) for solid in solids)
    error = max(abs(a - b) / b for a, b in zip(found, wanted, strict=True))
    arcs = len(re.findall(rb"CYLINDRICAL_SURFACE\(", content))
    valid = all(solid.is_valid for solid in solids)
    wrong = "" if error <= 1e-9 and valid and arcs else " WRONG"
    return f"{len(solids)} solids, volume {error:.0e}, {arcs} cylinders{wrong}"
