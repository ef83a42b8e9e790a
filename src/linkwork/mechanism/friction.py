"""Friction of joints: coefficients, and the sizes on which moments of friction depend."""

from __future__ import annotations

from dataclasses import dataclass

from linkwork.foundation.file_keys import Key, Number as NumberKey
from linkwork.foundation.value_types import check_values
from linkwork.mechanism.dimensions import Number

__all__ = ["FRICTION_KEYS", "Friction"]

FRICTION_KEYS = (
    Key("mu", NumberKey(), "Coefficient of friction", required=True),
    Key(
        "radius",
        NumberKey("length"),
        "Of a pin its radius; of teeth the mean distance of their contact from the pitch point",
    ),
    Key(
        "length",
        NumberKey("length"),
        "Guided length of a slider, whose moment presses its two ends; by default it has no effect",
    ),
)


@dataclass(frozen=True, kw_only=True)
class Friction:
    """Friction in a pin or a part.

    Parameters
    ----------
    mu : number
        The coefficient of friction; of a rolling wheel that of adhesion, beyond which it slips.
    radius : number, optional
        The radius of a pin, or for teeth the mean distance of their contact from the pitch point
        [length].
    length : number, optional
        The guided length of a slider [length].

    Examples
    --------
    >>> import linkwork as lw
    >>> lw.Friction(mu=0.1, radius=5).radius
    5
    """

    mu: Number
    radius: Number | None = None
    length: Number | None = None

    def __post_init__(self) -> None:
        check_values(self)
