"""One question of growth: the same solvers on works of growing size, in one run."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

from benchmarks.peers.comparison import Entry, compare
from benchmarks.peers.peer import Peer
from benchmarks.peers.report import significant
from benchmarks.peers.work import Work

__all__ = ["Growth", "Part", "grown"]


@dataclass(frozen=True, kw_only=True)
class Part:
    """A question of growth.

    To ask a further one, write a function that returns a :class:`Growth` and add a part to
    ``PARTS``.

    Parameters
    ----------
    measure : callable
        Takes the number of repeats.
    """

    name: str
    measure: Callable[[int], Growth]


@dataclass(frozen=True, kw_only=True)
class Growth:
    """Times over a size, per solver.

    Parameters
    ----------
    unit : str
        Of the times.
    size : str
        What grows.
    times : Mapping of solver to {size: median}
        A solver that was not given a size has none there.
    notes : list of str
        What was not measured and why, and answers that were not right.
    """

    title: str
    unit: str
    size: str
    times: dict[str, dict[int, float]]
    notes: list[str] = field(default_factory=list)

    def table(self) -> str:
        """Medians; below them how many times the first of the same solver each is."""
        sizes = sorted({size for curve in self.times.values() for size in curve})
        width = min(12, 58 // max(1, len(sizes)))
        lines = [f"{self.title} [{self.unit}]"]
        lines.append(f"{self.size:<22}" + "".join(f"{size:>{width},}" for size in sizes))
        for solver, curve in self.times.items():
            first = curve[min(curve)]
            cells = [significant(curve[size]) if size in curve else "-" for size in sizes]
            lines.append(f"{solver:<22}" + "".join(f"{cell:>{width}}" for cell in cells))
            if len(sizes) > 1:
                ratios = [f"{curve[size] / first:.2g}" if size in curve else "" for size in sizes]
                lines.append(
                    f"{'':<22}" + "".join(f"{'× ' + r if r else '':>{width}}" for r in ratios)
                )
        return "\n".join(lines + [f"  {note}" for note in self.notes])


def grown(
    *,
    title: str,
    unit: str,
    size: str,
    works: Sequence[tuple[int, Work]],
    peers: Sequence[Peer],
    repeats: int,
    most: dict[str, int] | None = None,
    share: Callable[[int], float] = lambda size: 1.0,
) -> Growth:
    """Compare peers on works of growing size.

    Parameters
    ----------
    works : sequence of (size, work)
    most : dict of peer name to size
        Larger works are not given to that peer.
    share : callable
        Time per position is divided by ``share(size)``.
    """
    times: dict[str, dict[int, float]] = {}
    notes: list[str] = []
    for count, work in works:
        asked = [peer for peer in peers if count <= (most or {}).get(peer.name, count)]
        for entry in compare(work, asked, repeats):
            notes += _notes(entry)
            if entry.verdict is not None:
                times.setdefault(entry.peer, {})[count] = entry.median / share(count)
    return Growth(title=title, unit=unit, size=size, times=times, notes=list(dict.fromkeys(notes)))


def _notes(entry: Entry) -> list[str]:
    if entry.verdict is None:
        return [f"{entry.peer}: {entry.absent}"[:78]]
    wrong = entry.verdict.rows - entry.verdict.found
    return [f"{entry.peer}: {wrong} rows not right of {entry.work}"] if wrong else []
