"""TikZ pictures of library mechanisms, compiled by LaTeX and measured in the PDF."""

from __future__ import annotations

import re
import shutil
import subprocess
from pathlib import Path

import numpy as np

import linkwork as lw
from linkwork.core.drawing.scene import Arc, Disc, Hatch, Polygon, Polyline, Primitive
from linkwork.core.drawing.vector_files import tikz_picture
from linkwork.core.foundation.arrays import Array
from linkwork.core.foundation.errors import InputError
from linkwork.core.foundation.units import LENGTHS

__all__ = ["compared_picture", "has_latex"]

_ALLOWED = 0.1  # mm on the page
_ROUNDED = 0.001  # of coordinates in the file [mm]
_MM = 25.4 / 72.0  # of a point of PDF
_HEAD = (
    "\\documentclass[border=2mm]{standalone}\\usepackage{tikz}\n"
    "\\pdfcompresslevel=0 \\pdfobjcompresslevel=0\n"
)
_NUMBER = rb"(-?\d*\.?\d+)"
#: End points of paths: move, line, curve.
_PATH = re.compile(rb"(?:^|\s)" + _NUMBER + rb" " + _NUMBER + rb" [mlc]\b")
_MATRIX = re.compile(rb"((?:" + _NUMBER.replace(b"(", b"(?:") + rb"\s){4})\S+ \S+ cm\b")
_SCALE = re.compile(r"scale (\d+):(\d+)")
_AT_ONCE = 400  # places


def has_latex() -> bool:
    """Whether this machine has pdfLaTeX."""
    return shutil.which("pdflatex") is not None


def compared_picture(name: str, folder: Path) -> str:
    """How far points of the drawing, and of the mechanism, are from those of the PDF [mm]."""
    mechanism = lw.example(name)
    try:
        start = mechanism.solve()
        scene = mechanism.scene(dict(start.input))
    except InputError as error:
        return f"refused: {error}"
    text = tikz_picture(scene)
    drawn = _points_of(_compiled(text, folder))
    first, second = map(int, _SCALE.findall(text)[0])
    scale = float(LENGTHS.get(scene.unit, LENGTHS["mm"])) * 1000 * first / second
    vertices = np.array([p for primitive in scene.primitives for p in _vertices(primitive)])
    points = np.array(list(start.points.values()))
    # a point inside a symbol, as the pin of a sliding block, has no mark of its own
    marked = points[_gaps(points, vertices) * scale < _ROUNDED]
    away, off = (float(_gaps(scale * places, drawn).max()) for places in (vertices, marked))
    return (
        f"{len(vertices)} vertices {away:.3f} mm, {len(marked)} of {len(points)} points "
        f"{off:.3f} mm, {first}:{second}{'' if max(away, off) <= _ALLOWED else ' WRONG'}"
    )


def _compiled(picture: str, folder: Path) -> bytes:
    """The PDF of a picture, without compression; a failure of LaTeX is raised with its message."""
    (folder / "picture.tex").write_text(
        f"{_HEAD}\\begin{{document}}\n{picture}\\end{{document}}\n", "utf-8"
    )
    command = ["pdflatex", "-halt-on-error", "-interaction=nonstopmode", "picture.tex"]
    done = subprocess.run(command, cwd=folder, capture_output=True, check=False, timeout=120)
    if done.returncode:
        said = done.stdout.decode("utf-8", "replace")
        raise RuntimeError(next((x for x in said.split("\n") if x.startswith("!")), said[-400:]))
    return (folder / "picture.pdf").read_bytes()


def _points_of(pdf: bytes) -> Array:
    """The end points of all paths of the page, (K, 2) [mm] from the origin of the picture."""
    page = pdf[: pdf.find(b"endstream")]
    if any(list(map(float, m.split())) != [1.0, 0.0, 0.0, 1.0] for m in _MATRIX.findall(page)):
        raise RuntimeError("a part of the picture is scaled or turned: it cannot be measured")
    found = [(float(x), float(y)) for x, y in _PATH.findall(page)]
    return np.array(found) * _MM


def _vertices(primitive: Primitive) -> tuple[tuple[float, float], ...]:
    match primitive:
        case Polyline() | Arc():
            return (*primitive.shaft, *primitive.arrow_head)
        case Hatch():
            return tuple(point for stroke in primitive.strokes for point in stroke)
        case Polygon():
            return primitive.points
        case Disc():
            return (primitive.centre,)
    return ()


def _gaps(places: Array, others: Array) -> Array:
    """The distance of each place (K, 2) from the nearest of the others, (K,)."""
    parts = (places[k : k + _AT_ONCE] for k in range(0, len(places), _AT_ONCE))
    every = [np.linalg.norm(part[:, None] - others[None], axis=2).min(axis=1) for part in parts]
    return np.concatenate(every)
