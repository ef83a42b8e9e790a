"""Long tables by the compiled kernels: what plain NumPy finds, row by row."""

from __future__ import annotations

import hashlib
import os
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
from linkwork.foundation.arrays import Array
from linkwork.kernels.program import kernel_cache as at_hand
from linkwork.kernels.program.kernel_cache import kernels_are_compiled, say_that_it_compiles
from linkwork.motion import by_kernels
from linkwork.motion.drive import Drive
from linkwork.numerics.continuation.branch_tracking import Track
from linkwork.numerics.rows import SolvedRows
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
def used(monkeypatch: pytest.MonkeyPatch) -> list[by_kernels.KernelRows | None]:
    """What the kernels found, call by call."""
    own, found = by_kernels.kernel_rows, []

    def seen(*arguments: Any) -> by_kernels.KernelRows | None:
        found.append(own(*arguments))
        return found[-1]

    monkeypatch.setattr(by_kernels, "kernel_rows", seen)
    return found


@pytest.fixture
def taken(monkeypatch: pytest.MonkeyPatch) -> list[bool]:
    """Whether what they found was taken, call by call."""
    own, found = by_kernels.KernelRows.put_into, []

    def seen(self: by_kernels.KernelRows, *arguments: Any) -> SolvedRows | None:
        filled = own(self, *arguments)
        found.append(filled is not None)
        return filled

    monkeypatch.setattr(by_kernels.KernelRows, "put_into", seen)
    return found


@pytest.fixture
def both(monkeypatch: pytest.MonkeyPatch, used: list[by_kernels.KernelRows | None]) -> Sweep:
    """A sweep without kernels, and one with them wherever they serve."""

    def sweep(mechanism: lw.Mechanism, **options: Any) -> tuple[lw.Motion, lw.Motion]:
        motions = []
        for wanted in (False, True):
            pay = (lambda model, rows, certify: by_kernels.are_served(model)) if wanted else _never
            monkeypatch.setattr(by_kernels, "kernels_pay", pay)
            motions.append(mechanism.sweep(**options))
            assert bool(used) or not wanted
        return motions[0], motions[1]

    return sweep


def _never(model: object, rows: int, certify: bool) -> bool:
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
    assert (own <= 4.0 * other + 4e-15).all()
    assert quick.worst <= 1e-13
    np.testing.assert_allclose(quick.unique_within, plain.unique_within, rtol=1e-6)
    fair = found & (plain.condition < 1e4)
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
    name: str,
    certify: bool,
    both: Sweep,
    used: list[by_kernels.KernelRows | None],
    taken: list[bool],
) -> None:
    mechanism = fine(lw.example(name))
    plain, quick = both(mechanism, certify=certify)
    assert_same(plain, quick, mechanism)
    assert taken == [True for rows in used if rows is not None]
    # which comes nearer to a change point than rows are apart
    assert (None in used) == (name == "hart-inversor" and certify)
    by_hand = sum(len(rows.checked) for rows in used if rows is not None)
    assert by_hand < 0.1 * plain.found.sum()


@pytest.mark.parametrize("name", ["rapier-drive-limited", "watt-linkage", "chebyshev"])
def test_every_branch_of_a_circuit_has_its_own(
    name: str, both: Sweep, used: list[by_kernels.KernelRows | None], taken: list[bool]
) -> None:
    mechanism = fine(lw.example(name))
    plain, quick = both(mechanism, through=True)
    assert_same(plain, quick, mechanism)
    assert len(plain.limits) >= 2
    assert len(used) >= 2
    assert None not in used
    assert taken == [True] * len(used)


@pytest.mark.parametrize("start", [10.0, 200.0])
def test_a_table_that_falls_or_winds_is_no_other(start: float, both: Sweep) -> None:
    crank = replace(
        lw.example("four-bar").description.inputs[0], start=900.0, stop=start, step=-0.3
    )
    mechanism = lw.example("four-bar").changed(inputs=(crank,))
    assert_same(*both(mechanism), mechanism)


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


Change = Callable[[by_kernels.KernelRows], by_kernels.KernelRows]


@pytest.fixture
def spoilt(monkeypatch: pytest.MonkeyPatch, both: Sweep) -> Callable[..., tuple[lw.Motion, ...]]:
    """Both sweeps of a four-bar, with what the kernels find changed before it is used."""
    own = by_kernels.kernel_rows

    def sweep(change: Change, **options: Any) -> tuple[lw.Motion, ...]:
        def changed(*arguments: Any) -> by_kernels.KernelRows:
            rows = own(*arguments)
            assert rows is not None
            return change(rows)

        monkeypatch.setattr(by_kernels, "kernel_rows", changed)
        return both(fine(lw.example("four-bar")), **options)

    return sweep


@pytest.mark.parametrize("certify", [True, False])
@pytest.mark.parametrize("away", [1e-6, 2e-9])
def test_rows_on_another_branch_are_not_taken(
    certify: bool, away: float, spoilt: Callable[..., tuple[lw.Motion, ...]], taken: list[bool]
) -> None:
    def strayed(rows: by_kernels.KernelRows) -> by_kernels.KernelRows:
        v = rows.rows.v.copy()
        v[len(rows.where) // 2 :, 0] += away  # from the middle on
        return replace(rows, rows=rows.rows.set(v=v))

    plain, quick = spoilt(strayed, certify=certify)
    assert taken == [False]
    np.testing.assert_array_equal(quick.q, plain.q)


def not_checked(rows: by_kernels.KernelRows) -> np.ndarray:
    return np.flatnonzero(~np.isin(rows.where, rows.checked))


def checked(rows: by_kernels.KernelRows) -> np.ndarray:
    return np.flatnonzero(np.isin(rows.where, rows.checked))


@pytest.mark.parametrize(
    ("which", "radius"),
    [
        (not_checked, np.nan),  # without a proof
        (checked, 1.0),  # so wide that other roots may be nearer than its own
    ],
)
def test_rows_without_a_proof_of_their_own_are_not_certified(
    which: Callable[[by_kernels.KernelRows], np.ndarray],
    radius: float,
    spoilt: Callable[..., tuple[lw.Motion, ...]],
    taken: list[bool],
) -> None:
    def doubtful(rows: by_kernels.KernelRows) -> by_kernels.KernelRows:
        return replace(rows, rows=rows.rows.set(which(rows)[7], radius=radius))

    plain, quick = spoilt(doubtful)
    assert taken == [False]
    np.testing.assert_array_equal(quick.radius, plain.radius)


def test_inputs_that_are_not_known_exactly_widen_the_proofs(
    both: Sweep, monkeypatch: pytest.MonkeyPatch
) -> None:
    own, apart, found = by_kernels.kernel_rows, 1e-9, []

    def wider(drive: Drive, track: Track, t: Array, spread: Array, certify: bool) -> None:
        for more in (0.0, apart):
            rows = own(drive, track, t, spread + more, certify)
            assert rows is not None
            found.append(rows)

    monkeypatch.setattr(by_kernels, "kernel_rows", wider)
    both(fine(lw.example("four-bar")))
    narrow, wide = found
    moved = (
        np.abs(wide.rows.first[:, :-1]).max(axis=1) * apart
    )  # by how much the position may be off
    assert wide.rows.radius - narrow.rows.radius == pytest.approx(moved, rel=1e-3)


def test_corrections_are_counted(both: Sweep) -> None:
    _, quick = both(fine(lw.example("jansen-leg")), certify=False)
    assert (quick.iterations[quick.found] >= 0).all()
    assert 1.0 <= quick.iterations.mean() <= 4.0
    _, certified = both(fine(lw.example("jansen-leg")))
    assert certified.iterations.mean() == pytest.approx(quick.iterations.mean() + 1.0, abs=0.2)


def test_uneven_tables_and_laws_are_left_to_numpy(
    both: Sweep, used: list[by_kernels.KernelRows | None]
) -> None:
    assert not by_kernels.are_served(lw.example("cam-roller-follower").model)
    assert not by_kernels.are_served(lw.example("scissor-three-bars").model)  # a redundant link
    mechanism = fine(lw.example("four-bar"), rows=50)
    plain, quick = both(mechanism)
    np.testing.assert_array_equal(quick.q, plain.q)
    assert used == [None]


# ---------------------------------------------------------------- when it pays


def test_a_short_table_does_not_ask_for_compiled_code(monkeypatch: pytest.MonkeyPatch) -> None:
    code = (
        "import sys, linkwork as lw\n"
        "m = lw.example('four-bar')\n"
        "m.sweep(step=0.05)\n"
        "assert 'numba' not in sys.modules\n"
        "from linkwork.motion import by_kernels\n"
        "many = 10**9\n"
        "print(by_kernels.kernels_pay(m.model, many, True), 'numba' in sys.modules)\n"
        "import linkwork.kernels.march.rowwise\n"
        "print(by_kernels.kernels_pay(m.model, 4000, True))\n"
        "print(by_kernels.kernels_pay(m.model, 40000, True))\n"
    )
    at_hand = kernels_are_compiled()
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    first, *others = done.stdout.splitlines()
    assert first == f"{at_hand} False"
    assert others == ["False", "True"]


def test_who_waits_for_a_compiler_is_told(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    say_that_it_compiles()
    (told,) = caplog.records
    assert "once after an installation" in told.getMessage()
    left = tmp_path / "march_0a1b" / "rowwise.by_rows-336.py311.nbi"
    left.parent.mkdir()
    left.write_bytes(b"")
    say_that_it_compiles()
    assert len(caplog.records) == 1


def test_compiled_code_counts_if_it_is_that_of_its_source(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    assert not kernels_are_compiled()
    left = tmp_path / "march_0a1b" / "rowwise.by_rows-336.py311.nbi"
    left.parent.mkdir()
    left.write_bytes(b"")
    assert kernels_are_compiled()
    os.utime(left, (1.0, 1.0))  # older than the source: that of another one
    assert not kernels_are_compiled()
    digest = hashlib.sha256(at_hand._LAST.read_bytes()).digest()
    left.write_bytes(b"an index with " + digest + b" in it")
    os.utime(left, (1.0, 1.0))  # but in a copy times tell nothing
    assert kernels_are_compiled()


def test_numba_keeps_the_digest_by_which_compiled_code_is_known() -> None:
    numba = import_module("numba")
    if tuple(map(int, numba.__version__.split(".")[:2])) < (0, 68):
        pytest.skip("this version goes by the times of files")
    import_module("linkwork.kernels.march.rowwise")
    digest = hashlib.sha256(at_hand._LAST.read_bytes()).digest()
    assert any(digest in index.read_bytes() for index in at_hand._indices())
