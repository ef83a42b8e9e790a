"""Every status of the enumeration is reached by one mechanism, its message matched whole."""

from __future__ import annotations

import math
from collections.abc import Callable

import pytest

import linkwork as lw
from tests.core.failures.test_positions_that_do_not_exist import four_bar

Reached = tuple[lw.Position | lw.Motion, str]


def plain(text: str, **guess: float) -> lw.Mechanism:
    return lw.plain_equations(name="plain", equations={"f": text}, guess=guess)


def converged() -> Reached:
    return lw.example("four-bar").solve(), "position found"


def singular_jacobian() -> Reached:
    # both vectors lie along x: no change of an angle moves their ends along x
    mechanism = lw.loops(
        name="four-bar",
        loops={"O2 A B O4": "2*e^(i*θ2) + 5*e^(i*θ3) = 4 + 3.5*e^(i*θ4)"},
        guess={"θ2": 60, "θ3": 0, "θ4": 0},
        inputs=lw.Input(variable="θ2"),
    )
    return mechanism.solve(), (
        "the Jacobian became singular during the iteration: the derivative is singular at an "
        "iterate, where Newton-Raphson has no next step: start from a guess near it; "
        "a damped iteration finds θ3 = 14.40014098°, θ4 = 58.22758874°; "
        "2 configurations exist there: open (θ3 = 14.40014098°, θ4 = 58.22758874°) or "
        "crossed (θ3 = -74.40014098°, θ4 = -118.2275887°)"
    )


def diverged() -> Reached:
    return lw.example("newton-inflection").solve(), (
        "the iteration diverged to infinity: the equations have an inflection near the root, so "
        "that every step overshoots further than the one before: start nearer to the root; a "
        "damped iteration finds x = 0; 1 root exists there (perhaps not all): x = 0"
    )


def step_limit() -> Reached:
    # 0 and 1 lead to each other for ever, around the minimum of F at √(2/3)
    return plain("x^3 - 2*x + 2 = 0", x=0).solve(), (
        "no position after the largest allowed number of iterations: the guess is near a local "
        "extremum of the equations, which do not reach zero there: start from the other side of "
        "the extremum; 1 root exists there (perhaps not all): x = -1.769292354"
    )


def cannot_close() -> Reached:
    # the crank's end is √(40² + 100²) from O4; coupler and rocker reach 30 + 40
    gap = math.hypot(40, 100) - 70
    # the ground that just lets them meet, and the crank angle at which they just meet
    ground = math.sqrt(70**2 - 40**2)
    angle = math.degrees(math.acos((40**2 + 100**2 - 70**2) / (2 * 40 * 100)))
    return four_bar(40, 30, 40, 100).solve(), (
        f'loop "O2 A B O4" cannot be closed at crank = 90°: near the guess a gap of at '
        f"least {gap:.6g} mm remains; "
        f'the loops just close with "A B" = {30 + gap:.6g} mm ({gap:.6g} longer) '
        f'or "O4 B" = {40 + gap:.6g} mm ({gap:.6g} longer) '
        f'or "O2 O4" = {ground:.6g} mm ({100 - ground:.6g} shorter); '
        f"nearest reachable input: crank = {angle:.10g}° (dead point); "
        "no configuration exists there"
    )


def out_of_reach() -> Reached:
    angle = math.degrees(math.acos(11 / 16))
    return four_bar(2, 5, 2, 4).solve(at=10), (
        "this branch does not reach the input value: the motion ends at the limit reported, ask "
        f"for values before it (met at crank = {angle:.10g}° and {-angle:.10g}°); "
        f"nearest reachable input: crank = {angle:.10g}° (dead point); "
        "no configuration exists there"
    )


def change_point() -> Reached:
    return four_bar(1, 2, 1, 2, at=60).solve(at=200), (
        "the motion reaches a change point, where two branches cross, before this input value: "
        "ask for values before it, or start from a guess beyond it (met at crank = 180° and 360°); "
        "nearest reachable input: crank = 180° (change point); "
        "2 configurations exist there: open (coupler = 13.27254518°, rocker = 173.2725452°) or "
        "crossed (coupler = 0°, rocker = -160°)"
    )


def out_of_circuit() -> Reached:
    motion = four_bar(4, 2, 5, 2, at=90).sweep(from_=-40, to=40, step=10, through=True)
    place = 'where loop "O2 A B O4" locks (coupler and rocker in line)'
    return motion, (
        "9 of 9 positions were not found; this circuit does not reach the input value on any of "
        "its branches: the motion reverses at the limits reported, ask for values between them; "
        f"dead point at crank = 46.5674634422 deg, {place}; "
        f"dead point at crank = 313.432536558 deg, {place}"
    )


def start_singular() -> Reached:
    mechanism = lw.linkage(
        points={"O2": (0, 0), "A": (40, 0), "B": (160, 0), "T": (300, 0)},
        links={"ground": ["O2", "T"], "crank": ["O2", "A"], "rod": ["A", "B"], "block": ["B"]},
        sliders=[
            lw.Slider(name="s", link="block", points=("B",), angle=0, on="ground", line=("O2", "T"))
        ],
        inputs=lw.Input(slider="s", from_=160, to=80, step=-5),
    )
    # law of cosines in the triangle 40, 120, 100
    crank = math.degrees(math.acos((40**2 + 100**2 - 120**2) / (2 * 40 * 100)))
    rod = math.degrees(math.acos((120**2 + 100**2 - 40**2) / (2 * 120 * 100)))
    return mechanism.solve(at=100), (
        "the start is a dead point or change point, where the direction of motion is undetermined: "
        "start from a guess near it (met at s = 160); "
        f"2 configurations exist there: open (crank = {crank:.10g}°, rod = -{rod:.10g}°) or "
        f"crossed (crank = -{crank:.10g}°, rod = {rod:.10g}°)"
    )


def lost() -> Reached:
    # x = u^1.5 ends at u = 0 without any rate growing there
    mechanism = lw.plain_equations(
        name="square root",
        equations={"f": "x - u*sqrt(u) = 0"},
        guess={"x": 1, "u": 1},
        inputs=lw.Input(variable="u", from_=1, to=-1, step=-0.5),
    )
    position = mechanism.solve(at=-1)
    # where exactly the steps become too short is a matter of rounding
    met = float(position.message.partition("met at u = ")[2].partition(")")[0])
    assert 0 < met < 1e-12
    return position, (
        "the branch could not be followed reliably up to this input value: ask for a value "
        "before the last one reached, or start from a guess beyond it "
        f"(met at u = {met:.10g}); other guesses also lead to no position there"
    )


def no_start() -> Reached:
    motion = four_bar(10, 10, 10, 100).sweep()
    gap = math.hypot(10, 100) - 20
    ground = math.sqrt(20**2 - 10**2)
    return motion, (
        f'loop "O2 A B O4" cannot be closed at crank = 90°: near the guess a gap of at '
        f"least {gap:.6g} mm remains; "
        f'the loops just close with "A B" = {10 + gap:.6g} mm ({gap:.6g} longer) '
        f'or "O4 B" = {10 + gap:.6g} mm ({gap:.6g} longer) '
        f'or "O2 O4" = {ground:.6g} mm ({100 - ground:.6g} shorter); '
        "no input value was found at which the mechanism can be assembled; "
        "no configuration exists there"
    )


def does_not_fit() -> Reached:
    # a third bar on a parallelogram that is no parallel crank: it fits where it stands upright
    points = {"O": (0, 0), "P": (50, 0), "A": (0, 30), "B": (50, 30), "Q": (25, -20), "C": (25, 30)}
    links = {
        "ground": ("O", "P", "Q"),
        "first": ("O", "A"),
        "second": ("P", "B"),
        "coupler": ("A", "B", "C"),
        "third": ("Q", "C"),
    }
    mechanism = lw.linkage(points=points, links=links, inputs=lw.Input(link="first"))
    turned = math.radians(85)
    length = math.hypot(30 * math.cos(turned), 30 * math.sin(turned) + 20)
    return mechanism.solve(at=85), (
        "a redundant link does not fit into the position of the others: change its length, or "
        f'leave the link out; the loops just close with "Q C" = {length:.6g} mm '
        f"({50 - length:.6g} shorter)"
    )


def root_not_proved() -> Reached:
    # the steps end where (9/10)^k has made the residual smaller than its tolerance, far from 0
    mechanism = plain("x^10 = 0", x=1)
    position = mechanism.solve()
    x, residual = position.unknowns["x"], position.residual * 10.0
    assert 0.0 < x < 0.1
    return position, (
        "the residual is small, but no root is proved, it is a multiple root or none: start from "
        "another guess, or write the equation so that the root is simple (the residual is "
        f"{residual:.2g}; the steps shrink as near a root of order 10: if there is one, it lies at "
        f"about x = {x:.10g} ± {x:.2g}); other guesses also lead to no position there"
    )


CASES: dict[lw.Status, Callable[[], Reached]] = {
    lw.Status.CONVERGED: converged,
    lw.Status.SINGULAR_JACOBIAN: singular_jacobian,
    lw.Status.DIVERGED: diverged,
    lw.Status.STEP_LIMIT: step_limit,
    lw.Status.CANNOT_CLOSE: cannot_close,
    lw.Status.OUT_OF_REACH: out_of_reach,
    lw.Status.OUT_OF_CIRCUIT: out_of_circuit,
    lw.Status.CHANGE_POINT: change_point,
    lw.Status.START_SINGULAR: start_singular,
    lw.Status.LOST: lost,
    lw.Status.DOES_NOT_FIT: does_not_fit,
    lw.Status.NO_START: no_start,
    lw.Status.ROOT_NOT_PROVED: root_not_proved,
}


def test_every_status_has_its_mechanism() -> None:
    assert set(CASES) == set(lw.Status)


@pytest.mark.parametrize("status", CASES, ids=lambda status: status.name)
def test_a_status_is_reached_and_its_message_is_whole(status: lw.Status) -> None:
    result, message = CASES[status]()
    statuses = {result.status} if isinstance(result, lw.Position) else set(result.status)
    assert statuses == {status}
    assert result.message == message
