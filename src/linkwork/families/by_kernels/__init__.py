"""Rows of one mechanism computed by the compiled kernels, if that is faster."""

from __future__ import annotations

from typing import TYPE_CHECKING

from linkwork.core.foundation.loading import loader

if TYPE_CHECKING:
    from linkwork.families.by_kernels.choice import (
        are_served as are_served,
        kernels_pay as kernels_pay,
    )
    from linkwork.families.by_kernels.rows import (
        block_parts as block_parts,
        kernel_of as kernel_of,
        kernel_rows as kernel_rows,
        lines_of_lengths as lines_of_lengths,
    )
else:  # rows and kernels load compiled code
    __getattr__ = loader(__name__)
