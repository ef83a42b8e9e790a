"""Plates as SVG in millimetres at true scale."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from xml.sax.saxutils import escape, quoteattr

from linkwork.drawing.theme import LIGHT
from linkwork.export.plates.outline import Outline
from linkwork.export.plates.placing import PlacedPlate, box
from linkwork.export.plates.plate import PlateStack

__all__ = ["svg_of"]

_LINE = 0.1  # mm: the width of lines to cut
_CUT, _ENGRAVE = "#ff0000", "#0000ff"  # colours that laser cutters tell apart
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
            f'text-anchor="middle" fill="{_ENGRAVE}">{escape(text)}</text>'
        )
    yield "</g>"


def _path(curve: Outline) -> str:
    """A closed path of lines and arcs."""
    start = curve.corners[0]
    parts = [f"M{_number(start.real)} {_number(-start.imag)}"]
    for begin, end, bulge in zip(curve.corners, curve.ends, curve.bulges, strict=True):
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
