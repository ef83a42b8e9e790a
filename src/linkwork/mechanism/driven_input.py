"""An input of a mechanism: the driven quantity and its range."""

from __future__ import annotations

from dataclasses import dataclass

from linkwork.foundation.value_types import check_values, is_listed
from linkwork.mechanism.dimensions import Number
from linkwork.mechanism.input_law import LawSegment
from linkwork.mechanism.motor import Motor

__all__ = ["Input"]


@dataclass(frozen=True, kw_only=True)
class Input:
    """An input: the driven quantity, its range and its speed.

    Exactly one of ``link``, ``joint``, ``slider``, ``cylinder`` and ``variable`` is given.

    Parameters
    ----------
    link : str, optional
        The link whose angle is driven.
    joint : str, optional
        The pin between two links whose relative angle is driven.
    slider, cylinder : str, optional
        The slider or slot whose displacement, or the cylinder whose length, is driven.
    variable : str, optional
        The driven variable of loop equations.
    relative_to : str, optional
        With ``link``: the link from which the angle is measured; by default ground.
    start, stop, step : number or formula, optional
        The input values in file units (``from``, ``to``, ``step`` in a file). An angle without them
        makes one turn in steps of one degree. With a law they are times [s].
    speed : str or number, optional
        ``"300 rpm"``, ``"25 rad/s"``, ``"90 deg/s"``, for lengths ``"50 mm/s"``; a number is in
        file units per second.
    law : tuple of LawSegment, or str, optional
        How the input moves in time: segments one after the other from t = 0, or its value as a
        formula of t.
    begin : number or formula, optional
        With segments: its value at t = 0, by default that of the sketch or guess.
    motor : Motor, optional
        What drives it in simulations.
    inertia : number, optional
        In simulations: the moment of inertia that turns with it, a flywheel [mass · length²]; of a
        length a mass.

    Examples
    --------
    >>> import linkwork as lw
    >>> lw.Input(link="crank", start=0, stop=90, step=30, speed="300 rpm").column
    'crank'
    >>> lw.Input(link="stick", relative_to="boom").column
    'stick-boom'
    """

    link: str | None = None
    joint: str | None = None
    slider: str | None = None
    cylinder: str | None = None
    variable: str | None = None
    relative_to: str | None = None
    start: Number | None = None
    stop: Number | None = None
    step: Number | None = None
    speed: Number | None = None
    law: tuple[LawSegment, ...] | str | None = None
    begin: Number | None = None
    motor: Motor | None = None
    inertia: Number | None = None

    def __post_init__(self) -> None:
        if self.law is not None and is_listed(self.law):
            object.__setattr__(self, "law", tuple(self.law))
        check_values(self)

    @property
    def drives(self) -> tuple[str, str]:
        """``(kind, name)`` of the driven quantity; ``("", "")`` if none is named."""
        for kind in ("link", "joint", "slider", "cylinder", "variable"):
            name: str | None = getattr(self, kind)
            if name is not None:
                return kind, name
        return "", ""

    @property
    def column(self) -> str:
        """The name of the input in results, ``crank``, ``stick-boom``, ``s16``."""
        kind, name = self.drives
        if kind == "link" and self.relative_to not in (None, "ground"):
            return f"{name}-{self.relative_to}"
        return name
