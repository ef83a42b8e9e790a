"""Lengths that would close a mechanism, and the position nearest to closure."""

from __future__ import annotations

import cmath
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cache

import numpy as np

from linkwork.core.equations.compiling import DirectionForm, NoDirectionForm, direction_form
from linkwork.core.expression.grammar import parse, parse_equation
from linkwork.core.expression.tree import Binary, Call, Name, Negative, Node, names_in
from linkwork.core.foundation.arrays import Array
from linkwork.core.foundation.errors import InputError
from linkwork.core.foundation.names import GROUND, canonical
from linkwork.core.mechanism.description import Description
from linkwork.core.mechanism.dimensions import Number
from linkwork.core.mechanism.linkage import Linkage
from linkwork.core.mechanism.loops import Loops
from linkwork.core.mechanism.varied_numbers import VariedNumber, with_numbers
from linkwork.core.motion.model import Model, model_of
from linkwork.core.motion.positions import Named, name_series, target_values
from linkwork.core.numerics.block_solver import Block
from linkwork.core.numerics.change_point import FoldFamily, locate_fold
from linkwork.core.numerics.decomposition import JoinedBlocks, closure_of
from linkwork.core.numerics.newton import nearest_miss
from linkwork.core.results.failure import Remedy
from linkwork.core.results.position import LinkEnd, NearestAssembly
from linkwork.core.table.loop_table import LoopTable


def dyad_form(block: Block) -> DirectionForm | None:
    """The form of one loop with two unknowns, which has a closed form; ``None`` of other blocks."""
    table = block.system
    if not isinstance(table, LoopTable) or table.unknowns != 2 or table.loops.rows != 1:
        return None
    try:
        return direction_form(table)
    except NoDirectionForm:
        return None


# ----------------------------------------------------------------------
# The lengths that a user can change, under the user's names.


@dataclass(frozen=True, kw_only=True)
class ChangeableLength:
    """A length, its value and the description with another value.

    ``signed``: whether it may be negative, like an offset.
    """

    name: str
    value: float
    changed: Callable[[float], Description]
    signed: bool = False

    @classmethod
    def of(cls, description: Description, table: str, key: str, value: float) -> ChangeableLength:
        """A number of a table of the description."""

        def changed(other: float) -> Description:
            return with_numbers(description, {VariedNumber(key, table, key): other})

        return cls(name=key, value=value, changed=changed)


def model_with(length: ChangeableLength, value: float) -> Model | None:
    """The mechanism with another value of one length; ``None`` if there is no such mechanism."""
    try:
        return model_of(length.changed(value))
    except InputError:
        return None


def lengths_of(description: Description) -> list[ChangeableLength]:
    """Named dimensions that are lengths, given and measured lengths, offsets, ground distances.

    The changed descriptions have loops only, without points and outputs that follow from them.
    """
    description = replace(description, trace=(), outputs={})
    if isinstance(description, Loops):
        description = replace(description, points={}, links={})
    match description:
        case Linkage():
            return [
                *_dimensions(description, _linkage_names(description)),
                *_between_points(description),
                *_offsets(description),
                *_ground(description),
            ]
        case Loops():
            return list(_dimensions(description, _loop_names(description)))
        case _:
            return []


def _dimensions(description: Description, used: set[str]) -> Iterator[ChangeableLength]:
    """Dimensions that are plain numbers and serve as a length somewhere."""
    for name, number in description.dimensions.items():
        if not isinstance(number, str) and canonical(name) in used:
            length = ChangeableLength.of(description, "dimensions", name, float(number))
            yield replace(length, signed=number <= 0)


def _linkage_names(linkage: Linkage) -> set[str]:
    """The dimensions in formulas of lengths, coordinates and offsets."""
    numbers: list[Number] = [*linkage.lengths.values()]
    numbers += [number for pair in linkage.points.values() for number in pair]
    numbers += [slider.offset for slider in linkage.sliders]
    return _resolved(linkage, [tree for number in numbers for tree in _tree(number)])


def _loop_names(loops: Loops) -> set[str]:
    return _resolved(loops, [s for text in loops.loops.values() for s in parse_equation(text)])


def _tree(number: Number) -> list[Node]:
    return [parse(number)] if isinstance(number, str) else []


def _resolved(description: Description, trees: list[Node]) -> set[str]:
    """The names that are factors or summands, also within the formulas of other dimensions."""
    formulas = {canonical(n): number for n, number in description.dimensions.items()}
    found: set[str] = set()
    while trees:
        for name in _lengths_in(trees.pop()):
            if name not in found:
                found.add(name)
                trees += _tree(formulas.get(name, 0.0))
    return found


def _lengths_in(node: Node) -> Iterator[str]:
    """Names outside exponents and arguments of functions: those inside are angles."""
    match node:
        case Name():
            yield node.name
        case Negative():
            yield from _lengths_in(node.operand)
        case Binary("^"):
            yield from _lengths_in(node.left)
        case Binary():
            yield from _lengths_in(node.left)
            yield from _lengths_in(node.right)
        case Call("sqrt" | "abs"):
            yield from (name.name for name in names_in(node))


def _between_points(linkage: Linkage) -> Iterator[ChangeableLength]:
    """Given lengths that are plain numbers, and measured ones."""
    ground = set(linkage.links[GROUND])
    lengths = {
        key: float(number)
        for key, number in linkage.lengths.items()
        # the distance of two ground points is changed by moving one of them, see _ground
        if not isinstance(number, str) and not set(key.split()) <= ground
    }
    lengths |= {" ".join(measured.points): measured.length for measured in linkage.shapes.measured}
    for key, value in lengths.items():
        yield ChangeableLength.of(linkage, "lengths", key, value)


def _offsets(linkage: Linkage) -> Iterator[ChangeableLength]:
    for slider in linkage.sliders:
        if not isinstance(slider.offset, str):
            length = ChangeableLength.of(linkage, "sliders", slider.name, float(slider.offset))
            yield replace(length, name=f"offset of {slider.name}", signed=True)


def _ground(linkage: Linkage) -> Iterator[ChangeableLength]:
    """The distance of every pivot on ground from the first one, along the line between them.

    Points that only carry lines are left alone: moving one would turn its line.
    """
    lines = {p for slot in linkage.slots for p in slot.line}
    lines |= {p for slider in linkage.sliders for p in slider.line}
    pivots = [p for p in linkage.links[GROUND] if p not in lines]
    numbers = all(not isinstance(n, str) for p in pivots for n in linkage.points[p])
    if not pivots or not numbers:
        return
    first = pivots[0]
    base = linkage.sketched(first)
    for pivot in pivots[1:]:
        span = linkage.sketched(pivot) - base
        pair = (f"{first} {pivot}", f"{pivot} {first}")
        if any(isinstance(linkage.lengths.get(key), str) for key in pair):
            continue

        def changed(
            value: float, pivot: str = pivot, span: complex = span, pair: tuple[str, str] = pair
        ) -> Description:
            place = base + span / abs(span) * value
            lengths = {k: value if k in pair else old for k, old in linkage.lengths.items()}
            points = {**linkage.points, pivot: (place.real, place.imag)}
            return replace(linkage, points=points, lengths=lengths)

        name = pair[1] if pair[1] in linkage.lengths else pair[0]
        yield ChangeableLength(name=name, value=abs(span), changed=changed)


# ----------------------------------------------------------------------
# Changes of single lengths with which the loops just close.


_MOST_LENGTHS = 40
_MOST_UNKNOWNS = 80
_STEP = 1e-6  # of the longest link, for derivatives by a length
_ROUND = 4e-15  # of the longest link: a length this near to a short decimal number is that number


def remedies_of(model: Model, number: int, v: Array) -> tuple[Remedy, ...]:
    """The lengths that alone would let a block just close, smallest change first.

    Parameters
    ----------
    number : int
        The block that cannot be closed.
    v : (N,)
        With the earlier blocks solved, and this block as near to closure as possible.

    Notes
    -----
    The block and those it depends on are one family of systems with the length as parameter; the
    value with which they just close is a fold of that family.
    """
    solver = model.compiled.solver
    members = closure_of(solver, number)
    joined = JoinedBlocks(solver, members)
    if joined.unknowns > _MOST_UNKNOWNS:
        return ()
    exact = all(len(solver.blocks[k].unknowns) == 1 or dyad_form(solver.blocks[k]) for k in members)
    found = []
    for length in lengths_of(model.description)[:_MOST_LENGTHS]:
        needed = _needed(model, length, members, v)
        if needed is not None:
            remedy = Remedy(length=length.name, now=length.value, needed=needed, exact=bool(exact))
            found.append(remedy)
    return tuple(sorted(found, key=lambda r: float(f"{abs(r.change):.9e}")))


def _needed(model: Model, length: ChangeableLength, members: list[int], v: Array) -> float | None:
    """The value of one length with which the blocks just close, if there is one."""
    solver = model.compiled.solver
    own = [solver.blocks[k].equations for k in members]
    joined = JoinedBlocks(solver, members)
    n, size = joined.unknowns, model.equations.length_scale

    @cache
    def at(p: float) -> JoinedBlocks:
        changed = model_with(length, p)
        if changed is None:
            raise ValueError(f"no mechanism has {length.name} = {p}")
        blocks = changed.compiled.solver.blocks
        # with another topology the unknowns would not correspond
        if [blocks[k].equations for k in members] != own:
            raise ValueError(f"other blocks with {length.name} = {p}")
        return JoinedBlocks(changed.compiled.solver, members)

    step = _STEP * size
    try:
        family = FoldFamily(
            at=at,
            inputs=v[solver.unknowns :],
            low=at(length.value - step),
            high=at(length.value + step),
            step=2.0 * step,
            size=size,
        )
    except (ValueError, IndexError):
        return None
    fold = locate_fold(family, v[joined.order[:n]], length.value)
    # a fold without a solution next to it would be no remedy
    if fold is None or not fold.checked or (fold.p <= 0.0 and not length.signed):
        return None
    # a special value, such as the sum of two lengths, is meant exactly
    short = float(np.round(fold.p, 9))
    return short if abs(short - fold.p) <= _ROUND * size else fold.p


# ----------------------------------------------------------------------
# The position nearest to closure of a mechanism whose loops do not close.


_MEETS = 1e-9  # of the longest link: ends this near to their joint meet it


def nearest_assembly(
    model: Model, at: float | Mapping[str, float] | None = None
) -> NearestAssembly:
    """The position near the guess at which the loops stay open by least.

    Every block of equations in turn is brought as near to zero as a damped iteration gets it,
    min ‖F(q, u)‖², with the blocks before it as they came out.

    Parameters
    ----------
    at : number or Mapping[str, number], optional
        Input value(s) in file units; the guess's own if left out.

    Raises
    ------
    UnknownNameError, InputError
        For input values that do not fit the mechanism.

    Notes
    -----
    A local minimum; where the mechanism can be closed, usually a position of it with gap 0.
    """
    solver, equations = model.compiled.solver, model.equations
    target = target_values(model, at)
    v = equations.start.copy()
    v[solver.unknowns :] = target * model.input_scale
    with np.errstate(all="ignore"):
        for block in solver.blocks:
            nearest, _ = nearest_miss(block.system, v[block.variables])
            # later blocks start from this position, though it may not close
            v[block.unknowns] = nearest[: len(block.unknowns)]
        f = model.compiled.table.residual(v[None, :])[0]
    none = np.zeros((1, len(v)))
    named = name_series(model, v[None, :], none, none, target[None, :], np.ones(1, dtype=bool))
    count = len(equations.loops)
    vectors = f[:count] + 1j * f[count : 2 * count]
    points = {p: (float(x.value[0]), float(y.value[0])) for p, (x, y) in named.points.items()}
    return NearestAssembly(
        mechanism=model.description.name,
        units=model.units,
        skeleton=model.skeleton,
        input={name: float(values[0]) for name, values in named.inputs.items()},
        unknowns={name: float(series.value[0]) for name, series in named.unknowns.items()},
        points=points,
        gaps={
            loop.label: (float(gap.real), float(gap.imag))
            for loop, gap in zip(equations.loops, vectors, strict=True)
        },
        gap=float(np.linalg.norm(vectors)),
        apart=open_ends(model, named, points),
    )


def open_ends(
    model: Model, named: Named, points: Mapping[str, tuple[float, float]], row: int = 0
) -> tuple[LinkEnd, ...]:
    """The ends of rigid links that lie elsewhere than the joints they belong to, in a row."""
    linkage = model.description
    if not isinstance(linkage, Linkage):
        return ()
    found = []
    for link, local in linkage.shapes.local.items():
        if link == GROUND or link not in named.links or len(local) < 2:
            continue
        angle = float(named.links[link].value[row]) * linkage.angle.radians
        first = next(iter(linkage.links[link]))
        for point, place in local.items():
            end = complex(*points[first]) + (place - local[first]) * cmath.exp(1j * angle)
            if abs(end - complex(*points[point])) > _MEETS * model.equations.length_scale:
                here = (float(end.real), float(end.imag))
                found.append(LinkEnd(link=link, point=point, joint=points[point], end=here))
    return tuple(found)
