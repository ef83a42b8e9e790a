"""The report of a check: how a mechanism was read, before a cycle is solved."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from linkwork.foundation.status import Status
from linkwork.results.classification import AssurGroup, Classification
from linkwork.results.failure import Failure

__all__ = ["BlockSummary", "CheckReport"]


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
        return {
            "equations": list(self.equations),
            "unknowns": list(self.unknowns),
            "group": None if self.group is None else self.group.to_dict(),
        }


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

    def to_dict(self) -> dict[str, Any]:
        """The report as JSON-ready data."""
        return {
            "mechanism": self.mechanism,
            "form": self.form,
            "links": self.links,
            "joints": self.joints,
            "loops": list(self.loops),
            "unknowns": [{"name": n, "unit": u} for n, u in self.unknowns],
            "inputs": [{"name": n, "unit": u} for n, u in self.inputs],
            "rows": self.rows,
            "blocks": [block.to_dict() for block in self.blocks],
            "classification": None
            if self.classification is None
            else self.classification.to_dict(),
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
