"""The results that a report shows, computed before it is written."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from linkwork.foundation.frozen import FrozenDict
from linkwork.motion.model import Model
from linkwork.results.check import CheckReport
from linkwork.results.circuits import Circuits
from linkwork.results.configurations import Configurations
from linkwork.results.motion import Motion
from linkwork.results.position import Position
from linkwork.results.reactions import Reactions
from linkwork.results.stall import Stall
from linkwork.results.tolerance import Tolerance
from linkwork.results.vector_loop import VectorLoop

__all__ = ["Findings"]


@dataclass(frozen=True, kw_only=True, eq=False)
class Findings:
    """The results of one mechanism.

    Parameters
    ----------
    source : str
        The mechanism file.
    check : CheckReport
        How it was read.
    position : Position
        The position that is drawn and solved step by step.
    motion : Motion, optional
        The sweep over the table of the input.
    vectors, circuits, configurations, forces, stalls, tolerances
        The results of the sections that need them.
    absent : Mapping[str, str]
        Sections without content, each with its reason.
    """

    model: Model
    source: str
    check: CheckReport
    position: Position
    motion: Motion | None = None
    vectors: tuple[VectorLoop, ...] = ()
    circuits: Circuits | None = None
    configurations: Configurations | None = None
    forces: Reactions | None = None
    stalls: tuple[Stall, ...] = ()
    tolerances: tuple[Tolerance, ...] = ()
    absent: Mapping[str, str] = FrozenDict()
