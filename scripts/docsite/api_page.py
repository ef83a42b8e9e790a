"""The reference page of the public names, from the package itself."""

from __future__ import annotations

import inspect
from collections.abc import Iterator
from enum import Enum
from functools import cached_property
from types import FunctionType

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
#: The parts of the page: their titles, and the packages of the names in them.
_PARTS = (
    ("Read and make mechanisms", ("linkwork.api", "linkwork.core.textfile", "linkwork.readers")),
    ("Parts of a mechanism", ("linkwork.core.mechanism", "linkwork.core.foundation.units")),
    ("Families", ("linkwork.families",)),
    (
        "Synthesis and improvement",
        (
            "linkwork.design",
            "linkwork.synthesis.task_objects",
            "linkwork.synthesis.atlas.near_paths",
        ),
    ),
    ("Pictures and films", ("linkwork.core.drawing", "linkwork.app")),
    ("Plates", ("linkwork.writers.plates",)),
    ("Results", ("linkwork.core.results", "linkwork.core.equations", "linkwork.core.numerics")),
    ("Statuses", ("linkwork.core.foundation",)),
    ("Errors", ("linkwork.core.foundation.errors",)),
)


def public_names() -> tuple[str, ...]:
    """All public names."""
    return tuple(lw.__all__)  # type: ignore[attr-defined]  # by the loader


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
    by_part: dict[str, list[str]] = {title: [] for title, _homes in _PARTS}
    for name in public_names():
        by_part[_part_of(name)].append(name)
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
    public = getattr(lw, name)
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
