"""The runner reports every peer: what it did, or why there is nothing to report."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from benchmarks.machine import machine
from benchmarks.peers.comparison import Entry, compare
from benchmarks.peers.linkwork_sweep import LinkworkSweep
from benchmarks.peers.numpy_dyads import NumpyDyads
from benchmarks.peers.peer import DyadPeer, Peer
from benchmarks.peers.plot import draw
from benchmarks.peers.registry import PEERS, chosen
from benchmarks.peers.report import significant, table, write_figures
from benchmarks.peers.work import Work, four_bar, four_bar_family, jansen_leg, rapier_drive
from benchmarks.scaling.chains import coupled_loops, dyad_chain
from benchmarks.scaling.part import Growth, grown
from benchmarks.single_thread import LIMITS, environment
from benchmarks.timing import interleaved
from tests.benchmarks.solvers import Absent, Answering, Raising, crossed, right

REQUIREMENTS = Path(__file__).parents[2] / "benchmarks" / "peers" / "requirements.txt"


def entries_of(*peers: Peer, work: Work | None = None) -> list[Entry]:
    return compare(work or four_bar(37), peers, repeats=5)


def test_a_peer_on_the_wrong_branch_is_reported_as_such() -> None:
    wrong, good = entries_of(Answering("wrong", crossed), Answering("good", right))
    assert wrong.verdict
    assert good.verdict
    assert (wrong.verdict.found, wrong.verdict.other_branch) == (0, 37)
    assert (good.verdict.found, good.verdict.other_branch) == (37, 0)
    flips = [line.split()[-3] for line in table([wrong, good]).splitlines()[2:]]
    assert flips == ["37", "0"]


def test_a_missing_peer_is_listed_with_the_name_that_pip_installs() -> None:
    entry, good = entries_of(Absent(), Answering("good", right))
    assert entry.absent == "not installed (pip install no-such-solver)"
    assert entry.absent in table([entry, good])
    assert good.verdict
    assert good.verdict.found == 37


def test_a_peer_that_fails_does_not_stop_the_others() -> None:
    entry, good = entries_of(Raising(), Answering("good", right))
    assert entry.absent == "failed: ArithmeticError: no such linkage"
    assert len(good.nanoseconds) == 5


def test_a_peer_that_drops_rows_has_failed() -> None:
    (entry,) = entries_of(Answering("short", lambda work: right(work)[:, :-1]))
    assert entry.absent.startswith("failed: ValueError: positions have the shape (1, 36)")
    assert entry.nanoseconds == ()


def test_dyads_cannot_solve_coupled_loops() -> None:
    (entry,) = entries_of(NumpyDyads(), work=rapier_drive(5))
    assert entry.absent == "cannot: dyads only"


def test_a_slow_peer_is_given_a_part_of_a_family() -> None:
    slow = Answering("slow", right)
    slow.most_members = 2
    entry, all_of_it = entries_of(
        slow, Answering("fast", right), work=four_bar_family(members=6, rows=10)
    )
    assert entry.verdict
    assert (entry.members, entry.positions, entry.verdict.rows) == (2, 20, 20)
    assert (all_of_it.members, all_of_it.positions) == (6, 60)


@pytest.mark.parametrize(
    "peer",
    [LinkworkSweep(certify=True), LinkworkSweep(certify=False), NumpyDyads()],
    ids=lambda peer: peer.name,
)
@pytest.mark.parametrize("work", [four_bar(37), jansen_leg(37)], ids=lambda work: work.name)
def test_own_solvers_find_every_row(peer: Peer, work: Work) -> None:
    (entry,) = entries_of(peer, work=work)
    assert entry.verdict, entry.absent
    assert entry.verdict.found == 37, entry.absent
    assert entry.verdict.error <= 1e-11


def test_linkwork_finds_every_row_of_the_rapier_drive() -> None:
    (entry,) = entries_of(LinkworkSweep(certify=True), work=rapier_drive(37))
    assert entry.verdict, entry.absent
    assert entry.verdict.found == 37, entry.absent


def test_calls_are_timed_in_turn() -> None:
    order = []
    interleaved([lambda: order.append("A"), lambda: order.append("B")], 3)
    assert "".join(order) == "AB" + "ABABAB"


def test_steady_work_is_measured_behind_work_of_its_own_kind() -> None:
    order: list[str] = []
    times = interleaved([lambda: order.append("A"), lambda: order.append("B")], 2, steady=True)
    assert "".join(order) == "AB" + "AABB" * 2
    assert [len(found) for found in times] == [2, 2]


def test_tables_have_at_most_eighty_columns() -> None:
    wide = Answering("n" * 22, right)
    entries = entries_of(wide, Absent(), Raising(), work=four_bar_family(members=3, rows=5))
    lines = table(entries).splitlines()
    assert max(map(len, lines)) <= 80
    assert len(lines[2]) == 80


@pytest.mark.parametrize(
    ("value", "text"),
    [(9.3149, "9.31"), (63.84, "63.8"), (152.4, "152"), (24_512.0, "24,500"), (99.97, "100")],
)
def test_figures_have_three_digits(value: float, text: str) -> None:
    assert significant(value) == text


def test_figures_and_picture_are_written(tmp_path: Path) -> None:
    lost = Answering("lost", lambda work: np.full((1, 37), np.nan, complex))
    entries = entries_of(Answering("good", right), lost, Absent())
    write_figures(tmp_path / "peers.json", "one core", 5, entries)
    data = json.loads((tmp_path / "peers.json").read_text(encoding="utf-8"))
    good, lost_too, absent = data["entries"]
    assert good["verdict"]["found"] == 37
    assert len(good["nanoseconds"]) == 5
    assert (lost_too["verdict"]["missing"], lost_too["verdict"]["error"]) == (37, None)
    assert absent["verdict"] is None
    draw(tmp_path / "peers.png", "one core", entries)
    assert (tmp_path / "peers.png").read_bytes().startswith(b"\x89PNG")


def test_every_peer_has_a_name_of_its_own_that_fits_the_table() -> None:
    names = [peer.name for peer in PEERS]
    assert len(set(names)) == len(names)
    assert max(map(len, names)) <= 22


def test_every_peer_that_pip_installs_is_in_the_requirements() -> None:
    listed = set(re.findall(r"^([\w-]+)[>=]", REQUIREMENTS.read_text(encoding="utf-8"), re.M))
    assert listed == {peer.distribution for peer in PEERS} - {"linkwork", "numpy"}


def test_peers_are_chosen_by_part_of_their_name() -> None:
    assert [peer.name for peer in chosen(["NumPy", "kinepy"])] == ["NumPy dyads", "kinepy"]
    assert chosen([]) == list(PEERS)
    with pytest.raises(ValueError, match='no peer is called "nobody"'):
        chosen(["nobody"])


def test_the_measured_process_has_one_thread() -> None:
    assert {environment()[name] for name in LIMITS} == {"1"}
    assert "NUMBA_NUM_THREADS" in LIMITS


def test_the_machine_is_described_without_its_name() -> None:
    assert re.fullmatch(r"one core.*; Python 3\.\d+, NumPy \d+\.\d+", machine())


def test_growth_is_told_as_multiples_of_the_first() -> None:
    growth = Growth(title="t", unit="ns", size="rows", times={"a": {1: 10.0, 10: 25.0}})
    assert [line.split() for line in growth.table().splitlines()[1:]] == [
        ["rows", "1", "10"],
        ["a", "10", "25"],
        ["×", "1", "×", "2.5"],
    ]


def test_growth_notes_wrong_rows_and_leaves_out_what_is_too_large() -> None:
    growth = grown(
        title="t",
        unit="ns",
        size="rows",
        works=[(5, four_bar(5)), (9, four_bar(9))],
        peers=[Answering("wrong", crossed), Answering("small", right)],
        repeats=5,
        most={"small": 5},
    )
    assert set(growth.times["wrong"]) == {5, 9}
    assert set(growth.times["small"]) == {5}
    assert growth.notes == [
        "wrong: 5 rows not right of four-bar, 5 rows",
        "wrong: 9 rows not right of four-bar, 9 rows",
    ]


@pytest.mark.parametrize("count", range(1, 7))
def test_coupled_loops_close_at_the_start_and_are_no_dyads(count: int) -> None:
    loops = coupled_loops(count)
    assert loops.unknowns == 2 * count
    gap = loops.residual(loops.start, loops.driven(0.0))
    assert np.abs(gap).max() <= 1e-12 * loops.scale
    used = loops.turning != 0.0
    for some in range(1, 2**count - 1):  # fewer loops have more than two unknowns each
        chosen_loops = [k for k in range(count) if some >> k & 1]
        assert used[chosen_loops].any(axis=0).sum() > 2 * len(chosen_loops)


def test_every_dyad_of_a_chain_copies_the_crank() -> None:
    chain = dyad_chain(7)
    u = np.radians([60.0, 90.0, 120.0])
    np.testing.assert_allclose(chain.positions(u)["A7"], 700.0 + 40.0 * np.exp(1j * u), atol=1e-9)


def test_peers_that_place_dyads_say_so() -> None:
    placing = [peer.name for peer in PEERS if isinstance(peer, DyadPeer)]
    assert "NumPy dyads" in placing
    assert "scipy fsolve" not in placing


def test_solvers_are_listed_without_loading_compiled_code() -> None:
    # or every fresh process that is measured would pay for it
    code = "import sys, benchmarks.peers.registry; print('numba' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "False"
