"""Designs that follow a record: the equations written for them anew, decisions, and refusals."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import linkwork as lw
from linkwork.core.equations.model import LoopEquations
from linkwork.core.foundation.arrays import Array, BoolArray
from linkwork.core.foundation.lanes import NotElementwise, choose, finite, leader_value, snap
from linkwork.core.mechanism.varied_numbers import VariedNumber, with_numbers
from linkwork.core.motion.model import Model
from linkwork.design.derivatives.tape import RecordedTape, Tape, TapedNumber
from linkwork.families.building import write_equations
from linkwork.synthesis.improvement.improving import numbers_to_vary
from linkwork.synthesis.improvement.lanes import DesignWriter


def _taped_in(equations: LoopEquations) -> list[TapedNumber]:
    found: list[object] = []
    equations.mapped(found.append)
    return [number for number in found if isinstance(number, TapedNumber)]


def _written_anew(
    model: Model, numbers: tuple[VariedNumber, ...], x: Array
) -> tuple[BoolArray, Array, Array]:
    """Designs that agree with the mechanism, and their numbers with derivatives, by lanes."""
    tape = Tape(1 + len(x))
    tape.writing = True
    own = np.array([[float(q.of(model.description)) for q in numbers], *x])
    taped = {q: tape.number(own[:, k]) for k, q in enumerate(numbers)}
    with np.errstate(all="ignore"):
        equations = write_equations(with_numbers(model.description, taped))
    found = _taped_in(equations)
    rates = np.stack([np.broadcast_to(r, own.T.shape) for r in tape.forward(found)])
    values = np.stack([np.broadcast_to(number.values, len(own)) for number in found])
    return tape.agreeing[1:], values[:, 1:], rates[:, :, 1:]


@pytest.mark.parametrize("name", [
    "jansen-leg", "slider-crank", "double-butterfly", "belt-drive", "cam-swinging-follower",
    "scotch-yoke", "inverted-slider-crank", "planetary-gear", "andrews-squeezer", "three-rpr",
])  # fmt: skip
def test_designs_follow_to_the_last_bit_of_equations_written_for_them(name: str) -> None:
    model = lw.example(name).model
    numbers = numbers_to_vary(model, ())
    x = np.array([float(q.of(model.description)) for q in numbers])
    rng = np.random.default_rng(7)
    # far designs of the butterfly cannot be built, and are not among those of one tape
    spread = np.array([[0.0], [1e-6], [0.01], [0.02 if name == "double-butterfly" else 0.3]])
    designs = x + spread * np.where(x == 0.0, 1.0, x) * rng.uniform(-1.0, 1.0, (4, len(x)))
    writer = DesignWriter(model, numbers)
    found = writer.written(designs)
    fine, values, rates = _written_anew(model, numbers, designs)
    followed = [found.known[number.node] for number in _taped_in(writer.equations)]
    assert len(followed) == len(values) > 0
    assert found.fine.tolist() == fine.tolist()
    assert found.fine[0]
    for (value, rate), expected, expected_rate in zip(followed, values, rates, strict=True):
        assert np.array_equal(value, expected, equal_nan=True)
        assert np.array_equal(rate, expected_rate, equal_nan=True)


def test_a_design_that_cannot_be_built_does_not_follow() -> None:
    model = lw.example("double-butterfly").model
    numbers = numbers_to_vary(model, ["C1 C2", "O C1"])
    long = float(numbers[0].of(model.description)), float(numbers[1].of(model.description))
    found = DesignWriter(model, numbers).written(np.array([long, (9.0 * long[0], long[1]), long]))
    assert found.fine.tolist() == [True, False, True]


def _recorded(*values: float) -> tuple[RecordedTape, list[Any]]:
    tape = RecordedTape()
    return tape, [tape.number(value) for value in values]


def test_every_decision_counts_for_every_design() -> None:
    tape, (x, y) = _recorded(2.0, 3.0)
    asked: list[Any] = [
        (x > 1.0) & (y > 2.0), (x > 9.0) | (y > 2.0), (x > 1.0) == (y > 2.0),
        (x > 9.0) != (y > 2.0), finite(1.0 / x), x, not x < 0.0, True & (y < 7.0),
    ]  # fmt: skip
    assert all(asked)
    tape.keep([x * y])
    # each of these designs has another answer to one question, or to more than one
    designs = np.array(
        [[2.0, 3.0], [0.5, 3.0], [2.0, 1.0], [9.5, 3.0], [0.0, 3.0], [2.0, 7.5], [2.5, 3.5]]
    )
    fine, [(value, rate)] = tape.follow(designs.T)
    assert fine.tolist() == [True, False, False, False, False, False, True]
    assert value.tolist() == (designs[:, 0] * designs[:, 1]).tolist()
    assert rate.tolist() == designs.T[::-1].tolist()


def test_choices_are_made_in_every_design() -> None:
    tape, (x,) = _recorded(2.0)
    whole: Any = snap(abs(x - np.round(x)) < 1e-9, np.round(x), x)
    sign: Any = choose(x > 3.0, 1.0, -1.0)
    tape.keep([choose(x > 3.0, x * x, -x), sign * x, whole])
    fine, found = tape.follow(np.array([[2.0, 5.0, 4.0 + 1e-12, 2.5]]))
    assert fine.all()
    assert found[0][0] == pytest.approx([-2.0, 25.0, 16.0, -2.5])
    assert found[0][1] == pytest.approx(np.array([[-1.0, 10.0, 8.0, -1.0]]))
    assert found[1][0] == pytest.approx([-2.0, 5.0, 4.0, -2.5])
    assert found[1][1] == pytest.approx(np.array([[-1.0, 1.0, 1.0, -1.0]]))
    assert found[2][0].tolist() == [2.0, 5.0, 4.0, 2.5]
    assert found[2][1].tolist() == [[1.0, 1.0, 1.0, 1.0]]


def test_a_number_that_does_not_vary_by_chance_excludes_designs_in_which_it_does() -> None:
    tape, (x,) = _recorded(3.0)
    away = (x - 3.0) ** 2
    assert tape.is_steady(away)
    assert not tape.is_steady(x)
    tape.keep([x])
    fine, _ = tape.follow(np.array([[3.0, 3.0 + 1e-6, np.nan]]))
    assert fine.tolist() == [True, False, False]


def test_what_reads_values_cannot_be_recorded() -> None:
    tape, (x,) = _recorded(2.0)
    assert leader_value(x) == 2.0  # of the mechanism itself: the same for all designs
    for read in (
        lambda: x.values, lambda: (x > 1.0).values, lambda: float(x), lambda: len(x),
        lambda: tape.decide(np.array([True])), lambda: tape.chain(np.ones(1), 1.0, x),
        lambda: np.max(x), lambda: np.unwrap(x), lambda: x * np.ones(3), lambda: tape.value_of(x),
    ):  # fmt: skip
        with pytest.raises(NotElementwise):
            read()


def test_numbers_of_another_tape_are_refused() -> None:
    one: Any = Tape().number(1.0)
    other: Any = Tape().number(2.0)
    with pytest.raises(NotElementwise):
        one * other
