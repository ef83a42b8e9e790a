"""Parameters of which every run takes some, the extended tests some more, a thorough run all."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import pytest

__all__ = ["thinned"]


def thinned(values: Iterable[Any], every: int = 6) -> list[Any]:
    """Every sixth value, or whichever, as it is; as many extended ones; the others thorough."""
    marks = {every // 2: pytest.mark.extended, 0: ()}
    return [
        pytest.param(value, marks=marks.get(k % every, pytest.mark.thorough))
        for k, value in enumerate(values)
    ]
