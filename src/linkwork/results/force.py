"""Forces at points, for drawings."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

from linkwork.foundation.errors import InputError, UnknownNameError, choices
from linkwork.foundation.value_types import check_values

__all__ = ["Force", "check_forces", "force_unit"]


@dataclass(frozen=True, kw_only=True)
class Force:
    """A force at a point, for drawings and pages; it is given, not computed.

    Parameters
    ----------
    at : str
        The name of the point.
    x, y : float
        Components along the axes of the ground, in ``unit``.
    unit : str
        For example ``N``; all forces of a picture have the same unit.

    Raises
    ------
    InputError
        If a component is not finite.

    Examples
    --------
    >>> import linkwork as lw
    >>> lw.Force(at="B", x=0, y=-981, unit="N")
    Force(at='B', x=0, y=-981, unit='N')
    """

    at: str
    x: float
    y: float
    unit: str = ""

    def __post_init__(self) -> None:
        check_values(self)
        if not (math.isfinite(self.x) and math.isfinite(self.y)):
            raise InputError(f"the force at {self.at} is not finite: {self.x:g}, {self.y:g}")


def force_unit(forces: Iterable[Force]) -> str:
    """The unit that all forces have.

    Raises
    ------
    InputError
        If they have different ones.
    """
    units = dict.fromkeys(force.unit for force in forces)
    if len(units) > 1:
        listed = ", ".join(unit or "none" for unit in units)
        raise InputError(f"forces of one picture need one unit, these have several: {listed}")
    return next(iter(units), "")


def check_forces(forces: Iterable[Force], points: Iterable[str]) -> None:
    """Refuse forces at points that are not there, and units that differ.

    Raises
    ------
    UnknownNameError, InputError
    """
    known, every = tuple(points), tuple(forces)
    for force in every:
        if force.at not in known:
            raise UnknownNameError(
                f'there is no point "{force.at}" for a force {choices("points", known, force.at)}'
            )
    force_unit(every)
