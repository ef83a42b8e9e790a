"""Results find a name however it is written: θ13, theta13, ϑ₁₃."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np
import pytest

import linkwork as lw


@pytest.mark.parametrize("name", ["θ13", "theta13", "ϑ13", "θ₁₃"])
def test_a_greek_name_is_found_in_every_spelling(name: str) -> None:
    rapier = lw.example("rapier-drive")
    position, motion = rapier.solve(), rapier.sweep(to=3)
    assert position[name] == position.unknowns["θ13"]
    np.testing.assert_array_equal(motion[name], motion.unknowns["θ13"].value)
    assert motion.series(name) is motion.unknowns["θ13"]


def test_inputs_and_points_too() -> None:
    rapier = lw.example("rapier-drive")
    position, motion = rapier.solve(), rapier.sweep(to=3)
    assert position["theta12"] == 60
    np.testing.assert_array_equal(motion["theta12"], [0, 1, 2, 3])
    crank = lw.linkage(
        points={"O": (0, 0), "Ω": (40, 0), "B": (120, 60), "Q": (100, 0)},
        links={"ground": ["O", "Q"], "a": ["O", "Ω"], "b": ["Ω", "B"], "c": ["Q", "B"]},
        inputs=lw.Input(link="a"),
    )
    assert crank.solve()["Omega.x"] == crank.solve()["Ω.x"] == pytest.approx(40)
    turned = crank.sweep(to=3)
    np.testing.assert_array_equal(turned["Omega.y"], turned["Ω.y"])
    np.testing.assert_array_equal(turned.trace("Omega"), turned.trace("Ω"))
    limits = [crank.sweep(limits_of=[name]).output_limits for name in ("Omega.y", "Ω.y")]
    assert [[limit.value for limit in found] for found in limits] == [pytest.approx([40, -40])] * 2


def test_a_table_shows_its_size_and_first_columns() -> None:
    table = lw.example("rapier-drive").sweep(to=3).table()
    assert repr(table).startswith("<Table of 4 rows over θ12, ")
    assert repr(table).endswith(
        " columns: θ12 [deg], θ13 [deg], θ14 [deg], θ15 [deg], s16 [mm], A0.x [mm], …>"
    )


def _numpy_numbers(value: object, path: str) -> Iterator[str]:
    """Where a value holds a number of NumPy outside of an array."""
    if isinstance(value, np.generic):
        yield path
    elif isinstance(value, Mapping):
        for name, part in value.items():
            yield from _numpy_numbers(part, f"{path}[{name!r}]")
    elif isinstance(value, tuple | list):
        for k, part in enumerate(value):
            yield from _numpy_numbers(part, f"{path}[{k}]")
    elif type(value).__module__.startswith("linkwork.core.results"):
        own = [name for name in dir(type(value)) if not name.startswith("_")]
        for name in own:
            part = getattr(value, name, None)
            if not callable(part):
                yield from _numpy_numbers(part, f"{path}.{name}")


@pytest.mark.parametrize("name", ["slider-crank-engine", "four-bar", "rapier-drive"])
def test_numbers_of_results_are_those_of_python(name: str) -> None:
    """So that ``position.velocity`` is shown as ``{'s': 0.5}``, not with NumPy's types."""
    mechanism = lw.example(name)
    results = {
        "position": mechanism.solve(),
        "motion": mechanism.sweep(step=30),
        "around": mechanism.sweep(step=30, through=True),
        "configurations": mechanism.configurations(),
        "circuits": mechanism.circuits(),
        "check": mechanism.check(),
        "iterates": mechanism.iterates(),
    }
    assert [where for of, found in results.items() for where in _numpy_numbers(found, of)] == []


def test_a_check_and_equations_print_as_text() -> None:
    mechanism = lw.example("four-bar")
    report = str(mechanism.check())
    assert report.startswith("Check of Four-bar linkage, open\n  written as  points and links\n")
    assert report.endswith("  start       solved")
    assert str(mechanism.equations()) == mechanism.equations().text().rstrip()
