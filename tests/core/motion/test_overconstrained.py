"""Linkages with more conditions than freedoms that move nevertheless, and those that do not."""

from __future__ import annotations

import cmath
import math

import numpy as np
import pytest

import linkwork as lw
from linkwork.core.foundation.statuses import Certification, Status

X = {"A1": 30.0, "A2": 50.0, "A3": -40.0}
Y = {"B1": 60.0, "B2": 80.0, "B3": -70.0}


def dixon(**changed: float) -> lw.Mechanism:
    """Dixon's first mechanism: every bar of K(3,3) between points of two perpendicular lines."""
    points = {a: (x, 0.0) for a, x in X.items()} | {b: (0.0, y) for b, y in Y.items()}
    links = {f"{a.lower()}{b.lower()}": (a, b) for a in X for b in Y}
    links["ground"] = links.pop("a1b1")
    return lw.linkage(
        name="Dixon I",
        points=points,
        links=links,
        lengths=changed,
        inputs=(lw.Input(link="a1b2", from_=100, to=125, step=5),),
    )


def cranks(places: tuple[float, ...], crank: complex, offset: float = 0.0) -> lw.Mechanism:
    """A coupler on parallel cranks; the last one stands a bit aside."""
    points: dict[str, tuple[float, float]] = {}
    links: dict[str, tuple[str, ...]] = {"ground": (), "coupler": ()}
    for k, x in enumerate(places):
        points[f"O{k}"] = (x, 0.0)
        tip = x + crank + (offset if k == len(places) - 1 else 0.0)
        points[f"P{k}"] = (tip.real, tip.imag)
        links["ground"] += (f"O{k}",)
        links["coupler"] += (f"P{k}",)
        links[f"crank{k}"] = (f"O{k}", f"P{k}")
    drive = lw.Input(link="crank0", from_=10, to=170, step=10)
    return lw.linkage(points=points, links=links, inputs=(drive,))


def test_dixons_mechanism_moves_as_dixon_says() -> None:
    """x_i → ±√(x_i² + t), y_j → ±√(y_j² - t) for one t at every position."""
    motion = dixon().sweep()
    assert motion.found.all()
    for row in range(len(motion)):
        at = {p: complex(motion[f"{p}.x"][row], motion[f"{p}.y"][row]) for p in (*X, *Y)}
        # both triples stay on perpendicular lines through one centre
        across = at["A2"] - at["A1"]
        along = at["B2"] - at["B1"]
        assert abs((across * along.conjugate()).real) <= 1e-9 * abs(across) * abs(along)
        unit = across / abs(across)
        s = ((at["B1"] - at["A1"]) * unit.conjugate()).real
        center = at["A1"] + s * unit
        t = {p: abs(at[p] - center) ** 2 - X[p] ** 2 for p in X}
        t |= {p: Y[p] ** 2 - abs(at[p] - center) ** 2 for p in Y}
        assert np.ptp(list(t.values())) <= 1e-8 * 80.0**2
    assert motion["A2.x"][0] != pytest.approx(motion["A2.x"][-1], abs=1.0)


def test_what_is_proved_leaves_the_redundant_link_out() -> None:
    motion = dixon().sweep()
    assert set(motion.certification) == {Certification.SUBSET_CERTIFIED}
    assert not motion.certified.any()
    (gap,) = motion.redundant.values()
    assert gap <= 1e-12
    position = dixon().solve()
    assert position.certificate.certification is Certification.SUBSET_CERTIFIED
    assert position.certificate.radius is not None
    assert set(position.redundant) == set(motion.redundant)
    # its length is no unknown of the results
    assert not any(name.endswith("_length") for name in motion.unknowns)


def test_bars_of_the_released_link_keep_their_length_in_every_configuration() -> None:
    found = dixon().configurations()
    assert len(found) == 8
    for position in found:
        for a, x in X.items():
            for b, y in Y.items():
                length = math.dist(position.points[a], position.points[b])
                assert length == pytest.approx(math.hypot(x, y), rel=1e-9)


def test_a_bar_of_another_length_makes_dixons_mechanism_rigid() -> None:
    with pytest.raises(lw.MechanismError) as raised:
        dixon(**{"A2 B2": 94.0})
    text = str(raised.value)
    assert text.startswith('1 problem in mechanism "Dixon I"\n  links  1 condition too many: ')
    assert " (it does not fit the sketch: " in text
    assert " needs the length " in text


@pytest.mark.parametrize("count", [3, 4, 5])
def test_any_number_of_parallel_cranks_turn_together(count: int) -> None:
    places = tuple(50.0 * k + 7.0 * k * k for k in range(count))
    mechanism = cranks(places, cmath.rect(30.0, 1.2))
    motion = mechanism.sweep()
    assert motion.found.all()
    assert len(motion.redundant) == count - 2
    for k in range(1, count):
        np.testing.assert_allclose(motion[f"crank{k}"], motion["crank0"], atol=1e-10)
    report = mechanism.check()
    assert (report.mobility_count, report.mobility_rank) == (3 - count, 1)
    assert "it is overconstrained, but it moves" in report.mobility_why
    assert f"{count - 2} condition" in report.mobility_why
    assert len(report.redundant) == count - 2


def test_a_crank_aside_fits_only_as_drawn() -> None:
    """The last crank is no parallel one: it fits into the drawn position and into few others."""
    with pytest.raises(lw.MechanismError) as raised:
        cranks((0.0, 50.0, 120.0), cmath.rect(30.0, 1.2), offset=5.0)
    assert "(as assembled it has 0 degrees of freedom for 1 input)" in str(raised.value)


def test_rows_that_a_redundant_link_does_not_fit_are_told() -> None:
    """At its dead point the third crank of a shaky truss is free to first order, no farther."""
    # the third bar lies on the common normal of its ends' velocities: mobility 1 by rank
    points = {"O": (0, 0), "P": (50, 0), "A": (0, 30), "B": (50, 30), "Q": (25, -20), "C": (25, 30)}
    links = {
        "ground": ("O", "P", "Q"),
        "first": ("O", "A"),
        "second": ("P", "B"),
        "coupler": ("A", "B", "C"),
        "third": ("Q", "C"),
    }
    shaky = lw.linkage(
        points=points,
        links=links,
        inputs=(lw.Input(link="first", from_=80, to=100, step=5),),
    )
    motion = shaky.sweep()
    assert [status.name for status in motion.status] == [
        "DOES_NOT_FIT", "DOES_NOT_FIT", "CONVERGED", "DOES_NOT_FIT", "DOES_NOT_FIT",
    ]  # fmt: skip
    assert shaky.solve(at=85).status is Status.DOES_NOT_FIT
    report = shaky.check()
    assert (report.mobility_count, report.mobility_rank) == (0, 1)
    assert report.mobility_why.endswith("may be infinitesimal only")


def test_a_flat_four_bar_is_movable_only_infinitely_little() -> None:
    links = {"ground": ("A", "D"), "crank": ("A", "B"), "coupler": ("B", "C"), "rocker": ("D", "C")}
    points = {"A": (0, 0), "B": (1, 0), "C": (3, 0), "D": (4, 0)}
    flat = lw.linkage(points=points, links=links, inputs=(lw.Input(link="crank"),))
    report = flat.check()
    assert (report.mobility_count, report.mobility_rank) == (1, 2)
    assert report.mobility_why.endswith("may be infinitesimal only")


def test_a_parallelogram_in_line_has_two_freedoms_there_and_one_beside() -> None:
    links = {"ground": ("A", "D"), "crank": ("A", "B"), "coupler": ("B", "C"), "rocker": ("D", "C")}
    points = {"A": (0, 0), "B": (1, 0), "C": (4, 0), "D": (3, 0)}
    flat = lw.linkage(points=points, links=links, inputs=(lw.Input(link="crank"),))
    report = flat.check()
    assert (report.mobility_count, report.mobility_rank) == (1, 2)
    assert report.mobility_why.endswith("near it the rank gives 1")


def test_at_a_change_point_no_way_is_taken_that_a_redundant_link_does_not_fit() -> None:
    """Straight on all cranks stay parallel; turned, the third would have another length."""
    mechanism = lw.example("parallel-cranks")
    straight = mechanism.sweep(from_=0, to=360, step=20, change_points="straight")
    assert straight.found.all()
    assert [limit.passed for limit in straight.limits] == ["", "straight", ""]
    np.testing.assert_allclose(straight["third"], straight["first"], atol=1e-9)
    turned = mechanism.sweep(from_=0, to=360, step=20, change_points="turn")
    assert [(limit.input, limit.passed) for limit in turned.limits] == [(0.0, ""), (180.0, "")]
    beyond = (turned["first"] > 180) & (turned["first"] < 360)
    assert {turned.status[k] for k in np.flatnonzero(beyond)} == {Status.DOES_NOT_FIT}
    assert turned.found[~beyond].all()
