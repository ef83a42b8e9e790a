"""A public name that was once given keeps working; where it has changed, it warns."""

from __future__ import annotations

import inspect
import subprocess
import sys
import warnings
from dataclasses import fields, is_dataclass
from importlib import import_module
from pathlib import Path

import pytest

import linkwork as lw

NAMES = {
    owner: names.split()
    for owner, names in (
        entry.split(":")
        for entry in Path(__file__)
        .with_name("former_names.txt")
        .read_text(encoding="utf-8")
        .replace("\n    ", " ")
        .splitlines()[1:]
    )
}


def _owner(path: str) -> object:
    try:
        return import_module(path)
    except ImportError:
        module, _, name = path.rpartition(".")
        return getattr(import_module(module), name)


@pytest.mark.parametrize("owner", NAMES)
@pytest.mark.filterwarnings("ignore:.*is now:DeprecationWarning")
def test_every_name_that_was_public_still_exists(owner: str) -> None:
    found = _owner(owner)
    stored = {f.name for f in fields(found)} if is_dataclass(found) else set()
    missing = [name for name in NAMES[owner] if name not in stored and not hasattr(found, name)]
    assert missing == []


@pytest.mark.parametrize("name", NAMES["linkwork.everyday"])
def test_everyday_is_now_api(name: str) -> None:
    everyday = import_module("linkwork.everyday")
    told = (
        f"linkwork.everyday.{name} is now linkwork.api.{name}; "
        "the former name is removed in version 0.4"
    )
    with pytest.warns(DeprecationWarning, match="is now") as seen:
        former = getattr(everyday, name)
    assert [(str(w.message), w.filename) for w in seen] == [(told, __file__)]
    assert former is getattr(lw, name)


def test_a_former_module_has_no_other_name() -> None:
    everyday = import_module("linkwork.everyday")
    with pytest.warns(DeprecationWarning, match=r"everyday\.__all__"):
        assert set(NAMES["linkwork.everyday"]) <= set(everyday.__all__)
    with pytest.raises(AttributeError, match=r"module 'linkwork\.api' has no attribute 'solver'"):
        everyday.solver  # noqa: B018


def test_sweep_beside_is_now_approximate_sweep() -> None:
    bar = lw.example("four-bar")
    with pytest.warns(DeprecationWarning, match="is now") as seen:
        former = bar.sweep_beside()
    told = "sweep_beside() is now approximate_sweep(); the former name is removed in version 0.4"
    assert [(str(w.message), w.filename) for w in seen] == [(told, __file__)]
    # compiled code, which the second call may find, rounds differently
    assert former["coupler"] == pytest.approx(bar.approximate_sweep()["coupler"], rel=1e-12)
    assert inspect.signature(bar.sweep_beside) == inspect.signature(bar.approximate_sweep)


def test_importing_the_package_warns_of_nothing() -> None:
    code = "import linkwork as lw; lw.example('four-bar').solve()"
    subprocess.run([sys.executable, "-Werror::DeprecationWarning", "-c", code], check=True)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        import_module("linkwork.everyday")
