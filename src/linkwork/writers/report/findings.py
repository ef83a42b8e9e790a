"""Templates of reports: sections, their order, and their contents."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cache
from importlib import resources
from pathlib import Path
from typing import Any

from linkwork.circuits.results import Circuits, Configurations
from linkwork.core.foundation.containers import FrozenDict
from linkwork.core.foundation.errors import InputError, Problem, choices
from linkwork.core.foundation.files import as_path
from linkwork.core.foundation.values import Constant, Key, ListOf, PlainNumber, Text, as_told
from linkwork.core.motion.model import Model
from linkwork.core.results.check import CheckReport
from linkwork.core.results.motion import Motion
from linkwork.core.results.position import Position
from linkwork.core.results.vector_loop import VectorLoop
from linkwork.core.textfile.keys import FORMAT, Form
from linkwork.core.textfile.reader import check_format, located_error
from linkwork.core.textfile.structure import Structure
from linkwork.core.textfile.toml_text import Lines, bytes_of, data_of, text_of
from linkwork.design.tolerance_results import Tolerance
from linkwork.forces.results import Reactions
from linkwork.forces.stall import Stall

#: The sections that a report can have.
SECTIONS = (
    "summary",
    "drawing",
    "vectors",
    "dimensions",
    "equations",
    "newton",
    "motion",
    "plots",
    "paths",
    "circuits",
    "configurations",
    "forces",
    "tolerances",
    "proof",
    "versions",
    "file",
)
#: The templates of the package.
TEMPLATES = ("engineer", "student")

_FOLDER = "templates"
_BYLINE = ("author", "institution", "date")
_NAMES = ListOf(Text(), "quantity")
_KEYS = Form(
    "template",
    "The sections of a report and their contents",
    "",
    (
        Key("format", Constant(FORMAT), "The version of this file format; write format = 1"),
        Key(
            "sections",
            ListOf(Text(SECTIONS), "section", 1),
            "The sections in their order",
            required=True,
        ),
        Key("title", Text(), "The title; by default the name of the mechanism"),
        Key("author", Text(), "Who wrote the report"),
        Key("institution", Text(), "University, company or course"),
        Key("date", Text(), "The date as it is printed; there is none by default"),
        Key("every", PlainNumber(), "Step of the input between rows of the table of the motion"),
        Key("quantities", _NAMES, "Columns of the table and of the plots"),
        Key("tolerances_of", _NAMES, "The quantities whose tolerances are given"),
    ),
)


@dataclass(frozen=True, kw_only=True)
class Template:
    """What a report contains.

    ``every`` is the step of the input between rows of the table of the motion, in file units;
    ``quantities`` replace the unknowns, outputs and traced points; ``tolerances_of`` the outputs.
    """

    sections: tuple[str, ...]
    title: str = ""
    author: str = ""
    institution: str = ""
    date: str = ""
    every: float | None = None
    quantities: tuple[str, ...] = ()
    tolerances_of: tuple[str, ...] = ()

    @property
    def byline(self) -> tuple[tuple[str, str], ...]:
        """The stated ones of author, institution and date."""
        return tuple((name, text) for name in _BYLINE if (text := getattr(self, name)))

    def with_head(self, head: Mapping[str, str | None]) -> Template:
        """A copy with another title, author, institution or date.

        Raises
        ------
        InputError
            If one of them is not text.
        """
        texts: dict[str, Any] = {name: text for name, text in head.items() if text is not None}
        for name, text in texts.items():
            if not isinstance(text, str):
                raise InputError(f"the {name} of a report must be text, got {as_told(text)}")
        return replace(self, **texts)


def template_of(name: str | Path) -> Template:
    """A template of the package by its name, or that of a file.

    Raises
    ------
    MechanismFileError
        If the file does not exist; else all its problems with line, key and remedy.
    """
    shown = str(as_path(name))
    if shown in TEMPLATES:
        return _shipped(shown)
    path = as_path(name)
    if not path.exists() and path.parent == Path() and not path.suffix:
        raise InputError(
            f'there is no template "{shown}" {choices("templates", TEMPLATES, shown)}; a path '
            "names a file"
        )
    return _read(text_of(bytes_of(path, shown), shown), shown)


@cache
def _shipped(name: str) -> Template:
    file = resources.files(__package__).joinpath(_FOLDER, f"{name}.toml")
    return _read(file.read_text("utf-8"), name)


def _read(text: str, name: str) -> Template:
    data = data_of(text, name)
    lines = Lines.of(text)
    check_format(data, lines, name)
    structure = Structure(data, _KEYS)
    problems = [*structure.problems, *_problems(structure.content)]
    if problems:
        raise located_error(problems, lines, name)
    content: dict[str, Any] = {
        key: tuple(entry) if isinstance(entry, list) else entry
        for key, entry in structure.content.items()
        if key != "format"
    }
    return Template(**content)


def _problems(content: Mapping[str, Any]) -> list[Problem]:
    """Repeated sections, and a step that is no step."""
    listed = content.get("sections", [])
    twice = [name for name in dict.fromkeys(listed) if listed.count(name) > 1]
    problems = [
        Problem(key=("sections",), message=f'has "{name}" twice: name each section once')
        for name in twice
    ]
    if content.get("every", 1.0) <= 0:
        problems.append(Problem(key=("every",), message="must be a positive step of the input"))
    return problems


# ----------------------------------------------------------------------
# The results that a report shows, computed before it is written.


@dataclass(frozen=True, kw_only=True, eq=False)
class Findings:
    """The results of one mechanism.

    Parameters
    ----------
    source : str
        The mechanism file.
    check : CheckReport
        How it was read.
    position : Position
        The position that is drawn and solved step by step.
    motion : Motion, optional
        The sweep over the table of the input.
    vectors, circuits, configurations, forces, stalls, tolerances
        The results of the sections that need them.
    absent : Mapping[str, str]
        Sections without content, each with its reason.
    """

    model: Model
    source: str
    check: CheckReport
    position: Position
    motion: Motion | None = None
    vectors: tuple[VectorLoop, ...] = ()
    circuits: Circuits | None = None
    configurations: Configurations | None = None
    forces: Reactions | None = None
    stalls: tuple[Stall, ...] = ()
    tolerances: tuple[Tolerance, ...] = ()
    absent: Mapping[str, str] = FrozenDict()
