"""The classification of a mechanism: chain, inversion, type by lengths, Assur groups."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from linkwork.core.foundation.statuses import Status
from linkwork.core.results.failure import Failure
from linkwork.core.results.listing import Column, redundant_lines, significant
from linkwork.core.results.tables import Summary, plain_fields

_ROMAN = ("", "I", "II", "III", "IV", "V", "VI", "VII", "VIII", "IX", "X")


def roman(number: int) -> str:
    """A class as a Roman numeral: ``II``."""
    return _ROMAN[number] if number < len(_ROMAN) else str(number)


@dataclass(frozen=True, kw_only=True)
class LoopType:
    """The type of a four-bar or slider-crank loop, from its exact lengths.

    Parameters
    ----------
    links : tuple of str
        Around the loop: ground, driven link (or the first one), coupler, output.
    name : str
        ``crank-rocker``, ``crank shaper``, …
    barker : str
        Barker's code of a four-bar (``GCRR``); "" for other loops.
    grashof : bool or None
        Whether a link turns fully; ``None`` at a change point.
    margin : float
        p + q - s - l of a four-bar, l - s - e of a slider-crank [length]; positive if a link turns
        fully. s is the shortest link, l the longest, p and q are the others, e is the offset.
    relative_margin : float
        The margin divided by the longest of these lengths.
    turns_fully : bool or None
        Whether the driven joint turns fully; ``None`` at a change point, or if no pin of this loop
        is driven.
    condition : str
        The comparison of the lengths as a sentence.

    References
    ----------
    C. R. Barker: A complete classification of planar four-bar linkages. Mechanism and Machine
    Theory 20 (1985) 535-554

    Examples
    --------
    >>> import linkwork as lw
    >>> loop = lw.example("four-bar").check().classification.loop
    >>> loop.barker, loop.margin, loop.turns_fully
    ('GCRR', 20.0, True)
    """

    links: tuple[str, ...]
    name: str
    barker: str = ""
    grashof: bool | None  # noqa: V107
    margin: float
    relative_margin: float  # noqa: V107
    turns_fully: bool | None
    condition: str

    @property
    def text(self) -> str:
        """``crank-rocker (GCRR): Grashof, s + l < p + q by 40 mm``."""
        code = f" ({self.barker})" if self.barker else ""
        return f"{self.name}{code}: {self.condition}"

    def to_dict(self) -> dict[str, Any]:
        """The type as JSON-ready data."""
        names = (
            "links", "name", "barker", "grashof", "margin", "relative_margin", "turns_fully",
        )  # fmt: skip
        return plain_fields(self, *names) | {"barker": self.barker or None}


@dataclass(frozen=True, kw_only=True)
class AssurGroup:
    """A group of links that are determined together once all links before them are known.

    Parameters
    ----------
    links : tuple of str
        The links of the group; links that the input holds together count as one:
        ``crank + coupler``.
    name : str
        ``dyad RRR``, ``triad RR-RR-RP``, ``tetrad``, ``group of 6 links``; or why the links are not
        an Assur group.
    class_number, order : int or None
        Class and order after Artobolevskii; ``None`` if the links are not an Assur group.

    Examples
    --------
    >>> import linkwork as lw
    >>> report = lw.example("four-bar").check()
    >>> report.classification.groups[0].text
    'dyad RRR, class II'
    """

    links: tuple[str, ...]
    name: str
    class_number: int | None
    order: int | None

    @property
    def text(self) -> str:
        """``dyad RRR, class II``."""
        if self.class_number is None:
            return self.name
        return f"{self.name}, class {roman(self.class_number)}"

    def to_dict(self) -> dict[str, Any]:
        """The group as JSON-ready data."""
        found = plain_fields(self, "links", "name", "class_number", "order")
        return {name.removesuffix("_number"): value for name, value in found.items()}


@dataclass(frozen=True, kw_only=True)
class Classification:
    """The kinematic chain, the type and the Assur groups of a mechanism.

    Parameters
    ----------
    chain : str
        The kinematic chain: ``four-bar chain``, ``Watt chain``, …
    inversion : str or None
        The name of the inversion, which depends on the ground: ``Stephenson III``, ``Scotch yoke``,
        …
    links : int
        The number of links of the chain.
    blocks : tuple of str
        Slots whose pins count as links (blocks).
    loop : LoopType or None
        The type of the four-bar or slider-crank loop that contains the driven link.
    groups : tuple of AssurGroup
        In the order in which they are solved.
    class_number : int or None
        The highest class of a group, 1 without groups; ``None`` if the mechanism has no class.

    Examples
    --------
    >>> import linkwork as lw
    >>> found = lw.example("four-bar").check().classification
    >>> found.chain, found.loop.name, found.class_number
    ('four-bar chain', 'crank-rocker', 2)
    """

    chain: str
    inversion: str | None
    links: int
    blocks: tuple[str, ...]
    loop: LoopType | None
    groups: tuple[AssurGroup, ...]
    class_number: int | None

    @property
    def type(self) -> str:
        """The type by ground and lengths, empty if there is no name for it."""
        if self.loop is not None and self.links == len(self.loop.links):
            return self.loop.text
        told = [self.inversion] if self.inversion is not None else []
        if self.loop is not None:
            told.append(f"its loop {', '.join(self.loop.links)}: {self.loop.text}")
        return "; ".join(told)

    def to_dict(self) -> dict[str, Any]:
        """The classification as JSON-ready data."""
        names = ("chain", "links", "inversion", "type", "blocks", "loop", "groups")
        found = plain_fields(self, *names)
        return found | {"type": self.type or None, "class": self.class_number}


@dataclass(frozen=True, kw_only=True)
class Inversion:
    """An inversion of a kinematic chain: the chain with another link as ground.

    Parameters
    ----------
    ground : str
        The fixed link of this inversion.
    type : str
        The type of the mechanism; "" if it has no name.
    like : str
        The first link that, as ground, gives the same chain up to its lengths.
    problem : str
        Why ``mechanism.inversion`` cannot make it; "" if it can.

    Examples
    --------
    >>> import linkwork as lw
    >>> for inversion in lw.circuits.inversions(lw.example("four-bar")):
    ...     print(inversion.ground, "->", inversion.type.partition(":")[0])
    ground -> crank-rocker (GCRR)
    crank -> double-crank (GCCC)
    coupler -> crank-rocker
    rocker -> double-rocker
    """

    ground: str
    type: str
    like: str
    problem: str = ""

    @property
    def text(self) -> str:
        """``coupler: double-rocker (GRCR): …``."""
        return f"{self.ground}: {self.type or self.problem or 'unnamed'}"


# ----------------------------------------------------------------------
# The report of a check: how a mechanism was read, before a cycle is solved.


@dataclass(frozen=True, kw_only=True)
class BlockSummary:
    """A block: the labels of equations that are solved together, and their unknowns.

    ``group``: the Assur group of the block.

    Examples
    --------
    >>> import linkwork as lw
    >>> [block.unknowns for block in lw.example("double-four-bar").check().blocks]
    [('θ2', 'θ3'), ('θ4', 'θ5')]
    """

    equations: tuple[str, ...]
    unknowns: tuple[str, ...]
    group: AssurGroup | None = None

    def to_dict(self) -> dict[str, Any]:
        """The block as JSON-ready data."""
        return plain_fields(self, "equations", "unknowns", "group")


@dataclass(frozen=True, kw_only=True)
class CheckReport:
    """How a mechanism was read: its equations, mobility, classification and start position.

    Parameters
    ----------
    mechanism : str
        The name of the mechanism.
    form : str
        ``points and links``, ``loops`` or ``equations``.
    links, joints : int
        Their numbers; for loops they are read from the equations, and 0 if that fails.
    loops : tuple of str
        Labels of the loop equations, or of plain equations.
    unknowns, inputs : tuple of (name, unit)
        The variables with their units.
    rows : int
        Number of rows of the input's table.
    blocks : tuple of BlockSummary
        Equations that are solved together, in solving order.
    mobility_count : int or None
        Mobility by Grübler's count; ``None`` without links and joints.
    mobility_rank : int or None
        Variables minus the rank of the full Jacobian at the start position; ``None`` without one.
    measured : tuple of (link, "A B", length)
        Dimensions that are not given and follow from the sketched points [file's length unit].
    measured_in_parts : tuple of (part, quantity, value, unit)
        Numbers of parts that are not given and follow from the sketch, such as a phase of gears.
    start : Status
        How Newton-Raphson ended at the input value of the guess.
    start_message : str
        The same as a sentence.
    start_input : dict[str, float]
        The input values of the guess, in file units.
    residual : float
        Largest closure error at the start, relative to the longest link.
    failure : Failure, optional
        Why there is no position at the start.
    mobility_why : str
        Why the two mobilities differ; "" if they do not.
    redundant : tuple of (link, length, gap)
        Links whose length follows from the others: the given length, and its error at the start
        relative to the longest link.
    classification : Classification, optional
        Chain, type and Assur groups.
    unclassified : str
        Why there is no classification; "" if there is one.

    Examples
    --------
    >>> import linkwork as lw
    >>> report = lw.example("four-bar").check()
    >>> report.mobility_count, report.mobility_rank
    (1, 1)
    >>> report.classification.type
    'crank-rocker (GCRR): Grashof, s + l < p + q by 20 mm'
    """

    mechanism: str
    form: str
    links: int
    joints: int
    loops: tuple[str, ...]
    unknowns: tuple[tuple[str, str], ...]
    inputs: tuple[tuple[str, str], ...]
    rows: int
    blocks: tuple[BlockSummary, ...]
    mobility_count: int | None
    mobility_rank: int | None
    measured: tuple[tuple[str, str, float], ...]
    start: Status
    start_message: str
    start_input: dict[str, float]
    residual: float
    failure: Failure | None = None
    mobility_why: str = ""
    redundant: tuple[tuple[str, float, float], ...] = ()
    classification: Classification | None = None
    unclassified: str = ""
    measured_in_parts: tuple[tuple[str, str, float, str], ...] = ()

    def __repr__(self) -> str:
        """A summary: equations, mobility, classification, and whether there is a start position."""
        start = ("start", "solved" if self.start.ok else self.start_message)
        return str(Summary(f"Check of {self.mechanism}", (*check_fields(self), start)))

    def to_dict(self) -> dict[str, Any]:
        """The report as JSON-ready data."""
        return {
            **plain_fields(self, "mechanism", "form", "links", "joints", "loops"),
            "unknowns": [{"name": n, "unit": u} for n, u in self.unknowns],
            "inputs": [{"name": n, "unit": u} for n, u in self.inputs],
            **plain_fields(self, "rows", "blocks", "classification"),
            **({"unclassified": self.unclassified} if self.unclassified else {}),
            "mobility": {
                "count": self.mobility_count,
                "rank": self.mobility_rank,
                **({"why": self.mobility_why} if self.mobility_why else {}),
            },
            "redundant": [
                {"link": link, "length": length, "gap": gap} for link, length, gap in self.redundant
            ],
            "measured": [{"link": k, "points": p, "length": v} for k, p, v in self.measured],
            "measured_in_parts": [
                {"part": part, "quantity": quantity, "value": value, "unit": unit}
                for part, quantity, value, unit in self.measured_in_parts
            ],
            "start": {
                "status": self.start.name,
                "message": self.start_message,
                "input": self.start_input,
                "residual": self.residual,
            },
            **({} if self.failure is None else {"failure": self.failure.to_dict()}),
        }


# ----------------------------------------------------------------------
# How a mechanism was read, as sentences: equations, mobility, classification.


def check_fields(report: CheckReport) -> Iterator[tuple[str, str]]:
    """Parts, equations, unknowns, inputs, blocks, mobility, chain and type."""
    yield "written as", report.form
    if report.links:
        read = ", read off the loops" if report.form == "loops" else ""
        yield "parts", f"{_count(report.links, 'link')}, {_count(report.joints, 'joint')}{read}"
    what = "equation" if report.form == "equations" else "loop"
    yield what if len(report.loops) == 1 else f"{what}s", ", ".join(map(_quoted, report.loops))
    yield "unknowns", _with_units(report.unknowns) or "none"
    inputs = _with_units(report.inputs) or "none: solve finds one position, there is no sweep"
    yield "input" if len(report.inputs) < 2 else "inputs", inputs
    if report.rows:
        yield "sweep", _count(report.rows, "position")
    if report.blocks:
        yield "blocks", _blocks_sentence(report)
        if len(report.blocks) > 1:
            for k, block in enumerate(report.blocks, 1):
                together = " and ".join(map(_quoted, block.equations))
                yield "", f"{k}. {', '.join(block.unknowns)} from {together}{_group(block)}"
    if report.form != "equations":
        yield "mobility", _mobility(report)
    yield from redundant_lines({link: gap for link, _, gap in report.redundant})
    if report.classification is not None:
        yield from classification_fields(report.classification)
    else:
        yield "chain", f"not known: {report.unclassified}"


def measured_part_columns(report: CheckReport) -> list[Column]:
    """What the sketch gives of parts: part, quantity and value."""
    parts, quantities, values, units = zip(*report.measured_in_parts, strict=True)
    cells = [significant(value, 7, noise=1e-9) for value in values]
    return [
        Column(header="part", cells=parts),
        Column(header="quantity", cells=quantities),
        Column(header="value", cells=cells, align="point", units=units),
    ]


def _blocks_sentence(report: CheckReport) -> str:
    if len(report.blocks) == 1:
        return f"1, all unknowns are solved together{_group(report.blocks[0])}"
    return f"{len(report.blocks)}, solved one after the other:"


def _group(block: BlockSummary) -> str:
    return "" if block.group is None else f": {block.group.text}"


def _mobility(report: CheckReport) -> str:
    count, rank = report.mobility_count, report.mobility_rank
    by_rank = "not known by rank, which needs a position" if rank is None else f"{rank} by rank"
    if count is None:
        return by_rank
    both = f"{count} by Grübler's count, {by_rank}"
    return f"{both}. They differ: {report.mobility_why}" if report.mobility_why else both


def classification_fields(found: Classification) -> Iterator[tuple[str, str]]:
    """Chain, type and class with their labels."""
    blocks = ", ".join(found.blocks)
    counted = ""
    if found.blocks:
        whose = "pin in slot" if len(found.blocks) == 1 else "pins in slots"
        what = "a block" if len(found.blocks) == 1 else "blocks"
        counted = f"; {whose} {blocks} counted as {what}"
    yield "chain", found.chain + counted
    if found.type:
        yield "type", found.type
    if found.class_number is not None:
        several = ", the highest of its Assur groups" if len(found.groups) > 1 else ""
        yield "class", roman(found.class_number) + several


def _with_units(names: tuple[tuple[str, str], ...]) -> str:
    return ", ".join(f"{name} [{unit}]" if unit else name for name, unit in names)


def _quoted(label: str) -> str:
    return f'"{label}"'


def _count(number: int, noun: str) -> str:
    return f"{number} {noun}" if number == 1 else f"{number} {noun}s"
