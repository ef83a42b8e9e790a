"""Where a branch ends, and where a quantity is largest or smallest."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from enum import Enum
from typing import Any

from linkwork.foundation.frozen import FrozenDict
from linkwork.foundation.short_number import short_number
from linkwork.foundation.status import Status

__all__ = ["Limit", "LimitKind", "OutputLimit"]


class LimitKind(Enum):
    """What ends a branch."""

    DEAD_POINT = "dead point: the input can move no further"
    CHANGE_POINT = "change point: another branch crosses here"
    UNKNOWN = "the branch could not be followed further"

    @property
    def word(self) -> str:
        """``dead point``, ``change point`` or ``limit``."""
        return "limit" if self is LimitKind.UNKNOWN else self.value.partition(":")[0]


@dataclass(frozen=True, kw_only=True)
class Limit:
    """Where a branch ends.

    Parameters
    ----------
    kind : LimitKind
    input : float
        Of the leading input, in file units.
    bracket : (float, float)
        The dead point lies in it if it is located. Otherwise the last value reached and the first
        that failed.
    located : bool
        Whether the input is proved to turn back within the bracket, and the branch to lead there;
        of a change point, whether it was found to rounding.
    status : Status
        What rows beyond it say.
    loops : tuple of str
        The loops that lock.
    in_line : tuple of str
        Links of those loops that are in line there.
    onward, other : Mapping[str, float]
        At a change point, the derivatives by the input of the locked loops' unknowns on the
        branch that was followed and on the one that crosses it.
    passed : str
        How the motion went on at a change point: ``straight`` or ``turn``; "" if it stopped.
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
        return {
            "kind": self.kind.name,
            "input": self.input,
            "bracket": list(self.bracket),
            "located": self.located,
            "status": self.status.name,
            "loops": list(self.loops),
            "in_line": list(self.in_line),
            "onward": dict(self.onward),
            "other": dict(self.other),
            "passed": self.passed,
        }

    def told(self, name: str, unit: str) -> str:
        """Where it lies, which loops lock there with which links in line, how the motion went on.

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
            text += "; went straight on" if self.passed == "straight" else "; turned off"
        return text


@dataclass(frozen=True, kw_only=True)
class OutputLimit:
    """Where a quantity is largest or smallest on the way, dead points of the input among it.

    Parameters
    ----------
    name : str
    kind : str
        ``maximum`` or ``minimum``.
    input : float
        Of the leading input, in file units, with ``bracket`` around it.
    value : float
        Of the quantity, in file units.
    located : bool
        Whether it was found to rounding.
    """

    name: str
    kind: str
    input: float
    value: float
    bracket: tuple[float, float]
    located: bool

    def named(self, value: float) -> OutputLimit:
        """The same at another name of its input value, whole turns away."""
        low, high = self.bracket
        shift = value - self.input
        return replace(self, input=value, bracket=(low + shift, high + shift))
