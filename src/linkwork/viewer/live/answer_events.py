"""Events that answer questions about a mechanism: its circuits, its quantities, files of it."""

from __future__ import annotations

from dataclasses import dataclass

from linkwork.viewer.page_data import PageData

__all__ = [
    "BranchFound",
    "CircuitFound",
    "CircuitsFound",
    "Exported",
    "FormOffered",
    "LimitFound",
    "QuantitiesListed",
    "QuantityListed",
    "SimulationEvent",
    "SimulationFound",
    "Working",
]

Range = tuple[float, float]


@dataclass(frozen=True, kw_only=True)
class LimitFound:
    """An end of the motion: a dead point or change point of the input."""

    what: str
    input: float
    located: bool
    sentence: str


@dataclass(frozen=True, kw_only=True)
class BranchFound:
    """A branch of a circuit; ``start`` is the name that starts a motion there."""

    name: str
    start: str
    input_range: Range
    certified: bool


@dataclass(frozen=True, kw_only=True)
class CircuitFound:
    """A circuit: the range of the input, the turns until it closes, its dead points and branches.

    ``current``: it contains the motion of the file.
    """

    name: str
    current: bool
    end: str
    certified: bool
    input_range: Range
    turns: int | None
    limits: tuple[LimitFound, ...]
    branches: tuple[BranchFound, ...]


@dataclass(frozen=True, kw_only=True)
class CircuitsFound:
    """All circuits, and a page with the motion of each."""

    input: str
    input_unit: str
    circuits: tuple[CircuitFound, ...]
    message: str
    page: PageData | None


@dataclass(frozen=True, kw_only=True)
class QuantityListed:
    """A quantity that can be plotted, and how many of its derivatives are known."""

    name: str
    unit: str
    about: str
    derivatives: int


@dataclass(frozen=True, kw_only=True)
class QuantitiesListed:
    """All quantities that can be plotted."""

    quantities: tuple[QuantityListed, ...]


@dataclass(frozen=True, kw_only=True)
class Exported:
    """A file for the visitor; ``content`` is in base64."""

    name: str
    media_type: str
    content: str
    notices: tuple[str, ...] = ()


@dataclass(frozen=True, kw_only=True)
class SimulationEvent:
    """What happens in a row of a simulation, at a time [s]."""

    row: int
    t: float
    text: str


@dataclass(frozen=True, kw_only=True)
class FormOffered:
    """A form of the page that mends something: ``start`` of a simulation, ``masses``, ``motor``,
    ``stops``, ``input``, ``text`` of the file; and the label of a button that leads to it.
    """

    form: str
    label: str


@dataclass(frozen=True, kw_only=True)
class SimulationFound:
    """A simulation: how it ended, its events, and its page.

    ``complete``: it reached the last time. ``forms``: where to mend what ended or refused it, which
    then has no ``page``.
    """

    message: str
    complete: bool
    rows: int
    certified: int
    energy: str
    events: tuple[SimulationEvent, ...]
    forms: tuple[FormOffered, ...]
    page: PageData | None


@dataclass(frozen=True, kw_only=True)
class Working:
    """The finished fraction of an answer that takes long, 0 to 1."""

    fraction: float
