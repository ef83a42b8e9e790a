"""The main class: a mechanism that can be solved, swept, checked, drawn and exported."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from linkwork import app as viewer, families as batch
from linkwork.api import solving
from linkwork.api.reported import ReportedMechanism
from linkwork.core import drawing, motion, textfile
from linkwork.core.foundation.errors import InputError, internal
from linkwork.core.foundation.files import as_path, save_bytes
from linkwork.core.foundation.names import as_names
from linkwork.core.foundation.values import given_or
from linkwork.forces.results import Force

if TYPE_CHECKING:
    from linkwork.app.pages.page_data import SolvingPage
    from linkwork.core.results.motion import Motion

__all__ = ["Mechanism"]


@internal("description", "read", "solving_page")
class Mechanism(ReportedMechanism):
    """A planar mechanism: solve, sweep, check, draw, animate and export it.

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
        options: viewer.FilmOptions | None = None,
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
        kind = viewer.check_animation(path, options)
        if all_circuits and (motion is not None or kind != "html"):
            raise InputError("all circuits need the page of a mechanism: use the suffix .html")
        if forces and kind != "html":
            raise InputError("only a page shows forces: use the suffix .html")
        solver = None
        if sliders:
            if kind != "html" or all_circuits or motion is not None:
                raise InputError(
                    "sliders are for a page of one sweep: use the suffix .html, and leave out "
                    "motion and all_circuits"
                )
            motion = self.sweep(progress=progress)
            solver = self.solving_page(sliders, motion)
        motions = self._shown(motion, all_circuits, progress)
        content = viewer.animation(
            motions,
            kind,
            options=options,
            equations=self.equations().mathml(),
            loops=self.moving_loops,
            forces=forces,
            solver=solver,
            progress=progress,
        )
        save_bytes(content, path)

    def solving_page(self, sliders: Sequence[str], motion: Motion) -> SolvingPage:
        """The solver for a page that shows a sweep with sliders; see :meth:`animate`."""
        if not motion.found.any():
            raise InputError("there is no motion to change with sliders: no position was found")
        design = batch.record_design(self.model, as_names("sliders", sliders))
        return solving.solving_page(design, motion, design.changed())

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
        if all_circuits and motion is not None:
            raise InputError("a widget shows either the given motion or all circuits, not both")
        motions = self._shown(motion, all_circuits)
        equations = self.equations().mathml()
        return viewer.motions_widget(
            motions, equations=equations, loops=self.moving_loops, forces=forces
        )

    def _shown(
        self,
        motion: Motion | None,
        all_circuits: bool,
        progress: Callable[[float], None] | None = None,
    ) -> dict[str, Motion]:
        """The displayed motions, by name."""
        if all_circuits:
            return self.cycles(progress=progress)
        return {"motion": self.cycle() if motion is None else motion}

    def _repr_html_(self) -> str:
        """A picture of the start and a short table, for notebooks."""
        return viewer.mechanism_html(
            repr(self).strip("<>"), self.solve(), self.equations().mathml()
        )

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
