"""Programs in JavaScript, for Node and for browsers."""

from __future__ import annotations

from linkwork.export.code.syntax import Syntax

__all__ = ["JAVASCRIPT"]

_WORDS = """
    abstract arguments await boolean break byte case catch char class const continue debugger
    default delete do double else enum eval export extends false final finally float for
    function goto if implements import in instanceof int interface let long native new null
    package private protected public return short static super switch synchronized this throw
    throws transient true try typeof undefined var void volatile while with yield nan infinity
    document location top window
"""  # the last four: names that a page cannot declare
_CLOSURE = """\
/** {about}: F, and the Jacobian by its unknowns. */
function closure{k}(u, q) {{
  const F = new Array({n}).fill(0);
  const J = F.map(() => new Array({n}).fill(0));
  {body}
  return [F, J];
}}
"""
_SIDES = """\
/** {{about}}: F differentiated {times}, without the {left} derivatives of its own unknowns. */
function {left}Sides{{k}}(u, q, d1, d2) {{{{
  const F = new Array({{n}}).fill(0);
  {{body}}
  return F;
}}}}
"""
_FORMS = {
    name: f"Math.{name}({{}})"
    for name in ("sin", "cos", "tan", "asin", "acos", "atan", "sqrt", "abs", "exp", "log10")
}
JAVASCRIPT = Syntax(
    language="JavaScript",
    suffix=".js",
    template="javascript.txt",
    functions=_FORMS
    | {name: f"Math.{name}({{}}, {{}})" for name in ("atan2", "hypot", "min", "max")}
    | {
        "ln": "Math.log({})", "^": "Math.pow({}, {})", "radians": "radians({})",
        "degrees": "degrees({})", "pi": "Math.PI", "e": "Math.E",
    },
    sections={
        "closure": _CLOSURE,
        "sides1": _SIDES.format(times="once", left="first"),
        "sides2": _SIDES.format(times="twice", left="second"),
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
    words=frozenset(_WORDS.split()),
    comments=r"/\*.*?\*/|//[^\n]*",
    indent="  ",
    padded=False,
)  # fmt: skip
