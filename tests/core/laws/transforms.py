"""The same mechanism mirrored, turned and scaled, by rewriting its description."""

from __future__ import annotations

import cmath
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

import linkwork as lw
from linkwork.core.expression.grammar import parse, parse_equation
from linkwork.core.expression.tree import Binary, Call, Name, Negative, Node, names_in, text
from linkwork.core.foundation.names import canonical
from linkwork.core.mechanism.linkage import Linkage
from linkwork.core.mechanism.loops import Loops

__all__ = ["mirrored", "scaled", "turned"]

_I = Name("i")


def mirrored(mechanism: lw.Mechanism) -> lw.Mechanism:
    """Reflected in the x axis: y and all angles change sign."""
    description = mechanism.description
    if isinstance(description, Linkage):
        return _changed_linkage(mechanism, complex.conjugate, 1.0, -1.0, 0.0)
    angles = _angles(mechanism)
    swap: dict[str, Node] = {"i": Negative(_I), **{n: Negative(Name(n)) for n in angles}}
    return _changed_loops(mechanism, swap, {}, lambda node: node, 1.0, -1.0, 0.0)


def turned(mechanism: lw.Mechanism, turn: float) -> lw.Mechanism:
    """Everything rotated about the origin by ``turn`` [rad]."""
    description = mechanism.description
    if isinstance(description, Linkage):
        phasor = cmath.exp(1j * turn)
        return _changed_linkage(mechanism, lambda z: z * phasor, 1.0, 1.0, turn)
    swap: dict[str, Node] = {n: Binary("-", Name(n), Name("turned")) for n in _absolute(mechanism)}

    def phasor_of(angle: Node) -> Node:
        return Binary("^", Name("e"), Binary("*", _I, angle))

    # points that formulas refer to are turned already
    back = phasor_of(Negative(Name("turned")))
    assert isinstance(description, Loops)
    points: dict[str, Node] = {
        canonical(p): Binary("*", Name(canonical(p)), back) for p in description.points
    }
    forth = phasor_of(Name("turned"))
    return _changed_loops(
        mechanism, swap, points, lambda node: Binary("*", node, forth), 1.0, 1.0, turn
    )


def scaled(mechanism: lw.Mechanism, factor: float) -> lw.Mechanism:
    """All lengths multiplied."""
    if isinstance(mechanism.description, Linkage):
        return _changed_linkage(mechanism, lambda z: z * factor, factor, 1.0, 0.0)
    return _changed_loops(mechanism, {}, {}, lambda node: node, factor, 1.0, 0.0)


def _changed_linkage(
    mechanism: lw.Mechanism,
    place: Callable[[complex], complex],
    factor: float,
    sign: float,
    turn: float,
) -> lw.Mechanism:
    description = mechanism.description
    assert isinstance(description, Linkage)
    numbers = description.numbers
    moved = {p: place(description.sketched(p)) for p in description.points}
    return lw.Mechanism(
        replace(
            description,
            points={p: (z.real, z.imag) for p, z in moved.items()},
            lengths={k: numbers(n) * factor for k, n in description.lengths.items()},
            angles={k: sign * numbers(n) for k, n in description.angles.items()},
            sliders=tuple(
                replace(
                    slider,
                    offset=sign * factor * numbers(slider.offset),
                    angle=None if slider.angle is None else sign * numbers(slider.angle),
                )
                for slider in description.sliders
            ),
            inputs=_inputs(mechanism, factor, sign, turn),
            outputs={},
            **_changed_contacts(description, factor, sign),
        )
    )


def _changed_contacts(description: Linkage, factor: float, sign: float) -> dict[str, Any]:
    """Welds, gears, belts, racks, rolling wheels, cams and curves, scaled and mirrored."""
    numbers = description.numbers

    def length(given: Any) -> Any:
        return None if given is None else factor * numbers(given)

    def angle(given: Any) -> Any:
        return None if given is None else sign * numbers(given)

    def wheels(pair: Any) -> Any:
        radii = None if pair.radii is None else tuple(map(length, pair.radii))
        return replace(pair, radii=radii, phase=angle(pair.phase))

    def outline(points: Any) -> Any:
        return tuple((length(x), sign * length(y)) for x, y in points)

    def cam(part: lw.Cam) -> lw.Cam:
        # a mirrored cam turns the other way: its follower does everything backwards
        ahead = part.segments if sign > 0 else part.segments[::-1]
        size = factor if part.slider is not None else 1.0
        return replace(
            part,
            radius=length(part.radius),
            base=length(part.base),
            start=angle(part.start),
            segments=tuple(replace(s, lift=sign * size * numbers(s.lift)) for s in ahead),
            profile=outline(part.profile),
        )

    def noncircular(part: lw.NoncircularGear) -> lw.NoncircularGear:
        pairs = [(angle(x), angle(y)) for x, y in part.table]
        law = part.law
        if law is not None and sign < 0:
            law = f"-({law.replace('phi', '(-phi)')})"
        return replace(
            part,
            law=law,
            table=tuple(pairs if sign > 0 else pairs[::-1]),
            pitch_curve=outline(part.pitch_curve),
            start=angle(part.start),
            phase=angle(part.phase),
        )

    return {
        "welds": tuple(replace(w, angle=angle(w.angle)) for w in description.welds),
        "gears": tuple(map(wheels, description.gears)),
        "belts": tuple(map(wheels, description.belts)),
        "racks": tuple(replace(r, radius=length(r.radius)) for r in description.racks),
        "rolling": tuple(
            replace(r, radius=length(r.radius), circle_radius=length(r.circle_radius))
            for r in description.rolling
        ),
        "noncircular_gears": tuple(map(noncircular, description.noncircular_gears)),
        "cams": tuple(map(cam, description.cams)),
        "curves": tuple(replace(c, through=outline(c.through)) for c in description.curves),
    }


def _inputs(
    mechanism: lw.Mechanism, factor: float, sign: float, turn: float
) -> tuple[lw.Input, ...]:
    description, found = mechanism.description, []
    unit = description.angle.radians
    for which, variable in zip(description.inputs, mechanism.loop_equations.inputs, strict=True):
        rows = description.rows(which)
        held = len(rows) == 1
        start, stop = float(rows[0]), float(rows[-1])
        step = 0.0 if held else float(rows[1] - rows[0])
        absolute = which.drives[0] in ("link", "variable") and which.relative_to is None
        if variable.kind == "length":
            start, stop, step = (factor * x for x in (start, stop, step))
        else:
            shift = turn / unit if absolute else 0.0
            start, stop, step = sign * start + shift, sign * stop + shift, sign * step
        found.append(replace(which, from_=start, to=stop, step=None if held else step))
    return tuple(found)


def _angles(mechanism: lw.Mechanism) -> list[str]:
    return [v.symbol for v in mechanism.loop_equations.variables if v.kind == "angle"]


def _absolute(mechanism: lw.Mechanism) -> list[str]:
    """Angles against ground: those that stand alone in some exponent; others are relative."""
    equations = mechanism.loop_equations
    alone = {t.phase[0][0] for loop in equations.loops for t in loop.terms if len(t.phase) == 1}
    return [name for name in _angles(mechanism) if name in alone]


def _changed_loops(
    mechanism: lw.Mechanism,
    swap: Mapping[str, Node],
    swap_points: Mapping[str, Node],
    wrap: Callable[[Node], Node],
    factor: float,
    sign: float,
    turn: float,
) -> lw.Mechanism:
    description = mechanism.description
    assert isinstance(description, Loops)
    unit = description.angle.radians
    kinds = {v.symbol: v.kind for v in mechanism.loop_equations.variables}
    absolute = _absolute(mechanism)
    in_exponents = {n for t in description.loops.values() for n in _exponents(parse_equation(t))}

    def start(name: str) -> float:
        given = description.numbers(description.guess[name])
        if kinds[canonical(name)] == "length":
            return factor * given
        return sign * given + (turn / unit if canonical(name) in absolute else 0.0)

    loops = {}
    for label, equation in description.loops.items():
        left, right = parse_equation(equation)
        loops[label] = f"{text(_swapped(left, swap))} = {text(_swapped(right, swap))}"
    everywhere = {**swap, **swap_points}
    points = {p: text(wrap(_swapped(parse(t), everywhere))) for p, t in description.points.items()}
    dimensions: dict[str, Any] = {
        name: description.numbers(given) * (1.0 if canonical(name) in in_exponents else factor)
        for name, given in description.dimensions.items()
    }
    if turn:
        dimensions["turned"] = turn / unit
    return lw.Mechanism(
        replace(
            description,
            dimensions=dimensions,
            loops=loops,
            points=points,
            guess={name: start(name) for name in description.guess},
            inputs=_inputs(mechanism, factor, sign, turn),
            outputs={},
        )
    )


def _exponents(sides: tuple[Node, Node]) -> set[str]:
    """Names that occur inside an exponent."""
    found: set[str] = set()
    todo = list(sides)
    while todo:
        match todo.pop():
            case Binary("^", _, exponent):
                found |= {used.name for used in names_in(exponent)}
            case Binary(_, left, right):
                todo += [left, right]
            case Negative(operand):
                todo.append(operand)
            case _:
                pass
    return found


def _swapped(node: Node, swap: Mapping[str, Node]) -> Node:
    match node:
        case Name():
            return swap.get(node.name, Name(node.name))
        case Negative():
            return Negative(_swapped(node.operand, swap))
        case Binary():
            return Binary(node.operator, _swapped(node.left, swap), _swapped(node.right, swap))
        case Call():
            return Call(node.function, tuple(_swapped(a, swap) for a in node.arguments))
        case _:
            return node
