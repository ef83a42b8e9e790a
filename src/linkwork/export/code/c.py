"""Programs in C99 without allocation, for controllers."""

from __future__ import annotations

from linkwork.export.code.syntax import Syntax

__all__ = ["C"]

_WORDS = """
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
_SIDES = """\
/* {{about}}: F differentiated {times}, without the {left} derivatives of its own unknowns. */
static void {left}_sides_{{k}}(const double u[M], const double q[], const double d1[],
    const double d2[], double F[])
{{{{
    (void)u, (void)q, (void)d1, (void)d2;
    {{body}}
}}}}
"""
_FORMS = {
    name: f"{name}({{}})"
    for name in ("sin", "cos", "tan", "asin", "acos", "atan", "sqrt", "exp", "log10")
}
C = Syntax(
    language="C99",
    suffix=".c",
    template="c.txt",
    functions=_FORMS
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
        "sides1": _SIDES.format(times="once", left="first"),
        "sides2": _SIDES.format(times="twice", left="second"),
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
    words=frozenset((_WORDS + _MACROS).split()),
    comments=r"/\*.*?\*/",
)  # fmt: skip
