"""Archives with compiled modules: the next start finds them, and compiles nothing."""

from __future__ import annotations

import importlib
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

from linkwork.viewer.live.bytecode import with_bytecode

_FILES = {"deep/__init__.py": "a = 1", "deep/used.py": "b = 2", "deep/unused.py": "c = 3"}


@pytest.fixture
def archive(tmp_path: Path) -> Path:
    """An archive of three modules."""
    path = tmp_path / "site.zip"
    with zipfile.ZipFile(path, "w") as writing:
        for name, text in _FILES.items():
            writing.writestr(name, text)
    return path


def _steps(archive: Path, root: Path, target: Path, monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Names in a copy, after the modules have been loaded from a folder or the archive."""
    monkeypatch.syspath_prepend(str(root))
    monkeypatch.setattr(sys, "dont_write_bytecode", True)
    importlib.import_module("deep.used")
    try:
        steps = list(with_bytecode(archive, root, target))
    finally:
        for name in ("deep", "deep.used"):
            del sys.modules[name]
    assert len(steps) == 2
    with zipfile.ZipFile(target) as copy:
        return copy.namelist()


def test_compiled_modules_are_found_in_an_archive(
    archive: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    copy = tmp_path / "copy.zip"
    names = _steps(archive, archive, copy, monkeypatch)
    assert names == [*_FILES, "deep/__init__.pyc", "deep/used.pyc"]
    assert _cached(copy) == f"{copy / 'deep' / 'used.pyc'}"


def test_compiled_modules_are_found_in_a_folder(
    archive: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder, copy, again = (tmp_path / name for name in ("folder", "copy.zip", "again"))
    with zipfile.ZipFile(archive) as content:
        content.extractall(folder)
    _steps(archive, folder, copy, monkeypatch)
    with zipfile.ZipFile(copy) as content:
        content.extractall(again)
    for source in again.glob("deep/*.py"):
        source.write_text("this is not compiled again")
    assert _cached(again) == f"{again / 'deep' / 'used.py'}"


def _cached(place: Path) -> str:
    """Where a new process finds the module."""
    code = (
        "import sys; sys.path.insert(0, sys.argv[1]); import deep.used; print(deep.used.__file__)"
    )
    command = [sys.executable, "-c", code, str(place)]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    return done.stdout.strip()
