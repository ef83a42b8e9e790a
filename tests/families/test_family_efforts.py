"""Efforts of families equal those of each design alone."""

from __future__ import annotations

from typing import cast

import numpy as np
import pytest

import linkwork as lw
from linkwork.core.foundation.arrays import Array
from linkwork.core.mechanism.linkage import Linkage
from linkwork.families.family import Family
from linkwork.families.values import design_efforts
from tests.design.test_force_sensitivity import FRICTION, MACHINE


def varied(machine: lw.Mechanism) -> Family:
    random = np.random.default_rng(5)
    numbers = {"O A": random.normal(40, 0.5, 7), "A B": random.normal(120, 1, 7)}
    return machine.family(numbers | {"m2": random.uniform(0.5, 2.0, 7)})


def alone(machine: lw.Mechanism, family: Family, k: int) -> Array:
    numbers = {name: float(values[k]) for name, values in family.dimensions.items()}
    lengths = {name: numbers[name] for name in ("O A", "A B")}
    given = {**machine.description.dimensions, "m2": numbers["m2"]}
    design = machine.changed(lengths=lengths, dimensions=given)
    return np.asarray(design.forces()["crank.effort"])


@pytest.mark.parametrize("text", [MACHINE, MACHINE + FRICTION], ids=["smooth", "rubbing"])
def test_efforts_of_a_family_are_those_of_each_design_alone(text: str) -> None:
    machine = lw.loads(text)
    family = varied(machine)
    motion = family.sweep()
    found = motion["crank.effort"]
    together = design_efforts(family.designs, motion.rows, "crank.effort")
    # friction is decided row by row and design by design
    assert (together is None) == (text != MACHINE)
    for k in (0, 3, 6):
        wanted = alone(machine, family, k)
        assert found[k] == pytest.approx(wanted, rel=1e-11, abs=1e-11 * np.abs(wanted).max())


def test_dead_points_and_missing_rows_of_a_family_have_no_effort() -> None:
    bar = lw.example("four-bar").changed(masses={"coupler": lw.Mass(mass=1.0, shape="rod")})
    loaded = bar.changed(gravity=lw.Gravity(), inputs=[lw.Input(link="crank", step=10)])
    motion = loaded.family({"O2 A": [40.0, 80.0]}).sweep()
    effort = motion["crank.effort"]
    assert np.isfinite(effort[0]).all()
    assert (np.isfinite(effort[1]) == motion.found[1]).all()
    assert not motion.found[1].all()


def test_a_load_with_a_formula_of_a_rate_is_recorded_too() -> None:
    load = lw.Load(link="rocker", torque="-20 - 0.5*rocker.velocity")
    bar = lw.example("four-bar").changed(loads=[load], inputs=[lw.Input(link="crank", speed=100)])
    family = bar.family({"O2 A": [38.0, 40.0]})
    motion = family.sweep()
    assert design_efforts(family.designs, motion.rows, "crank.effort") is not None
    given = {**cast(Linkage, bar.description).lengths, "O2 A": 38.0}
    wanted = np.asarray(bar.changed(lengths=given).forces()["crank.effort"])
    assert motion["crank.effort"][0] == pytest.approx(wanted, rel=1e-11, abs=1e-9)


def test_a_switched_load_is_solved_design_by_design() -> None:
    load = lw.Load(link="rocker", torque="-20*(rocker > 80)")
    bar = lw.example("four-bar").changed(loads=[load])
    motion = bar.family({"O2 A": [38.0, 40.0]}).sweep()
    given = {**cast(Linkage, bar.description).lengths, "O2 A": 38.0}
    wanted = np.asarray(bar.changed(lengths=given).forces()["crank.effort"])
    assert motion["crank.effort"][0] == pytest.approx(wanted, rel=1e-11, abs=1e-9)
