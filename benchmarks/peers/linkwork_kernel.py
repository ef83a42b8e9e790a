"""Linkwork's kernel alone: one mechanism's march prepared beforehand, a call for all rows."""

from __future__ import annotations

from dataclasses import replace
from importlib import import_module
from typing import TYPE_CHECKING

import numpy as np

from benchmarks.peers.dyad_linkage import ComplexArray
from benchmarks.peers.linkwork_sweep import family_of
from benchmarks.peers.peer import Peer, Prepared
from benchmarks.peers.work import Work
from linkwork.core.foundation.arrays import Array

if TYPE_CHECKING:  # compiled code is loaded by those who use it
    from linkwork.families.family_march import FamilyMarch
    from linkwork.families.march.one_design import RowsOfOne

__all__ = ["LinkworkKernel", "rows_of_one"]


def rows_of_one(march: FamilyMarch, t: Array) -> RowsOfOne:
    """The rows of a family of one design, to be computed again and again."""
    steps = import_module("linkwork.families.march.march_programs").Steps()
    return march.kernel.prepare_single(
        march.coefficients,
        march.guess[:, 0],
        float(march.start[0]),
        t,
        steps.times(march.path.size),
    )


class LinkworkKernel(Peer):
    """What the march costs without reading a mechanism, statuses and tables; it starts anew in
    every call.
    """

    distribution = "linkwork"
    module = "linkwork"

    def __init__(self, *, certify: bool, compiled: bool) -> None:
        self.certify, self.compiled = certify, compiled
        kind = "compiled kernel" if compiled else "kernel"
        self.name = f"{kind}, proof" if certify else kind

    def cannot(self, work: Work) -> str:
        return "" if len(work.members) == 1 else "one mechanism only"

    def prepare(self, work: Work) -> Prepared:
        family = family_of(work)
        motion = family.sweep(certify=self.certify, threads=1, specialised=self.compiled)
        model = family.designs.base
        # compiled code is loaded by those who use it
        path = import_module("linkwork.families.design_sweep").TablePath.of(model)
        assert path is not None
        execution = import_module("linkwork.families.compiled.execution").Execution
        march = path.march(family.designs, self.certify, 1, execution(specialised=self.compiled))
        t = model.rows[:, path.lead]
        t = np.ascontiguousarray(t[::-1] if path.falling else t)

        one = rows_of_one(march, t)

        def run() -> Array:
            found = one.run()
            assert found is not None
            v: Array = found[0]
            return v

        def read(v: Array) -> ComplexArray:
            way = slice(None, None, -1 if path.falling else 1)
            rows = replace(motion.rows, v=v[:, way])
            return replace(motion, rows=rows).trace("T")

        return Prepared(run=run, read=read)
