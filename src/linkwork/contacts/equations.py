"""Equations of cams, curves and non-circular gears."""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable, Mapping
from dataclasses import replace
from fractions import Fraction

import numpy as np

from linkwork.contacts.cams import Cam
from linkwork.contacts.curves import Curve, NoncircularGear, coordinates
from linkwork.contacts.profiles import Outline, Undercut, follower_of, program_of, spline
from linkwork.core.equations.frames import PartRows, Place
from linkwork.core.equations.model import LawEquation, LoopEquation, MeasuredInPart, Term
from linkwork.core.equations.writing import write_rows
from linkwork.core.expression.derivatives import Jet, evaluate
from linkwork.core.expression.grammar import parse
from linkwork.core.expression.tree import Name, names_in
from linkwork.core.foundation.arrays import EPSILON, Array
from linkwork.core.foundation.lanes import leader_value, phase, phase as phase_of, uniform_value
from linkwork.core.foundation.names import canonical
from linkwork.core.foundation.precise import PI, joined, sin_cos
from linkwork.core.mechanism.bodies import Bodies
from linkwork.core.mechanism.description import Key
from linkwork.core.mechanism.part.guides import Slider, guide_named
from linkwork.core.table.rows import Piecewise

# ----------------------------------------------------------------------
# Equations of a point on a curve: its two coordinates are cubic splines.


@write_rows.register
def write_curve(curve: Curve, key: Key, rows: PartRows) -> None:
    """X = x(u), Y = y(u) in the frame of the curve's body."""
    outline = Outline.through(coordinates(curve.through, rows.frames.linkage), closed=curve.closed)
    at = (curve.on, curve.origin)
    place = on_outline(rows, curve.name, at, curve.point, outline, curve.closed)
    rows.put(curve.on, curve.point, place, key)


def add_law(
    rows: PartRows, label: str, coordinate: str, law: Piecewise, shown: tuple[str, str, int]
) -> None:
    """coordinate - law(u) = 0; ``shown``: the curve, x or y, and the order of the derivative."""
    name, axis, primes = shown
    count, called = len(law.breaks) - 1, f"{axis}_{name}"
    spline = f"{called} is the curve's {axis}, a cubic spline of {count} pieces"
    slope = f"{called}' is the derivative of {called}"
    rows.laws.append(
        LawEquation(
            label=label,
            terms=((canonical(coordinate), 1.0),),
            constant=0.0,
            law=law,
            shown=f"{axis}_{canonical(name)}",
            inner=((canonical(name), 1.0),),
            offset=0.0,
            meaning=slope if primes else spline,
            primes=primes,
        )
    )


def on_outline(
    rows: PartRows, name: str, at: tuple[str, str], point: str, outline: Outline, closed: bool
) -> Place:
    """The position of a point on a body's curve: its centre, then X and Y in its frame."""
    body, origin = at
    frames = rows.frames
    u = outline.nearest(rows.sketched_in(body, origin, point))
    rows.unknown(name, "angle" if closed else "length", u)
    here = complex(outline.at(np.array([u]))[0])
    terms = []
    for axis, start, law, unit in (
        ("x", here.real, outline.x, 1.0 + 0j),
        ("y", here.imag, outline.y, 1j),
    ):
        coordinate = f"{name}_{axis}"
        rows.unknown(coordinate, "length", start)
        terms.append(frames.vector_term(unit, None, body, coordinate))
        add_law(rows, f"{name} {axis}", coordinate, law, (name, axis, 0))
    rows.outlines[name] = (body, origin, outline.at(outline.samples()))
    return Place(frames.places[body][origin].fixed, tuple(terms), base=origin)


# ----------------------------------------------------------------------
# Equations of a cam, given by the follower's law of motion or by its outline.


@write_rows.register
def write_cam(cam: Cam, key: Key, rows: PartRows) -> None:
    """Write the equations for a given motion or a given outline."""
    (_programmed if cam.segments else _outlined)(rows, cam, key)


def _programmed(rows: PartRows, cam: Cam, key: Key) -> None:
    """A length or an angle of the follower is a function of the cam's angle."""
    frames = rows.frames
    motion = program_of(cam, frames.linkage)
    found = follower_of(cam, frames, motion)
    if isinstance(found, str):
        rows.problems.add((*key, "base"), found)
        return
    start = frames.linkage.numbers.precise_angle(cam.start)
    turned, at = frames.angles_of([(cam.cam, 1.0), (found.frame, -1.0)])
    swung, off = frames.angles_of(found.angles)
    if not turned:
        rows.held(cam.cam, found.frame, (*key, "cam"))
        return
    if not found.length and not swung:
        rows.held(str(cam.link), found.frame, (*key, "link"))
        return
    constant = found.constant + off
    if not found.length:  # equal angles may differ by whole turns
        now = (frames.sketched_sum(swung) + constant).high
        constant = constant - PI * (2.0 * round(now / math.tau))
    weights = {**({found.length: 1.0} if found.length else {}), **swung}
    rows.laws.append(
        LawEquation(
            label=cam.name,
            terms=_named(weights),
            constant=uniform_value(constant.high),
            law=motion.times(found.sign),
            shown=cam.name,
            meaning=_motion_text(cam, found.sign),
            inner=_named(turned),
            offset=uniform_value((at - start).high),
            kind="length" if found.length else "angle",
        )
    )
    try:
        outline = found.path.outline() * cmath.exp(-1j * start.high)
    except Undercut as cut:
        where = frames.linkage.angle.from_radians(cut.where)
        roller = " or a smaller roller" if cam.contact == "roller" else ""
        rows.problems.add(
            (*key, "segments"),
            f"undercut the cam {where:.4g} {frames.linkage.angle.value} after their start: "
            f"its outline would intersect itself; use a larger base circle{roller}",
        )
        return
    rows.outlines[cam.name] = (cam.cam, cam.center, outline)


def _named(weights: Mapping[str, float]) -> tuple[tuple[str, float], ...]:
    return tuple((canonical(name), weight) for name, weight in weights.items())


def _outlined(rows: PartRows, cam: Cam, key: Key) -> None:
    """A cam given by its outline."""
    linkage = rows.frames.linkage
    outline = Outline.through(coordinates(cam.profile, linkage), closed=True)
    point = cam.point
    if cam.slider is not None:
        guide = guide_named(linkage, cam.slider)
        assert guide is not None
        point = guide.point_on_line
    assert point is not None
    _check_hollows(rows, cam, outline, (*key, "profile"))
    at = (cam.cam, cam.center)
    if cam.contact == "flat":
        _flat(rows, cam, at, point, outline, key)
        return
    place = on_outline(rows, cam.name, at, point, outline, True)
    if cam.contact == "roller":
        place = _beside(rows, cam, at, point, place, outline)
    rows.put(cam.cam, point, place, key)


def _check_hollows(rows: PartRows, cam: Cam, outline: Outline, key: Key) -> None:
    """Reject concave outlines that a face or large roller would touch at two points."""
    place, bend = outline.deepest()
    where = f"({place.real:.4g}, {place.imag:.4g})"
    if cam.contact == "flat" and bend <= 0.0:
        rows.problems.add(
            key, f"is concave at {where}, where a flat face cannot follow: make it convex"
        )
    size = rows.frames.linkage.numbers(cam.radius)
    if 1.0 + size * bend <= 0.0:
        rows.problems.add(
            key,
            f"is too concave at {where}: its radius of curvature is {-1.0 / bend:.4g}, "
            "smaller than that of the roller",
        )


def _direction(rows: PartRows, name: str, outline: Outline, tangent: Term) -> None:
    """The curve's derivative as a direction times its magnitude T, the speed along the curve."""
    along = outline.slope(rows.frames.start[name])
    for axis, start, law in (("x", along.real, outline.x), ("y", along.imag, outline.y)):
        rows.unknown(f"{name}_d{axis}", "length", start)
        add_law(rows, f"{name} d{axis}", f"{name}_d{axis}", law.slope(), (name, axis, 1))
    rows.unknown(f"{name}_speed", "length", math.hypot(along.real, along.imag))
    rows.loops.append(
        LoopEquation(
            label=f"{name} direction",
            left=(tangent,),
            right=(
                Term(value=1.0 + 0j, length=canonical(f"{name}_dx")),
                Term(value=1j, turn=math.pi / 2.0, length=canonical(f"{name}_dy")),
            ),
        )
    )


def _beside(
    rows: PartRows, cam: Cam, at: tuple[str, str], point: str, place: Place, outline: Outline
) -> Place:
    """The centre of a roller: offset by its radius along the outward normal β."""
    frames = rows.frames
    radius = frames.linkage.numbers(cam.radius)
    along = outline.slope(frames.start[cam.name])
    normal = rows.unknown(f"{cam.name}_normal", "angle", phase_of(along / 1j))
    speed = canonical(f"{cam.name}_speed")
    tangent = Term(value=1j, turn=math.pi / 2, length=speed, phase=((normal, 1.0),))
    _direction(rows, cam.name, outline, tangent)
    size = canonical(f"{cam.name}_roller")
    frames.symbols[size] = radius
    arm = frames.vector_term(radius + 0j, Name(size, size), at[0])
    arm = replace(arm, phase=(*arm.phase, (normal, 1.0)))
    return Place(place.fixed, (*place.sliding, arm), base=place.base)


def _flat(
    rows: PartRows, cam: Cam, at: tuple[str, str], point: str, outline: Outline, key: Key
) -> None:
    """A face that touches the outline: common point and common direction."""
    frames, linkage = rows.frames, rows.frames.linkage
    contact = f"{cam.name}_contact"
    place = on_outline(rows, cam.name, at, point, outline, True)
    rows.put(cam.cam, contact, place, key)
    if cam.slider is not None:
        guide = guide_named(linkage, cam.slider)
        assert isinstance(guide, Slider)
        body, base = guide.link, point
        frame, line = guide.on, linkage.shapes.direction(guide.on, guide.line) * 1j
    else:
        assert cam.link is not None
        assert cam.pivot is not None
        body = frame = cam.link
        base = cam.pivot
        line = linkage.shapes.direction(body, (base, point))
    direction = complex(line.high)
    way = f"{cam.name}_way"
    term = frames.vector_term(line, None, frame, way)
    angle, other = frames.angle[frame], frames.angle[cam.cam]
    facing = direction * cmath.exp(1j * (angle.constant - other.constant))
    facing *= cmath.exp(1j * (frames.now(angle) - frames.now(other)))
    away = rows.sketched_in(at[0], cam.center, base)
    outwards = math.copysign(1.0, -(away * (1j * facing).conjugate()).real)
    samples = outline.samples()
    u = float(samples[(outwards * (outline.at(samples) / (1j * facing)).real).argmin()])
    frames.start[cam.name] = u
    here = complex(outline.at(np.array([u]))[0])
    frames.start[f"{cam.name}_x"], frames.start[f"{cam.name}_y"] = here.real, here.imag
    sign = 1.0 if (outline.slope(u) * facing.conjugate()).real > 0 else -1.0
    phase: dict[str, float] = {}
    for part, weight in ((angle, 1.0), (other, -1.0)):
        if part.variable is not None:
            symbol = canonical(part.variable)
            phase[symbol] = phase.get(symbol, 0.0) + weight
    sine, cosine = sin_cos(frames.constant[frame] - frames.constant[cam.cam])
    unit = line * joined(cosine, sine) * sign
    turning = tuple((name, weight) for name, weight in phase.items() if weight)
    tangent = Term.vector(unit.high, None, canonical(f"{cam.name}_speed"), turning)
    _direction(rows, cam.name, outline, tangent)
    turned = cmath.exp(1j * (other.constant + frames.now(other)))
    touch = linkage.sketched(cam.center) + here * turned
    face = direction * cmath.exp(1j * (angle.constant + frames.now(angle)))
    start = ((touch - linkage.sketched(base)) * face.conjugate()).real
    rows.unknown(way, "length", start)
    own_place = frames.places[body][base]
    frames.places[body][contact] = Place(own_place.fixed, (*own_place.sliding, term), base=base)


def _motion_text(cam: Cam, sign: float) -> str:
    """The follower's motion in words."""
    parts = [
        f"{part.law} over {part.over}" + (f" by {part.lift}" if part.law != "dwell" else "")
        for part in cam.segments
    ]
    way = "in the negative direction, " if sign < 0 else ""
    return f"{cam.name} is the follower's motion {way}as the cam turns: {', '.join(parts)}"


# ----------------------------------------------------------------------
# Equations of non-circular gears with the law ψ(φ) = k φ + g(φ), g periodic.


_PIECES = 360  # of a formula or pitch curve, each a polynomial of degree five
_HALVINGS = 24  # of the pieces of a formula; at a kink no number suffices
_MOST_PIECES = 20_000
_EXACT = 4e-15  # [rad] between a formula and its pieces, and in unit roundoffs:
_ROUNDINGS = 2.0
_ROUNDED = 2.0 * EPSILON * math.tau  # of the angles themselves
_INSIDE = np.array([0.25, 0.5, 0.75])  # of a piece, for the comparison with the formula
_DRAWN = 720  # points of a pitch curve
_MOST_LOBES = 12
_CLOSED = 1e-7  # relative closing error of a law after one turn of each wheel
_NEARLY = 1e-4  # the same for a pitch curve given by points


class _Misfit(Exception):
    """A law that does not give closed pitch curves: the key and the reason."""


@write_rows.register
def write_noncircular_gear(gear: NoncircularGear, key: Key, rows: PartRows) -> None:
    """q (θ2 - θa) - p (θ1 - θa) - q g(θ1 - θa - start) = constant, k = p/q."""
    frames, linkage = rows.frames, rows.frames.linkage
    first, second = gear.wheels
    inner, at = frames.angles_of([(first, 1.0), (gear.arm, -1.0)])
    if not inner:
        rows.held(first, gear.arm, (*key, "wheels"))
        return
    try:
        ratio, rest, off = _law(gear, linkage)
        _check_closed(gear, ratio, rest)
    except _Misfit as misfit:
        rows.problems.add((*key, misfit.args[0]), misfit.args[1])
        return
    p, q = float(ratio.numerator), float(ratio.denominator)
    weights, held = frames.angles_of([(second, q), (first, -p), (gear.arm, p - q)])
    offset = at - linkage.numbers.precise_angle(gear.start)
    law = rest.times(q)
    begin = uniform_value((offset - at).high)  # argument of the law at angle 0 of the first wheel
    if gear.phase is not None:
        total = held - linkage.numbers.precise_angle(gear.phase) * q + _at(law, begin)
    else:
        angle = uniform_value((frames.sketched_sum(inner) + offset).high)
        total = _at(law, angle) - frames.sketched_sum(weights)
        value = (held.high + _at(law, begin) - total.high) / q
        rows.measured.append(MeasuredInPart(gear.name, "phase", value, "angle"))
    constant = total.high
    rows.laws.append(
        LawEquation(
            label=gear.name,
            terms=_named(weights),
            constant=uniform_value(constant),
            law=law,
            shown=canonical(gear.name),
            inner=_named(inner),
            offset=uniform_value(offset.high),
            meaning=f"{gear.name} is the lead of the second wheel over uniform rotation",
            kind="angle",
            # in both places where the law enters: here, and in the constant
            error=2.0 * q * off,
        )
    )
    _draw(gear, ratio, rest, uniform_value(held.high - constant) / q, rows)


def _at(law: Piecewise, x: float) -> float:
    return float(law(np.array([x]))[0])


def _law(gear: NoncircularGear, linkage: Bodies) -> tuple[Fraction, Piecewise, float]:
    """The mean ratio k, the periodic rest g of ψ over one turn of φ, and how far it may be off."""
    if gear.table:
        radians = linkage.angle.radians
        table = np.array([[uniform_value(linkage.numbers(n)) for n in row] for row in gear.table])
        phi, psi = table.T * radians
        phi = phi - phi[0]
        phi[-1] = math.tau
        ratio = _ratio(psi[-1] - psi[0], "table")
        rest = psi - psi[0] - float(ratio) * phi
        rest[-1] = rest[0]
        begin = float(table[0, 0]) * radians
        return ratio, _shifted(spline(phi, rest, True), begin), _ROUNDED
    phi = np.linspace(0.0, math.tau, _PIECES + 1)
    if gear.law:
        return _pieces_of_formula(gear.law, phi, linkage)
    jet = _rolled(gear, phi, linkage)
    _check_falling(jet, "pitch_curve")
    over = float(jet.v[-1] - jet.v[0])
    # the closing error of a curve's points is distributed over the turn
    ratio = _ratio(over, "pitch_curve", _NEARLY)
    # the curve closes only approximately; the law must close exactly
    jet = jet * (float(ratio) * math.tau / over)
    return ratio, _through(phi, jet, float(ratio)), _ROUNDED


def _pieces_of_formula(law: str, phi: Array, linkage: Bodies) -> tuple[Fraction, Piecewise, float]:
    """The mean ratio and the rest of a formula, in pieces that are halved until they agree with it.

    Proofs are valid for these pieces, so they must equal the given law to rounding.
    """
    for _ in range(_HALVINGS):
        jet = _formula(law, phi, linkage)
        _check_falling(jet, "law")
        ratio = _ratio(float(jet.v[-1] - jet.v[0]), "law")
        rest = _through(phi, jet, float(ratio))
        inside = phi[:-1, None] + np.diff(phi)[:, None] * _INSIDE
        given = _formula(law, inside.ravel(), linkage)
        _check_falling(given, "law")
        wanted = given.v.reshape(inside.shape) - jet.v[0] - float(ratio) * inside
        rounding = (np.abs(given.v) + np.abs(inside.ravel() * given.d1)).reshape(inside.shape)
        off = np.abs(rest(inside.ravel()).reshape(inside.shape) - wanted)
        coarse = (off > _EXACT + _ROUNDINGS * EPSILON * rounding).any(axis=1)
        if not coarse.any():
            # between the places that are compared it may be a little larger
            return ratio, rest, _ROUNDED + 2.0 * float(off.max())
        # the middle of the points inside a piece
        halves = inside[coarse, 1]
        if len(phi) + len(halves) > _MOST_PIECES:
            break
        phi = np.sort(np.concatenate([phi, halves]))
    where = linkage.angle.from_radians(float(halves[0]))
    raise _Misfit("law", f"is not smooth, or changes too fast, near phi = {where:.6g}")


def _check_falling(jet: Jet, field: str) -> None:
    if not np.all(np.isfinite(jet.v)) or jet.d1.max() >= 0.0:
        raise _Misfit(field, "is not decreasing: external gears turn in opposite directions")


def _ratio(over: float, field: str, within: float = _CLOSED) -> Fraction:
    """Turns of the second wheel per turn of the first."""
    turns = over / math.tau
    found = Fraction(turns).limit_denominator(_MOST_LOBES)
    if abs(turns - found) > within or not found or abs(found.numerator) > _MOST_LOBES:
        raise _Misfit(
            field,
            f"turns the second wheel by {turns:.8g} of a turn while the first one turns once: "
            f"not a ratio of whole numbers up to {_MOST_LOBES}, so the pitch curves do not close",
        )
    return found


def _formula(law: str | None, phi: Array, linkage: Bodies) -> Jet:
    """ψ [rad] of a formula with its derivatives with respect to φ [rad]."""
    radians = linkage.angle.radians
    tree, known = parse(str(law)), linkage.numbers.known
    used = {node.name for node in names_in(tree)} & known.keys()
    names = {name: Jet.constant(uniform_value(known[name])) for name in used}
    one, none = np.full_like(phi, 1.0 / radians), np.zeros_like(phi)
    names["phi"] = Jet(phi / radians, one, none)
    with np.errstate(all="ignore"):
        found = evaluate(tree, names, linkage.angle)
    v, d1, d2 = (
        np.broadcast_to(part * radians, phi.shape) for part in (found.v, found.d1, found.d2)
    )
    return Jet(v, d1, d2)


def _rolled(gear: NoncircularGear, phi: Array, linkage: Bodies) -> Jet:
    """ψ by rolling the pitch curve r(α): ψ' = -r/(d - r) at α = β - φ, β the line of centres."""
    numbers = linkage.numbers
    points = [
        complex(uniform_value(numbers(x)), uniform_value(numbers(y))) for x, y in gear.pitch_curve
    ]
    outline = Outline.through(points, closed=True)
    way = _line_of_centres(gear, linkage, uniform_value)
    distance, line = abs(way), phase(way)
    u = outline.samples(64 * len(points) + 1)
    z = outline.at(u)
    around = np.unwrap(np.angle(z))
    if np.abs(z).min() <= 0.0 or np.diff(around).min() <= 0.0:
        raise _Misfit("pitch_curve", "is not star-shaped about its centre")
    if np.abs(z).max() >= distance:
        raise _Misfit("pitch_curve", f"reaches beyond the other centre, {distance:.6g} away")

    def speeds(angle: Array) -> tuple[Array, Array]:
        """ψ' and ψ'' at φ."""
        alpha = around[0] + np.mod(line - angle - around[0], math.tau)
        place = np.interp(alpha, around, u)
        for _ in range(4):  # Newton: arg z(u) = α
            x, y = outline.x.jet(place), outline.y.jet(place)
            z, z1 = x[0] + 1j * y[0], x[1] + 1j * y[1]
            place = place - np.angle(z * np.exp(-1j * alpha)) / (z1 / z).imag
        x, y = outline.x.jet(place), outline.y.jet(place)
        z, z1 = x[0] + 1j * y[0], x[1] + 1j * y[1]
        r, r1 = np.abs(z), np.abs(z) * (z1 / z).real / (z1 / z).imag
        return -r / (distance - r), r1 * distance / (distance - r) ** 2  # eq. (68)

    nodes, weights = np.polynomial.legendre.leggauss(6)
    half = np.diff(phi) / 2.0
    middle = (phi[1:] + phi[:-1]) / 2.0
    inside = speeds((middle[:, None] + half[:, None] * nodes).ravel())[0].reshape(len(half), -1)
    psi = np.concatenate([[0.0], np.cumsum(half * (inside @ weights))])
    return Jet(psi, *speeds(phi))


def _line_of_centres(
    gear: NoncircularGear, linkage: Bodies, one: Callable[[float], float]
) -> complex:
    """The vector from the first centre to the second in the arm."""
    a, b = (linkage.shapes.local[gear.arm][center] for center in gear.centers)
    return complex(one((b - a).real), one((b - a).imag))


def _through(phi: Array, jet: Jet, ratio: float) -> Piecewise:
    """Pieces of degree five with the values and two derivatives of ψ - k φ at their ends."""
    g, g1, g2 = jet.v - jet.v[0] - ratio * phi, jet.d1 - ratio, np.array(jet.d2)
    g[-1], g1, g2[-1] = g[0], np.array(g1), g2[0]
    g1[-1] = g1[0]
    h = np.diff(phi)
    rise = g[1:] - g[:-1] - h * g1[:-1] - h**2 / 2.0 * g2[:-1]
    slope = (g1[1:] - g1[:-1] - h * g2[:-1]) * h
    bend = (g2[1:] - g2[:-1]) * h**2
    powers = np.stack(
        [
            g[:-1],
            g1[:-1],
            g2[:-1] / 2.0,
            (10.0 * rise - 4.0 * slope + bend / 2.0) / h**3,
            (-15.0 * rise + 7.0 * slope - bend) / h**4,
            (6.0 * rise - 3.0 * slope + bend / 2.0) / h**5,
        ],
        axis=1,
    )
    return Piecewise(breaks=phi, powers=powers, sines=np.zeros((len(h), 3)))


def _shifted(law: Piecewise, by: float) -> Piecewise:
    """The function of x - by."""
    return Piecewise(breaks=law.breaks + by, powers=law.powers, sines=law.sines)


def _check_closed(gear: NoncircularGear, ratio: Fraction, rest: Piecewise) -> None:
    """Check that the second pitch curve closes: g must have the period of its turn."""
    field = next(f for f in ("law", "table", "pitch_curve") if getattr(gear, f))
    phi = np.linspace(0.0, math.tau, _DRAWN)
    if (float(ratio) + rest.jet(phi)[1]).max() >= 0.0:
        raise _Misfit(field, "is not decreasing: external gears turn in opposite directions")
    turns = abs(ratio.numerator)
    gap = np.abs(rest(phi) - rest(phi + math.tau / turns)).max()
    if gap > 1e3 * _CLOSED:
        raise _Misfit(
            field,
            f"turns the second wheel {turns} times while the first one turns "
            f"{ratio.denominator} times, but each time differently: its pitch curve does not close",
        )


def _draw(
    gear: NoncircularGear, ratio: Fraction, rest: Piecewise, shift: float, rows: PartRows
) -> None:
    """Both pitch curves: r1 = -ψ' d/(1 - ψ') and r2 = d - r1 along the line of centres.

    ψ = k φ + g(φ - start) + ``shift`` [rad].
    """
    linkage = rows.frames.linkage
    # families are not drawn, so any design can be used
    way, radians = _line_of_centres(gear, linkage, leader_value), linkage.angle.radians
    start = uniform_value(linkage.numbers(gear.start)) * radians
    spans = (1.0, abs(1.0 / ratio))
    for k, (suffix, span) in enumerate(zip(gear.curves, spans, strict=True)):
        phi = np.linspace(0.0, math.tau * float(span), _DRAWN)
        value, slope, _ = rest.jet(phi)
        steep = float(ratio) + slope
        # eq. (68): r1 and r2 in centre distances
        radius = (-steep if k == 0 else 1.0) / (1.0 - steep)
        angle = phi + start
        if k == 1:
            angle = float(ratio) * angle + value + shift
        points = (way if k == 0 else -way) * radius * np.exp(-1j * angle)
        rows.outlines[f"{gear.name}{suffix}"] = (gear.wheels[k], gear.centers[k], points)
