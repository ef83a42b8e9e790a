"""The index of the cells of part reactions: each part that has them has a module of the same name.

It adds the part's reactions with ``write(part, reactions)``, and, if the part can be driven, the
force along its displacement with ``drive(part, reactions, effort)``. ``contacts(part, linkage)``
are the places where it pushes links in contact, ``numbers(part, linkage)`` those numbers on which
its forces alone depend: word, value, kind, description.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from importlib import import_module
from importlib.util import find_spec
from typing import Any

from linkwork.export.workbook.contact import Contact
from linkwork.mechanism.linkage import Linkage
from linkwork.mechanism.part.index import part_module
from linkwork.mechanism.part.part import Part
from linkwork.results.quantity import Kind

__all__ = ["contacts_of", "function_of", "has_cells", "numbers_of"]


def _room(part: Part) -> str:
    return f"{__package__}.{part_module(type(part))}"


def has_cells(part: Part) -> bool:
    """Whether the reactions of a part have cells."""
    return find_spec(_room(part)) is not None


def function_of(part: Part, name: str) -> Callable[..., Any]:
    """A function of the module of a part; one that does nothing if it has none."""
    found: Callable[..., Any] = getattr(import_module(_room(part)), name, lambda *_: ())
    return found


def contacts_of(linkage: Linkage) -> Iterator[Contact]:
    """Where the parts of a linkage push links in contact."""
    for part in linkage.parts:
        yield from function_of(part, "contacts")(part, linkage)


def numbers_of(linkage: Linkage) -> Iterator[tuple[str, str, float, Kind, str]]:
    """The name of a part, and a number on which its forces depend."""
    for part in linkage.parts:
        for number in function_of(part, "numbers")(part, linkage):
            yield (part.label, *number)
