"""Derivation of the loop equations of a mechanism given by points and links."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field

from linkwork.core.equations.frames import Frames
from linkwork.core.equations.model import (
    LawEquation,
    LinearEquation,
    LoopEquation,
    LoopEquations,
    Output,
    PointPath,
    Term,
    Variable,
)
from linkwork.core.equations.outputs import read_outputs
from linkwork.core.equations.parts import rows_of_parts
from linkwork.core.equations.structure import Bar, Node, Structure, StructureBlock, released_links
from linkwork.core.expression.tree import Name
from linkwork.core.foundation.errors import MechanismError, Problem
from linkwork.core.foundation.lanes import cis, hypot, largest, phase, row_of, smallest
from linkwork.core.foundation.names import GROUND, canonical, pretty
from linkwork.core.foundation.precise import PI
from linkwork.core.mechanism.description import Problems
from linkwork.core.mechanism.inputs import Input
from linkwork.core.mechanism.linkage import Linkage
from linkwork.core.mechanism.part.guides import Cylinder


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
            length_scale=_longest(linkage),
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

    def _order(self, walk: tuple[Node, ...]) -> list[int]:
        """Sort the loops of a block by the order of their links in the file."""
        return sorted(self.rank[name] for kind, name in walk if kind == "body")

    def _loop(self, walk: tuple[Node, ...]) -> LoopEquation:
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


def _crossings(walk: tuple[Node, ...], order: Mapping[str, int]) -> list[tuple[str, str, str]]:
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


def _longest(linkage: Linkage) -> float:
    """The longest link: the largest extent of a link's points, ground included."""
    extents = []
    for local in linkage.shapes.local.values():
        x = [z.real for z in local.values()]
        y = [z.imag for z in local.values()]
        extents.append(hypot(largest(x) - smallest(x), largest(y) - smallest(y)))
    return largest(extents) or 1.0
