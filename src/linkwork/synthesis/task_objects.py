"""Functions of a mechanism that find better numbers for it."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any, Self

import numpy as np

from linkwork.core.api.mechanism import Mechanism
from linkwork.core.foundation.errors import InputError, MechanismError
from linkwork.core.foundation.values import as_told, finite_number
from linkwork.core.results.tables import Table
from linkwork.synthesis.defects.by_circuits import defects_by_circuits
from linkwork.synthesis.defects.verdicts import Defect
from linkwork.synthesis.designs_folder import FolderOptions, write_designs
from linkwork.synthesis.improvement.improving import improved_designs
from linkwork.synthesis.improvement.proved_design import ImprovedDesign
from linkwork.synthesis.improvement.settings import Improvement, read_goal
from linkwork.synthesis.solvers.result import Synthesis as result_Synthesis, designs_table
from linkwork.synthesis.solvers.solving import solve_task
from linkwork.synthesis.tasks import task_file
from linkwork.synthesis.tasks.task import Task as task_Task


def improve(
    mechanism: Mechanism,
    goal: Mapping[str, Any] | Sequence[Mapping[str, Any]],
    *,
    vary: Sequence[str] = (),
    bounds: Mapping[str, tuple[float, float]] | None = None,
    fit: str = "least squares",
    front: int = 0,
    starts: int = 16,
    spread: float = 0.05,
    seed: int = 1,
    progress: Callable[[float], None] | None = None,
) -> tuple[ImprovedDesign, ...]:
    """Designs that meet goals best, from many starts.

    Parameters
    ----------
    goal : Mapping, or sequence of Mapping
        Points ``{"point": "F", "points": [(x, y), …], "inputs": […]}``, without inputs in their
        order or with ``"order": "any"``; a quantity at inputs ``{"of": "rocker", "at": […],
        "values": […]}``; a quantity, a number of the motion (``dwell(d, 2)``) or a formula of
        either, with ``target``, ``least`` or ``most``; each with ``weight``. File units.
    vary : sequence of str
        Numbers that vary; by default lengths, angles, offsets, dimensions and fixed pivots.
    bounds : Mapping[str, (number, number)], optional
        By default lengths change by a factor of four at most.
    fit : str
        "least squares", or "minimax": the largest miss counts.
    front : int
        Instead of a sum: the largest number of designs between the goals (points, targets and
        values, not bounds) of which no other one is better in every goal.
    starts, spread, seed : int, number, int
        Starts about the mechanism as it is, their relative spread, and their seed; the first
        one is the mechanism itself.
    progress : callable, optional
        Called with the finished fraction, 0 to 1.

    Returns
    -------
    tuple of ImprovedDesign
        Different fits: those with all rows proved first, then by their misses. Of a
        front its designs by rising miss of the first goal, then those that are not proved.
        Ctrl-C keeps the best so far.

    Raises
    ------
    InputError, MechanismError, UnknownNameError
        For a goal that contradicts itself, is not known, or whose derivatives are not known.

    Examples
    --------
    >>> import linkwork as lw
    >>> bar = lw.example("four-bar")
    >>> goal = {"of": "rocker", "at": [0, 90, 180], "values": [60, 80, 100]}
    >>> best = lw.synthesis.improve(bar, goal, vary=["A B", "O4 B"], starts=4)[0]
    >>> best.sound
    True
    >>> crank = lw.example("slider-crank")
    >>> goals = [{"of": "stroke(d)", "target": 70}, {"of": "max(d)", "target": 60}]
    >>> front = lw.synthesis.improve(crank, goals, vary=["O2 A"], front=2, starts=1)
    >>> [round(design.goals["stroke(d)"], 4) for design in front]
    [0.0, 49.7142]
    """
    goal_tables = (goal,) if isinstance(goal, Mapping) else tuple(goal)
    for one in goal_tables:
        if not isinstance(one, Mapping):
            raise InputError(
                f'a goal is a table, {{"of": "stroke(d)", "target": 40}}, got {as_told(goal)}; '
                'how misses count is fit = "least squares" or "minimax"'
            )
    settings = Improvement(
        vary=(vary,) if isinstance(vary, str) else tuple(vary),
        bounds=bounds or {},
        fit=fit,
        front=front,
        starts=starts,
        spread=spread,
        seed=seed,
    )
    goals = tuple(map(read_goal, goal_tables))
    return improved_designs(mechanism.model, goals, settings, progress)


# ----------------------------------------------------------------------
# Tasks as Python objects, and the mechanisms that do them.


class Task:
    """The task of a mechanism: poses, points or a function, with requirements.

    The class methods make tasks; keyword arguments are the other keys and tables of a task file.

    Examples
    --------
    >>> import linkwork as lw
    >>> poses = [(0, 0, 0), (2, 1, 20), (3, 3, 50), (2, 5, 80), (0, 6, 100)]
    >>> task = lw.Task.motion(poses, wanted={"transmission": {"least": 10}})
    >>> task.solve().real
    2
    """

    def __init__(self, described: task_Task, name: str = "the task") -> None:
        self.described = described
        self._name = name

    @classmethod
    def motion(cls, poses: Sequence[Sequence[float]], **tables: Any) -> Self:
        """A task of poses (x, y, angle), in order of travel and file units."""
        return cls._of("motion", **_apart(tables, positions=_positions(poses)))

    @classmethod
    def mixed(cls, positions: Sequence[Sequence[float]], **tables: Any) -> Self:
        """A task of points (x, y) and poses (x, y, angle), in order of travel and file units."""
        return cls._of("mixed", **_apart(tables, positions=_positions(positions)))

    @classmethod
    def path(
        cls,
        points: Sequence[Sequence[float]],
        *,
        inputs: Sequence[float] | None = None,
        order: str = "as given",
        tolerance: float = 0.0,
        **tables: Any,
    ) -> Self:
        """A task of points (x, y), passed in their order or, with ``order="any"``, in any.

        ``inputs``: angles of the crank at the points. Timed points, and more than nine of them, are
        met by least squares. ``tolerance``: how far every point may be missed [length].
        """
        wanted_table = {"order": order, **tables.pop("wanted", {})}
        positions = _positions(points)
        if inputs is not None:
            if len(inputs) != len(positions):
                raise InputError(f"{len(positions)} points need as many inputs, got {len(inputs)}")
            for position, value in zip(positions, inputs, strict=True):
                position["input"] = value
        for position in positions if tolerance else ():
            position["tolerance"] = tolerance
        return cls._of("path", **_apart(tables, positions=positions, wanted=wanted_table))

    @classmethod
    def function(cls, of: str | Sequence[Sequence[float]], **tables: Any) -> Self:
        """A task of a function: a formula of x, or pairs of input and output.

        ``x``, ``input``, ``output``, ``positions``, ``spacing`` and ``fit`` are keys of the table
        of the function; all others are tables of the task.
        """
        table = {key: tables.pop(key) for key in _OF_FUNCTIONS if key in tables}
        table["of" if isinstance(of, str) else "pairs"] = of
        return cls._of("function", **_apart(tables, function=table))

    @classmethod
    def improve(cls, mechanism: str | Path, **tables: Any) -> Self:
        """A task that improves a mechanism: a file, or an example of the library.

        ``goal``, ``goals``, ``point``, ``vary``, ``bounds``, ``starts``, ``spread``, ``front`` and
        ``seed`` are keys of the table ``improve``; all others are tables of the task.
        """
        table = {key: tables.pop(key) for key in _OF_IMPROVEMENTS if key in tables}
        return cls._of("improve", **_apart(tables, mechanism=str(mechanism), improve=table))

    @classmethod
    def load(cls, path: str | Path) -> Self:
        """The task in a file.

        Raises
        ------
        MechanismFileError
            Lists all problems with file, line and key.
        """
        return cls(task_file.read_task(path), str(path))

    @classmethod
    def loads(cls, text: str, name: str = "the task") -> Self:
        """The task in the text of a task file; raises like :meth:`load`."""
        return cls(task_file.read_task_text(text, name), name)

    @classmethod
    def _of(cls, kind: str, **tables: Any) -> Self:
        return cls(task_file.task_of_tables({"task": kind, **tables}))

    @property
    def name(self) -> str:
        """The name of the task."""
        return self.described.name

    def solve(self, *, progress: Callable[[float], None] | None = None) -> Synthesis:
        """All designs for the task, each with its defects.

        Raises
        ------
        InputError
            If the task has no solver, or its conditions contradict each other.
        """
        try:
            solved = solve_task(self.described, progress=progress)
        except MechanismError as error:
            raise task_file.located_task_error(error, self.described, self._name) from None
        return Synthesis(**{f.name: getattr(solved, f.name) for f in fields(solved)})

    def defects_of(
        self, mechanism: Mechanism, inputs: Sequence[float], *, point: str | None = None
    ) -> tuple[Defect, ...]:
        """The circuit or branch defect of a mechanism of any kind that passes the positions.

        Parameters
        ----------
        mechanism : Mechanism
        inputs : sequence of float
            Its input at the positions [file units].
        point : str, optional
            The guided point; by default the first traced point.

        Raises
        ------
        InputError
            If the number of inputs differs from that of the positions, no point is named, or one
            configuration is nearest to different positions of one input.

        Examples
        --------
        >>> import linkwork as lw
        >>> bar = lw.example("four-bar")
        >>> path = [bar.solve(at=angle).points["B"] for angle in (0, 90, 180)]
        >>> lw.Task.path(path).defects_of(bar, (0, 90, 180), point="B")
        ()
        """
        positions = self.described.positions
        name = point or next(iter(mechanism.description.trace), None)
        if name is None:
            raise InputError(f'"{mechanism.name}" traces no point: name one, point="P"')
        if len(inputs) != len(positions):
            raise InputError(f"{len(positions)} positions need as many inputs, got {len(inputs)}")
        values = [
            finite_number(f"the input of position {k}", value)
            for k, value in enumerate(inputs, start=1)
        ]
        places = [{name: complex(*position.point)} for position in positions]
        return defects_by_circuits(mechanism.model, values, places)

    def __repr__(self) -> str:
        return f'<Task "{self.name}": {self.described.kind}>'


_OF_IMPROVEMENTS = (
    "goal", "goals", "point", "vary", "bounds", "starts", "spread", "front", "seed",
)  # fmt: skip
_OF_FUNCTIONS = ("x", "input", "output", "positions", "spacing", "fit")


def _apart(tables: dict[str, Any], **named: Any) -> dict[str, Any]:
    """The tables of a task; a table that is passed twice is an error."""
    for name in sorted({*named, "task"} & tables.keys()):
        raise InputError(f'"{name}" is made of the other arguments: give its keys as arguments')
    return {**named, **tables}


def _positions(listed: Any) -> list[dict[str, Any]]:
    """Positions of rows: of three numbers poses; others are points, if the task's keys say so."""
    rows = np.asarray(listed, dtype=float).tolist() if isinstance(listed, np.ndarray) else listed
    return [
        {"point": list(row[:2]), "angle": row[2]} if len(row) == 3 else {"point": list(row)}
        for row in rows
    ]


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Synthesis(result_Synthesis):
    """All designs for a task, sound ones first.

    Attributes are those of a report: ``complex``, ``real`` and ``proved`` count solutions,
    ``linkages`` mechanisms, ``defects`` designs by defect; ``completeness`` and ``message`` say
    whether the list is complete; ``dyads`` and ``designs`` hold the details.

    Examples
    --------
    >>> import linkwork as lw
    >>> task = lw.Task.function("log10(x)", x=(1, 2), input=(45, 105), output=(0, 90))
    >>> found = task.solve()
    >>> len(found.defect_free), found.completeness.name
    (1, 'PROVED')
    >>> round(found.defect_free[0].solve(at=75)["rocker"], 2)
    52.65
    """

    @property
    def defect_free(self) -> tuple[Mechanism, ...]:
        """The delivered designs as mechanisms, best first."""
        return tuple(Mechanism(design.linkage) for design in self.delivered)

    def table(self) -> Table:
        """All designs, one row each: numbers, points, and the first reason of refused ones."""
        return designs_table(self)

    def save(
        self, folder: str | Path, *, refused: bool = False, force: bool = False
    ) -> tuple[str, ...]:
        """Write the delivered designs as mechanism files with their task beside them.

        Parameters
        ----------
        folder : str or Path
            A new or empty folder; with ``force`` it may hold files.
        refused : bool
            Whether to write the refused designs too, in its folder ``refused``.
        force : bool
            Whether to replace the files of an earlier synthesis in the folder; other files stay.

        Returns
        -------
        tuple of str
            The files; none if no design is delivered, and a folder of earlier designs stays as it
            was.

        Raises
        ------
        InputError
            If the folder holds files that are not to be replaced, or cannot be written.
        """
        return tuple(
            write_designs(self, folder, FolderOptions(refused=refused, force=force)).values()
        )
