"""Files for other programs, for the shop, robots and readers, in one registry."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from linkwork import wings
from linkwork.core.api.mechanism import Mechanism
from linkwork.core.foundation.errors import InputError, UnknownNameError, choices
from linkwork.core.foundation.files import as_path, save_bytes, save_text
from linkwork.core.foundation.values import check_flags, given_or
from linkwork.core.results.motion import Motion
from linkwork.readers.importing import exported
from linkwork.writers.code.languages import code_of
from linkwork.writers.plates.files import check_plate_file, plates_of
from linkwork.writers.plates.plate import PlateOptions, PlateStack
from linkwork.writers.plates.stack import stack_of
from linkwork.writers.report.gathering import write_report
from linkwork.writers.robot.files import check_robot_file, robot_of
from linkwork.writers.workbook.workbook import workbook_of


@dataclass(frozen=True, kw_only=True)
class Writer:
    """A kind of file: the suffixes that select it, and its function of a mechanism and a path."""

    suffixes: tuple[str, ...] = ()
    write: Callable[..., Any]


def write_workbook(
    mechanism: Mechanism, path: str | Path, motion: Motion | None = None
) -> tuple[str, ...]:
    """Write a sweep as an Excel workbook whose formulas solve the cycle again.

    Parameters
    ----------
    path : str or Path
        The .xlsx file.
    motion : Motion, optional
        A sweep of this mechanism; by default :meth:`~linkwork.Mechanism.sweep`.

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

    Examples
    --------
    >>> import linkwork as lw, tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     lw.example("four-bar").write(f"{folder}/bar.xlsx")
    ()
    """
    if as_path(path).suffix.lower() != ".xlsx":
        raise InputError(f'cannot write "{path}": a workbook needs the suffix .xlsx')
    cycle = mechanism.sweep() if motion is None else motion
    written = workbook_of(mechanism.model, cycle)
    save_bytes(written.content, path)
    return written.notices


def write_program(mechanism: Mechanism, path: str | Path, motion: Motion | None = None) -> None:
    """Write the solver as a program in another language, which needs no Linkwork.

    Parameters
    ----------
    path : str or Path
        The file; its suffix selects the language: ``.py`` (NumPy), ``.m`` (Octave, MATLAB),
        ``.c`` (C99), ``.js``, ``.st`` (structured text of IEC 61131-3).
    motion : Motion, optional
        A sweep of this mechanism, whose table the program computes again; by default
        :meth:`~linkwork.Mechanism.sweep`.

    Raises
    ------
    InputError
        If there is no such language, no formulas of the mechanism's equations, or the file
        cannot be written.

    Examples
    --------
    >>> import linkwork as lw, pathlib, tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     lw.example("four-bar").write(f"{folder}/four_bar.py")
    ...     lines = pathlib.Path(folder, "four_bar.py").read_text().splitlines()
    >>> lines[1]
    'Four-bar linkage, open.'
    """
    cycle = mechanism.sweep() if motion is None else motion
    text = code_of(mechanism.model, cycle, as_path(path))
    save_text(text, path)


def write_robot(
    mechanism: Mechanism,
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
        :meth:`~linkwork.Mechanism.solve`.
    configuration : str, optional
        The configuration of the start position.
    motion : Motion, optional
        Of URDF, the sweep through the start position that gives limits and polynomials; by
        default :meth:`~linkwork.Mechanism.sweep`.

    Raises
    ------
    InputError
        If there is no such format, no start position, no equivalent of a part, or the file
        cannot be written.

    Examples
    --------
    >>> import linkwork as lw, pathlib, tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     lw.example("four-bar").write(f"{folder}/bar.mjcf", at=60)
    ...     text = pathlib.Path(folder, "bar.mjcf").read_text("utf-8")
    >>> text.count("<joint "), text.count("<connect ")
    (3, 1)
    """
    suffix = check_robot_file(as_path(path))
    start = mechanism.solve(at, configuration=configuration)
    if suffix == ".urdf" and motion is None:
        motion = mechanism.sweep(configuration=configuration)
    text = robot_of(mechanism.model, start, motion, as_path(path))
    save_text(text, path)


def write_plates(
    mechanism: Mechanism,
    path: str | Path,
    motion: Motion | None = None,
    *,
    options: PlateOptions | None = None,
    layout: bool = False,
    progress: Callable[[float], None] | None = None,
) -> PlateStack:
    """Write the links as plates to cut or print, in layers in which nothing collides.

    Parameters
    ----------
    path : str or Path
        The file; its suffix selects the format: ``.dxf``, ``.svg``, ``.stl``, ``.3mf`` or
        ``.step``.
    motion : Motion, optional
        The sweep in which nothing may collide; by default :meth:`~linkwork.Mechanism.sweep`.
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
    ...     stack = lw.example("slider-crank").write(f"{folder}/plates.dxf", layout=True)
    >>> stack.layers, stack.proved
    (3, True)
    """
    file, chosen = as_path(path), given_or(PlateOptions(), "options", options)
    check_flags(progress, layout=layout)
    check_plate_file(file)
    cycle = mechanism.sweep() if motion is None else motion
    stack = stack_of(mechanism.model, cycle, chosen, progress)
    save_bytes(plates_of(stack, file, layout=layout), path)
    return stack


def _text_of(format: str) -> Callable[..., Any]:
    def write_text(
        mechanism: Mechanism,
        path: str | Path,
        at: float | Mapping[str, float] | None = None,
        *,
        configuration: str | None = None,
    ) -> Any:
        made = exported(mechanism, format, at, configuration=configuration)
        save_text(made.text, path)
        return made.left_out

    return write_text


WRITERS: Mapping[str, Writer] = {
    "workbook": Writer(suffixes=(".xlsx",), write=write_workbook),
    "program": Writer(suffixes=(".py", ".m", ".c", ".js", ".st"), write=write_program),
    "plates": Writer(suffixes=(".dxf", ".stl", ".3mf", ".step"), write=write_plates),
    "robot": Writer(suffixes=(".mjcf", ".sdf", ".urdf"), write=write_robot),
    "report": Writer(suffixes=(".docx", ".md"), write=write_report),
    "pmks": Writer(write=_text_of("pmks")),
    "pylinkage": Writer(write=_text_of("pylinkage")),
    "pyslvs": Writer(write=_text_of("pyslvs")),
}


def writers() -> dict[str, Writer]:
    """All kinds of files: those of Linkwork, then those of other packages."""
    more = {
        kind: wings.load(place) for wing in wings.wings() for kind, place in wing.writers.items()
    }
    return {**WRITERS, **more}


def kind_of(path: str | Path) -> str:
    """The kind of file that a suffix selects.

    Raises
    ------
    InputError
        If none has it.
    """
    known, suffix = writers(), as_path(path).suffix.lower()
    for name, writer in known.items():
        if suffix in writer.suffixes:
            return name
    suffixes = sorted(s for writer in known.values() for s in writer.suffixes)
    raise InputError(
        f'cannot write "{path}": no kind of file has the suffix "{suffix}" '
        f"{choices('suffixes', suffixes)}; or name the kind {choices('kinds', known)}"
    )


def write(mechanism: Mechanism, path: str | Path, kind: str | None = None, **options: Any) -> Any:
    """Write a mechanism to a file; see :meth:`~linkwork.Mechanism.write`."""
    known, kind = writers(), kind_of(path) if kind is None else kind
    if kind not in known:
        raise UnknownNameError(f'there is no kind of file "{kind}" {choices("kinds", known, kind)}')
    chosen = known[kind].write
    takes = list(inspect.signature(chosen).parameters)[2:]
    for name in options:
        if name not in takes:
            raise InputError(f'a {kind} has no option "{name}" {choices("options", takes, name)}')
    return chosen(mechanism, path, **options)
