"""The mechanism as a report for people: the sections of a template, in the format of a file."""

from __future__ import annotations

import errno
import os
from collections.abc import Callable, Iterator, Mapping
from importlib import import_module
from pathlib import Path

from linkwork.core.api.mechanism import Mechanism
from linkwork.core.foundation.errors import InputError, UnknownNameError
from linkwork.core.foundation.files import (
    as_path,
    save_bytes,
    suffix_of,
    unwritten,
    written_folder,
)
from linkwork.core.foundation.loading import installed_with
from linkwork.writers.report import motion_sections, sections
from linkwork.writers.report.document import Block, Document, Facts, Section
from linkwork.writers.report.docx import docx_bytes
from linkwork.writers.report.findings import FOLLOWED, SECTIONS, Findings, template_of
from linkwork.writers.report.html import html_bytes, markdown_files
from linkwork.writers.report.pdf import pdf_bytes

#: Formats of reports by suffix.
FORMATS = (".html", ".pdf", ".docx", ".md")

#: The packages that formats need, with their names.
_PACKAGES = {
    ".pdf": ("typst", "PDF reports need Typst"),
    ".docx": ("docx", "Word reports need python-docx"),
}
_SECTIONS: Mapping[str, tuple[str, Callable[[Findings], Iterator[Block]]]] = {
    "summary": ("Summary", sections.summary),
    "drawing": ("Drawing", sections.drawing),
    "vectors": ("Vector diagram", sections.vectors),
    "dimensions": ("Given dimensions", sections.dimensions),
    "equations": ("Equations", sections.equations),
    "newton": ("Newton-Raphson step by step", sections.newton),
    "motion": ("Motion", motion_sections.motion),
    "plots": ("Plots", motion_sections.plots),
    "paths": ("Paths of points", motion_sections.paths),
    "circuits": ("Circuits and dead points", motion_sections.circuits),
    "configurations": ("Configurations", motion_sections.configurations),
    "forces": ("Forces", motion_sections.forces),
    "tolerances": ("Tolerances", motion_sections.tolerances),
    "proof": ("What is proved", sections.proof),
    "versions": ("Versions", sections.versions),
    "file": ("Mechanism file", sections.file),
}
assert tuple(_SECTIONS) == SECTIONS


def write_report(
    mechanism: Mechanism,
    path: str | Path,
    at: float | Mapping[str, float] | None = None,
    *,
    template: str | Path = "engineer",
    configuration: str | None = None,
    title: str | None = None,
    author: str | None = None,
    institution: str | None = None,
    date: str | None = None,
    progress: Callable[[float], None] | None = None,
) -> tuple[Path, ...]:
    """Write a report: equations, drawings, tables, plots, proofs, the file.

    Parameters
    ----------
    path : str or Path
        The file; its suffix selects the format: ``.html``, ``.pdf``, ``.docx``, or ``.md`` with
        its pictures in the folder ``<name>-pictures``.
    at : number or Mapping[str, number], optional
        The input of the drawing, the vectors, the configurations and the iterations; by default
        round values near those of the guess.
    template : str or Path
        ``engineer``, ``student``, or a template file, which names the sections.
    configuration : str, optional
        The configuration or branch of the motion, as in :meth:`~linkwork.Mechanism.solve`.
    title, author, institution, date : str, optional
        The head of the report, instead of that in the template.
    progress : callable, optional
        Called with the finished fraction, 0 to 1.

    Returns
    -------
    tuple of Path
        The files that were written: the report, then its pictures.

    Raises
    ------
    InputError
        If the suffix is unknown, the template has errors or does not fit the mechanism, or the
        file cannot be written.
    MissingPackageError
        If the package that writes the format is not installed.

    Examples
    --------
    >>> import linkwork as lw, tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     (file,) = lw.example("four-bar").write(f"{folder}/bar.html", kind="report", title="Bar")
    ...     text = file.read_text("utf-8")
    >>> file.name, "What is proved" in text
    ('bar.html', True)
    """
    target = as_path(path)
    check_report_file(target)
    chosen = template_of(template).with_head(
        {"title": title, "author": author, "institution": institution, "date": date}
    )
    motion_sections.check_template(chosen, mechanism.model)
    tell = progress or (lambda fraction: None)
    results = Findings(mechanism, chosen, at, configuration, tell)
    content, pictures = report_of(
        results, target, lambda part: tell(FOLLOWED + (1.0 - FOLLOWED) * part)
    )
    return save_report(target, content, pictures)


def check_report_file(path: Path) -> None:
    """Reject a file that cannot be written here before any computation.

    Raises
    ------
    InputError
        If the suffix is not one of :data:`FORMATS`.
    MissingPackageError
        If the package that writes the format is not installed.
    """
    suffix = suffix_of(path, "a report", FORMATS)
    if suffix in _PACKAGES:
        package, name = _PACKAGES[suffix]
        with installed_with("report", f"{suffix} reports need {name}"):
            import_module(package)


def document_of(findings: Findings) -> Document:
    """The sections of the template with their content; the last one names those left out."""
    written: list[Section] = []
    absent: list[tuple[str, str]] = []
    for name in findings.template.sections:
        heading, build = _SECTIONS[name]
        try:
            findings.check_hidden(name)
            written.append(Section(title=heading, blocks=tuple(build(findings))))
        except UnknownNameError:  # of the template
            raise
        except InputError as error:
            absent.append((heading, str(error)))
    if absent:
        written.append(Section(title="Sections left out", blocks=(Facts(pairs=tuple(absent)),)))
    title = findings.template.title or findings.model.description.name
    return Document.numbered(title, findings.template.byline, written)


def report_of(
    findings: Findings, path: Path, progress: Callable[[float], None] = lambda fraction: None
) -> tuple[bytes, Mapping[str, bytes]]:
    """The content of the file, and of pictures by their paths relative to its folder.

    The same results give the same bytes.
    """
    document = document_of(findings)
    match path.suffix.lower():
        case ".html":
            return html_bytes(document, progress), {}
        case ".pdf":
            return pdf_bytes(document, progress), {}
        case ".docx":
            return docx_bytes(document, progress), {}
        case _:
            return markdown_files(document, path.stem, progress)


def save_report(path: Path, content: bytes, pictures: Mapping[str, bytes]) -> tuple[Path, ...]:
    """Write the file with its pictures, or nothing; returns all paths, that of the file first.

    Raises
    ------
    InputError
        If one of them cannot be written.
    """
    places = [path.parent / name for name in pictures]
    if not places:
        save_bytes(content, path)
        return (path,)
    folder = places[0].parent  # all pictures are in one
    if not folder.parent.is_dir():
        raise unwritten(folder, FileNotFoundError(errno.ENOENT, os.strerror(errno.ENOENT)))
    with written_folder(folder) as part:
        for place, picture in zip(places, pictures.values(), strict=True):
            (part / place.name).write_bytes(picture)
        save_bytes(content, path)
    return path, *places
