"""A motion: the positions of one table of input values, as arrays."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from linkwork import wings
from linkwork.core.expression.derivatives import Jet
from linkwork.core.foundation.arrays import (
    EQUAL_ROWS,
    Array,
    BoolArray,
    ComplexArray,
    CountArray,
    FrozenDict,
    read_only,
)
from linkwork.core.foundation.errors import UnknownNameError, choices, internal
from linkwork.core.foundation.names import as_name, find_spelling
from linkwork.core.foundation.statuses import Certification, CircuitEnd, Status
from linkwork.core.mechanism.skeleton import Skeleton
from linkwork.core.results.failure import Failure, Limit, LimitKind, OutputLimit
from linkwork.core.results.quantities.definition import Asked, AskedOfMotion, Group
from linkwork.core.results.quantities.registry import EVIDENCE, Quantities
from linkwork.core.results.quantities.rows import Between, LocatedRows, columns_of, locate_rows
from linkwork.core.results.quantity import Rate, Units
from linkwork.core.results.tables import Column, Series, Summary, Table

# long: more than half are the descriptions and examples of public methods.


_FEW_ROWS = 4000  # of motions that are drawn


@internal(
    "quantities",
    "units",
    "skeleton",
    "quantity",
    "own",
    "place",
    "located",
    "between",
    "is_of_rows",
)
@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Motion:
    """The positions of a mechanism over a table of N input values.

    ``motion["rocker"]`` is the column of a quantity as an array, shape (N,); rows without a
    position are kept and hold NaN.

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
    inputs : Mapping[str, array (N,)]
        Input values in file units.
    input_units : Mapping[str, str]
        Their units.
    derivative_unit : str
        The unit of the leading input in derivatives: ``rad``, or the length unit.
    unknowns, links, sliders, outputs : Mapping[str, Series]
        Values and derivatives of the quantities, as in
        :class:`~linkwork.core.results.position.Position`.
    points : Mapping[str, (Series, Series)]
        x and y of every point.
    riding : tuple of str
        Links that turn with another link, on which they only slide.
    status : tuple of Status
        One status per row.
    message : str
        Number of rows without position, and every limit of the motion with its links in line.
    residual, condition : array (N,)
        Largest closure error relative to the longest link; largest condition number of a block.
    iterations : array (N,) of int
        Newton-Raphson iterations.
    certification : tuple of Certification
        Proof of each row, or the reason why there is none; ``certified`` is the array of bool.
    radius, unique_within : array (N,)
        For proved rows: a true position lies within ``radius``, and no other within
        ``unique_within`` (largest norm, angles [rad], lengths relative to the longest link).
    branch : tuple of str
        The branch of each row; "" if the row has no position.
    limit : tuple of str
        ``dead point``, ``change point``, ``maximum of …`` for rows at such an input, otherwise "".
    added : array (N,) of bool
        Rows in addition to the table: limits, and with ``through`` the rows of further branches.
    speed : float, optional
        Speed of the leading input [rad/s or length/s].
    limits : tuple of Limit
        The limits of the branch within the table; with ``through`` all dead points passed.
    output_limits : tuple of OutputLimit
        Extremes of the quantities in ``limits_of``.
    circuit : CircuitEnd, optional
        With ``through``: how the circuit ends.
    redundant : Mapping[str, float]
        The largest error of each redundant link's length, relative to the longest link; not proved.
    q : array (N, n)
        The unknowns with angles in radians.
    failure : Failure, optional
        Why no position was found at the guess.
    friction_work : array (N,), optional
        Of a simulation with friction: the energy that it has taken so far.
    flywheel_energy : array (N,), optional
        Of a simulation: the kinetic energy of the inertia on its inputs.
    stop_forces, stop_impulses : Mapping[str, array (N,)]
        Of a simulation: the force or moment with which stops push a quantity, and the impulse of
        their shocks, by its name; positive where it makes the quantity grow.
    between : callable, optional
        Solves positions between rows; without it extremes are those of the rows.

    Examples
    --------
    >>> import linkwork as lw
    >>> motion = lw.example("four-bar").sweep(from_=0, to=90, step=30)
    >>> motion["rocker"].round(3)
    array([62.72 , 55.268, 64.943, 80.257])
    >>> motion["rocker.velocity"].round(3)
    array([-16.667,   3.043,  11.434,  13.475])
    >>> bool(motion.certified.all())
    True
    """

    mechanism: str
    units: Units
    skeleton: Skeleton
    quantities: Quantities
    inputs: Mapping[str, Array]
    input_units: Mapping[str, str]
    derivative_unit: str
    unknowns: Mapping[str, Series]
    links: Mapping[str, Series] = FrozenDict()
    sliders: Mapping[str, Series] = FrozenDict()
    points: Mapping[str, tuple[Series, Series]] = FrozenDict()
    outputs: Mapping[str, Series] = FrozenDict()
    riding: tuple[str, ...] = ()
    status: tuple[Status, ...]
    message: str = ""
    residual: Array
    iterations: CountArray
    condition: Array
    certification: tuple[Certification, ...]
    radius: Array
    unique_within: Array
    branch: tuple[str, ...]
    limit: tuple[str, ...]
    added: BoolArray
    speed: float | None = None
    limits: tuple[Limit, ...] = ()
    output_limits: tuple[OutputLimit, ...] = ()
    circuit: CircuitEnd | None = None
    redundant: Mapping[str, float] = FrozenDict()
    q: Array
    failure: Failure | None = None
    friction_work: Array | None = None
    flywheel_energy: Array | None = None
    stop_forces: Mapping[str, Array] = FrozenDict()
    stop_impulses: Mapping[str, Array] = FrozenDict()
    between: Between | None = None

    def __post_init__(self) -> None:
        for field in (*EVIDENCE, "added", "q"):
            object.__setattr__(self, field, read_only(getattr(self, field)))
        for field in ("friction_work", "flywheel_energy"):
            if getattr(self, field) is not None:
                object.__setattr__(self, field, read_only(getattr(self, field)))
        for field in ("stop_forces", "stop_impulses"):
            table = {name: read_only(values) for name, values in getattr(self, field).items()}
            object.__setattr__(self, field, FrozenDict(table))
        inputs = {name: read_only(values) for name, values in self.inputs.items()}
        object.__setattr__(self, "inputs", FrozenDict(inputs))

    def __len__(self) -> int:
        return len(self.status)

    def __getitem__(self, name: str) -> Array:
        """Values of one column by name, shape (N,): ``motion["s16"]``, ``motion["A.x"]``.

        Rates are columns too: ``motion["A.x.d1"]``, ``motion["A.x.velocity"]``; see
        :class:`~linkwork.core.results.quantity.Rate`. ``linkwork quantities`` lists all names.

        Raises
        ------
        UnknownNameError
            If the name does not exist; lists the nearest names.
        """
        asked = self.quantity(name)
        if asked.group is Group.EVIDENCE:
            evidence: Array = getattr(self, asked.name)
            return evidence
        if asked.group is Group.INPUT and asked.rate is None:
            return self.inputs[asked.name]
        return asked.values(self, self.speed)

    def quantity(self, name: str) -> Asked:
        """A quantity or rate by name, with its unit.

        Raises
        ------
        UnknownNameError
            If the name does not exist, or the rate needs an input speed.

        Examples
        --------
        >>> import linkwork as lw
        >>> lw.example("four-bar").sweep(step=90).quantity("B.x").unit
        'mm'
        """
        asked = self.quantities.find(name)
        asked.check_rate(self.speed)
        return asked

    def value(self, name: str) -> float:
        """A number of the whole motion: ``motion.value("stroke(s16)")``.

        Parameters
        ----------
        name : str
            ``min(…)``, ``max(…)``, ``mean(…)``, ``stroke(…)``, ``time_ratio(…)``,
            ``path_length(…)``, ``dwell(…, band)``; the value is in file units, NaN if undefined.
            Extremes are located between the rows.

        Raises
        ------
        InputError, UnknownNameError
            If the name does not exist.

        Examples
        --------
        >>> import linkwork as lw
        >>> round(lw.example("four-bar").sweep().value("stroke(rocker)"), 2)
        73.78
        """
        asked = self.quantities.find_of_motion(name)
        return float(asked.number(self.located(asked).rows))

    def is_of_rows(self, name: str) -> bool:
        """Whether a number of the motion is that of its rows, and follows their distance.

        Rates and forces may grow without bound towards dead points.
        """
        asked = self.quantities.find_of_motion(name)
        ends = asked.of.needs > 0 and LimitKind.DEAD_POINT.word in self.limit
        known = self.between is None or asked.of.group is Group.EVIDENCE
        return known or ends or asked.quantity.places is None

    def located(self, asked: AskedOfMotion) -> LocatedRows:
        """The rows with further ones that make a number of the motion exact."""
        asked.of.check_rate(self.speed)
        names = asked.names
        leading = self.inputs[names.lead] * names.units.scale(names.inputs[names.lead])
        if asked.of.group in (Group.EVIDENCE, Group.INPUT):
            columns: tuple[Array, ...] = (self[asked.of.name],)
        else:
            columns = columns_of(asked, self, self.speed)
        return locate_rows(asked, asked.rows(leading, *columns), self.between, self.speed)

    def series(self, name: str) -> Series:
        """A quantity with both derivatives with respect to the leading input.

        Parameters
        ----------
        name : str
            A quantity without rate: ``"s16"``, ``"B.x"``.

        Raises
        ------
        UnknownNameError
            If the name does not exist; lists the nearest names.

        Examples
        --------
        >>> import linkwork as lw
        >>> motion = lw.example("four-bar").sweep(from_=0, to=90, step=30)
        >>> motion.series("B.x").first.round(3)  # mm/rad
        array([ 47.402,  -8.004, -33.145, -42.497])
        """
        asked = self.quantities.find(name)
        if asked.group in (Group.EVIDENCE, Group.POINT) or asked.rate is not None:
            raise self.quantities.unknown(name)
        own = asked.own.name
        for table in (self.unknowns, self.links, self.sliders, self.outputs):
            if own in table:
                return table[own]
        point, _, axis = own.rpartition(".")
        if asked.group is Group.COORDINATE:
            return self.points[point][axis == "y"]
        jet = asked.jet(self)
        return Series(quantity=asked.own, value=jet.v, first=jet.d1, second=jet.d2)

    def own(self, name: str) -> Jet:
        """A variable of the mechanism by its exact name; see :class:`Solved`."""
        if name in self.inputs and name not in self.links:
            return self._driven(name)
        series = self.series(name)
        return Jet(series.value, series.first, series.second)

    def _driven(self, name: str) -> Jet:
        """An input; only the rate of the leading one is known."""
        leads = name == self.quantities.names.lead
        value = self.inputs[name]
        return Jet(value, np.full(len(self), 1.0 if leads else np.nan), np.zeros(len(self)))

    def place(self, point: str) -> Jet:
        """A point with both derivatives by its exact name."""
        known = self._places.get(as_name(point))
        if known is not None:
            return known
        if point not in self.points:
            raise UnknownNameError(
                f'there is no point "{point}" {choices("points", self.points, point)}'
            )
        x, y = self.points[point]
        jet = Jet(x.value + 1j * y.value, x.first + 1j * y.first, x.second + 1j * y.second)
        if len(self) <= _FEW_ROWS:  # longer tables would take twice the memory
            for part in (jet.v, jet.d1, jet.d2):
                part.flags.writeable = False
            self._places[point] = jet
        return jet

    @cached_property
    def _places(self) -> dict[str, Jet]:
        """The places asked for so far: a drawing asks again and again."""
        return {}

    @cached_property
    def found(self) -> BoolArray:
        """Whether a row has a position, shape (N,)."""
        return read_only(Status.CONVERGED.where(self.status))

    @property
    def asked(self) -> BoolArray:
        """Whether a row is in the input's table, shape (N,); false for added rows."""
        return np.logical_not(self.added)

    @property
    def certified(self) -> BoolArray:
        """Whether a row is proved, shape (N,)."""
        return Certification.CERTIFIED.where(self.certification)

    @property
    def worst(self) -> float:
        """The largest residual of the rows found, relative to the longest link; NaN if none."""
        found = self.residual[self.found]
        return float(found.max()) if len(found) else float("nan")

    def table(self, *names: str) -> Table:
        """Columns with units.

        Parameters
        ----------
        names : str
            Quantities and rates; by default all columns.

        Examples
        --------
        >>> import linkwork as lw
        >>> lw.example("four-bar").sweep(from_=0, to=90, step=30).table("rocker", "B.x")
        <Table of 4 rows over crank, 4 columns: crank [deg], rocker [deg], B.x [mm], status>
        """
        return table_of(self, *names)

    def to_pandas(self) -> Any:
        """A pandas DataFrame with the input as index."""
        return self.table().to_pandas()

    def to_xarray(self) -> Any:
        """An xarray Dataset over the input, with units."""
        return self.table().to_xarray()

    def plot(
        self,
        *names: str,
        kind: str = "curves",
        against: str = "",
        wrapped: bool = False,
        ax: Any = None,
        theme: str = "light",
        title: str | None = None,
    ) -> Any:
        """Plot columns over the input: ``motion.plot("theta3", "s16")``.

        Parameters
        ----------
        names : str
            Columns, including rates, ``residual``, ``iterations`` and ``condition``; by default
            unknowns and outputs. Points for paths and hodographs, pins for transmission angles.
        kind : str
            ``curves``, ``polar``, ``path``, ``hodograph`` or ``transmission``.
        against : str
            The column of the abscissa, or ``time``; by default the leading input.
        wrapped : bool
            Reduce angles to one turn; no line is drawn where they jump.
        ax : Axes, or a sequence of them, optional
            Existing axes, one for each panel; by default a new figure.
        theme : str
            ``light`` or ``dark``.
        title : str, optional
            By default the mechanism's name; "" for none.

        Returns
        -------
        matplotlib.axes.Axes, or a tuple of them
            One for each panel: columns of one unit share a panel.

        Raises
        ------
        InputError
            If there is nothing to plot, or options exclude each other.
        UnknownNameError
            If a name does not exist.
        MissingPackageError
            If Matplotlib is not installed.
        """
        plotting = wings.use("writers.charts.plane")
        chart = plotting.motion_plot(self, names, kind=kind, against=against, wrapped=wrapped)
        return plotting.plot(chart, ax, theme, title)

    def animate(
        self,
        path: str | Path,
        *,
        options: Any = None,
        progress: Callable[[float], None] | None = None,
    ) -> None:
        """Write the motion as an animation: ``motion.animate("crank.html")``.

        A page (.html) works offline in any browser; films are .gif, .apng, .webp (with Pillow) and
        .mp4 (with ffmpeg). The page of :meth:`linkwork.Mechanism.animate` shows the equations too.

        Parameters
        ----------
        path : str or Path
            The file; its suffix selects the format.
        options : linkwork.app.FilmOptions, optional
            Frames per second, number of positions and size of a film.
        progress : callable, optional
            Called with the finished fraction of a film, 0 to 1.

        Raises
        ------
        InputError
            If the suffix is not a known format, or there is nothing to draw.
        MissingPackageError
            If the package that writes the format is not installed.
        """
        wings.use("app.pages.animation").animate_motion(
            self, path, options=options, progress=progress
        )

    def widget(self) -> Any:
        """The motion as a notebook widget to play and drag; needs the extra ``notebook``.

        Returns
        -------
        anywidget.AnyWidget
            ``row`` is the displayed row and can be set.

        Raises
        ------
        InputError
            If there is nothing to draw.
        MissingPackageError
            If anywidget is not installed.
        """
        return wings.use("app.pages.notebook").motion_widget(self)

    def __repr__(self) -> str:
        return str(motion_summary(self))

    def _repr_html_(self) -> str:
        """A picture and a short table, for notebooks."""
        return wings.use("app.pages.notebook").motion_html(self)

    @property
    def counts(self) -> Counter[Status]:
        """Number of rows by status."""
        return Counter(self.status)

    def trace(self, point: str) -> ComplexArray:
        """The path of a point as x + iy, shape (N,), NaN without a position.

        Parameters
        ----------
        point : str
            A point, or one of its rates: ``"B.velocity"``.

        Raises
        ------
        UnknownNameError
            If the point does not exist, or the rate needs an input speed.

        Examples
        --------
        >>> import linkwork as lw
        >>> lw.example("four-bar").sweep(from_=0, to=60, step=60).trace("B").round(1)
        array([136.7+71.1j, 133.9+72.5j])
        """
        own, rate = Rate.split(point)
        own = find_spelling(own, self.points)
        if own not in self.points:
            raise UnknownNameError(
                f'there is no point "{own}" {choices("points", self.points, own)}'
            )
        if rate is not None:
            rate.check(own, self.speed)
            return self[f"{own}.x.{rate.value}"] + 1j * self[f"{own}.y.{rate.value}"]
        return self.place(own).v


# ----------------------------------------------------------------------
# Whether a branch ends in the table of a motion, be it between two rows.


def branch_end(motion: Motion) -> Limit | None:
    """The first limit in the table at which the branch ends.

    Without a lost row it is between two rows: those behind it belong to the same branch, and were
    reached from its other end.
    """
    ends = (limit for limit in motion.limits if not limit.passed)
    return next((limit for limit in ends if is_in_table(limit, motion)), None)


def is_in_table(limit: Limit, motion: Motion) -> bool:
    """Whether a row is lost, or a limit is at an input between the first row and the last."""
    lead = next(iter(motion.inputs))
    values, turn = motion.inputs[lead], motion.units.angle.turn
    if not len(values) or not motion.found.all():
        return True
    low, high = float(values.min()), float(values.max())
    # rounding may leave a limit at an end of the table just beyond it
    slack = EQUAL_ROWS * max(abs(low), abs(high))
    if motion.input_units[lead] != motion.units.angle.value:
        return low - slack <= limit.input <= high + slack
    away = (limit.input - low) % turn
    return bool(away <= high - low + slack or away > turn - slack)


def table_of(motion: Motion, *names: str) -> Table:
    """Columns of a motion: inputs, unknowns, points, outputs, derivatives, rates, evidence.

    ``<name>.d1`` and ``.d2`` are derivatives with respect to the leading input, angles in radians;
    ``.velocity`` and ``.acceleration`` appear when the input has a speed.

    Parameters
    ----------
    names : str
        Only these quantities and rates, between the inputs and the status.

    Raises
    ------
    UnknownNameError
        With the nearest names.
    """
    units = motion.units
    columns: dict[str, Column] = {}
    unit_of: dict[str, str] = {}

    def add(name: str, values: Column, unit: str) -> None:
        columns[name], unit_of[name] = values, unit

    for name, values in motion.inputs.items():
        add(name, values, motion.input_units[name])
    if names:
        for quantity in map(motion.quantity, names):
            add(quantity.name, motion[quantity.name], quantity.unit)
        add("status", np.array([status.name for status in motion.status]), "")
        return Table(columns=columns, units=unit_of, index=next(iter(motion.inputs)))
    everything: dict[str, Series] = dict(motion.unknowns)
    everything |= {link: motion.links[link] for link in motion.riding}
    for x, y in motion.points.values():
        everything[x.quantity.name], everything[y.quantity.name] = x, y
    everything |= motion.outputs
    for name, series in everything.items():
        add(name, series.value, units.of(series.quantity.kind))
    known = (rate for rate in Rate if not rate.needs_series)
    asked = [rate for rate in known if not (rate.by_time and motion.speed is None)]
    for pair in (asked[:2], asked[2:]):
        for name, series in everything.items():
            kind = series.quantity.kind
            for rate in pair:
                values = rate.of(series.first, series.second, motion.speed)
                unit = rate.unit(kind, units, motion.derivative_unit)
                add(f"{name}.{rate.value}", values, unit)
    add("status", np.array([status.name for status in motion.status]), "")
    add("residual", motion.residual, "")
    add("iterations", motion.iterations, "")
    add("condition", motion.condition, "")
    add("certified", motion.certified, "")
    add("branch", np.array(motion.branch, dtype=str), "")
    add("limit", np.array(motion.limit, dtype=str), "")
    return Table(columns=columns, units=unit_of, index=next(iter(motion.inputs)))


def motion_summary(motion: Motion) -> Summary:
    """Range of the input, counts by status, limits, worst evidence, ranges of the unknowns."""
    name, values = next(iter(motion.inputs.items()))
    values = values[motion.asked]
    unit = motion.input_units[name]
    head = (
        f"Motion of {motion.mechanism}, {name} {values[0]:.10g} to {values[-1]:.10g} {unit}, "
        f"{len(values)} positions"
    )
    rows = [(s.label, str(n)) for s, n in motion.counts.most_common()]
    rows += [(limit.kind.word, f"{limit.input:.10g} {unit}") for limit in motion.limits]
    rows += [
        (extreme.kind, f"{extreme.name} = {extreme.value:.10g} at {extreme.input:.10g} {unit}")
        for extreme in motion.output_limits
    ]
    if motion.circuit is not None:
        rows.append(("circuit", motion.circuit.value))
    found = motion.found
    if found.any():
        rows.append(("certified", f"{int(motion.certified.sum())} of {int(found.sum())}"))
        rows.append(("worst residual", f"{motion.worst:.1e} of the longest link"))
        regular = motion.condition[np.isfinite(motion.condition)]  # not so at dead points
        if len(regular):
            rows.append(("worst condition", f"{regular.max():.3g}"))
        for own, series in {**motion.unknowns, **motion.outputs}.items():
            reached, unit = series.value[found], motion.units.of(series.quantity.kind)
            rows.append((own, f"{reached.min():.8g} … {reached.max():.8g} {unit}".rstrip()))
    return Summary(head, tuple(rows))
