"""All four-bars through precision positions: solved, counted, and proved where they are real."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from linkwork.design.precision.cognates import cognates
from linkwork.design.precision.four_bar_positions import FourBarPositions
from linkwork.design.precision.linkage_proof import prove_linkages
from linkwork.design.precision.path_tracking import SparingTracker
from linkwork.design.precision.positions import PrecisionPositions
from linkwork.design.precision.start_sets import start_member
from linkwork.foundation.arrays import IndexArray
from linkwork.foundation.completeness import Completeness
from linkwork.foundation.rounding import ALMOST_REAL
from linkwork.numerics.homotopy.monodromy import Member
from linkwork.numerics.homotopy.parameter_path import Tracker
from linkwork.numerics.homotopy.parameter_roots import ParameterRoots, roots_at

__all__ = ["PrecisionFourBars", "four_bars_through"]

_SEED = 19_920_301  # of detours; every run gives the same answer
_LEAST_SIZE = 0.1  # of the size of the positions: numbers are compared relative to at least this


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class PrecisionFourBars(FourBarPositions):
    """Real four-bars through positions, and how many solutions there are.

    Parameters
    ----------
    triple : (D,) int
        Equal for four-bars that are cognates of each other.
    real : int
        Real solutions, a triple of cognates counted once.
    roots : ParameterRoots
        All complex solutions, and the outcome of every path.
    """

    triple: IndexArray
    real: int
    roots: ParameterRoots

    def __repr__(self) -> str:
        roots = self.roots
        return (
            f"Four-bars through {self.guided.shape[1]} positions\n"
            f"  solutions {len(roots.x):5}   of {roots.paths} paths; {roots.at_infinity} to "
            f"infinity, {len(roots.singular)} singular, {roots.lost} lost\n"
            f"  real      {self.real:5}\n"
            f"  four-bars {len(self):5}   {int(self.proved.sum())} of them proved\n"
            f"  {self.completeness.value}"
        )

    @property
    def completeness(self) -> Completeness:
        """Whether all four-bars are listed."""
        return self.roots.graded(self.proved)


def four_bars_through(
    given: PrecisionPositions,
    tracker: Tracker | None = None,
    *,
    member: Member | None = None,
    alike: int = 1,
    progress: Callable[[float], None] | None = None,
) -> PrecisionFourBars:
    """All four-bars through positions that determine a finite number of them.

    Parameters
    ----------
    given : PrecisionPositions
        With two conditions for every pose and every fixed pivot, one for every point and length,
        not counting the first position: eight in all, at least one of them a point.
    tracker : Tracker, optional
        By default compiled where that saves time.
    member : Member, optional
        A solved member to start from, needed with given lengths; by default the shipped one.
    alike : int
        How many tasks of this kind will be solved, this one included.
    progress : callable, optional
        Called with the finished fraction of the paths; may raise an error to end the work.
    """
    problem, size = given.problem, given.size
    member = member or start_member(problem)
    goal, rng = given.parameters(size), np.random.default_rng(_SEED)
    tracker = tracker or SparingTracker(alike * len(member.x), progress)
    roots = roots_at(problem, member, goal, tracker, rng)
    apart = np.abs(problem.mirrored(roots.x) - roots.x) / (_LEAST_SIZE + np.abs(roots.x))
    real = problem.linkages(roots.x[apart.max(axis=1, initial=0.0) < ALMOST_REAL], goal)
    count = len(real)
    triple = np.arange(count)
    if not (problem.poses or problem.lengths or problem.pivots == 2):
        # with one pivot given the second cognate, which lacks it, is none
        others = cognates(real)[: 2 - problem.pivots]
        real, triple = np.concatenate([real, *others]), np.tile(triple, 1 + len(others))
    proofs = prove_linkages(given, real * size)
    return PrecisionFourBars.of(given, proofs, triple=triple, real=count, roots=roots)
