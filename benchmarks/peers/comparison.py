"""One task for all peers: set up, checked, then timed in turn."""

from __future__ import annotations

import statistics
import time
import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from math import ceil
from typing import Any

from benchmarks.peers.peer import Peer, Prepared
from benchmarks.peers.reference import Reference, reference_of
from benchmarks.peers.verdict import Verdict, judged
from benchmarks.peers.work import Work
from benchmarks.timing import interleaved, seconds

__all__ = ["Entry", "compare"]

#: A timed call is repeated until it lasts about this long [s], so that the clock does not matter.
LEAST_TIME = 0.005


@dataclass(frozen=True, kw_only=True)
class Entry:
    """The result of one peer on one task.

    Parameters
    ----------
    absent : str
        Reason for a missing result: not installed, not possible, failed; "" if measured.
    members, positions : int
        Numbers of mechanisms, and of positions per run.
    nanoseconds : tuple of float
        Per position, one for each of the interleaved repeats.
    verdict : Verdict, optional
        Correctness of the results.
    """

    work: str
    peer: str
    version: str = ""
    absent: str = ""
    members: int = 0
    positions: int = 0
    nanoseconds: tuple[float, ...] = ()
    verdict: Verdict | None = None

    @property
    def median(self) -> float:
        """The median time per position [ns]."""
        return statistics.median(self.nanoseconds)


@dataclass(frozen=True, kw_only=True)
class _Ready:
    entry: Entry
    run: Callable[[], Any]
    calls: int


def compare(
    work: Work,
    peers: Sequence[Peer],
    repeats: int,
    told: Callable[[str], None] = lambda _: None,
) -> list[Entry]:
    """Entries in the order of the peers.

    Every peer is prepared and run once before anything is timed, so compiled code is warm; then
    all are timed in turn, A B C … A B C …, so that a disturbance affects all of them. Times are
    processor times of all threads of the process, without other programs.

    Parameters
    ----------
    told : callable
        Called with the name of each peer before its preparation.
    """
    reference = reference_of(work)
    states: list[_Ready | Entry] = []
    for peer in peers:
        told(peer.name)
        states.append(_set_up(peer, work, reference))
    ready = [state for state in states if isinstance(state, _Ready)]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # rows that failed are counted instead
        runs = [partial(_repeat, s.run, s.calls) for s in ready]
        times = interleaved(runs, repeats, time.process_time)
    measured = iter(zip(ready, times, strict=True))
    return [state if isinstance(state, Entry) else _entry(*next(measured)) for state in states]


def _repeat(run: Callable[[], Any], calls: int) -> None:
    for _ in range(calls):
        run()


def _entry(ready: _Ready, times: Sequence[float]) -> Entry:
    share = 1e9 / (ready.calls * ready.entry.positions)
    return replace(ready.entry, nanoseconds=tuple(t * share for t in times))


def _set_up(peer: Peer, work: Work, reference: Reference) -> _Ready | Entry:
    """The prepared peer, or the reason for its absence."""
    absent = peer.missing()
    if absent:
        return Entry(work=work.name, peer=peer.name, absent=absent)
    absent = peer.cannot(work)
    if absent:
        return Entry(work=work.name, peer=peer.name, version=peer.version(), absent=absent)
    members = min(len(work.members), peer.most_members or len(work.members))
    part = work.sample(members)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            prepared = peer.prepare(part)
            verdict = judged(prepared.read(prepared.run()), reference.sample(members))
    except Exception as error:  # any error of a peer must not stop the others
        reason = f"failed: {type(error).__name__}: {error}"
        return Entry(work=work.name, peer=peer.name, version=peer.version(), absent=reason)
    entry = Entry(
        work=work.name,
        peer=peer.name,
        version=peer.version(),
        members=members,
        positions=part.positions,
        verdict=verdict,
    )
    return _Ready(entry=entry, run=prepared.run, calls=_calls(prepared))


def _calls(prepared: Prepared) -> int:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return max(1, ceil(LEAST_TIME / max(seconds(prepared.run), 1e-9)))
