"""What is drawn over a mechanism to explain it: arrows, centres, dimensions, with their names."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field

from linkwork.drawing.label_placement import Choice
from linkwork.drawing.scene import Primitive

__all__ = ["Annotation", "round_number"]


@dataclass(frozen=True, kw_only=True)
class Annotation:
    """One kind of explanation.

    Parameters
    ----------
    drawn : list of Primitive
    names : list of Choice
        Texts whose places are chosen when everything is drawn.
    caption : str
        What has to be said to read it, as the scale of arrows; "" if nothing.
    """

    drawn: list[Primitive] = field(default_factory=list)
    names: list[Choice] = field(default_factory=list)
    caption: str = ""

    @classmethod
    def joined(cls, parts: Iterable[Annotation]) -> Annotation:
        """Several kinds as one."""
        every = list(parts)
        return cls(
            drawn=[primitive for part in every for primitive in part.drawn],
            names=[name for part in every for name in part.names],
            caption="; ".join(part.caption for part in every if part.caption),
        )


def round_number(wanted: float) -> float:
    """The largest of 1, 2, 5 times a power of ten that is not above a positive number."""
    power: float = 10.0 ** int(f"{wanted:e}".partition("e")[2])
    return max(step * power for step in (1.0, 2.0, 5.0) if step * power <= wanted)
