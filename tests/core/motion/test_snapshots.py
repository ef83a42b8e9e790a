"""Snapshots of behaviour: whatever changes in a record is a difference, rounding is none."""

from __future__ import annotations

from copy import deepcopy
from pathlib import Path

import numpy as np
import pytest

from tests.campaigns.snapshot import Record, Snapshot, load, record_of, save
from tests.campaigns.snapshot_comparison import Comparison, compare
from tests.campaigns.snapshot_mechanisms import mechanism_of, names_of

#: A crank and a slotted lever, which rock between two dead points.
NAME = "loop inverted 0"


@pytest.fixture(scope="module")
def record() -> Record:
    return record_of(NAME)


def compared(before: Record, after: Record, *, messages: bool = False) -> Comparison:
    one, other = (Snapshot({record.name: record}, 0.0) for record in (before, after))
    return compare(one, other, messages=messages)


def test_the_record_has_rows_limits_configurations_circuits_and_designs(record: Record) -> None:
    assert set(record.words["sweep.status.name"]) == {"CONVERGED", "OUT_OF_REACH"}
    assert record.words["sweep.limits.kind"] == ["DEAD_POINT", "DEAD_POINT"]
    assert record.words["configurations.names.all"] == ["open", "crossed"]
    assert sorted(record.words["circuits.branches.configuration"]) == ["crossed", "open"]
    assert record.words["circuits.limits.kind"] == ["DEAD_POINT", "DEAD_POINT"]
    assert np.isfinite(record.numbers["family.limits.lower"]).tolist() == 5 * [True]


def test_a_second_record_is_equal(record: Record) -> None:
    found = compared(record, record_of(NAME))
    assert found.equal, found.told()
    assert found.tallies["sweep coordinates"].compared > 200


@pytest.mark.parametrize(
    "path",
    [
        "sweep.status.name",
        "sweep.certified.flag",
        "sweep.certified.reason",
        "sweep.names.column",
        "sweep.rows.branch",
        "sweep.limits.located",
        "configurations.names.all",
        "configurations.complete.grade",
        "configurations.certified.flag",
        "circuits.circuits.end",
        "circuits.branches.configuration",
        "circuits.certified.branch",
        "family.status.name",
        "family.certified.flag",
    ],
)
def test_one_other_word_is_a_difference(record: Record, path: str) -> None:
    other = deepcopy(record)
    other.words[path][1 if len(other.words[path]) > 1 else 0] = "otherwise"
    found = compared(record, other)
    assert not found.equal
    assert [difference.path for difference in found.first] == [path]
    assert NAME in found.told()
    assert "otherwise" in found.told()


@pytest.mark.parametrize(
    "path",
    [
        "sweep.coordinates.value",
        "sweep.limits.input",
        "configurations.coordinates.value",
        "circuits.circuits.range",
        "circuits.branches.range",
        "circuits.limits.input",
        "family.coordinates.value",
        "family.rows.input",
        "family.limits.lower",
    ],
)
def test_a_millionth_is_a_difference_and_rounding_is_none(record: Record, path: str) -> None:
    values = record.numbers[path]
    at = tuple(np.argwhere(np.isfinite(values))[-1])
    for relative, equal in ((1e-6, False), (1e-15, True)):
        other = deepcopy(record)
        other.numbers[path][at] += relative * max(1.0, abs(values[at]))
        assert compared(record, other).equal is equal


def test_a_position_that_is_lost_or_a_row_less_is_a_difference(record: Record) -> None:
    lost, shorter = deepcopy(record), deepcopy(record)
    path = "sweep.coordinates.value"
    lost.numbers[path][np.argwhere(np.isfinite(lost.numbers[path]))[0][0]] = np.nan
    shorter.numbers[path] = shorter.numbers[path][:-1]
    assert not compared(record, lost).equal
    assert not compared(record, shorter).equal


def test_errors_are_compared_by_type_and_by_wording_on_request() -> None:
    record = record_of("library newton-extremum")
    assert record.words["sweep.error.type"] == ["InputError"]
    reworded, otherwise = deepcopy(record), deepcopy(record)
    reworded.words["sweep.message.text"] = ["there is nothing to sweep"]
    otherwise.words["sweep.error.type"] = ["crash: KeyError"]
    assert compared(record, reworded).equal
    assert not compared(record, reworded, messages=True).equal
    assert not compared(record, otherwise).equal


def test_a_missing_library_mechanism_is_a_difference_and_a_smaller_number_of_others_is_none(
    record: Record,
) -> None:
    library, further = Record("library four-bar"), Record("loop triad 9")
    whole = Snapshot({r.name: r for r in (record, library, further)}, 0.0)
    fewer = Snapshot({r.name: r for r in (record, library)}, 0.0)
    without = Snapshot({r.name: r for r in (record, further)}, 0.0)
    assert compare(whole, fewer).equal
    assert not compare(whole, without).equal


def test_a_saved_snapshot_comes_back_bit_by_bit(record: Record, tmp_path: Path) -> None:
    save(Snapshot({NAME: record}, 1.5), tmp_path / "there")
    back = load(tmp_path / "there").records[NAME]
    assert back.words == record.words
    assert back.seconds == record.seconds
    assert back.numbers.keys() == record.numbers.keys()
    for path, values in record.numbers.items():
        assert back.numbers[path].tobytes() == values.tobytes()
        assert back.numbers[path].shape == values.shape


def test_a_smaller_number_has_the_first_of_each_kind_and_a_name_is_always_the_same_mechanism() -> (
    None
):
    some, many = names_of(300), names_of(3000)
    assert len(set(many)) == len(many) == 3000 + len(names_of(0))
    assert set(some) < set(many)
    for name in ("variant of four-bar 1", "contact rack 5", "linkage slot on ground 2"):
        assert mechanism_of(name) == mechanism_of(name)
