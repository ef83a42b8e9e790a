"""Templates of reports: sections, their order, and their contents."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any

from linkwork.circuits.results import Circuits, Configurations
from linkwork.core import motion, textfile
from linkwork.core.api.mechanism import Mechanism
from linkwork.core.foundation.errors import InputError, Problem, choices
from linkwork.core.foundation.files import as_path
from linkwork.core.foundation.values import Constant, Key, ListOf, PlainNumber, Text as TextKey, as_told
from linkwork.core.results.check import CheckReport
from linkwork.core.results.listing.motion_listing import inputs_text
from linkwork.core.results.motion import Motion
from linkwork.core.results.position import Position
from linkwork.core.textfile.keys import FORMAT, Form
from linkwork.core.textfile.reader import check_format, located_error
from linkwork.core.textfile.structure import Structure
from linkwork.core.textfile.toml_text import Lines, bytes_of, data_of, text_of
from linkwork.design.tolerance_results import Tolerance
from linkwork.design.tolerances import tolerance
from linkwork.forces.functions import stalls
from linkwork.forces.results import ForceStatus, Reactions
from linkwork.forces.stall import Stall
from linkwork.writers.report.document import template_text

#: The sections that a report can have.
SECTIONS = (
    "summary", "drawing", "vectors", "dimensions", "equations", "newton", "motion", "plots",
    "paths", "circuits", "configurations", "forces", "tolerances", "proof", "versions", "file",
)  # fmt: skip
#: The templates of the package.
TEMPLATES = ("engineer", "student")

_BYLINE = ("author", "institution", "date")
_NAMES = ListOf(TextKey(), "quantity")
_KEYS = Form(
    "template",
    "The sections of a report and their contents",
    "",
    (
        Key("format", Constant(FORMAT), "The version of this file format; write format = 1"),
        Key(
            "sections",
            ListOf(TextKey(SECTIONS), "section", 1),
            "The sections in their order",
            required=True,
        ),
        Key("title", TextKey(), "The title; by default the name of the mechanism"),
        Key("author", TextKey(), "Who wrote the report"),
        Key("institution", TextKey(), "University, company or course"),
        Key("date", TextKey(), "The date as it is printed; there is none by default"),
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
        return _read(template_text(f"{shown}.toml"), shown)
    path = as_path(name)
    if not path.exists() and path.parent == Path() and not path.suffix:
        raise InputError(
            f'there is no template "{shown}" {choices("templates", TEMPLATES, shown)}; a path '
            "names a file"
        )
    return _read(text_of(bytes_of(path, shown), shown), shown)


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
# The results that a report shows.


#: Finished fractions of a report: sweep, circuits.
SWEPT, FOLLOWED = 0.3, 0.6
_MOST_TOLERANCES = 6  # quantities, if the template names none
NO_INPUT, NOT_FOUND = "the mechanism has no input", "no position was found"
_HIDDEN = "a question of the file hides it: report a copy of the file without [[questions]]"
#: The sections that would show the answer of a question.
_HIDING = {
    "numbers": ("vectors", "newton", "motion", "configurations", "forces", "tolerances"),
    "charts": ("plots",),
    "limits": ("motion", "circuits", "proof"),
    "input": ("vectors", "newton", "configurations"),
    "equations": ("equations", "vectors", "newton"),
}


def needs(condition: object, reason: str) -> None:
    """Leave out a section without this condition.

    Raises
    ------
    InputError
        With the reason.
    """
    if not condition:
        raise InputError(reason)


class Findings:
    """The results of one mechanism, each computed when a section first shows it.

    Parameters
    ----------
    at : number or Mapping[str, number], optional
        The input of the position that is drawn and solved step by step.
    configuration : str, optional
        The configuration or branch of position and motion.
    progress : callable
        Called with the finished fraction, up to :data:`FOLLOWED`.
    """

    def __init__(
        self,
        mechanism: Mechanism,
        template: Template,
        at: float | Mapping[str, float] | None = None,
        configuration: str | None = None,
        progress: Callable[[float], None] = lambda fraction: None,
    ) -> None:
        self.mechanism, self.model, self.template = mechanism, mechanism.model, template
        self.at, self.configuration, self.progress = at, configuration, progress

    @property
    def source(self) -> str:
        """The mechanism file."""
        read = self.mechanism.read
        return textfile.write_text(self.mechanism.description) if read is None else read.text

    @cached_property
    def check(self) -> CheckReport:
        """How the file was read."""
        return self.mechanism.check()

    @cached_property
    def motion(self) -> Motion | None:
        """The sweep over the table of the input; ``None`` without an input."""
        if not self.model.description.inputs:
            return None
        return self.mechanism.sweep(
            configuration=self.configuration, progress=lambda part: self.progress(SWEPT * part)
        )

    @property
    def cycle(self) -> Motion:
        """The motion.

        Raises
        ------
        InputError
            If the mechanism has no input, or no position was found.
        """
        if self.motion is None:
            raise InputError(NO_INPUT)
        needs(self.motion.found.any(), NOT_FOUND)
        return self.motion

    @cached_property
    def position(self) -> Position:
        """The position that is drawn, by default at round values near those of the guess."""
        swept, steps = self.motion, self.configuration is None
        position = self.mechanism.solve(self.at, configuration=self.configuration, with_steps=steps)
        if self.at is not None or swept is None or not swept.found.any():
            return position
        model = self.model if steps else self.model.from_position(position)
        near = motion.solve_round_start(model, swept, position)
        if not near.status.ok or near.input == position.input:
            return position
        return self.mechanism.solve(near.input, with_steps=True) if steps else near

    @property
    def where(self) -> str:
        """The input of the position, ``at crank = 60 deg``; "" without an input."""
        return inputs_text(self.position.input, self.position.input_units)

    @cached_property
    def circuits(self) -> Circuits:
        """All circuits."""
        return self.mechanism.circuits(
            progress=lambda part: self.progress(SWEPT + (FOLLOWED - SWEPT) * part)
        )

    @cached_property
    def configurations(self) -> Configurations:
        """The configurations at the input of the drawn position."""
        return self.mechanism.configurations(self.position.input or None)

    @cached_property
    def forces(self) -> Reactions:
        """The forces in the rows of the motion."""
        return self.mechanism.forces(motion=self.cycle)

    @property
    def stalls(self) -> tuple[Stall, ...]:
        """Where friction stops the motion."""
        if ForceStatus.SELF_LOCKING not in self.forces.statuses:
            return ()
        return stalls(self.mechanism, motion=self.cycle, configuration=self.configuration)

    @cached_property
    def tolerances(self) -> tuple[Tolerance, ...]:
        """The tolerances at the drawn position."""
        usual = self.position.outputs or self.position.unknowns
        names = self.template.tolerances_of or tuple(usual)[:_MOST_TOLERANCES]
        at = self.position.input or None
        return tuple(
            tolerance(self.mechanism, of, at, configuration=self.configuration) for of in names
        )

    def check_hidden(self, section: str) -> None:
        """Leave out a section that would give the answer of a question.

        Raises
        ------
        InputError
            With the reason.
        """
        for question in self.model.description.questions:
            hidden = {name for part in question.hide for name in _HIDING[part]}
            needs(section not in hidden | {"file"}, _HIDDEN)

    def shown(self, section: str) -> Any:
        """The result of a section with the same name; ``None`` if the report leaves it out."""
        if section not in self.template.sections:
            return None
        try:
            self.check_hidden(section)
            return getattr(self, section)
        except InputError:
            return None
