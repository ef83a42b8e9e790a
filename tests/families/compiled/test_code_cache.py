"""Programs written out as functions do what the machine does, and are kept on disk."""

from __future__ import annotations

import ctypes
import os
import shutil
import subprocess
import sys
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import linkwork as lw
from linkwork.core.foundation.arrays import Array, allocate_aligned
from linkwork.core.record.printing import trial_source
from linkwork.core.record.recorder import LANES, SOURCES, Op
from linkwork.families.compiled import code_cache as execution, code_cache as kernel_cache
from linkwork.families.compiled.code_cache import (
    Execution,
    is_cached,
    is_compiled,
    load_compiled,
    say_that_it_compiles,
    sources_digest,
)
from linkwork.families.compiled.compiling import CodeFiles
from linkwork.families.compiled.interpreter import run
from linkwork.families.design_sweep import block_parts
from linkwork.families.march import step_trial as step_control, sweep_kernel
from linkwork.families.march.march_programs import Steps
from linkwork.families.march.sweep_kernel import SweepKernel

PLACES = 5
_CODE_FILES: Any = CodeFiles  # whose methods have no types


@pytest.fixture(autouse=True)
def _own_cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    monkeypatch.setenv("LINKWORK_CACHE", str(tmp_path))
    before = set(sys.modules)
    yield
    for name in set(sys.modules) - before:
        if name.startswith("linkwork_kernel"):
            del sys.modules[name]


def every_operation(rng: np.random.Generator, height: int) -> np.ndarray:
    """A program of every instruction with registers by chance, the targets in place 0."""
    code = []
    for op in [
        op for op in Op if op not in (Op.COS, Op.INPUT, Op.CONSTANT, Op.ATAN2, Op.CALL, Op.PART)
    ] * 3:
        target, beside = rng.choice(height, 2, replace=False)
        sources = rng.integers(0, PLACES * height + 6, 3)
        if op is Op.SIN:
            sources[2] = beside
        sources[SOURCES[op] :] = beside if op is Op.SIN else target
        code.append([op, target, *sources])
    return np.array(code, dtype=np.uint32)


def test_every_instruction_written_out_is_that_of_the_machine() -> None:
    rng = np.random.default_rng(7)
    height = 6
    for _ in range(3):
        code = every_operation(rng, height)
        space = rng.choice([0.0, 1.0, -2.0, 0.3, 5.5, np.nan], (PLACES * height + 6, LANES))
        constants = dict(enumerate([0.25, -np.inf, np.inf, np.nan], PLACES * height + 2))
        for register, value in constants.items():
            space[register] = value
        other = space.copy()
        run(code, space)
        source = trial_source([code[:20], code[20:]], height, set(range(height)), constants)
        number = ctypes.POINTER(ctypes.c_double)
        places = [other[k * height :].ctypes.data_as(number) for k in range(PLACES + 1)]
        load_compiled(source, "trial").ctypes(*places, LANES)
        np.testing.assert_allclose(other, space, rtol=1e-12, atol=1e-13)


@pytest.mark.parametrize(
    ("name", "dimension", "value", "certify"),
    [
        ("four-bar", "O2 A", 40.0, True),
        ("four-bar", "A B", 60.0, False),  # with dead points
        ("coupled-six-link", "a2", 100.0, False),
    ],
)
def test_families_are_the_same_with_compiled_equations(
    name: str, dimension: str, value: float, certify: bool, tmp_path: Path
) -> None:
    family = lw.example(name).family({dimension: np.linspace(0.98, 1.03, 70) * value})
    usual = family.sweep(certify=certify, specialised=False)
    assert not (tmp_path / "kernels").exists()
    special = family.sweep(certify=certify, specialised=True)
    assert len(list((tmp_path / "kernels").glob("*.py"))) == 1
    assert usual.found.any()
    assert (special.status == usual.status).all()
    assert (special.certified == usual.certified).all()
    away = np.abs(special.rows.v - usual.rows.v)
    assert np.nanmax(away) <= 1e-11 * np.nanmax(np.abs(usual.rows.v))


def kernel() -> SweepKernel:
    model = lw.example("crank-slider").model
    return SweepKernel(model.compiled.table, block_parts(model), frozenset(), False)


def test_many_positions_are_worth_a_compilation(monkeypatch: pytest.MonkeyPatch) -> None:
    few, many = kernel(), kernel()
    few.choose_execution(Execution(positions=99_999_999))
    assert few.trial == 0
    many.choose_execution(Execution(positions=100_000_000))
    assert many.trial != 0
    again = kernel()
    again.choose_execution(Execution(positions=999_999))
    assert again.trial == 0
    again.choose_execution(Execution(positions=1_000_000))  # what the run before has compiled
    assert again.trial == many.trial
    again.choose_execution(Execution(specialised=False, positions=1 << 40))  # and no more
    assert again.trial == 0
    monkeypatch.setattr(execution, "_LONGEST", 10)
    long = kernel()
    long.choose_execution(Execution(positions=1 << 40))
    assert long.trial == 0


def test_a_changed_file_is_written_anew(tmp_path: Path) -> None:
    source = trial_source([np.array([[Op.NEG, 0, 1, 0, 0]], np.uint32)], 2, {0}, {})
    assert not is_cached(source)
    load_compiled(source, "trial")
    (file,) = (tmp_path / "kernels").glob("*.py")
    assert file.read_text() == source
    assert is_cached(source)
    del sys.modules[file.stem]
    file.write_text("raise SystemExit('somebody else')")
    load_compiled(source, "trial")
    assert file.read_text() == source
    assert not list((tmp_path / "kernels").glob("*.part"))


def test_threads_that_want_the_same_module_wait_until_it_is_whole() -> None:
    source = "import time\n\ntime.sleep(0.2)\n\n\ndef trial():\n    return 7\n"
    with ThreadPoolExecutor(4) as pool:
        functions = list(pool.map(lambda _: load_compiled(source, "trial"), range(4)))
    assert [function() for function in functions] == [7] * 4
    assert len(set(functions)) == 1


def test_threads_share_a_kernel_and_its_workspaces(monkeypatch: pytest.MonkeyPatch) -> None:
    """Another thread asks for a workspace of other steps while one is being made."""
    shared, mine, other = kernel(), Steps(tolerance=1e-3), Steps(tolerance=1e-4)
    tolerance = shared.registers.named["tolerance"]
    others = []

    def meanwhile(*size: int) -> Array:
        monkeypatch.setattr(sweep_kernel, "allocate_aligned", allocate_aligned)
        others.append(shared.workspace(other))
        return allocate_aligned(*size)

    monkeypatch.setattr(sweep_kernel, "allocate_aligned", meanwhile)
    assert shared.workspace(mine)[tolerance, 0] == 1e-3
    assert others[0][tolerance, 0] == 1e-4


def test_without_a_folder_to_write_to_the_machine_serves(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    taken = tmp_path / "taken"
    taken.write_text("")
    monkeypatch.setenv("LINKWORK_CACHE", str(taken))
    with pytest.raises(lw.InputError) as told:
        kernel().choose_execution(Execution(specialised=True))
    assert str(told.value) == (
        f"compiled code cannot be stored in {taken / 'kernels'} ({os.strerror(20)}): "
        "name another folder in LINKWORK_CACHE, or use specialised=False"
    )
    mine = kernel()
    mine.choose_execution(Execution(positions=1 << 40))
    assert mine.trial == 0


def test_equations_compiled_before_leave_values_as_they_were() -> None:
    family = lw.example("four-bar").family({"O2 A": np.linspace(38.0, 42.0, 20)})
    before = family.sweep(certify=False).rows.v
    family.sweep(certify=False, specialised=True)
    np.testing.assert_array_equal(family.sweep(certify=False).rows.v, before)


def test_functions_of_compiled_ones_refuse_python() -> None:
    with pytest.raises(TypeError, match="stride is called by compiled functions only"):
        step_control.stride(1.0, 2.0, 0.1)


def test_code_of_a_signature_is_never_read_for_another_one(tmp_path: Path) -> None:
    """One process compiles a function for integers while another one, which began with the same
    empty folder, is about to write its code for numbers.
    """

    def files() -> Any:
        return _CODE_FILES(cache_path=str(tmp_path), filename_base="f-1", source_stamp="now")

    other, read = files(), []

    def enter(known: dict[str, str]) -> None:
        other.save("integers", "code for integers")
        _CODE_FILES._save_index(late, known)

    def write(name: str, code: str) -> None:
        read.append(files().load("numbers"))
        _CODE_FILES._save_data(late, name, code)

    late = files()
    late._save_index, late._save_data = enter, write
    late.save("numbers", "code for numbers")
    read += [files().load("numbers"), files().load("integers")]
    assert read[0] is None
    assert read[1] == "code for numbers"
    assert read[2] in (None, "code for integers")  # its entry may be lost: it is compiled again


def test_code_of_former_sources_is_not_read_and_goes(tmp_path: Path) -> None:
    def files(stamp: str) -> Any:
        return _CODE_FILES(cache_path=str(tmp_path), filename_base="f-1", source_stamp=stamp)

    files("before").save("numbers", "former code")
    assert files("now").load("numbers") is None
    files("now").save("numbers", "code")
    assert files("now").load("numbers") == "code"
    assert len(list(tmp_path.glob("*.nbc"))) == 1


@pytest.fixture
def _nothing_said() -> None:
    kernel_cache._warn_that_it_compiles.cache_clear()


@pytest.mark.parametrize("loop", ["march.independent", "march.lockstep"])
@pytest.mark.usefixtures("_nothing_said")
def test_compiled_code_counts_if_it_is_that_of_all_sources(
    loop: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    caplog: pytest.LogCaptureFixture,
) -> None:
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    left = tmp_path / "march_0a1b" / f"{loop[6:]}.{kernel_cache.LOOPS[loop]}-336.py311.nbi"
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
    indices = [index.read_bytes() for index in kernel_cache._indices("march.independent")]
    assert any(sources_digest() in index for index in indices)
