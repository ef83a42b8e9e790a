"""Limits of a branch, and extremes of a quantity."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from enum import Enum
from typing import Any

from linkwork.core.foundation.containers import FrozenDict
from linkwork.core.foundation.names import short_number
from linkwork.core.foundation.statuses import Status
from linkwork.core.results.tables import plain_fields


class LimitKind(Enum):
    """The kind of a limit of a branch; the value is a sentence.

    Examples
    --------
    >>> import linkwork as lw
    >>> lw.core.results.LimitKind.DEAD_POINT.word
    'dead point'
    """

    DEAD_POINT = "dead point: the input cannot move further"
    CHANGE_POINT = "change point: another branch crosses here"
    UNKNOWN = "the branch could not be followed further"

    @property
    def word(self) -> str:
        """``dead point``, ``change point`` or ``limit``."""
        return "limit" if self is LimitKind.UNKNOWN else self.value.partition(":")[0]


@dataclass(frozen=True, kw_only=True)
class Limit:
    """A limit of a branch: a dead point, a change point, or an end of unknown kind.

    Parameters
    ----------
    kind : LimitKind
        Dead point, change point or unknown.
    input : float
        Value of the leading input, in file units.
    bracket : (float, float)
        Contains the dead point if it is located; otherwise the last value reached and the first
        value that failed, in file units.
    located : bool
        For a dead point, whether it is proved that the input reverses within the bracket and that
        the branch leads there; for a change point, whether it was found to rounding.
    status : Status
        The status of the rows beyond it.
    loops : tuple of str
        The loops that lock.
    in_line : tuple of str
        Links of those loops that are in line there.
    onward, other : Mapping[str, float]
        At a change point, derivatives of the locked loops' unknowns with respect to the input, on
        the branch that was followed and on the branch that crosses it.
    passed : str
        How the motion passed a change point: ``straight`` or ``turn``; "" if it stopped.

    Examples
    --------
    >>> import linkwork as lw
    >>> lengths = {"O2 A": 80, "A B": 120, "O4 B": 80, "O2 O4": 100}
    >>> limit = lw.example("four-bar").changed(lengths=lengths).sweep().limits[0]
    >>> limit.kind.word, round(limit.input, 6), limit.in_line
    ('dead point', 22.331645, ('coupler', 'rocker'))
    """

    kind: LimitKind
    input: float
    bracket: tuple[float, float]
    located: bool
    status: Status
    loops: tuple[str, ...] = ()
    in_line: tuple[str, ...] = ()
    onward: Mapping[str, float] = FrozenDict()
    other: Mapping[str, float] = FrozenDict()
    passed: str = ""

    def to_dict(self) -> dict[str, Any]:
        """Plain data, as in the command line's JSON."""
        names = (
            "kind", "input", "bracket", "located", "status", "loops", "in_line", "onward", "other",
            "passed",
        )  # fmt: skip
        return plain_fields(self, *names)

    def told(self, name: str, unit: str) -> str:
        """The limit as text: its place, the loops that lock, the links in line, the way past it.

        ``name`` and ``unit`` are the leading input's.
        """
        text = f"{name} = {short_number(self.input):.12g} {unit}".rstrip()
        if self.loops:
            quoted = ", ".join(f'"{loop}"' for loop in self.loops)
            one = len(self.loops) == 1
            does = "can close in two ways" if self.kind is LimitKind.CHANGE_POINT else "lock"
            text += f", where {'loop' if one else 'loops'} {quoted} {does}"
            text += "s" if one and does == "lock" else ""
        if self.in_line:
            text += f" ({' and '.join(self.in_line)} in line)"
        if self.passed:
            text += (
                "; went straight on"
                if self.passed == "straight"
                else "; turned onto the other branch"
            )
        return text


@dataclass(frozen=True, kw_only=True)
class OutputLimit:
    """A maximum or minimum of a quantity along the motion.

    Parameters
    ----------
    name : str
        The quantity.
    kind : str
        ``maximum`` or ``minimum``.
    input : float
        Value of the leading input, in file units.
    value : float
        Value of the quantity, in file units.
    bracket : (float, float)
        Interval around ``input``, in file units.
    located : bool
        Whether the extreme was found to rounding.

    Examples
    --------
    >>> import linkwork as lw
    >>> low, high = lw.example("four-bar").sweep(limits_of="rocker").output_limits
    >>> high.kind, round(high.input, 6), round(high.value, 6)
    ('maximum', 231.317813, 128.682187)
    """

    name: str
    kind: str
    input: float
    value: float
    bracket: tuple[float, float]
    located: bool

    def named(self, value: float) -> OutputLimit:
        """The same limit, with its input value changed by whole turns."""
        low, high = self.bracket
        shift = value - self.input
        return replace(self, input=value, bracket=(low + shift, high + shift))
