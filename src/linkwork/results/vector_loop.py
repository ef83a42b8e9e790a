"""The loop equations of one position as vectors: what a vector diagram shows."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["LoopVector", "VectorLoop"]


@dataclass(frozen=True, kw_only=True)
class LoopVector:
    """One term of a loop equation at one position.

    Parameters
    ----------
    name : str
        What the equation calls it, in polar form: ``a2∠θ12``.
    value : complex
        What the term adds to its side: x + iy, in the mechanism's length unit.
    backwards : bool
        Whether the equation takes the named vector off: the arrow then points against ``value``.
    """

    name: str
    value: complex
    backwards: bool = False


@dataclass(frozen=True, kw_only=True)
class VectorLoop:
    """A loop equation at one position: both sides lead from one place to another.

    ``label`` is the loop's name in the file, or the points it passes.
    """

    label: str
    left: tuple[LoopVector, ...]
    right: tuple[LoopVector, ...]
