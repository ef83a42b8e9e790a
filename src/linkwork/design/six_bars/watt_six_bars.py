"""All Watt-II six-bars through nine pairs of angles: solved, counted, and proved where real."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from linkwork.design.precision.path_tracking import SparingTracker
from linkwork.design.six_bars.start_member import watt_member
from linkwork.design.six_bars.watt_problem import WATT
from linkwork.design.six_bars.watt_proof import prove_six_bars
from linkwork.foundation.arrays import Array, BoolArray, ComplexArray
from linkwork.foundation.completeness import Completeness
from linkwork.foundation.rounding import ALMOST_REAL
from linkwork.numerics.homotopy.monodromy import Member
from linkwork.numerics.homotopy.parameter_path import Tracker
from linkwork.numerics.homotopy.parameter_roots import ParameterRoots, roots_at

__all__ = ["PAIRS", "WattSixBars", "watt_six_bars"]

#: Pairs of angles that a Watt-II six-bar meets exactly, the first one included.
PAIRS = 9
_SEED = 20_140_601  # of detours; every run gives the same answer
_LEAST_SIZE = 0.1  # of the ground: numbers are compared relative to at least this


@dataclass(frozen=True, kw_only=True, eq=False)
class WattSixBars:
    """Real Watt-II six-bars through nine pairs, and how many solutions there are.

    Parameters
    ----------
    arms : (D, 4) complex
        Crank a and arm b at the first position, seen along the ground of the first four-bar, and
        arm c and rocker e along that of the second one [ground of their four-bar].
    turns : (D, 9) complex
        The rotations of the bell crank, e^{iψ}, from the first position.
    inputs, outputs : (9,)
        Angles of crank and rocker from their first ones [rad].
    proved : (D,) bool
    error : (D,)
        A bound of the errors of all arms in all positions [ground of their four-bar]; infinite
        where it is not proved.
    roots : ParameterRoots
        All complex solutions, and the outcome of every path.
    """

    arms: ComplexArray
    turns: ComplexArray
    inputs: Array
    outputs: Array
    proved: BoolArray
    error: Array
    roots: ParameterRoots

    def __len__(self) -> int:
        return len(self.arms)

    @property
    def completeness(self) -> Completeness:
        """Whether all real six-bars are listed."""
        return self.roots.graded(self.proved)


def watt_six_bars(
    inputs: Array,
    outputs: Array,
    tracker: Tracker | None = None,
    *,
    member: Member | None = None,
    progress: Callable[[float], None] | None = None,
) -> WattSixBars:
    """All Watt-II six-bars whose rocker has turned by ``outputs`` at the inputs.

    Parameters
    ----------
    inputs, outputs : (9,)
        Angles [rad], of which differences from the first ones count.
    tracker : Tracker, optional
        By default compiled where that saves time.
    member : Member, optional
        A solved member to start from; by default the shipped one.
    progress : callable, optional
        Called with the finished fraction of the paths; may raise an error to end the work.
    """
    member = member or watt_member()
    inputs, outputs = inputs - inputs[0], outputs - outputs[0]
    goal = np.exp(1j * np.stack([inputs[1:], outputs[1:]], axis=1)).ravel()
    tracker = tracker or SparingTracker(len(member.x), progress)
    roots = roots_at(WATT, member, goal, tracker, np.random.default_rng(_SEED))
    apart = np.abs(WATT.mirrored(roots.x) - roots.x) / (_LEAST_SIZE + np.abs(roots.x))
    real = roots.x[apart.max(axis=1, initial=0.0) < ALMOST_REAL]
    proofs = prove_six_bars(real, inputs[1:], outputs[1:])
    return WattSixBars(
        arms=proofs.arms,
        turns=proofs.turns,
        inputs=inputs,
        outputs=outputs,
        proved=proofs.holds,
        error=proofs.error,
        roots=roots,
    )
