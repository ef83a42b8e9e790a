"""Why Newton-Raphson misses: the four ways of the textbook's sketches, told apart."""

from __future__ import annotations

from enum import Enum

__all__ = ["NewtonTrouble"]


class NewtonTrouble(Enum):
    """What keeps Newton-Raphson from the position that was meant, with a next step."""

    SINGULAR_DERIVATIVE = (
        "the derivative is singular at an iterate, where Newton-Raphson has no next step: "
        "start from a guess beside it"
    )
    INFLECTION = (
        "the equations bend to the other side behind the root (an inflection), so that every "
        "step overshoots further than the one before: start nearer to the root"
    )
    ANOTHER_ROOT = (
        "Newton-Raphson went past the root beside the guess and found another one: "
        "start nearer to the one that is meant"
    )
    LOCAL_EXTREMUM = (
        "the guess lies at a local extremum of the equations, which come no nearer to zero "
        "around it: start from the other side of it"
    )
