"""Where a part pushes links in contact, as formulas of points: a place and a unit vector."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["SPAN", "Contact", "offset_contact"]

#: The distance of the points ``a`` and ``b``.
SPAN = "hypot(bx-ax, by-ay)"


@dataclass(frozen=True, kw_only=True)
class Contact:
    """A row of the sheet; ``points`` are those of the formulas' names: ``ax`` is the x of ``a``."""

    name: str
    points: dict[str, str]
    place: tuple[str, str]
    way: tuple[str, str]


def offset_contact(
    name: str, center: str, line: tuple[str, str], side: float, reach: float
) -> Contact:
    """``reach`` to the left of a line from a centre; the unit vector is to its ``side``."""
    return Contact(
        name=name,
        points={"a": line[0], "b": line[1], "c": center},
        place=(f"cx - {reach!r}*(by-ay)/{SPAN}", f"cy + {reach!r}*(bx-ax)/{SPAN}"),
        way=(f"{-side!r}*(by-ay)/{SPAN}", f"{side!r}*(bx-ax)/{SPAN}"),
    )
