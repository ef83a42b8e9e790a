"""Matplotlib's own settings, whatever the user's are, while a picture is drawn."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from linkwork.foundation.errors import MissingPackageError

__all__ = ["house_settings"]


@contextmanager
def house_settings() -> Iterator[None]:
    """Matplotlib's own defaults, whatever the user's settings are, while we draw."""
    try:
        import matplotlib
    except ImportError as error:
        raise MissingPackageError("drawing needs Matplotlib: pip install matplotlib") from error
    with matplotlib.rc_context():
        matplotlib.rcdefaults()
        matplotlib.rcParams["svg.hashsalt"] = "linkwork"
        matplotlib.rcParams["path.simplify"] = False  # files show the scene's own coordinates
        matplotlib.rcParams["pdf.fonttype"] = 42  # journals refuse PDF files with fonts of type 3
        yield
