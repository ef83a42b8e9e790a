"""Every numbered example runs and ends with the number it announces."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest

EXAMPLES = sorted((Path(__file__).parents[2] / "examples").glob("[0-9]*.py"))


def test_there_are_examples() -> None:
    assert len(EXAMPLES) >= 7


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_example_ends_with_its_number(path: Path) -> None:
    expected = re.search(r"^expect: (\S+)$", path.read_text(encoding="utf-8"), re.MULTILINE)
    assert expected is not None
    done = subprocess.run(
        [sys.executable, str(path)], capture_output=True, text=True, encoding="utf-8", check=True
    )
    assert done.stdout.split()[-1] == expected.group(1)
