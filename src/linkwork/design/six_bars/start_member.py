"""A solved random member of the Watt-II six-bars, shipped with the package.

``scripts/start_linkages`` computes it by monodromy and confirms it by the trace test.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path

from linkwork.design.precision.start_sets import stored_member
from linkwork.design.six_bars.watt_problem import WATT
from linkwork.numerics.homotopy.monodromy import Member

__all__ = ["SHIPPED", "watt_member"]

SHIPPED = Path(__file__).with_name("start_six_bars.npz")


@cache
def watt_member() -> Member:
    """The shipped solved member.

    Raises
    ------
    InputError
        If the installation is damaged.
    """
    return stored_member(WATT, SHIPPED)
