"""Linkwork's families: all mechanisms of one structure in one call, the kernels warm."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from benchmarks.peers.dyad_linkage import ComplexArray
from benchmarks.peers.linkwork_sweep import family_of
from benchmarks.peers.peer import Peer, Prepared
from benchmarks.peers.work import Work

if TYPE_CHECKING:
    from linkwork.families import FamilyMotion

__all__ = ["LinkworkFamily"]


class LinkworkFamily(Peer):
    """``family.sweep`` with or without proof, on one core; designs are built beforehand.

    ``specialised``: with the mechanism's own equations compiled, also beforehand.
    """

    distribution = "linkwork"
    module = "linkwork"

    def __init__(self, *, certify: bool, specialised: bool = False) -> None:
        self.certify, self.specialised = certify, specialised
        kind = "compiled" if specialised else "family"
        self.name = f"{kind}, certified" if certify else kind

    def prepare(self, work: Work) -> Prepared:
        family = family_of(work)

        def run() -> FamilyMotion:
            return family.sweep(certify=self.certify, threads=1, specialised=self.specialised)

        return Prepared(run=run, read=self._read)

    def _read(self, motion: FamilyMotion) -> ComplexArray:
        proved = motion.certified | (not self.certify)
        return np.where(proved, motion.trace("T"), np.nan)
