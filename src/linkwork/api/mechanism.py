"""The friendly face: a mechanism that can be solved, swept, checked, shown and drawn."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from linkwork import drawing, export, motion, textfile, viewer
from linkwork.api.solvable import SolvableMechanism
from linkwork.foundation.errors import InputError
from linkwork.results.force import Force
from linkwork.results.motion import Motion

__all__ = ["Mechanism"]


class Mechanism(SolvableMechanism):
    """A planar mechanism.

    Made by :func:`load`, :func:`example`, :func:`linkage`, :func:`loops` or
    :func:`plain_equations`. Immutable: changing a dimension gives a new mechanism.

    Parameters
    ----------
    description : Description
        What is asked: points and links, loop equations, or plain equations.

    Raises
    ------
    MechanismError
        If the equations cannot be written or do not determine the motion.
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
        """A picture of one position with the traces of points over the cycle.

        Parameters
        ----------
        at, configuration
            Which position, as in :meth:`solve`; the cycle is the one through it.
        vectors : bool
            Show the loop equations as vectors over the mechanism.
        traces : sequence of str, optional
            The points whose paths are shown; those of the file's ``[trace]`` unless given.
        options : SceneOptions, optional
            What else to show; see :class:`linkwork.drawing.SceneOptions`.
        """
        position = self.solve(at, configuration=configuration, throw=True)
        chosen = options or drawing.SceneOptions()
        if vectors:
            chosen = replace(chosen, vectors=motion.vector_loops(self.model, position))
        if not self.description.inputs:
            return drawing.scene_of(position, traces=traces, options=chosen)
        model = self.model if configuration is None else self.model.from_position(position)
        cycle = motion.sweep(model, progress=progress)
        found = cycle if cycle.found.any() else None
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
        theme : str
            Colours of the page: ``light`` or ``dark``.
        """
        colours = drawing.theme_named(theme, drawing.THEMES)
        scene = self.scene(
            at, configuration=configuration, vectors=vectors, traces=traces, options=options
        )
        drawing.write(scene, Path(path), theme=colours)

    def animate(
        self,
        path: str | Path,
        motion: Motion | None = None,
        *,
        all_circuits: bool = False,
        forces: Sequence[Force] = (),
        options: viewer.FilmOptions | None = None,
        progress: Callable[[float], None] | None = None,
    ) -> None:
        """Write the motion to a file that moves.

        A page (.html) works offline, in any browser, without Linkwork: play, drag the crank,
        plots, numbers with their proof. Films are .gif, .apng, .webp (with Pillow) and .mp4
        (with ffmpeg).

        Parameters
        ----------
        path : str or Path
            The suffix chooses the format.
        motion : Motion, optional
            A sweep of this mechanism; that of the guess around its circuit unless given.
        all_circuits : bool
            Let a page show all circuits, to choose from.
        forces : sequence of Force
            Let a page show them as arrows at their points.
        options : FilmOptions, optional
            Pictures a second, rows, size of a film.

        Raises
        ------
        InputError
            If the suffix names no known format, there is nothing to draw, or forces are not for it.
        UnknownNameError
            If there is no point that a force is at.
        MissingPackageError
            Without what writes the format.
        """
        kind = viewer.check_animation(path, options)
        if all_circuits and (motion is not None or kind != "html"):
            raise InputError("all circuits need the page of a mechanism: use the suffix .html")
        if forces and kind != "html":
            raise InputError("only a page shows forces: use the suffix .html")
        motions = self._shown(motion, all_circuits, progress)
        content = viewer.animation(
            motions,
            kind,
            options=options,
            equations=self.equations().mathml(),
            loops=self.moving_loops,
            forces=forces,
            progress=progress,
        )
        Path(path).write_bytes(content)

    def widget(
        self,
        motion: Motion | None = None,
        *,
        all_circuits: bool = False,
        forces: Sequence[Force] = (),
    ) -> Any:
        """The motion in a notebook, to play and to drag; needs the extra ``notebook``.

        Parameters
        ----------
        motion : Motion, optional
            A sweep of this mechanism; that of the guess around its circuit unless given.
        all_circuits : bool
            Show all circuits, to choose from.
        forces : sequence of Force
            Show them as arrows at their points.

        Returns
        -------
        anywidget.AnyWidget
            ``configuration`` and ``row`` are what is shown, and can be set; see
            :func:`linkwork.viewer.motions_widget`.

        Raises
        ------
        InputError
            If there is nothing to draw.
        MissingPackageError
            Without anywidget.
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
        """The motions that are shown, by name."""
        if all_circuits:
            return self.cycles(progress=progress)
        return {"motion": self.cycle() if motion is None else motion}

    def _repr_html_(self) -> str:
        """A picture of the start and a short table, for notebooks."""
        return viewer.mechanism_html(
            repr(self).strip("<>"), self.solve(), self.equations().mathml()
        )

    def to_excel(self, path: str | Path, motion: Motion | None = None) -> tuple[str, ...]:
        """Write a sweep as an Excel workbook whose formulas solve it again.

        Parameters
        ----------
        path : str or Path
            Name of the .xlsx file.
        motion : Motion, optional
            A sweep of this mechanism; :meth:`sweep` unless given.

        Returns
        -------
        tuple of str
            What in the workbook is values only, and does not follow its dimensions.

        Raises
        ------
        InputError
            If the name is no .xlsx, or the motion is not this mechanism's.
        MissingPackageError
            Without XlsxWriter.
        """
        if Path(path).suffix.lower() != ".xlsx":
            raise InputError(f'cannot write "{path}": a workbook needs the suffix .xlsx')
        cycle = self.sweep() if motion is None else motion
        written = export.workbook_of(self.model, cycle)
        Path(path).write_bytes(written.content)
        return written.notices

    def save(self, path: str | Path) -> None:
        """Write the mechanism as a TOML file."""
        textfile.save(self.description, Path(path))
