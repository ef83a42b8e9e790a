"""Counts what makes the source easy or hard to carry on: scripts/house [-v]

Goals, and what no rule can tell (which classes are parts, which loops step along a path), are in
``house.toml``. Ends with 1 where a firm goal is missed.
"""

from __future__ import annotations

import argparse
import sys
import tomllib
from collections import Counter
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from scripts.house_ideas import (
    arithmetic,
    containers,
    files_of_a_part,
    files_of_a_quantity,
    lists_of_parts,
    loop_counts,
    roundoffs,
    tolerances,
)
from scripts.house_source import (
    Count,
    circles,
    comment_share,
    long_files,
    long_functions,
    read,
)

HERE = Path(__file__).resolve().parent
SOURCE = HERE.parent / "src" / "linkwork"


def measure(package: Path, known: Mapping[str, Any]) -> dict[str, Count]:
    """Every figure by its name."""
    sources = read(package)
    most = known["most"]
    per_module = Counter({str(s.path.parent): 0 for s in sources})
    for source in sources:
        per_module[str(source.path.parent)] += source.code
    where = tuple(f"{folder}: {count}" for folder, count in sorted(per_module.items()))
    rows = known["rows"]
    return {
        "files for a part (median)": files_of_a_part(sources, known["parts"], known["indices"]),
        "lists of kinds of parts": lists_of_parts(sources, known["parts"]),
        "files for a quantity (most)": files_of_a_quantity(sources, known["quantities"]),
        **loop_counts(sources, known["stepping"], known["loops"]),
        "containers of rows": containers(sources, rows["fields"], rows["least"], rows["single"]),
        "classes with arithmetic": arithmetic(sources),
        "roundoffs worked out elsewhere": roundoffs(sources, known["rounding"]),
        "tolerances of one name": tolerances(sources, known["tolerances"]),
        "comments, % of code lines": comment_share(sources),
        "code lines": Count(sum(per_module.values()), where),
        "long files": long_files(sources, most["file"]),
        "long functions": long_functions(sources, most["function"]),
        "import circles": circles(sources, package.name),
    }


def missed(count: Count, goal: Mapping[str, float]) -> bool:
    return not goal.get("least", count.value) <= count.value <= goal.get("most", count.value)


def report(
    counts: Mapping[str, Count],
    goals: Mapping[str, Mapping[str, float]],
    verbose: bool,
    say: Callable[[str], object],
) -> int:
    """Print the table; the exit status."""
    failed = 0
    for name, count in counts.items():
        goal = goals.get(name, {})
        over = count.value > goal.get("ceiling", count.value)
        bound = f"at most {goal['most']}" if "most" in goal else ""
        bound = f"at least {goal['least']}" if "least" in goal else bound
        firm = goal.get("firm") or over
        state = ("MISSED" if firm else "not yet") if missed(count, goal) else ""
        failed += state == "MISSED"
        say(f"{name:32} {count.value:>8}   {bound:14} {state}".rstrip())
        if verbose:
            for entry in count.where:
                say(f"    {entry}")
    return 1 if failed else 0


def main(words: list[str] | None = None) -> int:
    """Count and print."""
    parser = argparse.ArgumentParser(description="Counts what makes the source hard to carry on.")
    parser.add_argument("-v", "--verbose", action="store_true", help="say where")
    parser.add_argument("--package", type=Path, default=SOURCE, help="of another tree")
    parser.add_argument("--known", type=Path, default=HERE / "house.toml", help="goals, loops")
    asked = parser.parse_args(words)
    known = tomllib.loads(asked.known.read_text(encoding="utf-8"))
    counts = measure(asked.package, known)
    return report(counts, known["goals"], asked.verbose, lambda t: sys.stdout.write(t + "\n"))


if __name__ == "__main__":
    sys.exit(main())
