"""All configurations at one input: counts of the literature, laws, special positions, names."""

from __future__ import annotations

import cmath
import math
from typing import Any

import numpy as np
import pytest

import linkwork as lw
from linkwork import Completeness
from linkwork.circuits import assembling, assembling as block_roots
from linkwork.circuits.assembling import positions_at
from linkwork.circuits.homotopy import isolated_roots, isolated_roots as bilinear_family
from linkwork.circuits.homotopy.path_tracking import PathOptions
from tests.campaigns.configurations import judge_truss
from tests.core.laws.mechanisms import NAMES, mechanism_of
from tests.oracles.four_bar import FourBar
from tests.oracles.trusses import FIVE_LINKS, NINE_LINKS, SEVEN_LINKS, truss, truss_at
from tests.thinned import thinned


def looped(loops: dict[str, str], **guess: float) -> lw.Mechanism:
    """Loops driven by q."""
    drive = lw.Input(variable="q", from_=0, to=360, step=1)
    return lw.loops(name="loops", loops=loops, guess={"q": 60, **guess}, inputs=(drive,))


#: Peaucellier's B folded onto D leaves both far bars free to turn together.
FREE = {"peaucellier"}
#: A cam or a curve is no polynomial.
CURVED = {"curved-slot", "eccentric-cam", "garage-door"}


@pytest.mark.parametrize("name", thinned((name for name in NAMES if name not in CURVED), 3))
def test_the_position_of_the_sketch_is_one_of_the_configurations(name: str) -> None:
    mechanism = mechanism_of(name)
    position, found = mechanism.solve(throw=True), mechanism.configurations()
    assert found.completeness.complete is (name not in FREE)
    gaps = [np.abs(np.exp(1j * p.q) - np.exp(1j * position.q)).max(initial=0.0) for p in found]
    scale = mechanism.loop_equations.length_scale
    for value in position.sliders.values():
        assert min(min(abs(p - value) for p in c.sliders.values()) for c in found) < 1e-9 * scale
    assert min(gaps) < 1e-6
    for p in found:
        subset = p.certificate.certification is lw.Certification.SUBSET_CERTIFIED
        assert p.certificate.certified or (subset and p.redundant)
        assert p.residual < 1e-13
        assert p.input == position.input


@pytest.mark.parametrize(("graph", "count"), {**FIVE_LINKS, **SEVEN_LINKS}.items())
def test_random_trusses_have_the_known_number_of_configurations(graph: str, count: int) -> None:
    rng = np.random.default_rng(1)
    for _ in range(10):
        assert judge_truss(truss(graph, rng), count) == []


@pytest.mark.parametrize("graph", thinned(list(NINE_LINKS)[::3], 2))
def test_random_four_loop_trusses_have_the_known_number(graph: str) -> None:
    assert judge_truss(truss(graph, np.random.default_rng(2)), NINE_LINKS[graph]) == []


def test_a_truss_of_three_loops_is_proved_by_its_laman_number() -> None:
    found = truss("FCpv?", np.random.default_rng(1)).configurations()
    assert found.completeness is Completeness.PROVED
    assert found.message.endswith(
        "largest possible number; b1, b2, b3, b4, b5, b6: "
        "16 complex solutions, at most 16 by the Laman number of the links"
    )
    (paths,) = found.to_dict()["paths"]
    assert (paths["bound"], paths["theorem"]) == (16, "the Laman number of the links")


def test_one_loop_needs_no_theorem() -> None:
    assert lw.example("four-bar").configurations().message == Completeness.PROVED.value


def test_three_loops_with_a_slide_are_proved() -> None:
    found = _three_loops_with_a_slide().configurations()
    assert found.completeness is Completeness.PROVED
    assert found.message.endswith(
        "; a, b, c, d, f, s: 16 complex solutions, at most 16 by the Laman number of the links"
    )


def _three_loops_with_a_slide() -> lw.Mechanism:
    return looped(
        {
            "1": "2*e^(i*q) + 3*e^(i*a) + 2*e^(i*b) = 4 + 2.5*e^(i*c)",
            "2": "2*e^(i*q) + (3+i)*e^(i*a) + 2*e^(i*d) = 5 + 3*i + 2.2*e^(i*f)",
            "3": "2*e^(i*q) + 3*e^(i*a) + (2+0.6*i)*e^(i*b) + (1+0.7*i)*e^(i*f) = s - 2*i",
        },
        a=20, b=40, c=70, d=10, f=80, s=4,
    )  # fmt: skip


def test_special_trusses_are_not_proved() -> None:
    """Two links, 4 and 5, pinned together on four legs from link 6."""
    rng = np.random.default_rng(0)
    places = rng.uniform(-1.0, 1.0, (9, 2)) @ [1.0, 1.0j]
    ends, feet = [0, 1, 2, 3], [5, 6, 7, 8]
    assert truss_at("F?o~_", places).configurations().completeness is Completeness.PROVED
    places[feet] = 0.4 + 0.9j + 0.5 * cmath.exp(1j) * places[ends]  # similar to the ends
    found = truss_at("F?o~_", places).configurations()
    assert (found.paths[0].finite, found.paths[0].at_infinity) == (16, 2)
    assert found.completeness is Completeness.WITH_PROBABILITY_ONE
    assert found.message.endswith("complex solutions, at most 18 by the Laman number of the links")
    places[feet] = 0.4 + 0.9j + places[ends]  # four legs equal and parallel
    found = truss_at("F?o~_", places).configurations()
    assert found.completeness is Completeness.CONTINUUM
    assert "at most" not in found.message


def test_pins_that_almost_coincide_prove_nothing() -> None:
    """Two legs on one pin have 4 solutions at most, but 6 as soon as there are two pins."""
    for gap, grade in ((0.0, "PROVED"), (1e-12, "WITH_PROBABILITY_ONE")):
        found = _platform([0, 4, 1 + 3j], [3, 3.5, 2.8], [0, 2, 2 + gap]).configurations()
        assert (found.paths[0].finite, found.completeness.name) == (4, grade)


def test_lengths_in_millimetres_change_nothing() -> None:
    for seed in range(5):
        metres, millimetres = (
            truss("FCpv?", np.random.default_rng(seed), size=size) for size in (1.0, 1000.0)
        )
        for a, b in zip(metres.configurations(), millimetres.configurations(), strict=True):
            np.testing.assert_allclose(a.q, b.q, rtol=0, atol=1e-8)


SIX_LINK = {60: (1252.618473, 741.812501, 40.140378, 25.672098, -102.590796, -657.652654)}


def test_the_first_example_has_six_real_configurations() -> None:
    found = lw.example("coupled-six-link").configurations(at=60)
    assert [round(p["s6"], 6) for p in found] == list(SIX_LINK[60])
    assert found.completeness is Completeness.PROVED
    assert all(p.certificate.certified for p in found)


def test_the_rapier_has_four_ways() -> None:
    found = lw.example("rapier-drive").configurations(at=60)
    slides = sorted(round(p["s16"], 6) for p in found)
    assert slides == [-1172.005855, -792.629982, 216.940343, 343.520577]
    limited = lw.example("rapier-drive-limited").configurations(at=60)
    assert sorted(round(p["s16"], 6) for p in limited) == [-567.362061, 275.864911]


def _platform(ground: list[complex], legs: list[float], ends: list[complex]) -> lw.Mechanism:
    (x2, x3), (b2, b3) = (
        [f"({z.real!r} + {z.imag!r}*i)" for z in map(complex, w[1:])] for w in (ground, ends)
    )
    return lw.loops(
        name="3-RPR",
        dimensions={"l2": legs[1], "l3": legs[2]},
        loops={
            "1": f"l1*e^(i*t1) + {b2}*e^(i*p) - l2*e^(i*t2) - {x2} = 0",
            "2": f"l1*e^(i*t1) + {b3}*e^(i*p) - l3*e^(i*t3) - {x3} = 0",
        },
        guess={"l1": legs[0], "t1": 60, "t2": 60, "t3": 60, "p": 0},
        inputs=(lw.Input(variable="l1", from_=legs[0], to=legs[0] + 1, step=1),),
    )


def test_the_published_platform_has_its_six_positions() -> None:
    a, b, c = 17.04, 16.54, 20.84
    x = (a * a + c * c - b * b) / (2 * a)
    ends = [0, a, complex(x, math.sqrt(c * c - x * x))]
    found = _platform([0, 15.91, 10j], [14.98, 15.38, 12.00], ends).configurations()
    angles = sorted(round(p["p"] % 360, 8) for p in found)
    assert angles == [
        14.05520080, 33.55657866, 57.41257925, 122.20641823, 303.45054168, 357.28811230
    ]  # fmt: skip
    assert found.completeness is Completeness.PROVED


def test_a_congruent_platform_with_equal_legs_is_reported_as_a_continuum() -> None:
    base = [0, 15.91, 3 + 10j]
    found = _platform(base, [12, 12, 12], base).configurations()
    assert found.completeness is Completeness.CONTINUUM
    assert found.message.startswith("not proved: the mechanism can still move at this input")
    assert len(found) == 2  # the isolated ones, turned over
    assert found.paths[0].multiple == 4


def _legs(*kinds: str, seed: int, size: float = 1.0) -> lw.Mechanism:
    """A platform on three legs: R turns a link, P slides on the ground; PP does not turn it.

    The first leg stands on a crank.
    """
    rng = np.random.default_rng(seed)

    def place() -> str:
        x, y = (size * rng.uniform(-3, 3, 2)).tolist()
        return f"({x!r} + {y!r}*i)"

    guess: dict[str, float] = {}
    legs = []
    for k, kind in enumerate(kinds):
        terms = []
        for j, letter in enumerate(kind.removesuffix("R") or kind):
            if letter == "R":
                guess[f"t{k}"] = 30.0 * k
                terms.append(f"{float(size * rng.uniform(1, 4))!r}*e^(i*t{k})")
            else:
                guess[f"s{k}{j}"] = size
                terms.append(f"s{k}{j}*e^(i*{float(rng.uniform(0, 360))!r})")
        legs.append(" + ".join(terms))
    turning = "" if "PP" in kinds else "*e^(i*p)"
    if turning:
        guess["p"] = 10.0
    return looped(
        {
            f"{k}": f"{size!r}*e^(i*q) + {legs[0]} + {place()}{turning} = {place()} + {legs[k]}"
            for k in (1, 2)
        },
        **guess,
    )


LEGS = {
    ("RR", "RR", "RR"): 6,
    ("PR", "RR", "RR"): 6,
    ("PR", "PR", "RR"): 4,
    ("PR", "PR", "PR"): 2,
    ("PP", "RR", "RR"): 2,
    ("PP", "PR", "PR"): 1,
}


@pytest.mark.parametrize("size", [1.0, 1000.0])
@pytest.mark.parametrize(("kinds", "count"), LEGS.items())
def test_platforms_on_sliding_legs(kinds: tuple[str, ...], count: int, size: float) -> None:
    for seed in range(5):
        found = _legs(*kinds, seed=seed, size=size).configurations()
        (paths,) = found.paths
        assert (paths.finite, paths.expected, paths.failed, paths.multiple) == (count, count, 0, 0)
        assert paths.real == len(found)
        assert found.completeness.complete
        assert all(p.certificate.certified for p in found)
        assert found.completeness is Completeness.PROVED


@pytest.mark.parametrize(
    ("name", "count"),
    [("jansen-leg", 8), ("double-four-bar", 4), ("stephenson-far-crank", 6), ("four-bar", 2)],
)
def test_six_bars_and_the_jansen_leg(name: str, count: int) -> None:
    paths = lw.example(name).configurations().paths
    assert math.prod(p.finite // p.solved for p in paths) == count


@pytest.mark.parametrize("mirrored", [False, True])
def test_four_bars_are_open_where_norton_says_so(mirrored: bool) -> None:
    bar = FourBar(100, 40, 120, 80)
    for theta in (-70.0, 20.0, 130.0):
        points = bar.points(math.radians(theta), -1 if mirrored else 1)
        mechanism = lw.linkage(
            points=points,
            links={
                "ground": ("O2", "O4"),
                "crank": ("O2", "A"),
                "coupler": ("A", "B"),
                "rocker": ("O4", "B"),
            },
            inputs=(lw.Input(link="crank"),),
        )
        found = mechanism.configurations()
        assert found.names == ("open", "crossed")
        # Norton (4.10b), Design of Machinery, in his own frame: the root with the minus sign
        a, b, c, d = 40.0, 120.0, 80.0, 100.0
        k1, k2, k3 = d / a, d / c, (a * a - b * b + c * c + d * d) / (2 * a * c)
        cos, sin = math.cos(math.radians(theta)), math.sin(math.radians(theta))
        aa, bb, cc = cos - k1 - k2 * cos + k3, -2 * sin, k1 - (k2 + 1) * cos + k3
        open_, crossed = (
            2 * math.atan2(-bb + sign * math.sqrt(bb * bb - 4 * aa * cc), 2 * aa)
            for sign in (-1, 1)
        )
        for name, theta4 in (("open", open_), ("crossed", crossed)):
            turn = math.radians(found[name]["rocker"]) - theta4
            assert cmath.exp(1j * turn) == pytest.approx(1, abs=1e-12)
        sketch = "crossed" if mirrored else "open"
        assert found[sketch]["rocker"] == pytest.approx(mechanism.solve()["rocker"], abs=1e-9)


def test_slider_cranks_are_open_towards_larger_displacements() -> None:
    for text in ("2*e^(i*q) + 5*e^(i*t) = s + 0.3*i", "s + 0.3*i - 2*e^(i*q) = 5*e^(i*t)"):
        for guess in ({"t": 0, "s": 6}, {"s": 6, "t": 0}):
            found = looped({"l": text}, **guess).configurations()
            assert found.names == ("open", "crossed")
            assert found["open"]["s"] > found["crossed"]["s"]


def test_a_name_stays_on_its_branch_over_the_whole_turn() -> None:
    mechanism = lw.example("four-bar")
    motion = mechanism.sweep(step=10)
    for k, at in enumerate(range(0, 361, 10)):
        position = mechanism.solve(at, configuration="open")
        turn = math.radians(position["rocker"] - motion["rocker"][k])
        assert cmath.exp(1j * turn) == pytest.approx(1, abs=1e-12)


def test_a_slide_that_only_directs_itself_is_one_assembly() -> None:
    shaper = looped({"l": "2*e^(i*q) + 5*i = s*e^(i*t)"}, t=60, s=3)
    found = shaper.configurations()
    assert found.names == ("configuration 1",)
    assert found[0]["s"] == pytest.approx(abs(2 * cmath.exp(1j * math.pi / 3) + 5j))
    assert found.completeness is Completeness.PROVED
    assert found.message.endswith("s and t turned around, with s < 0, are the same assembly")
    offset = looped({"l": "2*e^(i*q) + 5*i = (s + i)*e^(i*t)"}, t=60, s=3)
    assert offset.configurations().names == ("open", "crossed")
    twice = looped(  # s stands along another direction, too
        {"l": "2*e^(i*q) + 5*i = s*e^(i*t)", "m": "s + 3*e^(i*a) = u*e^(i*20)"},
        t=60, s=3, a=0, u=9,
    )  # fmt: skip
    assert len({round(p["s"], 6) for p in twice.configurations()}) == 2
    seen = lw.example("inverted-slider-crank")  # the lever's end tells the two apart
    assert len(seen.configurations()) == 2


@pytest.mark.parametrize(
    ("ends", "legs", "finite"),
    [
        ([0, 2, 0.5 + 1.5j], [3, 3.5, 2.8], 4),  # similar to the base, smaller
        ([0, 4, 1 + 3j], [3, 3.5, 2.8], 4),  # congruent with it
        ([0, 2, 2], [3, 3.5, 2.8], 4),  # two legs on one pin
        ([0, 2, 0.5], [3, 3.5, 2.8], 6),  # pins in line
    ],
)
def test_special_platforms_lose_solutions_to_infinity_and_no_others(
    ends: list[complex], legs: list[float], finite: int
) -> None:
    found = _platform([0, 4, 1 + 3j], legs, ends).configurations()
    (paths,) = found.paths
    assert (paths.finite, paths.failed, paths.multiple) == (finite, 0, 0)
    assert paths.finite + paths.at_infinity == paths.paths == paths.expected
    assert found.completeness.complete
    assert all(p.certificate.certified for p in found)


def test_a_dead_point_is_one_double_configuration_without_certificate() -> None:
    bar = looped({"l": "4*e^(i*q) + 2*e^(i*a) = 4 + 1.5*e^(i*b)"}, a=10, b=60)
    dead = math.degrees(math.acos((32 - 3.5**2) / 32))
    found = bar.configurations(at=dead)
    assert (found.completeness, found.names) == (Completeness.MULTIPLE, ("double",))
    assert not found[0].certificate.certified
    assert found[0].residual < 1e-12
    assert found.paths[0].multiple == 2
    assert "dead point or change point" in found[0].message
    assert len(bar.configurations(at=dead - 0.01)) == 2
    beyond = bar.configurations(at=dead + 0.01)
    assert (len(beyond), beyond.completeness) == (0, Completeness.PROVED)


def test_a_kite_folded_together_can_still_move() -> None:
    kite = looped({"l": "2*e^(i*q) + 3*e^(i*a) = 2 + 3*e^(i*b)"}, a=0, b=60)
    assert kite.configurations().completeness is Completeness.PROVED
    folded = kite.configurations(at=0)
    assert (folded.completeness, len(folded)) == (Completeness.CONTINUUM, 0)


def test_later_blocks_are_solved_for_every_configuration_before() -> None:
    found = lw.example("jansen-leg").configurations()
    assert [p.solved for p in found.paths] == [1, 2, 4]
    assert found.names[:3] == ("open-open-open", "open-open-crossed", "open-crossed-open")
    assert len(set(found.names)) == 8
    squeezer = lw.example("andrews-squeezer").configurations()
    assert [p.real for p in squeezer.paths] == [2, 2, 4]  # one dyad cannot reach the other


def test_too_many_configurations_are_not_listed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("linkwork.circuits.assembling._LARGEST", 64)
    loops = {f"l{k}": f"2*e^(i*q) + 9*e^(i*a{k}) = 5 + 8*e^(i*b{k})" for k in range(7)}
    guess = {f"{letter}{k}": 60.0 for k in range(7) for letter in "ab"}
    found = looped(loops, **guess).configurations()
    assert found.completeness is Completeness.NOT_LISTED
    assert found.message.endswith("there are more than 64 of them")
    assert len(found) == 0


def test_positions_at_gives_variables_inputs_and_proof() -> None:
    model = lw.example("four-bar").model
    found = positions_at(model, np.array([1.0]))
    assert found.v.shape == (2, 3)
    assert (found.v[:, 2] == 1.0).all()
    assert found.proof.holds.all()
    assert found.proof.radius.max() < 1e-12
    assert model.compiled.solver.residual(found.v).max() < 1e-15


def test_angles_are_those_near_the_guess() -> None:
    drive = looped({"l": "4*e^(i*q) + 6*e^(i*a) = 5 + 5*e^(i*b)"}, a=730, b=-700)
    for position in drive.configurations():
        assert abs(position["a"] - 730) <= 180
        assert abs(position["b"] + 700) <= 180


def test_lists_read_like_sequences() -> None:
    found = lw.example("four-bar").configurations(at=60)
    assert len(found) == 2
    assert [p.configuration for p in found] == ["open", "crossed"]
    assert found[1] is found["crossed"]
    with pytest.raises(lw.UnknownNameError, match=r"^there is no configuration \"opne\" of .* at "
                       r"this input \(configurations: open, crossed\)$"):  # fmt: skip
        _ = found["opne"]
    with pytest.raises(IndexError):
        _ = found[2]
    text = repr(found)
    assert text.startswith("Configurations of Four-bar linkage, open at crank = 60 deg\n  open  ")
    assert "certified" in text
    assert lw.example("four-bar").configurations(at=60).seed == found.seed


def test_angles_tied_to_an_input_keep_their_tie_far_from_the_guess() -> None:
    """A relative angle as input: whole turns of one angle are whole turns of the other."""
    mechanism = mechanism_of("joint as input")
    for at in (60.0, -60.0, 300.0):
        found = mechanism.configurations(at=at)
        assert found.completeness is Completeness.PROVED
        assert [p.certificate.certified for p in found] == [True, True]


def test_solve_takes_a_configuration_by_name() -> None:
    bar = lw.example("four-bar")
    position = bar.solve(60, configuration="crossed")
    assert position["rocker"] == bar.configurations(60)["crossed"]["rocker"]
    assert position.certificate.certified
    with pytest.raises(lw.UnknownNameError, match="there is no configuration"):
        bar.solve(60, configuration="closed")
    stuck = looped({"l": "4*e^(i*q) + 2*e^(i*a) = 4 + 1.5*e^(i*b)"}, a=10, b=60)
    position = stuck.solve(90, configuration="open")
    assert position.status is lw.Status.CANNOT_CLOSE
    gap = (
        'loop "l" cannot be closed at q = 90°: near the guess a gap of at least 2.15685 mm remains'
    )
    assert position.message.startswith(gap)
    assert position.message.endswith("; no configuration exists there")
    assert position.failure is not None
    # 2 + 1.5 do not reach from the driven point to the far pivot
    assert position.failure.gap == pytest.approx(4 * math.sqrt(2) - 3.5, rel=1e-12)
    with pytest.raises(lw.NotConvergedError, match=f"^{gap}"):
        stuck.solve(90, configuration="open", throw=True)
    with pytest.raises(lw.InputError, match="plain equations"):
        lw.example("newton-inflection").solve(configuration="open")


def test_a_configuration_has_no_steps_from_the_guess() -> None:
    options: tuple[dict[str, Any], ...] = ({"from_guess": True}, {"with_steps": True})
    for option in options:
        with pytest.raises(lw.InputError, match=r"^configuration= has no steps from a guess"):
            lw.example("four-bar").solve(60, configuration="open", **option)


def test_loops_that_say_the_same_twice_are_refused_with_a_reason() -> None:
    one = "2*e^(i*a) + 3*e^(i*b) + 4*e^(i*c) + 5*e^(i*d) = e^(i*q)"
    two = "4*e^(i*a) + 6*e^(i*b) + 8*e^(i*c) + 10*e^(i*d) = 2*e^(i*q)"
    found = looped({"1": one, "2": two}, a=0, b=100, c=190, d=280).configurations()
    assert found.completeness is Completeness.NOT_LISTED
    assert found.message.endswith("are not independent: one follows from the others")


def test_blocks_of_many_loops_are_not_tried() -> None:
    loops = {
        str(k): f"{k + 3}*e^(i*a{k}) + 2*e^(i*b{k}) + e^(i*q) = 3 + e^(i*a{(k + 1) % 7})"
        for k in range(7)
    }
    found = looped(loops, **{f"{c}{k}": 10.0 for k in range(7) for c in "ab"}).configurations()
    assert found.completeness is Completeness.NOT_LISTED
    assert "are 7 coupled loops; paths are followed for at most 6" in found.message


def test_a_random_start_that_was_not_confirmed_makes_no_claim(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    mechanism = _three_loops_with_a_slide()
    monkeypatch.setattr(bilinear_family, "bound_by_sums", lambda *_: None)
    monkeypatch.setattr(isolated_roots, "_KNOWN", {})
    found = mechanism.configurations()
    assert found.completeness is Completeness.WITH_PROBABILITY_ONE
    assert found.message.endswith("16 complex solutions, at most 20 by Bézout's theorem")
    monkeypatch.setattr(isolated_roots, "_KNOWN", {})
    monkeypatch.setattr(isolated_roots, "read_sets", lambda topology: iter(()))
    monkeypatch.setattr(isolated_roots, "write_set", lambda kept: None)
    monkeypatch.setattr(isolated_roots, "_TRIES", 1)
    assert mechanism.configurations().completeness is Completeness.NOT_PROVED


def test_two_solutions_that_settle_on_one_position_make_no_claim(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    bar = lw.example("four-bar").model
    once = positions_at(bar, np.array([1.0]))
    settled = assembling._polish_roots

    def merged(*arguments: Any) -> tuple[np.ndarray, ...]:
        end, good, iterations = settled(*arguments)
        end[1] = end[0]
        return end, good, iterations

    monkeypatch.setattr(assembling, "_polish_roots", merged)
    found = positions_at(bar, np.array([1.0]))
    assert (len(once.v), len(found.v)) == (2, 1)
    assert found.completeness is Completeness.NOT_PROVED


def test_lost_paths_are_told(monkeypatch: pytest.MonkeyPatch) -> None:
    mechanism = truss("Ds[", np.random.default_rng(5))
    monkeypatch.setattr(block_roots, "roots_of_two_loops", lambda _: None)
    mechanism.configurations()
    for care in ("BOLD", "CAREFUL"):
        monkeypatch.setattr(isolated_roots, care, PathOptions(attempts=3))
    found = mechanism.configurations()
    assert (found.completeness, len(found)) == (Completeness.NOT_PROVED, 0)
    assert found.message.startswith("not proved: solution paths were lost")
    assert found.paths[0].failed == 6


def test_sweep_starts_from_a_configuration() -> None:
    bar = lw.example("four-bar")
    motion = bar.sweep(configuration="crossed", step=5)
    assert motion.certified.all()
    wanted = bar.solve(at=60, configuration="crossed")["rocker"]
    turn = math.radians(motion["rocker"][12] - wanted)
    assert cmath.exp(1j * turn) == pytest.approx(1, abs=1e-12)
    with pytest.raises(lw.UnknownNameError, match=r"at its guess's input \(configurations: open"):
        bar.sweep(configuration="folded")
