"""Parameters of which every run takes some, and the extended tests the others."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import pytest

__all__ = ["thinned"]


def thinned(values: Iterable[Any], every: int = 6) -> list[Any]:
    """Every sixth value, or whichever, as it is; the others marked as extended."""
    return [
        value if k % every == 0 else pytest.param(value, marks=pytest.mark.extended)
        for k, value in enumerate(values)
    ]
