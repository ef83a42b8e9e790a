"""Parameters of which every run takes some, the extended tests some more, a thorough run all."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import pytest

__all__ = ["thinned"]


def thinned(values: Iterable[Any], every: int = 6) -> list[Any]:
    """Every sixth value, or whichever, as it is; as many extended ones; the others thorough."""
    return [
        value if k % every == 0 else pytest.param(value, marks=_mark(k % every, every))
        for k, value in enumerate(values)
    ]


def _mark(place: int, every: int) -> pytest.MarkDecorator:
    return pytest.mark.extended if place == every // 2 else pytest.mark.thorough
