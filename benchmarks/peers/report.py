"""Reports of a comparison: a table of 80 columns, figures as JSON."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path

from benchmarks.peers.comparison import Entry

__all__ = ["significant", "table", "write_figures"]

#: Rows asked, rows without a position, on another branch, nowhere; and the largest error.
HEADER = (
    f"{'':<22}{'median':>8}{'least … most':>20}"
    f"{'rows':>10}{'none':>5}{'flip':>5}{'off':>4}{'error':>6}"
)


def table(entries: Sequence[Entry]) -> str:
    """One work: time per position, rows found, largest error, rows on another branch."""
    lines = [f"{entries[0].work} [ns per position]", HEADER]
    lines += [_line(entry) for entry in entries]
    return "\n".join(lines)


def _line(entry: Entry) -> str:
    name = f"{entry.peer:<22}"
    verdict = entry.verdict
    if verdict is None:
        return f"{name} {entry.absent}"[:80]
    spread = f"{significant(min(entry.nanoseconds))} … {significant(max(entry.nanoseconds))}"
    error = f"{verdict.error:.0e}" if verdict.found else "-"
    return (
        f"{name}{significant(entry.median):>8}{spread:>20}{verdict.rows:>10,}"
        f"{verdict.missing:>5}{verdict.other_branch:>5}{verdict.wrong:>4}{error:>6}"
    )


def significant(value: float) -> str:
    """Three significant digits, thousands apart: ``9.31``, ``152``, ``24,500``."""
    rounded = float(f"{value:.3g}")
    return f"{rounded:,.0f}" if rounded >= 100.0 else f"{rounded:.3g}"


def write_figures(path: Path, machine: str, repeats: int, entries: Sequence[Entry]) -> None:
    """All figures as JSON, NaN as null."""
    figures = []
    for entry in entries:
        figure = asdict(entry)
        figure["nanoseconds"] = [float(f"{t:.4g}") for t in entry.nanoseconds]
        if entry.verdict is not None and not entry.verdict.found:
            figure["verdict"]["error"] = None
        figures.append(figure)
    data = {
        "unit": "ns per position",
        "machine": machine,
        "repeats": repeats,
        "entries": figures,
    }
    text = json.dumps(data, indent=1, ensure_ascii=False, allow_nan=False)
    path.write_text(text + "\n", encoding="utf-8")
