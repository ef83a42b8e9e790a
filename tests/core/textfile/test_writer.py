"""What is written reads back as the same description; a file is replaced wholly or not at all."""

from __future__ import annotations

import os
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given

import linkwork as lw
from linkwork.core.foundation.errors import InputError
from linkwork.core.mechanism.description import Description
from linkwork.core.mechanism.loops import PlainEquations
from linkwork.core.textfile import read_file, read_text, save, write_text
from tests.core.textfile.descriptions import descriptions
from tests.core.textfile.samples import SAMPLES


@pytest.mark.parametrize("name", SAMPLES)
def test_a_sample_reads_back_as_the_same_description(name: str) -> None:
    description = read_text(SAMPLES[name]).description
    assert read_text(write_text(description)).description == description


@given(descriptions)
def test_any_description_reads_back_as_the_same(description: Description) -> None:
    again = read_text(write_text(description)).description
    assert again == description
    assert orders(again) == orders(description)


def orders(description: Description) -> list[list[str]]:
    """The order of the keys of every table."""
    tables = (table for table in vars(description).values() if isinstance(table, dict))
    return [list(table) for table in tables]


def test_what_is_written_looks_as_a_person_would_write_it() -> None:
    for name in ("four_bar", "sketched", "listed"):
        assert write_text(read_text(SAMPLES[name]).description) == SAMPLES[name]


def test_writing_what_was_written_changes_nothing() -> None:
    for text in SAMPLES.values():
        once = write_text(read_text(text).description)
        assert write_text(read_text(once).description) == once


def test_numbers_keep_every_digit_and_their_kind() -> None:
    numbers = [0.1, 1e-320, -1e300, 1 / 3, 2**70, 0, -0.0, np.float64(0.3)]
    unknowns: dict[str, Any] = {f"x{k}": number for k, number in enumerate(numbers)}
    description = PlainEquations(equations={"f": "x0 = 0"}, guess=unknowns)
    again = read_text(write_text(description)).description
    assert isinstance(again, PlainEquations)
    assert [repr(n) for n in again.guess.values()] == [repr(n) for n in [*numbers[:-1], 0.3]]


def test_a_saved_file_reads_back(tmp_path: Path) -> None:
    description = read_text(SAMPLES["rapier"]).description
    path = tmp_path / "rapier.toml"
    save(description, path)
    assert read_file(path).description == description
    assert [each.name for each in tmp_path.iterdir()] == ["rapier.toml"]


@pytest.mark.skipif(sys.platform == "win32", reason="POSIX permissions")
def test_saving_keeps_the_permissions_of_the_file(tmp_path: Path) -> None:
    path = tmp_path / "cubic.toml"
    path.write_text("old")
    path.chmod(0o640)
    save(read_text(SAMPLES["cubic"]).description, path)
    assert path.stat().st_mode & 0o777 == 0o640


def test_a_failed_save_leaves_the_old_file_alone(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "cubic.toml"
    path.write_text("old")

    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "replace", full)
    with pytest.raises(InputError) as caught:
        save(read_text(SAMPLES["cubic"]).description, path)
    assert str(caught.value) == (
        f'cannot write "{path}": No space left on device: make room there, or write to '
        "another place"
    )
    assert path.read_text() == "old"
    assert [each.name for each in tmp_path.iterdir()] == ["cubic.toml"]


def test_saving_into_a_folder_that_is_not_there_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "none" / "cubic.toml"
    with pytest.raises(InputError) as caught:
        save(read_text(SAMPLES["cubic"]).description, path)
    assert str(caught.value) == f'cannot write "{path}": No such file or directory'


def test_a_symbolic_link_stays_one(tmp_path: Path) -> None:
    path, link = tmp_path / "cubic.toml", tmp_path / "link.toml"
    path.write_text("old")
    try:
        link.symlink_to(path)
    except OSError:
        pytest.skip("this system makes no symbolic links")
    save(read_text(SAMPLES["cubic"]).description, link)
    assert link.is_symlink()
    assert read_file(path).description.name == "A cubic that makes Newton cycle"


@pytest.mark.parametrize("suffix", ["xlsx", "py", "mjcf", "html"])
def test_files_of_other_programs_are_refused_by_our_error_too(tmp_path: Path, suffix: str) -> None:
    path = tmp_path / "nowhere" / f"bar.{suffix}"
    bar = lw.example("four-bar")
    write = bar.animate if suffix == "html" else bar.write
    with pytest.raises(InputError) as caught:
        write(path)
    assert str(caught.value) == f'cannot write "{path}": No such file or directory'
