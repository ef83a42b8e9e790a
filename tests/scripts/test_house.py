"""The script that measures how much a maintainer has to read."""

from __future__ import annotations

from pathlib import Path

from scripts.house import arrows, code_lines, import_lines

TEXT = '''"""Head."""

from linkwork.core.motion import solving  # used below
from linkwork.forces import (
    results,
)

__all__ = ["name"]


def name() -> None:
    """Docstring
    of two lines.
    """
    # a comment
    solving.solve(
        results,
    )
'''


def test_docstrings_comments_and_blank_lines_are_no_code() -> None:
    assert code_lines(TEXT) == 9
    assert import_lines(TEXT) == 5


def test_arrows_join_rooms() -> None:
    texts = {Path("design/a.py"): TEXT, Path("forces/b.py"): TEXT, Path("__init__.py"): TEXT}
    assert arrows(texts) == {("design", "core"): 1, ("design", "forces"): 1, ("forces", "core"): 1}
