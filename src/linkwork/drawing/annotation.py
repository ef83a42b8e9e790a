"""Annotations drawn over a mechanism: arrows, centres and dimensions, with their names."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field

from linkwork.drawing.label_placement import Choice
from linkwork.drawing.scene import Primitive

__all__ = ["Annotation", "round_up"]

_SHORT = (1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0)


@dataclass(frozen=True, kw_only=True)
class Annotation:
    """One kind of annotation.

    Parameters
    ----------
    drawn : list of Primitive
    names : list of Choice
        Texts whose positions are chosen when everything else is drawn.
    caption : str
        Explanation such as the scale of arrows; "" if none.
    """

    drawn: list[Primitive] = field(default_factory=list)
    names: list[Choice] = field(default_factory=list)
    caption: str = ""

    @classmethod
    def joined(cls, parts: Iterable[Annotation]) -> Annotation:
        """Combine several annotations."""
        every = list(parts)
        return cls(
            drawn=[primitive for part in every for primitive in part.drawn],
            names=[name for part in every for name in part.names],
            caption="; ".join(part.caption for part in every if part.caption),
        )


def round_up(wanted: float) -> float:
    """A positive number rounded up to 1, 1.5, 2, 2.5, 3, 4, 5, 6 or 8 times a power of ten."""
    power: float = 10.0 ** int(f"{wanted:e}".partition("e")[2])
    return min(step * power for step in _SHORT if step * power >= wanted * (1.0 - 1e-12))
