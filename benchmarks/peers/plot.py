"""A comparison as a picture: a panel per mechanism, time per position on a logarithmic axis."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import groupby
from pathlib import Path

import matplotlib
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from benchmarks.peers.comparison import Entry
from benchmarks.peers.report import significant

__all__ = ["draw"]

LINKWORK, OTHERS = "#c1440e", "#34597c"
LEAST, MOST = 4.0, 4e6  # of the axis [ns]; wider where figures ask for it


def draw(path: Path, machine: str, entries: Sequence[Entry]) -> None:
    """Write the picture: marks with their medians beside, an incomplete answer as a cross.

    What was not measured is left out.
    """
    measured = [entry for entry in entries if entry.verdict is not None]
    if not measured:
        return
    panels = [(name, list(group)) for name, group in groupby(measured, _mechanism)]
    with matplotlib.rc_context({"font.size": 8, "font.family": "DejaVu Sans"}):
        heights = [len({entry.peer for entry in group}) + 2.2 for _, group in panels]
        figure = Figure(figsize=(8.0, 0.2 * sum(heights) + 0.7), layout="constrained")
        table = figure.subplots(len(panels), 1, sharex=True, squeeze=False, height_ratios=heights)
        for axis, (name, group) in zip(table[:, 0], panels, strict=True):
            _panel(axis, name, group)
        table[-1, 0].set_xlabel("ns per position, median with least and most\n" + machine)
        figure.savefig(path, dpi=130)


def _mechanism(entry: Entry) -> str:
    return entry.work.partition(", ")[0]


def _panel(axis: Axes, name: str, entries: Sequence[Entry]) -> None:
    """One line per peer, the fastest on top, one mark per table of inputs."""
    tables = list(dict.fromkeys(entry.work for entry in entries))
    fastest = {
        peer: min(entry.median for entry in entries if entry.peer == peer)
        for peer in {entry.peer for entry in entries}
    }
    peers = sorted(fastest, key=lambda peer: -fastest[peer])
    for entry in entries:
        place = peers.index(entry.peer) + 0.3 * (0.5 * (len(tables) - 1) - tables.index(entry.work))
        _mark(axis, place, entry, filled=entry.work == tables[-1])
    for place, peer in enumerate(peers):
        medians = [significant(entry.median) for entry in entries if entry.peer == peer]
        beside = axis.get_yaxis_transform()
        axis.text(1.01, place, "   ".join(medians), transform=beside, va="center", fontsize=7)
    axis.set_yticks(range(len(peers)), peers)
    axis.set_ylim(-0.7, len(peers) - 0.3)
    axis.set_xscale("log")
    everything = [t for entry in entries for t in entry.nanoseconds]
    axis.set_xlim(min(LEAST, *everything), max(MOST, *everything))
    axis.set_title(_title(name, tables), loc="left", fontsize=9, fontweight="bold")
    axis.grid(axis="both", which="major", linewidth=0.4, color="#d4d4d4")
    axis.set_axisbelow(True)
    axis.spines[["top", "right", "left"]].set_visible(False)
    axis.tick_params(axis="y", length=0)


def _mark(axis: Axes, place: float, entry: Entry, *, filled: bool) -> None:
    colour = LINKWORK if entry.peer.startswith("linkwork") else OTHERS
    least, most = min(entry.nanoseconds), max(entry.nanoseconds)
    complete = entry.verdict is not None and entry.verdict.found == entry.verdict.rows
    axis.plot([least, most], [place, place], color=colour, linewidth=1.0)
    axis.plot(
        [entry.median],
        [place],
        marker="o" if complete else "X",
        markersize=4.5,
        color=colour,
        markerfacecolor=colour if filled else "white",
    )


def _title(name: str, tables: Sequence[str]) -> str:
    parts = [work.partition(", ")[2] for work in tables]
    if len(parts) == 1:
        return f"{name}, {parts[0]}"
    return f"{name}: {', '.join(parts[:-1])} (hollow), {parts[-1]} (filled)"
