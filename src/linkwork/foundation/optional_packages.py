"""Packages that only some results need, imported where these are asked for."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from linkwork.foundation.errors import MissingPackageError

__all__ = ["installed_with"]


@contextmanager
def installed_with(extra: str, need: str) -> Iterator[None]:
    """Around the import of packages of an extra; ``need`` says what needs them.

    Raises
    ------
    MissingPackageError
        If they are not installed.
    """
    try:
        yield
    except ImportError:
        raise MissingPackageError(f'{need}: pip install "linkwork[{extra}]"') from None
