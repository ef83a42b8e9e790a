"""Requests that change many entries of the file at once: units, names, copies."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, kw_only=True)
class ChangeUnits:
    """Another unit of lengths or angles; empty: as before.

    ``convert``: every number is converted, so that the mechanism stays as large as it is; otherwise
    the numbers stay.
    """

    convert: bool
    length: str = ""
    angle: str = ""


@dataclass(frozen=True, kw_only=True)
class Rename:
    """Another name for a point, link or part, in all of the file. ``of``: point, link or part."""

    of: str
    name: str
    new: str


@dataclass(frozen=True, kw_only=True)
class Duplicate:
    """Copy points and links, with the parts between them.

    By the names of points and links: ``names`` of the copies, the same for a point that is shared,
    and ``places`` of new points [length]. ``mirrored``: the copy is a mirror image.
    """

    names: dict[str, str]
    places: dict[str, tuple[float, float]]
    mirrored: bool = False


@dataclass(frozen=True, kw_only=True)
class Mirror:
    """Move points to mirrored places [length]; the dimensions between them stay."""

    places: dict[str, tuple[float, float]]


@dataclass(frozen=True, kw_only=True)
class AddOutput:
    """Add a named formula of results to the file."""

    name: str
    formula: str
