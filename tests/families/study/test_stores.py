"""What is stored: the values of the family, whoever computed them, however often it was stopped."""

from __future__ import annotations

import errno
import json
import os
import shutil
import signal
import subprocess
import sys
import time
import warnings
from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray
from click.testing import CliRunner

import linkwork as lw
from linkwork.core.commands.main import linkwork
from linkwork.core.foundation.errors import InputError
from linkwork.core.foundation.statuses import Status
from linkwork.families import Family
from linkwork.families.family_motion import FamilyMotion
from linkwork.families.study import (
    Progress,
    Study,
    chunks_with_record,
    run_study,
    summary_of,
    verify_store,
)
from linkwork.families.study.study import Part, compute_part
from tests.families.study.plans import PLAN, contents, edited, study
from tests.interruptible import interruptible

FEW = (
    ("count = 300", "count = 100"),
    ("chunk = 64", "chunk = 50"),
    ('keep = ["B.x", "rocker"]', ""),
    ('swing = "stroke(rocker)"', ""),
    ('mu_mean = "mean(mu)"', ""),
    ('cycle = "whole cycle"', ""),
)


class Killed(BaseException):
    """In place of SIGKILL, at a place of our choice."""


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The store of the small study, computed without interruption by one process."""
    store = tmp_path_factory.mktemp("whole") / "out.zarr"
    run_study(study(), store, workers=1)
    return store


def test_a_store_holds_what_the_family_says(whole: Path) -> None:
    asked = study()
    bar = lw.example("four-bar").changed(inputs=lw.Input(link="crank", from_=0, to=330, step=30))
    motion = bar.family(asked.plan).sweep()
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        found = xarray.open_zarr(whole).load()
    for name in asked.plan:
        np.testing.assert_array_equal(found[name], asked.plan[name])
    with np.errstate(all="ignore"), warnings.catch_warnings():
        warnings.simplefilter("ignore")  # designs without any position
        rocker, mu = motion["rocker"], motion["mu"]
        cycle, fair = motion.found.all(axis=1), motion.value("min(mu)") >= 25
        swing = motion.value("stroke(rocker)")
        assert not (swing < np.nanmax(rocker, axis=1) - np.nanmin(rocker, axis=1)).any()
        np.testing.assert_allclose(found["mu_mean"], np.nanmean(mu, axis=1), rtol=1e-14)
    np.testing.assert_allclose(found["swing"], swing, rtol=1e-12)
    np.testing.assert_array_equal(found["passes.cycle"], cycle)
    np.testing.assert_array_equal(found["passes.transmission"], fair)
    np.testing.assert_array_equal(found["passed"], cycle & fair)
    assert 0 < int(found["passed"].sum()) < 300
    masked = np.where((cycle & fair)[:, None], motion["B.x"], np.nan)
    np.testing.assert_array_equal(found["B.x"], masked)
    np.testing.assert_array_equal(found["status"], motion.status)
    np.testing.assert_array_equal(found["found"], motion.found.sum(axis=1))
    np.testing.assert_array_equal(found["certified"], motion.certified.sum(axis=1))


def test_a_store_has_names_units_and_where_it_comes_from(whole: Path) -> None:
    found = xarray.open_zarr(whole)
    assert dict(found.sizes) == {"design": 300, "crank": 12}
    np.testing.assert_array_equal(found["crank"], np.arange(0, 331, 30))
    units = {name: array.attrs.get("units") for name, array in found.variables.items()}
    assert units["crank"] == units["rocker"] == units["swing"] == units["mu_mean"] == "deg"
    assert units["O2 A"] == units["B.x"] == "mm"
    assert found["swing"].attrs["description"] == "stroke(rocker)"
    assert found["passes.transmission"].attrs["description"] == "min(mu) >= 25"
    meanings = found["status"].attrs["flag_meanings"].split()
    assert meanings == [status.name for status in Status]
    assert found["status"].attrs["flag_values"] == [status.code for status in Status]
    assert found.attrs["plan"] == PLAN
    assert found.attrs["mechanism"] == lw.example_text("four-bar")
    assert found.attrs["seed"] == 1
    assert found.attrs["linkwork_version"]


def test_two_workers_store_the_same_as_one(whole: Path, tmp_path: Path) -> None:
    run_study(study(), tmp_path / "out.zarr", workers=2)
    assert contents(tmp_path / "out.zarr") == contents(whole)


@pytest.mark.parametrize("chunk", [7, 300])
def test_values_do_not_depend_on_the_size_of_chunks(
    chunk: int, whole: Path, tmp_path: Path
) -> None:
    run_study(study(("chunk = 64", f"chunk = {chunk}")), tmp_path / "out.zarr", workers=1)
    other = xarray.open_zarr(tmp_path / "out.zarr")
    for name, array in xarray.open_zarr(whole).variables.items():
        # designs go in step with others, so rounding depends on who the others are
        np.testing.assert_allclose(other[name], array, rtol=1e-13, atol=1e-11, err_msg=str(name))


def test_chunks_may_come_in_any_order(
    whole: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def backwards(asked: Study, chunks: list[int], *_: object) -> Iterator[tuple[int, Part]]:
        for k in reversed(chunks):
            yield k, compute_part(asked.job, asked.values(k))

    monkeypatch.setattr("linkwork.families.study.running.compute_parts", backwards)
    run_study(study(), tmp_path / "out.zarr", workers=1)
    assert contents(tmp_path / "out.zarr") == contents(whole)


def test_a_run_killed_at_any_write_goes_on_to_the_same_store(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Every file is torn once while it is written, and once not renamed when it is whole."""
    run_study(study(*FEW), tmp_path / "whole.zarr", workers=1)
    wanted = contents(tmp_path / "whole.zarr")
    store, replace, left = tmp_path / "out.zarr", os.replace, 0

    def step() -> bool:
        nonlocal left
        left -= 1
        return left == 0

    def killed(old: Path, new: Path) -> None:
        if Path(new).is_relative_to(store):
            if step():
                os.truncate(old, Path(old).stat().st_size // 2)
                raise Killed
            if step():
                raise Killed
        replace(old, new)

    monkeypatch.setattr(os, "replace", killed)
    deaths = 0
    for at in range(1, 10_000):
        left = at
        try:
            run_study(study(*FEW), store, workers=1)
            break
        except Killed:
            deaths += 1
            found = summary_of(store)  # can be read at any moment
            assert found.computed in (0, 50)
            assert found.damaged == ()
    files = [path for path in wanted if path.endswith("/c/0")]
    files.remove("crank/c/0")
    assert deaths == 2 * len(files) + 1  # both ways in the first chunk, once in the second one
    assert contents(store) == wanted


def test_a_damaged_chunk_is_computed_again(whole: Path, tmp_path: Path) -> None:
    store = tmp_path / "out.zarr"
    run_study(study(), store, workers=1)
    for path, damage in (
        ("rocker/c/2/0", b"torn"),
        ("swing/c/1", None),
        ("ledger/chunks/c/3", b'{"rows": '),
    ):
        (store / path).unlink() if damage is None else (store / path).write_bytes(damage)
    told: list[int] = []
    run_study(study(), store, workers=1, progress=lambda progress: told.append(progress.done))
    assert told == [300 - 3 * 64, 300 - 2 * 64, 300 - 64, 300]
    assert contents(store) == contents(whole)


def _started(folder: Path, *more: str) -> subprocess.Popen[bytes]:
    source = Path(__file__).parents[3] / "src"
    words = [sys.executable, "-m", "linkwork", "study", "plan.toml", "-o", "out.zarr", *more]
    return subprocess.Popen(
        words,
        cwd=folder,
        env={**os.environ, "PYTHONPATH": str(source)},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        preexec_fn=interruptible,
    )


def _until(store: Path, chunks: int, process: subprocess.Popen[bytes]) -> None:
    """Until so many chunks are stored."""
    for _ in range(6000):
        if len(chunks_with_record(store)) >= chunks or process.poll() is not None:
            return
        time.sleep(0.01)


#: Some seconds of work, so that signals arrive in the middle of it.
LONG = (("count = 300", "count = 800"), ("chunk = 64", "chunk = 40"))


@pytest.mark.extended
def test_killed_processes_lose_nothing_and_leave_no_workers(tmp_path: Path) -> None:
    run_study(study(*LONG), tmp_path / "whole.zarr", workers=1)
    store = tmp_path / "out.zarr"
    (tmp_path / "plan.toml").write_text(edited(*LONG), encoding="utf-8")
    generator = np.random.default_rng(7)
    before = 0
    for count in ("1", "2"):
        process = _started(tmp_path, "--workers", count)
        _until(store, before + int(generator.integers(1, 8)), process)
        children = _children(process.pid)
        assert len(children) == (0 if count == "1" else 2)
        process.kill()
        assert process.communicate() == (b"", b"")  # workers say nothing when they are left alone
        stored = summary_of(store).computed
        assert before * 40 < stored < 800
        before = stored // 40
        for _ in range(500):
            if not any(_alive(child) for child in children):
                break
            time.sleep(0.01)
        assert not any(_alive(child) for child in children)
    run_study(study(*LONG), store, workers=1)
    assert contents(store) == contents(tmp_path / "whole.zarr")


def _children(pid: int) -> list[int]:
    tasks = Path(f"/proc/{pid}/task")
    if not tasks.exists():
        pytest.skip("needs /proc")
    return [
        int(child)
        for task in tasks.iterdir()
        for child in (task / "children").read_text(encoding="ascii").split()
    ]


def _alive(pid: int) -> bool:
    try:
        return "Z" not in Path(f"/proc/{pid}/stat").read_text(encoding="ascii").split()[2]
    except OSError:
        return False


@pytest.mark.extended
def test_an_interrupt_leaves_a_store_to_go_on_with_and_says_so(tmp_path: Path) -> None:
    store = tmp_path / "out.zarr"
    (tmp_path / "plan.toml").write_text(edited(*LONG), encoding="utf-8")
    process = _started(tmp_path, "--workers", "2")
    _until(store, 5, process)
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=30)
    found = summary_of(store)
    assert (out, process.returncode) == (b"", 130)
    assert 200 <= found.computed < 800
    assert " ".join(err.decode().split()) == (
        f"{found.computed} of 800 designs are stored in out.zarr. To resume, repeat the same "
        "command. Interrupted."
    )
    assert len(chunks_with_record(store)) * 40 == found.computed
    told: list[int] = []
    run_study(study(*LONG), store, workers=1, progress=lambda p: told.append(p.done))
    assert told[0] == found.computed
    assert told[-1] == 800


@pytest.mark.extended
def test_a_worker_that_dies_ends_the_run_and_the_next_one_goes_on(tmp_path: Path) -> None:
    run_study(study(*LONG), tmp_path / "whole.zarr", workers=1)
    before = set(_children(os.getpid()))

    def kill(progress: Progress) -> None:
        if progress.done == 80:
            os.kill(min(set(_children(os.getpid())) - before), signal.SIGKILL)

    store = tmp_path / "out.zarr"
    with pytest.raises(InputError, match=r"^a worker process has ended, perhaps"):
        run_study(study(*LONG), store, workers=2, progress=kill)
    assert set(_children(os.getpid())) <= before
    assert 80 <= summary_of(store).computed < 800
    run_study(study(*LONG), store, workers=2)
    assert contents(store) == contents(tmp_path / "whole.zarr")


def test_workers_that_cannot_start_end_the_run(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sys, "executable", "/bin/false")
    with pytest.raises(InputError) as caught:
        run_study(study(*FEW), tmp_path / "out.zarr", workers=2)
    assert str(caught.value) == (
        "a worker process has ended, perhaps for lack of memory: reduce chunk or --workers; the "
        "same command goes on from the chunks that are stored"
    )


@pytest.mark.extended
def test_a_worker_of_another_version_refuses(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("linkwork.families.study.plan.linkwork_version", lambda: "7.8.9")
    with pytest.raises(InputError, match=r"^the study was started with Linkwork 7\.8\.9, a worker"):
        run_study(study(*FEW), tmp_path / "out.zarr", workers=2)


def test_the_device_of_a_plan_computes_its_designs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    plan = study(("seed = 1", 'seed = 1\ndevice = "gpu"'))
    with pytest.raises(InputError):  # numba-cuda or a card is missing
        run_study(plan, tmp_path / "none.zarr")
    assert not (tmp_path / "none.zarr").exists()
    asked: list[str] = []
    sweep = Family.sweep

    def noted(self: Family, *, device: str = "cpu", **options: Any) -> FamilyMotion:
        asked.append(device)
        return sweep(self, **options)

    monkeypatch.setattr(Family, "sweep", noted)
    monkeypatch.setattr("linkwork.families.gpu.kernel.graphics_card", lambda: None)
    run_study(plan, tmp_path / "out.zarr")  # in this process: a card serves one
    assert asked == ["gpu"] * plan.chunks
    with pytest.raises(InputError, match="device"):
        run_study(study(), tmp_path / "out.zarr")


def test_another_study_is_refused_with_what_differs(whole: Path, tmp_path: Path) -> None:
    mine = lw.example_text("four-bar").replace('"O2 A"  = 40', '"O2 A"  = 41')
    (tmp_path / "mine.toml").write_text(mine, encoding="utf-8")
    other = study(
        ('"four-bar"', '"mine.toml"'),
        ("seed = 1", "seed = 2"),
        ("from = 36", "from = 37"),
        ("step = 30", "step = 15"),
        ('swing = "stroke(rocker)"', ""),
        ("mu >= 25", "mu >= 26"),
        folder=tmp_path,
    )
    before = contents(whole)
    with pytest.raises(InputError) as caught:
        run_study(other, whole)
    assert str(caught.value) == (
        f'"{whole}" holds another study:\n'
        '  mechanism: "O2 A"  = 40 there, "O2 A"  = 41 here\n'
        "  seed: 1 there, 2 here\n"
        '  dimensions."O2 A": {"from": 36, "to": 44} there, {"from": 37, "to": 44} here\n'
        "  input.rows: 12 there, 23 here\n"
        "  reductions.swing: stroke(rocker) there, nothing here\n"
        "  filters.transmission: min(mu) >= 25 there, min(mu) >= 26 here\n"
        "Choose another store, or start over with --force, which deletes the old "
        "study."
    )
    assert contents(whole) == before


def test_comments_and_names_of_a_plan_may_change(whole: Path) -> None:
    before = contents(whole)
    run_study(study(("seed = 1", "seed = 1  # of the first day"), ("A small", "The small")), whole)
    assert contents(whole) == before


def test_blank_lines_at_the_end_of_a_mechanism_may_change(tmp_path: Path) -> None:
    text = lw.example_text("four-bar")
    edits = (*FEW, ('"four-bar"', '"mine.toml"'))
    for end in ("", "\n\n"):
        (tmp_path / "mine.toml").write_text(text + end, encoding="utf-8")
        run_study(study(*edits, folder=tmp_path), tmp_path / "out.zarr", workers=1)


def test_every_reader_refuses_damaged_numbers(whole: Path, tmp_path: Path) -> None:
    shutil.copytree(whole, tmp_path / "out.zarr")
    for name in ("rocker/c/2/0", "swing/c/1", "O2 A/c/4"):
        _flipped(tmp_path / "out.zarr" / name, -1)  # in the checksum, or what it covers
        with pytest.raises(ValueError, match="checksum"):
            xarray.open_zarr(tmp_path / "out.zarr")[name.split("/")[0]].load()


def test_fresh_begins_again_and_takes_nothing_else_away(whole: Path, tmp_path: Path) -> None:
    store = tmp_path / "out.zarr"
    run_study(study(("seed = 1", "seed = 2")), store, workers=1)
    run_study(study(), store, workers=1, force=True)
    assert contents(store) == contents(whole)
    (tmp_path / "notes").mkdir()
    (tmp_path / "notes" / "zarr.json").write_text("{}", encoding="utf-8")
    for force in (False, True):
        with pytest.raises(InputError) as caught:
            run_study(study(), tmp_path / "notes", force=force)
        assert str(caught.value) == (
            f'"{tmp_path / "notes"}" exists and is not the store of a study: choose another name'
        )
    assert (tmp_path / "notes" / "zarr.json").exists()


def test_a_store_that_is_killed_while_it_is_taken_away_is_there_or_not(
    whole: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def killed(path: Path) -> None:
        (path / "crank" / "c" / "0").unlink()
        raise Killed

    store = tmp_path / "out.zarr"
    run_study(study(*FEW), store, workers=1)
    with monkeypatch.context() as patch:
        patch.setattr("linkwork.families.study.store.shutil.rmtree", killed)
        with pytest.raises(Killed):
            run_study(study(*FEW), store, workers=1, force=True)
    run_study(study(), store, workers=1)
    assert contents(store) == contents(whole)


def test_two_runs_do_not_write_to_one_store(whole: Path, tmp_path: Path) -> None:
    def second(_: object) -> None:
        run_study(study(), tmp_path / "out.zarr", workers=1)

    with pytest.raises(InputError) as caught:
        run_study(study(), tmp_path / "out.zarr", workers=1, progress=second)
    assert str(caught.value) == (
        f'another run is writing to "{tmp_path / "out.zarr"}": wait for it or stop it'
    )


def test_designs_that_cannot_be_built_are_counted_with_their_reason(tmp_path: Path) -> None:
    asked = study(
        ("latin-hypercube", "random"), ('"O4 B" = { from = 66, to = 90 }', '"O4 B" = [80, -10]')
    )
    found = run_study(asked, tmp_path / "out.zarr", workers=1)
    bad = int((asked.plan["O4 B"] <= 0).sum())
    assert found.computed - found.built == bad == sum(found.problems.values())
    assert bad > 0
    (message,) = found.problems
    assert 'lengths."O4 B"' in message
    store = xarray.open_zarr(tmp_path / "out.zarr")
    np.testing.assert_array_equal(store["built"], asked.plan["O4 B"] > 0)


def test_a_summary_counts_and_measures_what_passed(whole: Path) -> None:
    found, store = summary_of(whole), xarray.open_zarr(whole).load()
    assert (found.designs, found.computed, found.inputs, found.built) == (300, 300, 12, 300)
    assert found.filters["cycle"] == ("whole cycle", int(store["passes.cycle"].sum()))
    assert found.passed == int(store["passed"].sum())
    assert sum(found.rows.values()) == 3600
    assert found.rows["CONVERGED"] == int(store["found"].sum())
    for output in found.outputs:
        values = store[output.name].values[store["passed"].values]
        assert (output.count, output.least, output.most) == (
            values.size, values.min(), values.max(),
        )  # fmt: skip
        assert output.mean == pytest.approx(values.mean(), rel=1e-14)
        assert sum(output.histogram) == output.count
        np.testing.assert_array_equal(output.histogram, np.histogram(values, 12)[0])


def test_values_that_differ_by_rounding_have_one_part(tmp_path: Path) -> None:
    asked = study(
        ('mu_mean = "mean(mu)"', 'same = "max(A.x)"'),
        ('"O2 A" = { from = 36, to = 44 }', '"O2 A" = { from = 40, to = 40.00000000000002 }'),
    )
    swing, same, *_ = run_study(asked, tmp_path / "out.zarr", workers=1).outputs
    assert same.least < same.most
    assert same.histogram == (same.count,)
    assert len(swing.histogram) == 12


def test_a_store_that_is_not_there_has_no_summary(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r'^there is no ".*none"$'):
        summary_of(tmp_path / "none")


def _flipped(path: Path, place: int) -> None:
    data = bytearray(path.read_bytes())
    data[place // 8 % len(data)] ^= 1 << place % 8
    path.write_bytes(data)


def test_any_flipped_bit_of_a_chunk_is_found_and_repaired(whole: Path, tmp_path: Path) -> None:
    store = tmp_path / "out.zarr"
    shutil.copytree(whole, store)
    files = [path for path in sorted(contents(whole)) if "/c/" in path and path != "crank/c/0"]
    assert any(path.startswith("ledger/chunks/c/") for path in files)
    random = np.random.default_rng(5)
    for path in files[::5]:
        _flipped(store / path, int(random.integers(1 << 20)))
        found = verify_store(store)
        assert not found.intact
        ((number, names),) = found.chunks.items()
        assert names == (path,)
        assert summary_of(store).damaged == (number,)
        assert run_study(study(), store, workers=1).repaired == (number,)
        assert contents(store) == contents(whole)
    assert verify_store(store).intact
    assert run_study(study(), store, workers=1).repaired == ()


def test_a_store_whose_description_is_damaged_is_refused(whole: Path, tmp_path: Path) -> None:
    store = tmp_path / "out.zarr"
    shutil.copytree(whole, store)
    (store / "zarr.json").write_bytes(b"{}")
    for call in (summary_of, verify_store, partial(run_study, study())):
        with pytest.raises(InputError, match="exists and is not the store of a study"):
            call(store)


def test_a_full_disk_names_the_file_and_leaves_a_store_to_go_on_with(
    whole: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    store = tmp_path / "out.zarr"
    replace, left = os.replace, [60]

    def full(old: Path, new: Path) -> None:
        left[0] -= 1
        if left[0] < 0:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        replace(old, new)

    with monkeypatch.context() as patch:
        patch.setattr(os, "replace", full)
        with pytest.raises(InputError) as caught:
            run_study(study(), store, workers=1)
    assert str(caught.value).startswith(f'cannot write "{store}{os.sep}')
    assert str(caught.value).endswith(
        ": No space left on device. The chunks that are stored are complete: make room and repeat "
        "the command"
    )
    assert not list(store.rglob("*.partial"))
    assert 0 < summary_of(store).computed < 300
    run_study(study(), store, workers=1)
    assert contents(store) == contents(whole)


def test_the_command_verifies_a_store(whole: Path, tmp_path: Path) -> None:
    store = tmp_path / "out.zarr"
    shutil.copytree(whole, store)
    asked = ["study", str(store), "--verify"]
    sound = CliRunner().invoke(linkwork, asked)
    assert (sound.exit_code, sound.stdout) == (
        0,
        f"All 5 chunks of {store} are as they were written.\n",
    )
    _flipped(store / "rocker/c/2/0", 77)
    damaged = CliRunner().invoke(linkwork, asked)
    assert damaged.exit_code == 1
    assert "chunk 2" in damaged.stdout
    assert "rocker/c/2/0" in damaged.stdout
    told = json.loads(CliRunner().invoke(linkwork, [*asked, "--json"]).stdout)
    assert told == {
        "schema": 1,
        "intact": False,
        "sound": 4,
        "chunks": {"2": ["rocker/c/2/0"]},
    }
