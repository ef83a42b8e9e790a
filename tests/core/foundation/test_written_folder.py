"""Folders that are written as a whole: where they cannot be, and interruptions."""

from __future__ import annotations

import os
import signal
from collections.abc import Iterator
from pathlib import Path
from types import FrameType

import pytest

from linkwork.core.foundation.errors import InputError
from linkwork.core.foundation.files import check_place, written_folder


def test_a_place_where_no_folder_can_be_is_refused_and_nothing_is_left(tmp_path: Path) -> None:
    (tmp_path / "lost").symlink_to("nowhere")
    (tmp_path / "file").write_text("")
    before = sorted(tmp_path.rglob("*"))
    for name, why in (
        ("lost", 'lost" is a link that leads to no folder; name another folder'),
        ("lost/inner", 'lost" is a link that leads to no folder; name another folder'),
        ("file/inner", 'file" is not a folder; name another folder'),
        ("new/" + "x" * 256, "File name too long"),
        ("no\0", "embedded null byte"),
    ):
        with pytest.raises(InputError, match=f"{why}$"):
            check_place(tmp_path / name)
    check_place(tmp_path)
    check_place(tmp_path / "new" / "inner")
    assert sorted(tmp_path.rglob("*")) == before


@pytest.mark.parametrize("name", ["designs", "new/designs", "x" * 255])
def test_a_new_folder_appears_whole_and_an_old_one_holds_the_files_until_then(
    tmp_path: Path, name: str
) -> None:
    out = tmp_path / name
    with written_folder(out) as part:
        (part / "a.txt").write_text("new")
        assert not out.exists()
        assert part.parent == out.parent
    assert [path.name for path in out.iterdir()] == ["a.txt"]
    (out / "old").mkdir()
    (out / "old" / "b.txt").write_text("old")
    with written_folder(out, stale=("old/b.txt", "a.txt", "gone.txt")) as part:
        (part / "a.txt").write_text("newer")
        assert part.parent == out  # the same file system, whatever lies beside it
    assert [path.name for path in out.iterdir()] == ["a.txt"]
    assert (out / "a.txt").read_text() == "newer"
    assert len(list(out.parent.iterdir())) == 1


@pytest.fixture
def interruptible() -> Iterator[None]:
    """Python's own handler: shells start background jobs that ignore interruptions."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


@pytest.mark.usefixtures("interruptible")
def test_an_interruption_waits_until_all_files_are_replaced(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in "abc":
        (tmp_path / name).write_text("old")
    replace = os.replace

    def interrupted(source: Path, target: Path) -> None:
        if target.name == "a":
            signal.raise_signal(signal.SIGINT)
        replace(source, target)

    def write() -> None:
        with written_folder(tmp_path, stale={"c"}) as part:
            for name in "ab":
                (part / name).write_text("new")

    monkeypatch.setattr(os, "replace", interrupted)
    handler = signal.getsignal(signal.SIGINT)
    with pytest.raises(KeyboardInterrupt, match="after all files were written in"):
        write()
    assert signal.getsignal(signal.SIGINT) == handler
    assert {path.name: path.read_text() for path in tmp_path.iterdir()} == {"a": "new", "b": "new"}

    told: list[int] = []

    def heard(number: int, frame: FrameType | None) -> None:
        told.append(number)

    signal.signal(signal.SIGINT, heard)
    try:
        write()  # a program that takes interruptions itself hears of it
    finally:
        signal.signal(signal.SIGINT, handler)
    assert told == [signal.SIGINT]
