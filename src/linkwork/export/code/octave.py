"""Programs for Octave and MATLAB: one function file."""

from __future__ import annotations

from linkwork.export.code.syntax import Syntax

__all__ = ["OCTAVE"]

_WORDS = """
    break case catch classdef continue do else elseif end end_try_catch end_unwind_protect
    endfor endfunction endif endparfor endswitch endwhile enumeration events for function global
    if methods otherwise parfor persistent properties return spmd switch try until
    unwind_protect unwind_protect_cleanup while
"""
_SIDES = """\
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
        "pi": "pi", "e": "exp(1)",
    },
    sections={
        "closure": (
            "function [F, J] = closure_{k}(u, q, p)\n"
            "  % {about}: F, and the Jacobian by its unknowns.\n"
            "  F = zeros({n}, 1);\n  J = zeros({n});\n  {body}\nend\n"
        ),
        "sides1": _SIDES.format(order="first", times="once"),
        "sides2": _SIDES.format(order="second", times="twice"),
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
        "call": "    @closure_{k}, @first_sides_{k}, @second_sides_{k};",
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
    words=frozenset(_WORDS.split()),
    comments=r"%[^\n]*",
    indent="  ",
    padded=False,
    shared="p.{name}",
)  # fmt: skip
