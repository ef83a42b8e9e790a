"""The main class: a mechanism that can be solved, swept, checked, drawn and written."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self

from linkwork import wings
from linkwork.core import drawing, motion, textfile
from linkwork.core.equations.model import LoopEquations
from linkwork.core.equations.writing import EquationSheet
from linkwork.core.foundation.errors import InputError, MechanismError, internal, key_text
from linkwork.core.foundation.files import as_path
from linkwork.core.foundation.values import as_told, given_or
from linkwork.core.mechanism.description import Description, made_of, merged
from linkwork.core.mechanism.dimensions import Number
from linkwork.core.mechanism.inputs import Input
from linkwork.core.mechanism.varied_numbers import numbers_named, with_numbers
from linkwork.core.numerics.newton import NewtonOptions
from linkwork.core.results.position import Position

if TYPE_CHECKING:
    from linkwork.app.pages.animation import FilmOptions
    from linkwork.circuits.results import Circuits, Configurations
    from linkwork.core.drawing.annotations import Force
    from linkwork.core.results.check import CheckReport
    from linkwork.core.results.motion import Motion
    from linkwork.core.results.position import Iterates
    from linkwork.families.family import Family
    from linkwork.forces.results import Reactions


@internal("description", "read", "loop_equations", "place")
class Mechanism:
    """A planar mechanism: solve, sweep, check, draw, animate and write it.

    The functions :func:`load`, :func:`loads`, :func:`example`, :func:`linkage`, :func:`loops` and
    :func:`plain_equations` make mechanisms. A mechanism is immutable: every change returns a new
    one.

    Parameters
    ----------
    description : Description
        Points and links, loop equations, or plain equations.
    read : ReadFile, optional
        The file that the description was read from, for line numbers in messages.

    Raises
    ------
    MechanismError
        If the equations cannot be derived, or do not determine the motion.

    Examples
    --------
    >>> import linkwork as lw
    >>> bar = lw.example("four-bar")
    >>> bar
    <Mechanism "Four-bar linkage, open": 1 equation for coupler, rocker; driven by crank>
    >>> round(bar.solve(at=60)["rocker"], 3)
    64.943
    >>> len(bar.sweep(step=30))
    13
    """

    def __init__(self, description: Description, read: textfile.ReadFile | None = None) -> None:
        self.description, self.read = description, read
        try:
            self.model = motion.as_described(description)
        except MechanismError as error:
            if read is None:
                raise
            raise read.located(error) from None

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Mechanism) and self.description == other.description

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

    def _repr_html_(self) -> str:
        """A picture of the start and a short table, for notebooks."""
        return wings.use("app.pages.notebook").mechanism_html(
            repr(self).strip("<>"), self.solve(), self.equations().mathml()
        )

    @property
    def name(self) -> str:
        """The name of the mechanism."""
        return self.description.name

    @property
    def loop_equations(self) -> LoopEquations:
        """The closure equations as symbols."""
        return self.model.equations

    def check(self) -> CheckReport:
        """How the mechanism was read: equations, unknowns, blocks, mobility, start.

        Examples
        --------
        >>> import linkwork as lw
        >>> print(lw.example("four-bar").check().classification.type)
        crank-rocker (GCRR): Grashof, s + l < p + q by 20 mm
        """
        return motion.check(self.model)

    def equations(self) -> EquationSheet:
        """The loop equations and their Jacobian as text, LaTeX or MathML.

        Examples
        --------
        >>> import linkwork as lw
        >>> print(lw.example("four-bar").equations().text().splitlines()[0])
        unknowns  θ_coupler (angle), θ_rocker (angle)
        """
        return EquationSheet(self.model.equations)

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
            return wings.use("circuits.circuit_list").solve_configuration(
                self.model, at, configuration, throw=throw
            )
        return motion.solve(
            self.model,
            at,
            from_guess=from_guess,
            options=options,
            certify=certify,
            with_steps=with_steps,
            throw=throw,
        )

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

    def sweep(
        self,
        *,
        from_: Number | None = None,
        to: Number | None = None,
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
        from_, to, step : number, optional
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
        >>> motion = lw.example("four-bar").sweep(from_=0, to=360, step=90)
        >>> motion["rocker"].round(2)
        array([ 62.72,  80.26, 121.19, 123.86,  62.72])
        """
        model = self.model
        # another range keeps the start position, which is on the branch of the guess
        if not (from_ is None and to is None and step is None):
            model = motion.model_of(self.description.with_range(from_, to, step))
            model = model.from_start_of(self.model)
        if configuration is not None:
            model = wings.use("circuits.circuit_list").start_in_configuration(model, configuration)
        return motion.sweep(
            model,
            through=through,
            change_points=change_points,
            limits_of=limits_of,
            certify=certify,
            options=options,
            progress=progress,
        )

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

    def configurations(self, at: float | Mapping[str, float] | None = None) -> Configurations:
        """All assembly configurations at one input value, each with its certificate.

        Blocks of one loop are solved in closed form, larger blocks by homotopy continuation.

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
        return wings.use("circuits.circuit_list").configurations(self.model, at)

    def circuits(
        self, *, certify: bool = True, progress: Callable[[float], None] | None = None
    ) -> Circuits:
        """All circuits with their branches.

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
        return wings.use("circuits.circuit_list").circuits(
            self.model, certify=certify, progress=progress
        )

    def forces(
        self,
        at: float | Mapping[str, float] | None = None,
        *,
        configuration: str | None = None,
        motion: Motion | None = None,
    ) -> Reactions:
        """Efforts of the inputs and reactions of the joints, from masses, loads and springs.

        Without ``at`` over the input's table; of a structure in its position. With a speed of
        the input, masses have inertia; without one the mechanism is at rest. See
        :mod:`linkwork.forces.reactions`.

        Parameters
        ----------
        at : number or Mapping[str, number], optional
            Input value(s) in file units.
        configuration : str, optional
            As in :meth:`solve`.
        motion : Motion, optional
            Instead of the table: a motion of this mechanism, solved already.

        Returns
        -------
        Reactions
            ``["crank.effort"]``, ``["A.force.x"]``, …; its ``status`` says whether they exist.

        Raises
        ------
        InputError
            If nothing loads the mechanism.

        Examples
        --------
        >>> import linkwork as lw
        >>> press = lw.example("crank-press")
        >>> round(press.forces(at=60)["crank.effort"])
        3644
        """
        forces = wings.use("forces.reactions.solving")
        if at is not None or not self.model.equations.inputs:
            position = self.solve(at, configuration=configuration)
            return forces.forces_of_position(self.model, position, self.place)
        rows = self.sweep(configuration=configuration) if motion is None else motion
        return forces.forces_of_motion(self.model, rows, self.place)

    def simulate(
        self,
        until: float,
        *,
        step: float | None = None,
        at: float | Mapping[str, float] | None = None,
        start_speed: Number | Mapping[str, Number] = 0,
        change_points: str = "stop",
        certify: bool = True,
        progress: Callable[[float], None] | None = None,
    ) -> Motion:
        """The motion in time under masses, loads, springs, a motor and stops; see
        :mod:`linkwork.forces.dynamics`.

        Inputs with a law follow it, the others are free: they start at ``at`` with
        ``start_speed``. Friction of joints takes the energy ``friction_work`` of the motion, and
        can hold the mechanism at rest; with several inputs it is refused.

        Parameters
        ----------
        until : float
            The last time [s].
        step : float, optional
            Between rows [s]; by default 400 rows. Events add rows: stops, switched loads.
        at : number or Mapping[str, number], optional
            The input value at the start, in file units; by default that of the guess.
        start_speed : str, number or Mapping[str, str or number]
            Of the input: ``"60 rad/s"``; a number is in file units per second. Of several inputs
            by name; those that are not named begin at rest.
        change_points : str
            ``stop`` at a change point, or go ``straight`` on.
        certify : bool
            Prove the positions of all rows.
        progress : callable, optional
            Called with the finished fraction, 0 to 1.

        Returns
        -------
        Motion
            Rows over the time ``t``, with all quantities and rates; ``message`` says how it ended.

        Raises
        ------
        InputError
            If nothing has mass, there is no input, or laws drive all of them; for friction in
            joints whose forces redundant links leave undetermined.

        Examples
        --------
        >>> import linkwork as lw
        >>> pendulum = lw.linkage(
        ...     length="m", points={"O": (0, 0), "A": (-1, 0)},
        ...     links={"ground": ["O"], "bar": ["O", "A"]}, inputs=lw.Input(link="bar"),
        ...     masses={"bar": lw.Mass(mass=1, center=(1, 0))}, gravity=lw.Gravity(),
        ... )
        >>> motion = pendulum.simulate(until=10, step=1)
        >>> round(float(motion["A.x"][-1]), 12)
        -0.275087462576
        """
        return wings.use("forces.dynamics.simulation").simulate(
            self.model,
            until=until,
            step=step,
            at=at,
            start_speed=start_speed,
            change_points=change_points,
            certify=certify,
            place=self.place,
            progress=progress,
        )

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
        return wings.use("families.family").family_of(self.model, dimensions)

    def with_dimensions(
        self, changes: Mapping[str, Number] | None = None, /, **more: Number
    ) -> Self:
        """A copy with other values of dimensions, lengths and all other numbers of the description.

        Parameters
        ----------
        changes : Mapping[str, number or formula], optional
            New values by name, in the unit of the file: the names that a family varies, as
            ``"O2 A"``, ``"O4.x"`` or ``"s16.offset"``.
        **more : number or formula
            The same, for names that Python can write.

        Raises
        ------
        UnknownNameError
            If there is no such number.
        InputError
            If a number is given twice.

        Examples
        --------
        >>> import linkwork as lw
        >>> lw.example("crank-shaper").with_dimensions(r=50).description.dimensions["r"]
        50
        >>> lw.example("four-bar").with_dimensions({"O2 A": 38}).description.lengths["O2 A"]
        38
        """
        if changes is not None and not isinstance(changes, Mapping):
            raise InputError(
                'dimensions are given by name, as with_dimensions({"O2 A": 38}) or '
                f"with_dimensions(r=50), got {as_told(changes)}"
            )
        numbers = numbers_named(self.description, [*(changes or {}).items(), *more.items()])
        return type(self)(with_numbers(self.description, numbers))

    def changed(self, **parts: Any) -> Self:
        """A copy with other parts of the description.

        Parameters
        ----------
        **parts
            Fields of the description, as in :func:`linkage` or :func:`loops`: ``points``,
            ``lengths``, ``guess``, … Entries of such tables join those that exist, ``None`` removes
            the one of its name, an empty table all; lists replace lists.

        Raises
        ------
        UnknownNameError
            For a field, or an entry to be removed, that does not exist.
        MechanismError
            With every problem found.

        Examples
        --------
        >>> import linkwork as lw
        >>> longer = lw.example("four-bar").changed(lengths={"O2 A": 42})
        >>> dict(longer.description.lengths)
        {'O2 A': 42, 'A B': 120, 'O4 B': 80, 'O2 O4': 100}
        >>> round(longer.solve(at=60)["rocker"], 3)
        63.482
        """
        return type(self)(replace(self.description, **merged(self.description, parts)))

    def driven_by(self, **fields: Any) -> Self:
        """A copy with another input.

        Parameters
        ----------
        **fields
            Fields of :class:`linkwork.Input`: ``link="rocker"``, ``from_=0``, …

        Examples
        --------
        >>> import linkwork as lw
        >>> lw.example("four-bar").driven_by(link="rocker")
        <Mechanism "Four-bar linkage, open": 1 equation for crank, coupler; driven by rocker>
        """
        return type(self)(
            wings.use("circuits.inverting").driven_otherwise(self.model, made_of(Input, fields))
        )

    def inversion(self, link: str, *, input: Input | None = None) -> Self:
        """The same kinematic chain with another link as ground; the old ground becomes ``frame``.

        Parameters
        ----------
        link : str
            The link that becomes the ground.
        input : Input, optional
            The new input; by default the same relative angle or length as before.

        Raises
        ------
        UnknownNameError
            If the link does not exist.
        InputError
            If the link cannot be the ground.

        Examples
        --------
        >>> import linkwork as lw
        >>> lw.example("four-bar").inversion("coupler").name
        'Four-bar linkage, open, coupler fixed'
        """
        return type(self)(wings.use("circuits.inverting").inversion(self.model, link, input))

    def scene(
        self,
        at: float | Mapping[str, float] | None = None,
        *,
        configuration: str | None = None,
        vectors: bool = False,
        traces: Sequence[str] | None = None,
        options: drawing.SceneOptions | None = None,
        progress: Callable[[float], None] | None = None,
    ) -> drawing.Scene:
        """The drawing of one position, with the paths of traced points over the cycle.

        Parameters
        ----------
        at : number or Mapping[str, number], optional
            Input value(s) in file units, as in :meth:`solve`; by default round values near those of
            the guess.
        configuration : str, optional
            The configuration or branch to draw, as in :meth:`solve`; also selects the cycle.
        vectors : bool
            Whether to draw the loop equations as vectors.
        traces : sequence of str, optional
            The points whose paths are drawn; by default those of the file's ``[trace]``.
        options : SceneOptions, optional
            Further contents; see :class:`linkwork.core.drawing.SceneOptions`.
        progress : callable, optional
            Called with the finished fraction of the cycle, 0 to 1.

        Returns
        -------
        Scene
            Primitives in the mechanism's unit of length.

        Raises
        ------
        NotConvergedError
            If there is no position at this input value.
        UnknownNameError
            If a point or configuration does not exist.

        Examples
        --------
        >>> import linkwork as lw
        >>> lw.example("four-bar").scene(at=60).caption
        'crank = 60°'
        """
        position = self.solve(at, configuration=configuration, throw=True)
        chosen = given_or(drawing.SceneOptions(), "options", options)
        found = None
        if self.description.inputs:
            model = self.model if configuration is None else self.model.from_position(position)
            cycle = motion.sweep(model, progress=progress)
            found = cycle if cycle.found.any() else None
            if at is None:
                position = motion.solve_round_start(model, cycle, position)
        if vectors:
            chosen = replace(chosen, vectors=motion.vector_loops(self.model, position))
        return drawing.scene_of(position, found, traces=traces, options=chosen)

    def draw(
        self,
        path: str | Path,
        at: float | Mapping[str, float] | None = None,
        *,
        configuration: str | None = None,
        vectors: bool = False,
        traces: Sequence[str] | None = None,
        options: drawing.SceneOptions | None = None,
        theme: str = "light",
    ) -> None:
        """Draw one position to a PNG, SVG or PDF file; see :meth:`scene`.

        Parameters
        ----------
        path : str or Path
            The file; its suffix selects the format.
        at, configuration, vectors, traces, options
            As in :meth:`scene`.
        theme : str
            Colours of the drawing: ``light`` or ``dark``.

        Raises
        ------
        InputError
            If the format is unknown, or the mechanism has no points.
        MissingPackageError
            If Matplotlib is not installed.
        """
        colours = drawing.theme_named(theme, drawing.THEMES)
        scene = self.scene(
            at, configuration=configuration, vectors=vectors, traces=traces, options=options
        )
        drawing.write(scene, as_path(path), theme=colours)

    def animate(
        self,
        path: str | Path,
        motion: Motion | None = None,
        *,
        all_circuits: bool = False,
        forces: Sequence[Force] = (),
        sliders: Sequence[str] = (),
        options: FilmOptions | None = None,
        progress: Callable[[float], None] | None = None,
    ) -> None:
        """Write the motion as an animated page or a film.

        A page (.html) works offline in any browser, without Linkwork: it plays the motion, follows
        the dragged crank, and shows plots and certified numbers. Films are .gif, .apng, .webp (with
        Pillow) and .mp4 (with ffmpeg).

        Parameters
        ----------
        path : str or Path
            The file; its suffix selects the format.
        motion : Motion, optional
            A sweep of this mechanism; by default :meth:`cycle`.
        all_circuits : bool
            Whether a page contains all circuits.
        forces : sequence of Force
            Forces that a page draws as arrows at their points.
        sliders : sequence of str
            Numbers of the mechanism, by the names that :meth:`family` takes, that can be changed in
            a page: it contains the solver of this mechanism, and proves every position that it
            draws. It shows :meth:`sweep`.
        options : FilmOptions, optional
            Frames per second, number of positions and size of a film.
        progress : callable, optional
            Called with the finished fraction, 0 to 1.

        Raises
        ------
        InputError
            If the suffix is unknown, there is nothing to draw, an option does not fit the
            format, or a page cannot solve the mechanism with these sliders.
        UnknownNameError
            If a force is at a point that does not exist, or a slider's number does not exist.
        MissingPackageError
            If the package that writes the format is not installed.
        """
        wings.use("app.pages.animation").animate(
            self,
            path,
            motion,
            all_circuits=all_circuits,
            forces=forces,
            sliders=sliders,
            options=options,
            progress=progress,
        )

    def widget(
        self,
        motion: Motion | None = None,
        *,
        all_circuits: bool = False,
        forces: Sequence[Force] = (),
    ) -> Any:
        """The motion as a notebook widget; needs the extra ``notebook``.

        Parameters
        ----------
        motion : Motion, optional
            A sweep of this mechanism; by default :meth:`cycle`.
        all_circuits : bool
            Whether the widget contains all circuits.
        forces : sequence of Force
            Forces drawn as arrows at their points.

        Returns
        -------
        anywidget.AnyWidget
            Its traits ``configuration`` and ``row`` select the displayed position and can be set;
            see :func:`linkwork.app.motions_widget`.

        Raises
        ------
        InputError
            If there is nothing to draw, or both ``motion`` and ``all_circuits`` are given.
        MissingPackageError
            If anywidget is not installed.
        """
        return wings.use("app.pages.notebook").widget(
            self, motion, all_circuits=all_circuits, forces=forces
        )

    def write(self, path: str | Path, kind: str | None = None, **options: Any) -> Any:
        """Write the mechanism for another program, a workshop, a robot or a reader.

        Parameters
        ----------
        path : str or Path
            The file; its suffix selects the kind: ``.xlsx`` a workbook whose formulas solve the
            cycle again, ``.py``, ``.m``, ``.c``, ``.js``, ``.st`` a program, ``.dxf``, ``.stl``,
            ``.3mf``, ``.step`` plates, ``.mjcf``, ``.sdf``, ``.urdf`` a robot, ``.html``,
            ``.pdf``, ``.docx``, ``.md`` a report.
        kind : str, optional
            Instead: ``workbook``, ``program``, ``plates``, ``robot``, ``report``, ``pmks``,
            ``pylinkage``, ``pyslvs``.
        **options
            Those of the kind: of ``write_plates``, ``write_report``, … in :mod:`linkwork.writers`.

        Returns
        -------
        Any
            What that function returns: notices, the stack of plates, the files of a report.

        Raises
        ------
        InputError
            If no kind has this suffix or name, an option does not belong to it, or the file cannot
            be written.
        MissingPackageError
            If the package that writes the format is not installed.

        Examples
        --------
        >>> import linkwork as lw, pathlib, tempfile
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     lw.example("four-bar").write(f"{folder}/four_bar.py")
        ...     lines = pathlib.Path(folder, "four_bar.py").read_text().splitlines()
        >>> lines[1]
        'Four-bar linkage, open.'
        """
        return wings.use("writers").write(self, path, kind, **options)

    def save(self, path: str | Path) -> None:
        """Write the mechanism as a TOML file.

        Parameters
        ----------
        path : str or Path
            The file, which is overwritten.

        Raises
        ------
        InputError
            If the file cannot be written.

        Examples
        --------
        >>> import linkwork as lw, pathlib, tempfile
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     lw.example("four-bar").save(pathlib.Path(folder) / "bar.toml")
        """
        textfile.save(self.description, as_path(path))

    def link(self, app: str | None = None) -> str:
        """The mechanism packed into a link; the server of the app never receives it.

        Parameters
        ----------
        app : str, optional
            The address of a Linkwork app, as ``https://example.org/linkwork/``. Without it, the
            result is the fragment ``#lw1=…`` alone, to append to such an address.

        Returns
        -------
        str
            The text that :meth:`save` writes, compressed; :func:`linkwork.load` and every command
            read it.

        Raises
        ------
        InputError
            If ``app`` is not the address of a page, or the mechanism is too large for a link.

        Examples
        --------
        >>> import linkwork as lw
        >>> bar = lw.example("four-bar")
        >>> bar.link(app="https://example.org/linkwork/")[:34]
        'https://example.org/linkwork/#lw1='
        >>> lw.load(bar.link()).description == bar.description
        True
        """
        return textfile.link_of(textfile.write_text(self.description), app)

    def place(self, key: Sequence[str | int]) -> str:
        """Where a key of the description is found: file and line, if it was read."""
        if self.read is None:
            return key_text(key)
        return f"{self.read.name} line {self.read.lines.line(tuple(key))}, {key_text(key)}"
