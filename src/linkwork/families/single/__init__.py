"""Equations of one row, in plain numbers and in compiled code, which is loaded when first used."""

from __future__ import annotations

from typing import TYPE_CHECKING

from linkwork.core.foundation.loading import loader

if TYPE_CHECKING:
    from linkwork.families.single.compiled_rows import (
        solve_row as solve_row,
        take_rates as take_rates,
    )
else:
    __getattr__ = loader(__name__)
