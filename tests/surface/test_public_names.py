"""The public names are those the reference page lists, and each of them exists."""

from __future__ import annotations

import inspect
import re
import subprocess
import sys
from functools import cached_property
from operator import attrgetter

import linkwork as lw
from scripts.docsite.api_page import api_page, public_members, public_names

PUBLIC = public_names()


def test_reference_page_has_an_entry_for_every_public_name() -> None:
    page = api_page()
    listed = re.findall(r"^\.\. auto\w+:: linkwork\.([\w.]+)", page, re.MULTILINE)
    assert sorted(listed) == sorted(PUBLIC)


def test_every_public_name_exists_and_has_a_docstring() -> None:
    for name in PUBLIC:
        assert attrgetter(name)(lw).__doc__, name


def test_dir_tells_every_public_name_and_no_other_before_one_is_used() -> None:
    listed = "[name for name in dir(lw) if not name.startswith('__')]"
    code = f"import linkwork as lw; print({listed} == lw.__all__)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "True"


def test_an_unknown_name_is_an_attribute_error() -> None:
    code = "import linkwork; linkwork.solver"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.stderr.splitlines()[-1] == (
        "AttributeError: module 'linkwork' has no attribute 'solver'"
    )


def test_functions_named_like_their_module_stay_callable() -> None:
    code = (
        "import linkwork as lw\n"
        "bar = lw.example('four-bar')\n"
        "bar.solve(configuration='open')\n"
        "print(len(bar.configurations()), len(bar.circuits()))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "2 2"


def test_import_loads_nothing_heavy() -> None:
    code = (
        "import sys, linkwork as lw\n"
        "lw.example('rapier-drive').solve(at=60)\n"
        "heavy = {'scipy', 'numba', 'matplotlib', 'networkx', 'pandas', 'xarray', 'rich'}\n"
        "heavy |= {'tomlkit'}\n"
        "print(sorted(heavy & set(sys.modules)))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_methods_work_in_any_order_of_first_use() -> None:
    """A function with the name of its module is not hidden by it."""
    code = (
        "import linkwork as lw; bar = lw.example('four-bar'); "
        "bar.solve(60, configuration='open'); "
        "print(len(bar.configurations(60)), len(bar.circuits(certify=False)))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert (done.stdout, done.stderr) == ("2 2\n", "")


def test_no_property_reads_as_a_type_before_its_colon() -> None:
    # the reference takes what stands before a colon in the first line of a property as its type
    misread = [
        f"{name}.{member}"
        for name in PUBLIC
        if isinstance(kind := attrgetter(name)(lw), type)
        for member, function in public_members(kind)
        if isinstance(inspect.getattr_static(kind, member), property | cached_property)
        and re.match(r"[^`]*: ", (inspect.getdoc(function) or "").partition("\n\n")[0])
    ]
    assert misread == []
