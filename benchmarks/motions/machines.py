"""Machines whose motion is known: IFToMM's N four-bars (A02) and Andrews' squeezer."""

from __future__ import annotations

import cmath
import math
from typing import Any

import linkwork as lw
from linkwork.core.mechanism.loops import Loops

__all__ = ["SQUEEZER_ANGLE", "SQUEEZER_SPRING", "WINDOW_PLACES", "squeezer", "windows"]

#: Place of B0 at a time [m], by the number of four-bars and the time [s]: with parallel cranks the
#: machine moves as one pendulum, and its quadrature has 25 digits.
WINDOW_PLACES = {
    2: {1: (-0.195020301949435152, -0.980799205662173821),
        5: (-0.811310461005107567, -0.584615545348975333),
        10: (0.328458111540815498, 0.944518538178600921)},
    40: {1: (-0.115356880632109982, -0.993324111300450176),
         5: (-0.540190050675526618, -0.841543052464442834),
         10: (0.180512226686728532, 0.983572740582311549)},
}  # fmt: skip
#: Angle of the squeezer's crank after 0.03 s [rad], good to 1e-11: an integration of index 1 with
#: three stabilisations and the quadrature of the energy agree. The Test Set's misses the balance
#: of energy by 4e-10.
SQUEEZER_ANGLE = 15.81077119515
#: The squeezer's spring: its fixed point [m], stiffness [N/m] and free length [m].
SQUEEZER_SPRING = (0.014 + 0.072j, 4530.0, 0.07785)


def windows(count: int) -> lw.Mechanism:
    """Four-bars in a row of rods of 1 m and 1 kg; they pass flat positions twice a turn."""
    points: dict[str, Any] = {}
    links: dict[str, Any] = {"ground": [f"A{k}" for k in range(count + 1)]}
    for k in range(count + 1):
        points[f"A{k}"], points[f"B{k}"] = (k, 0), (k, 1)
        links[f"r{k}"] = [f"A{k}", f"B{k}"]
    for k in range(count):
        links[f"h{k}"] = [f"B{k}", f"B{k + 1}"]
    masses = {link: lw.Mass(mass=1, shape="rod") for link in links if link != "ground"}
    return lw.linkage(
        length="m", points=points, links=links, masses=masses, gravity=lw.Gravity(),
        inputs=lw.Input(link="r0"),
    )  # fmt: skip


def squeezer() -> lw.Mechanism:
    """Andrews' squeezer with the masses and the spring of the Test Set for IVP Solvers."""
    base = lw.example("andrews-squeezer")
    own = base.description
    assert isinstance(own, Loops)
    place = base.solve()
    u, zf, zt, e, rr = 0.04, 0.02, 0.04, 0.02, 0.007
    beta, theta, gamma, phi, delta, omega, eps = (
        cmath.exp(1j * place[name]) for name in ("β", "Θ", "γ", "Φ", "δ", "Ω", "ε")
    )
    points = {name: complex(*xy) for name, xy in place.points.items()}
    a, b = points["A"], points["B"]
    centres = [
        0.00092 * beta,
        rr * beta - 0.0115 * beta * theta,
        b + (0.01043 - 0.01874j) * gamma,
        a + zt * delta - 1j * (e - 0.01421) * phi * delta,
        a + (0.02308 + 0.00916j) * delta,
        a - 1j * u * eps + (zf - 0.01421) * omega * eps,
        a - (0.00449 + 0.01228j) * eps,
    ]
    mass = [0.04325, 0.00365, 0.02373, 0.00706, 0.07050, 0.00706, 0.05498]
    inertia = [2.194e-6, 4.410e-7, 5.255e-6, 5.667e-7, 1.169e-5, 5.667e-7, 1.912e-5]
    masses = {}
    for k, centre in enumerate(centres):
        first, second = (points[p] for p in own.links[f"K{k + 1}"][:2])
        z = (centre - first) / ((second - first) / abs(second - first))
        masses[f"K{k + 1}"] = lw.Mass(mass=mass[k], center=(z.real, z.imag), inertia=inertia[k])
    fixed, stiffness, free = SQUEEZER_SPRING
    x, y = f"(D.x - {fixed.real})", f"(D.y - {fixed.imag})"
    pull = f"-{stiffness}*(hypot({x}, {y}) - {free})/hypot({x}, {y})"
    return base.changed(
        points={**own.points, "D": "B + (0.02 - i*0.018)*e^(i*γ)"},
        links={**own.links, "K3": ("B", "F", "D")},
        masses=masses,
        loads=(
            lw.Load(point="D", link="K3", force=(f"{pull}*{x}", f"{pull}*{y}")),
            lw.Load(link="K1", torque=0.033),
        ),
        inputs=lw.Input(variable="β"),
    )


def window_error(count: int, turned: float) -> float:
    """Distance of B0 from its place after 10 s if its crank has turned so far [rad]."""
    return abs(cmath.exp(1j * (0.5 * math.pi + turned)) - complex(*WINDOW_PLACES[count][10]))
