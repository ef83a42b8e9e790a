"""The languages of programs as tables of spellings; programs by the suffixes of their files."""

from __future__ import annotations

import keyword
from collections.abc import Iterator, Mapping
from importlib import metadata
from pathlib import Path

from linkwork.core.api.mechanism import Mechanism
from linkwork.core.foundation.errors import InputError
from linkwork.core.foundation.files import as_path, save_text
from linkwork.core.motion.model import Model
from linkwork.core.results.motion import Motion
from linkwork.writers.code.program_text import ProgramText, Syntax
from linkwork.writers.code.solver_program import SolverProgram


def _functions(one: str, two: str, **others: str) -> dict[str, str]:
    """Forms of functions of one and of two numbers, by forms of their names, and others."""
    single = ("sin", "cos", "tan", "asin", "acos", "atan", "sqrt", "exp", "log10", "abs")
    named = {name: one.format(name) for name in single}
    named |= {name: two.format(name) for name in ("atan2", "hypot", "min", "max")}
    named |= {"ln": one.format("log"), "radians": "radians({})", "degrees": "degrees({})"}
    return named | others


# ----------------------------------------------------------------------
# The languages.


_C_WORDS = """
    auto break case char const continue default do double else enum extern float for goto if
    inline int long register restrict return short signed sizeof static struct switch typedef
    union unsigned void volatile while bool true false nan infinity null main
"""
# Macros of the headers, also those beyond the standard that compilers add by default.
_MACROS = """
    bufsiz eof huge_val isfinite isgreater isinf isless isnan isnormal linux m_e m_pi signbit stderr
    stdin stdout unix
"""
C = Syntax(
    language="C99",
    suffix=".c",
    template="c.txt",
    functions=_functions(
        "{}({{}})", "{}({{}}, {{}})", min="fmin({}, {})", max="fmax({}, {})", abs="fabs({})",
        square="({0}*{0})", pi="PI", e="exp(1.0)", **{"^": "pow({}, {})"},
    ),
    assign="const double {name} = {value};",
    constant="#define {name} ({value})",
    comment=" /* {} */",
    row=("{", ", ", "}"),
    rows=("{\n    ", ", ", "\n}"),
    empty="0",
    words=frozenset((_C_WORDS + _MACROS).split()),
    comments=r"/\*.*?\*/",
    padded=True,
)  # fmt: skip
_JAVASCRIPT_WORDS = """
    abstract arguments await boolean break byte case catch char class const continue debugger
    default delete do double else enum eval export extends false final finally float for
    function goto if implements import in instanceof int interface let long native new null
    package private protected public return short static super switch synchronized this throw
    throws transient true try typeof undefined var void volatile while with yield nan infinity
    document location top window
"""  # the last four: names that a page cannot declare
JAVASCRIPT = Syntax(
    language="JavaScript",
    suffix=".js",
    template="javascript.txt",
    functions=_functions(
        "Math.{}({{}})", "Math.{}({{}}, {{}})",
        square="({0}*{0})", pi="Math.PI", e="Math.E", **{"^": "Math.pow({}, {})"},
    ),
    assign="const {name} = {value};",
    constant="const {name} = {value};",
    comment=" // {}",
    rows=("[\n  ", ", ", ",\n]"),
    words=frozenset(_JAVASCRIPT_WORDS.split()),
    comments=r"/\*.*?\*/|//[^\n]*",
)  # fmt: skip
_OCTAVE_WORDS = """
    break case catch classdef continue do else elseif end end_try_catch end_unwind_protect
    endfor endfunction endif endparfor endswitch endwhile enumeration events for function global
    if methods otherwise parfor persistent properties return spmd switch try until
    unwind_protect unwind_protect_cleanup while
"""
#: Octave and MATLAB: one function file.
OCTAVE = Syntax(
    language="Octave and MATLAB",
    suffix=".m",
    template="octave.txt",
    functions=_functions(
        "{}({{}})", "{}({{}}, {{}})", square="{}^2", pi="pi", e="exp(1)", **{"^": "{}^{}"}
    ),
    comment="  % {}",
    first=1,
    element="{array}({k})",
    entry="{array}({i}, {j})",
    string="'{}'",
    rows=("[\n  ", "; ", "\n]"),
    words=frozenset(_OCTAVE_WORDS.split()),
    comments=r"%[^\n]*",
    shared="p.{name}",
)  # fmt: skip
#: Python with NumPy.
PYTHON = Syntax(
    language="Python",
    suffix=".py",
    template="python.txt",
    functions=_functions(
        "{}({{}})", "{}({{}}, {{}})", square="{}**2", pi="pi", e="exp(1.0)", **{"^": "{}**{}"}
    ),
    assign="{name} = {value}",
    constant="{name} = {value}",
    comment="  # {}",
    entry="{array}[{i}, {j}]",
    store="{place} = {value}",
    rows=("[\n    ", ", ", ",\n]"),
    words=frozenset(map(str.lower, keyword.kwlist)),
    comments=r'""".*?"""|#[^\n]*',
)  # fmt: skip
_STRUCTURED_TEXT_WORDS = """
    abs abstract acos action add and any any_bit any_date any_int any_num any_real array asin at
    atan atan2 bool by byte case class concat configuration constant continue cos ct ctd ctu
    ctud date date_and_time delete div do dint dt dword else elsif end_action end_case end_class
    end_configuration end_for end_function end_function_block end_if end_interface end_method
    end_namespace end_program end_repeat end_resource end_step end_struct end_transition
    end_type end_var end_while eq exit exp expt extends f_edge f_trig false find final for from
    function function_block ge gt if implements initial_step insert int interface internal
    interval invert le left len limit ln log lreal lt lword max method mid min mod move mul mux
    namespace ne non_retain not null of on or overlap override pragma private program protected
    public pt q1 r1 r_edge r_trig read_only read_write real ref ref_to repeat replace resource
    retain return right rol ror rs s1 sel set shl shr sin single sint sizeof sqrt sr step string
    struct sub super tan task then this time time_of_day to tod tof ton tp transition true trunc
    type udint uint ulint unsigned until uint usint using var var_access var_config var_external
    var_global var_in_out var_input var_output var_temp while with word wstring xor ld st en eno
    jmp cal ret s r n
"""
#: Structured text of IEC 61131-3, for programmable controllers.
STRUCTURED_TEXT = Syntax(
    language="structured text, IEC 61131-3",
    suffix=".st",
    template="structured_text.txt",
    functions={
        **{name: form.upper() for name, form in _functions("{}({{}})", "{}({{}}, {{}})").items()},
        "ln": "LN({})", "log10": "LOG({})", "hypot": "SQRT(EXPT({}, 2.0) + EXPT({}, 2.0))",
        "^": "EXPT({}, {})", "square": "({0}*{0})", "pi": "3.141592653589793", "e": "EXP(1.0)",
        "radians": "(0.017453292519943295*({}))", "degrees": "(57.29577951308232*({}))",
    },
    assign="{name} := {value};",
    constant="{name} := {value};",
    comment=" (* {} *)",
    entry="{array}[{i}, {j}]",
    store="{place} := {value};",
    string="'{}'",
    rows=("[\n    ", ", ", "\n  ]"),
    inner=("", ", ", ""),
    words=frozenset(_STRUCTURED_TEXT_WORDS.split()),
    comments=r"\(\*.*?\*\)",
    empty="0",
    shared="p.{name}",
    locals="VAR\n  {names} : LREAL;\nEND_VAR",
    padded=True,
)  # fmt: skip


# ----------------------------------------------------------------------
# A mechanism's solver as a program in another language.


#: Languages by the suffixes of their files.
LANGUAGES: Mapping[str, Syntax] = {
    syntax.suffix: syntax for syntax in (PYTHON, OCTAVE, C, JAVASCRIPT, STRUCTURED_TEXT)
}


def language_of(file: Path) -> Syntax:
    """The language of a program's file, by its suffix.

    Raises
    ------
    InputError
        If no programs are written in this language.
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
        If the language is not known, or the mechanism's equations have no formulas.
    """
    syntax = language_of(file)
    program = SolverProgram(model, motion, file.stem, syntax.reserved)
    return ProgramText(program, syntax).written(list(_heading(program)))


def _heading(program: SolverProgram) -> Iterator[str]:
    """The results of the program, its units, and its limits."""
    model, motion = program.model, program.motion
    units = model.units
    yield f"{model.description.name}."
    yield ""
    yield f"Written by Linkwork {metadata.version('linkwork')}."
    yield f"Lengths in {units.length or 'the unit of the file'}, angles in {units.angle.value};"
    yield "derivatives are with respect to the leading input, with angles in radians."
    proved = int(motion.certified[motion.asked].sum())
    yield f"Linkwork proved {proved} of the {len(program.inputs)} positions of the table below;"
    yield "this program computes them again, and any others near them, but proves nothing."
    for limit in motion.limits:
        yield f"{limit.kind.word.capitalize()} at {limit.input:.12g}."


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
        If the language is not known, the mechanism's equations have no formulas, or the file
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
