"""The motions that are compared, and one run of a program on one of them."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import linkwork as lw
from benchmarks.motions.baumgarte_motion import by_baumgarte
from benchmarks.motions.bodies import Bodies, Spring, bodies_of
from benchmarks.motions.exudyn_motion import by_exudyn
from benchmarks.motions.machines import (
    SQUEEZER_ANGLE,
    SQUEEZER_SPRING,
    squeezer,
    window_error,
    windows,
)

__all__ = ["CASES", "PROGRAMS", "run"]


@dataclass(frozen=True, kw_only=True)
class Case:
    """A machine, how long it moves, and the error of the angle by which its input turns [rad]."""

    machine: Callable[[], lw.Mechanism]
    bodies: Callable[[lw.Mechanism], Bodies]
    options: dict[str, Any]
    until: float
    error: Callable[[float], float]
    unit: str
    exudyn_steps: int  # its error falls with their square
    exudyn_newton: tuple[float, float]  # relative and absolute tolerance
    gain: float  # of Baumgarte's stabilisation; ten times more or less make it worse


def _falling(mechanism: lw.Mechanism) -> Bodies:
    return bodies_of(mechanism, speed=-1.0)


def _squeezed(mechanism: lw.Mechanism) -> Bodies:
    fixed, stiffness, free = SQUEEZER_SPRING
    at = complex(*mechanism.solve().points["D"])
    spring = Spring(fixed=fixed, body=2, at=at, stiffness=stiffness, free=free)
    return replace(bodies_of(mechanism, torque=0.033), springs=(spring,))


def _squeezer_error(turned: float) -> float:
    return abs(squeezer().solve().input["β"] + turned - SQUEEZER_ANGLE)


def _windows(count: int, steps: int) -> Case:
    return Case(
        machine=partial(windows, count),
        bodies=_falling,
        options={"start_speed": "-1 rad/s", "change_points": "straight"},
        until=10.0,
        error=partial(window_error, count),
        unit="m",
        exudyn_steps=steps,
        exudyn_newton=(1e-8, 1e-10),  # its own; smaller ones cannot be met at flat positions
        gain=10.0,
    )


CASES = {
    "A02, N = 2": _windows(2, 80_000),
    "A02, N = 40": _windows(40, 8_000),
    "squeezer": Case(
        machine=squeezer,
        bodies=_squeezed,
        options={},
        until=0.03,
        error=_squeezer_error,
        unit="rad",
        exudyn_steps=50_000,
        exudyn_newton=(1e-10, 1e-12),  # by its own it is 4e-6 away in any number of steps
        gain=1000.0,
    ),
}


def _by_linkwork(case: Case) -> tuple[float, float]:
    machine = case.machine()

    def turned() -> float:
        motion = machine.simulate(case.until, step=case.until, **case.options)
        lead = motion[machine.model.equations.inputs[0].name]
        return float(lead[-1] - lead[0])

    turned()  # compiled code is loaded
    begin = time.process_time()
    angle = turned()
    taken = time.process_time() - begin
    return taken, angle * machine.model.input_scale[0]


def _by_peer(solve: Callable[[Case, Bodies], float], case: Case) -> tuple[float, float]:
    bodies = case.bodies(case.machine())
    begin = time.process_time()
    angle = solve(case, bodies)
    return time.process_time() - begin, angle


def _exudyn(case: Case, bodies: Bodies) -> float:
    return by_exudyn(bodies, case.until, case.exudyn_steps, case.exudyn_newton)


def _baumgarte(case: Case, bodies: Bodies) -> float:
    return by_baumgarte(bodies, case.until, tolerance=1e-9, gain=case.gain)


#: Processor time [s] and the angle by which the input turns [rad].
PROGRAMS: dict[str, Callable[[Case], tuple[float, float]]] = {
    "Linkwork": _by_linkwork,
    "Exudyn": partial(_by_peer, _exudyn),
    "Baumgarte": partial(_by_peer, _baumgarte),
}


def run(case: str, program: str) -> tuple[float, float]:
    """Processor time [s] and error of a program."""
    taken, angle = PROGRAMS[program](CASES[case])
    return taken, CASES[case].error(angle)
