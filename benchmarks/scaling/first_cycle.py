"""One cycle of a four-bar by one peer: the process that ``cold_start`` measures."""

from __future__ import annotations

import sys

from benchmarks.peers.work import four_bar


def first_cycle(name: str) -> None:
    """Solve once with the peer of this name; with none of that name, only write the work down."""
    work = four_bar(361)
    if name == "NumPy alone":
        return
    # The registry imports Linkwork, which the first line of the table must not pay for.
    from benchmarks.peers.registry import PEERS

    peer = next(peer for peer in PEERS if peer.name == name)
    peer.prepare(work).run()


if __name__ == "__main__":
    first_cycle(sys.argv[1])
