"""Reader of forms B and C: loop equations in textbook notation, and plain equations."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from linkwork.core.equations.model import (
    LoopEquation,
    LoopEquations,
    Output,
    PointPath,
    RealEquation,
    Term,
    Variable,
)
from linkwork.core.equations.outputs import read_outputs
from linkwork.core.equations.phasors import Monomial, PhasorReader
from linkwork.core.expression.grammar import CONSTANTS, parse, parse_equation
from linkwork.core.expression.tree import Binary, Name, Negative, Node, names_in
from linkwork.core.foundation.errors import ExpressionError, choices
from linkwork.core.foundation.lanes import display_value, is_structurally_nonzero, largest, row_of
from linkwork.core.foundation.names import canonical
from linkwork.core.mechanism.description import Problems
from linkwork.core.mechanism.loops import Loops, PlainEquations


def read_loops(mechanism: Loops) -> LoopEquations:
    """The equations of a mechanism given by its loops.

    Raises
    ------
    MechanismError
        Lists all formulas that cannot be read and all unknowns that occur in no loop.
    """
    problems = Problems()
    spelling = {canonical(name): name for name in mechanism.guess}
    numbers = mechanism.numbers
    reader = PhasorReader(
        numbers.known,
        numbers.precise_tree,
        numbers.unit,
        spelling.__contains__,
        known=(*spelling.values(), *mechanism.dimensions),
    )
    loops: list[LoopEquation] = []
    for label, text in mechanism.loops.items():
        try:
            left, right = (reader.read(side, text) for side in parse_equation(text))
            loops.append(
                LoopEquation(
                    label=label,
                    left=_terms(left, text),
                    right=_terms(right, text),
                )
            )
        except ExpressionError as error:
            problems.add(("loops", label), str(error))
    points = _read_points(mechanism, reader, problems)
    problems.raise_any(f'mechanism "{mechanism.name}"')
    kinds = _kinds(loops, spelling, problems)
    problems.raise_any(f'mechanism "{mechanism.name}"')
    _check_ranges(mechanism, kinds, problems)
    problems.raise_any(f'mechanism "{mechanism.name}"')
    outputs = read_outputs(mechanism.outputs, kinds, mechanism.points, numbers.known, problems)
    problems.raise_any(f'mechanism "{mechanism.name}"')
    return _equations_of(
        mechanism,
        kinds,
        outputs,
        loops=tuple(loops),
        symbols=_symbols(mechanism, loops),
        points=points,
        sliders={spelling[n]: n for n in spelling if kinds[n] == "length"},
        fixed=tuple(
            name
            for name, path in points.items()
            if not any(term.phase or term.length for term in path.terms)
        ),
        length_scale=_longest(loops),
    )


def _equations_of(
    mechanism: Loops | PlainEquations,
    kinds: Mapping[str, str],
    outputs: Mapping[str, Output],
    **own: Any,
) -> LoopEquations:
    """The equations over the variables of the guess; ``own``: those of the form."""
    numbers = mechanism.numbers
    variables = {
        canonical(name): Variable(name=name, kind=kinds[canonical(name)], symbol=canonical(name))
        for name in mechanism.guess
    }
    values = {canonical(name): numbers(number) for name, number in mechanism.guess.items()}
    driven = [canonical(which.drives[1]) for which in mechanism.inputs]
    unknown = [name for name in variables if name not in driven]
    return LoopEquations(
        angle=mechanism.angle,
        unknowns=tuple(variables[name] for name in unknown),
        inputs=tuple(variables[name] for name in driven),
        dimensions=dict(numbers.known),
        start=row_of(
            values[name] * (mechanism.angle.radians if kinds[name] == "angle" else 1)
            for name in (*unknown, *driven)
        ),
        outputs=outputs,
        **own,
    )


def _terms(monomials: list[Monomial], text: str) -> tuple[Term, ...]:
    return tuple(_term(m, text) for m in monomials if is_structurally_nonzero(m.value.high))


def _term(m: Monomial, text: str) -> Term:
    if len(m.factors) > 1:
        raise ExpressionError(
            f"the product {'·'.join(m.factors)} of two unknowns is not allowed in a loop equation: "
            "a term is one length times e^(i*angle)",
            text,
            1,
        )
    sign = -1 if isinstance(m.shown, Negative) else 1
    shown = m.shown.operand if isinstance(m.shown, Negative) else m.shown
    turn = 0.0
    seen = display_value(m.value.high)
    if shown is not None and abs(seen.real) <= 1e-15 * abs(seen.imag):
        found, rest = _without_i(shown)
        if found:
            # a factor i is displayed as a right angle
            shown, turn = rest, math.pi / 2
    return Term(
        value=m.value.high,
        magnitude=shown,
        sign=sign,
        turn=turn,
        length=m.factors[0] if m.factors else None,
        phase=m.phase,
    )


def _without_i(node: Node) -> tuple[bool, Node | None]:
    """A product without its factor i, if it has exactly one."""
    match node:
        case Name("i"):
            return True, None
        case Binary("*"):
            for inner, other, flipped in (
                (node.left, node.right, False),
                (node.right, node.left, True),
            ):
                found, rest = _without_i(inner)
                if found:
                    if rest is None:
                        return True, other
                    return True, Binary("*", *((other, rest) if flipped else (rest, other)))
    return False, node


def _read_points(
    mechanism: Loops, reader: PhasorReader, problems: Problems
) -> dict[str, PointPath]:
    """Read points, which may refer to each other in any order; circular references are errors."""
    texts = {canonical(name): text for name, text in mechanism.points.items()}
    spelling = {canonical(name): name for name in mechanism.points}
    done: dict[str, PointPath] = {}
    state: dict[str, str] = {}

    def resolve(name: str, chain: tuple[str, ...]) -> None:
        if name in state:
            if state[name] == "open":
                circle = " → ".join(spelling[n] for n in (*chain[chain.index(name) :], name))
                problems.add(("points", spelling[name]), f"is defined in terms of itself: {circle}")
                state[name] = "done"
            return
        state[name] = "open"
        text = texts[name]
        try:
            tree = parse(text)
            for node in names_in(tree):
                if node.name in texts:
                    resolve(node.name, (*chain, name))
            missing = any(n.name in texts and n.name not in reader.points for n in names_in(tree))
            if state[name] == "open" and not missing:  # otherwise the other point is reported
                monomials = reader.read(tree, text)
                reader.points[name] = monomials
                done[spelling[name]] = PointPath(parent=None, terms=_terms(monomials, text))
        except ExpressionError as error:
            if not any(p.key == ("points", spelling[name]) for p in problems):
                problems.add(("points", spelling[name]), str(error))
        state[name] = "done"

    for name in texts:
        resolve(name, ())
    return {name: done[name] for name in mechanism.points if name in done}


def _kinds(
    loops: list[LoopEquation], spelling: Mapping[str, str], problems: Problems
) -> dict[str, str]:
    """The kind of every variable, from its place in the equations."""
    kinds: dict[str, str] = {}
    for loop in loops:
        for term in loop.terms:
            found = {name: "angle" for name, _ in term.phase}
            if term.length is not None:
                # one name cannot be a length and an angle in one term
                found[term.length] = "length" if term.length not in found else "both"
            for name, kind in found.items():
                if kinds.setdefault(name, kind) != kind or kind == "both":
                    problems.add(
                        ("loops", loop.label),
                        f'"{spelling[name]}" is used as an angle and as a length',
                    )
    for name, spelled in spelling.items():
        if name not in kinds:
            problems.add(("guess", spelled), f'"{spelled}" occurs in no loop equation')
    return kinds


def _check_ranges(
    mechanism: Loops | PlainEquations, kinds: Mapping[str, str], problems: Problems
) -> None:
    """Report inputs without a range unless they are angles."""
    for k, which in enumerate(mechanism.inputs):
        if kinds[canonical(which.drives[1])] == "angle" or which.law is not None:
            continue
        fields = (("from", which.from_), ("to", which.to), ("step", which.step))
        missing = [field for field, number in fields if number is None]
        if missing and (missing != ["step"] or len(mechanism.rows(which)) > 1):
            problems.add(
                (*mechanism.input_key(k), missing[0]),
                f'is missing: "{which.drives[1]}" is not an angle and has no natural range',
            )


def _symbols(mechanism: Loops | PlainEquations, loops: list[LoopEquation]) -> dict[str, float]:
    used = {
        node.name
        for loop in loops
        for term in loop.terms
        if term.magnitude is not None
        for node in names_in(term.magnitude)
    }
    known = mechanism.numbers.known
    return {name: known[name] for name in map(canonical, mechanism.dimensions) if name in used}


def _longest(loops: list[LoopEquation]) -> float:
    """The longest fixed vector; 1 if there is none."""
    sizes = [abs(t.value) for loop in loops for t in loop.terms if t.length is None]
    return largest(sizes) or 1.0


def read_plain_equations(mechanism: PlainEquations) -> LoopEquations:
    """The equations of form C; every variable is a plain number.

    Raises
    ------
    MechanismError
        Lists all formulas that cannot be read and all unknowns that occur nowhere.
    """
    problems = Problems()
    spelling = {canonical(name): name for name in mechanism.guess}
    numbers = mechanism.numbers
    equations: list[RealEquation] = []
    occurring: set[str] = set()
    for label, text in mechanism.equations.items():
        try:
            left, right = parse_equation(text)
            for side in (left, right):
                _check_plain(side, text, spelling, numbers.known)
                occurring |= {node.name for node in names_in(side)}
            equations.append(RealEquation(label=label, left=left, right=right))
        except ExpressionError as error:
            problems.add(("equations", label), str(error))
    for name, spelled in spelling.items():
        if name not in occurring and not problems:
            problems.add(("guess", spelled), f'"{spelled}" occurs in no equation')
    kinds = dict.fromkeys(spelling, "number")
    outputs = read_outputs(mechanism.outputs, kinds, {}, numbers.known, problems)
    _check_ranges(mechanism, kinds, problems)
    problems.raise_any(f'mechanism "{mechanism.name}"')
    symbols = {n: v for n, v in numbers.known.items() if n in occurring}
    return _equations_of(mechanism, kinds, outputs, real=tuple(equations), symbols=symbols)


def _check_plain(
    side: Node, text: str, spelling: Mapping[str, str], numbers: Mapping[str, float]
) -> None:
    for node in names_in(side):
        if node.name in spelling or node.name in numbers or node.name in CONSTANTS:
            continue
        if node.name == "i":
            message = "plain equations are real: for complex loop equations use [loops]"
        else:
            known = choices("names", [*spelling.values(), *numbers], node.name)
            message = f'"{node.spelling}" is neither a dimension nor in [guess] {known}'
        raise ExpressionError(f"column {node.column}: {message}", text, node.column)
    if "cis(" in text.replace(" ", ""):
        raise ExpressionError("cis is complex: for complex loop equations use [loops]", text, 1)
