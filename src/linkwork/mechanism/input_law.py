"""Laws of inputs over time: segments one after the other, or one formula of t."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from linkwork.expression.grammar import CONSTANTS, parse
from linkwork.expression.tree import names_in
from linkwork.foundation.errors import ExpressionError
from linkwork.foundation.file_keys import Key, ListOf, Measured, Number as NumberKey, Text
from linkwork.foundation.internal import internal
from linkwork.foundation.units import split_unit
from linkwork.foundation.value_types import check_values, is_listed
from linkwork.mechanism.dimensions import Number, Numbers
from linkwork.mechanism.motion_laws import INPUT_LAWS

__all__ = ["LAW_KEYS", "THROUGH", "LawSegment", "formula_mistake", "law_mistakes", "seconds"]

#: Laws given by points instead of a duration and a displacement.
THROUGH = ("spline", "table")
_SECONDS = {"ms": 1e-3, "s": 1.0, "min": 60.0}

LAW_KEYS = (
    Key("law", Text((*INPUT_LAWS, *THROUGH)), "Motion law of the input", required=True),
    Key("over", Measured("0.5 s"), "Duration; a number is in seconds"),
    Key("by", NumberKey("driven"), "Displacement of the input; a dwell has none"),
    Key("times", ListOf(NumberKey(), "time", 1), "Of a spline or table: seconds since its begin"),
    Key("values", ListOf(NumberKey("driven"), "value", 1), "The displacements at these times"),
)


@internal("through", "duration", "displacement")
@dataclass(frozen=True, kw_only=True)
class LawSegment:
    """A segment of an input's law: the input moves by ``by`` in the time ``over``.

    Parameters
    ----------
    law : str
        ``dwell``; ``constant`` speed; ``ramp``: the speed changes evenly from that at the end of
        the segment before; ``trapezoid``: a third each of the time speeding up, at constant speed
        and slowing down; a motion law of cams: ``3-4-5``, ``cycloidal``, …; ``spline``: cubic,
        from rest to rest; ``table``: straight lines.
    over : number or str, optional
        The duration: ``"0.5 s"``, ``"200 ms"``; a number is in seconds.
    by : number, optional
        The displacement, in file units; only a dwell has none.
    times, values : tuple of number
        Of ``spline`` and ``table``: times [s] and displacements since the segment's beginning.

    Examples
    --------
    >>> import linkwork as lw
    >>> rise = lw.LawSegment(law="3-4-5", over="0.5 s", by=90)
    >>> bar = lw.example("four-bar").changed(inputs=lw.Input(link="crank", law=[rise]))
    >>> len(bar.sweep()), bar.sweep().quantity("rocker.velocity").unit
    (361, 'rad/s')
    """

    law: str
    over: Number | None = None
    by: Number | None = None
    times: tuple[Number, ...] = ()
    values: tuple[Number, ...] = ()

    def __post_init__(self) -> None:
        for name in ("times", "values"):
            if is_listed(getattr(self, name)):
                object.__setattr__(self, name, tuple(getattr(self, name)))
        check_values(self)

    def through(self, numbers: Numbers) -> tuple[tuple[float, float], ...]:
        """The points of a spline or table, from its beginning."""
        pairs = zip(self.times, self.values, strict=True)
        return ((0.0, 0.0), *((numbers(t), numbers(by)) for t, by in pairs))

    def duration(self, numbers: Numbers) -> float:
        """How long it takes [s]."""
        if self.law in THROUGH:
            return self.through(numbers)[-1][0]
        assert self.over is not None
        return seconds(self.over, numbers)

    def displacement(self, numbers: Numbers) -> float:
        """How far the input moves, in file units."""
        return self.through(numbers)[-1][1] if self.law in THROUGH else numbers(self.by or 0)


def seconds(time: Number, numbers: Numbers) -> float:
    """A time with or without its unit [s].

    Raises
    ------
    ExpressionError
        If it cannot be read.
    """
    if isinstance(time, str) and (split := split_unit(time, _SECONDS)) is not None:
        amount, unit = split
        return numbers(amount) * _SECONDS[unit]
    return numbers(time)


def law_mistakes(
    segments: tuple[LawSegment, ...], numbers: Numbers
) -> Iterator[tuple[tuple[str | int, ...], str]]:
    """What is wrong with segments: the key below the law and a message."""
    if not segments:
        yield (), "is empty: write at least one segment"
    for k, segment in enumerate(segments):
        for key, message in _mistakes(segment, numbers):
            yield (k, *key), message


def _mistakes(segment: LawSegment, numbers: Numbers) -> Iterator[tuple[tuple[str | int, ...], str]]:
    known = (*INPUT_LAWS, *THROUGH)
    if segment.law not in known:
        yield ("law",), f"must be one of {', '.join(known)}, got {segment.law}"
        return
    by_points = segment.law in THROUGH
    if by_points and (segment.over is not None or segment.by is not None):
        yield (), f"a {segment.law} has times and values instead of over and by: leave these out"
        return
    if by_points and not (segment.times and len(segment.times) == len(segment.values)):
        counts = f"{len(segment.times)} times and {len(segment.values)} values"
        yield ("times",), f"need as many times as values, at least one; there are {counts}"
        return
    if not by_points and (segment.times or segment.values):
        yield ("times",), "are used with spline and table only"
    if not by_points and segment.over is None:
        yield ("over",), 'is missing: the duration, as in over = "0.5 s"'
        return
    if not by_points and segment.by is None and segment.law != "dwell":
        yield ("by",), "is missing: how far the input moves, as in by = 90"
        return
    own: list[tuple[tuple[str | int, ...], Number | None]]
    own = [(("over",), segment.over), (("by",), segment.by)]
    for name in ("times", "values"):
        own += [((name, k), number) for k, number in enumerate(getattr(segment, name))]
    wrong = False
    for key, number in own:
        try:
            seconds(0 if number is None else number, numbers)
        except ExpressionError as error:
            wrong = True
            yield key, error.message
    if wrong:
        return
    over, by = segment.duration(numbers), segment.displacement(numbers)
    steps = np.diff([t for t, _ in segment.through(numbers)]) if by_points else np.ones(1)
    if min(steps) <= 0.0:
        yield ("times", int(np.flatnonzero(steps <= 0.0)[0])), "must increase from 0"
    elif over <= 0.0:
        yield ("over",), f"must be a positive time, got {over:g}"
    elif segment.law == "dwell" and by:
        yield ("by",), "must be 0: a dwell does not move"


def formula_mistake(formula: str, numbers: Numbers) -> str | None:
    """What is wrong with a formula of t."""
    try:
        tree = parse(formula, comparing=True)
    except ExpressionError as error:
        return str(error)
    for node in names_in(tree):
        if node.name != "t" and node.name not in numbers.known and node.name not in CONSTANTS:
            return (
                f'column {node.column}: "{node.spelling}" is not defined: a law is a formula of t '
                "and of dimensions"
            )
    return None
