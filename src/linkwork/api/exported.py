"""The mechanism as a file of other programs: workbooks, programs, robots, plates."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from linkwork import readers as exchange, writers as export
from linkwork.api.designed import DesignedMechanism
from linkwork.core.foundation.errors import InputError
from linkwork.core.foundation.files import as_path, save_bytes, save_text
from linkwork.core.foundation.values import check_flags, given_or
from linkwork.core.mechanism.linkage import Linkage
from linkwork.readers.assembly import Exported

if TYPE_CHECKING:
    from linkwork.core.results.motion import Motion

__all__ = ["ExportedMechanism"]


class ExportedMechanism(DesignedMechanism):
    """A mechanism that can be written for other programs."""

    def to_excel(self, path: str | Path, motion: Motion | None = None) -> tuple[str, ...]:
        """Write a sweep as an Excel workbook whose formulas solve the cycle again.

        Parameters
        ----------
        path : str or Path
            The .xlsx file.
        motion : Motion, optional
            A sweep of this mechanism; by default :meth:`sweep`.

        Returns
        -------
        tuple of str
            The parts of the workbook that contain values only and do not recalculate.

        Raises
        ------
        InputError
            If the suffix is not .xlsx, the motion belongs to another mechanism, or the file cannot
            be written.
        MissingPackageError
            If XlsxWriter is not installed.
        """
        if as_path(path).suffix.lower() != ".xlsx":
            raise InputError(f'cannot write "{path}": a workbook needs the suffix .xlsx')
        cycle = self.sweep() if motion is None else motion
        written = export.workbook_of(self.model, cycle)
        save_bytes(written.content, path)
        return written.notices

    def to_code(self, path: str | Path, motion: Motion | None = None) -> None:
        """Write the solver as a program in another language, which needs no Linkwork.

        Parameters
        ----------
        path : str or Path
            The file; its suffix selects the language: ``.py`` (NumPy), ``.m`` (Octave, MATLAB),
            ``.c`` (C99), ``.js``, ``.st`` (structured text of IEC 61131-3).
        motion : Motion, optional
            A sweep of this mechanism, whose table the program computes again; by default
            :meth:`sweep`.

        Raises
        ------
        InputError
            If there is no such language, no formulas of the mechanism's equations, or the file
            cannot be written.

        Examples
        --------
        >>> import linkwork as lw, pathlib, tempfile
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     lw.example("four-bar").to_code(f"{folder}/four_bar.py")
        ...     lines = pathlib.Path(folder, "four_bar.py").read_text().splitlines()
        >>> lines[1]
        'Four-bar linkage, open.'
        """
        cycle = self.sweep() if motion is None else motion
        text = export.code_of(self.model, cycle, as_path(path))
        save_text(text, path)

    def exported(
        self,
        format: str,
        at: float | Mapping[str, float] | None = None,
        *,
        configuration: str | None = None,
    ) -> Exported:
        """The mechanism as a text of another program: pins, and slots or sliders.

        Parameters
        ----------
        format : str
            ``pmks`` (a link of PMKS+, coordinates in thousandths), ``pylinkage`` (JSON) or
            ``pyslvs`` (an expression).
        at : float or mapping, optional
            The input of the position that is written; by default that of :meth:`solve`.
        configuration : str, optional
            The configuration of that position.

        Returns
        -------
        Exported
            The text, and what it leaves out; :func:`imported` reads it back.

        Raises
        ------
        InputError
            If the format is not written, or has no equivalent of a part.
        NotConvergedError
            If there is no position at this input value.

        Examples
        --------
        >>> import linkwork as lw
        >>> lw.example("hoeken").exported("pmks").text.partition("?")[0]
        'https://app.pmksplus.com/'
        """
        linkage = self.description
        if not isinstance(linkage, Linkage):
            raise InputError(
                f'mechanism "{self.name}" is given by equations: other programs need points and '
                "links"
            )
        start = self.solve(at, configuration=configuration, throw=True)
        places = {name: complex(*start.points[name]) for name in linkage.points}
        return exchange.write_foreign(linkage, places, format)

    def to_robot(
        self,
        path: str | Path,
        at: float | Mapping[str, float] | None = None,
        *,
        configuration: str | None = None,
        motion: Motion | None = None,
    ) -> None:
        """Write the mechanism for a simulator of robots.

        Parameters
        ----------
        path : str or Path
            The file; its suffix selects the format: ``.mjcf`` (MuJoCo, with the real loops),
            ``.sdf`` (with all joints), ``.urdf`` (a tree whose joints follow the driven one).
        at : float or mapping, optional
            The input of the start position, at which all joint values are zero; by default that of
            :meth:`solve`.
        configuration : str, optional
            The configuration of the start position.
        motion : Motion, optional
            Of URDF, the sweep through the start position that gives limits and polynomials; by
            default :meth:`sweep`.

        Raises
        ------
        InputError
            If there is no such format, no start position, no equivalent of a part, or the file
            cannot be written.

        Examples
        --------
        >>> import linkwork as lw, pathlib, tempfile
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     lw.example("four-bar").to_robot(f"{folder}/bar.mjcf", at=60)
        ...     text = pathlib.Path(folder, "bar.mjcf").read_text("utf-8")
        >>> text.count("<joint "), text.count("<connect ")
        (3, 1)
        """
        suffix = export.check_robot_file(as_path(path))
        start = self.solve(at, configuration=configuration)
        if suffix == ".urdf" and motion is None:
            motion = self.sweep(configuration=configuration)
        text = export.robot_of(self.model, start, motion, as_path(path))
        save_text(text, path)

    def to_plates(
        self,
        path: str | Path,
        motion: Motion | None = None,
        *,
        options: export.PlateOptions | None = None,
        layout: bool = False,
        progress: Callable[[float], None] | None = None,
    ) -> export.PlateStack:
        """Write the links as plates to cut or print, in layers in which nothing collides.

        Parameters
        ----------
        path : str or Path
            The file; its suffix selects the format: ``.dxf``, ``.svg``, ``.stl``, ``.3mf`` or
            ``.step``.
        motion : Motion, optional
            The sweep in which nothing may collide; by default :meth:`sweep`.
        options : PlateOptions, optional
            Widths, pins, clearance, kerf and thickness.
        layout : bool
            Put the plates side by side on a sheet; otherwise they are assembled.
        progress : callable, optional
            Called with the finished fraction, 0 to 1.

        Returns
        -------
        PlateStack
            The layers, the bill of materials, and what is proved of collisions.

        Raises
        ------
        InputError
            If a part cannot be made of plates, there is no order of layers, or the file cannot be
            written.
        MissingPackageError
            If the package that writes the format is not installed.

        Examples
        --------
        >>> import linkwork as lw, tempfile
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     stack = lw.example("slider-crank").to_plates(f"{folder}/plates.dxf", layout=True)
        >>> stack.layers, stack.proved
        (3, True)
        """
        file, chosen = as_path(path), given_or(export.PlateOptions(), "options", options)
        check_flags(progress, layout=layout)
        export.check_plate_file(file)
        cycle = self.sweep() if motion is None else motion
        stack = export.stack_of(self.model, cycle, chosen, progress)
        save_bytes(export.plates_of(stack, file, layout=layout), path)
        return stack
