"""The classification of a mechanism as lines of a page."""

from __future__ import annotations

from collections.abc import Iterator

from linkwork.results.classification import Classification, roman

__all__ = ["classification_fields"]


def classification_fields(found: Classification) -> Iterator[tuple[str, str]]:
    """Chain, type and class with their labels."""
    blocks = ", ".join(found.blocks)
    counted = ""
    if found.blocks:
        whose = "pin in slot" if len(found.blocks) == 1 else "pins in slots"
        what = "a block" if len(found.blocks) == 1 else "blocks"
        counted = f"; {whose} {blocks} counted as {what}"
    yield "chain", found.chain + counted
    if found.type:
        yield "type", found.type
    if found.class_number is not None:
        several = ", the highest of its Assur groups" if len(found.groups) > 1 else ""
        yield "class", roman(found.class_number) + several
