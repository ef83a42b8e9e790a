"""A mechanism that can be changed, checked and solved."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Self

from linkwork import batch, equations as closure, motion, textfile
from linkwork.foundation.deprecation import former_method
from linkwork.foundation.errors import InputError, MechanismError
from linkwork.mechanism.description import Description
from linkwork.mechanism.dimensions import Number
from linkwork.mechanism.driven_input import Input
from linkwork.numerics.newton import NewtonOptions
from linkwork.results.motion import Motion
from linkwork.results.position import Position

if TYPE_CHECKING:
    from linkwork.batch.family import Family
    from linkwork.results.check import CheckReport
    from linkwork.results.circuits import Circuits
    from linkwork.results.classification import Inversion
    from linkwork.results.configurations import Configurations
    from linkwork.results.iterates import Iterates
    from linkwork.results.nearest_assembly import NearestAssembly
    from linkwork.results.vector_loop import MovingLoop

__all__ = ["SolvableMechanism"]


class SolvableMechanism:
    """A mechanism that knows no pictures: see :class:`~linkwork.api.mechanism.Mechanism`.

    Raises
    ------
    MechanismError
        If the equations cannot be written or do not determine the motion.
    """

    def __init__(self, description: Description, read: textfile.ReadFile | None = None) -> None:
        self.description = description
        try:
            self.model = motion.as_described(description)
        except MechanismError as error:
            if read is None:
                raise
            raise read.located(error) from None

    def __eq__(self, other: object) -> bool:
        return isinstance(other, SolvableMechanism) and self.description == other.description

    def __hash__(self) -> int:
        return hash((type(self.description), self.description.name))

    def __repr__(self) -> str:
        equations = self.model.equations
        inputs = ", ".join(v.name for v in equations.inputs) or "nothing"
        count = len(equations.labels)
        what = "equation" if count == 1 else "equations"
        return (
            f'<Mechanism "{self.description.name}": {count} {what} for '
            f"{', '.join(v.name for v in equations.unknowns)}; driven by {inputs}>"
        )

    @property
    def name(self) -> str:
        """What the mechanism is called."""
        return self.description.name

    @property
    def loop_equations(self) -> closure.LoopEquations:
        """The closure equations as symbols."""
        return self.model.equations

    def with_dimensions(self, **changes: Number) -> Self:
        """A copy with named dimensions replaced."""
        return type(self)(self.description.with_dimensions(changes))

    def changed(self, **parts: Any) -> Self:
        """A copy with parts of the description replaced: ``changed(guess={...})``.

        Arguments are those the mechanism was made with: ``points``, ``lengths``, ``guess``, …
        """
        return type(self)(replace(self.description, **parts))

    def inversion(self, link: str, *, input: Input | None = None) -> Self:
        """The same chain with another link as ground; the old ground becomes ``frame``.

        Parameters
        ----------
        link : str
            The link that stands still from now on.
        input : Input, optional
            What is driven; unless given, the same relative angle or the same length as before.

        Raises
        ------
        InputError, UnknownNameError
            If there is no such link, or it cannot be ground.
        """
        return type(self)(motion.inversion(self.model, link, input))

    def inversions(self) -> tuple[Inversion, ...]:
        """Every link as ground, with what a textbook calls the mechanism then."""
        return motion.inversions(self.model)

    def driven_by(self, **what: Any) -> Self:
        """A copy with another input; arguments as of ``lw.Input``."""
        return type(self)(motion.driven_otherwise(self.model, Input(**what)))

    def check(self) -> CheckReport:
        """What was understood: loops, unknowns, blocks, mobility, the start."""
        return motion.check(self.model)

    def equations(self) -> closure.EquationSheet:
        """The loop equations and the Jacobian, to be shown as text or LaTeX."""
        return closure.EquationSheet(self.model.equations)

    def solve(
        self,
        at: float | Mapping[str, float] | None = None,
        *,
        configuration: str | None = None,
        from_guess: bool = False,
        options: NewtonOptions | None = None,
        certify: bool = True,
        with_steps: bool = False,
        throw: bool = False,
    ) -> Position:
        """The position at one input value; see :func:`linkwork.motion.solve`.

        Parameters
        ----------
        configuration : str, optional
            The one of this name in ``configurations(at)``, or on this branch of ``circuits()``,
            whatever the guess is near to.
        """
        if configuration is not None:
            if from_guess or with_steps:
                raise InputError("configuration= has no steps from a guess: leave one out")
            return motion.solve_configuration(self.model, at, configuration, throw=throw)
        return motion.solve(
            self.model,
            at,
            from_guess=from_guess,
            options=options,
            certify=certify,
            with_steps=with_steps,
            throw=throw,
        )

    def sweep(
        self,
        *,
        start: Number | None = None,
        stop: Number | None = None,
        step: Number | None = None,
        configuration: str | None = None,
        through: bool = False,
        change_points: str = "stop",
        limits_of: str | Iterable[str] = (),
        certify: bool = True,
        options: NewtonOptions | None = None,
        progress: Callable[[float], None] | None = None,
    ) -> Motion:
        """The whole cycle; see :func:`linkwork.motion.sweep`.

        Parameters
        ----------
        start, stop, step : number, optional
            Replace the range of the (only) input, in file units.
        configuration : str, optional
            Start from the configuration of this name at the guess's own input value, or on this
            branch of ``circuits()``.
        through : bool
            Go on through dead points, the input turning back, around the whole circuit.
        change_points : str
            ``stop`` at a change point, go ``straight`` on, or ``turn`` into the other branch.
        limits_of : str, or several
            Quantities whose largest and smallest values are located.
        certify : bool
            Prove every position and the motion between them; without, a sweep is faster.
        """
        asked = self.model
        if not (start is None and stop is None and step is None):
            asked = motion.model_of(self.description.with_range(start, stop, step))
            asked = asked.from_start_of(self.model)
        if configuration is not None:
            asked = motion.start_in_configuration(asked, configuration)
        return motion.sweep(
            asked,
            through=through,
            change_points=change_points,
            limits_of=limits_of,
            certify=certify,
            options=options,
            progress=progress,
        )

    def approximate_sweep(self, neighbour: Motion | None = None) -> Motion:
        """The cycle of a mechanism whose numbers differ a little from another's; nothing proved.

        Many times faster than :meth:`sweep`, for pictures while a dimension is being changed:
        Newton-Raphson starts from the neighbour's positions, at all rows at once. Where that
        would not be safe, the branch is followed anew; see :func:`linkwork.motion.warm_started`.
        """
        started = None if neighbour is None else motion.warm_started(self.model, neighbour)
        if started is None:
            started = motion.sweep(self.model, certify=False, explained=False)
        return started

    sweep_beside = former_method("sweep_beside", approximate_sweep, removed_in="0.4")

    def moving_loops(self, cycle: Motion) -> tuple[MovingLoop, ...]:
        """The loop equations over a motion, as vectors; none if there are no loops."""
        return motion.moving_loops(self.model, cycle)

    def nearest_assembly(self, at: float | Mapping[str, float] | None = None) -> NearestAssembly:
        """As near to closing as it gets; see :func:`linkwork.motion.nearest_assembly`."""
        return motion.nearest_assembly(self.model, at)

    def iterates(
        self,
        guess: Mapping[str, float] | None = None,
        at: float | Mapping[str, float] | None = None,
        *,
        options: NewtonOptions | None = None,
    ) -> Iterates:
        """Newton-Raphson from a guess, step by step; see :func:`linkwork.motion.iterates`."""
        return motion.iterates(self.model, guess, at, options=options)

    def guessed_points(self) -> tuple[str, ...]:
        """The points that a guess of the unknowns places."""
        return motion.guessed_points(self.model)

    def pulled_guess(
        self,
        point: str,
        place: tuple[float, float],
        guess: Mapping[str, float] | None = None,
        at: float | Mapping[str, float] | None = None,
    ) -> dict[str, float]:
        """A guess that brings a point near a place; see :func:`linkwork.motion.pulled_guess`."""
        return motion.pulled_guess(self.model, point, place, guess, at)

    def configurations(self, at: float | Mapping[str, float] | None = None) -> Configurations:
        """Every way to put it together at one input; see :func:`linkwork.motion.configurations`."""
        return motion.configurations(self.model, at)

    def circuits(
        self, *, certify: bool = True, progress: Callable[[float], None] | None = None
    ) -> Circuits:
        """All circuits with their branches; see :func:`linkwork.motion.circuits`."""
        return motion.circuits(self.model, certify=certify, progress=progress)

    def family(self, dimensions: Mapping[str, object]) -> Family:
        """Many designs of the mechanism at once; see :func:`linkwork.batch.designs_of`.

        Parameters
        ----------
        dimensions : Mapping[str, number or (D,)]
            What varies, in file units: dimensions, lengths (``"O2 A"``), angles, coordinates
            (``"O4.x"``); a plan of :mod:`linkwork.batch`.
        """
        return batch.family_of(self.model, dimensions)

    def cycle(
        self,
        *,
        configuration: str | None = None,
        certify: bool = True,
        progress: Callable[[float], None] | None = None,
    ) -> Motion:
        """The motion that is shown where one is wanted: :meth:`sweep`, and on through dead points
        where the input does not reach all of its range.
        """
        motion = self.sweep(configuration=configuration, certify=certify, progress=progress)
        if motion.found.all() or not motion.found.any():
            return motion
        return self.sweep(
            configuration=configuration, through=True, certify=certify, progress=progress
        )

    def cycles(
        self, *, certify: bool = True, progress: Callable[[float], None] | None = None
    ) -> dict[str, Motion]:
        """The motion on every circuit, by the circuit's name; that of the guess first.

        See :meth:`cycle`.
        """
        found = {}
        circuits = self.circuits(certify=False)
        for k, circuit in enumerate(circuits):
            branch = circuit.branches[0].name
            found[circuit.name] = self.cycle(configuration=branch, certify=certify)
            if progress is not None:
                progress((k + 1) / len(circuits))
        return found
