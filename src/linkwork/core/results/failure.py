"""Why a position does not exist or differs from the intended one, as numbers and sentences."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from linkwork.core.foundation.containers import FrozenDict
from linkwork.core.foundation.errors import internal
from linkwork.core.foundation.statuses import NewtonTrouble
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
