"""Rows of one mechanism computed by the compiled kernels, if that is faster."""

from __future__ import annotations

from typing import TYPE_CHECKING

from linkwork.foundation.lazy import loader

if TYPE_CHECKING:
    from linkwork.motion.by_kernels.choice import (
        are_served as are_served,
        kernels_pay as kernels_pay,
    )
    from linkwork.motion.by_kernels.equations import (
        block_parts as block_parts,
        lines_of_lengths as lines_of_lengths,
    )
    from linkwork.motion.by_kernels.kernels import kernel_of as kernel_of
    from linkwork.motion.by_kernels.rows import (
        kernel_rows as kernel_rows,
    )
else:  # rows and kernels load compiled code
    __getattr__ = loader(__name__)
