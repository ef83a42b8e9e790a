"""Packages that load what they provide on first use."""

from __future__ import annotations

import sys
from importlib import import_module
from pathlib import Path
from typing import Any

import pytest


@pytest.fixture
def package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Any:
    """With modules ``one`` (``one``, ``first``) and ``two`` (``second``)."""
    folder = tmp_path / "lazy_things"
    folder.mkdir()
    (folder / "__init__.py").write_text(
        "from typing import TYPE_CHECKING\n"
        "from linkwork.core.foundation.loading import loader\n"
        "if TYPE_CHECKING:\n"
        "    from lazy_things.one import first as first, one as one\n"
        "    from lazy_things.two import second as second\n"
        "__getattr__ = loader(__name__)\n"
    )
    (folder / "one.py").write_text("one, first = 'the name, not the module', 1\n")
    (folder / "two.py").write_text("second = 2\n")
    monkeypatch.syspath_prepend(tmp_path)
    for name in ("lazy_things", "lazy_things.one", "lazy_things.two"):
        monkeypatch.delitem(sys.modules, name, raising=False)
    return import_module("lazy_things")


def test_nothing_is_loaded_before_it_is_used(package: Any) -> None:
    assert "lazy_things.one" not in sys.modules
    assert package.second == 2
    assert "lazy_things.one" not in sys.modules
    assert [name for name in dir(package) if name[0] != "_"] == ["first", "one", "second"]
    assert package.__all__ == ["first", "one", "second"]


def test_a_name_wins_over_the_module_of_the_same_name(package: Any) -> None:
    assert package.first == 1
    assert package.one == "the name, not the module"


def test_what_somebody_has_put_there_stays(package: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    assert package.first == 1
    monkeypatch.setattr(package, "first", "replaced")
    assert package.second == 2
    assert package.first == "replaced"


def test_what_is_not_provided_is_an_attribute_error(package: Any) -> None:
    with pytest.raises(AttributeError, match="'lazy_things' has no attribute 'third'"):
        _ = package.third
