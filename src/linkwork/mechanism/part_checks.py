"""What every part in contact is asked: its links and points exist, its sizes are positive."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from linkwork.foundation.errors import choices
from linkwork.mechanism.parts import Number

if TYPE_CHECKING:
    from linkwork.mechanism.description import Problems
    from linkwork.mechanism.linkage import Linkage

__all__ = ["AGREE", "Key", "PartChecks"]

Key = tuple[str | int, ...]

#: Relative: numbers that are given twice must agree to this.
AGREE = 1e-9


class PartChecks:
    """Checks of one linkage, adding to its problems."""

    def __init__(self, linkage: Linkage, problems: Problems) -> None:
        self.linkage, self.problems = linkage, problems

    def defined(self, point: str) -> bool:
        return point in self.linkage.points

    def undefined_point(self, point: str, key: Key) -> None:
        known = choices("points", self.linkage.points, point)
        self.problems.add(key, f'point "{point}" is not defined {known}')

    def link(self, link: str, key: Key) -> bool:
        if link in self.linkage.links:
            return True
        known = choices("links", self.linkage.links, link)
        self.problems.add(key, f'link "{link}" is not defined {known}')
        return False

    def on(self, point: str, link: str, key: Key) -> None:
        """The point has to be one of the link's."""
        if not self.defined(point):
            self.undefined_point(point, key)
        elif point not in self.linkage.links[link]:
            known = choices("points", self.linkage.links[link])
            self.problems.add(key, f'point "{point}" is not on link "{link}" {known}')

    def two(self, names: Sequence[str], key: Key, noun: str) -> bool:
        if len(names) != 2:
            self.problems.add(key, f"needs two {noun}s, got {len(names)}")
            return False
        if names[0] == names[1]:
            self.problems.add(key, f"needs two different {noun}s, got {names[0]} twice")
            return False
        return True

    def positive(self, number: Number, key: Key, noun: str) -> float:
        amount = self.linkage.numbers.check_number(self.problems.add, key, number)
        if amount <= 0:
            what = "positive" if noun == "radii" else f"a positive {noun}"
            what = "positive whole numbers" if noun == "teeth" else what
            self.problems.add(key, f"must be {what}, got {amount:g}")
        return amount
