"""Reference solutions, computed independently of the compared solvers."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import chain, combinations

import numpy as np

from benchmarks.peers.dyad_linkage import Array, ComplexArray, DyadLinkage, stacked
from benchmarks.peers.loop_system import newton
from benchmarks.peers.work import Work

__all__ = ["Reference", "reference_of"]

#: With more dyads than this, other configurations are too many to be listed.
MOST_DYADS = 4


@dataclass(frozen=True, kw_only=True, eq=False)
class Reference:
    """The positions of the compared point, and those of every configuration.

    Parameters
    ----------
    traced : array (members, rows), complex
    configurations : array (configurations, members, rows), complex
        NaN where one does not exist; of length 0 where they are not known.
    scale : array (members, 1)
        The length that errors are divided by: the longest link.
    """

    traced: ComplexArray
    configurations: ComplexArray
    scale: Array

    def sample(self, members: int) -> Reference:
        """That of the first members."""
        return replace(
            self,
            traced=self.traced[:members],
            configurations=self.configurations[:, :members],
            scale=self.scale[:members],
        )


def reference_of(work: Work) -> Reference:
    """Closed forms for dyads; for anything else Newton's method in small steps."""
    if work.dyads:
        family = stacked(work.dyads)
        traced = family.positions(work.inputs)[family.traced]
        ways = _configurations(family, work.inputs)
    else:
        traced = np.array(
            [
                member.loops.trace(newton(member.loops, work.inputs), work.inputs)
                for member in work.members
            ]
        )
        ways = [way for drive in work.rapiers for way in drive.configurations(work.inputs)]
    return Reference(
        traced=traced,
        configurations=np.array(ways, complex).reshape(-1, *traced.shape),
        scale=np.array([[member.loops.scale] for member in work.members]),
    )


def _configurations(family: DyadLinkage, inputs: Array) -> list[ComplexArray]:
    joining = [dyad.point for dyad in family.dyads if not dyad.rigid]
    if len(joining) > MOST_DYADS:
        return []
    mirrored = chain.from_iterable(
        combinations(joining, count) for count in range(len(joining) + 1)
    )
    return [family.positions(inputs, which)[family.traced] for which in mirrored]
