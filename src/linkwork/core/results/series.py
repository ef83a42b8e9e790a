"""One quantity over the rows of a motion."""

from __future__ import annotations

from dataclasses import dataclass

from linkwork.core.foundation.arrays import Array
from linkwork.core.foundation.containers import read_only
from linkwork.core.foundation.errors import internal
from linkwork.core.results.quantity import Quantity


@internal("quantity")
@dataclass(frozen=True, kw_only=True, eq=False)
class Series:
    """One quantity over the N rows of a motion.

    Parameters
    ----------
    quantity : Quantity
        Its name and kind.
    value : array (N,)
        Values in file units.
    first, second : array (N,)
        Derivatives with respect to the leading input; angles in radians.

    Examples
    --------
    >>> import linkwork as lw
    >>> motion = lw.example("four-bar").sweep(from_=0, to=90, step=30)
    >>> series = motion.unknowns["rocker"]
    >>> series.quantity.name, series.first.round(3)
    ('rocker', array([-0.667,  0.122,  0.457,  0.539]))
    """

    quantity: Quantity
    value: Array
    first: Array
    second: Array

    def __post_init__(self) -> None:
        for field in ("value", "first", "second"):
            object.__setattr__(self, field, read_only(getattr(self, field)))
