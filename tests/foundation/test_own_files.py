"""Folders that are filled again: own files are replaced, the user's are never touched."""

from __future__ import annotations

import os
import re
from pathlib import Path

import pytest

from linkwork.foundation.errors import InputError
from linkwork.foundation.own_files import OwnFiles

_OWN = OwnFiles(
    run="search",
    option="--fresh",
    numbered=re.compile(r"(refused/)?near-\d+\.toml"),
    named={"curve/foot.csv": b"foot", "table.csv": None},
    folders=(".", "refused"),
)
_FIRST = {"near-1.toml": "one", "near-2.toml": "two", "refused/near-3.toml": "three"}
_TOLD = (
    "which this search could write over and which is yours, changed or read by it: "
    "rename or move it, or name a new folder"
)


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
    listed = (root / ".linkwork-search.sha256").read_text().splitlines()
    assert [line[64:] for line in listed] == [f"  {name}" for name in sorted(_FIRST)]
    mine = {"far-1.toml": "mine", "data/near-4.toml": "mine", "near-1.svg": "mine"}
    (root / "data").mkdir()
    for name, text in mine.items():
        (root / name).write_text(text)
    _write(root, {"near-1.toml": "new"})
    assert _files(root) == {"near-1.toml": "new", **mine}
    assert not (root / "refused").exists()


@pytest.mark.parametrize(
    ("name", "text", "met"),
    [
        ("near-7.toml", "mine", "near-7.toml"),
        ("near-2.toml", "changed", "near-2.toml"),
        ("refused/near-7.toml", "mine", "refused/near-7.toml"),
        ("table.csv", "mine", "table.csv"),
        ("table.csv/mine.txt", "mine", "table.csv"),
        ("curve/foot.csv", "mine", "curve/foot.csv"),
        ("curve", "mine", "curve"),
        ("curve/foot.csv", "foot", ""),
        ("curve/other.csv", "mine", ""),
        ("curve/near-7.toml", "mine", ""),
    ],
)
def test_a_file_that_could_be_written_over_is_named_before_the_work(
    tmp_path: Path, name: str, text: str, met: str
) -> None:
    _write(tmp_path, _FIRST)
    (tmp_path / name).parent.mkdir(exist_ok=True)
    (tmp_path / name).write_text(text)
    if met:
        told = f'the folder "{tmp_path}" holds "{met}", {_TOLD}'
        with pytest.raises(InputError, match=f"^{re.escape(told)}$"):
            _OWN.check(tmp_path, fresh=True)
        assert (tmp_path / name).read_text() == text
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
    with pytest.raises(InputError, match=r'holds "refused", which this search could'):
        _OWN.check(root, fresh=True)
    other = OwnFiles(run="search", option="--fresh", numbered=_OWN.numbered)
    assert other.check(root, fresh=True) == {"near-1.toml", "near-2.toml"}
    # the folder itself may be a link
    (tmp_path / "link").symlink_to(root)
    assert other.check(tmp_path / "link", fresh=True) == {"near-1.toml", "near-2.toml"}
    (root / "near-1.toml").rename(mine / "near-1.toml")
    (root / "near-1.toml").symlink_to(mine / "near-1.toml")
    with pytest.raises(InputError, match=r'holds "near-1.toml", which this search could'):
        other.check(root, fresh=True)
    assert _files(mine) == {"near-3.toml": "three", "near-1.toml": "one"}


def test_a_list_names_no_file_outside_its_folder(tmp_path: Path) -> None:
    root = tmp_path / "near"
    _write(root, {"near-1.toml": "one"})
    outside = tmp_path / "outside.toml"
    outside.write_text("one")
    file = root / ".linkwork-search.sha256"
    line = file.read_text()
    for name in ("../outside.toml", str(outside)):
        file.write_text(line + line.replace("near-1.toml", name))
        assert _OWN.check(root, fresh=True) == {"near-1.toml"}
    for damaged in ("", line[1:], line.replace("  ", " "), "\0\n\ud800"):
        file.write_bytes(damaged.encode(errors="surrogatepass"))
        with pytest.raises(InputError, match=r'holds "(near-1|.linkwork-search.sha256)'):
            _OWN.check(root, fresh=True)
    file.write_text(line.replace("near-1.toml", "./near-1.toml"))
    with pytest.raises(InputError, match=r'holds "near-1.toml", which'):
        _OWN.check(root, fresh=True)


@pytest.mark.parametrize("kind", ["folder", "link", "text"])
def test_what_has_the_name_of_the_list_is_not_replaced(tmp_path: Path, kind: str) -> None:
    file = tmp_path / "near" / ".linkwork-search.sha256"
    file.parent.mkdir()
    if kind == "folder":
        file.mkdir()
    elif kind == "link":
        file.symlink_to(tmp_path / "elsewhere")
    else:
        file.write_text("mine")
    with pytest.raises(InputError, match=r'holds "\.linkwork-search\.sha256", which this search'):
        _OWN.check(file.parent, fresh=True)


def test_files_that_are_changed_while_a_run_works_are_kept(tmp_path: Path) -> None:
    root = tmp_path / "near"
    _write(root, _FIRST)
    earlier = _OWN.check(root, fresh=True)
    (root / "near-2.toml").write_text("changed")
    with _OWN.written(root, earlier) as part:
        (part / "near-1.toml").write_text("new")
    assert _files(root) == {"near-1.toml": "new", "near-2.toml": "changed"}
    (root / "near-2.toml").unlink()
    earlier = _OWN.check(root, fresh=True)
    (root / "near-1.toml").write_text("changed")

    def write() -> None:
        with _OWN.written(root, earlier) as part:
            (part / "near-1.toml").write_text("newer")
            (part / "near-9.toml").write_text("nine")

    for name in ("near-2", "near-3"):
        told = rf'changed meanwhile at "near-1\.toml" and stays as it is: all .* in ".*/{name}"$'
        with pytest.raises(InputError, match=told):
            write()
        assert _files(tmp_path / name) == {"near-1.toml": "newer", "near-9.toml": "nine"}
        assert _OWN.check(tmp_path / name, fresh=True) == {"near-1.toml", "near-9.toml"}
    assert _files(root) == {"near-1.toml": "changed"}


def test_after_an_obstacle_all_files_of_both_runs_can_be_replaced(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    root = tmp_path / "near"
    _write(root, _FIRST)
    replace = os.replace

    def locked(source: Path, target: Path) -> None:
        if Path(target) == root / "near-2.toml":
            raise PermissionError(1, "Operation not permitted", str(source), None, str(target))
        replace(source, target)

    monkeypatch.setattr(os, "replace", locked)
    with pytest.raises(InputError, match=r'cannot write ".*/near/near-2.toml": Operation not'):
        _write(root, {"near-1.toml": "new", "near-2.toml": "new", "near-4.toml": "new"})
    monkeypatch.undo()
    assert (root / "near-1.toml").read_text() == "new"
    assert _OWN.check(root, fresh=True) == {*_FIRST}
    _write(root, {"near-5.toml": "newest"})
    assert _files(root) == {"near-5.toml": "newest"}


def test_names_of_several_lines_are_never_removed(tmp_path: Path) -> None:
    root = tmp_path / "near"
    _write(root, {"a\nb.toml": "one"})
    (root / "a").write_text("one")
    _write(root, {"near-1.toml": "new"})
    assert _files(root) == {"a": "one", "a\nb.toml": "one", "near-1.toml": "new"}


def test_left_over_temporary_folders_do_not_fill_a_folder(tmp_path: Path) -> None:
    (tmp_path / ".linkwork-0123456789ab.part").mkdir()
    assert not _OWN.check(tmp_path, fresh=False)


def test_a_file_that_comes_while_a_run_writes_is_kept(tmp_path: Path) -> None:
    def late() -> None:
        with _OWN.written(tmp_path, _OWN.check(tmp_path, fresh=True)) as part:
            (part / "near-1.toml").write_text("new")
            (tmp_path / "near-1.toml").write_text("mine")

    with pytest.raises(InputError, match=r'changed meanwhile at "near-1.toml" and stays as it is'):
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
    with pytest.raises(
        InputError, match=r'holds "near-2.toml", which this search could write over'
    ):
        reads.check(tmp_path, fresh=True)
