"""Programs in Python with NumPy."""

from __future__ import annotations

import keyword

from linkwork.export.code.syntax import Syntax

__all__ = ["PYTHON"]

_CLOSURE = '''\
def closure_{k}(u, q):
    """{about}: F, and the Jacobian by its unknowns."""
    F, J = np.zeros({n}), np.zeros(({n}, {n}))
    {body}
    return F, J

'''
_SIDES = '''\
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
        "closure": _CLOSURE,
        "sides1": _SIDES.format(order="first", times="once", left="first"),
        "sides2": _SIDES.format(order="second", times="twice", left="second"),
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
