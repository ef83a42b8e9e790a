"""Forces over a table and motions in time, beside Exudyn and a stabilised integrator."""

from __future__ import annotations

import time
from collections.abc import Callable
from functools import partial
from importlib import import_module, util
from typing import Any

import numpy as np

import linkwork as lw
from benchmarks.timing import bar, interleaved

__all__ = ["measure", "windows"]

#: B0 at 10 s, exact: the mechanism moves as one pendulum (IFToMM A02).
EXACT = {
    2: (0.328458111540815498, 0.944518538178600921),
    40: (0.180512226686728532, 0.983572740582311549),
}
_UNTIL = 10.0
_STEPS = {2: 80_000, 40: 8_000}  # of Exudyn: its error falls with their square


def measure(repeats: int = 15) -> bool:
    """Limits: processor time over that of the certified sweep; over that of Exudyn, which may have
    a thousand times the error.
    """
    print("forces: processor time, one thread")
    held = _rows(repeats)
    for count in EXACT:
        held = _simulation(count) and held
    return held


def _rows(repeats: int) -> bool:
    """All efforts and reactions of 361 four-bar rows."""
    bar_linkage = lw.example("four-bar").changed(
        masses={k: lw.Mass(mass=1.0, shape="rod") for k in ("crank", "coupler", "rocker")},
        gravity=lw.Gravity(),
        inputs=lw.Input(link="crank", start=0, stop=360, step=1, speed="60 rpm"),
    )
    for _ in range(10):  # from then on with kernels
        bar_linkage.sweep()
    motions = [bar_linkage.sweep() for _ in range(repeats + 1)]
    new = iter(motions)  # places of a motion are computed once
    sweep, alone, both = interleaved(
        [bar_linkage.sweep, lambda: bar_linkage.forces(motion=next(new)), bar_linkage.forces],
        repeats,
        time.process_time,
    )
    ratios = [b / a for a, b in zip(sweep, alone, strict=True)]
    held = bar("361 four-bar rows: all forces / certified sweep", ratios, 1.5)
    ratios = [b / a for a, b in zip(sweep, both, strict=True)]
    return bar("the same with the sweep in it / certified sweep", ratios, 2.0) and held


def windows(count: int) -> lw.Mechanism:
    """Four-bars in a row of rods of 1 m and 1 kg (IFToMM A02)."""
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


def _simulation(count: int) -> bool:
    mechanism = windows(count)
    runs: dict[str, Callable[[], tuple[float, float]]] = {
        "linkwork": partial(_by_linkwork, mechanism),
    }
    if count < 10:  # it loses the branch at flat positions, and many of them take minutes
        runs["Baumgarte, DOP853"] = partial(_by_baumgarte, count)
    if util.find_spec("exudyn") is not None:
        runs["exudyn"] = partial(_by_exudyn, count, _STEPS[count])
    runs["linkwork"]()  # compiled code is loaded
    found: dict[str, tuple[float, float]] = {}
    for name, run in runs.items():
        begin = time.process_time()
        x, y = run()
        took = time.process_time() - begin
        error = float(np.hypot(x - EXACT[count][0], y - EXACT[count][1]))
        found[name] = took, error
        print(f"  A02, N = {count:2}, {name:<18} {took:8.3f} s   error {error:.1e} m")
    if "exudyn" not in found:
        print("  exudyn is not installed: not compared")
        return True
    (own, error), (other, its) = found["linkwork"], found["exudyn"]
    held = bar(f"A02, N = {count}: linkwork / exudyn", [own / other], 1.0)
    return bar(f"A02, N = {count}: error / a thousandth of its", [1e3 * error / its], 1.0) and held


def _by_linkwork(mechanism: lw.Mechanism) -> tuple[float, float]:
    motion = mechanism.simulate(
        until=_UNTIL, step=_UNTIL, start_speed="-1 rad/s", change_points="straight"
    )
    return float(motion["B0.x"][-1]), float(motion["B0.y"][-1])


def _by_exudyn(count: int, steps: int) -> tuple[float, float]:
    """Rigid bodies and revolute joints, generalised-α of index 3."""
    exudyn: Any = import_module("exudyn")
    items: Any = import_module("exudyn.itemInterface")
    exudyn.config.printToConsole = False
    system = exudyn.SystemContainer().AddSystem()
    ground = system.AddObject(items.ObjectGround())

    def marker(body: Any, x: float, y: float) -> Any:
        place = items.MarkerBodyPosition(bodyNumber=body, localPosition=[x, y, 0.0])
        return system.AddMarker(place)

    def rod(x: float, y: float, angle: float, speed: tuple[float, float, float]) -> Any:
        node = items.NodeRigidBody2D(
            referenceCoordinates=[x, y, angle], initialVelocities=list(speed)
        )
        node = system.AddNode(node)
        body = system.AddObject(
            items.ObjectRigidBody2D(mass=1.0, inertia=1.0 / 12.0, nodeNumber=node)
        )
        weight = system.AddMarker(items.MarkerBodyMass(bodyNumber=body))
        system.AddLoad(items.LoadMassProportional(markerNumber=weight, loadVector=[0, -9.81, 0]))
        return node, body

    def pin(first: Any, second: Any) -> None:
        system.AddObject(items.ObjectJointRevolute2D(markerNumbers=[first, second]))

    standing = [rod(k, 0.5, np.pi / 2, (0.5, 0.0, -1.0)) for k in range(count + 1)]
    lying = [rod(k + 0.5, 1.0, 0.0, (1.0, 0.0, 0.0)) for k in range(count)]
    for k, (_, body) in enumerate(standing):
        pin(marker(ground, k, 0.0), marker(body, -0.5, 0.0))
    for k, (_, body) in enumerate(lying):
        pin(marker(standing[k][1], 0.5, 0.0), marker(body, -0.5, 0.0))
        pin(marker(standing[k + 1][1], 0.5, 0.0), marker(body, 0.5, 0.0))
    system.Assemble()
    settings = exudyn.SimulationSettings()
    settings.timeIntegration.numberOfSteps = steps
    settings.timeIntegration.endTime = _UNTIL
    settings.timeIntegration.verboseMode = 0
    # index 2 (Newmark) ends at the first flat position, where constraints are redundant
    settings.timeIntegration.generalizedAlpha.spectralRadius = 0.6
    settings.solutionSettings.writeSolutionToFile = False
    if count > 10:
        settings.linearSolverType = exudyn.LinearSolverType.EigenSparse
    system.SolveDynamic(settings)
    x, y, angle = system.GetNodeOutput(standing[0][0], exudyn.OutputVariableType.Coordinates)
    angle += np.pi / 2
    return x + 0.5 * np.cos(angle), y + 0.5 + 0.5 * np.sin(angle)


def _by_baumgarte(count: int) -> tuple[float, float]:
    """Natural coordinates of B0 … BN, index 1 with Baumgarte's stabilisation, DOP853."""
    solve_ivp = import_module("scipy.integrate").solve_ivp
    n, gain = count + 1, 10.0
    base = np.arange(n) + 0j
    # the mass of a uniform rod between two points; standing rods have one fixed end
    mass = np.zeros((n, n))
    for k in range(n):
        mass[k, k] += 1.0 / 3.0
    for k in range(count):
        mass[k : k + 2, k : k + 2] += np.array([[2.0, 1.0], [1.0, 2.0]]) / 6.0
    weight = np.full(n, 0.5)
    weight[:-1] += 0.5
    weight[1:] += 0.5
    inverse = np.linalg.inv(mass)

    def rate(_: float, state: Any) -> Any:
        z, v = state[: 2 * n].view(complex), state[2 * n :].view(complex)
        arms = np.concatenate([z - base, np.diff(z)])
        moved = np.concatenate([v, np.diff(v)])
        gap = 0.5 * (np.abs(arms) ** 2 - 1.0)
        slope = np.zeros((n + count, n), dtype=complex)  # d gap = Re(conj(slope) dz)
        slope[np.arange(n), np.arange(n)] = arms[:n]
        slope[n + np.arange(count), np.arange(count)] = -arms[n:]
        slope[n + np.arange(count), np.arange(count) + 1] = arms[n:]
        drift = (np.conj(slope) @ v).real
        right = -(np.abs(moved) ** 2) - 2.0 * gain * drift - gain**2 * gap
        free = inverse @ (-1j * 9.81 * weight)
        through = slope @ inverse
        matrix = (np.conj(slope) @ through.T).real
        # parallelograms are redundant when flat: the shortest multipliers
        forces = np.linalg.lstsq(matrix, right - (np.conj(slope) @ free).real, rcond=1e-10)[0]
        bend = free + through.T @ forces
        return np.concatenate([v.view(float), bend.view(float)])

    start = np.concatenate([(base + 1j).view(float), np.ones(n, complex).view(float)])
    found = solve_ivp(rate, (0.0, _UNTIL), start, method="DOP853", rtol=1e-9, atol=1e-9)
    return float(found.y[0, -1]), float(found.y[1, -1])
