"""Frame entries of a cylinder: a body of variable length."""

from __future__ import annotations

from linkwork.equations.part_rows import PartRows
from linkwork.mechanism.description import Key
from linkwork.mechanism.part.cylinder import Cylinder

__all__ = ["write"]


def write(cylinder: Cylinder, key: Key, rows: PartRows) -> None:
    """Add a rod with an unknown angle and length."""
    rows.frames.add_rod(cylinder.name, cylinder.between, angle=cylinder.angle_name)
