"""Stops: bounds of a quantity at which a simulated motion bounces or rests."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from linkwork.foundation.errors import ExpressionError
from linkwork.foundation.file_keys import Key, Number as NumberKey, Text
from linkwork.foundation.internal import internal
from linkwork.foundation.value_types import check_values
from linkwork.mechanism.dimensions import Number, Numbers

__all__ = ["STOP_KEYS", "Stop"]

STOP_KEYS = (
    Key("of", Text(), "The quantity that is bounded: a link, a slider, B.x", required=True),
    Key("from", NumberKey("named"), "Its least value", field="start"),
    Key("to", NumberKey("named"), "Its greatest value", field="stop"),
    Key("restitution", NumberKey(), "Speed after a shock over that before; default 0"),
)


@internal("keys", "mistakes")
@dataclass(frozen=True, kw_only=True)
class Stop:
    """Stops that keep a quantity within bounds, in simulations.

    Parameters
    ----------
    of : str
        The quantity: a link, a slider, ``B.x``.
    start, stop : number, optional
        Its bounds in file units (``from``, ``to`` in a file).
    restitution : number
        The speed after a shock over that before, from 0 to 1.

    Examples
    --------
    >>> import linkwork as lw
    >>> lw.Stop(of="rocker", stop=130, restitution=0.3).of
    'rocker'
    """

    of: str
    start: Number | None = None
    stop: Number | None = None
    restitution: Number = 0

    def __post_init__(self) -> None:
        check_values(self)

    @property
    def keys(self) -> tuple[Key, ...]:
        """Its keys in a file."""
        return STOP_KEYS

    def mistakes(self, numbers: Numbers) -> Iterator[tuple[str, str]]:
        """Keys with what is wrong."""
        if self.start is None and self.stop is None:
            yield "from", "is missing: a stop needs from, to, or both"
            return
        amounts = {}
        for key, number in (("from", self.start), ("to", self.stop)):
            if number is not None:
                try:
                    amounts[key] = numbers(number)
                except ExpressionError as error:
                    yield key, error.message
        if len(amounts) == 2 and amounts["from"] >= amounts["to"]:
            yield "to", f"must be greater than from, got {amounts['from']:g} and {amounts['to']:g}"
        try:
            if not 0.0 <= numbers(self.restitution) <= 1.0:
                yield "restitution", f"must be from 0 to 1, got {numbers(self.restitution):g}"
        except ExpressionError as error:
            yield "restitution", error.message
