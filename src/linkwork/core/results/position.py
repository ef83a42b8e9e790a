"""The position nearest to closure, with the gap and the ends of links that do not meet."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from linkwork import wings
from linkwork.core.expression.derivatives import Jet
from linkwork.core.foundation.arrays import Array, ComplexArray, FrozenDict, read_only
from linkwork.core.foundation.errors import internal
from linkwork.core.foundation.statuses import Certification, Status
from linkwork.core.mechanism.skeleton import Skeleton
from linkwork.core.results.failure import Failure
from linkwork.core.results.quantities.definition import Group
from linkwork.core.results.quantities.registry import EVIDENCE, Quantities
from linkwork.core.results.quantity import Units
from linkwork.core.results.tables import Summary, driven_text


@dataclass(frozen=True, kw_only=True)
class LinkEnd:
    """An end of a link that does not reach its joint.

    Parameters
    ----------
    link, point : str
        The link, and the joint.
    joint, end : (x, y)
        The positions of the joint and of the link's end [length].
    """

    link: str
    point: str
    joint: tuple[float, float]
    end: tuple[float, float]


@internal("skeleton", "units", "apart")
@dataclass(frozen=True, kw_only=True)
class NearestAssembly:
    """The least-squares position: the smallest closure error found near the guess.

    Parameters
    ----------
    input, unknowns : Mapping[str, float]
        File units.
    points : Mapping[str, (x, y)]
        Coordinates of every point, each reached from ground by one way around its loop.
    gaps : Mapping[str, (x, y)]
        The closure error of every loop as a vector [length]; zero where it closes.
    gap : float
        Root of the sum of their squares [length].
    apart : tuple of LinkEnd
        Ends of links that do not reach their joint (points-and-links mechanisms).

    Examples
    --------
    >>> import linkwork as lw
    >>> short = lw.example("four-bar").with_dimensions({"A B": 20})
    >>> round(lw.circuits.nearest_assembly(short, at=180).gap, 1)  # mm
    40.0
    """

    mechanism: str
    units: Units
    skeleton: Skeleton
    input: Mapping[str, float]
    unknowns: Mapping[str, float]
    points: Mapping[str, tuple[float, float]]
    gaps: Mapping[str, tuple[float, float]] = FrozenDict()
    gap: float
    apart: tuple[LinkEnd, ...] = ()


# ----------------------------------------------------------------------
# One solved position, with its evidence.


@dataclass(frozen=True, kw_only=True)
class Certificate:
    """The proof of one position, or the reason why there is none.

    Parameters
    ----------
    certification : Certification
        Whether the position is proved, as a sentence.
    radius : float, optional
        A true position lies within this distance of the computed one: largest norm of the unknowns,
        angles [rad], lengths relative to the longest link. ``None`` without a proof.
    unique_within : float, optional
        No other position lies within this distance, in the same norm; ``inf`` if there is no other
        at all. ``None`` without a proof.

    Examples
    --------
    >>> import linkwork as lw
    >>> certificate = lw.example("four-bar").solve(at=60).certificate
    >>> certificate.certified
    True
    >>> certificate.radius < 1e-13 < certificate.unique_within
    True
    """

    certification: Certification = Certification.NOT_ASKED
    radius: float | None = None
    unique_within: float | None = None

    @property
    def certified(self) -> bool:
        """Whether the position is proved."""
        return self.certification.certified


@dataclass(frozen=True, kw_only=True)
class NewtonStep:
    """One iterate of Newton-Raphson: F + J Δ = 0, and Δ leads to the next iterate.

    ``values``: F, one number for each real equation: a length of the file, or radians.
    ``jacobian``: J, a row for each of them and a column for each unknown, angles in radians.
    ``changes``: Δ by unknown, in file units; none at the last iterate. ``step``: their largest
    weighted size.

    Examples
    --------
    >>> import linkwork as lw
    >>> step = lw.example("four-bar").solve(at=60, with_steps=True).steps[0].steps[-1]
    >>> f"{step.residual:.0e}"
    '1e-14'
    """

    k: int
    unknowns: Mapping[str, float]
    residual: float
    step: float | None = None
    values: tuple[float, ...] = ()
    jacobian: tuple[tuple[float, ...], ...] = ()
    changes: Mapping[str, float] = FrozenDict()


@dataclass(frozen=True, kw_only=True)
class NewtonTrail:
    """The iterates of one block of equations, in file units.

    In the steps, ``residual`` is the 2-norm of the block's real equations in their unit, ``step``
    the largest weighted change of an unknown. ``rows`` names the real equations.

    Examples
    --------
    >>> import linkwork as lw
    >>> trail = lw.example("four-bar").solve(at=60, with_steps=True).steps[0]
    >>> len(trail.steps)
    5
    """

    equations: tuple[str, ...]
    rows: tuple[str, ...]
    steps: tuple[NewtonStep, ...]
    status: Status


@internal("quantities", "units", "skeleton", "own", "place")
@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Position:
    """A position of a mechanism at one input value.

    Values are in file units; derivatives are per radian, with angles in radians (``first["s16"]``
    in mm/rad for an input angle). ``position["rocker"]`` is a value by name.

    Parameters
    ----------
    quantities : Quantities
        All quantities by name.
    mechanism : str
        The name of the mechanism.
    units : Units
        Units of angles and lengths.
    skeleton : Skeleton
        Links, joints and other parts, for drawings.
    status, message : Status, str
        The final status, and a sentence with details.
    input : Mapping[str, float]
        Input values.
    input_units : Mapping[str, str]
        Their units.
    derivative_unit : str
        The unit of the leading input in derivatives: ``rad``, or the length unit.
    unknowns : Mapping[str, float]
        The solved unknowns; angles are unwrapped.
    links : Mapping[str, float]
        The angle of every link.
    sliders : Mapping[str, float]
        Displacement of every slider and slot, length of every cylinder.
    points : Mapping[str, (x, y)]
        Coordinates of every point.
    outputs : Mapping[str, float]
        Values of the named formulas.
    value_units : Mapping[str, str]
        Units of unknowns, links, sliders, outputs and coordinates by name.
    first, second : Mapping[str, float]
        Derivatives with respect to the input of unknowns, links, sliders, outputs and coordinates.
    velocity, acceleration : Mapping[str, float]
        Derivatives with respect to time [per s, per s²], if the input has a speed.
    speed : float, optional
        Rate of the first input [rad/s or length/s], if given.
    residual : float
        Largest closure error relative to the longest link.
    iterations : int
        Newton-Raphson iterations at the guess and at every step along the branch.
    condition : float
        Largest condition number of a block's Jacobian (largest norm, weighted).
    certificate : Certificate
        The proof of the position.
    redundant : Mapping[str, float]
        The error of each redundant link's length, relative to the longest link; not proved.
    branch : str
        The branch that contains the position, if it was asked for by name.
    configuration : str
        The name of the configuration, if the position comes from a list of configurations.
    q : array, shape (n,)
        The unknowns with angles in radians.
    steps : tuple of NewtonTrail
        The iterates of every block, with ``with_steps=True``.
    failure : Failure, optional
        The reason why there is no position, or not the one nearest to the guess.

    Examples
    --------
    >>> import linkwork as lw
    >>> position = lw.example("four-bar").solve(at=60)
    >>> position.status.ok, position.certificate.certified
    (True, True)
    >>> x, y = position.points["B"]
    >>> round(x, 3), round(y, 3)
    (133.881, 72.471)
    >>> round(position.first["rocker"], 4)
    0.4573
    """

    mechanism: str
    units: Units
    skeleton: Skeleton
    quantities: Quantities
    status: Status
    message: str
    input: Mapping[str, float]
    input_units: Mapping[str, str] = FrozenDict()
    derivative_unit: str = ""
    unknowns: Mapping[str, float]
    links: Mapping[str, float] = FrozenDict()
    sliders: Mapping[str, float] = FrozenDict()
    points: Mapping[str, tuple[float, float]] = FrozenDict()
    outputs: Mapping[str, float] = FrozenDict()
    value_units: Mapping[str, str] = FrozenDict()
    first: Mapping[str, float] = FrozenDict()
    second: Mapping[str, float] = FrozenDict()
    velocity: Mapping[str, float] = FrozenDict()
    acceleration: Mapping[str, float] = FrozenDict()
    speed: float | None = None
    residual: float
    iterations: int
    condition: float
    certificate: Certificate = Certificate()
    redundant: Mapping[str, float] = FrozenDict()
    branch: str = ""
    configuration: str = ""
    q: Array
    steps: tuple[NewtonTrail, ...] = ()
    failure: Failure | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "q", read_only(self.q))

    def __getitem__(self, name: str) -> float:
        """A value by name: ``position["s16"]``, ``position["B.x"]``, ``position["B.x.velocity"]``.

        ``linkwork quantities`` lists all names.

        Raises
        ------
        UnknownNameError
            If the name does not exist; lists the nearest names.
        """
        asked = self.quantities.find(name)
        asked.check_rate(self.speed)
        if asked.rate is None and asked.row is None:
            for table in (self.input, self.unknowns, self.links, self.sliders, self.outputs):
                if asked.name in table:
                    return table[asked.name]
        if asked.group is Group.EVIDENCE:
            holder = self.certificate if hasattr(self.certificate, asked.name) else self
            number: float | None = getattr(holder, asked.name)
            return float("nan") if number is None else number
        return float(asked.values(self, self.speed))

    def own(self, name: str) -> Jet:
        """A variable of the mechanism by its exact name; see :class:`Solved`."""
        point, _, axis = name.rpartition(".")
        for table in (self.unknowns, self.links, self.sliders, self.outputs):
            if name in table:
                value = table[name]
                break
        else:
            if name in self.input:
                leads = name == self.quantities.names.lead
                one, zero = np.asarray(1.0 if leads else np.nan), np.zeros(())
                return Jet(np.asarray(self.input[name]), one, zero)
            value = self.points[point][axis == "y"]
        rates = (self.first.get(name, np.nan), self.second.get(name, np.nan))
        return Jet(*(np.asarray(part) for part in (value, *rates)))

    def place(self, point: str) -> Jet:
        """A point with both derivatives by its exact name."""
        x, y = self.own(f"{point}.x"), self.own(f"{point}.y")
        return Jet(*(a + 1j * b for a, b in ((x.v, y.v), (x.d1, y.d1), (x.d2, y.d2))))

    def __repr__(self) -> str:
        return str(position_summary(self))

    def _repr_html_(self) -> str:
        """A picture and a short table, for notebooks."""
        return wings.use("app.pages.notebook").position_html(self)

    def to_dict(self) -> dict[str, Any]:
        """The position as JSON-ready data: NaN becomes null, the status its member name.

        Examples
        --------
        >>> import linkwork as lw
        >>> lw.example("four-bar").solve(at=60).to_dict()["status"]
        'CONVERGED'
        """
        return {
            "mechanism": self.mechanism,
            "units": {"angle": self.units.angle.value, "length": self.units.length},
            "status": self.status.name,
            "message": self.message,
            "input": _plain(self.input),
            "unknowns": _plain(self.unknowns),
            "links": _plain(self.links),
            "sliders": _plain(self.sliders),
            "points": {name: [_null(x), _null(y)] for name, (x, y) in self.points.items()},
            "outputs": _plain(self.outputs),
            "first_derivative": _plain(self.first),
            "second_derivative": _plain(self.second),
            **({"velocity": _plain(self.velocity)} if self.velocity else {}),
            **({"acceleration": _plain(self.acceleration)} if self.acceleration else {}),
            "residual": _null(self.residual),
            "iterations": self.iterations,
            "condition": _null(self.condition),
            "certificate": {
                "certified": self.certificate.certified,
                **{
                    name: _null(getattr(self.certificate, name))
                    for name in EVIDENCE
                    if hasattr(self.certificate, name)
                },
                "reason": self.certificate.certification.value,
                **({"redundant": dict(self.redundant)} if self.redundant else {}),
            },
            "branch": self.branch,
            "configuration": self.configuration,
            **({} if self.failure is None else {"failure": self.failure.to_dict()}),
            **({"steps": [_trail(trail) for trail in self.steps]} if self.steps else {}),
        }


def _null(number: float | None) -> float | None:
    """A finite number; ``None`` for any other."""
    return float(number) if number is not None and np.isfinite(number) else None


def _plain(table: Mapping[str, float]) -> dict[str, float | None]:
    return {name: _null(number) for name, number in table.items()}


def _trail(trail: NewtonTrail) -> dict[str, Any]:
    return {
        "equations": list(trail.equations),
        "rows": list(trail.rows),
        "status": trail.status.name,
        "steps": [
            {
                "k": step.k,
                "unknowns": _plain(step.unknowns),
                "residual": _null(step.residual),
                "step": _null(step.step),
                "F": [_null(value) for value in step.values],
                "J": [[_null(slope) for slope in row] for row in step.jacobian],
                "change": _plain(step.changes),
            }
            for step in trail.steps
        ],
    }


def position_summary(position: Position) -> Summary:
    """A summary: status, unknowns, evidence."""
    at = driven_text(position.input, position.input_units)
    head = f"Position of {position.mechanism}" + (f" at {at}" if at else "")
    if not position.status.ok:
        return Summary(head, ((position.status.name, position.message),))
    values = {**position.unknowns, **position.outputs}
    units = position.value_units
    rows = [(n, f"{value:.10g} {units.get(n, '')}".rstrip()) for n, value in values.items()]
    rows += [
        ("residual", f"{position.residual:.1e} of the longest link"),
        ("condition", f"{position.condition:.3g}"),
        ("iterations", str(position.iterations)),
        ("certified", "yes" if position.certificate.certified else "no"),
    ]
    return Summary(head, tuple(rows))


# ----------------------------------------------------------------------
# Newton-Raphson step by step: every iterate with its equations, Jacobian and picture.


@internal("apart")
@dataclass(frozen=True, kw_only=True)
class Iterate:
    """One iterate of Newton-Raphson on one block of equations.

    Parameters
    ----------
    equations : tuple of str
        Labels of the block's equations.
    k : int
        Number of the iterate; 0 is the guess.
    unknowns : Mapping[str, float]
        The block's unknowns, in file units.
    residuals : tuple of float, shape (n,)
        F: the real parts of the loops, their imaginary parts, then the other equations, each in
        its own unit.
    norm : float
        The 2-norm of ``residuals``.
    jacobian : tuple of tuple of float, shape (n, n)
        dF/dx with respect to the block's unknowns; angles in radians.
    step : float, optional
        Largest weighted change to the next iterate (radians, or relative to the longest link);
        ``None`` at the last one.
    points : Mapping[str, (x, y)]
        Positions at this iterate: earlier blocks are solved, later blocks are at their guess.
    apart : tuple of LinkEnd
        Ends of links that do not meet their joint there.

    Examples
    --------
    >>> import linkwork as lw
    >>> run = lw.example("four-bar").iterates(at=60)
    >>> [f"{iterate.norm:.0e}" for iterate in run.iterates[:4]]
    ['2e+01', '1e+00', '8e-03', '4e-07']
    """

    equations: tuple[str, ...]
    k: int
    unknowns: Mapping[str, float]
    residuals: tuple[float, ...]
    norm: float
    jacobian: tuple[tuple[float, ...], ...]
    step: float | None
    points: Mapping[str, tuple[float, float]]
    apart: tuple[LinkEnd, ...] = ()


@dataclass(frozen=True, kw_only=True)
class Iterates:
    """The iterates from a guess, block after block, and where they ended: ``position``.

    Examples
    --------
    >>> import linkwork as lw
    >>> run = lw.example("four-bar").iterates(at=60)
    >>> len(run.iterates), run.position.status.name
    (5, 'CONVERGED')
    """

    position: Position
    iterates: tuple[Iterate, ...]


# ----------------------------------------------------------------------
# The loop equations of a position or a motion as vectors, for vector diagrams.


@dataclass(frozen=True, kw_only=True)
class LoopVector:
    """One term of a loop equation at one position.

    Parameters
    ----------
    name : str
        Its name in the equation, in polar form: ``a2∠θ12``.
    value : complex
        The value of the term: x + iy, in the mechanism's length unit.
    backwards : bool
        Whether the equation subtracts the named vector: the arrow then points against ``value``.
    """

    name: str
    value: complex
    backwards: bool = False


@dataclass(frozen=True, kw_only=True)
class VectorLoop:
    """A loop equation at one position: both sides lead from one place to another.

    ``label`` is the loop's name in the file, or the points it passes.
    """

    label: str
    left: tuple[LoopVector, ...]
    right: tuple[LoopVector, ...]


@dataclass(frozen=True, kw_only=True, eq=False)
class MovingVector:
    """One term of a loop equation over the rows of a motion: ``values`` (N,), NaN where there is no
    position; else as :class:`LoopVector`.
    """

    name: str
    values: ComplexArray
    backwards: bool = False

    def at(self, row: int) -> LoopVector:
        """The vector in a row."""
        value = complex(self.values[row])
        return LoopVector(name=self.name, value=value, backwards=self.backwards)


@dataclass(frozen=True, kw_only=True, eq=False)
class MovingLoop:
    """A loop equation over the rows of a motion."""

    label: str
    left: tuple[MovingVector, ...]
    right: tuple[MovingVector, ...]

    def at(self, row: int) -> VectorLoop:
        """The loop in a row."""
        return VectorLoop(
            label=self.label,
            left=tuple(vector.at(row) for vector in self.left),
            right=tuple(vector.at(row) for vector in self.right),
        )
