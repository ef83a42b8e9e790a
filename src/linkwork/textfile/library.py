"""The mechanism files that come with Linkwork, by name."""

from __future__ import annotations

from pathlib import Path

from linkwork.foundation.errors import UnknownNameError, choices
from linkwork.foundation.names import as_name

__all__ = ["example_text", "examples"]

_FOLDER = Path(__file__).parents[1] / "library"


def examples() -> tuple[str, ...]:
    """The names of all mechanisms of the library, in alphabetical order.

    Returns
    -------
    tuple of str

    Examples
    --------
    >>> import linkwork as lw
    >>> "rapier-drive" in lw.examples()
    True
    """
    return tuple(path.stem for path in sorted(_FOLDER.glob("*.toml")))


def example_text(name: str) -> str:
    """The text of a mechanism file of the library.

    Parameters
    ----------
    name : str
        One of :func:`examples`.

    Returns
    -------
    str
        TOML, as ``linkwork examples NAME`` prints it.

    Raises
    ------
    UnknownNameError
        If the library has no such mechanism.

    Examples
    --------
    >>> import linkwork as lw
    >>> print(lw.example_text("four-bar").splitlines()[1])
    name   = "Four-bar linkage, open"
    """
    known = examples()
    if as_name(name) not in known:
        raise UnknownNameError(f'there is no example "{name}" {choices("examples", known, name)}')
    return (_FOLDER / f"{name}.toml").read_text(encoding="utf-8")
