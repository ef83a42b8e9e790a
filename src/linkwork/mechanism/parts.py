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
        makes one turn in steps of one degree.
    speed : str or number, optional
        ``"300 rpm"``, ``"25 rad/s"``, ``"90 deg/s"``, for lengths ``"50 mm/s"``; a number is in
        file units per second.

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
    """A pin in a slot: a point of one link moves along a line of another link.

    Parameters
    ----------
    name : str
        The displacement, zero at the first point of ``line``, positive towards the second [length].
    point : str
        The pin.
    on : str
        The link with the slot.
    line : (str, str)
        Two points of that link.

    Examples
    --------
    >>> import linkwork as lw
    >>> lw.Slot(name="s", point="A", on="lever", line=("O4", "Q")).name
    's'
    >>> round(lw.example("crank-shaper").solve(at=90)["s"], 6)
    210.0
    """

    name: str
    point: str
    on: str
    line: tuple[str, str]

    def __post_init__(self) -> None:
        as_tuples(self, "line")


@dataclass(frozen=True, kw_only=True)
class Slider:
    """A prismatic joint: a link slides along a line of another link without turning.

    Parameters
    ----------
    name : str
        The displacement, zero at the first point of ``line``, positive towards the second [length].
    link : str
        The sliding link.
    points : tuple of str
        One or two points of the sliding link at the distance ``offset`` from the line.
    on : str
        The link on which it slides.
    line : (str, str)
        Two points of that link.
    offset : number
        Distance of the points from the line, positive to its left [length].
    angle : number, optional
        With one point: the angle from the line to the sliding link's direction [file's angle unit].

    Examples
    --------
    >>> import linkwork as lw
    >>> lw.Slider(name="d", link="block", points=("B",), on="ground", line=("S", "T")).offset
    0
    >>> round(lw.example("slider-crank").solve(at=60)["d"], 3)
    126.838
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
    """A link of variable length between two points, such as a hydraulic cylinder.

    Parameters
    ----------
    name : str
        The variable length.
    between : (str, str)
        The two points.

    Examples
    --------
    >>> import linkwork as lw
    >>> lw.Cylinder(name="ram", between=("P", "Q")).angle_name
    'ram_angle'
    """

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
    """A spring between two points; it is drawn and does not constrain the motion.

    Parameters
    ----------
    name : str
        The name of the spring.
    between : (str, str)
        The two points.

    Examples
    --------
    >>> import linkwork as lw
    >>> lw.Spring(name="return", between=("O4", "B")).between
    ('O4', 'B')
    """

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
