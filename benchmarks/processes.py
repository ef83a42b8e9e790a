"""Processor time and memory of this process's descendants, by their kind (Linux)."""

from __future__ import annotations

import os
from collections import Counter
from pathlib import Path

__all__ = ["descendants", "kind_of", "private_memory", "processor_time"]

_TICKS = os.sysconf("SC_CLK_TCK")


def _fields(pid: int) -> list[str]:
    """The fields of a process after its name; none if it has ended."""
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    except OSError:
        return []


def descendants() -> list[int]:
    """All processes that this one has started, directly or not."""
    children: dict[int, list[int]] = {}
    for entry in Path("/proc").glob("[0-9]*"):
        pid = int(entry.name)
        if fields := _fields(pid):
            children.setdefault(int(fields[1]), []).append(pid)
    found = [os.getpid()]
    for pid in found:
        found += children.get(pid, [])
    return found[1:]


def kind_of(pid: int) -> str:
    """Which process of a browser it is: ``renderer``, ``gpu-process``, …; else ``program``."""
    try:
        words = Path(f"/proc/{pid}/cmdline").read_text().replace("\0", " ").split()
    except OSError:
        return "ended"
    if "linkwork" in words:
        return "program"
    kinds = [word.removeprefix("--type=") for word in words if word.startswith("--type=")]
    return kinds[0] if kinds else "browser"


def processor_time() -> Counter[str]:
    """Processor time by kind so far [ms]."""
    found: Counter[str] = Counter()
    for pid in descendants():
        if fields := _fields(pid):
            found[kind_of(pid)] += round(1000 * (int(fields[11]) + int(fields[12])) / _TICKS)
    return found


def private_memory(kind: str) -> float:
    """Memory of the largest process of a kind that it does not share with others [MB]."""
    largest = 0
    for pid in descendants():
        if kind_of(pid) != kind:
            continue
        lines = Path(f"/proc/{pid}/smaps_rollup").read_text().splitlines()
        own = [int(line.split()[1]) for line in lines if line.startswith("Private_")]
        largest = max(largest, sum(own))
    return 1024 * largest / 1e6
