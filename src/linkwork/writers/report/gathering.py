"""The mechanism as a report for people: the results of its sections, gathered and written."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from linkwork.core import motion, textfile
from linkwork.core.api.mechanism import Mechanism
from linkwork.core.foundation.errors import InputError, UnknownNameError
from linkwork.core.foundation.files import as_path
from linkwork.design.tolerances import tolerance
from linkwork.forces.functions import stalls
from linkwork.forces.results import ForceStatus
from linkwork.writers.report.findings import Findings, Template, template_of
from linkwork.writers.report.motion_sections import check_template, quantities_of
from linkwork.writers.report.report import check_report_file, report_of

if TYPE_CHECKING:
    from linkwork.core.results.motion import Motion
    from linkwork.core.results.position import Position

T = TypeVar("T")

_SWEPT, _FOLLOWED, _DONE = 0.3, 0.6, 0.7  # finished fractions: sweep, circuits, the others
_MOST_TOLERANCES = 6  # quantities, if the template names none
_NO_POINTS = "the mechanism has no points to draw"
_NO_INPUT = "the mechanism has no input"
_NOT_DONE = "no position was found"
_HIDDEN = "a question of the file hides it: report a copy of the file without [[questions]]"
#: The sections that would show the answer of a question.
_HIDING = {
    "numbers": ("vectors", "newton", "motion", "configurations", "forces", "tolerances"),
    "charts": ("plots",),
    "limits": ("motion", "circuits", "proof"),
    "input": ("vectors", "newton", "configurations"),
    "equations": ("equations", "vectors", "newton"),
}


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
    check_template(chosen, mechanism.model)
    tell = progress or (lambda fraction: None)
    results = findings(mechanism, chosen, at, configuration, lambda part: tell(_DONE * part))
    written = report_of(results, chosen, target, lambda part: tell(_DONE + (1.0 - _DONE) * part))
    return written.save(target)


def findings(
    mechanism: Mechanism,
    template: Template,
    at: float | Mapping[str, float] | None,
    configuration: str | None,
    progress: Callable[[float], None],
) -> Findings:
    """The results that the sections of a template show."""
    gathering = _Gathering(mechanism, template, at, configuration, progress)
    gathering.gather()
    read = mechanism.read
    source = textfile.write_text(mechanism.description) if read is None else read.text
    return Findings(
        model=mechanism.model, source=source, absent=gathering.absent, **gathering.found
    )


class _Gathering:
    """Computes the results of the sections; notes why a section has none."""

    def __init__(
        self,
        mechanism: Mechanism,
        template: Template,
        at: float | Mapping[str, float] | None,
        configuration: str | None,
        progress: Callable[[float], None],
    ) -> None:
        self.mechanism, self.template = mechanism, template
        self.at, self.configuration, self.progress = at, configuration, progress
        self.found: dict[str, Any] = {}
        self.absent: dict[str, str] = {}

    def gather(self) -> None:
        """Compute the position and the motion, then the results that need them."""
        mechanism = self.mechanism
        self.found["check"] = mechanism.check()
        swept = None
        if mechanism.description.inputs:
            swept = mechanism.sweep(
                configuration=self.configuration,
                progress=lambda part: self.progress(_SWEPT * part / _DONE),
            )
        position = self._position(swept)
        self.found |= {"position": position, "motion": swept}
        self._leave_out(position, swept)
        self._list(position)
        self._load(swept)
        self._vary(position)
        self.progress(1.0)

    def _is_included(self, section: str) -> bool:
        return section in self.template.sections and section not in self.absent

    def _without(self, sections: Collection[str], reason: str) -> None:
        for name in self.template.sections:
            if name in sections:
                self.absent.setdefault(name, reason)

    def _position(self, swept: Motion | None) -> Position:
        mechanism, steps = self.mechanism, self.configuration is None
        position = mechanism.solve(self.at, configuration=self.configuration, with_steps=steps)
        if self.at is not None or swept is None or not swept.found.any():
            return position
        model = mechanism.model if steps else mechanism.model.from_position(position)
        near = motion.solve_round_start(model, swept, position)
        if not near.status.ok or near.input == position.input:
            return position
        return mechanism.solve(near.input, with_steps=True) if steps else near

    def _leave_out(self, position: Position, swept: Motion | None) -> None:
        """Note the sections that have nothing to show."""
        for question in self.mechanism.description.questions:
            # the file gives answers
            hidden = [name for part in question.hide for name in _HIDING[part]]
            self._without([*hidden, "file"], _HIDDEN)
        drawn = bool(self.mechanism.model.compiled.points.names)
        if not position.status.ok:
            self._without(("drawing", "vectors", "tolerances"), _NOT_DONE)
        if not drawn:
            self._without(("drawing", "paths"), _NO_POINTS)
        if not (self.template.tolerances_of or position.outputs or position.unknowns):
            self._without(("tolerances",), "the mechanism has no unknown and no output")
        if not self.mechanism.loop_equations.loops:
            self._without(("vectors",), "the mechanism has no loop equations")
        if not self.mechanism.loop_equations.unknowns:
            self._without(("newton",), "the mechanism has no unknowns")
        elif not position.steps:
            self._without(("newton",), "a chosen configuration has no iterations from the guess")
        if swept is None:
            self._without(("plots", "paths", "circuits", "forces"), _NO_INPUT)
        elif not swept.found.any():
            self._without(("plots", "paths", "forces", "tolerances"), _NOT_DONE)
        else:
            if not quantities_of(swept, self.template):
                self._without(("plots",), "the mechanism has no unknown, output or traced point")
            if not swept.skeleton.traced:
                self._without(("paths",), "the file traces no point")

    def _list(self, position: Position) -> None:
        """Circuits, configurations, vectors."""
        if self._is_included("vectors"):
            self.found["vectors"] = motion.vector_loops(self.mechanism.model, position)
        if self._is_included("circuits"):
            span = (_FOLLOWED - _SWEPT) / _DONE
            self._try(
                "circuits",
                lambda: self.mechanism.circuits(
                    progress=lambda part: self.progress(_SWEPT / _DONE + span * part)
                ),
            )
        if self._is_included("configurations"):
            inputs = position.input or None
            self._try("configurations", lambda: self.mechanism.configurations(inputs))

    def _load(self, swept: Motion | None) -> None:
        """The forces in the rows of the motion, and where friction stops it."""
        if swept is None or not self._is_included("forces"):
            return
        mechanism = self.mechanism
        self._try("forces", lambda: mechanism.forces(motion=swept))
        acting = self.found.get("forces")
        if acting is not None and ForceStatus.SELF_LOCKING in acting.statuses:
            self.found["stalls"] = stalls(mechanism, motion=swept, configuration=self.configuration)

    def _vary(self, position: Position) -> None:
        """The tolerances at the drawn position."""
        if not self._is_included("tolerances"):
            return
        usual = position.outputs or position.unknowns
        names = self.template.tolerances_of or tuple(usual)[:_MOST_TOLERANCES]
        at = position.input or None
        self._try(
            "tolerances",
            lambda: tuple(
                tolerance(self.mechanism, of, at, configuration=self.configuration) for of in names
            ),
        )

    def _try(self, section: str, compute: Callable[[], object]) -> None:
        """Keep a result, or the reason why there is none."""
        try:
            self.found[section] = compute()
        except UnknownNameError:  # of the template
            raise
        except InputError as error:
            self.absent[section] = str(error)
