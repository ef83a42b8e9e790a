"""Results: configurations, circuits and their branches."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, fields, replace
from typing import Any

import numpy as np

from linkwork import wings
from linkwork.core.foundation.arrays import Array, Deferred, FrozenDict, NamedSequence
from linkwork.core.foundation.errors import UnknownNameError, choices, internal
from linkwork.core.foundation.statuses import CircuitEnd, Completeness
from linkwork.core.results.failure import Failure, Limit
from linkwork.core.results.motion import Motion
from linkwork.core.results.position import Position
from linkwork.core.results.tables import Summary, driven_text

# ----------------------------------------------------------------------
# Circuits of a mechanism, each reachable without disassembly, and their branches.


@dataclass(frozen=True, kw_only=True, eq=False)
class Branch:
    """A part of a circuit between dead points or change points (Chase & Mirth 1993).

    Parameters
    ----------
    name : str
        ``circuit 1 branch 2``.
    input_range : (float, float)
        Smallest and largest value of the leading input, in file units, unwrapped.
    configuration : str
        The name of its configuration at the input value of the guess; "" if the branch does not
        contain that value.
    certified : bool
        Whether the branch, and the way to it, is proved.
    end : CircuitEnd
        How the curve that contains the branch ends; ``INPUT_CONSTANT`` if the input is at rest
        along the whole branch.

    References
    ----------
    T. R. Chase, J. A. Mirth: Circuits and branches of single-degree-of-freedom planar linkages.
    Journal of Mechanical Design 115 (1993) 223-230, doi:10.1115/1.2919181

    Examples
    --------
    >>> import linkwork as lw
    >>> circuits = lw.example("four-bar").circuits()
    >>> branch = circuits.branch("circuit 2 branch 1")
    >>> branch.configuration, branch.certified
    ('crossed', True)
    """

    name: str
    input_range: tuple[float, float]
    configuration: str
    certified: bool
    end: CircuitEnd


@internal("weakness", "course")
@dataclass(frozen=True, kw_only=True, eq=False)
class Circuit:
    """The set of all positions that a mechanism can reach from one of them without disassembly.

    Parameters
    ----------
    name : str
        ``circuit 1`` contains the guess.
    end : CircuitEnd
        Whether the curve of positions closes, or why not.
    certified : bool
        Whether the curve is proved to be one curve, and to close; at change points to a millionth
        of a radian.
    input_range : (float, float)
        Smallest and largest value of the leading input, in file units, unwrapped.
    turns : int, optional
        Turns of the input until the circuit closes; 0 if the input reverses; ``None`` if the
        circuit does not close or the input is a length.
    turning : Mapping[str, int]
        Whole turns of every moving link in one pass of a closed circuit, positive
        counter-clockwise; 0 for a link that rocks.
    branches : tuple of Branch
        In the order of travel.
    dead_points, change_points : tuple of Limit
        Where the input reverses, and where curves cross.
    weakness : Deferred of (float, float)
        ``smallest_singular_value`` and ``weakest``, computed when one of them is first read.
    course : Deferred of Motion
        ``motion``, computed when it is first read.

    Examples
    --------
    >>> import linkwork as lw
    >>> circuit = lw.example("four-bar").circuits()[0]
    >>> circuit.closed, circuit.turns, circuit.turning["rocker"]
    (True, 1, 0)
    >>> [round(angle) for angle in circuit.range("rocker")]
    [55, 129]
    """

    name: str
    end: CircuitEnd
    certified: bool
    input_range: tuple[float, float]
    turns: int | None
    turning: Mapping[str, int] = FrozenDict()
    branches: tuple[Branch, ...]
    dead_points: tuple[Limit, ...] = ()
    change_points: tuple[Limit, ...] = ()
    weakness: Deferred[tuple[float, float]] = field(repr=False)
    course: Deferred[Motion] = field(repr=False)

    @property
    def smallest_singular_value(self) -> float:
        """σ_min of diag(1/s) J diag(w) along the circuit, to rounding; 0 at dead points and change
        points.

        J is the Jacobian with respect to all unknowns at a fixed input, s a length of each loop, w
        1 rad or a length for each unknown.
        """
        return self.weakness.value[0]

    @property
    def weakest(self) -> float:
        """The input value at which that singular value is smallest [file units]."""
        return self.weakness.value[1]

    @property
    def motion(self) -> Motion:
        """Positions along the circuit in the order of travel, branch by branch."""
        return self.course.value

    @property
    def closed(self) -> bool:
        """Whether the motion returns to its start."""
        return self.end.closed

    def __getitem__(self, name: str) -> Array:
        """Values of a quantity along the circuit: ``circuit["s16"]``."""
        return self.motion[name]

    def range(self, name: str) -> tuple[float, float]:
        """Smallest and largest value at the computed positions of the circuit."""
        values = self.motion[name]
        return float(np.nanmin(values)), float(np.nanmax(values))


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Circuits(NamedSequence[Circuit]):
    """All circuits of a mechanism, that of the guess first: a sequence.

    Indexed by number (from 0), by slice or by name.

    Parameters
    ----------
    mechanism : str
        The name of the mechanism.
    circuits : tuple of Circuit
        The circuits.
    completeness : Completeness
        Whether the list is complete.
    message : str
        The same as a sentence.
    input, input_unit : str
        The leading input, to whose values the branches refer, and its unit.
    seeded : int
        The number of input values at which all configurations were listed to find the circuits.
    failure : Failure, optional
        Why there is no position at the guess, or no motion from it, if no circuit was found.

    Examples
    --------
    >>> import linkwork as lw
    >>> circuits = lw.example("four-bar").circuits()
    >>> [circuit.name for circuit in circuits]
    ['circuit 1', 'circuit 2']
    >>> circuits.completeness.complete
    True
    """

    mechanism: str
    circuits: tuple[Circuit, ...]
    completeness: Completeness
    message: str
    input: str
    input_unit: str
    seeded: int
    failure: Failure | None = None

    @property
    def _by_name(self) -> tuple[tuple[str, Circuit], ...]:
        return tuple((circuit.name, circuit) for circuit in self.circuits)

    def _unknown(self, name: object) -> tuple[str, str]:
        return f'there is no "{name}"', "circuits"

    def branch(self, name: str) -> Branch:
        """A branch by its name, ``circuit 1 branch 2``.

        Raises
        ------
        UnknownNameError
            With the names that exist.
        """
        known = {branch.name: branch for circuit in self.circuits for branch in circuit.branches}
        if name not in known:
            raise UnknownNameError(f'there is no "{name}" {choices("branches", known, name)}')
        return known[name]

    def plot(
        self,
        *names: str,
        kind: str = "circuits",
        ax: Any = None,
        theme: str = "light",
        title: str | None = None,
    ) -> Any:
        """Plot quantities over the input, every circuit as a closed curve.

        Parameters
        ----------
        names : str
            Unknowns, links, sliders, outputs, coordinates; the first unknowns if left out.
        kind : str
            ``circuits`` together, or ``branches`` side by side, each in a panel of its own.
        ax : Axes, or a sequence of them, optional
            Where to draw: one for each panel. A new figure if left out.
        theme : str
            ``light`` or ``dark``.
        title : str, optional
            The mechanism's name unless given; "" for none.

        Returns
        -------
        matplotlib.axes.Axes, or a tuple of them
            One for each panel.

        Raises
        ------
        InputError
            If there is no circuit, or there are more branches than panels fit on a page.
        UnknownNameError
            For a name that does not exist.
        """
        plotting = wings.use("writers.charts.plane")
        return plotting.plot(plotting.circuits_plot(self, names, kind=kind), ax, theme, title)

    def __repr__(self) -> str:
        return str(circuits_summary(self))

    def _repr_html_(self) -> str:
        """A picture and a short table, for notebooks."""
        return wings.use("app.pages.notebook").circuits_html(self)

    def to_dict(self) -> dict[str, Any]:
        """Plain data, as in the command line's JSON."""
        return {
            "mechanism": self.mechanism,
            "input": self.input,
            "unit": self.input_unit,
            "circuits": [_circuit_data(circuit) for circuit in self.circuits],
            "completeness": self.completeness.name,
            "message": self.message,
            **({} if self.failure is None else {"failure": self.failure.to_dict()}),
        }


def _circuit_data(circuit: Circuit) -> dict[str, Any]:
    return {
        "name": circuit.name,
        "closed": circuit.closed,
        "end": circuit.end.name,
        "certified": circuit.certified,
        "input_range": list(circuit.input_range),
        "turns": circuit.turns,
        "turning": dict(circuit.turning),
        "branches": [
            {**vars(branch), "input_range": list(branch.input_range), "end": branch.end.name}
            for branch in circuit.branches
        ],
        "dead_points": [limit.to_dict() for limit in circuit.dead_points],
        "change_points": [limit.to_dict() for limit in circuit.change_points],
        "smallest_singular_value": circuit.smallest_singular_value,
        "weakest": circuit.weakest,
    }


def circuits_summary(circuits: Circuits) -> Summary:
    """One line per branch."""
    unit = circuits.input_unit
    head = f"{len(circuits)} circuit{'' if len(circuits) == 1 else 's'} of {circuits.mechanism}"
    rows = []
    for circuit in circuits:
        for branch in circuit.branches:
            low, high = branch.input_range
            rows.append((branch.name, f"{circuits.input} {low:.10g} to {high:.10g} {unit}"))
    return Summary(head, tuple(rows))


# ----------------------------------------------------------------------
# All assembly configurations at one input, and whether the list is complete.


@dataclass(frozen=True, kw_only=True)
class PathCount:
    """The counts of solutions of one block, summed over all configurations of the blocks before it.

    Parameters
    ----------
    unknowns : tuple of str
        The unknowns of the block.
    solved : int
        The number of configurations of earlier blocks for which the block was solved.
    paths : int
        Solution paths: finite + at_infinity + multiple + failed.
    finite : int
        Isolated complex solutions.
    real : int
        Real solutions; each is a configuration.
    at_infinity, multiple, failed : int
        Paths that ended at infinity, at a multiple solution, or were lost.
    expected : int
        The number of solutions of a random mechanism with the same structure.
    bound : int
        The largest possible number of solutions.
    theorem : str
        The theorem behind the bound.

    Examples
    --------
    >>> import linkwork as lw
    >>> count = lw.example("four-bar").configurations(60).paths[0]
    >>> count.finite, count.real, count.bound
    (2, 2, 2)
    """

    unknowns: tuple[str, ...]
    solved: int = 1
    paths: int = 0
    finite: int = 0
    real: int = 0
    at_infinity: int = 0
    multiple: int = 0
    failed: int = 0
    expected: int = 0
    bound: int = 0
    theorem: str = ""

    def plus(self, *others: PathCount) -> PathCount:
        """The sum of this count and others of the same block."""
        counts = (self, *others)
        kept = ("unknowns", "theorem")
        numbers = [f.name for f in fields(self) if f.name not in kept]
        sums = {name: sum(getattr(count, name) for count in counts) for name in numbers}
        theorems = dict.fromkeys(count.theorem for count in counts)
        return replace(self, theorem=" and ".join(theorems), **sums)


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Configurations(NamedSequence[Position]):
    """All assembly configurations of a mechanism at one input value.

    A sequence of positions, each with its name in ``position.configuration``; indexed by number
    (from 0), by slice or by name. The order is by block in solving order; within a block ``open``
    before ``crossed``, otherwise by the block's unknowns, angles from 0 to a full turn.

    Parameters
    ----------
    mechanism : str
        The name of the mechanism.
    positions : tuple of Position
        The configurations.
    completeness : Completeness
        Whether the list is complete.
    message : str
        The same as a sentence, with remarks on this list.
    input, input_units : Mapping
        Input values and their units.
    paths : tuple of PathCount
        The counts of solutions of every block.
    seed : int
        The seed of all random numbers.

    Examples
    --------
    >>> import linkwork as lw
    >>> found = lw.example("four-bar").configurations(60)
    >>> found.names
    ('open', 'crossed')
    >>> round(found["crossed"]["rocker"], 3)
    -111.77
    """

    mechanism: str
    positions: tuple[Position, ...]
    completeness: Completeness
    message: str
    input: Mapping[str, float]
    input_units: Mapping[str, str] = FrozenDict()
    paths: tuple[PathCount, ...] = ()
    seed: int

    @property
    def _by_name(self) -> tuple[tuple[str, Position], ...]:
        return tuple((position.configuration, position) for position in self.positions)

    def _unknown(self, name: object) -> tuple[str, str]:
        here = f"of {self.mechanism} at this input"
        return f'there is no configuration "{name}" {here}', "configurations"

    @property
    def names(self) -> tuple[str, ...]:
        """The names of all configurations."""
        return tuple(position.configuration for position in self.positions)

    def __repr__(self) -> str:
        return str(configurations_summary(self))

    def _repr_html_(self) -> str:
        """A picture and a short table, for notebooks."""
        return wings.use("app.pages.notebook").configurations_html(self)

    def to_dict(self) -> dict[str, Any]:
        """The list as JSON-ready data."""
        return {
            "mechanism": self.mechanism,
            "input": dict(self.input),
            "configurations": [position.to_dict() for position in self.positions],
            "completeness": self.completeness.name,
            "complete": self.completeness.complete,
            "message": self.message,
            "paths": [{**asdict(count), "unknowns": list(count.unknowns)} for count in self.paths],
            "seed": self.seed,
        }


def configurations_summary(found: Configurations) -> Summary:
    """One row per configuration, then the completeness and the ends of the paths."""
    at = driven_text(found.input, found.input_units)
    head = f"Configurations of {found.mechanism}" + (f" at {at}" if at else "")
    rows = []
    for position in found:
        values = ", ".join(f"{name} = {value:.8g}" for name, value in position.unknowns.items())
        certified = "certified" if position.certificate.certified else "not certified"
        rows.append((position.configuration, f"{values}  {certified}"))
    rows.append(("completeness", found.message))
    rows.append(("paths", "; ".join(map(solution_counts, found.paths))))
    return Summary(head, tuple(rows))


def solution_counts(count: PathCount) -> str:
    """``6 complex solutions, 4 of them real``."""
    finite = count.finite + count.multiple
    return f"{finite} complex solution{'' if finite == 1 else 's'}, {count.real} of them real"
