"""The order, names and units of a file change no answer: random mechanisms, each rewritten."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, fields, replace
from itertools import combinations
from typing import Any

import numpy as np

import linkwork as lw
from linkwork.core.expression.grammar import parse, parse_equation
from linkwork.core.expression.tree import Binary, Name, Negative, Node, NumberNode, text
from linkwork.core.foundation.names import GROUND, canonical
from linkwork.core.foundation.units import AngleUnit
from linkwork.core.mechanism.linkage import Linkage
from linkwork.core.mechanism.loops import Loops
from linkwork.core.mechanism.part.index import PARTS
from linkwork.core.motion.solving import first_position
from linkwork.core.numerics.newton import NewtonOptions
from tests.campaigns.motion import FAMILIES
from tests.campaigns.snapshot_mechanisms import mechanism_of, names_of
from tests.core.laws.transforms import mirrored, scaled
from tests.core.motion.dyad_linkages import dyad_linkage
from tests.core.motion.written_loops import as_loops
from tests.described import described_as

__all__ = ["order_campaign", "partly_dimensioned", "permuted", "renamed"]

Rng = np.random.Generator
#: Of the longest link: residuals are below 1e-14, conditions of certified rows below 1e3 times it.
_ROUNDING = 1e-10
_CONDITION = 1e5  # rows nearer to a dead point are counted, not compared
_INCH = 25.4
_COUNTED = 8  # of every so many mechanisms configurations and circuits are counted
#: Radii grow with a last residual of a few roundoffs, which differs.
_RADII, _TINY = 2.0, 1e-11


def partly_dimensioned(number: int) -> lw.Mechanism:
    """A crank with dyads, links of 2 to 6 points, of which some dimensions are given.

    The sketch is off by up to 3 %; one in three has a planet wheel welded to a link.
    """
    rng = np.random.default_rng([41, number])
    linkage = described_as(Linkage, dyad_linkage(number))
    exact = {name: linkage.sketched(name) for name in linkage.points}
    size = max(abs(a - b) for a, b in combinations(exact.values(), 2))
    links = {name: list(points) for name, points in linkage.links.items()}
    lengths, angles = {}, {}
    for name, points in links.items():
        if name == GROUND or len(points) < 2:
            continue
        for _ in range(int(rng.integers(0, 7 - min(len(points), 6)))):
            points.append(f"q{len(exact)}")
            exact[points[-1]] = exact[points[0]] + _complex(rng, size / 4)
        pairs = rng.permutation([*combinations(points, 2)]).tolist()
        for a, b in pairs[: rng.integers(0, 2 * len(points) - 2)]:
            vertex = str(rng.choice(points))
            if vertex in (a, b) or rng.random() < 0.8:
                lengths[f"{a} {b}"] = abs(exact[a] - exact[b])
            else:
                turn = (exact[b] - exact[vertex]) / (exact[a] - exact[vertex])
                angles[f"{a} {vertex} {b}"] = math.degrees(np.angle(turn))
    off = size * float(rng.choice([1e-3, 1e-2, 3e-2]))
    places = {
        name: place if name in links[GROUND] else place + _complex(rng, off)
        for name, place in exact.items()
    }
    wheels: dict[str, Any] = {}
    joints = [(a, b, p) for a, b in combinations(links, 2) for p in set(links[a]) & set(links[b])]
    arms = [j for j in joints if GROUND not in j and len(links[j[0]]) > 1 < len(links[j[1]])]
    if number % 3 == 0 and arms:
        a, b, at = arms[int(rng.integers(len(arms)))]
        other = next(p for p in links[a] if p != at)
        links |= {"planet": [at], "sun": [other]}
        angle = float(rng.uniform(-180, 180)) if rng.random() < 0.5 else None
        wheels["welds"] = (lw.Weld(links=("planet", b), angle=angle),)
        wheels["gears"] = (
            lw.Gear(name="mesh", wheels=("sun", "planet"), centers=(other, at), arm=a,
                    teeth=(int(rng.integers(10, 40)), int(rng.integers(10, 40)))),
        )  # fmt: skip
    return lw.Mechanism(
        replace(
            linkage,
            points={name: (z.real, z.imag) for name, z in places.items()},
            links={name: tuple(points) for name, points in links.items()},
            lengths=lengths,
            angles=angles,
            **wheels,
        )
    )


def _complex(rng: Rng, size: float) -> complex:
    return complex(*rng.normal(0.0, size, 2))


def _shuffled(table: Mapping[str, Any], rng: Rng) -> dict[str, Any]:
    return {name: table[name] for name in rng.permutation(list(table)).tolist()}


def _directed(linkage: Linkage) -> set[str]:
    """Links whose angle is a number of the file: their first two points define its zero."""
    found = {GROUND}
    named: tuple[Any, ...] = (*linkage.parts, *linkage.inputs)
    for part in named:
        for entry in (getattr(part, f.name) for f in fields(part)):
            found |= {entry} if isinstance(entry, str) else set()
            found |= set(entry) if isinstance(entry, tuple) else set()
        for link, points in linkage.links.items():
            found |= {link} if getattr(part, "joint", None) in points else set()
    return found & set(linkage.links)


def permuted(mechanism: lw.Mechanism, rng: Rng) -> lw.Mechanism:
    """Every table in another order, pairs of points and wheels from their other end.

    Links named by parts and inputs keep their first two points, which define the zero of their
    angle; lines keep their direction.
    """
    linkage = described_as(Linkage, mechanism)
    kept = _directed(linkage)
    links = {}
    for name, points in linkage.links.items():
        first = 2 if name in kept - {GROUND} else 0
        links[name] = (*points[:first], *rng.permutation(points[first:]).tolist())
    lengths = {" ".join(_flipped(k.split(), rng)): n for k, n in linkage.lengths.items()}
    angles: dict[str, Any] = {}
    for key, number in linkage.angles.items():
        turned = rng.random() < 0.5
        written = f"-({number})" if isinstance(number, str) else -number
        angles[" ".join(key.split()[::-1]) if turned else key] = written if turned else number
    parts: dict[str, Any] = {}
    for table in PARTS:
        entries = [_swapped(part, rng) for part in getattr(linkage, table)]
        parts[table] = tuple(entries[k] for k in rng.permutation(len(entries)))
    return lw.Mechanism(
        replace(
            linkage,
            points=_shuffled(linkage.points, rng),
            links=_shuffled(links, rng),
            lengths=_shuffled(lengths, rng),
            angles=_shuffled(angles, rng),
            dimensions=_shuffled(linkage.dimensions, rng),
            **parts,
        )
    )


def _flipped(pair: list[str], rng: Rng) -> list[str]:
    return pair[::-1] if rng.random() < 0.5 else pair


def _swapped(part: Any, rng: Rng) -> Any:
    """A part with its ends exchanged, if they are alike."""
    if rng.random() < 0.5:
        return part
    match part:
        case lw.Gear() | lw.Belt() if part.phase is None:
            sizes: dict[str, Any] = {
                key: None if getattr(part, key) is None else getattr(part, key)[::-1]
                for key in ("radii", "teeth")
            }
            return replace(part, wheels=part.wheels[::-1], centers=part.centers[::-1], **sizes)
        case lw.Weld():
            given = part.angle
            angle = f"-({given})" if isinstance(given, str) else given if given is None else -given
            return replace(part, links=part.links[::-1], angle=angle)
        case lw.Spring() if part.between is not None:
            return replace(part, between=part.between[::-1])
    return part


def renamed(mechanism: lw.Mechanism, rng: Rng) -> tuple[lw.Mechanism, dict[str, str]]:
    """Points and links with other names, whose alphabetical order differs, and the new names."""
    linkage = described_as(Linkage, mechanism)
    old = [name for name in (*linkage.points, *linkage.links) if name != GROUND]
    names = {name: f"n{k}_" for name, k in zip(old, rng.permutation(len(old)), strict=True)}

    def new(name: str) -> str:
        return names.get(name, name)

    def keys(table: Mapping[str, Any]) -> dict[str, Any]:
        return {" ".join(map(new, key.split())): number for key, number in table.items()}

    inputs = []
    for which in linkage.inputs:
        given = {key: getattr(which, key) for key in ("link", "joint", "relative_to")}
        changes: dict[str, Any] = {key: new(name) for key, name in given.items() if name}
        inputs.append(replace(which, **changes))
    parts: dict[str, Any] = {
        t: tuple(p.find_spelling(new) for p in getattr(linkage, t)) for t in PARTS
    }
    found = replace(
        linkage,
        points=keys(linkage.points),
        links={new(name): tuple(map(new, points)) for name, points in linkage.links.items()},
        lengths=keys(linkage.lengths),
        angles=keys(linkage.angles),
        trace=tuple(map(new, linkage.trace)),
        inputs=tuple(inputs),
        masses=keys(linkage.masses),
        friction=keys(linkage.friction),
        clearances=keys(linkage.clearances),
        **parts,
    )
    return lw.Mechanism(found), names


def in_radians_and_inches(mechanism: lw.Mechanism) -> lw.Mechanism:
    """The same mechanism in other units; its formulas must not have angles."""
    found = described_as(Linkage, scaled(mechanism, 1.0 / _INCH))
    radians = found.angle.radians

    def angle(given: Any) -> Any:
        return None if given is None else found.numbers(given) * radians

    def changed(part: Any) -> Any:
        named = {"angle", "phase", "start", "pressure_angle"} & {f.name for f in fields(part)}
        changes = {name: angle(getattr(part, name)) for name in named}
        if isinstance(part, lw.Cam):
            lift = radians if part.slider is None else 1.0
            changes["segments"] = tuple(
                replace(s, over=angle(s.over), lift=found.numbers(s.lift) * lift)
                for s in part.segments
            )
        return replace(part, **changes)

    inputs = [
        which
        if which.drives[0] in ("slider", "cylinder")
        else replace(which, **{k: angle(getattr(which, k)) for k in ("start", "stop", "step")})
        for which in found.inputs
    ]
    parts: dict[str, Any] = {
        t: tuple(map(changed, getattr(found, t))) for t in PARTS if t != "loads"
    }
    return lw.Mechanism(
        replace(
            found,
            length="in",
            angle=AngleUnit.RADIAN,
            angles={key: angle(number) for key, number in found.angles.items()},
            inputs=tuple(inputs),
            **parts,
        )
    )


def rewritten_loops(mechanism: lw.Mechanism, rng: Rng) -> lw.Mechanism:
    """Loops, terms, sides, signs, dimensions and guesses in another order, with other names."""
    loops = described_as(Loops, mechanism)
    names = {name: f"k{k}" for name, k in zip(loops.dimensions, rng.permutation(99), strict=False)}
    labels = {name: f"loop {k}" for name, k in zip(loops.loops, rng.permutation(99), strict=False)}
    known = {canonical(name): new for name, new in names.items()}

    def spelled(name: Name) -> str:
        return known.get(name.name, name.spelling or name.name)

    equations = {}
    for label, equation in loops.loops.items():
        left, right = parse_equation(equation)
        terms = [*_terms(left, 1), *((node, -sign) for node, sign in _terms(right, 1))]
        terms = [terms[k] for k in rng.permutation(len(terms))]
        cut, sign = int(rng.integers(0, len(terms) + 1)), int(rng.choice([-1, 1]))
        sides = [
            " ".join(f"{'+' if s * own > 0 else '-'} ({text(node, spelled)})" for node, s in part)
            for own, part in ((sign, terms[:cut]), (-sign, terms[cut:]))
        ]
        equations[labels[label]] = " = ".join(side.removeprefix("+ ") or "0" for side in sides)
    dimensions = {names[name]: loops.numbers(given) for name, given in loops.dimensions.items()}
    return lw.Mechanism(
        replace(
            loops,
            loops=_shuffled(equations, rng),
            guess=_shuffled(loops.guess, rng),
            dimensions=_shuffled(dimensions, rng),
            points={p: text(parse(given), spelled) for p, given in loops.points.items()},
        )
    )


def _terms(node: Node, sign: int) -> list[tuple[Node, int]]:
    match node:
        case Binary("+", left, right):
            return [*_terms(left, sign), *_terms(right, sign)]
        case Binary("-", left, right):
            return [*_terms(left, sign), *_terms(right, -sign)]
        case Negative(operand):
            return _terms(operand, -sign)
        case NumberNode(value=0.0):
            return []
    return [(node, sign)]


# ------------------------------------------------------------------ comparison


def _near_start(mechanism: lw.Mechanism) -> lw.Mechanism:
    """A table of three rows around the sketch, written down."""
    model = mechanism.model
    inputs = []
    for k, which in enumerate(model.description.inputs):
        here = float(model.start_in_file_units[k])
        length = model.equations.inputs[k].kind == "length"
        step = 0.02 * model.equations.length_scale if length else 0.15 / model.units.angle.radians
        inputs.append(
            replace(which, from_=here - step, to=here + step, step=step, law=None, begin=None)
        )
    return mechanism.changed(inputs=tuple(inputs))


@dataclass(frozen=True)
class Rewritten:
    """A rewritten mechanism, and how its answers follow from the first one's.

    ``names``: new names of points and links, where they differ. Places are multiplied by ``factor``
    and, with ``sign`` -1, mirrored. ``links``: those whose angles have the same zero. ``frame``:
    two points of a link from which all places are seen.
    """

    mechanism: lw.Mechanism
    names: Mapping[str, str] = field(default_factory=dict)
    factor: float = 1.0
    sign: float = 1.0
    links: tuple[str, ...] = ()
    frame: tuple[str, ...] = ()

    def place(self, motion: lw.Motion, point: str, *, first: bool) -> Any:
        """The places of a point in the table's rows, as those of the second mechanism."""
        names = {} if first else self.names
        z = motion.trace(names.get(point, point))
        if self.frame:
            origin, tip = (motion.trace(p) for p in self.frame)
            with np.errstate(all="ignore"):  # rows without a position
                z = (z - origin) * np.abs(tip - origin) / (tip - origin)
        if first:
            z = self.factor * (z if self.sign > 0 else z.conj())
        return z[motion.asked]


def _differences(one: lw.Motion, other: Rewritten, counts: Counter[str]) -> list[str]:
    """What differs between a sweep and that of the rewritten mechanism."""
    two = other.mechanism.sweep()
    first, second = one.asked, two.asked
    if first.sum() != second.sum():
        return ["other rows"]
    rows = (one.condition[first] < _CONDITION) | ~one.found[first]
    counts["rows near a dead point, not compared"] += int((~rows).sum())
    wrong = []
    for what in ("found", "certified"):
        flags = getattr(one, what)[first][rows], getattr(two, what)[second][rows]
        if (flags[0] != flags[1]).any():
            wrong.append(f"{what}: {flags[0]}, then {flags[1]}")
    both = rows & one.found[first] & two.found[second]
    counts["rows compared"] += int(both.sum())
    proved = [radius[both] for radius in (one.radius[first], two.radius[second])]
    apart = [a > _RADII * b + _TINY for a, b in (proved, proved[::-1])]
    # on another ground the unknowns are others
    if np.any(apart) and not other.frame:
        wrong.append(f"radii {proved[0]}, then {proved[1]}")
    scale = other.mechanism.loop_equations.length_scale
    for name in one.points:
        gap = other.place(one, name, first=True) - other.place(two, name, first=False)
        far = float(np.abs(gap[both]).max(initial=0.0)) / scale
        if far > _ROUNDING:
            wrong.append(f"point {name}: {far:.2g} of the longest link away")
    for name in other.links:
        ways = [
            np.exp(1j * motion.links[link].value[motion.asked][both] * motion.units.angle.radians)
            for motion, link in ((one, name), (two, other.names.get(name, name)))
        ]
        gap = ways[1] - (ways[0] if other.sign > 0 else ways[0].conj())
        far = float(np.abs(gap).max(initial=0.0))
        if far > _ROUNDING:
            wrong.append(f"angle of {name}: {far:.2g} rad away")
    return wrong


def _linkage_forms(mechanism: lw.Mechanism, rng: Rng) -> Iterator[tuple[str, Rewritten]]:
    """The mechanism in other orders, names and units, mirrored, scaled, on another ground."""
    linkage = described_as(Linkage, mechanism)
    links = tuple(name for name in linkage.links if name != GROUND)
    angles = mechanism.loop_equations.links
    zeros = tuple(name for name in links if name in _directed(linkage) and name in angles)
    yield "permuted", Rewritten(permuted(mechanism, rng), links=zeros)
    other, names = renamed(mechanism, rng)
    yield "renamed", Rewritten(other, names=names, links=zeros)
    yield "mirrored", Rewritten(mirrored(mechanism), sign=-1.0, links=zeros)
    factor = float(10.0 ** rng.uniform(-3.0, 3.0))
    yield "scaled", Rewritten(scaled(mechanism, factor), factor=factor, links=zeros)
    if not linkage.noncircular_gears:  # their laws are in the unit of the file
        yield (
            "other units",
            Rewritten(in_radians_and_inches(mechanism), factor=1 / _INCH, links=zeros),
        )
    frame = next((p for p in linkage.links.values() if len(p) > 1), ())
    for ground in rng.permutation(links).tolist() if frame else ():
        try:
            other = mechanism.inversion(ground)
        except lw.LinkworkError:  # a cylinder, or what only ground may carry
            continue
        yield "inverted", Rewritten(other, frame=frame[:2])
        break


def _assembled(mechanism: lw.Mechanism) -> bool:
    """Whether Newton-Raphson finds a position from the sketch; why not takes long to explain."""
    model = mechanism.model
    start = first_position(model, model.start_inputs, NewtonOptions(), explained=False)
    return start.status.ok


def _counted(one: lw.Mechanism, other: lw.Mechanism, counts: Counter[str]) -> list[str]:
    """Whether both mechanisms have as many configurations and circuits."""
    found = [(len(m.configurations()), len(m.circuits(certify=False))) for m in (one, other)]
    counts["configurations and circuits compared"] += 1
    return [f"configurations and circuits {found}"] if found[0] != found[1] else []


def _made(number: int) -> tuple[str, lw.Mechanism]:
    """In turn: three partly dimensioned ones, one of every kind, and one given by loops."""
    if number % 5 < 3:
        return f"partly dimensioned {number}", partly_dimensioned(number)
    if number % 5 == 3:
        name = _EVERY[number // 5 % len(_EVERY)]
        return name, mechanism_of(name)
    if number % 2:
        return f"loops of dyads {number}", as_loops(dyad_linkage(number), seed=number)
    name = f"loop {FAMILIES[number // 10 % len(FAMILIES)]} {number}"
    return name, mechanism_of(name)


#: Every kind of joint and the library, as in snapshots.
_EVERY = tuple(
    name
    for name in np.random.default_rng(42).permutation(names_of(4_000)).tolist()
    if name.split()[0] in ("contact", "linkage", "variant", "library", "dyads", "pinned", "crank")
)


def order_campaign(part: int, count: int) -> tuple[Counter[str], list[str]]:
    """``count`` mechanisms, each rewritten; what their answers differ in."""
    counts: Counter[str] = Counter()
    false: list[str] = []
    for number in range(part * count, (part + 1) * count):
        rng = np.random.default_rng([43, number])
        # formulas of outputs and stops are not rewritten
        try:
            name, mechanism = _made(number)
            mechanism = _near_start(mechanism).changed(outputs={})
            if isinstance(mechanism.description, Linkage):
                mechanism = mechanism.changed(stops=())
        except lw.LinkworkError:
            counts["refused"] += 1
            continue
        if not isinstance(mechanism.description, Linkage | Loops):
            counts["plain equations, left out"] += 1
            continue
        counts["mechanisms"] += 1
        motion = mechanism.sweep() if _assembled(mechanism) else None
        counts["mechanisms not assembled"] += motion is None
        if isinstance(mechanism.description, Linkage):
            forms = _linkage_forms(mechanism, rng)
        else:
            forms = iter([("loops rewritten", Rewritten(rewritten_loops(mechanism, rng)))])
        try:
            for form, other in forms:
                counts[form] += 1
                wrong: list[str] = []
                if motion is not None:
                    wrong = _differences(motion, other, counts)
                    if form in ("permuted", "loops rewritten") and number % _COUNTED == 0:
                        wrong += _counted(mechanism, other.mechanism, counts)
                elif not other.frame:  # on another ground Newton-Raphson takes other steps
                    wrong = ["assembled"] if _assembled(other.mechanism) else []
                false += [f"{name}, {form}: {what}" for what in wrong]
        except lw.LinkworkError as error:
            false.append(f"{name}: {error}")
    return counts, false
