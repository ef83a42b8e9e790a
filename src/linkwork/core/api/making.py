"""Make mechanisms from files, texts, the library and Python objects."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

from linkwork.core import textfile
from linkwork.core.api.mechanism import Mechanism
from linkwork.core.foundation.errors import InputError
from linkwork.core.foundation.files import as_path
from linkwork.core.foundation.values import as_told
from linkwork.core.mechanism.description import made_of
from linkwork.core.mechanism.linkage import Linkage
from linkwork.core.mechanism.loops import Loops, PlainEquations
from linkwork.core.textfile.reader import example_text, examples


def load(path: str | Path) -> Mechanism:
    """Read a mechanism file, or the mechanism in a link.

    Parameters
    ----------
    path : str or Path
        A TOML file; if there is none of this name, a link or its fragment ``#lw1=…``, as
        :meth:`~linkwork.Mechanism.link` returns it. Nothing is read from the network.

    Returns
    -------
    Mechanism

    Raises
    ------
    MechanismFileError
        With every problem found: file, line, key; or what is wrong with the link.
    InputError
        If there is no such file, but an example of this name.

    Examples
    --------
    >>> import linkwork as lw, pathlib, tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = pathlib.Path(folder) / "bar.toml"
    ...     lw.example("four-bar").save(path)
    ...     lw.load(path).name
    'Four-bar linkage, open'
    >>> lw.load(lw.example("four-bar").link()).name
    'Four-bar linkage, open'
    """
    given = str(as_path(path))
    if given in examples() and not os.path.exists(given):
        raise InputError(
            f'there is no file "{given}"; for the example of this name: lw.example("{given}")'
        )
    read = textfile.read_text(*textfile.source_text(given))
    return Mechanism(read.description, read)


def loads(text: str, name: str = "text") -> Mechanism:
    """Read a mechanism from the text of a mechanism file.

    Parameters
    ----------
    text : str
        TOML.
    name : str
        The name of the text in messages.

    Returns
    -------
    Mechanism

    Raises
    ------
    MechanismFileError
        With every problem found: line, key.

    Examples
    --------
    >>> import linkwork as lw
    >>> lw.loads(lw.example_text("four-bar")).name
    'Four-bar linkage, open'
    """
    if not isinstance(text, str):
        raise InputError(f"a mechanism file must be given as text, got {as_told(text)}")
    read = textfile.read_text(text, name)
    return Mechanism(read.description, read)


def example(name: str) -> Mechanism:
    """A mechanism of the library.

    Parameters
    ----------
    name : str
        One of :func:`examples`.

    Returns
    -------
    Mechanism

    Raises
    ------
    UnknownNameError
        If the library has no such mechanism.

    Examples
    --------
    >>> import linkwork as lw
    >>> lw.example("four-bar").name
    'Four-bar linkage, open'
    """
    return loads(example_text(name), f"{name}.toml")


def linkage(**parts: Any) -> Mechanism:
    """A mechanism from points and links.

    Parameters
    ----------
    **parts
        Fields of a description by points and links: ``points``, ``links``, ``lengths``,
        ``inputs``, ``sliders``, … in file units.

    Returns
    -------
    Mechanism

    Raises
    ------
    MechanismError
        With every problem found.

    Examples
    --------
    >>> import linkwork as lw
    >>> bar = lw.linkage(
    ...     points={"O2": (0, 0), "A": (35, 20), "B": (146, 66), "O4": (100, 0)},
    ...     links={
    ...         "ground": ["O2", "O4"],
    ...         "crank": ["O2", "A"],
    ...         "coupler": ["A", "B"],
    ...         "rocker": ["O4", "B"],
    ...     },
    ...     lengths={"O2 A": 40, "A B": 120, "O4 B": 80},
    ...     inputs=lw.Input(link="crank"),
    ... )
    >>> round(bar.solve(at=60)["rocker"], 3)
    64.943
    """
    return Mechanism(made_of(Linkage, parts))


def loops(**parts: Any) -> Mechanism:
    """A mechanism from loop equations.

    Parameters
    ----------
    **parts
        Fields of a description by loops: ``loops``, ``dimensions``, ``inputs``,
        ``guess``, … in file units.

    Returns
    -------
    Mechanism

    Raises
    ------
    MechanismError
        With every problem found.

    Examples
    --------
    >>> import linkwork as lw
    >>> bar = lw.loops(
    ...     loops={"four-bar": "a*cis(θ2) + b*cis(θ3) = d + c*cis(θ4)"},
    ...     dimensions={"a": 40, "b": 120, "c": 80, "d": 100},
    ...     inputs=lw.Input(variable="θ2"),
    ...     guess={"θ2": 60, "θ3": 20, "θ4": 65},
    ... )
    >>> round(bar.solve()["θ4"], 3)
    64.943
    """
    return Mechanism(made_of(Loops, parts))


def plain_equations(**parts: Any) -> Mechanism:
    """A system of plain real equations.

    Parameters
    ----------
    **parts
        Fields of a description by plain equations: ``equations``, ``guess``,
        ``dimensions``, …

    Returns
    -------
    Mechanism

    Raises
    ------
    MechanismError
        With every problem found.

    Examples
    --------
    >>> import linkwork as lw
    >>> system = lw.plain_equations(
    ...     equations={"circle": "x^2 + y^2 = 25", "line": "y = x + 1"}, guess={"x": 2, "y": 3}
    ... )
    >>> position = system.solve()
    >>> round(position["x"], 9), round(position["y"], 9)
    (3.0, 4.0)
    """
    return Mechanism(made_of(PlainEquations, parts))
