"""The place of Linkwork's compiled families; skipped while there are none."""

from __future__ import annotations

import linkwork as lw
from benchmarks.peers.peer import Peer, Prepared
from benchmarks.peers.work import Work

__all__ = ["LinkworkFamily"]


class LinkworkFamily(Peer):
    """Many mechanisms of one structure in one compiled call."""

    name = "linkwork family"
    distribution = "linkwork"
    module = "linkwork"

    def missing(self) -> str:
        return "" if hasattr(lw, "family") else "not there yet (linkwork.family)"

    def prepare(self, work: Work) -> Prepared:
        """Raises until the call is written here: the report then says so."""
        raise NotImplementedError("linkwork.family exists: call it in linkwork_family.py")
