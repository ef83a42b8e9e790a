"""The parts a mechanism is described with, besides points and links."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

__all__ = [
    "Cylinder",
    "Input",
    "Number",
    "Slider",
    "Slot",
    "Spring",
    "as_tuples",
    "replaced_names",
]

#: Wherever a number is expected, a formula of the named dimensions may stand.
Number = float | int | str


def as_tuples(part: object, *fields: str) -> None:
    """Turn lists into tuples, so that parts compare and cannot change."""
    for field in fields:
        entry = getattr(part, field)
        if entry is not None and not isinstance(entry, str):
            object.__setattr__(part, field, tuple(entry))


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


@dataclass(frozen=True, kw_only=True)
class Slot:
    """Pin in slot: ``point`` runs along the line through two points of the link ``on``.

    The displacement ``name`` is zero at the first point of ``line``, positive to the second.
    """

    name: str
    point: str
    on: str
    line: tuple[str, str]

    def __post_init__(self) -> None:
        as_tuples(self, "line")


@dataclass(frozen=True, kw_only=True)
class Slider:
    """Prismatic joint: ``link`` translates along a line of ``on`` without turning against it.

    ``points`` (one or two of the sliding link) keep the distance ``offset`` from the line,
    positive to its left; with one point, ``angle`` leads from the line to the link's direction.
    """

    name: str
    link: str
    points: tuple[str, ...]
    on: str
    line: tuple[str, str]
    offset: Number = 0
    angle: Number | None = None

    def __post_init__(self) -> None:
        as_tuples(self, "points", "line")


@dataclass(frozen=True, kw_only=True)
class Cylinder:
    """A link of variable length between two points; ``name`` is its length."""

    name: str
    between: tuple[str, str]

    def __post_init__(self) -> None:
        as_tuples(self, "between")

    @property
    def angle_name(self) -> str:
        """The name of its angle in results."""
        stem = self.name.rstrip("'")
        return f"{stem}_angle{self.name[len(stem) :]}"  # primes stand at the end of a name


@dataclass(frozen=True, kw_only=True)
class Spring:
    """A spring between two points: drawn, and no constraint."""

    name: str
    between: tuple[str, str]

    def __post_init__(self) -> None:
        as_tuples(self, "between")


#: Fields that hold numbers, words or labels: no name of a part of the mechanism.
_NOT_NAMES = frozenset(
    {
        "name", "start", "stop", "step", "speed", "offset", "angle", "radii", "teeth", "phase",
        "radius", "circle_radius", "contact", "base", "segments", "profile", "through",
    }
)  # fmt: skip


def replaced_names(part: Any, spelled: dict[str, str], canonical: Any) -> Any:
    """A copy of a part in which every name has the spelling of its declaration."""
    changed: dict[str, object] = {}
    for field, entry in vars(part).items():
        if field in _NOT_NAMES:
            continue
        if isinstance(entry, str):
            changed[field] = spelled.get(canonical(entry), entry)
        elif isinstance(entry, tuple):
            changed[field] = tuple(spelled.get(canonical(str(e)), e) for e in entry)
    return type(part)(**{**vars(part), **changed})
