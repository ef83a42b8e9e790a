"""Solves random members of all families of precision positions, or checks the shipped ones.

A member grows from one random linkage by closed paths, until three lead to nothing new; the trace
test then confirms that no solution is missing, and that one less would be noticed.
"""

from __future__ import annotations

import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "src"))

import numpy as np  # noqa: E402 - after the path is set

from linkwork.design.precision.path_tracking import CompiledTracker  # noqa: E402
from linkwork.design.precision.problem import PrecisionProblem  # noqa: E402
from linkwork.design.precision.start_sets import (  # noqa: E402
    SHIPPED,
    SHIPPED_PROBLEMS,
    as_arrays,
    member_of_arrays,
    start_member,
)
from linkwork.foundation.arrays import AnyArray  # noqa: E402
from linkwork.numerics.homotopy.monodromy import Member, solve_by_monodromy  # noqa: E402
from linkwork.numerics.homotopy.trace_test import trace_defect  # noqa: E402

_SEED, _CHECK = 11, 12  # random numbers of the shipped sets, and of others
_STRAIGHT = 1e-7  # a trace's distance from a straight line that rounding explains
_TRIES = 5  # random directions of the trace test, until no path is lost


def solve(problem: PrecisionProblem, seed: int) -> Member:
    """A solved and confirmed member; ends the script if it cannot be confirmed."""
    begin, grown = time.process_time(), list[int]()
    rng, tracker = np.random.default_rng(seed), CompiledTracker()
    member = solve_by_monodromy(problem, rng, tracker, grown.append)
    for _ in range(_TRIES):
        whole = trace_defect(problem, member, rng, tracker)
        if not whole.lost:
            break
    less = Member(parameters=member.parameters, x=member.x[1:])
    part = trace_defect(problem, less, rng, tracker)
    seconds = time.process_time() - begin
    _say(
        f"{problem.poses + 1} poses, {problem.points} points, {problem.pivots} pivots given: "
        f"{len(member.x)} solutions ({', '.join(map(str, grown))}); trace {whole.relative:.0e}, "
        f"one less {part.relative:.0e}; {seconds:.1f} s"
    )
    if whole.lost or whole.relative > _STRAIGHT or part.relative < 100.0 * _STRAIGHT:
        raise SystemExit("the trace test did not confirm these solutions")
    return member


def build() -> None:
    """Write the shipped file anew."""
    arrays = dict[str, AnyArray]()
    for problem in SHIPPED_PROBLEMS:
        kept = as_arrays(problem, solve(problem, _SEED))
        member_of_arrays(problem, kept)  # can it be read again?
        arrays.update(kept)
    np.savez_compressed(SHIPPED, **arrays)  # type: ignore[arg-type]
    _say(f"{SHIPPED.relative_to(ROOT)}: {SHIPPED.stat().st_size} bytes")


def check() -> None:
    """Compare the numbers of solutions with those of other members."""
    wrong = 0
    for problem in SHIPPED_PROBLEMS:
        shipped, other = len(start_member(problem).x), len(solve(problem, _CHECK).x)
        if shipped != other:
            wrong += 1
            _say(f"{problem.name}: {shipped} shipped, {other} in another member")
    _say(f"{len(SHIPPED_PROBLEMS)} sets, {wrong} differ")
    raise SystemExit(1 if wrong else 0)


def _say(text: str) -> None:
    sys.stdout.write(text + "\n")
    sys.stdout.flush()


if __name__ == "__main__":
    check() if sys.argv[1:] == ["--check"] else build()
