"""The area that two boxes share."""

from __future__ import annotations

from linkwork.core.drawing.scene import Box

__all__ = ["shared_area"]


def shared_area(one: Box, other: Box) -> float:
    """Zero if they only touch."""
    width = min(one.right, other.right) - max(one.left, other.left)
    height = min(one.top, other.top) - max(one.bottom, other.bottom)
    return max(width, 0.0) * max(height, 0.0)
