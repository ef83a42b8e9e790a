"""Programs in structured text of IEC 61131-3, for programmable controllers."""

from __future__ import annotations

from linkwork.export.code.syntax import Syntax

__all__ = ["STRUCTURED_TEXT"]

_WORDS = """
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


_FORMS = {name: f"{name.upper()}({{}})" for name in ("sin", "cos", "tan", "asin", "acos", "atan")}
_SIDES = "{b}: ok := @{{name}}_ORDER_sides_{k}(u := u, q := q, d1 := d1, d2 := d2, F := F, p := p);"
STRUCTURED_TEXT = Syntax(
    language="structured text, IEC 61131-3",
    suffix=".st",
    template="structured_text.txt",
    functions=_FORMS
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
        "call_first": _SIDES.replace("ORDER", "first"),
        "call_second": _SIDES.replace("ORDER", "second"),
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
    words=frozenset(_WORDS.split()),
    comments=r"\(\*.*?\*\)",
    indent="",
    empty="0",
    shared="p.{name}",
)  # fmt: skip
