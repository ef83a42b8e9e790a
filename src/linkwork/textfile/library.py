"""The mechanism files that come with Linkwork, by name."""

from __future__ import annotations

from pathlib import Path

from linkwork.foundation.errors import UnknownNameError, choices

__all__ = ["example_text", "examples"]

_FOLDER = Path(__file__).parents[1] / "library"


def examples() -> tuple[str, ...]:
    """The names of the mechanisms that come with Linkwork."""
    return tuple(path.stem for path in sorted(_FOLDER.glob("*.toml")))


def example_text(name: str) -> str:
    """The file of a library mechanism.

    Raises
    ------
    UnknownNameError
        With the names that exist.
    """
    known = examples()
    if name not in known:
        raise UnknownNameError(f'there is no example "{name}" {choices("examples", known, name)}')
    return (_FOLDER / f"{name}.toml").read_text(encoding="utf-8")
