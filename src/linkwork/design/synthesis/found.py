"""What a solver of tasks hands on: designs of each kind, counts, and whether the list is complete.

A solver for a further kind of task returns this; verdicts, ranking and delivery follow from it.
"""

from __future__ import annotations

from dataclasses import dataclass

from linkwork.design.loops.candidates import Candidates, Drive
from linkwork.design.poses.dyad_set import DyadSet
from linkwork.foundation.completeness import Completeness

__all__ = ["Found"]


@dataclass(frozen=True, kw_only=True, eq=False)
class Found:
    """The designs that solve a task, before their defects are known.

    Parameters
    ----------
    candidates : tuple of Candidates
        Designs, one container for each kind; their positions are those of the task.
    complex, real, proved : int
        Solutions of the equations, those that are real, and those that are proved.
    completeness : Completeness
        Whether the real solutions are all there are.
    message : str
        The same in words of the task.
    dyads : DyadSet, optional
        The real dyads, if the solver combines dyads.
    triples : int
        Triples of cognates, for tasks whose solutions are counted so.
    drives : tuple of Drive
        The links that may be driven.
    zeros : tuple of (float, float)
        Of each container, or none: the angles of crank and rocker, or the displacement of a slider,
        that the task has at the first position [rad or length]; a link that points the other way is
        measured from its moving pivot.
    output : str
        The name of the output link or slider of a function; "" for other tasks.
    starts : int
        Starts of a least-squares fit; 0 where equations are solved.
    interrupted : bool
        Whether the user stopped it; the designs are the best so far.
    """

    candidates: tuple[Candidates, ...]
    complex: int
    real: int
    proved: int
    completeness: Completeness
    message: str
    dyads: DyadSet | None = None
    triples: int = 0
    drives: tuple[Drive, ...] = tuple(Drive)
    zeros: tuple[tuple[float, float], ...] = ()
    output: str = ""
    starts: int = 0
    interrupted: bool = False
