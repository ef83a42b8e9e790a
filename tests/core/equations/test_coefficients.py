"""Coefficients from the numbers of a file, and radii that hold for the mechanism of these."""

from __future__ import annotations

from collections import Counter
from itertools import pairwise

import numpy as np
import pytest
from flint import acb, arb, ctx

import linkwork as lw
from linkwork.contacts.profiles import Outline
from linkwork.core.expression.grammar import parse
from linkwork.core.expression.values import precise_value
from linkwork.core.foundation.arrays import UNIT_ROUNDOFF
from linkwork.core.foundation.precise import Precise
from linkwork.core.foundation.units import AngleUnit
from linkwork.core.mechanism.linkage import Linkage
from linkwork.families import designs_of
from tests.campaigns.radii import judge_radii

#: Random mechanisms of the campaign in which every kind of part and of shape occurs.
SOME = (43, 135, 167, 237, 378, 489, 564, 3, 4, 12)


@pytest.fixture(autouse=True)
def _digits() -> None:
    ctx.prec = 300


def exact(z: complex) -> acb:
    return acb(arb(z.real), arb(z.imag))


def dyad(p: acb, b: arb, q: acb, c: arb, near: complex) -> acb:
    """The intersection of two circles next to a place."""
    d = q - p
    x = (b * b - c * c + abs(d) ** 2) / (2 * abs(d))
    h = (b * b - x * x).sqrt()
    both = [p + d / abs(d) * acb(x, s * h) for s in (1, -1)]
    return min(both, key=lambda z: float(abs(z - exact(near)).mid()))


def link_in_line(c: complex, lengths: dict[str, float]) -> tuple[lw.Mechanism, float, float]:
    """A four-bar whose coupler carries C, which leads a dyad: how far its link d2 is off, and the
    radius.
    """
    points = {
        "O": 0j, "A": 30 + 20j, "B": 130 + 60j, "C": c, "G": 100 - 20j, "H": 160 - 10j,
        "E": 150 + 70j,
    }  # fmt: skip
    rows = "\n".join(f"{k} = [{z.real!r}, {z.imag!r}]" for k, z in points.items())
    given = "\n".join(f'"{k}" = {x!r}' for k, x in lengths.items())
    mechanism = lw.loads(
        f'format = 1\n[points]\n{rows}\n[links]\nground = ["O", "G", "H"]\ncrank = ["O", "A"]\n'
        'cp = ["A", "B", "C"]\nr = ["G", "B"]\nd1 = ["C", "E"]\nd2 = ["H", "E"]\n'
        f'[lengths]\n{given}\n[input]\nlink = "crank"\n'
    )
    position = mechanism.solve(at=75)
    at = {k: exact(z) for k, z in points.items()}

    def length(a: str, b: str) -> arb:
        known = lengths.get(f"{a} {b}")
        return abs(at[b] - at[a]) if known is None else arb(known)

    def radians(degrees: float) -> arb:
        return arb(degrees) * arb.pi() / 180

    def turn(angle: arb) -> acb:
        return acb(angle.cos(), angle.sin())

    near = {k: complex(*map(float, xy)) for k, xy in position.points.items()}
    a = length("O", "A") * turn(radians(75))
    b = dyad(a, length("A", "B"), at["G"], length("G", "B"), near["B"])
    way = (at["C"] - at["A"]) / (at["B"] - at["A"])
    if lengths:
        ab, ac, bc = length("A", "B"), length("A", "C"), length("B", "C")
        x = (ab * ab + ac * ac - bc * bc) / (2 * ab)
        way = acb(x, (ac * ac - x * x).sqrt()) / ab
    e = dyad(a + way * (b - a), length("C", "E"), at["H"], length("H", "E"), near["E"])
    off = ((e - at["H"]) / turn(radians(position["d2"]))).arg()
    radius = position.certificate.radius
    assert position.certificate.certified
    assert radius is not None
    return mechanism, abs(float(off.mid())), radius


@pytest.mark.parametrize("height", [1e-2, 1e-4, 1e-5, 1e-7])
def test_a_flat_triangle_of_the_sketch_is_certified_truly(height: float) -> None:
    along = 100 + 40j
    c = 30 + 20j + (0.6 + 1j * height / abs(along)) * along
    _, off, radius = link_in_line(c, {})
    assert off <= radius < 5e-14


@pytest.mark.parametrize("bent", [1e-6, 1e-8, 1e-10, 1e-12])
def test_a_flat_triangle_of_given_sides_is_certified_truly(bent: float) -> None:
    c = 30 + 20j + (0.5 + 1e-3j) * (100 + 40j)
    sides = {"A B": 108.0, "A C": 54.0, "B C": 54.0 + bent}
    mechanism, off, radius = link_in_line(c, sides)
    assert off <= radius < 5e-14
    # designs of a family have the same coefficients
    designs = designs_of(mechanism, {"B C": [54.5, 54.0 + bent]})
    alone = mechanism.model.compiled.table.loops.coefficient
    assert np.abs(designs.loops[1] - alone).max() <= 2.0 * UNIT_ROUNDOFF * 108.0


@pytest.mark.parametrize("number", SOME)
def test_printed_numbers_lie_within_the_radius_from_the_floats_of_the_file(number: int) -> None:
    counts: Counter[str] = Counter()
    assert not judge_radii(number, counts)
    assert counts["rows"] == 1


def test_decimals_in_line_stay_in_line() -> None:
    """0.1 + 0.2 is no 0.3 in floats: the link is straight all the same, in any unit."""
    points = "O=[0,0]\nG=[0.4,0]\nA=[0.1,0.1]\nB=[0.4,0.2]\nC=[0.2,0.15]\n"
    for unit in (1.0, 25.4, 1e-3):
        a, b, c = 0.1 * unit, 0.2 * unit, 0.3 * unit
        linkage = lw.loads(
            f'format=1\n[points]\n{points}[links]\nground=["O","G"]\nk=["O","A"]\n'
            f'c=["A","B","C"]\nr=["G","B"]\n[lengths]\n"A C"={a!r}\n"B C"={b!r}\n"A B"={c!r}\n'
            '[input]\nlink="k"\n'
        ).description
        assert isinstance(linkage, Linkage)
        shape = linkage.shapes
        assert shape.local["c"]["C"] == pytest.approx(a, rel=1e-15)
        assert shape.local["c"]["C"].imag == 0.0


def test_dimensions_solved_together_are_met_to_32_digits() -> None:
    """Six points, nine distances without a triangle: nothing can be placed one by one."""
    z = {"A": 0j, "B": 3 + 0.2j, "C": 6.1 - 0.3j, "P": 0.4 + 3j, "Q": 3.3 + 4j, "R": 5 + 2.6j}
    pairs = [(a, b) for a in "ABC" for b in "PQR"]
    lengths = {f"{a} {b}": float(f"{abs(z[b] - z[a]):.6g}") for a, b in pairs}
    rows = "\n".join(f"{k}=[{p.real},{p.imag}]" for k, p in (z | {"O": -1 - 1j}).items())
    given = "\n".join(f'"{k}"={x!r}' for k, x in lengths.items())
    linkage = lw.loads(
        f'format=1\n[points]\n{rows}\n[links]\nground=["O"]\nk=["O","A"]\n'
        f'c=["A","P","B","Q","C","R"]\n[lengths]\n{given}\n[[input]]\nlink="k"\n[[input]]\nlink="c"\n'
    ).description
    assert isinstance(linkage, Linkage)
    shape = linkage.shapes
    for pair, length in lengths.items():
        a, b = (exact(shape.local["c"][p]) + exact(shape.rest["c"][p]) for p in pair.split())
        assert abs(float((abs(b - a) - arb(length)).mid())) < 1e-29


@pytest.mark.parametrize(
    ("formula", "value"),
    [
        ("p - q", lambda p, q: p - q),
        ("sqrt(p^2 - q^2)", lambda p, q: (p * p - q * q).sqrt()),
        ("p*cos(q) - q*sin(p)", lambda p, q: p * _deg(q).cos() - q * _deg(p).sin()),
        ("exp(q/7) - ln(p)", lambda p, q: (q / 7).exp() - p.log()),
        ("asin(q/p) + acos(q/p) - 90 + p", lambda p, q: p),
        ("atan2(q, p)*pi/180 + e", lambda p, q: (q / p).atan() + arb(1).exp()),
        ("max(p, q)^2.5 - hypot(p, q)", lambda p, q: p ** arb(2.5) - (p * p + q * q).sqrt()),
    ],
)
def test_formulas_are_rounded_once(formula: str, value: object) -> None:
    assert callable(value)
    p, q = 40.1, 40.099999999
    names = {"p": Precise(p), "q": Precise(q)}
    found = precise_value(parse(formula), names, AngleUnit.DEGREE)
    true = value(arb(p), arb(q))
    assert found.high == float(true.mid())
    assert abs(float((arb(found.high) + arb(found.low) - true).mid())) < 1e-27


def _deg(x: arb) -> arb:
    return x * arb.pi() / 180


def test_a_spline_of_uneven_chords_is_the_one_through_its_floats() -> None:
    """A short chord next to long ones: its cubic has to end in the given point."""
    points = [0j, 100 + 1j, 100.001 + 1.002j, 200 + 50j, 300 + 0j, 301 - 90j]
    outline = Outline.through(points, closed=False)
    u = [arb(0)]
    for a, b in pairwise(points):
        u.append(u[-1] + abs(exact(b) - exact(a)))
    for law, part in ((outline.x, "real"), (outline.y, "imag")):
        for k in range(len(points) - 1):
            t = u[k + 1] - u[k]
            end = sum((arb(c) * t**n for n, c in enumerate(law.powers[k])), arb(0))
            size = sum(abs(c) * float(t.mid()) ** n for n, c in enumerate(law.powers[k]))
            true = arb(getattr(points[k + 1], part))
            assert abs(float((end - true).mid())) <= 2.0 * UNIT_ROUNDOFF * size


def test_loops_with_sums_that_cancel_are_certified_truly() -> None:
    """The crank of these loops is a difference; 60 digits from the floats of the file."""
    a, b = 100000.1, 99999.9
    position = lw.loops(
        dimensions={"a": a, "b": b},
        loops={"1": "(a^2 - b^2)/2000*e^(i*t) + 90*e^(i*p) = 75 + 70*e^(i*q)"},
        guess={"t": 60, "p": 30, "q": 80},
        inputs=lw.Input(variable="t"),
    ).solve(at=60)
    third = arb.pi() / 3
    tip = ((arb(a) ** 2 - arb(b) ** 2) / 2000) * acb(third.cos(), third.sin())
    near = tip + 90 * acb(_deg(arb(position["p"])).cos(), _deg(arb(position["p"])).sin())
    joint = dyad(tip, arb(90), acb(75), arb(70), complex(near))
    printed = _deg(arb(position["q"]))
    off = ((joint - 75) / acb(printed.cos(), printed.sin())).arg()
    assert position.certificate.radius is not None
    assert abs(float(off.mid())) <= position.certificate.radius
