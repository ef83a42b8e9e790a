"""Rows of one mechanism by the compiled kernels, where that is quicker."""

from __future__ import annotations

from typing import TYPE_CHECKING

from linkwork.foundation.lazy import loader

if TYPE_CHECKING:
    from linkwork.motion.by_kernels.choice import are_served, kernels_pay
    from linkwork.motion.by_kernels.equations import block_parts, lines_of_lengths
    from linkwork.motion.by_kernels.kernels import kernel_of
    from linkwork.motion.by_kernels.rows import KernelRows, kernel_rows
else:  # rows and kernels load compiled code
    __getattr__ = loader(
        __name__,
        {
            "choice": ("are_served", "kernels_pay"),
            "equations": ("block_parts", "lines_of_lengths"),
            "kernels": ("kernel_of",),
            "rows": ("KernelRows", "kernel_rows"),
        },
    )

__all__ = [
    "KernelRows",
    "are_served",
    "block_parts",
    "kernel_of",
    "kernel_rows",
    "kernels_pay",
    "lines_of_lengths",
]
