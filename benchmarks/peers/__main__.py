"""``python -m benchmarks peers``: compare Linkwork with other software on the same tasks."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from benchmarks.machine import machine
from benchmarks.peers.comparison import Entry, compare
from benchmarks.peers.plot import draw
from benchmarks.peers.registry import chosen
from benchmarks.peers.report import table, write_figures
from benchmarks.peers.work import works

FOLDER = Path(__file__).parents[2] / "docs" / "benchmarks"


def main(arguments: Sequence[str]) -> int:
    """Print a table per task; write the figures and a picture."""
    options = _options(arguments)
    peers = chosen(options.peer)
    asked = [work for work in works() if options.work in work.name]
    if not asked:
        print(f'no work is called "{options.work}" (there are: {_names()})')
        return 2
    described = machine()
    print(f"{described}; one thread, warm, {options.repeats} repeats in turn")
    for peer in peers:
        print(f"  {peer.name:<22} {peer.missing() or f'{peer.distribution} {peer.version()}'}")
    entries: list[Entry] = []
    for work in asked:
        entries += compare(work, peers, options.repeats, _tell)
        _tell("")
        print(f"\n{table(entries[-len(peers) :])}", flush=True)
    if options.to is not None:
        options.to.mkdir(parents=True, exist_ok=True)
        write_figures(options.to / "peers.json", described, options.repeats, entries)
        draw(options.to / "peers.png", described, entries)
        print(f"\nwritten: {options.to / 'peers.json'}, {options.to / 'peers.png'}")
    return 0


def _options(arguments: Sequence[str]) -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m benchmarks peers", description=__doc__)
    parser.add_argument("--repeats", type=int, default=7, help="interleaved repeats, at least 5")
    parser.add_argument("--peer", action="append", default=[], help="part of a name; repeatable")
    parser.add_argument("--work", default="", help="part of the name of a work")
    parser.add_argument("--to", type=Path, default=None, help="folder for figures and picture")
    options = parser.parse_args(arguments)
    if options.repeats < 5:
        parser.error("a median needs at least 5 repeats")
    if options.to is None and not options.peer and not options.work:
        options.to = FOLDER  # a complete run updates the documented figures
    return options


def _names() -> str:
    return ", ".join(f'"{work.name}"' for work in works())


def _tell(name: str) -> None:
    """Show the current preparation on a terminal."""
    if sys.stderr.isatty():
        print(f"\r{name:<40}\r", end="", file=sys.stderr, flush=True)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
