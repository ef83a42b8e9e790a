"""Why there is no position, and what would help: loaded only when something failed."""

from __future__ import annotations

from typing import TYPE_CHECKING

from linkwork.foundation.lazy import loader

if TYPE_CHECKING:
    from linkwork.motion.failure.failing import (
        another_root,
        beyond_reach,
        no_position,
        without_circuit,
        without_start,
    )
else:
    __getattr__ = loader(
        __name__,
        {
            "failing": (
                "another_root",
                "beyond_reach",
                "no_position",
                "without_circuit",
                "without_start",
            )
        },
    )

__all__ = [
    "another_root",
    "beyond_reach",
    "no_position",
    "without_circuit",
    "without_start",
]
