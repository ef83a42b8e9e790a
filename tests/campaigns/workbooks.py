"""Workbooks of the library recalculated by LibreOffice, as written and after a changed dimension.

Needs ``soffice``. As written, every cell comes to the value in the file. After the change, no row
says that it is proved.
"""

from __future__ import annotations

import math
import shutil
import subprocess
from collections import Counter
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import openpyxl

import linkwork as lw
from linkwork.core.mechanism.linkage import Linkage
from tests.forces.random_loads import loaded
from tests.library_mechanisms import driven_examples, read_example
from tests.writers.coarse import coarse

__all__ = ["workbook_campaign"]

_NEAR = 1e-9  # relative, of 1 at least
_STEPS, _CHANGE, _CHANGED = 24, 1.0001, "-changed"
_ALWAYS = """<?xml version="1.0" encoding="UTF-8"?>
<oor:items xmlns:oor="http://openoffice.org/2001/registry">
<item oor:path="/org.openoffice.Office.Calc/Formula/Load"><prop oor:name="OOXMLRecalcMode"
oor:op="fuse"><value>0</value></prop></item></oor:items>
"""


def workbook_campaign(count: int) -> tuple[Counter[str], list[str]]:
    """Recalculate the workbooks of the first ``count`` mechanisms of the library."""
    counts: Counter[str] = Counter()
    false: list[str] = []
    names = driven_examples()[:count]
    with TemporaryDirectory() as given:
        folder = Path(given)
        for name in names:
            mechanism = coarse(_with_loads(read_example(name)), _STEPS)
            mechanism.write(folder / f"{name}.xlsx", motion=mechanism.sweep())
            _write_changed(folder / f"{name}.xlsx", folder / f"{name}{_CHANGED}.xlsx")
        out = _recalculated(folder)
        for name in names:
            counts["workbooks"] += 1
            found = openpyxl.load_workbook(out / f"{name}.xlsx", data_only=True)
            wrong = _differences(folder / f"{name}.xlsx", found, counts)
            changed = out / f"{name}{_CHANGED}.xlsx"
            wrong += _proofs(changed, counts) if changed.exists() else []
            false += [f"{name} {what}" for what in wrong]
    return counts, false


def _with_loads(mechanism: lw.Mechanism) -> lw.Mechanism:
    """A linkage with random loads, unless it has its own, so that it has sheets of forces."""
    given = mechanism.description
    if not isinstance(given, Linkage) or given.loaded or given.inputs[0].law is not None:
        return mechanism
    return loaded(mechanism, seed=len(given.points))


def _recalculated(folder: Path) -> Path:
    """The folder of the workbooks with the values that LibreOffice computes."""
    program = shutil.which("soffice")
    if program is None:
        raise SystemExit("this campaign needs LibreOffice (soffice)")
    profile, out = folder / "profile", folder / "out"
    (profile / "user").mkdir(parents=True)
    (profile / "user" / "registrymodifications.xcu").write_text(_ALWAYS)
    command = [program, f"-env:UserInstallation={profile.as_uri()}", "--headless", "--convert-to"]
    command += ["xlsx:Calc MS Excel 2007 XML", "--outdir", str(out)]
    # one process for all: starting takes longer than calculating
    subprocess.run([*command, *map(str, folder.glob("*.xlsx"))], check=True, capture_output=True)
    return out


def _differences(path: Path, found: Any, counts: Counter[str]) -> list[str]:
    """The cells whose recalculated values are not those in the file."""
    written = openpyxl.load_workbook(path, data_only=True)
    wrong = []
    for sheet in openpyxl.load_workbook(path):
        for row in sheet.iter_rows():
            for cell in row:
                expected = written[sheet.title][cell.coordinate].value
                if cell.data_type != "f" or expected in (None, ""):
                    continue
                own = found[sheet.title][cell.coordinate].value
                counts["formulas"] += 1
                if not _same(own, expected):
                    wrong.append(f"{sheet.title}!{cell.coordinate}: {own!r} for {expected!r}")
    return wrong


def _same(own: Any, expected: Any) -> bool:
    if isinstance(own, int | float) and isinstance(expected, int | float):
        return math.isclose(own, expected, rel_tol=_NEAR, abs_tol=_NEAR)
    return bool(own == expected)


def _write_changed(path: Path, changed: Path) -> None:
    """Write the workbook again with its first dimension changed a little, if it has one."""
    book = openpyxl.load_workbook(path)
    lines = book["Dimensions"].iter_rows(min_row=5, max_col=6)
    cell = next((row[1] for row in lines if _is_dimension(row)), None)
    if cell is not None:
        cell.value *= _CHANGE
        book.save(changed)


def _proofs(changed: Path, counts: Counter[str]) -> list[str]:
    """The rows that state a proof although a dimension has changed."""
    cycle = openpyxl.load_workbook(changed, data_only=True)["Cycle"]
    column = next(cell.column for cell in cycle[5] if cell.value == "status")
    said = [str(cycle.cell(row, column).value) for row in range(7, cycle.max_row + 1)]
    counts["rows after a change"] += len(said)
    counts["converged after a change"] += sum(one.startswith("converged") for one in said)
    proofs = (one.replace("(not proved)", "") for one in said)
    return [f"row {k + 1}: {one}" for k, one in enumerate(proofs) if "proved" in one]


def _is_dimension(row: Any) -> bool:
    """Whether a line has a plain number other than 0 that is compared with Linkwork's."""
    value = row[1].value
    return isinstance(value, int | float) and value != 0 and isinstance(row[5].value, str)
