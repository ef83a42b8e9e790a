"""Results of forces."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import islice

import numpy as np

from linkwork.core.drawing.annotations import Force
from linkwork.core.foundation.arrays import AnyArray, Array, BoolArray, FrozenDict, read_only
from linkwork.core.foundation.errors import UnknownNameError, internal
from linkwork.core.foundation.names import find_spelling
from linkwork.core.foundation.statuses import CodedEnum
from linkwork.core.results.position import Position
from linkwork.core.results.quantities.registry import nearest
from linkwork.core.results.quantity import Kind
from linkwork.core.results.tables import Summary, Table

# ----------------------------------------------------------------------
# Forces at points, for drawings.


# ----------------------------------------------------------------------
# Positions at which a mechanism can rest under its loads.


@dataclass(frozen=True, kw_only=True)
class Equilibrium:
    """An equilibrium of a mechanism.

    Parameters
    ----------
    input : float
        The value of the first input, in file units.
    values : Mapping[str, float]
        All variables by name, in file units.
    stable : bool
        Whether a small displacement leads back.
    frequency : float
        The natural frequency of small oscillations about a stable one [Hz]; of an unstable one
        the rate 1/s at which a displacement grows, divided by 2π, negative. With several inputs
        the least of ``frequencies``.
    frequencies : tuple of float
        Those of all its modes, rising; one for each input.
    indifferent : str
        ``near`` where the loads balance at neighbouring positions too, ``everywhere`` where they
        balance at all positions, else empty.

    Examples
    --------
    >>> import linkwork as lw
    >>> pendulum = lw.linkage(
    ...     length="m", points={"O": (0, 0), "A": (1, 0)},
    ...     links={"ground": ["O"], "bar": ["O", "A"]},
    ...     inputs=lw.Input(link="bar"), masses={"bar": lw.Mass(mass=1, center=(1, 0))},
    ...     gravity=lw.Gravity(),
    ... )
    >>> [(round(each.input), each.stable) for each in lw.forces.equilibria(pendulum)]
    [(-90, True), (90, False)]
    """

    input: float
    values: Mapping[str, float]
    stable: bool
    frequency: float
    frequencies: tuple[float, ...]
    indifferent: str = ""


# ----------------------------------------------------------------------
# Reactions of joints and efforts of inputs, of one position or of a motion.


class ForceStatus(CodedEnum):
    """How the computation of forces ended in a row; the value is a sentence with a next step.

    Examples
    --------
    >>> import linkwork as lw
    >>> lw.example("crank-press").forces(at=60).status.name
    'FOUND'
    """

    FOUND = "all forces found"
    UNDETERMINED = (
        "a self-stress of redundant links loads some joints, whose forces depend on tolerances: "
        "they are not given; release a link to determine them"
    )
    SELF_LOCKING = (
        "friction locks the mechanism: no effort of the input moves it this way; reduce friction, "
        "or drive another link"
    )
    NO_RATES = (
        "at a dead point or change point the input has no finite effort: ask for another input "
        "value"
    )
    NO_POSITION = "there is no position: see its own status"
    NO_LOAD = "a load has no finite value there: change its formula"
    HELD = (
        "friction holds the mechanism at rest: it takes any value up to its limit, and forces are "
        "not determined"
    )
    STOPPED = (
        "a stop on a quantity of several bodies pushes, or friction holds the mechanism against a "
        "stop: forces are not determined; bound a link, a slider or a coordinate, without friction"
    )


@internal("kinds")
@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Reactions:
    """Forces and moments of a mechanism, at one position or in the N rows of a motion.

    ``reactions["A.force.x"]`` is a quantity in the units of the file, a number or (N,), NaN where
    it is not determined.

    Parameters
    ----------
    mechanism : str
        The name of the mechanism.
    inputs : Mapping[str, array]
        The values of the inputs in file units.
    values : Mapping[str, array]
        All quantities by name.
    kinds : Mapping[str, Kind]
    units, about : Mapping[str, str]
        Unit and meaning of every quantity.
    statuses : tuple of ForceStatus
        One for each row.
    undetermined, lifted, slipping : Mapping[str, array of bool]
        Where a self-stress changes a quantity; where a joint that can only push would have to pull;
        where a rolling wheel would need more adhesion.
    undefined : Mapping[str, array of bool]
        Where formulas of loads have no finite value, by the place of the load.
    at_switches : Mapping[str, array]
        Inputs and quantities of a table just before and just behind every switch of a load.
    proved : array of bool
        Whether it is proved that friction leaves an equilibrium, or where ``SELF_LOCKING``, none.

    Examples
    --------
    >>> import linkwork as lw
    >>> reactions = lw.example("crank-press").forces(at=60)
    >>> reactions.units["crank.effort"]
    'N·mm'
    >>> reactions["disagreement"] < 1e-12
    True
    """

    mechanism: str
    inputs: Mapping[str, Array]
    input_units: Mapping[str, str]
    values: Mapping[str, Array]
    kinds: Mapping[str, Kind]
    units: Mapping[str, str]
    about: Mapping[str, str]
    statuses: tuple[ForceStatus, ...]
    undetermined: Mapping[str, BoolArray]
    lifted: Mapping[str, BoolArray]
    slipping: Mapping[str, BoolArray]
    undefined: Mapping[str, BoolArray]
    proved: BoolArray
    at_switches: Mapping[str, Array] = FrozenDict()

    def __post_init__(self) -> None:
        for name in ("inputs", "values", "undetermined", "lifted", "slipping", "undefined"):
            table = {key: read_only(array) for key, array in getattr(self, name).items()}
            object.__setattr__(self, name, FrozenDict(table))
        object.__setattr__(self, "proved", read_only(self.proved))

    def __len__(self) -> int:
        return len(self.statuses)

    def __getitem__(self, name: str) -> Array | float:
        """A quantity by name: a number at one position, else (N,).

        Raises
        ------
        UnknownNameError
            Lists the nearest names.
        """
        own = find_spelling(name, self.values)
        if own not in self.values:
            raise UnknownNameError(f'there is no "{name}" {nearest(name, self.values)}')
        value = self.values[own]
        return float(value) if value.ndim == 0 else value

    @property
    def status(self) -> ForceStatus:
        """That of the only row, or the first one that is not ``FOUND``."""
        wrong = [status for status in self.statuses if status is not ForceStatus.FOUND]
        return wrong[0] if wrong else ForceStatus.FOUND

    @property
    def efforts(self) -> tuple[str, ...]:
        """The names of the inputs' efforts."""
        return tuple(name for name in self.values if name.endswith(".effort"))

    @property
    def arrows(self) -> tuple[Force, ...]:
        """Forces of pins and loads at one position, for drawings."""
        found = []
        for name in self.values:
            stem, _, axis = name.rpartition(".")
            if axis != "x" or not ({"force", "load"} & {*stem.split(".")[1:2]}):
                continue
            x, y = self[f"{stem}.x"], self[f"{stem}.y"]
            if isinstance(x, float) and isinstance(y, float) and math.isfinite(x + y):
                found.append(Force(at=stem.split(".")[0], x=x, y=y, unit=self.units[name]))
        return tuple(found)

    def table(self, *names: str) -> Table:
        """Columns of all rows with units.

        Parameters
        ----------
        names : str
            Quantities; by default all.

        Raises
        ------
        UnknownNameError
            Lists the nearest names.
        """
        columns: dict[str, AnyArray] = {n: np.atleast_1d(v) for n, v in self.inputs.items()}
        columns |= {name: np.atleast_1d(self[name]) for name in names or self.values}
        columns["status"] = np.array([status.name for status in self.statuses])
        units = {**self.units, **self.input_units, "status": ""}
        index = next(iter(self.inputs), "status")
        return Table(columns=columns, units={n: units[n] for n in columns}, index=index)

    def __repr__(self) -> str:
        return str(summary_of(self))


def summary_of(reactions: Reactions) -> Summary:
    """Efforts, the largest reactions and the check, for terminals."""
    rows = []
    for name, value in reactions.values.items():
        sizes = np.abs(value[np.isfinite(value)])
        if not sizes.size:
            rows.append((name, "undetermined" if reactions.undetermined[name].any() else "none"))
            continue
        unit = reactions.units[name]
        most = value.item() if value.ndim == 0 else float(sizes.max())
        rows.append((name, f"{'' if value.ndim == 0 else 'at most '}{most:.6g} {unit}".rstrip()))
    head = f"Forces of {reactions.mechanism}"
    return Summary(head, tuple(rows))


# ----------------------------------------------------------------------
# Where friction stops a mechanism.


@dataclass(frozen=True, kw_only=True)
class Stall:
    """An input value between motion and self-locking.

    Parameters
    ----------
    input : str
        The name of the input.
    value : float
        The last value found at which an effort moves the mechanism [file units].
    unit : str
    bracket : (float, float)
        A value at which it moves and one at which it locks, both as near as can be found.
    proved : bool
        Whether the equilibrium at one, and that there is none at the other, are proved.
    position : Position
        The mechanism at ``value``: ``stall.position["crank"]``.

    Examples
    --------
    >>> import linkwork as lw
    >>> [stall.proved for stall in lw.forces.stalls(lw.example("crank-press"))]
    []
    """

    input: str
    value: float
    unit: str
    bracket: tuple[float, float]
    proved: bool
    position: Position


# ----------------------------------------------------------------------
# The evidence of forces as sentences.


def force_status_fields(found: Reactions) -> Iterator[tuple[str, str]]:
    """The number of rows with forces, and those without by their reasons."""
    counts = Counter(status for status in found.statuses if status is not ForceStatus.FOUND)
    yield "found", str(len(found) - counts.total())
    yield from ((status.label, f"{n}: {status.value}") for status, n in counts.items())


def finite_forces(found: Reactions, names: Sequence[str] = ()) -> list[str]:
    """The forces with a finite value in some row, of ``names`` or of all."""
    return [
        name
        for name in names or found.values
        if name != "disagreement" and np.isfinite(found.values[name]).any()
    ]


def force_fields(found: Reactions, stalls: Sequence[Stall] = ()) -> Iterator[tuple[str, str]]:
    """Stalls, how far virtual work and free bodies agree, and what is wrong with joints."""
    yield from (("stalls", _stall(stall)) for stall in stalls)
    if "disagreement" in found.values:
        worst = np.nanmax(found.values["disagreement"], initial=0.0)
        yield "check", f"virtual work and free bodies agree to {worst:.1e} of the largest term"
    yield from undefined_fields(found)
    lost = [name for name, rows in found.undetermined.items() if rows.any()]
    if lost:
        yield "undetermined", f"{', '.join(lost)}: {ForceStatus.UNDETERMINED.value}"
    for name, rows in found.lifted.items():
        if rows.any():
            yield "lifts off", f"{name} would have to pull{_where(rows)}"
    for name, rows in found.slipping.items():
        if rows.any():
            yield "slips", f"{name} needs more friction than there is{_where(rows)}"
    unsure = int(np.sum(~found.proved))
    if unsure:
        yield "not proved", f"that friction leaves an equilibrium, or none, in {unsure} rows"


def undefined_fields(found: Reactions) -> Iterator[tuple[str, str]]:
    """Loads without a finite value."""
    for name, rows in found.undefined.items():
        if rows.any():
            yield "no value", f"{name}{_where(rows)}"


def _where(rows: BoolArray) -> str:
    return "" if rows.ndim == 0 else f" in {int(rows.sum())} rows"


def _stall(stall: Stall) -> str:
    """Where friction stops the mechanism, and whether this is proved."""
    moves, locked = stall.bracket
    proof = (
        f"proved: moves at {moves:.10g}, locked at {locked:.10g}" if stall.proved else "not proved"
    )
    others = (name for name in stall.position.unknowns if name != stall.input)
    places = [
        f"{name} = {stall.position[name]:.8g} {stall.position.value_units[name]}"
        for name in (stall.input, *islice(others, 1))
    ]
    return f"at {', '.join(places)} ({proof})"
