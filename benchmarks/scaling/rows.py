"""Time per row of one mechanism, from a hundred to a hundred thousand rows."""

from __future__ import annotations

from benchmarks.peers.registry import chosen
from benchmarks.peers.work import Work, four_bar, jansen_leg
from benchmarks.scaling.part import Growth, grown

__all__ = ["four_bar_rows", "jansen_rows"]

SOLVERS = ["linkwork", "pylinkage step_fast", "NumPy", "casadi fast_newton, C", "scipy"]
SIZES = (100, 1_000, 10_000, 100_000)


def four_bar_rows(repeats: int) -> Growth:
    """A four-bar."""
    return _measured("four-bar", [(rows, four_bar(rows + 1)) for rows in SIZES], repeats)


def jansen_rows(repeats: int) -> Growth:
    """Jansen's leg: three blocks of two equations."""
    return _measured("Jansen leg", [(rows, jansen_leg(rows + 1)) for rows in SIZES], repeats)


def _measured(what: str, works: list[tuple[int, Work]], repeats: int) -> Growth:
    return grown(
        title=f"{what}, one turn in more and more rows",
        unit="ns per row",
        size="rows",
        works=works,
        peers=chosen(SOLVERS),
        repeats=repeats,
        most={"scipy fsolve": 10_000, "casadi fast_newton, C": 10_000},
    )
