"""A mechanism whose quantities are differentiated by its numbers."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from linkwork import design
from linkwork.api.dynamic import DynamicMechanism
from linkwork.core.foundation.errors import InputError
from linkwork.core.foundation.values import as_told

if TYPE_CHECKING:
    from linkwork.core.foundation.arrays import Array
    from linkwork.core.results.motion import Motion
    from linkwork.core.results.position import Position
    from linkwork.design.tolerance_results import Sensitivity, Tolerance
    from linkwork.synthesis.improvement.proved_design import ImprovedDesign

__all__ = ["DesignedMechanism"]


class DesignedMechanism(DynamicMechanism):
    """The part of :class:`~linkwork.api.mechanism.Mechanism` that helps to choose its numbers."""

    def sensitivity(
        self,
        of: str,
        at: float | Mapping[str, float] | None = None,
        *,
        by: Iterable[str] | None = None,
        configuration: str | None = None,
        motion: Motion | None = None,
    ) -> Sensitivity:
        """The derivatives of a quantity by the numbers of the mechanism, exact to rounding.

        With ``at`` those of a position at this input; without it those in all rows of the input's
        table. A number of a whole motion (``stroke(d)``, ``path_length(P)``, ``limit.upper`` for
        the dead point that ends the motion) has one derivative by each number.

        Parameters
        ----------
        of : str
            A quantity, a rate, or a number of a motion, see ``linkwork quantities``.
        at : number or Mapping[str, number], optional
            Input value(s) in file units.
        by : iterable of str, optional
            Numbers that a family can vary: ``"O2 A"``, ``"O4.x"``, ``"a2"``, ``"d.offset"``; by
            default all that the file writes as plain numbers.
        configuration : str, optional
            As in :meth:`solve`.
        motion : Motion, optional
            Instead of the table: a motion of this mechanism, solved already.

        Returns
        -------
        Sensitivity
            Its ``status`` says whether the derivatives exist.

        Raises
        ------
        UnknownNameError, InputError
            If a name is not known, or a number cannot vary alone.

        Examples
        --------
        >>> import linkwork as lw
        >>> found = lw.example("slider-crank").sensitivity("d", at=60)
        >>> found.effective[0], round(found["B A"], 6)
        ('B A', 1.123196)
        """
        if at is None and (
            self.description.inputs or motion is not None or design.is_of_motion(of)
        ):
            rows = self.sweep(configuration=configuration) if motion is None else motion
            if design.is_of_motion(of):
                return design.sensitivity_of_motion(self.model, rows, of, by)
            return design.sensitivity_of_rows(self.model, rows, of, by)
        if design.is_of_motion(of):
            raise InputError(f'"{of}" is a number of a whole motion: leave out at')
        position = self.solve(at, configuration=configuration)
        return design.sensitivity_of_position(self.model, position, of, by)

    def gradient(
        self,
        of: str,
        *,
        by: Iterable[str] | None = None,
        at: float | Mapping[str, float] | None = None,
        configuration: str | None = None,
        motion: Motion | None = None,
    ) -> dict[str, Array | float]:
        """The derivatives of :meth:`sensitivity` by name, (R,) each, or numbers; NaN where there is
        none.

        Parameters
        ----------
        of, by, at, configuration, motion
            As in :meth:`sensitivity`.

        Examples
        --------
        >>> import linkwork as lw
        >>> crank = lw.example("slider-crank")
        >>> rows = crank.gradient("d", by=["B A"])["B A"]
        >>> rows.shape, round(float(rows[60]), 6)
        ((361,), 1.123196)
        """
        found = self.sensitivity(of, at, by=by, configuration=configuration, motion=motion)
        return {name: found[name] for name in found.derivatives}

    def improve(
        self,
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
        >>> best = bar.improve(goal, vary=["A B", "O4 B"], starts=4)[0]
        >>> best.sound
        True
        >>> crank = lw.example("slider-crank")
        >>> goals = [{"of": "stroke(d)", "target": 70}, {"of": "max(d)", "target": 60}]
        >>> front = crank.improve(goals, vary=["O2 A"], front=2, starts=1)
        >>> [round(design.goals["stroke(d)"], 4) for design in front]
        [0.0, 49.7142]
        """
        wanted = (goal,) if isinstance(goal, Mapping) else tuple(goal)
        for one in wanted:
            if not isinstance(one, Mapping):
                raise InputError(
                    f'a goal is a table, {{"of": "stroke(d)", "target": 40}}, got {as_told(goal)}; '
                    'how misses count is fit = "least squares" or "minimax"'
                )
        settings = design.Improvement(
            vary=(vary,) if isinstance(vary, str) else tuple(vary),
            bounds=bounds or {},
            fit=fit,
            front=front,
            starts=starts,
            spread=spread,
            seed=seed,
        )
        goals = tuple(map(design.read_goal, wanted))
        return design.improved_designs(self.model, goals, settings, progress)

    def tolerance(
        self,
        of: str,
        at: float | Mapping[str, float] | None = None,
        *,
        deviations: Mapping[str, float] | None = None,
        clearances: Mapping[str, float] | None = None,
        samples: int = 0,
        seed: int = 1,
        configuration: str | None = None,
        motion: Motion | None = None,
    ) -> Tolerance:
        """What deviations of numbers and clearances of pins do to a quantity.

        Worst case, root sum square and the share of each are of first order; ``samples`` random
        designs are solved too, as a family.

        Parameters
        ----------
        of : str
            A quantity at a position, or a number of a whole motion: ``stroke(d)``.
        at : number or Mapping[str, number], optional
            Input value(s) in file units; by default those of the guess.
        deviations : Mapping[str, number], optional
            Standard deviations of numbers; by default those in the file's ``[tolerances]``.
        clearances : Mapping[str, number], optional
            Differences of the radii of hole and pin, by point; by default ``[clearances]``.
        samples : int
            Number of random designs.
        seed : int
            Equal seeds draw equal designs.
        configuration, motion
            As in :meth:`sensitivity`.

        Returns
        -------
        Tolerance

        Raises
        ------
        UnknownNameError, InputError
            If a name is not known, a deviation is negative, or none is given.

        Examples
        --------
        >>> import linkwork as lw
        >>> crank = lw.example("slider-crank")
        >>> found = crank.tolerance("d", at=60, deviations={"O2 A": 0.02, "B A": 0.05})
        >>> round(found.worst_case, 6), found.contributions[0].name
        (0.057301, 'B A')
        """
        given = design.deviations(self.model, deviations, clearances)
        solved: Motion | Position
        if design.is_of_motion(of):
            if at is not None:
                raise InputError(f'"{of}" is a number of a whole motion: leave out at')
            solved = self.sweep(configuration=configuration) if motion is None else motion
        else:
            solved = self.solve(at, configuration=configuration)
        return design.tolerance_of(self.model, solved, of, given, samples=samples, seed=seed)
