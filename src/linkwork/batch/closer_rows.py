"""The rows of designs, so close that the extremes of smooth quantities show in them."""

from __future__ import annotations

from dataclasses import replace

from linkwork.batch.design_sweep import design_rows
from linkwork.batch.designs import Designs
from linkwork.batch.located_extremes import parts_of
from linkwork.batch.rows import DesignRows
from linkwork.batch.single_sweep import with_table
from linkwork.motion.leading_input import leading_input
from linkwork.results.quantity import Kind

__all__ = ["closer_rows"]


def closer_rows(designs: Designs, rows: DesignRows, threads: int) -> tuple[Designs, DesignRows]:
    """Designs and their rows; where rows are too far apart, those of a table between them."""
    base = designs.base
    if len(base.rows) < 2:
        return designs, rows
    lead = leading_input(base.rows)[0]
    parts = parts_of(base.rows[:, lead], Kind(base.equations.inputs[lead].kind))
    if parts < 2:
        return designs, rows
    designs = replace(designs, base=with_table(base, base, parts))
    return designs, design_rows(designs, certify=False, threads=threads)
