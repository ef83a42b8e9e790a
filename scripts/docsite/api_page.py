"""The reference page of the public names, from the package itself."""

from __future__ import annotations

import inspect
from collections.abc import Iterator
from enum import Enum
from functools import cached_property
from importlib import import_module
from operator import attrgetter
from types import FunctionType, ModuleType

import linkwork as lw
from linkwork.core.foundation.errors import internal_members
from linkwork.core.mechanism.part.part import Part

__all__ = ["ALIASES", "api_page", "is_built_by_users", "public_members", "public_names"]

#: Short names in signatures that stand for several types.
ALIASES = {
    "Number": 'a number, or a formula as text: `40`, `"2*a"`',
    "Pairs": "pairs of numbers: coordinates of points",
    "Array": "NumPy array of float",
    "BoolArray": "NumPy array of bool",
    "ComplexArray": "NumPy array of complex: x + iy of points",
    "CountArray": "NumPy array of int",
    "IndexArray": "NumPy array of int: places of designs",
    "StatusArray": "NumPy array of int: codes of statuses, by their order in the class",
    "AnyArray": "NumPy array of float, int, bool or text",
    "Column": "the same, with one entry for each row",
    "Reduction": '`"max(rocker)"`, or a function of an array of designs and rows',
}
_PROPERTIES = (property, cached_property)
#: The parts of the page with names of the root: their titles, and the packages of the names.
_PARTS = (
    ("Read and make mechanisms", ("linkwork.core.api", "linkwork.core.textfile")),
    (
        "Parts of a mechanism",
        ("linkwork.core.mechanism", "linkwork.contacts", "linkwork.core.foundation.units"),
    ),
    (
        "Results and options",
        ("linkwork.core.results", "linkwork.core.numerics", "linkwork.core.drawing"),
    ),
    ("Statuses", ("linkwork.core.foundation",)),
    ("Errors", ("linkwork.core.foundation.errors",)),
    ("Synthesis", ("linkwork.synthesis",)),
)
#: The parts with the names of packages, as ``lw.design.flywheel``.
_PACKAGES = {
    "Results: linkwork.core.results": "core.results",
    "Equations: linkwork.core.equations": "core.equations",
    "Pictures: linkwork.core.drawing": "core.drawing",
    "Assemblies: linkwork.circuits": "circuits",
    "Forces: linkwork.forces": "forces",
    "Families: linkwork.families": "families",
    "Machine design: linkwork.design": "design",
    "Synthesis and improvement: linkwork.synthesis": "synthesis",
    "Files for other programs: linkwork.writers": "writers",
    "Files of other programs: linkwork.readers": "readers",
    "Pages: linkwork.app": "app",
}
#: Of packages with names that the tutorials explain: those of the reference.
_LISTED = {
    "core.equations": {"EquationSheet"},
    "core.drawing": {"Scene"},
    "families": {"Family", "FamilyLimits", "FamilyMotion"},
    "writers": {
        "PlateOptions",
        "PlateStack",
        "write_plates",
        "write_program",
        "write_report",
        "write_robot",
        "write_workbook",
    },
    "app": {"FilmOptions"},
}


def public_names() -> tuple[str, ...]:
    """All public names below ``linkwork``, wings apart: ``solve``, ``design.flywheel``."""
    root = [name for name in lw.__all__ if not isinstance(getattr(lw, name), ModuleType)]  # type: ignore[attr-defined]  # by the loader
    further = [
        f"{package}.{name}"
        for package in _PACKAGES.values()
        for name in import_module(f"linkwork.{package}").__all__
        if name not in root and name in _LISTED.get(package, {name})
    ]
    return (*root, *further)


def public_members(kind: type) -> Iterator[tuple[str, object]]:
    """The methods and properties of a public class that users call, those of base classes too.

    Parts have fields only: the package calls their methods.
    """
    left = set(internal_members(kind))
    for base in () if issubclass(kind, Part) else kind.__mro__:
        if not base.__module__.startswith("linkwork."):
            continue
        for name, member in vars(base).items():
            function = getattr(member, "__func__", getattr(member, "func", member))
            if name.startswith("_") or name in left or not getattr(function, "__doc__", None):
                continue
            if isinstance(function, FunctionType | property):
                left.add(name)
                yield name, function.fget if isinstance(function, property) else function


def is_built_by_users(kind: type) -> bool:
    """Whether users call the class; others are results, and the page shows no constructor."""
    made = ("linkwork.core.mechanism", "linkwork.core.drawing.annotations", "linkwork.app")
    own = ("linkwork.forces.results", "linkwork.core.numerics", "linkwork.writers.plates.plate")
    return kind.__module__.startswith(made + own)


def api_page() -> str:
    """Every public name with its signature, description and example, as Markdown."""
    parts = [
        "# Python\n",
        "`import linkwork as lw`. These names are public; all others may change.\n",
    ]
    parts += ["| in signatures | meaning |\n|---|---|"]
    parts += [f"| `{name}` | {meaning} |" for name, meaning in ALIASES.items()]
    parts.append("")
    titles = {package: title for title, package in _PACKAGES.items()}
    by_part: dict[str, list[str]] = {title: [] for title in [*dict(_PARTS), *_PACKAGES]}
    for name in public_names():
        package = name.rpartition(".")[0]
        by_part[titles[package] if package else _part_of(name)].append(name)
    for title, names in by_part.items():
        parts.append(f"## {title}\n")
        parts += [_entry(name) for name in names]
    return "\n".join(parts)


def _part_of(name: str) -> str:
    """The title of the part whose package is nearest to the home of a name."""
    home = getattr(lw, name).__module__
    fits = [
        (len(package), title)
        for title, packages in _PARTS
        for package in packages
        if f"{home}.".startswith(f"{package}.")
    ]
    if not fits:
        raise LookupError(f"no part of the page contains {home}: add it to _PARTS")
    return max(fits)[1]


def _entry(name: str) -> str:
    public = attrgetter(name)(lw)
    if not inspect.isclass(public):
        lines = [f".. autofunction:: linkwork.{name}"]
    else:
        kind = "exception" if issubclass(public, Exception) else "class"
        # parentheses: exceptions take the arguments of the language's own
        lines = [f".. auto{kind}:: linkwork.{name}()", ""]
        if issubclass(public, Enum):
            lines += [f"   .. autoattribute:: {member}" for member in public.__members__]
        for member, _function in public_members(public):
            is_property = isinstance(inspect.getattr_static(public, member), _PROPERTIES)
            lines.append(f"   .. auto{'property' if is_property else 'method'}:: {member}")
    return f"### `{name}`\n\n```{{eval-rst}}\n" + "\n".join(lines) + "\n```\n"
