"""Folders that are filled again: files of an earlier run are replaced, all others stay."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from linkwork.core.foundation.errors import InputError
from linkwork.core.foundation.files import OwnFiles

_OWN = OwnFiles(
    run="search",
    files=re.compile(r"(refused/)?near-\d+\.toml|table\.csv"),
    folders=(".", "refused"),
)
_FIRST = {"near-1.toml": "one", "near-2.toml": "two", "refused/near-3.toml": "three"}


def _write(root: Path, files: dict[str, str], force: bool = True) -> None:
    with _OWN.written(root, _OWN.check(root, force)) as part:
        for name, text in files.items():
            (part / name).parent.mkdir(exist_ok=True)
            (part / name).write_text(text)


def _files(root: Path) -> dict[str, str]:
    shown = {path: path.relative_to(root).as_posix() for path in root.rglob("*") if path.is_file()}
    return {name: path.read_text() for path, name in shown.items()}


def test_files_of_an_earlier_run_are_replaced_and_all_others_stay(tmp_path: Path) -> None:
    root = tmp_path / "near"
    _write(root, _FIRST)
    mine = {"far-1.toml": "mine", "data/near-4.toml": "mine", "near-1.svg": "mine"}
    (root / "data").mkdir()
    for name, text in mine.items():
        (root / name).write_text(text)
    _write(root, {"near-1.toml": "new"})
    assert _files(root) == {"near-1.toml": "new", **mine}
    assert not (root / "refused").exists()


def test_without_force_a_folder_with_files_is_refused(tmp_path: Path) -> None:
    (tmp_path / "notes.txt").write_text("mine")
    told = (
        f'the folder "{tmp_path}" is not empty: it holds "notes.txt"; name a new folder, or add '
        "--force, which replaces the files of an earlier search and keeps all others"
    )
    with pytest.raises(InputError, match=f"^{re.escape(told)}$"):
        _OWN.check(tmp_path, force=False)
    (tmp_path / "notes.txt").unlink()
    _write(tmp_path, _FIRST, force=False)
    assert _files(tmp_path) == _FIRST


def test_a_file_that_the_run_reads_is_not_replaced(tmp_path: Path) -> None:
    _write(tmp_path, _FIRST)
    own = OwnFiles(run="search", files=_OWN.files, read=[(tmp_path / "near-2.toml").resolve()])
    with pytest.raises(InputError, match=r'holds "near-2.toml", which this search reads'):
        own.check(tmp_path, force=True)


def test_an_interruption_keeps_the_earlier_files(tmp_path: Path) -> None:
    _write(tmp_path, _FIRST)
    with pytest.raises(KeyboardInterrupt), _OWN.written(tmp_path, _OWN.check(tmp_path, True)):
        raise KeyboardInterrupt
    assert _files(tmp_path) == _FIRST
