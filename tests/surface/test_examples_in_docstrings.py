"""Every public name has an example in its docstring, and all examples give what they print."""

from __future__ import annotations

import doctest
import inspect
from collections.abc import Iterator
from operator import attrgetter
from types import FunctionType

import pytest

import linkwork as lw
from scripts.docsite.api_page import public_names


def _docstrings(name: str) -> Iterator[tuple[str, str]]:
    """The docstring of a public name, and those of its public methods and properties."""
    public = attrgetter(name)(lw)
    yield name, public.__doc__ or ""
    if inspect.isclass(public):
        for kind in public.__mro__:
            if not kind.__module__.startswith("linkwork."):
                continue
            for method, entry in vars(kind).items():
                if not method.startswith("_") and isinstance(entry, FunctionType | property):
                    yield f"{name}.{method}", entry.__doc__ or ""


def _examples(name: str, text: str) -> doctest.DocTest:
    return doctest.DocTestParser().get_doctest(text, {}, name, None, 0)


@pytest.mark.parametrize("name", public_names())
def test_every_public_name_has_an_example_that_runs(name: str) -> None:
    assert _examples(name, attrgetter(name)(lw).__doc__ or "").examples, f"{name} has no example"
    report: list[str] = []
    for place, text in _docstrings(name):
        doctest.DocTestRunner(verbose=False).run(_examples(place, text), out=report.append)
    assert not report, "".join(report)


def test_an_example_that_prints_another_result_is_found() -> None:
    report: list[str] = []
    doctest.DocTestRunner().run(_examples("wrong", ">>> 1 + 1\n3\n"), out=report.append)
    assert "Expected:\n    3\nGot:\n    2\n" in "".join(report)
