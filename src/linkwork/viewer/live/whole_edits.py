"""Requests that change many entries of the file at once: units, names, copies."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["ChangeUnits"]


@dataclass(frozen=True, kw_only=True)
class ChangeUnits:
    """Another unit of lengths or angles; empty: as before.

    ``convert``: every number is converted, so that the mechanism stays as large as it is; otherwise
    the numbers stay.
    """

    convert: bool
    length: str = ""
    angle: str = ""
