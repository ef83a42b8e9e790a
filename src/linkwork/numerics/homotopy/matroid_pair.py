"""Points of two spaces whose coordinates have given products: how many there are almost always.

x and y lie in spaces of dimensions a and b with the same coordinates E, a + b = |E| + 1, and
x_e y_e = λ_e for all e ∈ E, up to one factor common to all. For almost all λ the number of such
pairs (up to x -> cx, y -> y / c) is finite and depends only on which coordinates are independent on
either space. Let λ_ē of one coordinate grow beyond all bounds: the pairs then fall apart into
groups, one for each way to share the other coordinates out to two smaller problems of the same
kind. That is a recursion (Capco, Gallet, Grasegger, Koutschan, Lubbes, Schicho 2018, SIAM J. Appl.
Algebra Geom. 2, 94, for the edges of two graphs; docs/decisions/0008 has the proof for spaces).
"""

from __future__ import annotations

from linkwork.numerics.homotopy.column_sums import Columns, column_ranks

__all__ = ["MatroidPair"]


class MatroidPair:
    """x in the null space of closures with given columns, y in that of others of the same kind.

    Sets of coordinates, which are those of the columns, are bit masks.
    """

    def __init__(self, columns: Columns) -> None:
        count = len(columns)
        ranks = column_ranks(columns)
        self.whole = len(ranks) - 1
        #: The dimension of the null space, seen through every set of coordinates.
        self.ranks = [s.bit_count() - ranks[-1] + ranks[self.whole ^ s] for s in range(len(ranks))]
        self._bits = [1 << k for k in range(count)]
        self._known: dict[tuple[int, int, int], int] = {}
        self._spans: dict[int, int] = {}

    def follows(self, coordinate: int, others: int) -> bool:
        """Whether a coordinate is a combination of others."""
        return self.ranks[others | coordinate] == self.ranks[others]

    def solutions(self, here: int, forgotten: int = 0, zero: int = 0) -> int:
        """The number of pairs for the coordinates ``here``; 0 if it is not finite.

        Others are ``zero`` for x and do not matter for y, or the other way round (``forgotten``).
        """
        if not self._fits(here, forgotten, zero):
            return 0
        spans = self._span(forgotten), self._span(zero)
        if here & (spans[0] | spans[1]):
            return 0  # a coordinate that is zero everywhere
        # both spaces are of the same kind, so x and y may change places
        key = (here, min(spans), max(spans))
        if key not in self._known:
            self._known[key] = self._share_out(here, forgotten, zero)
        return self._known[key]

    def _share_out(self, here: int, forgotten: int, zero: int) -> int:
        """Sum over all ways to share out the other coordinates, without the pivot ē."""
        pivot = here & -here
        rest = here ^ pivot
        total = 0
        mine = rest
        while True:
            others = rest ^ mine
            left = (mine, forgotten | others | pivot, zero)
            right = (others, forgotten, zero | mine | pivot)
            # dimensions first: most ways do not fit
            if (not mine or self._fits(*left)) and (not others or self._fits(*right)):
                number = self.solutions(*left) if mine else 1
                if number and others:
                    number *= self.solutions(*right)
                total += number
            if not mine:
                return total
            mine = (mine - 1) & rest

    def _fits(self, here: int, forgotten: int, zero: int) -> bool:
        """Whether there are as many equations as unknowns."""
        ranks = self.ranks
        free = ranks[here | zero] - ranks[zero] + ranks[here | forgotten] - ranks[forgotten]
        return free == here.bit_count() + 1

    def _span(self, zero: int) -> int:
        """All coordinates that are zero with these ones."""
        if zero not in self._spans:
            self._spans[zero] = sum(bit for bit in self._bits if self.follows(bit, zero))
        return self._spans[zero]
