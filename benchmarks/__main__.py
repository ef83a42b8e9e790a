"""Run the benchmarks: ``python -m benchmarks [name …]``; all figures are ratios within one run.

``python -m benchmarks peers`` and ``python -m benchmarks scaling`` are separate programs with
options (``--help``) and without limits.
"""

from __future__ import annotations

import sys

from benchmarks import (
    chain_growth,
    configuration_time,
    cycle_time,
    design_time,
    family_time,
    force_time,
    gradient_time,
    improve_time,
    live_time,
    page_time,
    precision_time,
    process_start,
    small_calls,
    verdict_time,
    web_time,
)
from benchmarks.single_thread import run_alone

MEASUREMENTS = {
    "start": process_start.measure,
    "cycle": cycle_time.measure,
    "configurations": configuration_time.measure,
    "chain": chain_growth.measure,
    "designs": design_time.measure,
    "families": family_time.measure,
    "forces": force_time.measure,
    "gradients": gradient_time.measure,
    "improve": improve_time.measure,
    "page": page_time.measure,
    "points": precision_time.measure,
    "live": live_time.measure,
    "small": small_calls.measure,
    "verdicts": verdict_time.measure,
    "web": web_time.measure,
}
PROGRAMS = {
    "peers": "benchmarks.peers",
    "scaling": "benchmarks.scaling",
    "before-after": "benchmarks.before_after",
}


def main(names: list[str]) -> int:
    """Print one table per benchmark; exit 1 if a limit is exceeded."""
    if names and names[0] in PROGRAMS:
        return run_alone(PROGRAMS[names[0]], names[1:])
    unknown = [name for name in names if name not in MEASUREMENTS]
    if unknown:
        known = ", ".join([*MEASUREMENTS, *PROGRAMS])
        print(f"unknown: {', '.join(unknown)} (there are: {known})")
        return 2
    passed = [MEASUREMENTS[name]() for name in names or MEASUREMENTS]
    return 0 if all(passed) else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
