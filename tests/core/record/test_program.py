"""Recording arithmetic, and giving values registers."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import given, strategies as st

from linkwork.core.record.recorder import (
    Op,
    Program,
    Recorder,
    Registers,
    Value,
    lower_program,
    reserve,
)
from tests.core.record.running import ran, with_registers

Array = npt.NDArray[np.float64]
#: Registers a, b, c of every operation that are read.
READ = {Op.COPY: 1, Op.NEG: 1, Op.ABS: 1, Op.SQRT: 1, Op.SIN: 1}
READ |= dict.fromkeys((Op.FMA, Op.FMS, Op.FNMA, Op.WHERE), 3)
NAMES = ("a", "b", "c", "d")


def ops(recorder: Recorder) -> list[Op]:
    """The operations that are left when a recording is lowered."""
    program, _ = with_registers(recorder)
    return [Op(int(row[0])) for row in program.code]


def assert_sound(program: Program, scratch_from: int) -> None:
    """No target is a source, and scratch is written before it is read."""
    written: set[int] = set()
    for row in program.code.tolist():
        op, target, sources = Op(row[0]), row[1], row[2:]
        read = sources[: READ.get(op, 2)]
        targets = [target, row[4]] if op is Op.SIN else [target]
        assert not set(targets) & set(read), (op, row)
        assert len(set(targets)) == len(targets)
        for register in read:
            assert register < scratch_from or register in written
        written.update(targets)
        assert max(*targets, *read) < max(program.height, scratch_from)


# ------------------------------------------------------------------ recording


def test_equal_computations_are_done_once_whatever_their_order() -> None:
    rec = Recorder()
    a, b = rec.input("a"), rec.input("b")
    assert (a + b).number == (b + a).number
    assert (a * b).number == (b * a).number
    assert rec.largest([a, b]).number == rec.largest([b, a]).number
    assert (a - b).number != (b - a).number
    assert (a / b).number != (b / a).number
    assert rec.at_most(a, b).number != rec.at_most(b, a).number
    assert rec.input("a").number == a.number
    assert rec.sin_cos(a)[1].number == rec.sin_cos(a)[1].number


def test_zeros_ones_and_signs_cost_nothing() -> None:
    rec = Recorder()
    a, b = rec.input("a"), rec.input("b")
    assert rec.is_zero(a * 0.0)
    assert rec.is_zero(rec.divide(0.0, a))
    assert rec.is_zero(rec.total([]))
    for same in (a + 0.0, 0.0 + a, a - 0.0, a * 1.0, 1.0 * a, (-a) * -1.0, a / 1.0):
        assert same.number == a.number
    assert rec.negate(-a).number == a.number
    assert (a + (-b)).number == (a - b).number
    assert ((-a) + b).number == (b - a).number
    assert (a - (-b)).number == (a + b).number
    assert (0.0 - a).number == (-a).number
    assert ((-a) * (-b)).number == (a * b).number
    assert ((-a) * b).number == (-(a * b)).number
    assert abs(-a).number == abs(abs(a)).number == abs(a).number
    assert rec.where(a, b, b).number == b.number
    assert rec.largest([a, a]).number == a.number
    assert (a / 4.0).number == (a * 0.25).number  # exact
    assert rec.ops[(a / 3.0).number] is Op.DIV  # 1/3 is no float
    assert (rec.constant(2.0) * rec.constant(3.0)).number == rec.constant(6.0).number


def test_dividing_constants_by_zero_gives_what_a_lane_gives() -> None:
    rec = Recorder()
    for name, x in (("a", 1.0), ("b", -1.0), ("c", 0.0)):
        rec.write(name, rec.divide(x, rec.constant(0.0)))
    found = ran(rec, {})
    assert found["a"][0] == math.inf
    assert found["b"][0] == -math.inf
    assert math.isnan(found["c"][0])


def test_a_product_used_once_is_fused_into_its_sum() -> None:
    made: tuple[tuple[Callable[[Value, Value, Value], Value], Op], ...] = (
        (lambda a, b, c: a * b + c, Op.FMA),
        (lambda a, b, c: c + a * b, Op.FMA),
        (lambda a, b, c: a * b - c, Op.FMS),
        (lambda a, b, c: c - a * b, Op.FNMA),
    )
    for make, op in made:
        rec = Recorder()
        a, b, c = (rec.input(name) for name in "abc")
        rec.write("d", make(a, b, c))
        assert ops(rec) == [op]
    rec = Recorder()
    a, b, c = (rec.input(name) for name in "abc")
    rec.write("d", a * b + c)
    rec.write("e", a * b)  # used twice
    assert sorted(ops(rec)) == [Op.ADD, Op.MUL]


def test_what_nobody_asks_for_is_not_computed() -> None:
    rec = Recorder()
    a, b = rec.input("a"), rec.input("b")
    _ = a / b
    _ = rec.sqrt(a)
    rec.write("c", a + b)
    assert ops(rec) == [Op.ADD]


def test_a_value_is_computed_where_it_is_written_to() -> None:
    rec = Recorder()
    a, b = rec.input("a"), rec.input("b")
    rec.write("c", a + b)
    program, registers = with_registers(rec)
    assert program.code.tolist()[0][1] == registers.named["c"]
    assert program.height == registers.count  # no scratch


# ------------------------------------------------------------------ registers


def test_registers_exchanged_at_the_end_hold_what_the_others_held_before() -> None:
    rec = Recorder()
    a, b, c = (rec.input(name) for name in "abc")
    rec.write("a", b)
    rec.write("b", c)
    rec.write("c", a)
    rec.write("d", a)
    found = ran(rec, {"a": np.array([1.0]), "b": np.array([2.0]), "c": np.array([3.0])})
    assert [float(found[name][0]) for name in "abcd"] == [2.0, 3.0, 1.0, 1.0]


def test_a_register_written_anew_is_copied_before() -> None:
    rec = Recorder()
    a, b = rec.input("a"), rec.input("b")
    rec.write("a", a * b)
    rec.write("c", a)
    rec.write("d", a * b)
    found = ran(rec, {"a": np.array([5.0]), "b": np.array([7.0])})
    assert [float(found[name][0]) for name in "acd"] == [35.0, 5.0, 35.0]


@pytest.mark.parametrize("names", [("x", "y"), ("y", "x"), ("x", "z"), ("z", "x"), ("y", "z")])
def test_sine_and_cosine_may_be_written_over_their_angle(names: tuple[str, str]) -> None:
    rec = Recorder()
    x = rec.input("x")
    sine, cosine = rec.sin_cos(x)
    rec.write(names[0], sine)
    rec.write(names[1], cosine)
    program, registers = with_registers(rec)
    assert_sound(program, registers.count)
    found = ran(rec, {"x": np.array([0.5])})
    np.testing.assert_allclose(found[names[0]], math.sin(0.5), rtol=1e-15)
    np.testing.assert_allclose(found[names[1]], math.cos(0.5), rtol=1e-15)


def test_sines_alone_leave_the_places_of_their_cosines_free() -> None:
    rec = Recorder()
    total: Value = rec.constant(0.0)
    for k in range(40):
        total = total + rec.sin_cos(rec.input("x") * float(k + 2))[k % 2]
    rec.write("y", total)
    program, registers = with_registers(rec)
    assert program.height - registers.count < 6


def test_programs_share_named_registers_and_use_scratch_behind_all_of_them() -> None:
    first, second = Recorder(), Recorder()
    first.write("b", first.input("a") * 2.0 + 1.0)
    second.write("c", second.input("b") * second.input("b") - 3.0)
    registers = Registers()
    for rec in (first, second):
        reserve(rec, registers)
    programs = [lower_program(rec, registers, registers.count) for rec in (first, second)]
    assert set(registers.named) == {"a", "b", "c"}
    assert set(registers.constants) == {2.0, 1.0, 3.0}
    space = registers.filled(max(p.height for p in programs), 3)
    for value, register in registers.constants.items():
        assert (space[register] == value).all()


@st.composite
def graphs(draw: st.DrawFn) -> tuple[list[tuple[int, int, int, int]], list[int], list[int]]:
    """Operations on what is there so far; which values are written, and to which names."""
    places = st.integers(0, 200)
    steps = draw(st.lists(st.tuples(st.integers(0, 12), places, places, places), max_size=40))
    written = draw(st.lists(places, min_size=1, max_size=6))
    names = draw(
        st.lists(st.integers(0, 6), min_size=len(written), max_size=len(written), unique=True)
    )
    return steps, written, names


class _Both:
    """The same arithmetic recorded, and done with NumPy on whole numbers (exact)."""

    def __init__(self, given: Array) -> None:
        self.rec = Recorder()
        self.values = [self.rec.input(name) for name in NAMES]
        self.arrays = [*given]
        self.values += [self.rec.constant(x) for x in (0.0, 1.0, -1.0, 2.0)]
        self.arrays += [np.full(given.shape[1], x) for x in (0.0, 1.0, -1.0, 2.0)]

    def step(self, op: int, places: Sequence[int]) -> None:
        """One more value."""
        i, j, k = (p % len(self.values) for p in places)
        x, y, z = self.values[i], self.values[j], self.values[k]
        a, b, c = self.arrays[i], self.arrays[j], self.arrays[k]
        rec = self.rec
        small = np.abs(a).max() * np.abs(b).max() < 2.0**50
        whole = all((np.mod(p, 1.0) == 0.0).all() and np.abs(p).max() < 2.0**51 for p in (a, b, c))
        if op in (0, 1, 2, 3, 6, 12) and not (whole and small):
            op = 4  # arithmetic would round: only signs and choices
        if op == 11 and np.abs(a).max() > 1e6:
            op = 4
        new: tuple[Value, Array]
        match op:
            case 0:
                new = x + y, a + b
            case 1:
                new = x - y, a - b
            case 2 | 3:
                new = x * y, a * b
            case 4:
                new = -x, -a
            case 5:
                new = abs(x), np.abs(a)
            case 6:
                new = x * 4.0 / 2.0, a * 2.0
            case 7:
                new = rec.largest([x, y, z]), np.maximum(np.maximum(a, b), c)
            case 8:
                new = rec.smallest([x, y]), np.minimum(a, b)
            case 9:
                new = rec.where(rec.at_most(x, y), z, x), np.where(a <= b, c, a)
            case 10:
                mask = rec.all_of([rec.at_most(x, y), rec.at_most(y, z)])
                new = mask, np.where((a <= b) & (b <= c), 1.0, 0.0)
            case 11:
                sine, cosine = rec.sin_cos(x)
                self.values.append(cosine)
                self.arrays.append(np.cos(a))
                new = sine, np.sin(a)
            case _:
                new = rec.total([x, y, z]), a + b + c
        self.values.append(new[0])
        self.arrays.append(new[1])


@given(graphs(), st.integers(0, 2**32 - 1))
def test_any_program_computes_what_was_recorded(
    graph: tuple[list[tuple[int, int, int, int]], list[int], list[int]], seed: int
) -> None:
    steps, written, numbers = graph
    rng = np.random.default_rng(seed)
    given = rng.integers(-9, 10, (len(NAMES), 70)).astype(float)
    both = _Both(given)
    for op, *places in steps:
        both.step(op, places)
    names = [(*NAMES, "e", "f", "g")[k] for k in numbers]  # old ones are written over
    expected = {}
    for name, place in zip(names, written, strict=True):
        both.rec.write(name, both.values[place % len(both.values)])
        expected[name] = both.arrays[place % len(both.values)]
    program, registers = with_registers(both.rec)
    assert_sound(program, registers.count)
    found = ran(both.rec, dict(zip(NAMES, given, strict=True)))
    for name, values in expected.items():
        # sines differ from NumPy's by rounding; everything else is exact
        exact = (np.mod(values, 1.0) == 0.0).all()
        np.testing.assert_allclose(found[name], values, rtol=0, atol=0 if exact else 1e-15)
