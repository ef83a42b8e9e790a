"""Solves random members of all families of precision positions and of six-bars, or checks these.

A member grows from one random linkage by closed paths, until three lead to nothing new; the trace
test then confirms that no solution is missing, and that one less would be noticed.

    scripts/start_linkages [--check] [four-bars | six-bars]
"""

from __future__ import annotations

import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "src"))

import numpy as np

from linkwork.circuits.homotopy.monodromy import (
    Member,
    first_of_each,
    solve_and_confirm,
)
from linkwork.core.foundation.arrays import AnyArray
from linkwork.synthesis.precision.problem import PrecisionProblem
from linkwork.synthesis.precision.solving import (
    SHIPPED,
    SHIPPED_PROBLEMS,
    CompiledTracker,
    NamedFamily,
    as_arrays,
    member_of_arrays,
    stored_member,
)
from linkwork.synthesis.six_bars import SHIPPED as SHIPPED_WATT, WATT

#: The shipped files and their families.
_FILES: dict[str, tuple[Path, tuple[NamedFamily, ...]]] = {
    "four-bars": (SHIPPED, SHIPPED_PROBLEMS),
    "six-bars": (SHIPPED_WATT, (WATT,)),
}
_SEED, _CHECK = 11, 12  # random numbers of the shipped sets, and of others
# of six-bars: of so many paths some pass too near to a degenerate solution on a longer way
_REACH = 1e-3


def solve(problem: NamedFamily, seed: int) -> Member:
    """A solved and confirmed member; ends the script if it cannot be confirmed."""
    begin, grown = time.process_time(), list[int]()
    rng, tracker = np.random.default_rng(seed), CompiledTracker()
    reach = _REACH if problem is WATT else 1.0

    def report(count: int) -> None:
        grown.append(count)
        if sys.stderr.isatty():
            sys.stderr.write(f"\r{_title(problem)}: {count} solutions so far ")

    found = solve_and_confirm(problem, rng, tracker, report, reach=reach)
    if sys.stderr.isatty():
        sys.stderr.write("\r")
    seconds = time.process_time() - begin
    _say(
        f"{_title(problem)}: {len(found.member.x)} solutions ({', '.join(map(str, grown))}); "
        f"trace {found.trace.relative:.0e}, "
        f"one less {found.trace.less:.0e}; {seconds:.1f} s"
    )
    if not found.confirmed:
        raise SystemExit("the trace test did not confirm these solutions")
    return found.member


def build(names: list[str]) -> None:
    """Write shipped files anew."""
    for path, problems in (_FILES[name] for name in names):
        arrays = dict[str, AnyArray]()
        for problem in problems:
            kept = as_arrays(problem, solve(problem, _SEED))
            again = member_of_arrays(problem, kept)  # can it be read again?
            arrays.update(kept)
            if path.exists():
                before = stored_member(problem, path)
                _say(f"  the file had {len(before.x)} solutions{_compared(problem, before, again)}")
        np.savez_compressed(path, **arrays)  # type: ignore[arg-type]
        _say(f"{path.relative_to(ROOT)}: {path.stat().st_size} bytes")


def _compared(problem: NamedFamily, one: Member, other: Member) -> str:
    """How many solutions two members have in common, if their parameters are the same."""
    if not np.array_equal(one.parameters, other.parameters):
        return " of a member with other parameters"
    both = np.concatenate([one.x, other.x])
    same = len(both) - len(first_of_each(problem.fingerprint(both, one.parameters)))
    return f", {same} of them among these"


def check(names: list[str]) -> None:
    """Compare the numbers of solutions with those of other members."""
    checked = wrong = 0
    for path, problems in (_FILES[name] for name in names):
        for problem in problems:
            shipped, other = len(stored_member(problem, path).x), len(solve(problem, _CHECK).x)
            checked += 1
            if shipped != other:
                wrong += 1
                _say(f"{problem.name}: {shipped} shipped, {other} in another member")
    _say(f"{checked} sets, {wrong} differ")
    raise SystemExit(1 if wrong else 0)


def _title(problem: NamedFamily) -> str:
    if isinstance(problem, PrecisionProblem):
        return f"{problem.poses + 1} poses, {problem.points} points, {problem.pivots} pivots given"
    return problem.name


def _say(text: str) -> None:
    sys.stdout.write(text + "\n")
    sys.stdout.flush()


if __name__ == "__main__":
    given = sys.argv[1:]
    chosen = [name for name in given if name != "--check"]
    if not set(chosen) <= set(_FILES):
        raise SystemExit("scripts/start_linkages [--check] [four-bars | six-bars]")
    (check if "--check" in given else build)(chosen or list(_FILES))
