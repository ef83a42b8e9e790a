"""Programs in C99 without allocation, for controllers."""

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

_C_WORDS = """
    auto break case char const continue default do double else enum extern float for goto if
    inline int long register restrict return short signed sizeof static struct switch typedef
    union unsigned void volatile while bool true false nan infinity null main
"""
# Macros of the headers, also those beyond the standard that compilers add by default.
_MACROS = """
    bufsiz eof filename_max fopen_max fp_fast_fma fp_fast_fmaf fp_fast_fmal fp_ilogb0 fp_ilogbnan
    fp_infinite fp_nan fp_normal fp_subnormal fp_zero fpclassify huge_val huge_valf huge_vall
    isfinite isgreater isgreaterequal isinf isless islessequal islessgreater isnan isnormal
    isunordered l_ctermid l_tmpnam linux m_1_pi m_2_pi m_2_sqrtpi m_e m_ln10 m_ln2 m_log10e
    m_log2e m_pi m_pi_2 m_pi_4 m_sqrt1_2 m_sqrt2 math_errexcept math_errhandling math_errno
    p_tmpdir seek_cur seek_end seek_set signbit stderr stdin stdout tmp_max unix
"""
_C_SIDES = """\
/* {{about}}: F differentiated {times}, without the {left} derivatives of its own unknowns. */
static void {left}_sides_{{k}}(const double u[M], const double q[], const double d1[],
    const double d2[], double F[])
{{{{
    (void)u, (void)q, (void)d1, (void)d2;
    {{body}}
}}}}
"""
_C_FORMS = {
    name: f"{name}({{}})"
    for name in ("sin", "cos", "tan", "asin", "acos", "atan", "sqrt", "exp", "log10")
}
C = Syntax(
    language="C99",
    suffix=".c",
    template="c.txt",
    functions=_C_FORMS
    | {
        "atan2": "atan2({}, {})", "hypot": "hypot({}, {})", "min": "fmin({}, {})",
        "max": "fmax({}, {})", "abs": "fabs({})", "ln": "log({})", "^": "pow({}, {})",
        "radians": "radians({})", "degrees": "degrees({})", "pi": "PI", "e": "exp(1.0)",
    },
    sections={
        "closure": (
            "/* {about}: F, and the Jacobian by its unknowns. */\n"
            "static void closure_{k}(const double u[M], const double q[], double F[], "
            "double J[][LARGEST])\n{{\n    (void)u, (void)q;\n    {body}\n}}\n"
        ),
        "sides1": _C_SIDES.format(times="once", left="first"),
        "sides2": _C_SIDES.format(times="twice", left="second"),
        "misfits": (
            "/* The errors of the lengths of redundant links, in w. */\n"
            "static void misfits(const double u[M], const double q[], double w[])\n"
            "{{\n    (void)u, (void)q, (void)w;\n    {body}\n}}"
        ),
        "derived": (
            "/* Links that turn with others, points and outputs. */\n"
            "static void derived(const double u[M], const double q[], double v[])\n"
            "{{\n    (void)u, (void)q, (void)v;\n    {body}\n}}"
        ),
        "derived_rates": (
            "/* Their derivatives by the leading input; angles in radians. */\n"
            "static void derived_rates(const double u[M], const double q[], const double v[],\n"
            "    const double d1[], const double d2[], double v1[], double v2[])\n"
            "{{\n    (void)u, (void)q, (void)v, (void)d1, (void)d2, (void)v1, (void)v2;\n"
            "    {body}\n}}"
        ),
        "no blocks": "    {0, 0, 0, 0}",
        "call": "    {{closure_{k}, first_sides_{k}, second_sides_{k}, {n}}},",
    },
    assign="const double {name} = {value};",
    constant="#define {name} ({value})",
    comment=" /* {} */",
    first=0,
    element="{array}[{k}]",
    entry="{array}[{i}][{j}]",
    store="{place} = {value};",
    string='"{}"',
    row=("{", ", ", "}"),
    rows=("{\n    ", ", ", "\n}"),
    empty="0",
    words=frozenset((_C_WORDS + _MACROS).split()),
    comments=r"/\*.*?\*/",
)  # fmt: skip


# ----------------------------------------------------------------------
# Programs in JavaScript, for Node and for browsers.


_JAVASCRIPT_WORDS = """
    abstract arguments await boolean break byte case catch char class const continue debugger
    default delete do double else enum eval export extends false final finally float for
    function goto if implements import in instanceof int interface let long native new null
    package private protected public return short static super switch synchronized this throw
    throws transient true try typeof undefined var void volatile while with yield nan infinity
    document location top window
"""  # the last four: names that a page cannot declare
_JAVASCRIPT_CLOSURE = """\
/** {about}: F, and the Jacobian by its unknowns. */
function closure{k}(u, q) {{
  const F = new Array({n}).fill(0);
  const J = F.map(() => new Array({n}).fill(0));
  {body}
  return [F, J];
}}
"""
_JAVASCRIPT_SIDES = """\
/** {{about}}: F differentiated {times}, without the {left} derivatives of its own unknowns. */
function {left}Sides{{k}}(u, q, d1, d2) {{{{
  const F = new Array({{n}}).fill(0);
  {{body}}
  return F;
}}}}
"""
_JAVASCRIPT_FORMS = {
    name: f"Math.{name}({{}})"
    for name in ("sin", "cos", "tan", "asin", "acos", "atan", "sqrt", "abs", "exp", "log10")
}
JAVASCRIPT = Syntax(
    language="JavaScript",
    suffix=".js",
    template="javascript.txt",
    functions=_JAVASCRIPT_FORMS
    | {name: f"Math.{name}({{}}, {{}})" for name in ("atan2", "hypot", "min", "max")}
    | {
        "ln": "Math.log({})", "^": "Math.pow({}, {})", "radians": "radians({})",
        "degrees": "degrees({})", "pi": "Math.PI", "e": "Math.E",
    },
    sections={
        "closure": _JAVASCRIPT_CLOSURE,
        "sides1": _JAVASCRIPT_SIDES.format(times="once", left="first"),
        "sides2": _JAVASCRIPT_SIDES.format(times="twice", left="second"),
        "misfits": (
            "/** The errors of the lengths of redundant links. */\n"
            "function misfits(u, q) {{\n  const w = new Array({n}).fill(0);\n  {body}\n"
            "  return w;\n}}"
        ),
        "derived": (
            "/** Links that turn with others, points and outputs. */\n"
            "function derived(u, q) {{\n  const v = new Array({n}).fill(0);\n  {body}\n"
            "  return v;\n}}"
        ),
        "derived_rates": (
            "/** Their derivatives by the leading input; angles in radians. */\n"
            "function derivedRates(u, q, v, d1, d2) {{\n  const v1 = new Array({n}).fill(0);\n"
            "  const v2 = new Array({n}).fill(0);\n  {body}\n  return [v1, v2];\n}}"
        ),
        "call": "  [closure{k}, firstSides{k}, secondSides{k}],",
    },
    assign="const {name} = {value};",
    constant="const {name} = {value};",
    comment=" // {}",
    first=0,
    element="{array}[{k}]",
    entry="{array}[{i}][{j}]",
    store="{place} = {value};",
    string='"{}"',
    row=("[", ", ", "]"),
    rows=("[\n  ", ", ", ",\n]"),
    words=frozenset(_JAVASCRIPT_WORDS.split()),
    comments=r"/\*.*?\*/|//[^\n]*",
    indent="  ",
    padded=False,
)  # fmt: skip


# ----------------------------------------------------------------------
# Programs for Octave and MATLAB: one function file.


_OCTAVE_WORDS = """
    break case catch classdef continue do else elseif end end_try_catch end_unwind_protect
    endfor endfunction endif endparfor endswitch endwhile enumeration events for function global
    if methods otherwise parfor persistent properties return spmd switch try until
    unwind_protect unwind_protect_cleanup while
"""
_OCTAVE_SIDES = """\
function F = {order}_sides_{{k}}(u, q, d1, d2, p)
  % {{about}}: F differentiated {times}, without the {order} derivatives of its own unknowns.
  F = zeros({{n}}, 1);
  {{body}}
end
"""
OCTAVE = Syntax(
    language="Octave and MATLAB",
    suffix=".m",
    template="octave.txt",
    functions={
        name: f"{name}({{}})"
        for name in ("sin", "cos", "tan", "asin", "acos", "atan", "sqrt", "abs", "exp", "log10")
    }
    | {name: f"{name}({{}}, {{}})" for name in ("atan2", "hypot", "min", "max")}
    | {
        "ln": "log({})", "^": "({})^({})", "radians": "radians({})", "degrees": "degrees({})",
        "pi": "pi", "e": "exp(1)"
    },
    sections={
        "closure": (
            "function [F, J] = closure_{k}(u, q, p)\n"
            "  % {about}: F, and the Jacobian by its unknowns.\n"
            "  F = zeros({n}, 1);\n  J = zeros({n});\n  {body}\nend\n"
        ),
        "sides1": _OCTAVE_SIDES.format(order="first", times="once"),
        "sides2": _OCTAVE_SIDES.format(order="second", times="twice"),
        "misfits": (
            "function w = misfits(u, q, p)\n  % The errors of the lengths of redundant links.\n"
            "  w = zeros(1, {n});\n  {body}\nend"
        ),
        "derived": (
            "function v = derived(u, q, p)\n  % Links that turn with others, points and outputs.\n"
            "  v = zeros(1, {n});\n  {body}\nend"
        ),
        "derived_rates": (
            "function [v1, v2] = derived_rates(u, q, v, d1, d2, p)\n"
            "  % Their derivatives by the leading input; angles in radians.\n"
            "  v1 = zeros(1, {n});\n  v2 = zeros(1, {n});\n  {body}\nend"
        ),
        "call": "    @closure_{k}, @first_sides_{k}, @second_sides_{k};"
    },
    assign="{name} = {value};",
    constant="{name} = {value};",
    comment="  % {}",
    first=1,
    element="{array}({k})",
    entry="{array}({i}, {j})",
    store="{place} = {value};",
    string="'{}'",
    row=("[", ", ", "]"),
    rows=("[\n  ", "; ", "\n]"),
    words=frozenset(_OCTAVE_WORDS.split()),
    comments=r"%[^\n]*",
    indent="  ",
    padded=False,
    shared="p.{name}"
)  # fmt: skip


# ----------------------------------------------------------------------
# Programs in Python with NumPy.


_PYTHON_CLOSURE = '''\
def closure_{k}(u, q):
    """{about}: F, and the Jacobian by its unknowns."""
    F, J = np.zeros({n}), np.zeros(({n}, {n}))
    {body}
    return F, J

'''
_PYTHON_SIDES = '''\
def {order}_sides_{{k}}(u, q, d1, d2):
    """{{about}}: F differentiated {times}, without the {left} derivatives of its own unknowns."""
    F = np.zeros({{n}})
    {{body}}
    return F

'''
_MISFITS = '''\
def misfits(u, q):
    """The errors of the lengths of redundant links."""
    w = np.zeros({n})
    {body}
    return w
'''
_DERIVED = '''\
def derived(u, q):
    """Links that turn with others, points and outputs."""
    v = np.zeros({n})
    {body}
    return v
'''
_DERIVED_RATES = '''\
def derived_rates(u, q, v, d1, d2):
    """Their first and second derivatives by the leading input; angles in radians."""
    v1, v2 = np.zeros({n}), np.zeros({n})
    {body}
    return v1, v2
'''
PYTHON = Syntax(
    language="Python",
    suffix=".py",
    template="python.txt",
    functions={
        "sin": "sin({})",
        "cos": "cos({})",
        "tan": "tan({})",
        "asin": "asin({})",
        "acos": "acos({})",
        "atan": "atan({})",
        "atan2": "atan2({}, {})",
        "sqrt": "sqrt({})",
        "abs": "abs({})",
        "exp": "exp({})",
        "ln": "log({})",
        "log10": "log10({})",
        "hypot": "hypot({}, {})",
        "min": "min({}, {})",
        "max": "max({}, {})",
        "^": "({})**({})",
        "radians": "radians({})",
        "degrees": "degrees({})",
        "pi": "pi",
        "e": "exp(1.0)",
    },
    sections={
        "closure": _PYTHON_CLOSURE,
        "sides1": _PYTHON_SIDES.format(order="first", times="once", left="first"),
        "sides2": _PYTHON_SIDES.format(order="second", times="twice", left="second"),
        "misfits": _MISFITS,
        "derived": _DERIVED,
        "derived_rates": _DERIVED_RATES,
        "call": "    (closure_{k}, first_sides_{k}, second_sides_{k}),",
    },
    assign="{name} = {value}",
    constant="{name} = {value}",
    comment="  # {}",
    first=0,
    padded=False,
    element="{array}[{k}]",
    entry="{array}[{i}, {j}]",
    store="{place} = {value}",
    string='"{}"',
    row=("[", ", ", "]"),
    rows=("[\n    ", ", ", ",\n]"),
    words=frozenset(map(str.lower, keyword.kwlist)),
    comments=r'""".*?"""|#[^\n]*',
)


# ----------------------------------------------------------------------
# Programs in structured text of IEC 61131-3, for programmable controllers.


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
_HEAD = """\
(* {about} *)
FUNCTION @{{{{name}}}}_{kind} : BOOL
VAR_IN_OUT
  {arguments}
  p : @{{{{name}}}}_numbers;
END_VAR
{{locals}}
{{body}}
@{{{{name}}}}_{kind} := TRUE;
END_FUNCTION
"""
_UQ = "u : @{{{{name}}}}_inputs; q : @{{{{name}}}}_unknowns;"
_RATES = "d1 : @{{{{name}}}}_unknowns; d2 : @{{{{name}}}}_unknowns;"


def _function(kind: str, about: str, arguments: str) -> str:
    head = _HEAD.format(about=about, kind=kind, arguments=arguments)
    return head.replace("@{{{{", "@{{").replace("}}}}", "}}")


_STRUCTURED_TEXT_FORMS = {
    name: f"{name.upper()}({{}})" for name in ("sin", "cos", "tan", "asin", "acos", "atan")
}
_STRUCTURED_TEXT_SIDES = (
    "{b}: ok := @{{name}}_ORDER_sides_{k}(u := u, q := q, d1 := d1, d2 := d2, F := F, p := p);"
)
STRUCTURED_TEXT = Syntax(
    language="structured text, IEC 61131-3",
    suffix=".st",
    template="structured_text.txt",
    functions=_STRUCTURED_TEXT_FORMS
    | {
        "sqrt": "SQRT({})", "abs": "ABS({})", "exp": "EXP({})", "ln": "LN({})",
        "log10": "LOG({})", "atan2": "ATAN2({}, {})", "min": "MIN({}, {})", "max": "MAX({}, {})",
        "hypot": "SQRT(EXPT({}, 2.0) + EXPT({}, 2.0))", "^": "EXPT({}, {})",
        "radians": "0.017453292519943295*({})", "degrees": "57.29577951308232*({})",
        "pi": "3.141592653589793", "e": "EXP(1.0)",
    },
    sections={
        "closure": _function(
            "closure_{k}", "{about}: F, and the Jacobian by its unknowns",
            _UQ + "\n  F : @{{{{name}}}}_side; J : @{{{{name}}}}_matrix;",
        ),
        "sides1": _function(
            "first_sides_{k}", "{about}: F differentiated once by the leading input",
            _UQ + "\n  " + _RATES + " F : @{{{{name}}}}_side;",
        ),
        "sides2": _function(
            "second_sides_{k}", "{about}: F differentiated twice by the leading input",
            _UQ + "\n  " + _RATES + " F : @{{{{name}}}}_side;",
        ),
        "misfits": _function(
            "misfits", "The errors of the lengths of redundant links",
            _UQ + "\n  w : @{{{{name}}}}_errors;",
        ),
        "derived": _function(
            "derived", "Links that turn with others, points and outputs",
            _UQ + "\n  v : @{{{{name}}}}_derived_numbers;",
        ),
        "derived_rates": _function(
            "derived_rates", "Their derivatives by the leading input, angles in radians",
            _UQ + "\n  v : @{{{{name}}}}_derived_numbers; " + _RATES
            + "\n  v1 : @{{{{name}}}}_derived_slopes; v2 : @{{{{name}}}}_derived_slopes;",
        ),
        "locals": "VAR\n  {names} : LREAL;\nEND_VAR",
        "number": "  {name} : LREAL;",
        "call": "{b}: ok := @{{name}}_closure_{k}(u := there, q := next, F := F, J := J, p := p);",
        "call_here": "{b}: ok := @{{name}}_closure_{k}(u := u, q := q, F := F, J := J, p := p);",
        "call_first": _STRUCTURED_TEXT_SIDES.replace("ORDER", "first"),
        "call_second": _STRUCTURED_TEXT_SIDES.replace("ORDER", "second"),
        "result": "{name} := {place};",
        "goal": "{place} := {name};",
    },
    assign="{name} := {value};",
    constant="{name} := {value};",
    comment=" (* {} *)",
    first=0,
    element="{array}[{k}]",
    entry="{array}[{i}, {j}]",
    store="{place} := {value};",
    string="'{}'",
    row=("[", ", ", "]"),
    rows=("[\n    ", ", ", "\n  ]"),
    inner=("", ", ", ""),
    words=frozenset(_STRUCTURED_TEXT_WORDS.split()),
    comments=r"\(\*.*?\*\)",
    indent="",
    empty="0",
    shared="p.{name}",
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
