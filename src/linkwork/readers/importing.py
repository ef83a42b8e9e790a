"""Mechanisms from the files of other programs."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from linkwork.core import textfile
from linkwork.core.api.mechanism import Mechanism
from linkwork.core.foundation.errors import (
    InputError,
)
from linkwork.core.foundation.files import as_path, save_text
from linkwork.core.foundation.values import as_told
from linkwork.core.mechanism.linkage import Linkage
from linkwork.readers.assembly import LARGEST, Exported
from linkwork.readers.formats import FORMATS, Imported, read_foreign, write_foreign


def imported(source: str | Path, format: str | None = None) -> Imported:
    """Read a mechanism from a file of another program, or from a link of PMKS+.

    Files are data: nothing in them is executed, no other file and no network is read.

    Parameters
    ----------
    source : str or Path
        A file; if there is none of this name, a link of PMKS or PMKS+.
    format : str, optional
        ``pmks``, ``pylinkage``, ``linkage2``, ``pyslvs``, ``geogebra``, ``dxf``, ``mjcf`` or
        ``urdf``; by default as suffix and content say.

    Returns
    -------
    Imported
        With the description and the omitted parts.

    Raises
    ------
    MechanismFileError
        If the file is damaged, too large or no linkage: the reason and its place.
    UnknownNameError
        If the format does not exist.

    Examples
    --------
    >>> import linkwork as lw, pathlib, tempfile
    >>> bar = "M[J[R, P[0, 0], L[ground, a]], J[R, P[3, 4], L[a]]]"
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = pathlib.Path(folder, "bar.txt")
    ...     _ = path.write_text(bar)
    ...     found = lw.readers.imported(path)
    >>> found.format, found.left_out[0].what
    ('pyslvs', 'the input: an expression does not state it')
    """
    # a path would make one stroke of the two in a link
    text = source if isinstance(source, str) else str(as_path(source))
    if format is not None and not isinstance(format, str):
        raise InputError(f"format must be a text, got {as_told(format)}")
    data, name = _bytes_of(text)
    return read_foreign(data, name, format)


def _bytes_of(text: str) -> tuple[bytes, str]:
    """The content of a file, or a link itself."""
    if FORMATS["pmks"].matches(text) and not os.path.exists(text):
        return text.encode("utf-8", "replace"), "the link"
    return textfile.bytes_of(Path(text), text, LARGEST), text


def exported(
    mechanism: Mechanism,
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
        The input of the position that is written; by default that of
        :meth:`~linkwork.Mechanism.solve`.
    configuration : str, optional
        The configuration of that position.

    Returns
    -------
    Exported
        The text, and the parts that it omits; :func:`imported` reads it back.

    Raises
    ------
    InputError
        If the format is not written, or has no equivalent of a part.
    NotConvergedError
        If there is no position at this input value.

    Examples
    --------
    >>> import linkwork as lw
    >>> lw.readers.exported(lw.example("hoeken"), "pmks").text.partition("?")[0]
    'https://app.pmksplus.com/'
    """
    linkage = mechanism.description
    if not isinstance(linkage, Linkage):
        raise InputError(
            f'mechanism "{mechanism.name}" is given by equations: other programs need points and '
            "links"
        )
    start = mechanism.solve(at, configuration=configuration, throw=True)
    places = {name: complex(*start.points[name]) for name in linkage.points}
    return write_foreign(linkage, places, format)


def _text_of(format: str) -> Callable[..., Any]:
    """The function that writes a mechanism as a text of another program."""

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


write_pmks, write_pylinkage, write_pyslvs = map(_text_of, ("pmks", "pylinkage", "pyslvs"))
