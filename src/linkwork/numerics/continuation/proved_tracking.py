"""Following a branch with every step proved before the next is taken."""

from __future__ import annotations

import math

import numpy as np

from linkwork.foundation.arrays import Array
from linkwork.foundation.rounding import UNIT_ROUNDOFF
from linkwork.foundation.status import CONVERGED
from linkwork.marching.loop import Attempt, StepBounds, march
from linkwork.numerics.block_solver import BlockSolver
from linkwork.numerics.continuation.branch_tracking import InputPath, Node, Watch, node_at, predict
from linkwork.numerics.proof.position_proof import (
    Place,
    Proof,
    expansions,
    prove,
    reach,
    rounding_of_inputs,
    steps_connected,
)

__all__ = ["follow_with_proof"]

_MOST_ATTEMPTS = 300  # about a second; half as many lead past a place where branches nearly cross
_GROWTH = 1.5  # of steps that are proved one by one


def follow_with_proof(
    solver: BlockSolver, path: InputPath, start: Node, goal: float, watch: Watch
) -> list[Node]:
    """The branch of ``start`` towards ``t = goal``, every step proved before the next is taken.

    The proof determines the step size: many short steps near a crossing of branches, and none
    that could come onto the other one. Ends where ``watch`` has seen enough or nothing is proved.
    """
    bounds = StepBounds(
        size=path.size, first=0.01, largest=math.inf, smallest=1e-13, attempts=_MOST_ATTEMPTS
    )
    nodes, _ = march(_ProvedTrial(solver, path, start), start, goal, bounds, watch)
    return nodes


class _ProvedTrial:
    """A step that is taken only if it is proved, with residuals that are rounded once."""

    def __init__(self, solver: BlockSolver, path: InputPath, start: Node) -> None:
        self.solver, self.path = solver, path
        self.here, self.places = self._proof(start.v[None, :])

    def _proof(self, v: Array) -> tuple[Proof, list[Place]]:
        places = expansions(self.solver, v, exact=True)
        return prove(self.solver, v, rounding_of_inputs(v, self.solver.unknowns), places), places

    def room(self, here: Node, sign: float) -> float:
        """The proof bounds the step, nothing else."""
        return math.inf

    def attempt(self, here: Node, t: float) -> Attempt[Node]:
        """Predict, correct, prove the position and the step to it."""
        solver = self.solver
        guess = predict(here, t)  # eq. (17)
        guess[solver.unknowns :] = self.path.at(t)
        found = solver.solve(guess[None, :])
        if found.status[0] != CONVERGED:
            return Attempt(None)
        v = solver.sharpen(found.v)
        known = rounding_of_inputs(v, solver.unknowns)
        proof, places = self._proof(v)
        input_radius = np.abs(v - here.v)[:, solver.unknowns :] * (1.0 + 8.0 * UNIT_ROUNDOFF)
        reached = reach(solver, here.v[None, :], input_radius + 2.0 * known, self.places)
        # the position at either end may be off by its error
        both = np.maximum(proof.error_bound, self.here.error_bound)
        # eq. (33)
        if not (proof.holds[0] and steps_connected(here.v[None, :], v, reached, both)[0]):
            return Attempt(None)
        self.here, self.places = proof, places
        return Attempt(node_at(solver, self.path, t, v[0]), _GROWTH)
