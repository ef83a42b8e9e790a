"""Every example runs and ends with the number it announces."""

from __future__ import annotations

import json
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


def test_the_notebook_ends_with_its_number(tmp_path: Path) -> None:
    notebook = json.loads((EXAMPLES[0].parent / "notebook.ipynb").read_text(encoding="utf-8"))
    cells = {"code": "", "markdown": ""}
    for cell in notebook["cells"]:
        cells[cell["cell_type"]] += "".join(cell["source"]) + "\n"
        assert not cell.get("outputs")  # they would grow old
    expected = re.search(r"number to check: (\S+)\.$", cells["markdown"], re.MULTILINE)
    assert expected is not None
    script = tmp_path / "notebook.py"
    script.write_text(f"import matplotlib\nmatplotlib.use('agg')\n{cells['code']}", "utf-8")
    done = subprocess.run(
        [sys.executable, str(script)], capture_output=True, text=True, encoding="utf-8", check=True
    )
    assert done.stdout.split() == [expected.group(1)]
