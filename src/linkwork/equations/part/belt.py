"""Equation of a belt: relates the angles of its wheels."""

from linkwork.equations.part.wheel_pair import write

__all__ = ["write"]
