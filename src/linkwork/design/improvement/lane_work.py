"""Work on parts of lanes on all cores, which tells its progress and which the user may stop."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from linkwork.foundation.arrays import IndexArray
from linkwork.foundation.sharing import cores, share_out

__all__ = ["LaneWork"]

_PART, _MOST = 8, 64  # lanes of one thread: of many rows, of few
_ROWS = 4000  # of all lanes of a thread: fewer would take as long

#: Works on lanes, and calls what it gets before each step.
Work = Callable[[IndexArray, Callable[[], None]], None]


class LaneWork:
    """All work on the lanes of a fit.

    Parameters
    ----------
    rows : int
        Of each lane.

    Attributes
    ----------
    tell : callable, optional
        Gets the finished fraction.
    whole, done : int
        Steps.
    stopped : bool
        Whether the user has stopped the work.
    """

    def __init__(self, rows: int) -> None:
        self.rows = rows
        self.tell: Callable[[float], None] | None = None
        self.whole, self.done, self.stopped = 1, 0, False

    def parts(self, lanes: IndexArray) -> list[IndexArray]:
        """Parts whose sizes do not depend on the number of cores; one at least."""
        size = min(max(_PART, _ROWS // max(1, self.rows)), _MOST)
        return [lanes[k : k + size] for k in range(0, max(1, len(lanes)), size)]

    def share(self, lanes: IndexArray, steps: int, work: Work) -> None:
        """Work on lanes part by part, each of so many steps, until the user stops it."""
        parts = self.parts(lanes)
        done = np.zeros(len(parts))

        def part(k: int) -> None:
            def count() -> None:
                if self.stopped:
                    raise KeyboardInterrupt
                if self.tell is not None:
                    self.tell(min(1.0, (self.done + float(done.mean())) / self.whole))
                done[k] = min(done[k] + 1.0, steps)

            try:
                work(parts[k], count)
            except KeyboardInterrupt:
                self.stopped = True
                raise
            done[k] = steps

        try:
            share_out(part, range(len(parts)), cores())
        except KeyboardInterrupt:
            # while waiting for the other threads, which stop at their next step
            self.stopped = True
        self.done += steps
