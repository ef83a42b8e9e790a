"""The four ways in which Newton-Raphson fails to find a root, as textbooks draw them."""

from __future__ import annotations

from enum import Enum

__all__ = ["NewtonTrouble"]


class NewtonTrouble(Enum):
    """The way in which Newton-Raphson missed the intended root; the value is a sentence.

    Examples
    --------
    >>> import linkwork as lw
    >>> lw.NewtonTrouble.ANOTHER_ROOT.value.partition(":")[0]
    'the iteration passed the root nearest to the guess and found another root'
    """

    SINGULAR_DERIVATIVE = (
        "the derivative is singular at an iterate, where Newton-Raphson has no next step: "
        "start from a guess near it"
    )
    INFLECTION = (
        "the equations have an inflection near the root, so that every step overshoots further "
        "than the one before: start nearer to the root"
    )
    ANOTHER_ROOT = (
        "the iteration passed the root nearest to the guess and found another root: "
        "start nearer to the intended root"
    )
    LOCAL_EXTREMUM = (
        "the guess is near a local extremum of the equations, which do not reach zero there: "
        "start from the other side of the extremum"
    )
