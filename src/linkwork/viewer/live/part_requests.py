"""Requests that add, change and remove parts."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = [
    "AddPart", "DrawPart", "Picked", "RemovePart", "SetEntry", "SetMass", "SetPart", "Typed",
]  # fmt: skip

#: User input of a field: one entry or several; a row of numbers or of a table is one line,
#: "10, 20".
Typed = str | tuple[str, ...]


@dataclass(frozen=True, kw_only=True)
class AddPart:
    """Add an entry to a table of parts: sliders, gears, cams, …

    ``typed``: user input by key: text, a number, a formula, true or false; a list of names; a list
    of lines, each with the numbers or words of one row.
    """

    table: str
    typed: dict[str, str | tuple[str, ...]]


@dataclass(frozen=True, kw_only=True)
class Picked:
    """A place that was picked in the drawing [length], and the point or link there.

    ``size``: the radius that was drawn from it.
    """

    x: float
    y: float
    point: str = ""
    link: str = ""
    size: float = 0.0


@dataclass(frozen=True, kw_only=True)
class DrawPart:
    """Add a part by what was picked in the drawing, with the points and links that it lacks.

    ``span``: half the length of a line that is made for it [length].
    """

    table: str
    picks: tuple[Picked, ...]
    span: float


@dataclass(frozen=True, kw_only=True)
class SetPart:
    """Change an entry of a part: user input as of :class:`AddPart`, "" removes the entry."""

    name: str
    key: str
    typed: str | tuple[str, ...]


@dataclass(frozen=True, kw_only=True)
class RemovePart:
    """Remove a slider, slot, cylinder, gear, belt, rack, rolling wheel, cam or curve; a weld by the
    names of its two links.

    ``whole``: with the wheels, blocks and fixed points that serve nothing else.
    """

    name: str
    whole: bool = False


@dataclass(frozen=True, kw_only=True)
class SetMass:
    """Set the mass of a link; without ``mass`` it has none.

    ``x``, ``y``: its centre in the frame of the link; without them a link of two points is a
    uniform rod. ``inertia``: about the centre.
    """

    link: str
    mass: float | str | None = None
    x: float | str | None = None
    y: float | str | None = None
    inertia: float | str | None = None


@dataclass(frozen=True, kw_only=True)
class SetEntry:
    """Set or remove an entry that is no part, with all its keys: ``gravity``; ``friction`` ``of`` a
    joint; the ``motor`` and flywheel of an input; ``stops``, by number, or "" for new ones.

    ``typed``: user input as of :class:`AddPart`.
    """

    table: str
    of: str
    typed: dict[str, str | tuple[str, ...]]
    remove: bool = False
