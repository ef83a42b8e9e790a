"""A report: the sections of a template as a document, written in the format of a file."""

from __future__ import annotations

import errno
import os
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from linkwork.core.foundation.files import save_bytes, suffix_of, unwritten, written_folder
from linkwork.writers.report.document import Block, Document, Facts, Section
from linkwork.writers.report.docx import docx_bytes, docx_package
from linkwork.writers.report.findings import SECTIONS, Findings, Template
from linkwork.writers.report.html import html_bytes, markdown_files
from linkwork.writers.report.motion_sections import (
    circuits,
    configurations,
    forces,
    motion,
    paths,
    plots,
    tolerances,
)
from linkwork.writers.report.pdf import pdf_bytes, typst_package
from linkwork.writers.report.sections import (
    dimensions,
    drawing,
    equations,
    file,
    newton,
    proof,
    summary,
    vectors,
    versions,
)

#: Formats of reports by suffix.
FORMATS = (".html", ".pdf", ".docx", ".md")

_PACKAGES = {".pdf": typst_package, ".docx": docx_package}

_Builder = Callable[[Findings, Template], Iterator[Block]]
_SECTIONS: Mapping[str, tuple[str, _Builder]] = {
    "summary": ("Summary", summary),
    "drawing": ("Drawing", drawing),
    "vectors": ("Vector diagram", vectors),
    "dimensions": ("Given dimensions", dimensions),
    "equations": ("Equations", equations),
    "newton": ("Newton-Raphson step by step", newton),
    "motion": ("Motion", motion),
    "plots": ("Plots", plots),
    "paths": ("Paths of points", paths),
    "circuits": ("Circuits and dead points", circuits),
    "configurations": ("Configurations", configurations),
    "forces": ("Forces", forces),
    "tolerances": ("Tolerances", tolerances),
    "proof": ("What is proved", proof),
    "versions": ("Versions", versions),
    "file": ("Mechanism file", file),
}
assert tuple(_SECTIONS) == SECTIONS


@dataclass(frozen=True, kw_only=True)
class WrittenReport:
    """The content of the file, and of pictures by their paths relative to its folder."""

    content: bytes
    pictures: Mapping[str, bytes]

    def save(self, path: Path) -> tuple[Path, ...]:
        """Write the file with its pictures, or nothing; returns all paths, that of the file first.

        Raises
        ------
        InputError
            If one of them cannot be written.
        """
        places = [path.parent / name for name in self.pictures]
        if not places:
            save_bytes(self.content, path)
            return (path,)
        folder = places[0].parent  # all pictures are in one
        if not folder.parent.is_dir():
            raise unwritten(folder, FileNotFoundError(errno.ENOENT, os.strerror(errno.ENOENT)))
        with written_folder(folder) as part:
            for place, picture in zip(places, self.pictures.values(), strict=True):
                (part / place.name).write_bytes(picture)
            save_bytes(self.content, path)
        return path, *places


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
        _PACKAGES[suffix]()


def document_of(findings: Findings, template: Template) -> Document:
    """The sections of a template with their content; the last one names those left out."""
    sections = []
    for name in template.sections:
        if name not in findings.absent:
            title, build = _SECTIONS[name]
            sections.append(Section(title=title, blocks=tuple(build(findings, template))))
    if findings.absent:
        absent = tuple((_SECTIONS[name][0], why) for name, why in findings.absent.items())
        sections.append(Section(title="Sections left out", blocks=(Facts(pairs=absent),)))
    title = template.title or findings.model.description.name
    return Document.numbered(title, template.byline, sections)


def report_of(
    findings: Findings,
    template: Template,
    path: Path,
    progress: Callable[[float], None] = lambda fraction: None,
) -> WrittenReport:
    """Write a report in the format of a file; the same results give the same bytes.

    Raises
    ------
    InputError
        If the format does not exist, or a key of the template does not fit the motion.
    MissingPackageError
        If the package that writes the format is not installed.
    """
    check_report_file(path)
    document = document_of(findings, template)
    pictures: dict[str, bytes] = {}
    match path.suffix.lower():
        case ".html":
            content = html_bytes(document, progress)
        case ".pdf":
            content = pdf_bytes(document, progress)
        case ".docx":
            content = docx_bytes(document, progress)
        case _:
            content, pictures = markdown_files(document, path.stem, progress)
    return WrittenReport(content=content, pictures=pictures)
