"""The loop equations of a position or a motion as vectors, for vector diagrams."""

from __future__ import annotations

from dataclasses import dataclass

from linkwork.core.foundation.arrays import ComplexArray


@dataclass(frozen=True, kw_only=True)
class LoopVector:
    """One term of a loop equation at one position.

    Parameters
    ----------
    name : str
        Its name in the equation, in polar form: ``a2∠θ12``.
    value : complex
        The value of the term: x + iy, in the mechanism's length unit.
    backwards : bool
        Whether the equation subtracts the named vector: the arrow then points against ``value``.
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


@dataclass(frozen=True, kw_only=True, eq=False)
class MovingVector:
    """One term of a loop equation over the rows of a motion: ``values`` (N,), NaN where there is no
    position; else as :class:`LoopVector`.
    """

    name: str
    values: ComplexArray
    backwards: bool = False

    def at(self, row: int) -> LoopVector:
        """The vector in a row."""
        value = complex(self.values[row])
        return LoopVector(name=self.name, value=value, backwards=self.backwards)


@dataclass(frozen=True, kw_only=True, eq=False)
class MovingLoop:
    """A loop equation over the rows of a motion."""

    label: str
    left: tuple[MovingVector, ...]
    right: tuple[MovingVector, ...]

    def at(self, row: int) -> VectorLoop:
        """The loop in a row."""
        return VectorLoop(
            label=self.label,
            left=tuple(vector.at(row) for vector in self.left),
            right=tuple(vector.at(row) for vector in self.right),
        )
