"""Wheels roll without slipping, cams touch their followers, points stay on their curves."""

from __future__ import annotations

import cmath
import math
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from scipy.interpolate import CubicSpline

import linkwork as lw
from linkwork.contacts.profiles import Outline
from linkwork.core.mechanism.linkage import Linkage
from tests.core.laws.contacts import KINDS, contact, outline_points, xy
from tests.oracles.contact_geometry import Seen, gap_of_face, gap_of_point

Array = npt.NDArray[np.float64]
Complex = npt.NDArray[np.complex128]
three_seeds = pytest.mark.parametrize("seed", [11, 12, 13])


def seen(kind: str, seed: int) -> tuple[Linkage, Seen]:
    mechanism = contact(kind, seed)
    assert isinstance(mechanism.description, Linkage)
    return mechanism.description, Seen(mechanism, mechanism.sweep())


# ------------------------------------------------------------------ wheels


@three_seeds
@pytest.mark.parametrize("kind", [k for k in KINDS if k.startswith("gear")])
def test_teeth_in_mesh_move_with_the_same_velocity(kind: str, seed: int) -> None:
    linkage, motion = seen(kind, seed)
    assert linkage.gears
    for gear in linkage.gears:
        a, b = (motion.at(center) for center in gear.centers)
        sizes = gear.radii if gear.radii is not None else gear.teeth
        assert sizes is not None
        first, second = map(float, sizes)
        part = first / (first - second) if gear.internal else first / (first + second)
        pitch = a + part * (b - a)  # divides the line of centres in the ratio of the radii
        one, other = (
            motion.carried(wheel, center, pitch)
            for wheel, center in zip(gear.wheels, gear.centers, strict=True)
        )
        assert np.abs(one).max() > 0.1 or "ground" in gear.wheels
        np.testing.assert_allclose(one, other, rtol=0, atol=1e-10)


@three_seeds
@pytest.mark.parametrize("crossed", [False, True])
def test_both_rims_move_with_their_belt(crossed: bool, seed: int) -> None:
    linkage, motion = seen("belt crossed" if crossed else "belt open", seed)
    (belt,) = linkage.belts
    sizes = belt.radii if belt.radii is not None else belt.teeth
    assert sizes is not None
    r1, r2 = map(float, sizes)
    # the common tangent leaves the wheels along n; crossed, it is on the other side of the second
    side = -1.0 if crossed else 1.0
    n = complex((r1 - side * r2) / 60, math.sqrt(1 - ((r1 - side * r2) / 60) ** 2))
    one = motion.carried("left", "O", motion.at("O") + r1 * n)
    other = motion.carried("right", "P", motion.at("P") + side * r2 * n)
    along = n / 1j
    scale = 1.0  # the rims of teeth have those radii in some unit
    np.testing.assert_allclose(
        scale * (one / along).real, scale * (other / along).real, rtol=0, atol=1e-10
    )
    assert np.abs(one).min() > 1.0


@three_seeds
def test_the_rack_moves_with_the_rim_of_its_pinion(seed: int) -> None:
    linkage, motion = seen("rack", seed)
    (rack,) = linkage.racks
    s, t, o = (motion.at(p) for p in ("S", "T", "O"))
    along = (t - s) / np.abs(t - s)
    foot = s + ((o - s) * along.conj()).real * along
    assert np.abs(np.abs(foot - o) - float(rack.radius)).max() < 1e-9
    np.testing.assert_allclose(
        motion.carried("pinion", "O", foot), motion.rate("R"), rtol=0, atol=1e-10
    )


@pytest.mark.parametrize("side", [1, -1])
def test_a_wheel_on_a_line_rests_where_it_touches(side: int) -> None:
    linkage, motion = next(
        (linkage, motion)
        for linkage, motion in (seen("rolling on a line", seed) for seed in range(20))
        if side * (linkage.sketched("C") - linkage.sketched("S")).imag > 0
    )
    (rolling,) = linkage.rolling
    s, t, c = (motion.at(p) for p in ("S", "T", "C"))
    along = (t - s) / np.abs(t - s)
    way = motion.motion.sliders["x"].value
    touch = s + way * along
    np.testing.assert_allclose(np.abs(touch - c), float(rolling.radius), rtol=0, atol=1e-9)
    np.testing.assert_allclose(((c - touch) * along.conj()).real, 0.0, rtol=0, atol=1e-9)
    np.testing.assert_allclose(motion.carried("wheel", "C", touch), 0.0, rtol=0, atol=1e-9)
    assert np.ptp(way) > 5.0


@three_seeds
@pytest.mark.parametrize("inside", [False, True])
def test_a_wheel_on_a_circle_rests_where_it_touches(inside: bool, seed: int) -> None:
    linkage, motion = seen("rolling in a circle" if inside else "rolling on a circle", seed)
    (rolling,) = linkage.rolling
    assert rolling.circle_radius is not None
    large = float(rolling.circle_radius)
    c = motion.at("C")
    touch = large * c / np.abs(c)
    np.testing.assert_allclose(np.abs(touch - c), float(rolling.radius), rtol=0, atol=1e-9)
    np.testing.assert_allclose(motion.carried("wheel", "C", touch), 0.0, rtol=0, atol=1e-9)
    # the unknown that bears its name is the direction of the line of centres
    way = np.radians(motion.motion.unknowns["way"].value)
    np.testing.assert_allclose(np.exp(1j * way), c / np.abs(c), rtol=0, atol=1e-11)


def test_a_ring_that_rolls_around_a_circle_rests_where_it_touches() -> None:
    mechanism = lw.linkage(
        points=xy(O=0j, C=-10 + 0j, P=-30 + 0j),
        links={"ground": ("O",), "ring": ("C", "P")},
        rolling=(
            lw.Rolling(name="way", wheel="ring", center="C", radius=30, circle="O",
                       circle_radius=20, inside=True),
        ),
        inputs=(lw.Input(link="ring", from_=0, to=360, step=10),),
    )  # fmt: skip
    motion = Seen(mechanism, mechanism.sweep())
    c = motion.at("C")
    np.testing.assert_allclose(np.abs(c), 10.0, rtol=0, atol=1e-9)
    touch = -20 * c / np.abs(c)  # beyond the circle's centre
    np.testing.assert_allclose(motion.carried("ring", "C", touch), 0.0, rtol=0, atol=1e-9)
    assert np.abs(motion.spin("ring")).min() == 1.0


# ------------------------------------------------------------------ wheels: numbers of books


def planetary(**gears: Any) -> lw.Mechanism:
    return lw.linkage(
        points=xy(O=0j, A=60 + 0j),
        links={"ground": ("O",), "carrier": ("O", "A"), "sun": ("O",), "planet": ("A",),
               "ring": ("O",)},
        gears=(
            lw.Gear(name="inner", wheels=("sun", "planet"), centers=("O", "A"), arm="carrier",
                    teeth=(40, 20)),
            lw.Gear(name="outer", wheels=("planet", "ring"), centers=("A", "O"), arm="carrier",
                    teeth=(20, 80), internal=True),
        ),
        **gears,
    )  # fmt: skip


@pytest.mark.parametrize(
    ("driven", "held", "wanted"),
    [
        # Willis: (ω_sun - ω_arm)/(ω_ring - ω_arm) = -80/40
        ("sun", "ring", {"carrier": 1 / 3, "planet": -1.0}),
        ("sun", "carrier", {"ring": -1 / 2, "planet": -2.0}),
        ("ring", "sun", {"carrier": 2 / 3, "planet": 2.0}),
        ("carrier", "ring", {"sun": 3.0, "planet": -3.0}),
    ],
)
def test_planetary_ratios_are_those_of_willis(
    driven: str, held: str, wanted: dict[str, float]
) -> None:
    motion = planetary(
        inputs=(
            lw.Input(link=driven, from_=0, to=360, step=30),
            lw.Input(link=held, from_=0, to=0, step=1),
        )
    ).sweep()
    values = np.arange(0, 361, 30)
    for link, ratio in wanted.items():
        np.testing.assert_allclose(motion[link], ratio * values, rtol=0, atol=1e-9)
        np.testing.assert_allclose(motion.links[link].first, ratio, rtol=1e-12)


def test_cardan_circles_draw_a_straight_line_and_an_ellipse() -> None:
    mechanism = lw.linkage(
        points=xy(O=0j, C=30 + 0j, P=60 + 0j, Q=40 + 0j),
        links={"ground": ("O",), "wheel": ("C", "P", "Q")},
        rolling=(
            lw.Rolling(name="arm", wheel="wheel", center="C", radius=30, circle="O",
                       circle_radius=60, inside=True),
        ),
        inputs=(lw.Input(link="wheel", from_=0, to=-360, step=-5),),
    )  # fmt: skip
    motion = mechanism.sweep()
    phi = np.radians(np.arange(0, 361, 5))
    np.testing.assert_allclose(motion.trace("P"), 60 * np.cos(phi), rtol=0, atol=1e-12 * 60)
    ellipse = 40 * np.cos(phi) + 20j * np.sin(phi)
    np.testing.assert_allclose(motion.trace("Q"), ellipse, rtol=0, atol=1e-12 * 60)


def test_a_point_of_a_rolling_rim_draws_the_cycloid() -> None:
    mechanism = lw.linkage(
        points=xy(S=0j, T=200 + 0j, C=10j, P=0j),
        links={"ground": ("S", "T"), "wheel": ("C", "P")},
        lengths={"C P": 10},
        rolling=(lw.Rolling(name="x", wheel="wheel", center="C", radius=10, line=("S", "T")),),
        inputs=(lw.Input(slider="x", from_=0, to=60, step=1),),
    )
    motion = mechanism.sweep()
    t = np.arange(0, 61) / 10
    wanted = 10 * (t - np.sin(t)) + 10j * (1 - np.cos(t))
    np.testing.assert_allclose(motion.trace("P"), wanted, rtol=0, atol=1e-11)


def test_the_phase_is_the_second_wheels_angle_where_the_firsts_is_zero() -> None:
    for arm_turn in (0.0, 25.0):
        arm = 60 * np.exp(1j * math.radians(arm_turn))
        mechanism = lw.linkage(
            points=xy(O=0j, P=complex(arm), A=10 + 0j, B=complex(arm) + 10j),
            links={
                "ground": ("O",), "bar": ("O", "P"), "left": ("O", "A"), "right": ("P", "B"),
            },
            gears=(
                lw.Gear(name="m", wheels=("left", "right"), centers=("O", "P"), arm="bar",
                        teeth=(40, 15), phase=33),
            ),
            inputs=(
                lw.Input(link="left", relative_to="bar", from_=0, to=20, step=10),
                lw.Input(link="bar", from_=arm_turn, to=arm_turn, step=1),
            ),
        )  # fmt: skip
        motion = mechanism.sweep()
        turned = motion["right"] - arm_turn
        np.testing.assert_allclose(turned, [33 - 40 / 15 * a for a in (0, 10, 20)], atol=1e-9)


def test_a_weld_leads_from_the_first_direction_to_the_second() -> None:
    mechanism = contact("weld", 3)
    description = mechanism.description
    assert isinstance(description, Linkage)
    motion = mechanism.sweep()
    given, measured = description.welds
    assert given.angle is not None
    np.testing.assert_allclose(
        np.exp(1j * np.radians(motion["arm"] - motion["coupler"] - float(given.angle))),
        1.0,
        atol=1e-12,
    )
    o4, b, q = (description.sketched(p) for p in ("O4", "B", "Q"))
    sketched = np.angle((q - o4) / (b - o4))
    np.testing.assert_allclose(
        np.exp(1j * (np.radians(motion["flag"] - motion["rocker"]) - sketched)),
        1.0,
        atol=1e-12,
    )
    assert measured.angle is None


# ------------------------------------------------------------------ cams


def touching(kind: str, seed: int) -> tuple[lw.Cam, Linkage, Seen, Complex]:
    """A cam, its motion, and its outline as it stands in every row (K, N)."""
    mechanism = contact(kind, seed)
    linkage, motion = seen(kind, seed)
    (cam,) = linkage.cams
    body, center, outline = mechanism.loop_equations.outlines["law"]
    assert (body, center) == (cam.cam, cam.center)
    if cam.profile:  # the drawn points are too few to measure from
        points = [complex(float(x), float(y)) for x, y in cam.profile]
        spline = Outline.through(points, closed=True)
        outline = spline.at(spline.samples(4001))
    turned = outline[None, :] * np.exp(1j * motion.angle(cam.cam))[:, None]
    return cam, linkage, motion, turned + motion.at(center)[:, None]


CAMS = [k for k in KINDS if k.startswith("cam")]


@three_seeds
@pytest.mark.parametrize("kind", [k for k in CAMS if not k.endswith("flat")])
def test_knife_and_roller_touch_the_cam_and_do_not_cut_into_it(kind: str, seed: int) -> None:
    cam, linkage, motion, outline = touching(kind, seed)
    radius = float(cam.radius)
    gap = gap_of_point(outline, motion.at("R")) - radius
    # between two of N places the distance is off by (2π·45/N)²/8 of the curvature of both, and
    # a knife edge stands up to half a spacing beside the next place
    if cam.slider is None:  # the arm's angle is that of the sketch, not one a turn away
        arm = linkage.sketched("R") - linkage.sketched("P")
        assert abs(motion.angle("arm")[0] - cmath.phase(arm)) < 1.0
    spacing = np.abs(np.diff(outline[0])).max()
    assert np.abs(gap).max() < (spacing**2 if radius else 0.6 * spacing)


@three_seeds
@pytest.mark.parametrize("kind", [k for k in CAMS if k.endswith("flat")])
def test_a_flat_face_touches_the_cam_and_does_not_cut_into_it(kind: str, seed: int) -> None:
    cam, _, motion, outline = touching(kind, seed)
    if cam.slider is not None:
        line = motion.at("T") - motion.at("S")
        gap = gap_of_face(outline, motion.at("R"), 1j * line / np.abs(line), motion.at("O"))
    else:
        face = motion.at("R") - motion.at("P")
        gap = gap_of_face(outline, motion.at("P"), face / np.abs(face), motion.at("O"))
    spacing = np.abs(np.diff(outline[0])).max()
    assert np.abs(gap).max() < spacing**2 / 100


@pytest.mark.parametrize("kind", [k for k in CAMS if "follower" in k])
def test_the_base_circle_is_the_smallest_and_touches_in_the_dwell(kind: str) -> None:
    cam, _, _, outline = touching(kind, 21)
    (distance,) = np.abs(outline[:1] - _center(kind, 21))
    assert distance.min() == pytest.approx(40.0, rel=0, abs=1e-9)
    assert cam.base == 40
    # the dwell lasts 50°: as much of the outline is the base circle
    assert np.mean(distance < 40.0 + 1e-9) == pytest.approx(50 / 360, rel=0, abs=0.03)


def _center(kind: str, seed: int) -> complex:
    description = contact(kind, seed).description
    assert isinstance(description, Linkage)
    return description.sketched("O")


@pytest.mark.parametrize("contact_kind", ["knife", "roller", "flat"])
@pytest.mark.parametrize("swings", [False, True])
def test_the_outline_that_a_motion_makes_makes_that_motion(contact_kind: str, swings: bool) -> None:
    """The error falls with the fourth power of the spacing, as that of a cubic spline does."""
    lift = 6.0
    # one turn of an analytic motion: h (1 - cos φ)/2
    law: dict[str, Any] = {
        "segments": (
            lw.Segment(law="harmonic", over=180, lift=lift),
            lw.Segment(law="harmonic", over=180, lift=-lift),
        ),
        "base": 40,
        "start": 37,
    }
    size: dict[str, Any] = {"radius": 8} if contact_kind == "roller" else {}

    def cam(**shape: Any) -> lw.Mechanism:
        points = xy(O=0j, S=4 + 0j, T=4 + 100j, R=4 + 50j)
        follower: dict[str, Any] = {"slider": "s"}
        links = {"ground": ("O", "S", "T"), "cam": ("O",), "stem": ("R",)}
        sliders: tuple[lw.Slider, ...] = (
            lw.Slider(name="s", link="stem", points=("R",), on="ground", line=("S", "T")),
        )
        if swings:
            points = xy(O=0j, P=80 + 0j, R=17 + 42j)
            links = {"ground": ("O", "P"), "cam": ("O",), "arm": ("P", "R")}
            follower = {"link": "arm", "pivot": "P", "point": "R"}
            sliders = ()
        return lw.linkage(
            points=points,
            links=links,
            sliders=sliders,
            cams=(
                lw.Cam(name="law", cam="cam", center="O", contact=contact_kind, **follower,
                       **size, **shape),
            ),
            inputs=(lw.Input(link="cam", from_=0.37, to=360.37, step=3.6),),
        )  # fmt: skip

    by_law = cam(**law)
    outline = by_law.loop_equations.outlines["law"][2]
    follower = "arm" if swings else "s"
    wanted = by_law.sweep()
    errors = []
    for count in (36, 72, 144):
        chosen = outline[:: len(outline) // count]
        found = cam(profile=tuple((float(z.real), float(z.imag)) for z in chosen)).sweep()
        assert found.found.all()
        errors.append(float(np.abs(found[follower] - wanted[follower]).max()))
        slope = found.links if swings else found.sliders
        first = (wanted.links if swings else wanted.sliders)[follower].first
        assert np.abs(slope[follower].first - first).max() < 40.0 * count**-2
    assert errors[0] < 1e-2
    # 2⁴ = 16; the last one may already be near rounding
    assert errors[0] / errors[1] == pytest.approx(16, rel=0.4)
    assert errors[1] / errors[2] == pytest.approx(16, rel=0.4)


def test_the_motion_begins_at_the_start_angle_and_runs_with_the_cam() -> None:
    mechanism = lw.linkage(
        points=xy(O=0j, S=0j, T=100j, R=50j) | {"S": (0, -1)},
        links={"ground": ("O", "S", "T"), "cam": ("O",), "stem": ("R",)},
        sliders=(lw.Slider(name="s", link="stem", points=("R",), on="ground", line=("S", "T")),),
        cams=(
            lw.Cam(name="law", cam="cam", center="O", slider="s", base=40, start=30,
                   segments=(
                       lw.Segment(law="cycloidal", over=90, lift=10),
                       lw.Segment(law="dwell", over=180),
                       lw.Segment(law="3-4-5", over=90, lift=-10),
                   )),
        ),
        inputs=(lw.Input(link="cam", from_=0, to=390, step=15),),
    )  # fmt: skip
    motion = mechanism.sweep()
    s = dict(zip(motion.inputs["cam"], motion["s"] - 1.0, strict=True))
    assert s[30] == pytest.approx(40, abs=1e-12)
    assert s[75] == pytest.approx(45, abs=1e-12)  # half of the rise
    assert s[120] == s[300] == pytest.approx(50, abs=1e-12)
    assert s[345] == pytest.approx(45, abs=1e-12)
    assert s[390] == pytest.approx(40, abs=1e-12)
    # the cam turns against the clock, so its rising flank follows the base circle clockwise
    outline = mechanism.loop_equations.outlines["law"][2]
    at_start = outline * np.exp(1j * math.radians(30))
    top = at_start[np.abs(np.angle(at_start / 1j)).argmin()]
    assert abs(top) == pytest.approx(40, abs=1e-9)
    later = outline * np.exp(1j * math.radians(75))
    assert abs(later[np.abs(np.angle(later / 1j)).argmin()]) == pytest.approx(45, abs=0.05)


# ------------------------------------------------------------------ curves


@pytest.mark.parametrize("closed", [False, True])
def test_a_curve_is_the_cubic_spline_over_its_chords(closed: bool) -> None:
    rng = np.random.default_rng(4)
    for _ in range(10):
        z = np.array([complex(*p) for p in outline_points(rng, int(rng.integers(4, 15)))])
        z = z + rng.normal(size=len(z)) + 1j * rng.normal(size=len(z))
        curve = Outline.through([complex(p) for p in z], closed=closed)
        ring = np.append(z, z[0]) if closed else z
        u = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(ring)))])
        u *= 2 * np.pi / u[-1] if closed else 1.0
        spline = CubicSpline(u, np.stack([ring.real, ring.imag], axis=1),
                             bc_type="periodic" if closed else "natural")  # fmt: skip
        at = rng.uniform(0, u[-1], 100)
        for order, (x, y) in enumerate(zip(curve.x.jet(at), curve.y.jet(at), strict=True)):
            wanted = spline(at, order)
            size = np.abs(wanted).max()
            np.testing.assert_allclose(x, wanted[:, 0], rtol=0, atol=1e-12 * size)
            np.testing.assert_allclose(y, wanted[:, 1], rtol=0, atol=1e-12 * size)
        np.testing.assert_allclose(curve.at(u), ring, rtol=0, atol=1e-12 * np.abs(z).max())


def test_a_closed_curve_given_clockwise_runs_the_other_way_from_the_same_point() -> None:
    z = [complex(*p) for p in outline_points(np.random.default_rng(5))]
    one, other = Outline.through(z, closed=True), Outline.through(z[:1] + z[:0:-1], closed=True)
    u = np.linspace(0, 2 * np.pi, 50)
    np.testing.assert_allclose(one.at(u), other.at(u), rtol=0, atol=1e-12)
    assert one.at(np.zeros(1))[0] == pytest.approx(z[0])


def test_bend_and_the_least_rounded_place_of_an_ellipse() -> None:
    t = 2 * np.pi * np.arange(200) / 200
    curve = Outline.through([complex(z) for z in 50 * np.cos(t) + 30j * np.sin(t)], closed=True)
    u = curve.samples(201)
    z = curve.at(u)
    exact = 50 * 30 / ((50 / 30 * z.imag) ** 2 + (30 / 50 * z.real) ** 2) ** 1.5
    np.testing.assert_allclose(curve.bend(u), exact, rtol=2e-3)
    place, bend = curve.deepest()
    assert abs(place.imag) == pytest.approx(30, abs=0.1)
    assert bend == pytest.approx(30 / 50**2, rel=2e-3)


@three_seeds
@pytest.mark.parametrize("kind", ["curve open", "curve closed"])
def test_the_point_stays_on_its_curve(kind: str, seed: int) -> None:
    linkage, motion = seen(kind, seed)
    (curve,) = linkage.curves
    points = [complex(float(x), float(y)) for x, y in curve.through]
    outline = Outline.through(points, closed=curve.closed)
    turn = np.exp(-1j * motion.angle(curve.on))
    here = (motion.at(curve.point) - motion.at(curve.origin)) * turn
    series = motion.motion.unknowns["u"]
    u = np.radians(series.value) if curve.closed else series.value
    np.testing.assert_allclose(here, outline.at(u), rtol=0, atol=1e-9)
    assert np.ptp(u) > 1.0


def test_a_point_beyond_an_open_curve_goes_straight_on() -> None:
    curve = Outline.through([0j, 1 + 1j, 3 + 1j, 4 + 3j], closed=False)
    end = curve.x.breaks[-1]
    tangent = complex(*(part.jet(np.array([end]))[1][0] for part in (curve.x, curve.y)))
    beyond = curve.at(np.array([end + 2.5]))[0]
    assert beyond == pytest.approx(4 + 3j + 2.5 * tangent, abs=1e-12)
    assert 0.5 < abs(tangent) < 1.5  # u is nearly the curve's length
