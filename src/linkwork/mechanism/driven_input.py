"""An input of a mechanism: what is driven, and over which values."""

from __future__ import annotations

from dataclasses import dataclass

from linkwork.mechanism.dimensions import Number

__all__ = ["Input"]


@dataclass(frozen=True, kw_only=True)
class Input:
    """What is driven, and over which values.

    Exactly one of ``link`` (its angle), ``joint`` (the angle between the two links of a pin),
    ``slider``, ``cylinder`` (their displacement or length) or ``variable`` (a name of the
    equations) is given.

    Parameters
    ----------
    relative_to : str, optional
        With ``link``: the link against which the angle is measured, ground unless given.
    start, stop, step : number or formula, optional
        The table's input values in the file's unit (``from``, ``to``, ``step`` in a file).
        An angle without them goes once around by one degree.
    speed : str or number, optional
        ``"300 rpm"``, ``"25 rad/s"``, ``"90 deg/s"``, for lengths ``"50 mm/s"``;
        a bare number is the file's unit per second.
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

    @property
    def drives(self) -> tuple[str, str]:
        """``(kind, name)`` of what is driven; ``("", "")`` if nothing is named."""
        for kind in ("link", "joint", "slider", "cylinder", "variable"):
            name: str | None = getattr(self, kind)
            if name is not None:
                return kind, name
        return "", ""

    @property
    def column(self) -> str:
        """The name of the input in results: ``crank``, ``stick-boom``, ``s16``."""
        kind, name = self.drives
        if kind == "link" and self.relative_to not in (None, "ground"):
            return f"{name}-{self.relative_to}"
        return name
