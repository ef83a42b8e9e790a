"""Families on a graphics card, which numba's CUDA simulator stands for: as on the processor."""

from __future__ import annotations

import os
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

import linkwork as lw
from benchmarks import gpu
from linkwork.core.foundation.errors import InputError, MissingPackageError
from linkwork.core.foundation.statuses import Status
from linkwork.families import family as batch_family
from linkwork.families.gpu import kernel as device_compiling
from tests.families.in_simulator import ARRAYS, families, found

pytestmark = pytest.mark.extended

ROOT = Path(__file__).resolve().parents[2]
FAMILIES = families()


@pytest.fixture(scope="module")
def simulated(tmp_path_factory: pytest.TempPathFactory) -> dict[str, np.ndarray]:
    """What the simulated card finds, by family and array."""
    pytest.importorskip("numba_cuda")  # which there is none of for macOS
    folder = tmp_path_factory.mktemp("simulator")
    added = {"NUMBA_ENABLE_CUDASIM": "1", "LINKWORK_CACHE": str(folder / "kernels")}
    path = os.pathsep.join([str(ROOT / "src"), str(ROOT)])
    run = subprocess.run(
        [sys.executable, "-m", "tests.families.in_simulator", str(folder / "found.npz")],
        cwd=ROOT,
        env={**os.environ, **added, "PYTHONPATH": path},
        capture_output=True,
        text=True,
        check=False,
    )
    assert run.returncode == 0, run.stderr
    with np.load(folder / "found.npz") as arrays:
        return dict(arrays)


@pytest.mark.parametrize("name", FAMILIES)
def test_the_card_says_what_the_processor_says(simulated: dict[str, np.ndarray], name: str) -> None:
    family, certify = FAMILIES[name]
    reference = found(family.sweep(certify=certify))
    ours = {key: simulated[f"{name}/{key}"] for key in ARRAYS}
    for key in ("status", "certification", "turns", "limit_kinds", "alone"):
        np.testing.assert_array_equal(ours[key], reference[key], err_msg=key)
    # rounding of a few operations, with lengths of a hundred
    np.testing.assert_allclose(ours["v"], reference["v"], rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(ours["limits"], reference["limits"], rtol=1e-12, atol=1e-12)
    assert np.array_equal(np.isnan(ours["radius"]), np.isnan(reference["radius"]))
    if certify:  # bounds of rounding, some of which come from the steps that led there
        shares = ours["radius"] / reference["radius"]
        assert np.nanmin(shares) > 0.5
        assert np.nanmax(shares) < 2.0
    assert (ours["status"] == Status.CONVERGED.code).any()


@pytest.mark.parametrize("proved", ["", ", proved"])
def test_a_design_that_stops_leaves_its_last_nodes(
    simulated: dict[str, np.ndarray], proved: str
) -> None:
    stopped, last = (
        simulated[f"four-bar with dead points{proved}/{key}"] for key in ("end", "last")
    )
    size = last.shape[1] // 2
    where = np.isfinite(stopped)
    assert where.any()
    for way, behind in ((0, 1.0), (1, -1.0)):
        mine = where[way]
        np.testing.assert_array_equal(last[way, size - 1, mine], stopped[way, mine])
        assert (behind * (last[way, -1, mine] - stopped[way, mine]) > 0.0).all()


def test_designs_that_do_not_fit_at_once_go_in_equal_chunks(
    simulated: dict[str, np.ndarray],
) -> None:
    # five designs of 13 rows, two at a time: the last chunk has room left over
    assert simulated["chunks"][:2].tolist() == [2, 2]


def test_the_check_finds_another_status_and_positions_too_far_apart() -> None:
    family, certify = FAMILIES["four-bar, proved"]
    ours, reference = (family.sweep(certify=certify) for _ in range(2))
    assert gpu.compared(ours, reference).agrees
    assert gpu.compared(ours, reference).positions == 52
    moved = ours.rows.v.copy()
    moved[1, 3, 2] += 1e-12
    ours = replace(ours, rows=replace(ours.rows, v=moved))
    assert gpu.compared(ours, reference).excess > 1.0
    assert not gpu.compared(ours, reference).agrees
    ours = family.sweep(certify=certify)
    status = ours.rows.status.copy()
    status[3, 2] = Status.OUT_OF_REACH.code
    ours = replace(ours, rows=replace(ours.rows, status=status))
    assert gpu.compared(ours, reference).differing == 1


def test_speed_is_that_of_at_least_so_many_positions(simulated: dict[str, np.ndarray]) -> None:
    positions, seconds = simulated["speed"]
    assert positions == 20  # two designs of five rows until there are 15
    assert seconds > 0.0


def test_without_numba_cuda_the_message_says_what_to_install(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(device_compiling, "find_spec", lambda name: None)
    with pytest.raises(MissingPackageError) as caught:
        family().sweep(device="gpu")
    assert str(caught.value) == (
        'families on a graphics card need numba-cuda: pip install "linkwork[gpu]"'
    )


NO_CARD = (
    "no usable graphics card was found: an NVIDIA card needs its driver and CUDA's compiler "
    '(pip install "numba-cuda[cu12]" or "[cu13]"); leave out device="gpu" to use the processor'
)


def test_without_a_card_the_message_says_that_the_processor_serves(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(device_compiling, "find_spec", lambda name: object())
    monkeypatch.setattr(
        device_compiling, "numba_cuda", lambda: SimpleNamespace(is_available=lambda: False)
    )
    for ask in (
        lambda: family().sweep(device="gpu"),
        lambda: family().parts(device="gpu"),
        lambda: family().reduced(["min(B.x)"], device="gpu"),
    ):
        with pytest.raises(InputError) as caught:
            ask()
        assert str(caught.value) == NO_CARD
    assert gpu.main([]) == 2
    assert capsys.readouterr().out == f"{NO_CARD}\n"


def test_devices_that_do_not_exist_and_cards_that_should_not_compile_are_refused() -> None:
    with pytest.raises(InputError) as caught:
        family().sweep(device="tpu")
    assert str(caught.value) == 'there is no device "tpu" (there are: cpu, gpu)'
    with pytest.raises(InputError) as caught:
        family().parts(device="gpu", specialised=False)
    assert str(caught.value) == (
        'a graphics card runs compiled equations only: leave out specialised=False or device="gpu"'
    )


def family() -> batch_family.Family:
    return lw.example("four-bar").family({"A B": [118.0, 121.0]})
