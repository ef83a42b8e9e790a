"""Equations of a mechanism, from its links or from its loops."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from linkwork.core.equations.frames import Frames
from linkwork.core.equations.model import (
    LawEquation,
    LinearEquation,
    LoopEquation,
    LoopEquations,
    Output,
    PointPath,
    RealEquation,
    Term,
    Variable,
    read_outputs,
)
from linkwork.core.equations.notation import Monomial, PhasorReader
from linkwork.core.equations.structure import (
    Bar,
    GraphNode,
    Structure,
    StructureBlock,
    released_links,
)
from linkwork.core.equations.writing import rows_of_parts
from linkwork.core.expression.grammar import CONSTANTS, parse, parse_equation
from linkwork.core.expression.tree import Binary, Name, Negative, Node, names_in
from linkwork.core.foundation.errors import ExpressionError, MechanismError, Problem, choices
from linkwork.core.foundation.lanes import (
    cis,
    display_value,
    hypot,
    is_structurally_nonzero,
    largest,
    phase,
    row_of,
    smallest,
)
from linkwork.core.foundation.names import GROUND, canonical, pretty
from linkwork.core.foundation.precise import PI
from linkwork.core.mechanism.description import Problems
from linkwork.core.mechanism.inputs import Input
from linkwork.core.mechanism.linkage import Linkage
from linkwork.core.mechanism.loops import Loops, PlainEquations
from linkwork.core.mechanism.part.guides import Cylinder

# ----------------------------------------------------------------------
# Derivation of the loop equations of a mechanism given by points and links.


def write_loops(linkage: Linkage) -> LoopEquations:
    """The loop equations of a linkage: unknowns are link angles and slider lengths.

    Raises
    ------
    MechanismError
        If inputs contradict each other or do not determine the motion; names the free links or the
        conflicting parts.
    """
    writer = _LoopWriter(linkage)
    return writer.write()


@dataclass
class _LoopWriter:
    linkage: Linkage
    released: tuple[Bar, ...] = ()
    surplus: Problem | None = None
    problems: Problems = field(default_factory=Problems)
    inputs: list[Variable] = field(default_factory=list)
    start: dict[str, float] = field(default_factory=dict)
    linear: list[LinearEquation] = field(default_factory=list)
    points: dict[str, PointPath] = field(default_factory=dict)
    base: dict[str, str | None] = field(default_factory=dict)

    def write(self) -> LoopEquations:
        """Derive all equations."""
        linkage = self.linkage
        where = f'mechanism "{linkage.name}"'
        self.frames = frames = Frames.of(linkage, self.problems)
        for bar in self.released:
            frames.release(*bar)
        self.problems.raise_any(where)
        self.contacts = contacts = rows_of_parts(frames, self.problems)
        self.problems.raise_any(where)
        self.linear = list(contacts.linear)
        self.rank = {body: k for k, body in enumerate(frames.bodies)}
        self.start = dict(frames.start)
        for k, which in enumerate(linkage.inputs):
            self._drive(which, linkage.input_key(k))
        self.problems.raise_any(where)
        driven = {v.name for v in self.inputs}
        angles = [a for b in frames.bodies if (a := frames.angle[b].variable) == self._angle_of(b)]
        unknowns = [_variable(n, kind) for n, kind in self._variables(angles) if n not in driven]
        structure = self._structure({v.symbol for v in unknowns})
        self._check_connected(structure)
        self.problems.raise_any(where)
        self._check_determined(structure)
        # only once: further releases would not help
        if self.problems and not self.released:
            without = self._without_surplus(structure, {v.symbol for v in unknowns})
            if without is not None:
                return without
        self.problems.raise_any(where)
        blocks = structure.blocks()
        loops = [
            self._loop(walk) for block in blocks for walk in sorted(block.loops, key=self._order)
        ]
        self._place_points(blocks)
        variables = (*unknowns, *self.inputs)
        outputs = self._outputs(variables)
        self.problems.raise_any(where)
        return LoopEquations(
            angle=linkage.angle,
            unknowns=tuple(unknowns),
            inputs=tuple(self.inputs),
            loops=(*loops, *contacts.loops),
            linear=tuple(self.linear),
            laws=tuple(contacts.laws),
            redundant=tuple(frames.released),
            surplus=self.surplus,
            outlines=contacts.outlines,
            measured=(*frames.measured, *contacts.measured),
            symbols=dict(frames.symbols),
            dimensions=dict(linkage.numbers.known),
            start=row_of(self.start[v.name] for v in variables),
            points=self.points,
            links={b: frames.angle[b] for b in linkage.links if b != GROUND},
            sliders={name: name for name in frames.lengths},
            outputs=outputs,
            fixed=linkage.links[GROUND],
            length_scale=_longest_link(linkage),
        )

    def _angle_of(self, body: str) -> str:
        """The name of a body's angle variable."""
        cylinder = {c.name: c.angle_name for c in self.linkage.of(Cylinder)}
        return cylinder.get(body, body)

    def _variables(self, angles: Sequence[str | None]) -> list[tuple[str, str]]:
        named = [(a, "angle") for a in angles if a is not None]
        lengths = [(length, "length") for length in self.frames.lengths]
        released = [(part.variable, "length") for part in self.frames.released]
        return named + lengths + released + self.contacts.variables

    def _drive(self, which: Input, key: tuple[str | int, ...]) -> None:
        """The variable of an input: an angle, a relative angle or a length."""
        kind, name = which.drives
        if kind in ("slider", "cylinder"):
            self.inputs.append(_variable(name, "length"))
            return
        link, against = name, which.relative_to or GROUND
        if kind == "joint":
            against, link = self.linkage.bodies_at(name)
            if link == GROUND:
                link, against = against, link
        angle, base = self.frames.angle[link], self.frames.angle[against]
        # both turn together
        if angle.variable == base.variable:
            self.problems.add(
                key,
                f'"{link}" cannot turn relative to "{against}": a slider or a weld holds its angle',
            )
        elif (
            kind == "link"
            and base.variable is None
            and angle.variable == link
            and not base.constant
        ):
            self.inputs.append(_variable(link, "angle"))
        else:
            column = which.column
            self.inputs.append(_variable(column, "angle"))
            self._relate(column, link, against)

    def _relate(self, column: str, link: str, against: str) -> None:
        """θ_link - θ_against - input = 0."""
        angle, base = self.frames.angle[link], self.frames.angle[against]
        terms = [(canonical(column), -1.0)]
        constant = self.frames.constant[link] - self.frames.constant[against]
        value = constant.high
        for sign, part in ((1.0, angle), (-1.0, base)):
            if part.variable is not None:
                terms.append((canonical(part.variable), sign))
                value += sign * self.frames.start[part.variable]
        # the input within half a turn, as sketched; the constant takes the whole turns
        wrapped = phase(cis(value))
        rounded = (constant + PI * (2.0 * round((wrapped - value) / math.tau))).high
        self.linear.append(
            LinearEquation(label=f"{link} against {against}", terms=tuple(terms), constant=rounded)
        )
        self.start[column] = wrapped

    def _structure(self, unknown: set[str]) -> Structure:
        frames = self.frames
        carriers: dict[str, list[str]] = {}
        for body in frames.bodies:
            for point in frames.places[body]:
                carriers.setdefault(point, []).append(body)
        incidences = [
            (body, point)
            for point, bodies in carriers.items()
            if len(bodies) > 1
            for body in bodies
        ]
        variables = []
        for body, point in incidences:
            turning = frames.angle[body].variable
            names = [] if turning is None else [canonical(turning)]
            for term in frames.places[body][point].sliding:
                names += term.names
            variables.append(tuple(n for n in dict.fromkeys(names) if n in unknown))
        relations = [
            tuple(name for name, _ in equation.terms if name in unknown) for equation in self.linear
        ]
        for law in self.contacts.laws:
            tied = dict.fromkeys(name for name, _ in (*law.terms, *law.inner))
            relations.append(tuple(name for name in tied if name in unknown))
        for loop in self.contacts.loops:
            tied = dict.fromkeys(n for term in loop.terms for n in term.names)
            relations += 2 * [tuple(name for name in tied if name in unknown)]
        return Structure(tuple(incidences), tuple(variables), tuple(relations), GROUND)

    def _check_connected(self, structure: Structure) -> None:
        """Report bodies that share no point with another body."""
        joined = {body for body, _ in structure.incidences}
        for link in self.linkage.links:
            if link != GROUND and link not in joined:
                self.problems.add(
                    ("links", link),
                    "is connected to nothing: let it share a point with another link",
                )

    def _check_determined(self, structure: Structure) -> None:
        form, names = structure.form()
        if form.square:
            return
        if form.missing:
            free = _subjects(names[k] for k in form.underdetermined)
            freedoms = f"{form.missing} degrees of freedom have no input: add {form.missing} inputs"
            if form.missing == 1:
                freedoms = "one degree of freedom has no input: add an input"
            example = next((link for link in free if link in self.linkage.links), None)
            text = f"{freedoms} or a link"
            if example is not None and not self.linkage.inputs:
                text = f'{freedoms}, for example link = "{example}"'
            self.problems.add(("input",), f"{text} (free to move: {', '.join(free)})")
        if form.surplus:
            tied = _subjects(names[k] for k in form.conflict_unknowns)
            self.problems.add(
                ("links",),
                f"{form.surplus} condition{'s' if form.surplus > 1 else ''} too many: "
                f"remove an input or a link among {', '.join(tied) or 'those joined to ground'}",
            )

    def _without_surplus(self, structure: Structure, unknown: set[str]) -> LoopEquations | None:
        """The equations with the lengths of some links released, if this makes them square."""
        form, _ = structure.form()
        if form.missing or not form.surplus:
            return None
        relations: list[LinearEquation | LawEquation] = [*self.linear, *self.contacts.laws]
        bars = released_links(self.frames, structure.incidences, relations, unknown, form.surplus)
        if len(bars) < form.surplus:
            return None
        try:
            return _LoopWriter(self.linkage, released=bars, surplus=self.problems[0]).write()
        except MechanismError:
            return None

    def _order(self, walk: tuple[GraphNode, ...]) -> list[int]:
        """Sort the loops of a block by the order of their links in the file."""
        return sorted(self.rank[name] for kind, name in walk if kind == "body")

    def _loop(self, walk: tuple[GraphNode, ...]) -> LoopEquation:
        """The closed vector sum along a walk of bodies and points."""
        crossings = _crossings(walk, self.rank)
        terms: list[Term] = []
        for start, body, end in crossings:
            terms += self.frames.between(body, start, end)
        left = tuple(t for t in terms if t.sign > 0)
        right = tuple(t.negated() for t in terms if t.sign < 0)
        label = " ".join(start for start, _, _ in crossings)
        return LoopEquation(label=label, left=left, right=right)

    def _place_points(self, blocks: Sequence[StructureBlock]) -> None:
        """Every point as its parent point plus terms, parents first."""
        self.base = {GROUND: None}
        for point in self.frames.places[GROUND]:
            if not self.frames.places[GROUND][point].sliding:
                self.points[point] = self._path(GROUND, point)
        for block in blocks:
            for parent, node in block.tree:
                if node[0] == "body":
                    self.base[node[1]] = parent[1]
                elif node[1] not in self.points:
                    self.points[node[1]] = self._path(parent[1], node[1])
        for body in self.frames.bodies:
            for point in self.frames.places[body]:
                if point not in self.points:
                    self.points[point] = self._path(body, point)

    def _path(self, body: str, point: str) -> PointPath:
        base = self.base[body]
        if base is not None:
            terms = self.frames.between(body, base, point)
            return PointPath(parent=base, terms=tuple(terms))
        place = self.frames.places[GROUND][point]
        fixed = Term.vector(place.fixed, Name(place.base, place.base))
        return PointPath(parent=None, terms=(fixed, *place.sliding))

    def _outputs(self, variables: tuple[Variable, ...]) -> dict[str, Output]:
        kinds = {v.symbol: v.kind for v in variables}
        kinds |= {canonical(link): "angle" for link in self.linkage.links if link != GROUND}
        known = self.linkage.numbers.known
        return read_outputs(self.linkage.outputs, kinds, self.points, known, self.problems)


def _variable(name: str, kind: str) -> Variable:
    """A link's angle, displayed as θ with the link's name unless the name is Greek."""
    symbol = canonical(name)
    stem = symbol.removesuffix("_angle")
    if kind != "angle" or pretty(stem) != stem:
        return Variable(name=name, kind=kind, symbol=symbol, shown=symbol)
    return Variable(name=name, kind=kind, symbol=symbol, shown=f"theta_{stem}")


def _crossings(walk: tuple[GraphNode, ...], order: Mapping[str, int]) -> list[tuple[str, str, str]]:
    """(entry point, body, exit point) along a walk; ground last, the driven side first."""
    count = len(walk)
    found = [
        (walk[k - 1][1], node[1], walk[(k + 1) % count][1])
        for k, node in enumerate(walk)
        if node[0] == "body"
    ]
    lowest = min(range(len(found)), key=lambda k: order[found[k][1]])
    # ground closes the loop, as in textbooks
    found = found[lowest + 1 :] + found[: lowest + 1]
    if len(found) > 2 and order[found[0][1]] > order[found[-2][1]]:
        backwards = [(end, body, start) for start, body, end in reversed(found)]
        found = backwards[1:] + backwards[:1]
    return found


def _subjects(columns: Iterable[str]) -> list[str]:
    """The bodies among column labels, or otherwise all subjects."""
    labels = [label.split() for label in columns]
    bodies = dict.fromkeys(parts[1] for parts in labels if parts[0] == "body")
    if bodies:
        return list(bodies)
    return list(dict.fromkeys(parts[-1] if len(parts) == 1 else parts[1] for parts in labels))


def _longest_link(linkage: Linkage) -> float:
    """The longest link: the largest extent of a link's points, ground included."""
    extents = []
    for local in linkage.shapes.local.values():
        x = [z.real for z in local.values()]
        y = [z.imag for z in local.values()]
        extents.append(hypot(largest(x) - smallest(x), largest(y) - smallest(y)))
    return largest(extents) or 1.0


# ----------------------------------------------------------------------
# Reader of forms B and C: loop equations in textbook notation, and plain equations.


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
        length_scale=_longest_length(loops),
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


def _longest_length(loops: list[LoopEquation]) -> float:
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
