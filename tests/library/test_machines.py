"""Quick returns, engines, pumps, presses, lifts and vehicles against their closed forms."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.optimize import brentq

import linkwork as lw
from linkwork.core.results.failure import OutputLimit
from tests.library.laws import degrees, law, motion_of, same
from tests.oracles.circles import SliderCrank, circles_meet
from tests.oracles.four_bar import FourBar


def extremes(name: str, quantity: str) -> tuple[OutputLimit, OutputLimit]:
    """The smallest and the largest value of a quantity over a turn, located."""
    found = lw.example(name).sweep(limits_of=[quantity]).output_limits
    return min(found, key=lambda at: at.value), max(found, key=lambda at: at.value)


def time_ratio(name: str, quantity: str) -> float:
    """Of the two strokes at constant input speed, the longer by the shorter."""
    low, high = extremes(name, quantity)
    way = (high.input - low.input) % 360
    return max(way, 360 - way) / min(way, 360 - way)


# ------------------------------------------------------------------ quick returns


@law("inverted-slider-crank")
def test_slotted_lever_points_at_the_crank_pin() -> None:
    """The lever points to the crank's pin; ratio (180 + 2 asin(r/d))/(180 - 2 asin(r/d))."""
    motion = motion_of("inverted-slider-crank")
    pin = 100 * np.exp(1j * degrees(motion, "crank")) + 250j
    same(motion["s"], np.abs(pin), 350)
    same(np.exp(1j * degrees(motion, "lever")), pin / np.abs(pin), 1)
    angle = math.degrees(math.asin(100 / 250))
    expected = (180 + 2 * angle) / (180 - 2 * angle)
    assert time_ratio("inverted-slider-crank", "lever") == pytest.approx(expected, abs=1e-9)


@law("crank-shaper")
def test_crank_shaper_has_its_quick_return_ratio() -> None:
    """Quick-return ratio (180 + 2 asin(r/d))/(180 - 2 asin(r/d)) = 1.710."""
    motion = motion_of("crank-shaper")
    pin = 60 * np.exp(1j * degrees(motion, "crank")) + 150j
    end = -150j + 320 * pin / np.abs(pin)
    same(motion["ram_x"], end.real + np.sqrt(120**2 - (150 - end.imag) ** 2), 320)
    angle = math.degrees(math.asin(60 / 150))
    expected = (180 + 2 * angle) / (180 - 2 * angle)
    assert time_ratio("crank-shaper", "lever") == pytest.approx(expected, abs=1e-9)


@law("whitworth")
def test_whitworth_has_its_quick_return_ratio() -> None:
    """Quick-return ratio (180 + 2 asin(d/r))/(180 - 2 asin(d/r)) = 1.754.

    The ram turns where the lever lies along its line, at crank angles asin(-d/r).
    """
    motion = motion_of("whitworth")
    pin = 120 * np.exp(1j * degrees(motion, "crank")) + 50j
    end = -60 * pin / np.abs(pin)
    same(motion["ram_x"], -end.real + np.sqrt(260**2 - end.imag**2), 320)
    assert motion["lever"][-1] - motion["lever"][0] == pytest.approx(360, abs=1e-10)
    angle = math.degrees(math.asin(50 / 120))
    expected = (180 + 2 * angle) / (180 - 2 * angle)
    assert time_ratio("whitworth", "ram_x") == pytest.approx(expected, abs=1e-8)


@law("drag-link")
def test_drag_link_ram_turns_where_the_driven_crank_lies_along_its_line() -> None:
    """The ram turns where the driven crank lies along its line: θ4 = 0° and 180°."""
    motion = motion_of("drag-link")
    b = FourBar(30, 70, 60, 80).coupler_end(degrees(motion, "crank"), 1)
    pin = 30 + 45 * (b - 30) / 80
    same(motion.trace("B"), b, 80)
    same(motion["ram_x"], pin.real - 30 + np.sqrt(150**2 - pin.imag**2), 195)
    for at, driven in zip(extremes("drag-link", "ram_x"), (-1, 1), strict=True):
        end = 30 + 80 * driven
        turn = math.acos((70**2 + end**2 - 60**2) / (2 * 70 * abs(end)))
        expected = math.degrees(turn if end > 0 else math.pi - turn)
        offsets = [(at.input - sign * expected + 180) % 360 - 180 for sign in (1, -1)]
        assert min(map(abs, offsets)) < 1e-6


# ------------------------------------------------------------------ engines and pumps


@law("slider-crank-engine")
def test_engine_piston_moves_by_its_closed_form_over_a_stroke_of_two_cranks() -> None:
    """s = r cos θ + √(l² - r² sin² θ), stroke 2r."""
    motion = motion_of("slider-crank-engine")
    crank = degrees(motion, "crank") - math.pi / 2
    same(motion["s"], SliderCrank(40, 130, 0j, 0).slide(crank, 1), 130)
    assert np.ptp(motion["s"]) == pytest.approx(80, abs=1e-10)


@law("pumpjack")
def test_pumpjack_stroke_is_the_published_one_to_three_percent() -> None:
    """The stroke of API Spec 11E, 54 inches, to 3 %; exactly A times the beam's swing.

    The beam turns where crank and pitman are in line; the standard rounds the stroke down.
    """
    motion = motion_of("pumpjack")
    k = complex(-64, 41) + 24 * np.exp(1j * degrees(motion, "crank"))
    rear = circles_meet(k, 74.5, np.full(k.shape, 116j), 64, 1)
    same(motion.trace("E"), rear, 116)
    frame = math.hypot(64, 116 - 41)
    high, low = (
        math.acos((64**2 + frame**2 - reach**2) / (2 * 64 * frame)) for reach in (98.5, 50.5)
    )
    least, most = extremes("pumpjack", "rod")
    assert most.value - least.value == pytest.approx(72 * (high - low), abs=1e-9)
    assert 54 < most.value - least.value < 54 * 1.03


@law("beam-engine")
def test_beam_engine_copies_the_link_point_and_keeps_the_piston_upright() -> None:
    """CF = 2.5·CP; the piston's pin deviates by 1.1 from a line over a stroke of 151."""
    motion = motion_of("beam-engine")
    k = complex(280, -420) + 75 * np.exp(1j * degrees(motion, "crank"))
    end = circles_meet(k, 400, np.zeros(k.shape), 300, -1)
    b = -0.4 * end
    d = circles_meet(b, 100, np.full(k.shape, -200 - 100j), 80, 1)
    same(motion.trace("P"), b + 0.4 * (d - b), 420)
    same(motion.trace("F"), 2.5 * motion.trace("P"), 420)
    path = motion.trace("F")
    assert np.ptp(path.imag) > 150
    assert np.ptp(path.real) < 1.2


@law("sun-and-planet")
def test_sun_turns_twice_as_far_as_the_arm_less_the_rods_swing() -> None:
    """θ(sun) = 2 θ(arm) - θ(rod) + const: two turns of the shaft for one of the arm."""
    motion = motion_of("sun-and-planet")
    a = 100 * np.exp(1j * degrees(motion, "arm"))
    end = circles_meet(a, 500, np.full(a.shape, 300 + 500j), 300, 1)
    same(motion.trace("B"), end, 600)
    same(motion["planet"], motion["rod"], 360)
    rod = np.unwrap(np.angle(end - a))
    sun = 2 * degrees(motion, "arm") - rod
    found = degrees(motion, "sun")
    same(found - found[0], sun - sun[0], 4 * math.pi)
    assert found[-1] - found[0] == pytest.approx(4 * math.pi, abs=1e-12)


@law("boxer-engine")
def test_boxer_pistons_mirror_each_other() -> None:
    """s = r cos θ + √(l² - r² sin² θ) on either side; the midpoint of the pistons is O."""
    motion = motion_of("boxer-engine")
    crank = degrees(motion, "throw1")
    closed = 35 * np.cos(crank) + np.sqrt(120**2 - (35 * np.sin(crank)) ** 2)
    same(motion["s1"], closed, 155)
    same(motion["s2"], closed, 155)
    same(motion.trace("B1") + motion.trace("B2"), 0, 155)
    same(motion.trace("A1") + motion.trace("A2"), 0, 155)


@law("atkinson-engine")
def test_atkinson_engine_expands_further_than_it_compresses() -> None:
    """s = c cos φ + √(l² - c² sin² φ); four strokes a turn, expansion 1.75 times compression."""
    motion = motion_of("atkinson-engine")
    a = 60 - 180j + 56 * np.exp(1j * degrees(motion, "crank"))
    pin = circles_meet(a, 189, np.zeros(a.shape), 100, -1)
    same(motion.trace("C"), pin, 250)
    same(motion["s"], pin.real + np.sqrt(150**2 - pin.imag**2), 250)
    frame, foot = abs(60 - 180j), math.atan2(-180, 60)
    turns = [
        foot + math.acos((100**2 + frame**2 - reach**2) / (2 * 100 * frame))
        for reach in (189 - 56, 189 + 56)
    ]
    near, far = (100 * math.cos(φ) + math.sqrt(150**2 - (100 * math.sin(φ)) ** 2) for φ in turns)
    found = lw.example("atkinson-engine").sweep(limits_of=["s"]).output_limits
    assert sorted(at.value for at in found) == pytest.approx([far, near, 250, 250], abs=1e-9)
    assert (250 - far) / (250 - near) == pytest.approx(1.75, abs=0.005)


@law("ross-yoke")
def test_ross_yoke_moves_its_pistons_as_sines_a_quarter_turn_apart() -> None:
    """y = r sin θ ± (b1/b2) r cos θ; with b1 = b2 amplitude √2 r, a quarter turn apart."""
    motion = motion_of("ross-yoke")
    crank = degrees(motion, "crank")
    same(motion["R.y"], 20 * math.sqrt(2) * np.sin(crank - math.pi / 4) + 0, 60)
    same(motion["L.y"], 20 * math.sqrt(2) * np.sin(crank + math.pi / 4) + 0, 60)
    same(motion["T.x"], 0, 60)


@law("stephenson-valve-gear")
@pytest.mark.parametrize("lift", [35, -35, 0])
def test_stephenson_valve_follows_its_hanging_link(lift: float) -> None:
    """The die block is where the hanging link, held at F, S, G, crosses the valve's line.

    One equation for the lifter's angle, bisected around the row's own.
    """
    gear = lw.example("stephenson-valve-gear").with_dimensions(lift=lift)
    motion = gear.sweep(step=30)
    assert motion.certified.all()
    pivot = 300 + 1j * (150 + lift)

    def placed(crank: float, lifter: float) -> tuple[complex, complex]:
        middle = pivot + 150 * np.exp(1j * lifter)
        fore = 30 * np.exp(1j * crank)
        top = complex(circles_meet(np.asarray(fore), 300, np.asarray(middle), 70, 1))
        return top, 2 * middle - top

    for row, crank in enumerate(degrees(motion, "crank")):
        back = 30 * np.exp(1j * (crank + 2 * math.pi / 3))

        def gap(lifter: float, crank: float = crank, back: complex = back) -> float:
            return abs(placed(crank, lifter)[1] - back) - 300

        near = degrees(motion, "lifter")[row]
        top, low = placed(crank, brentq(gap, near - 0.02, near + 0.02, xtol=1e-14))
        valve = low.real + (top - low).real * low.imag / (low - top).imag
        same(motion["x"][row], valve, 300, within=1e-11)


# ------------------------------------------------------------------ presses, lifts, diggers


@law("toggle-press")
def test_toggle_press_is_slowest_where_its_links_are_straight() -> None:
    """y = knee's height - √(150² - x²); straight, the ram is 300 below the fixed pin."""
    motion = motion_of("toggle-press")
    a = complex(-260, 120) + 40 * np.exp(1j * degrees(motion, "crank"))
    knee = circles_meet(a, 230, np.full(a.shape, 300j), 150, -1)
    same(motion.trace("C"), 1j * (knee.imag - np.sqrt(150**2 - knee.real**2)), 300)
    assert np.abs(motion.trace("C")).min() < 0.01  # straight: 300 below the fixed pin
    assert np.ptp(motion["C.y"]) > 30


@law("scissor-lift")
def test_scissor_lift_is_two_stages_high() -> None:
    """h = 2 √(100² - x²), the platform level."""
    motion = motion_of("scissor-lift")
    foot = motion["x"]
    same(motion["height"], 2 * np.sqrt(100**2 - foot**2), 200)
    same(motion.trace("F"), foot + 1j * motion["height"], 200)
    same(motion["platform"], 0, 180)


@law("excavator")
def test_excavator_angles_follow_from_its_cylinders() -> None:
    """Law of cosines at O, B and R, then the bucket's four-bar."""
    motion = motion_of("excavator")
    zero = np.zeros(len(motion), dtype=complex)
    root = circles_meet(zero + complex(60, -40), motion["boom_ram"], zero, 265, -1)
    boom = root / 265 * np.exp(-1j * math.radians(13))
    hinge, lug = 560 * boom, 310 * boom * np.exp(1j * math.radians(15))
    tail = circles_meet(lug, motion["stick_ram"], hinge, 85, 1)
    stick = (tail - hinge) / 85 * np.exp(-1j * math.radians(160))
    same(motion.trace("H"), hinge + 300 * stick, 560)
    lever, pin = hinge + 255 * stick, hinge + 300 * stick
    top = hinge + 70 * stick * np.exp(1j * math.radians(40))
    knee = circles_meet(top, motion["bucket_ram"], lever, 70, 1)
    ear = circles_meet(knee, 75, pin, 60, 1)
    same(motion.trace("W"), pin + 2 * (ear - pin) * np.exp(1j * math.radians(150)), 560)


# ------------------------------------------------------------------ vehicles


@law("windscreen-wiper")
def test_wiper_blades_stay_parallel_over_the_sweep_of_the_law_of_cosines() -> None:
    """Blades parallel; the sweep ends where crank and rod are in line."""
    motion = motion_of("windscreen-wiper")
    same(motion["blade2"], motion["blade1"], 180)
    inner, outer = (
        math.acos((300**2 + 110**2 - reach**2) / (2 * 300 * 110)) for reach in (250, 330)
    )
    least, most = extremes("windscreen-wiper", "blade1")
    assert most.value - least.value == pytest.approx(math.degrees(outer - inner), abs=1e-9)


@law("landing-gear")
def test_landing_gear_leg_follows_from_its_cylinder() -> None:
    """The leg's angle from the triangle S H N, the brace's knee on two circles."""
    motion = motion_of("landing-gear")
    zero = np.zeros(len(motion), dtype=complex)
    horn = circles_meet(zero + complex(100, 30), motion["actuator"], zero, 30, -1)
    leg = horn / 30 * np.exp(-1j * math.radians(120))
    same(motion.trace("W"), 120 * leg, 120)
    knee = circles_meet(zero + complex(80, 10), 62, 70 * leg, 52, 1)
    same(motion.trace("M"), knee, 120)
    assert motion["leg"][-1] - motion["leg"][0] > 75


@law("double-wishbone")
def test_double_wishbone_upright_is_the_coupler_of_a_four_bar() -> None:
    """The upright is the coupler of a four-bar; the camber changes by less than 6°."""
    motion = motion_of("double-wishbone")
    low = 340 * np.exp(1j * degrees(motion, "lower_arm"))
    top = circles_meet(low, 235, np.full(low.shape, 60 + 230j), 240, -1)
    upright = (top - low) / 235
    same(motion.trace("B"), top, 340)
    same(motion.trace("K"), low + 202 * upright * np.exp(-1j * math.radians(155)), 340)
    assert np.ptp(motion["upright"]) < 6  # camber over the whole travel
    assert np.ptp(motion["travel"]) > 180


@law("macpherson")
def test_macpherson_strut_passes_its_joint_at_a_fixed_distance() -> None:
    """s = √(JT² - h²): the strut's line passes J at the distance h."""
    motion = motion_of("macpherson")
    joint = 340 * np.exp(1j * degrees(motion, "arm"))
    span = 290 + 560j - joint
    line = span / np.abs(span) * np.exp(1j * np.arcsin(30 / np.abs(span)))
    same(motion["s"], np.sqrt(np.abs(span) ** 2 - 30**2), 560)
    foot = joint - 30j * line
    same(motion.trace("K"), foot + 233 * line * np.exp(-1j * math.radians(150)), 560)


@law("ackermann-steering")
def test_ackermann_trapezoid_errs_less_than_a_degree_to_30_degrees() -> None:
    """Up to 30° the outer wheel errs less than 0.9° from cot δo - cot δi = track/wheelbase."""
    motion = motion_of("ackermann-steering")
    a = 0.75 * np.exp(1j * degrees(motion, "left"))
    rod = 4.5 - 1.5 * math.sin(math.radians(15))
    b = circles_meet(a, rod, np.full(a.shape, 4.5 + 0j), 0.75, -1)
    same(motion.trace("AR"), b, 4.5)
    left, right = degrees(motion, "steer_left"), degrees(motion, "steer_right")
    inside = np.abs(right) < math.radians(30)
    mirrored = np.interp(-right[inside], left, right)
    same(mirrored, -left[inside], 1, within=1e-4)  # between rows of half a degree
    turning = left > math.radians(1)
    ideal = np.arctan(1 / (1 / np.tan(left[turning]) + 4.5 / 10))
    error = np.degrees(right[turning] - ideal)
    assert 0.5 < np.max(np.abs(error)) < 0.9


@law("crank-press")
def test_crank_press_moves_by_its_closed_form_and_works_against_its_load() -> None:
    """height = 600 + r sin θ - √(l² - r² cos² θ); in a turn the crank does the work of 20 mm."""
    motion = motion_of("crank-press")
    crank = degrees(motion, "crank")
    rod = np.sqrt(400**2 - (60 * np.cos(crank)) ** 2)
    same(motion["height"], 600 + 60 * np.sin(crank) - rod, 600)
    work = np.sum(motion["power"][1:-1]) * np.radians(1.0) / (4 * math.pi)
    assert work == pytest.approx(20000 * 20, rel=0.02)


@law("balanced-lamp")
def test_balanced_lamp_stands_at_every_height() -> None:
    """The spring's torque is k h a cos θ for every angle, the weight's W l cos θ."""
    motion = motion_of("balanced-lamp")
    assert np.abs(motion["arm.effort"]).max() < 1e-12 * 20 * 300
    height = 100 - 60 * np.sin(degrees(motion, "arm"))
    same(
        motion["balance.tension"] ** 2,
        height**2 + (60 * np.cos(degrees(motion, "arm"))) ** 2,
        160**2,
    )


@law("pendulum")
def test_pendulum_is_at_its_exact_places() -> None:
    """From rest at 180°, the place after 1, 5 and 10 s by elliptic functions (IFToMM A01)."""
    motion = lw.example("pendulum").simulate(10, step=1)
    exact = [
        0.986291751131875319 - 0.165010853125541169j,
        -0.942305435043757335 - 0.334754338414000581j,
        -0.27508746257611686 - 0.961419205099125064j,
    ]
    same((motion["A.x"] + 1j * motion["A.y"])[[1, 5, 10]], exact, 1)


@law("double-pendulum")
def test_double_pendulum_keeps_its_energy_and_equation_of_momentum() -> None:
    """Energy, and d/dt of the moment of momentum about O = moment of the weights."""
    motion = lw.example("double-pendulum").simulate(1, step=0.05)
    energy = motion["kinetic_energy"] + motion["stored_energy"]
    same(energy, np.full_like(energy, energy[0]), 10)
    places = (motion[f"{point}.x"] + 1j * motion[f"{point}.y"] for point in "AB")
    bends = (motion[f"{point}.x.d2"] + 1j * motion[f"{point}.y.d2"] for point in "AB")
    gained = sum((np.conj(z) * a).imag for z, a in zip(places, bends, strict=True))
    same(gained, -9.81 * (motion["A.x"] + motion["B.x"]), 10)


@law("door-closer")
def test_door_closer_falls_as_two_exponentials() -> None:
    """I θ'' + c θ' + k (θ - θ_free) = 0 up to the frame: θ = θ_free + Σ a e^(λ t)."""
    motion = lw.example("door-closer").simulate(3, step=0.05)
    inertia, damping, stiffness, free = 20 * 0.9**2 / 3, 18, 14, -0.5
    slow, fast = np.roots([inertia, damping, stiffness])[::-1]
    t = motion["t"]
    begin = math.pi / 2 - free
    angle = free + begin * (fast * np.exp(slow * t) - slow * np.exp(fast * t)) / (fast - slow)
    closed = t[motion["door"] <= 1e-12][0]
    same(motion["door"], np.where(t < closed, angle, 0), 2)
    assert [word for word in motion.limit if word] == ["stop of door"]


@law("toggle-latch")
def test_toggle_latch_rests_on_both_sides_of_its_centre() -> None:
    """d = r cos θ + √(l² - r² sin² θ); V = k/2 (180 - d - free)², A = m r²/3 + M d'²."""
    latch = lw.example("toggle-latch")
    rest = math.degrees(math.acos((40**2 + 90**2 - 60**2) / (2 * 40 * 90)))
    found = sorted(lw.forces.equilibria(latch), key=lambda each: each.input)
    same([each.input for each in found], [-rest, 0, rest], 180)
    assert [each.stable for each in found] == [True, False, True]
    # at the free length V'' = k d'²; in line V'' = -k (90 - 80) (r + r²/l)
    sine = math.sin(math.radians(rest))
    slope = 40 * sine * 90 / (90 - 40 * math.cos(math.radians(rest)))
    inertia = 0.2 * 40**2 / 3
    swing = math.sqrt(2 * 1000 * slope**2 / (inertia + 0.3 * slope**2)) / (2 * math.pi)
    growth = math.sqrt(2 * 1000 * 10 * (40 + 40**2 / 60) / inertia) / (2 * math.pi)
    same([each.frequency for each in found], [swing, -growth, swing], swing, within=1e-10)
    motion = latch.simulate(1, at=-1)
    same(motion["crank"][-1], -rest, 180)


@law("compressor")
def test_compressor_gives_the_power_of_its_motor_to_gas_friction_and_speed() -> None:
    """d = r cos θ + √(l² - r² sin² θ); motor + gas = d/dt(energy) + friction."""
    motion = lw.example("compressor").simulate(0.12, step=0.01)
    turn = degrees(motion, "crank")
    same(motion["d"], 40 * np.cos(turn) + np.sqrt(120**2 - (40 * np.sin(turn)) ** 2), 160)
    power, load, rate, friction = (
        motion[name] for name in ("power", "load_power", "energy_rate", "friction_power")
    )
    assert friction[-1] > 0
    same(power + load - friction, rate, float(np.abs(rate).max()))


# ------------------------------------------------------------------ linear couplings


@law("hydraulic-clutch")
def test_hydraulic_clutch_shares_the_oil_of_two_cylinders() -> None:
    """Master and slave cylinder share their oil: 0.5957 times one stroke is the other."""
    motion = motion_of("hydraulic-clutch")
    pin = abs(18 + 60j) * np.exp(1j * degrees(motion, "pedal"))
    master, start = np.abs(pin - (150 + 60j)), 132.0
    slave = np.hypot(110, 15) - 0.5957 * (master - start)
    same(motion["slave"], slave, 221)
    # the law of cosines in the triangle of fork, slave cylinder and ground
    q, r = 300, 190 + 45j
    base = abs(r - q)
    angle = np.arccos((60**2 + base**2 - slave**2) / (2 * 60 * base))
    same(degrees(motion, "fork"), np.angle(r - q) - angle, 1)


@law("hoist")
def test_hoist_lifts_its_cage_by_the_radius_times_the_angle() -> None:
    """The cage rises by radius times angle; the drum holds the difference of the weights."""
    motion = motion_of("hoist")
    height = 0.5 + 0.25 * degrees(motion, "drum")
    same(motion["height"], height, 6)
    same(motion["other"], 6 - height, 6)
    forces = lw.example("hoist").forces(at=200).values
    assert forces["drum.effort"] == pytest.approx(0.25 * 100 * 9.81, rel=1e-12)
    assert forces["rope.force"] == pytest.approx(300 * 9.81, rel=1e-12)
