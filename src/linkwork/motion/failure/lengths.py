"""The lengths that a user can change, under the user's names."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

from linkwork.expression.grammar import parse, parse_equation
from linkwork.expression.tree import Binary, Call, Name, Negative, Node, names_in
from linkwork.foundation.errors import ExpressionError, InputError
from linkwork.foundation.names import GROUND, canonical
from linkwork.mechanism.description import Description
from linkwork.mechanism.dimensions import Number
from linkwork.mechanism.linkage import Linkage
from linkwork.mechanism.loops import Loops
from linkwork.mechanism.varied_number import VariedNumber, with_numbers
from linkwork.motion.model import Model, model_of

__all__ = ["ChangeableLength", "lengths_of", "model_with"]


@dataclass(frozen=True, kw_only=True)
class ChangeableLength:
    """A length, its value and the description with another value.

    ``signed``: whether it may be negative, like an offset.
    """

    name: str
    value: float
    changed: Callable[[float], Description]
    signed: bool = False


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
                *_given(description),
                *_measured(description),
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
        if isinstance(number, str) or canonical(name) not in used:
            continue

        def changed(value: float, name: str = name) -> Description:
            return with_numbers(description, {VariedNumber(name, "dimensions", name): value})

        yield ChangeableLength(name=name, value=float(number), changed=changed, signed=number <= 0)


def _linkage_names(linkage: Linkage) -> set[str]:
    """The dimensions in formulas of lengths, coordinates and offsets."""
    numbers: list[Number] = [*linkage.lengths.values()]
    numbers += [number for pair in linkage.points.values() for number in pair]
    numbers += [slider.offset for slider in linkage.sliders]
    return _resolved(linkage, [tree for number in numbers for tree in _tree(number)])


def _loop_names(loops: Loops) -> set[str]:
    trees: list[Node] = []
    for text in loops.loops.values():
        try:
            trees += parse_equation(text)
        except ExpressionError:  # such a mechanism cannot have been made
            continue
    return _resolved(loops, trees)


def _tree(number: Number) -> list[Node]:
    if not isinstance(number, str):
        return []
    try:
        return [parse(number)]
    except ExpressionError:
        return []


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


def _given(linkage: Linkage) -> Iterator[ChangeableLength]:
    """Lengths that are plain numbers; a ground distance moves the point."""
    ground = set(linkage.links[GROUND])
    for key, number in linkage.lengths.items():
        # the distance of two ground points is changed by moving one of them, see _ground
        if isinstance(number, str) or set(key.split()) <= ground:
            continue

        def changed(value: float, key: str = key) -> Description:
            return replace(linkage, lengths={**linkage.lengths, key: value})

        yield ChangeableLength(name=key, value=float(number), changed=changed)


def _measured(linkage: Linkage) -> Iterator[ChangeableLength]:
    for measured in linkage.shapes.measured:
        key = " ".join(measured.points)

        def changed(value: float, key: str = key) -> Description:
            return replace(linkage, lengths={**linkage.lengths, key: value})

        yield ChangeableLength(name=key, value=measured.length, changed=changed)


def _offsets(linkage: Linkage) -> Iterator[ChangeableLength]:
    for k, slider in enumerate(linkage.sliders):
        if isinstance(slider.offset, str):
            continue

        def changed(value: float, k: int = k) -> Description:
            parts = list(linkage.sliders)
            parts[k] = replace(parts[k], offset=value)
            return replace(linkage, sliders=tuple(parts))

        name = f"offset of {slider.name}"
        yield ChangeableLength(name=name, value=float(slider.offset), changed=changed, signed=True)


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
