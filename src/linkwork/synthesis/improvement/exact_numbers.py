"""Numbers of the motions of designs as goals, exact between the rows of a fit.

A fit has numbers of polynomials through its rows. Their errors are measured on the motions of its
designs, and taken off the numbers while the fit goes on: a deferred correction.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from linkwork.core.foundation.arrays import Array, BoolArray, IndexArray
from linkwork.core.foundation.errors import LinkworkError
from linkwork.core.mechanism.varied_numbers import VariedNumber, with_numbers
from linkwork.core.motion.model import model_of
from linkwork.core.motion.sweeping import sweep
from linkwork.core.results.motion import Motion
from linkwork.synthesis.improvement.goals import Misses, NumberMisses
from linkwork.synthesis.improvement.lanes import DesignWriter, SolvedLanes

__all__ = ["ExactNumbers"]

_EQUAL = 1e-12  # relative: numbers that differ less are equal


class ExactNumbers:
    """The errors of the numbers of goals in lanes.

    Parameters
    ----------
    writer : DesignWriter
    numbers : sequence of VariedNumber
        Those of its designs.
    goals : sequence of Misses
    rows : Mapping[bytes, SolvedLanes]
        Their positions.
    there : (R,)
        Where the mechanism as it is has a position.
    lanes : int

    Attributes
    ----------
    errors : (K, lanes)
        How much the numbers of a fit are above the exact ones, for each goal.
    """

    def __init__(
        self,
        writer: DesignWriter,
        numbers: Sequence[VariedNumber],
        goals: Sequence[Misses],
        rows: Mapping[bytes, SolvedLanes],
        there: BoolArray,
        lanes: int,
    ) -> None:
        self._writer, self._numbers, self._rows, self._there = writer, numbers, rows, there
        self._goals = {k: own for k, own in enumerate(goals) if isinstance(own, NumberMisses)}
        self.errors = np.zeros((len(goals), lanes))

    def correct(self, x: Array, parts: Sequence[IndexArray]) -> IndexArray:
        """New errors of lanes that are at numbers (lanes, P); the lanes in which they are others.

        A design without all rows of the mechanism keeps its error.
        """
        changed = []
        for lanes in parts if self._goals else ():
            values = [*self._values(x[lanes], lanes)]
            for d, lane in enumerate(lanes.tolist()):
                motion = self._motion(x[lane])
                if motion is None:
                    continue
                before = self.errors[:, lane].copy()
                exact = np.array([goal.exact(motion) for goal in self._goals.values()])
                error = [float(value[d]) for value in values] - exact
                self.errors[[*self._goals], lane] = np.where(np.isnan(error), 0.0, error)
                away = np.abs(self.errors[:, lane] - before)[[*self._goals]]
                if not (away <= _EQUAL * np.abs(exact)).all():
                    changed.append(lane)
        return np.array(changed, dtype=np.intp)

    def _values(self, x: Array, lanes: IndexArray) -> Iterator[Array]:
        """The numbers of each goal in a fit, (D,)."""
        designs = self._writer.written(x)
        for goal in self._goals.values():
            at = np.broadcast_to(goal.at, (len(lanes), len(goal.at)))
            yield goal.values(self._rows[goal.at.tobytes()].at(designs, at, lanes))[0][:, 0]

    def _motion(self, x: Array) -> Motion | None:
        """The motion of a design, if it has all rows that the mechanism has."""
        new = dict(zip(self._numbers, x.tolist(), strict=True))
        try:
            model = model_of(with_numbers(self._writer.model.description, new))
            motion = sweep(model, certify=False)
        except LinkworkError:
            return None
        return motion if motion.found[motion.asked][self._there].all() else None
