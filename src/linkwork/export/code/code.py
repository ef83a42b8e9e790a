"""A mechanism's solver as a program in another language."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from importlib import metadata
from pathlib import Path

from linkwork.export.code.c import C
from linkwork.export.code.javascript import JAVASCRIPT
from linkwork.export.code.octave import OCTAVE
from linkwork.export.code.program_text import ProgramText
from linkwork.export.code.python import PYTHON
from linkwork.export.code.solver_program import SolverProgram
from linkwork.export.code.structured_text import STRUCTURED_TEXT
from linkwork.export.code.syntax import Syntax
from linkwork.foundation.errors import InputError
from linkwork.motion.model import Model
from linkwork.results.motion import Motion

__all__ = ["LANGUAGES", "code_of", "language_of"]

#: Languages by the suffixes of their files.
LANGUAGES: Mapping[str, Syntax] = {
    syntax.suffix: syntax for syntax in (PYTHON, OCTAVE, C, JAVASCRIPT, STRUCTURED_TEXT)
}


def language_of(file: Path) -> Syntax:
    """The language of a program's file, by its suffix.

    Raises
    ------
    InputError
        If no programs are written in such a language.
    """
    syntax = LANGUAGES.get(file.suffix.lower())
    if syntax is None:
        known = ", ".join(f"{key} ({one.language})" for key, one in LANGUAGES.items())
        raise InputError(f'cannot write "{file}": the suffix of a program is one of {known}')
    return syntax


def code_of(model: Model, motion: Motion, file: Path) -> str:
    """Write the solver of a mechanism as a program.

    Parameters
    ----------
    model : Model
    motion : Motion
        The sweep of its table, which the program computes again.
    file : Path
        The program's file: its suffix selects the language, its name is that of the program.

    Raises
    ------
    InputError
        If there is no such language, or no formulas of the mechanism's equations.
    """
    syntax = language_of(file)
    program = SolverProgram(model, motion, file.stem, syntax.reserved)
    return ProgramText(program, syntax).written(list(_heading(program)))


def _heading(program: SolverProgram) -> Iterator[str]:
    """What the program computes, its units, and what it does not know."""
    model, motion = program.model, program.motion
    units = model.units
    yield f"{model.description.name}."
    yield ""
    yield f"Written by Linkwork {metadata.version('linkwork')}."
    yield f"Lengths in {units.length or 'the unit of the file'}, angles in {units.angle.value};"
    yield "derivatives are with respect to the leading input, with angles in radians."
    found = int(motion.certified[motion.asked].sum())
    yield f"Linkwork proved {found} of the {len(program.inputs)} positions of the table below;"
    yield "this program computes them again, and any others near them, but proves nothing."
    for limit in motion.limits:
        yield f"{limit.kind.word.capitalize()} at {limit.input:.12g}."
