"""Folders that are filled again: own files are replaced, the user's are never touched."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

from linkwork.foundation.errors import InputError
from linkwork.foundation.own_files import OwnFiles

_OWN = OwnFiles(
    run="search",
    option="--fresh",
    numbered=re.compile(r"near-\d+\.toml"),
    named={"curve/foot.csv": b"foot", "table.csv": None},
    folders=("refused",),
)
_FIRST = {"near-1.toml": "one", "near-2.toml": "two", "refused/near-3.toml": "three"}
_NO_RUN = "which no earlier search wrote; this one could write over it"
_REMEDY = "rename or move it, or name a new folder"


def _write(root: Path, files: dict[str, str], fresh: bool = True) -> None:
    with _OWN.written(root, _OWN.check(root, fresh)) as part:
        for name, text in files.items():
            (part / name).parent.mkdir(exist_ok=True)
            (part / name).write_text(text)


def _files(root: Path) -> dict[str, str]:
    shown = {path: path.relative_to(root).as_posix() for path in root.rglob("*") if path.is_file()}
    return {name: path.read_text() for path, name in shown.items() if name[0] != "."}


def test_own_unchanged_files_are_replaced_and_all_others_stay(tmp_path: Path) -> None:
    root = tmp_path / "near"
    _write(root, _FIRST)
    assert set(json.loads((root / ".linkwork-search.json").read_text())) == set(_FIRST)
    mine = {"far-1.toml": "mine", "data/near-4.toml": "mine", "near-1.svg": "mine"}
    (root / "data").mkdir()
    for name, text in mine.items():
        (root / name).write_text(text)
    _write(root, {"near-1.toml": "new"})
    assert _files(root) == {"near-1.toml": "new", **mine}
    assert not (root / "refused").exists()


@pytest.mark.parametrize(
    ("name", "text", "told"),
    [
        ("near-7.toml", "mine", f'"near-7.toml", {_NO_RUN}: {_REMEDY}'),
        ("refused/near-7.toml", "mine", f'"refused/near-7.toml", {_NO_RUN}: {_REMEDY}'),
        ("table.csv", "mine", f'"table.csv", {_NO_RUN}: {_REMEDY}'),
        ("curve/foot.csv", "mine", f'"curve/foot.csv", {_NO_RUN}: {_REMEDY}'),
        ("curve", "mine", f'"curve", which is a link or a file: {_REMEDY}'),
        (
            "near-2.toml",
            "mine",
            '"near-2.toml", which was changed since an earlier search wrote it; this one could '
            f"write over it: {_REMEDY}",
        ),
        ("curve/foot.csv", "foot", ""),
        ("curve/other.csv", "mine", ""),
    ],
)
def test_a_file_that_could_be_written_over_is_named_before_the_work(
    tmp_path: Path, name: str, text: str, told: str
) -> None:
    _write(tmp_path, _FIRST)
    (tmp_path / name).parent.mkdir(exist_ok=True)
    (tmp_path / name).write_text(text)
    if told:
        with pytest.raises(InputError, match=f'^the folder "{tmp_path}" holds {re.escape(told)}$'):
            _OWN.check(tmp_path, fresh=True)
    else:
        _write(tmp_path, {"near-1.toml": "new", "curve/foot.csv": "foot"})
        assert _files(tmp_path)[name] == text
        # the user's file is not in the list: a later run does not remove it
        _write(tmp_path, {})
        assert _files(tmp_path) == {name: text}


def test_without_fresh_a_folder_with_files_is_refused_and_fresh_is_advised_where_it_helps(
    tmp_path: Path,
) -> None:
    (tmp_path / "notes.txt").write_text("mine")
    empty = f'the folder "{tmp_path}" is not empty: it holds "notes.txt"; name a new folder'
    advice = ", or add --fresh, which replaces the files of an earlier search and keeps all others"
    with pytest.raises(InputError, match=f"^{re.escape(empty + advice)}$"):
        _OWN.check(tmp_path, fresh=False)
    (tmp_path / "table.csv").write_text("mine")
    with pytest.raises(InputError, match=f"^{re.escape(empty)}$"):
        _OWN.check(tmp_path, fresh=False)
    # a list whose files are gone is no file
    root = tmp_path / "near"
    _write(root, {"near-1.toml": "one"})
    (root / "near-1.toml").unlink()
    _write(root, {"near-1.toml": "two"}, fresh=False)
    assert _files(root) == {"near-1.toml": "two"}


def test_links_in_the_folder_are_neither_followed_nor_replaced(tmp_path: Path) -> None:
    root, mine = tmp_path / "near", tmp_path / "mine"
    _write(root, _FIRST)
    (root / "refused").rename(mine)
    (root / "refused").symlink_to(mine)
    with pytest.raises(InputError, match=r'holds "refused", which is a link or a file: rename'):
        _OWN.check(root, fresh=True)
    other = OwnFiles(run="search", option="--fresh", numbered=_OWN.numbered)
    assert other.check(root, fresh=True) == ["near-1.toml", "near-2.toml"]
    (root / "near-1.toml").rename(mine / "near-1.toml")
    (root / "near-1.toml").symlink_to(mine / "near-1.toml")
    with pytest.raises(InputError, match=r'holds "near-1.toml", which was changed since an earl'):
        other.check(root, fresh=True)
    assert _files(mine) == {"near-3.toml": "three", "near-1.toml": "one"}


def test_a_list_names_no_file_outside_its_folder(tmp_path: Path) -> None:
    root = tmp_path / "near"
    _write(root, {"near-1.toml": "one"})
    outside = tmp_path / "outside.toml"
    outside.write_text("one")
    file = root / ".linkwork-search.json"
    (digest,) = json.loads(file.read_text()).values()
    listed = dict.fromkeys(("../outside.toml", str(outside), "near-1.toml"), digest)
    file.write_text(json.dumps(listed))
    assert _OWN.check(root, fresh=True) == ["near-1.toml"]
    for damaged in ("{", "[1]", '{"near-1.toml": 3}'):
        file.write_text(damaged)
        with pytest.raises(InputError, match=r'holds "near-1.toml", which'):
            _OWN.check(root, fresh=True)


def test_a_file_that_comes_while_a_run_writes_is_kept(tmp_path: Path) -> None:
    def late() -> None:
        with _OWN.written(tmp_path, _OWN.check(tmp_path, fresh=True)) as part:
            (part / "near-1.toml").write_text("new")
            (tmp_path / "near-1.toml").write_text("mine")

    with pytest.raises(InputError, match=r'holds "near-1.toml", which no earlier search wrote'):
        late()
    assert _files(tmp_path) == {"near-1.toml": "mine"}


def test_a_file_that_the_run_reads_is_not_removed(tmp_path: Path) -> None:
    _write(tmp_path, _FIRST)
    reads = OwnFiles(
        run="search",
        option="--fresh",
        numbered=_OWN.numbered,
        read=[(tmp_path / "near-2.toml").resolve()],
    )
    with pytest.raises(InputError, match=r'holds "near-2.toml", which is read: name a new folder$'):
        reads.check(tmp_path, fresh=True)
