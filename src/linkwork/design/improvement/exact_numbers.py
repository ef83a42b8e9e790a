"""Numbers of the motions of designs as goals, exact between the rows of a fit.

A fit has numbers of polynomials through its rows. Their errors are measured on the motions of its
designs, and added to the numbers while the fit goes on: a deferred correction.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from linkwork.design.improvement.goals import Misses
from linkwork.foundation.arrays import Array, BoolArray, IndexArray
from linkwork.foundation.errors import LinkworkError
from linkwork.mechanism.varied_number import VariedNumber, with_numbers
from linkwork.motion.model import Model, model_of
from linkwork.motion.sweeping import sweep
from linkwork.results.motion import Motion

__all__ = ["ExactNumbers"]

_EQUAL = 1e-12  # relative: numbers that differ less are equal


class ExactNumbers:
    """The errors of the numbers of goals in lanes.

    Parameters
    ----------
    model : Model
    numbers : sequence of VariedNumber
    goals : sequence of Misses
    there : (R,)
        Where the mechanism as it is has a position.
    lanes : int

    Attributes
    ----------
    errors : (K, lanes)
        What is added to the numbers of each goal.
    """

    def __init__(
        self,
        model: Model,
        numbers: Sequence[VariedNumber],
        goals: Sequence[Misses],
        there: BoolArray,
        lanes: int,
    ) -> None:
        self._model, self._numbers, self._there = model, numbers, there
        #: The goals that are numbers of the motion, by their places.
        self.goals = {k: misses for k, misses in enumerate(goals) if misses.is_number}
        self.errors = np.zeros((len(goals), lanes))

    def take(self, x: Array, values: dict[int, Array], lanes: IndexArray) -> BoolArray:
        """New errors of lanes with numbers (D, P) and values of goals (D,) without them; in which
        lanes they are others.

        A design that has no motion keeps its error.
        """
        changed = np.zeros(len(lanes), dtype=bool)
        for d, lane in enumerate(lanes.tolist()):
            motion = self._motion(x[d])
            for k, misses in self.goals.items() if motion is not None else ():
                exact = misses.exact(motion)
                error = exact - float(values[k][d])
                if not np.isnan(error):
                    changed[d] |= not abs(error - self.errors[k, lane]) <= _EQUAL * abs(exact)
                    self.errors[k, lane] = error
        return changed

    def _motion(self, x: Array) -> Motion | None:
        """The motion of a design, if it has all rows that the mechanism has."""
        new = dict(zip(self._numbers, x.tolist(), strict=True))
        try:
            motion = sweep(model_of(with_numbers(self._model.description, new)), certify=False)
        except LinkworkError:
            return None
        return motion if motion.found[motion.asked][self._there].all() else None
