"""Long tables by the compiled kernels: what plain NumPy finds, row by row."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from collections.abc import Callable
from dataclasses import replace
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import linkwork as lw
from linkwork.core.foundation.arrays import Array
from linkwork.core.motion.following import Drive
from linkwork.core.numerics.branch_tracking import Node
from linkwork.core.numerics.system import SolvedRows
from linkwork.families import by_kernels
from linkwork.families.by_kernels import rows as rows_module
from linkwork.families.compiled import code_cache as kernel_cache
from linkwork.families.compiled.code_cache import is_compiled, say_that_it_compiles, sources_digest
from linkwork.families.march import rate_programs as position_programs
from tests.library_mechanisms import read_example
from tests.thinned import thinned

ROWS = 2400
SERVED = [
    name
    for name in lw.examples()
    if by_kernels.are_served(read_example(name).model)
    and len(read_example(name).description.inputs) == 1
]
Sweep = Callable[..., tuple[lw.Motion, lw.Motion]]


@pytest.fixture
def used(monkeypatch: pytest.MonkeyPatch) -> list[SolvedRows | None]:
    """What the kernels found, call by call."""
    own, found = by_kernels.kernel_rows, []

    def seen(*arguments: Any) -> SolvedRows | None:
        found.append(own(*arguments))
        return found[-1]

    monkeypatch.setattr(by_kernels, "kernel_rows", seen)
    return found


@pytest.fixture
def both(monkeypatch: pytest.MonkeyPatch, used: list[SolvedRows | None]) -> Sweep:
    """A sweep without kernels, and one with them wherever they serve."""

    def sweep(mechanism: lw.Mechanism, **options: Any) -> tuple[lw.Motion, lw.Motion]:
        motions = []
        for wanted in (False, True):
            pay = (lambda model, rows: by_kernels.are_served(model)) if wanted else _never
            monkeypatch.setattr(by_kernels, "kernels_pay", pay)
            motions.append(mechanism.sweep(**options))
            assert bool(used) == wanted
        return motions[0], motions[1]

    return sweep


def _never(model: object, rows: int) -> bool:
    return False


def fine(mechanism: lw.Mechanism, rows: int = ROWS) -> lw.Mechanism:
    """With so many steps through its own range."""
    asked = mechanism.model.rows_in_file_units[:, 0]
    (own,) = mechanism.description.inputs
    step = float(asked[-1] - asked[0]) / rows
    return mechanism.changed(
        inputs=(replace(own, start=float(asked[0]), stop=float(asked[-1]), step=step),)
    )


def assert_same(plain: lw.Motion, quick: lw.Motion, mechanism: lw.Mechanism) -> None:
    assert quick.status == plain.status
    assert quick.certification == plain.certification
    assert quick.branch == plain.branch
    assert quick.limit == plain.limit
    np.testing.assert_array_equal(quick.added, plain.added)
    found = plain.found
    weights = mechanism.model.compiled.solver.variable_scale[: plain.q.shape[1]]
    away = (np.abs(quick.q - plain.q) / weights).max(axis=1)[found]
    proved = plain.certified[found]
    assert (away[proved] <= (quick.radius + plain.radius)[found][proved]).all()
    assert (away <= 1e-11).all()
    own, other = quick.radius[plain.certified], plain.radius[plain.certified]
    # two proofs of one root from two guesses: 0.24 to 3.1 times each other over the whole library
    assert (own >= 0.2 * other - 1e-15).all()
    # where the equations are linear, NumPy knows a position exactly and the kernels to rounding
    assert (own <= 4.0 * other + 1e-14).all()
    assert quick.worst <= 1e-13
    fair = found & (plain.condition < 1e4)
    np.testing.assert_allclose(quick.unique_within[fair], plain.unique_within[fair], rtol=1e-6)
    np.testing.assert_allclose(quick.unique_within, plain.unique_within, rtol=1e-2)
    np.testing.assert_allclose(quick.condition[fair], plain.condition[fair], rtol=1e-8)
    for order in ("first", "second"):
        own, other = (
            np.stack([getattr(series, order)[fair] for series in motion.unknowns.values()])
            for motion in (quick, plain)
        )
        size = np.maximum(np.abs(other / weights[:, None]).max(axis=0), 1.0)
        off = np.abs((own - other) / weights[:, None]).max(axis=0) / size
        assert (off <= 1e-13 * plain.condition[fair] ** (1 if order == "first" else 2)).all()


@pytest.mark.parametrize("certify", [True, False])
@pytest.mark.parametrize("name", thinned(SERVED, 6))
def test_rows_are_those_of_plain_sweeps(
    name: str, certify: bool, both: Sweep, used: list[SolvedRows | None]
) -> None:
    mechanism = fine(lw.example(name))
    plain, quick = both(mechanism, certify=certify)
    assert_same(plain, quick, mechanism)
    if plain.limits:
        assert used[0] is None  # the way to some rows is blocked
        del used[0]
    by_kernel = sum(len(rows) for rows in used if rows is not None)
    # hart-inversor comes nearer to a change point than rows are apart
    assert by_kernel > 0.8 * plain.found.sum() or name == "hart-inversor"


@pytest.mark.parametrize("name", ["rapier-drive-limited", "watt-linkage", "chebyshev"])
def test_every_branch_of_a_circuit_has_its_own(
    name: str, both: Sweep, used: list[SolvedRows | None]
) -> None:
    mechanism = fine(lw.example(name))
    plain, quick = both(mechanism, through=True)
    assert_same(plain, quick, mechanism)
    assert len(plain.limits) >= 2
    assert len([rows for rows in used if rows is not None]) >= 2


@pytest.mark.parametrize("start", [10.0, 200.0])
def test_a_table_that_falls_or_winds_is_no_other(start: float, both: Sweep) -> None:
    crank = replace(
        lw.example("four-bar").description.inputs[0], start=900.0, stop=start, step=-0.3
    )
    mechanism = lw.example("four-bar").changed(inputs=(crank,))
    assert_same(*both(mechanism), mechanism)


def test_a_table_out_of_reach_has_its_statuses(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(by_kernels, "kernels_pay", lambda model, rows: True)
    motion = (
        lw.example("four-bar").with_dimensions({"O2 A": 150}).sweep(start=170, stop=190, step=1)
    )
    assert {*motion.status} == {lw.Status.OUT_OF_REACH}


def test_two_inputs_move_together(both: Sweep) -> None:
    mechanism = lw.example("five-bar-robot")
    ranges = mechanism.model.rows_in_file_units
    inputs = tuple(
        replace(
            own,
            start=float(ranges[0, k]),
            stop=float(ranges[-1, k]),
            step=float(np.ptp(ranges[:, k])) / ROWS * np.sign(ranges[-1, k] - ranges[0, k]),
        )
        for k, own in enumerate(mechanism.description.inputs)
    )
    finer = mechanism.changed(inputs=inputs)
    assert_same(*both(finer), finer)


@pytest.mark.parametrize("certify", [True, False])
def test_rows_of_another_position_than_the_anchor_are_not_taken(
    certify: bool, both: Sweep, used: list[SolvedRows | None], monkeypatch: pytest.MonkeyPatch
) -> None:
    own = position_programs.along_rows

    def narrow(*arguments: Any) -> Array:
        read = own(*arguments)
        read[-1] = 0.0  # no root is known to be the only one anywhere near
        return read

    monkeypatch.setattr(rows_module, "along_rows", narrow)
    plain, quick = both(fine(lw.example("four-bar")), certify=certify)
    assert used == [None, None]
    np.testing.assert_array_equal(quick.q, plain.q)


def test_rows_without_a_proof_of_their_own_are_not_taken(
    both: Sweep, used: list[SolvedRows | None], monkeypatch: pytest.MonkeyPatch
) -> None:
    own = position_programs.along_rows

    def doubtful(*arguments: Any) -> Array:
        read = own(*arguments)
        read[-2, 7] = np.nan
        return read

    monkeypatch.setattr(rows_module, "along_rows", doubtful)
    plain, quick = both(fine(lw.example("four-bar")))
    assert used == [None, None]
    np.testing.assert_array_equal(quick.radius, plain.radius)


def test_inputs_that_are_not_known_exactly_widen_the_proofs(
    both: Sweep, monkeypatch: pytest.MonkeyPatch
) -> None:
    own, apart, found = by_kernels.kernel_rows, 1e-9, []

    def wider(drive: Drive, anchor: Node, t: Array, spread: Array) -> SolvedRows:
        for more in (0.0, apart):
            rows = own(drive, anchor, t, spread + more)
            assert rows is not None
            found.append(rows)
        return found[-1]

    monkeypatch.setattr(by_kernels, "kernel_rows", wider)
    mechanism = fine(lw.example("four-bar"))
    monkeypatch.setattr(by_kernels, "kernels_pay", lambda model, rows: True)
    mechanism.sweep()
    narrow, wide = found[:2]
    moved = np.abs(wide.first[:, :-1]).max(axis=1) * apart  # how far the position may be off
    assert wide.radius - narrow.radius == pytest.approx(moved, rel=1e-3)


def test_corrections_are_counted(both: Sweep) -> None:
    _, quick = both(fine(lw.example("jansen-leg")), certify=False)
    assert (quick.iterations[quick.found] >= 1).all()
    assert 1.0 <= quick.iterations.mean() <= 4.0


def test_coarse_tables_are_served_too(both: Sweep, used: list[SolvedRows | None]) -> None:
    mechanism = fine(lw.example("four-bar"), rows=50)
    assert_same(*both(mechanism), mechanism)
    assert None not in used


def test_laws_and_redundant_links_are_left_to_numpy() -> None:
    assert not by_kernels.are_served(lw.example("cam-roller-follower").model)
    assert not by_kernels.are_served(lw.example("scissor-three-bars").model)  # a redundant link


# ---------------------------------------------------------------- when it pays


def test_compiled_code_is_loaded_when_enough_was_solved_without_it() -> None:
    code = (
        "import sys, linkwork as lw\n"
        "m = lw.example('four-bar')\n"
        "m.sweep()\n"
        "assert 'numba' not in sys.modules\n"
        "from linkwork.families import by_kernels\n"
        "print(by_kernels.kernels_pay(m.model, 10**6), 'numba' in sys.modules)\n"
        "import linkwork.families.march.independent\n"
        "print(by_kernels.kernels_pay(m.model, 20), by_kernels.kernels_pay(m.model, 361))\n"
    )
    at_hand = is_compiled("independent")
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    first, second = done.stdout.splitlines()
    assert first == f"{at_hand} False"
    assert second == f"False {at_hand}"  # too few rows; a topology of which a million were asked


def test_many_small_tables_count_like_a_long_one() -> None:
    code = (
        "import linkwork as lw\n"
        "import linkwork.families.march.independent\n"
        "from linkwork.families import by_kernels\n"
        "one, other = lw.example('four-bar').model, lw.example('jansen-leg').model\n"
        "print([by_kernels.kernels_pay(one, 361) for _ in range(9)].index(True))\n"
        "print(by_kernels.kernels_pay(other, 361))\n"
        "near = lw.example('four-bar').with_dimensions({'O2 A': 41}).model\n"
        "print(by_kernels.kernels_pay(near, 361))\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["8", "False", "True"]


@pytest.fixture
def _nothing_said() -> None:
    kernel_cache._warn_that_it_compiles.cache_clear()


@pytest.mark.parametrize("loop", ["independent", "lockstep", "rowwise"])
@pytest.mark.usefixtures("_nothing_said")
def test_compiled_code_counts_if_it_is_that_of_all_sources(
    loop: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    caplog: pytest.LogCaptureFixture,
) -> None:
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    left = tmp_path / "march_0a1b" / f"{loop}.{kernel_cache.LOOPS[loop]}-336.py311.nbi"
    left.parent.mkdir()
    left.write_bytes(b"an index with " + sources_digest() + b" in it")
    assert is_compiled(loop)
    say_that_it_compiles()
    say_that_it_compiles(loop)
    assert not caplog.records
    left.write_bytes(b"an index of another version")
    assert not is_compiled(loop)
    say_that_it_compiles(loop)
    say_that_it_compiles()  # once is enough
    (told,) = caplog.records
    assert "once after an installation" in told.getMessage()


def test_every_source_that_is_compiled_has_a_part_in_the_digest(tmp_path: Path) -> None:
    package = Path(lw.__file__).parent
    changed = tmp_path / "linkwork"
    shutil.copytree(package, changed, ignore=shutil.ignore_patterns("__pycache__", "*.npz"))
    code = (
        "import sys; from linkwork.families.compiled.code_cache import sources_digest as d; "
        "print(d().hex())"
    )

    def digest() -> str:
        environment = {**os.environ, "PYTHONPATH": str(tmp_path), "PYTHONDONTWRITEBYTECODE": "1"}
        command = [sys.executable, "-c", code]
        done = subprocess.run(command, capture_output=True, text=True, check=True, env=environment)
        return done.stdout.strip()

    assert digest() == sources_digest().hex()
    for name in ("march/step_trial.py", "compiled/interpreter.py"):
        with (changed / "families" / name).open("a", encoding="utf-8") as file:
            file.write("# another version\n")
        assert digest() != sources_digest().hex()
        shutil.copy(package / "families" / name, changed / "families" / name)


def test_numba_keeps_the_digest_by_which_compiled_code_is_known() -> None:
    import_module("linkwork.families.march.independent")
    indices = [index.read_bytes() for index in kernel_cache._indices("independent")]
    assert any(sources_digest() in index for index in indices)


@pytest.mark.parametrize("options", [{"limits_of": "rocker"}, {"through": True}])
def test_extremes_and_circuits_have_a_track(
    options: dict[str, Any], both: Sweep, used: list[SolvedRows | None]
) -> None:
    plain, quick = both(fine(lw.example("four-bar")), **options)
    assert None not in used
    assert len(quick) == len(plain)
    for name, series in plain.unknowns.items():
        own = quick.unknowns[name].value
        np.testing.assert_allclose(own, series.value, rtol=0, atol=1e-9)
    assert [limit.value for limit in quick.output_limits] == pytest.approx(
        [limit.value for limit in plain.output_limits], abs=1e-9
    )
