"""Many designs of one mechanism at once: what varies, and the coefficients of their equations."""

from __future__ import annotations

from typing import TYPE_CHECKING

from linkwork.foundation.lazy import loader

if TYPE_CHECKING:
    from linkwork.batch.designs import Designs, designs_of
    from linkwork.batch.sampling import Plan, from_table, grid, latin_hypercube, random
else:
    __getattr__ = loader(
        __name__,
        {
            "designs": ("Designs", "designs_of"),
            "sampling": ("Plan", "from_table", "grid", "latin_hypercube", "random"),
        },
    )

__all__ = [
    "Designs",
    "Plan",
    "designs_of",
    "from_table",
    "grid",
    "latin_hypercube",
    "random",
]
