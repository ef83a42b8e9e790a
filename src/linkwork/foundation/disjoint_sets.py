"""Disjoint sets of numbered things, united two at a time (union-find)."""

from __future__ import annotations

__all__ = ["DisjointSets"]


class DisjointSets:
    """Sets of the numbers 0, 1, …; a set is named by its smallest number, its root."""

    def __init__(self, count: int = 0) -> None:
        self.above = list(range(count))

    def add(self) -> int:
        """Add the next number as a set of one element."""
        self.above.append(len(self.above))
        return self.above[-1]

    def root(self, k: int) -> int:
        """The smallest number of the set that holds k."""
        while self.above[k] != k:
            k = self.above[k]
        return k

    def unite(self, a: int, b: int) -> bool:
        """Unite the sets of a and b; returns whether they were different."""
        # the smaller root stays, so that names of sets do not depend on the order of unions
        first, second = sorted((self.root(a), self.root(b)))
        self.above[second] = first
        return first != second
