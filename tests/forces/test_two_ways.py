"""Virtual work and free bodies give the same efforts, with loads of every kind on every joint."""

from __future__ import annotations

import numpy as np
import pytest

import linkwork as lw
from linkwork.core.mechanism.linkage import Linkage
from linkwork.forces.results import ForceStatus
from tests.forces.random_loads import loaded

LINKAGES = [
    name
    for name in lw.examples()
    if isinstance((own := lw.example(name)).description, Linkage) and own.description.inputs
]
REDUNDANT = ("dixon-one", "dixon-two", "parallel-cranks", "scissor-three-bars")


@pytest.mark.parametrize("name", LINKAGES)
def test_two_ways_agree_on_a_library_mechanism(name: str) -> None:
    mechanism = loaded(lw.example(name), seed=len(name))
    values = mechanism.description.rows(mechanism.description.inputs[0])
    single = len(mechanism.description.inputs) == 1
    for at in values[[len(values) // 7, len(values) // 2]] if single else [None]:
        position = mechanism.solve(None if at is None else float(at), certify=False)
        if position.condition > 1e8 or not position.status.ok:
            continue
        found = mechanism.forces(None if at is None else float(at)) if single else _here(mechanism)
        expected = ForceStatus.UNDETERMINED if name in REDUNDANT else ForceStatus.FOUND
        assert found.status is expected
        assert found["disagreement"] < 1e-10
        power, loads, rate = (float(found[n]) for n in ("power", "load_power", "energy_rate"))
        lost = float(found["friction_power"]) if "friction_power" in found.values else 0.0
        assert abs(power + loads - rate - lost) < 1e-12 * (abs(power) + abs(loads) + abs(rate))


def _here(mechanism: lw.Mechanism) -> lw.forces.Reactions:
    return mechanism.forces(mechanism.solve(certify=False).input)


def test_the_energy_rate_is_the_slope_of_the_energy() -> None:
    mechanism = loaded(lw.example("four-bar"), seed=3)
    motion = mechanism.sweep(from_=0, to=2, step=0.01, certify=False)
    found = mechanism.forces(motion=motion)
    energy = np.add(found["kinetic_energy"], found["stored_energy"])
    slope = (energy[2:] - energy[:-2]) / (2.0 * 0.01 / 2.0)  # at 2 deg/s
    assert slope == pytest.approx(np.asarray(found["energy_rate"])[1:-1], rel=1e-6)


def test_units_of_one_machine_change_no_force() -> None:
    """Millimetres, metres and inches with pounds: the effort in N mm is the same."""
    efforts = []
    for length, mass, force, per_mm, per_kg, per_newton in (
        ("mm", "kg", "N", 1.0, 1.0, 1.0),
        ("m", "g", "kN", 1e-3, 1e3, 1e-3),
        ("in", "lb", "lbf", 1.0 / 25.4, 1.0 / 0.45359237, 1.0 / 4.4482216152605),
    ):
        arm, rod, inertia = 60.0 * per_mm, 400.0 * per_mm, 18e3 * per_kg * per_mm**2
        press = lw.linkage(
            length=length,
            mass=mass,
            force=force,
            points={"O": (0, 600 * per_mm), "T": (0, 0), "A": (0, 660 * per_mm), "C": (0, rod)},
            links={"ground": ["O", "T"], "crank": ["O", "A"], "rod": ["A", "C"], "ram": ["C"]},
            lengths={"O A": arm, "A C": rod},
            sliders=[lw.Slider(name="h", link="ram", points=("C",), on="ground", line=("T", "O"))],
            gravity=lw.Gravity(),
            masses={
                "crank": lw.Mass(mass=12 * per_kg, center=(8 * per_mm, 0), inertia=inertia),
                "rod": lw.Mass(mass=9 * per_kg, shape="rod"),
                "ram": lw.Mass(mass=25 * per_kg),
            },
            loads=[lw.Load(point="C", link="ram", force=(0, 2e4 * per_newton))],
            inputs=lw.Input(link="crank", speed="120 rpm"),
        )
        found = press.forces(at=200)
        efforts.append(float(found["crank.effort"]) / (per_newton * per_mm))
        assert found.units["crank.effort"] == f"{force}·{length}"
    assert efforts == pytest.approx([efforts[0]] * 3, rel=1e-12)
