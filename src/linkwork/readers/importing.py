"""The formats of other programs, and which one a file has."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from types import ModuleType
from typing import Any

from linkwork.core import textfile
from linkwork.core.api.mechanism import Mechanism
from linkwork.core.foundation.errors import (
    InputError,
    MechanismError,
    UnknownNameError,
    choices,
    internal,
)
from linkwork.core.foundation.files import as_path, save_text
from linkwork.core.foundation.values import as_told
from linkwork.core.mechanism.linkage import Linkage
from linkwork.core.mechanism.part.index import PARTS
from linkwork.readers import dxf, geogebra, linkage2, mjcf, pmks, pylinkage, pyslvs, urdf
from linkwork.readers.assembly import LARGEST, Drawn, Exported, LeftOut, Source

#: Modules by the name of their format; each has ``TITLE``, ``SUFFIXES``, ``matches`` and ``read``.
FORMATS: Mapping[str, ModuleType] = {
    "pmks": pmks,
    "pylinkage": pylinkage,
    "linkage2": linkage2,
    "pyslvs": pyslvs,
    "geogebra": geogebra,
    "dxf": dxf,
    "mjcf": mjcf,
    "urdf": urdf,
}
#: Formats that are written as well.
WRITERS = ("pmks", "pylinkage", "pyslvs")
_HEAD = 4000
#: Formats without a published description, with an alternative.
_CLOSED = {
    ".sam": "files of SAM (ARTAS) have no published format: export a DXF drawing from SAM and "
    "import that",
}


@internal("description")
@dataclass(frozen=True, kw_only=True)
class Imported:
    """A mechanism from a file of another program.

    Parameters
    ----------
    description : Linkage
        Points, links and parts; :meth:`save` writes them as a mechanism file.
    format : str
        The format of the file.
    left_out : tuple of LeftOut
        What was not carried over, with its places.
    renamed : Mapping[str, str]
        Names that could not be kept, with the new ones.

    Examples
    --------
    >>> import linkwork as lw, pathlib, tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = pathlib.Path(folder, "bar.json")
    ...     _ = path.write_text(lw.readers.exported(lw.example("hoeken"), "pylinkage").text)
    ...     found = lw.readers.imported(path)
    >>> print(found)
    pylinkage JSON: 5 points, 4 links, 1 input
    >>> found.mechanism.check().mobility_count
    1
    """

    description: Linkage
    format: str
    left_out: tuple[LeftOut, ...]
    renamed: Mapping[str, str]

    @cached_property
    def mechanism(self) -> Mechanism:
        """The mechanism, ready to be solved.

        Raises
        ------
        MechanismError
            If something is missing that the file did not contain, such as an input.
        """
        return Mechanism(self.description)

    def missing(self) -> str:
        """Why the mechanism cannot be solved yet; empty if it can."""
        try:
            self.mechanism  # noqa: B018 - made for its errors
        except MechanismError as error:
            return "; ".join(problem.message for problem in error.problems)
        return ""

    def save(self, path: str | Path) -> None:
        """Write a mechanism file, completely or not at all.

        Raises
        ------
        InputError
            If the file cannot be written.
        """
        textfile.save(self.description, path)

    @property
    def carried(self) -> dict[str, int]:
        """The numbers of points, links, parts by their table, and inputs, where there are any."""
        tables = ("points", "links", *PARTS)
        counts = {table: len(getattr(self.description, table)) for table in tables}
        present = {what: count for what, count in counts.items() if count}
        return present | {"inputs": len(self.description.inputs)}

    def __str__(self) -> str:
        counted = [
            f"{count} {what.removesuffix('s') if count == 1 else what}"
            for what, count in self.carried.items()
        ]
        lines = [f"{FORMATS[self.format].TITLE}: {', '.join(counted)}"]
        lines += [f"renamed: {old} is now {new}" for old, new in self.renamed.items()]
        return "\n".join([*lines, *(f"left out: {each}" for each in self.left_out)])


def read_foreign(data: bytes, name: str, form: str | None = None) -> Imported:
    """Read the file of another program.

    Parameters
    ----------
    data : bytes
    name : str
        Its name; the suffix tells the format, otherwise its beginning.
    form : str, optional
        A key of :data:`FORMATS`.

    Raises
    ------
    MechanismFileError
        With the reason and its place in the file.
    UnknownNameError
        If the format does not exist.
    """
    source = Source(data, name)
    chosen = _named(form) if form is not None else _recognized(source)
    assembly = FORMATS[chosen].read(source)
    assembly.name = assembly.name or Path(name).stem[:200]
    return Imported(
        description=assembly.finish(),
        format=chosen,
        left_out=source.left_out,
        renamed=assembly.renamed,
    )


def _named(form: str) -> str:
    if form not in FORMATS:
        raise UnknownNameError(f'there is no format "{form}" {choices("formats", FORMATS, form)}')
    return form


def _recognized(source: Source) -> str:
    suffix = Path(source.name).suffix.lower() if len(source.name) < 300 else ""
    if suffix in _CLOSED:
        source.refuse(_CLOSED[suffix])
    head = source.data[:_HEAD].decode("utf-8-sig", "replace")
    # a suffix such as .json or .xml says little, and content can be damaged
    by_suffix = [name for name, module in FORMATS.items() if suffix in module.SUFFIXES]
    by_content = [name for name, module in FORMATS.items() if module.matches(head)]
    matching = [name for name in by_content if name in by_suffix] or by_content or by_suffix
    if not matching:
        known = choices("formats", FORMATS)
        source.refuse(
            f"is in no known format: give it the right suffix, or name the format {known}"
        )
    return matching[0]


def write_foreign(linkage: Linkage, places: Mapping[str, complex], form: str) -> Exported:
    """Write a linkage in a format of another program.

    Parameters
    ----------
    linkage : Linkage
    places : Mapping[str, complex]
        The points in an assembled position.
    form : str
        One of :data:`WRITERS`.

    Raises
    ------
    InputError
        If the format is not written, or has no equivalent of a part.
    """
    if form not in WRITERS:
        raise InputError(f'"{form}" is not written {choices("formats", WRITERS, form)}')
    drawn = Drawn(linkage, places)
    return Exported(text=FORMATS[form].write(drawn), left_out=drawn.left_out)


# ----------------------------------------------------------------------
# Mechanisms from the files of other programs.


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
