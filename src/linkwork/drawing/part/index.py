"""The index of part symbols: each part has a module of the same name."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from importlib import import_module

from linkwork.drawing.measures import Measures
from linkwork.drawing.pose import Pose
from linkwork.drawing.scene import Primitive
from linkwork.mechanism.figures import Disc, Figure, Mesh
from linkwork.mechanism.part.index import part_module

__all__ = ["part_symbols"]


def part_symbols(figures: Iterable[Figure], pose: Pose, measures: Measures) -> Iterator[Primitive]:
    """The symbols of figures; wheels are drawn together, so that their teeth mesh."""
    for figure in figures:
        if not isinstance(figure, Disc | Mesh):
            module = import_module(f"linkwork.drawing.part.{part_module(type(figure))}")
            draw: Callable[[Figure, Pose, Measures], Iterator[Primitive]] = module.symbols
            yield from draw(figure, pose, measures)
