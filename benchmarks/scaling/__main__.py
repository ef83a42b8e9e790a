"""``python -m benchmarks scaling``: how time grows, as ratios in one run."""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path

from benchmarks.machine import machine
from benchmarks.scaling.cold_start import cold_start
from benchmarks.scaling.families import family_sizes, threads
from benchmarks.scaling.loops import chain_of_dyads, coupled
from benchmarks.scaling.part import Part
from benchmarks.scaling.rows import four_bar_rows, jansen_rows

FOLDER = Path(__file__).parents[2] / "docs" / "benchmarks"
PARTS = (
    Part(name="start", measure=cold_start),
    Part(name="rows", measure=four_bar_rows),
    Part(name="jansen", measure=jansen_rows),
    Part(name="dyads", measure=chain_of_dyads),
    Part(name="coupled", measure=coupled),
    Part(name="families", measure=family_sizes),
    Part(name="threads", measure=threads),
)


def main(arguments: Sequence[str]) -> int:
    """Print a table per part; a run of all parts renews the documented figures."""
    names = [part.name for part in PARTS]
    parser = argparse.ArgumentParser(prog="python -m benchmarks scaling", description=__doc__)
    parser.add_argument("part", nargs="*", choices=[[], *names], help="which; all without any")
    parser.add_argument("--repeats", type=int, default=5, help="interleaved repeats")
    parser.add_argument("--to", type=Path, default=None, help="folder for the figures")
    options = parser.parse_args(arguments)
    folder = options.to or (None if options.part else FOLDER)
    print(f"{machine()}; one thread, medians of {options.repeats}")
    grown = {}
    for part in PARTS:
        if not options.part or part.name in options.part:
            grown[part.name] = part.measure(options.repeats)
            print(f"\n{grown[part.name].table()}", flush=True)
    if folder is not None:
        folder.mkdir(parents=True, exist_ok=True)
        data = {"machine": machine(), "parts": {n: asdict(g) for n, g in grown.items()}}
        text = json.dumps(data, indent=1, ensure_ascii=False, allow_nan=False)
        (folder / "scaling.json").write_text(text + "\n", encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
