"""Equation of a gear pair: relates the angles of its wheels."""

from linkwork.equations.part.wheel_pair import write

__all__ = ["write"]
