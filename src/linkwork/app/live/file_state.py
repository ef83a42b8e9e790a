"""The edited file as the page shows it: its numbers, parts and inputs, and what it lacks."""

from __future__ import annotations

from dataclasses import dataclass

from linkwork.app.live.requests import Edit

Point = tuple[float, float]


@dataclass(frozen=True, kw_only=True)
class ProblemShown:
    """A problem: its line in the text, its key and the remedy."""

    line: int | None
    key: str
    message: str


@dataclass(frozen=True, kw_only=True)
class ChangeableNumber:
    """A named number that can be changed.

    ``table``: dimensions, lengths, angles, sliders, guess, points, or measured. ``formula`` is
    its formula in the file, if it has one: such a number depends on others.
    """

    name: str
    value: float
    unit: str
    table: str
    formula: str = ""


@dataclass(frozen=True, kw_only=True)
class Unknown:
    """An unknown of the equations with its guess."""

    name: str
    unit: str
    guess: float


@dataclass(frozen=True, kw_only=True)
class DrivenInput:
    """An input: the driven quantity, and its range as in the file."""

    name: str
    unit: str
    drive: str
    start: float
    stop: float
    rows: int
    speed: str = ""


@dataclass(frozen=True, kw_only=True)
class Drive:
    """A possible input: link, slider, cylinder or variable, and its name."""

    kind: str
    name: str


@dataclass(frozen=True, kw_only=True)
class Link:
    """A link and its points."""

    name: str
    points: tuple[str, ...]


@dataclass(frozen=True, kw_only=True)
class MassShown:
    """The mass of a moving link as it would be typed; empty without one. ``rod``: a uniform rod."""

    link: str
    mass: str
    x: str
    y: str
    inertia: str
    rod: bool


@dataclass(frozen=True, kw_only=True)
class EntryShown:
    """Gravity, friction of a joint, a motor or stops as they would be typed.

    ``takes``: the fields that it may have; ``there``: whether the file has it.
    """

    table: str
    of: str
    takes: tuple[str, ...]
    there: bool
    typed: dict[str, str | tuple[str, ...]]


@dataclass(frozen=True, kw_only=True)
class PaletteField:
    """A field of a form: a key of a table, its description and kind of entry.

    ``entry``: ``text``, ``number``, ``flag``, ``choice`` among ``words``; ``measured``: a number
    with or without a unit; the name of a ``point``, ``link`` or ``slider``; several ``points`` or
    ``links``; ``numbers`` in one line; ``lines`` of numbers, or of words in the order of ``named``.
    """

    name: str
    doc: str
    entry: str
    required: bool
    words: tuple[str, ...] = ()
    named: tuple[str, ...] = ()


@dataclass(frozen=True, kw_only=True)
class Pick:
    """A thing or place of the drawing that a part needs.

    ``takes``: ``point``, ``link``, ``place``; ``sized``: a drag from it sets a radius;
    ``repeated``: as often as wanted.
    """

    prompt: str
    takes: tuple[str, ...]
    sized: bool
    repeated: bool


@dataclass(frozen=True, kw_only=True)
class PalettePart:
    """A kind of part, with its table in the file; ``picks`` draw it."""

    table: str
    title: str
    doc: str
    fields: tuple[PaletteField, ...]
    picks: tuple[Pick, ...]


@dataclass(frozen=True, kw_only=True)
class PaletteForm:
    """A form of loads that are no parts, with the table that it fills."""

    table: str
    title: str
    doc: str
    fields: tuple[PaletteField, ...]


@dataclass(frozen=True, kw_only=True)
class PartShown:
    """A part of the file: its entries as they would be typed.

    ``links`` and ``points``: those that it joins.
    """

    table: str
    name: str
    typed: dict[str, str | tuple[str, ...]]
    links: tuple[str, ...]
    points: tuple[str, ...]


@dataclass(frozen=True, kw_only=True)
class Remedy:
    """A change of the file that mends something, and its label."""

    label: str
    edits: tuple[Edit, ...]


@dataclass(frozen=True, kw_only=True)
class Lack:
    """Something that keeps a draft from being a mechanism.

    ``kind`` and ``name``: the point, link or part concerned, or "".
    """

    message: str
    key: str
    line: int | None
    kind: str
    name: str
    remedies: tuple[Remedy, ...]


@dataclass(frozen=True, kw_only=True)
class FileState:
    """The edited file.

    ``lacks``: what keeps it from being a mechanism; ``readable``: whether it is at least a draft.

    ``parts``: names of sliders, gears, cams, …; for a weld its two links; ``part_entries``: what
    they are. ``drives``: possible inputs. ``traceable``: points whose paths can be shown.
    """

    file: str
    title: str
    text: str
    form: str
    unsaved: bool
    undo: str
    redo: str
    length_unit: str
    angle_unit: str
    configuration: str
    numbers: tuple[ChangeableNumber, ...]
    unknowns: tuple[Unknown, ...]
    inputs: tuple[DrivenInput, ...]
    points: dict[str, Point]
    links: tuple[Link, ...]
    parts: tuple[str, ...]
    part_entries: tuple[PartShown, ...]  # noqa: V107
    masses: tuple[MassShown, ...]
    mass_unit: str  # noqa: V107
    force_unit: str
    force_entries: tuple[EntryShown, ...]  # noqa: V107
    drives: tuple[Drive, ...]
    traceable: tuple[str, ...]
    traced: tuple[str, ...]
    outputs: tuple[str, ...]
    equations: tuple[str, ...]
    lacks: tuple[Lack, ...]
    readable: bool
