"""A mechanism that can be solved: positions, motions, configurations, circuits and families."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import TYPE_CHECKING

from linkwork import families as batch
from linkwork.api.described import DescribedMechanism
from linkwork.core import motion
from linkwork.core.foundation.errors import InputError, internal
from linkwork.core.mechanism.dimensions import Number
from linkwork.core.numerics.newton import NewtonOptions
from linkwork.core.results.position import Position

if TYPE_CHECKING:
    from linkwork.circuits.results import Circuits, Configurations
    from linkwork.core.results.motion import Motion
    from linkwork.core.results.nearest_assembly import NearestAssembly
    from linkwork.core.results.position import Iterates
    from linkwork.core.results.vector_loop import MovingLoop
    from linkwork.families.family import Family

__all__ = ["SolvableMechanism"]


@internal("moving_loops", "guessed_points", "pulled_guess")
class SolvableMechanism(DescribedMechanism):
    """The part of :class:`~linkwork.api.mechanism.Mechanism` that needs no drawing."""

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
        """The position at one input value.

        Newton-Raphson finds the position at the input value of the guess; from there the branch is
        followed to the requested value, and in the other direction if it meets a limit.

        Parameters
        ----------
        at : number or Mapping[str, number], optional
            Input value(s) in file units; by default those of the guess.
        configuration : str, optional
            Take the configuration of this name in ``configurations(at)``, or the position on this
            branch of ``circuits()``, instead of the branch of the guess.
        from_guess : bool
            Start Newton-Raphson from the guess at the requested value directly.
        options : NewtonOptions, optional
            Tolerances and the limit of a step.
        certify : bool
            Prove the position, and that the motion from the start to it stays on one branch.
        with_steps : bool
            Keep the iterates at the value asked in ``position.steps``, started from the guess.
        throw : bool
            Raise an exception instead of returning a position with another status.

        Returns
        -------
        Position
            Its ``status`` says whether the position was found.

        Raises
        ------
        UnknownNameError, InputError
            If the input values or the configuration do not fit the mechanism.
        NotConvergedError
            With ``throw``, if no position was found.

        Examples
        --------
        >>> import linkwork as lw
        >>> bar = lw.example("four-bar")
        >>> round(bar.solve(at=60)["rocker"], 3)
        64.943
        >>> round(bar.solve(at=60, configuration="crossed")["rocker"], 3)
        -111.77
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
        """The positions at all rows of the input's table, on the branch of the guess.

        If an input has a law, time drives the rows. The branch is followed both ways from the input
        value of the guess, with steps that do not depend on the table. A row beyond a limit is
        tried a whole turn away, otherwise it keeps its status. Dead points and change points on the
        way add rows.

        Parameters
        ----------
        start, stop, step : number, optional
            Replace the range of the only input, in file units.
        configuration : str, optional
            Start from the configuration of this name at the input value of the guess, or on this
            branch of ``circuits()``.
        through : bool
            Continue through dead points, where the input reverses, around the whole circuit.
        change_points : str
            ``stop`` at a change point, go ``straight`` on, or ``turn`` onto the other branch.
        limits_of : str or iterable of str
            Quantities whose maxima and minima are located.
        certify : bool
            Prove every position and the motion between them; a sweep without proofs is faster.
        options : NewtonOptions, optional
            Tolerances and the limit of a step.
        progress : callable, optional
            Called with the finished fraction, 0 to 1.

        Returns
        -------
        Motion
            One row per input value, each with its status.

        Raises
        ------
        UnknownNameError, InputError
            If a range, configuration, policy or quantity does not fit the mechanism.

        Examples
        --------
        >>> import linkwork as lw
        >>> motion = lw.example("four-bar").sweep(start=0, stop=360, step=90)
        >>> motion["rocker"].round(2)
        array([ 62.72,  80.26, 121.19, 123.86,  62.72])
        """
        asked = self.model
        # another range keeps the start position, which is on the branch of the guess
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
        """The cycle of a slightly changed mechanism, without proofs.

        It is many times faster than :meth:`sweep`: Newton-Raphson starts from the positions of the
        neighbour, at all rows together. If that is not safe, the branch is followed again; see
        :func:`linkwork.core.motion.warm_started`.

        Parameters
        ----------
        neighbour : Motion, optional
            The cycle of a mechanism with slightly different numbers.
        """
        started = None if neighbour is None else motion.warm_started(self.model, neighbour)
        if started is None:
            started = motion.sweep(self.model, certify=False, explained=False)
        return started

    def moving_loops(self, cycle: Motion) -> tuple[MovingLoop, ...]:
        """The loop equations over a motion as vectors; empty without loops."""
        return motion.moving_loops(self.model, cycle)

    def nearest_assembly(self, at: float | Mapping[str, float] | None = None) -> NearestAssembly:
        """The position nearest to closure, for a mechanism that does not close.

        See :func:`linkwork.core.motion.nearest_assembly`.

        Parameters
        ----------
        at : number or Mapping[str, number], optional
            Input value(s) in file units; by default those of the guess.
        """
        return motion.nearest_assembly(self.model, at)

    def iterates(
        self,
        guess: Mapping[str, float] | None = None,
        at: float | Mapping[str, float] | None = None,
        *,
        options: NewtonOptions | None = None,
    ) -> Iterates:
        """The iterates of Newton-Raphson from a guess; see :func:`linkwork.core.motion.iterates`.

        Parameters
        ----------
        guess : Mapping[str, number], optional
            Values of some or all unknowns, in file units; others keep the mechanism's guess.
        at : number or Mapping[str, number], optional
            Input value(s) in file units; by default those of the guess.
        options : NewtonOptions, optional
            Tolerances and the limit of a step.

        Examples
        --------
        >>> import linkwork as lw
        >>> found = lw.example("four-bar").iterates(at=60)
        >>> len(found.iterates), found.position.status.name
        (5, 'CONVERGED')
        """
        return motion.iterates(self.model, guess, at, options=options)

    def guessed_points(self) -> tuple[str, ...]:
        """The names of the points whose coordinates follow from a guess of the unknowns."""
        return motion.guessed_points(self.model)

    def pulled_guess(
        self,
        point: str,
        place: tuple[float, float],
        guess: Mapping[str, float] | None = None,
        at: float | Mapping[str, float] | None = None,
    ) -> dict[str, float]:
        """A guess that brings a point near given coordinates; see
        :func:`linkwork.core.motion.pulled_guess`.

        Parameters
        ----------
        point, place : str, (float, float)
            The point, and coordinates [length].
        guess, at
            As in :meth:`iterates`.
        """
        return motion.pulled_guess(self.model, point, place, guess, at)

    def configurations(self, at: float | Mapping[str, float] | None = None) -> Configurations:
        """All assembly configurations at one input value, each with its certificate.

        Blocks of one loop are solved in closed form, larger blocks by homotopy continuation; see
        :func:`linkwork.core.motion.configurations`.

        Parameters
        ----------
        at : number or Mapping[str, number], optional
            Input value(s) in file units; by default those of the guess.

        Returns
        -------
        Configurations
            Iterates over the positions; ``completeness`` grades the list.

        Raises
        ------
        UnknownNameError, InputError
            If the input values do not fit the mechanism.

        Examples
        --------
        >>> import linkwork as lw
        >>> for position in lw.example("four-bar").configurations(at=60):
        ...     print(position.configuration, round(position["rocker"], 3))
        open 64.943
        crossed -111.77
        """
        return motion.configurations(self.model, at)

    def circuits(
        self, *, certify: bool = True, progress: Callable[[float], None] | None = None
    ) -> Circuits:
        """All circuits with their branches; see :func:`linkwork.core.motion.circuits`.

        Parameters
        ----------
        certify : bool
            Prove the curve of every circuit.
        progress : callable, optional
            Called with the finished fraction, 0 to 1.

        Returns
        -------
        Circuits
            The circuit of the guess first.

        Raises
        ------
        InputError
            If the mechanism has no input.

        Examples
        --------
        >>> import linkwork as lw
        >>> for circuit in lw.example("four-bar").circuits():
        ...     print(circuit.name, circuit.end.name, circuit.certified)
        circuit 1 CLOSED True
        circuit 2 CLOSED True
        """
        return motion.circuits(self.model, certify=certify, progress=progress)

    def family(self, dimensions: Mapping[str, object]) -> Family:
        """Many designs of the mechanism, solved together; see :func:`linkwork.families.designs_of`.

        Parameters
        ----------
        dimensions : Mapping[str, number or array (D,)]
            The varied numbers in file units: dimensions, lengths (``"O2 A"``), angles, coordinates
            (``"O4.x"``); or a plan of :mod:`linkwork.families`.

        Returns
        -------
        Family
            D designs.

        Raises
        ------
        UnknownNameError, InputError
            If a name does not exist, or the arrays have different lengths.

        Examples
        --------
        >>> import linkwork as lw
        >>> family = lw.example("four-bar").family({"O2 A": [38, 40, 42]})
        >>> family.reduced(["stroke(rocker)"])["stroke(rocker)"].round(3)
        array([69.572, 73.782, 78.117])
        """
        return batch.family_of(self.model, dimensions)

    def cycle(
        self,
        *,
        configuration: str | None = None,
        certify: bool = True,
        progress: Callable[[float], None] | None = None,
    ) -> Motion:
        """The motion for displays.

        It is :meth:`sweep`, continued through dead points if the input does not reach its whole
        range.

        Parameters
        ----------
        configuration, certify, progress
            As in :meth:`sweep`.
        """
        motion = self.sweep(configuration=configuration, certify=certify, progress=progress)
        if motion.found.all() or not motion.found.any() or self.description.timed:
            return motion  # time does not turn back
        return self.sweep(
            configuration=configuration, through=True, certify=certify, progress=progress
        )

    def cycles(
        self, *, certify: bool = True, progress: Callable[[float], None] | None = None
    ) -> dict[str, Motion]:
        """The motions on all circuits, by the names of the circuits, that of the guess first.

        Parameters
        ----------
        certify, progress
            As in :meth:`sweep`.

        Examples
        --------
        >>> import linkwork as lw
        >>> {name: len(motion) for name, motion in lw.example("four-bar").cycles().items()}
        {'circuit 1': 361, 'circuit 2': 361}
        """
        found = {}
        circuits = self.circuits(certify=False)
        for k, circuit in enumerate(circuits):
            branch = circuit.branches[0].name
            found[circuit.name] = self.cycle(configuration=branch, certify=certify)
            if progress is not None:
                progress((k + 1) / len(circuits))
        return found
