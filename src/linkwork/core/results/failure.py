"""Why a position does not exist or differs from the intended one, as numbers and sentences."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from enum import Enum
from typing import Any

from linkwork.core.foundation.arrays import FrozenDict
from linkwork.core.foundation.errors import internal
from linkwork.core.foundation.names import short_number
from linkwork.core.foundation.statuses import NewtonTrouble, Status
from linkwork.core.results.quantity import Kind, Units
from linkwork.core.results.tables import plain_fields

_MOST_REMEDIES = 3
_MOST_CONFIGURATIONS = 4
_MOST_VALUES = 4
_NOTHING = 1e-12  # rounding, shown as 0


@dataclass(frozen=True, kw_only=True)
class Remedy:
    """One length whose change alone closes the loops.

    Parameters
    ----------
    length : str
        The name of the length in the file.
    now, needed : float
        Its value, and the value at which the loops just close [length].
    exact : bool
        Whether ``needed`` follows from a closed form (dyads) and does not depend on the guess.
        Otherwise it was found by linearisation, corrected until the loops just close, and checked
        by a position a little further.

    Examples
    --------
    >>> import linkwork as lw
    >>> short = {"O2 A": 40, "A B": 30, "O4 B": 20, "O2 O4": 100}
    >>> remedies = lw.example("four-bar").changed(lengths=short).solve().failure.remedies
    >>> [(remedy.length, round(remedy.change, 3)) for remedy in remedies]
    [('A B', 18.366), ('O4 B', 18.366), ('O2 O4', -19.551)]
    """

    length: str
    now: float
    needed: float
    exact: bool

    @property
    def change(self) -> float:
        """The change that the length needs; negative if it has to be shorter."""
        return self.needed - self.now

    def to_dict(self) -> dict[str, Any]:
        """The numbers as JSON-ready data."""
        return plain_fields(self, "length", "now", "needed", "change", "exact")


@internal("units", "kinds")
@dataclass(frozen=True, kw_only=True)
class Failure:
    """Why a position does not exist, or differs from the intended one.

    Parameters
    ----------
    what : str
        What happened, as a sentence.
    asked : Mapping[str, float]
        The requested input values, in file units.
    loops : tuple of str
        The loops that do not close or that lock.
    gap : float, optional
        The closure error that remains near the guess [length]; for coupled loops the root of the
        sum of squares.
    remedies : tuple of Remedy
        Lengths whose change alone closes the loops.
    nearest_input : Mapping[str, float]
        The reachable input values nearest to the requested ones, in file units, on the circuit
        through the start, or, without a start, on the circuit found nearest to the guess; empty if
        unknown.
    nearest_kind : str
        What limits the circuit there: ``dead point``, ``end of what was followed``; "" if the
        circuit reaches the requested values.
    nearest_proved : bool
        Whether the circuit was followed with proof.
    through : Mapping[str, float]
        The dead point beyond which the circuit reaches the requested values.
    unreachable : bool
        Whether no input value was found at which the mechanism can be assembled.
    trouble : NewtonTrouble, optional
        The way in which Newton-Raphson missed the root.
    configurations : tuple of Mapping[str, float]
        The positions that exist at the requested values: unknowns by name.
    configuration_names : tuple of str
        Their names, where configurations can be listed.
    complete : bool, optional
        Whether these are all configurations; ``None`` if they were not searched.
    complete_likely : bool
        Whether that holds with probability one only.
    meant : Mapping[str, float]
        The root nearest to the guess, if Newton-Raphson missed it.
    units : Units
        Units of the numbers.
    kinds : Mapping[str, Kind]
        The kind (angle, length, number) of every name.

    Examples
    --------
    >>> import linkwork as lw
    >>> short = {"O2 A": 40, "A B": 30, "O4 B": 20, "O2 O4": 100}
    >>> failure = lw.example("four-bar").changed(lengths=short).solve().failure
    >>> round(failure.gap, 3), failure.remedies[0].length
    (18.366, 'A B')
    """

    what: str
    asked: Mapping[str, float] = FrozenDict()
    loops: tuple[str, ...] = ()
    gap: float | None = None
    remedies: tuple[Remedy, ...] = ()
    nearest_input: Mapping[str, float] = FrozenDict()
    nearest_kind: str = ""
    nearest_proved: bool = False  # noqa: V107
    through: Mapping[str, float] = FrozenDict()
    unreachable: bool = False
    trouble: NewtonTrouble | None = None
    configurations: tuple[Mapping[str, float], ...] = ()
    configuration_names: tuple[str, ...] = ()
    complete: bool | None = None
    complete_likely: bool = False
    meant: Mapping[str, float] = FrozenDict()
    units: Units
    kinds: Mapping[str, Kind] = FrozenDict()

    @property
    def message(self) -> str:
        """All sentences as one text."""
        return "; ".join(text for _, text in self.sentences())

    def sentences(self) -> Iterator[tuple[str, str]]:
        """The sentences, each with a word for its subject."""
        yield "why", self.what
        if self.meant:
            another = self.trouble is NewtonTrouble.ANOTHER_ROOT
            which = "the root nearest to the guess is" if another else "a damped iteration finds"
            yield "root", f"{which} {self._values(self.meant, _MOST_VALUES)}"
        if self.remedies:
            yield "remedy", self._remedy_text()
        if self.nearest_input:
            yield "nearest", self._nearest_text()
        elif self.unreachable:
            yield "nearest", "no input value was found at which the mechanism can be assembled"
        if self.complete is not None:
            yield "elsewhere", self._configurations_text()

    def _remedy_text(self) -> str:
        unit = self.units.length
        texts = []
        for remedy in self.remedies[:_MOST_REMEDIES]:
            way = "longer" if remedy.change > 0 else "shorter"
            if remedy.now <= 0.0 or remedy.needed <= 0.0:  # an offset
                way = "more" if remedy.change > 0 else "less"
            name = f'"{remedy.length}"' if " " in remedy.length else remedy.length
            change = f"{abs(remedy.change):.6g} {way}"
            texts.append(f"{name} = {remedy.needed:.6g} {unit} ({change})")
        where = "" if all(remedy.exact for remedy in self.remedies) else " near the guess"
        return f"the loops just close{where} with {' or '.join(texts)}"

    def _nearest_text(self) -> str:
        where = self._values(self.nearest_input)
        if self.through:
            passed = self._values(self.through)
            return f"the circuit reaches this input through the dead point at {passed}"
        if not self.nearest_kind:
            return "the circuit nearest to the guess reaches this input"
        return f"nearest reachable input: {where} ({self.nearest_kind})"

    def _configurations_text(self) -> str:
        if not self.configurations:
            if self.complete:
                sure = " (with probability one)" if self.complete_likely else ""
                return f"no configuration exists there{sure}"
            return "other guesses also lead to no position there"
        shown = [self._values(c, _MOST_VALUES) for c in self.configurations[:_MOST_CONFIGURATIONS]]
        names = self.configuration_names
        if names:
            shown = [f"{n} ({text})" for n, text in zip(names, shown, strict=False)]
        more = len(self.configurations) - len(shown)
        texts = " or ".join(shown) + (f" or {more} more" if more else "")
        count = len(self.configurations)
        plain = all(kind is Kind.NUMBER for kind in self.kinds.values())
        noun = ("root" if plain else "configuration") + ("" if count == 1 else "s")
        noun += " exists" if count == 1 else " exist"
        return f"{count} {noun} there{'' if self.complete else ' (perhaps not all)'}: {texts}"

    def _values(self, values: Mapping[str, float], most: int = 99) -> str:
        texts = []
        for name, value in list(values.items())[:most]:
            kind = self.kinds.get(name, Kind.NUMBER)
            unit = self.units.angle.sign if kind is Kind.ANGLE else ""
            unit = f" {self.units.length}" if kind is Kind.LENGTH else unit
            short = 0.0 if abs(value) < _NOTHING else value
            texts.append(f"{name} = {short:.10g}{unit}")
        return ", ".join(texts) + (", …" if len(values) > most else "")

    def to_dict(self) -> dict[str, Any]:
        """The numbers as JSON-ready data."""
        names = (
            "what", "loops", "gap", "remedies", "nearest_input", "nearest_kind", "nearest_proved",
            "through", "trouble", "configurations", "configuration_names",
        )  # fmt: skip
        return plain_fields(self, *names) | {
            "configurations_complete": self.complete,
            "configurations_complete_with_probability_one": self.complete_likely,
        }


# ----------------------------------------------------------------------
# Limits of a branch, and extremes of a quantity.


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
