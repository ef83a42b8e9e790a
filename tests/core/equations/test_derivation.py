"""The derivation of a mechanism's equations as a LaTeX document."""

from __future__ import annotations

import re
import shutil
import subprocess
from pathlib import Path

import pytest

import linkwork as lw
from linkwork.core.equations.writing import derivation


def _derived(name: str) -> str:
    mechanism = lw.example(name)
    return derivation(mechanism.equations(), mechanism.name)


def test_the_rates_of_the_rapier_drive_have_the_derivative_by_the_crank() -> None:
    by_input = _derived("rapier-drive").partition("\\section{Rates}")[2]
    matrix = re.search(r"begin\{bmatrix\}\n(.*?)\n\\end", by_input, re.DOTALL)
    assert matrix is not None
    # F1 and F3 have a2·cos θ12 and a2·sin θ12, the second loop has no crank
    assert [row.strip() for row in matrix[1].split("\\\\")] == [
        r"-a_2 \, \sin \theta_{12}",
        "0",
        r"a_2 \, \cos \theta_{12}",
        "0",
    ]


def test_a_large_jacobian_is_a_list_of_its_entries() -> None:
    text = _derived("double-butterfly")
    assert "\\partial F_{1}/\\partial" in text
    assert "All others are zero." in text


def test_without_unknowns_there_is_nothing_to_solve() -> None:
    text = _derived("double-pendulum")
    assert "There is no unknown: all positions follow from the inputs directly." in text
    assert "Newton" not in text
    assert "bmatrix" not in text


@pytest.mark.extended
@pytest.mark.skipif(shutil.which("pdflatex") is None, reason="needs pdfLaTeX")
@pytest.mark.parametrize(
    "name", ["rapier-drive", "cam-roller-follower", "double-butterfly", "pendulum"]
)
def test_latex_compiles_the_document(name: str, tmp_path: Path) -> None:
    (tmp_path / "x.tex").write_text(_derived(name), "utf-8")
    command = ["pdflatex", "-halt-on-error", "-interaction=nonstopmode", "x.tex"]
    subprocess.run(command, cwd=tmp_path, check=True, capture_output=True, timeout=120)
