"""Matplotlib's default settings while a picture is drawn, independent of the user's."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from linkwork.core.foundation.errors import MissingPackageError


@contextmanager
def house_settings() -> Iterator[None]:
    """Use Matplotlib's defaults instead of the user's settings."""
    try:
        import matplotlib
    except ImportError as error:
        raise MissingPackageError("drawing needs Matplotlib: pip install matplotlib") from error
    with matplotlib.rc_context():
        matplotlib.rcdefaults()
        matplotlib.rcParams["svg.hashsalt"] = "linkwork"
        matplotlib.rcParams["path.simplify"] = False  # files show the coordinates of the scene
        matplotlib.rcParams["pdf.fonttype"] = 42  # journals reject PDF files with Type 3 fonts
        matplotlib.rcParams["pgf.rcfonts"] = False  # LaTeX files use the fonts of the document
        yield
