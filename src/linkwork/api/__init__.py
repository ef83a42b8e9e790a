"""Mechanisms, as users make and use them."""

from __future__ import annotations

from linkwork.api.making import example, linkage, load, loads, loops, plain_equations
from linkwork.api.mechanism import Mechanism
from linkwork.textfile.library import example_text, examples

__all__ = [
    "Mechanism",
    "example",
    "example_text",
    "examples",
    "linkage",
    "load",
    "loads",
    "loops",
    "plain_equations",
]
