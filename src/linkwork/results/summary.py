"""Short summaries of results as aligned text and as rows of a table."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

__all__ = ["Summary", "driven_text"]


@dataclass(frozen=True)
class Summary:
    """A title line and rows of a name and a text; as text, in aligned columns."""

    head: str
    rows: tuple[tuple[str, str], ...]

    def __str__(self) -> str:
        width = max((len(name) for name, _ in self.rows), default=0)
        return "\n".join([self.head, *(f"  {name:<{width}}  {text}" for name, text in self.rows)])


def driven_text(inputs: Mapping[str, float], units: Mapping[str, str]) -> str:
    """Input values with their units: ``crank = 60 deg``."""
    return ", ".join(f"{name} = {value:.10g} {units[name]}" for name, value in inputs.items())
