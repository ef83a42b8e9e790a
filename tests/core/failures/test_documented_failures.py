"""The page "Why did it fail?" shows what the commands print."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from click.testing import CliRunner

import linkwork as lw
from linkwork.core.commands.main import linkwork
from tests.core.failures.test_positions_that_do_not_exist import four_bar

PAGE = (Path(__file__).parents[3] / "docs" / "why-did-it-fail.md").read_text(encoding="utf-8")
SHOWN = re.findall(r"```text\n(.*?)```", PAGE, re.DOTALL)


def test_every_shown_output_is_checked() -> None:
    assert len(SHOWN) == len(CASES)


CASES = {
    "Coupler too short": ("", []),
    "Rapier drive of a loom, limited crank": ("rapier-drive-limited", ["--at", "170"]),
    "Newton-Raphson diverging from a root": ("newton-inflection", []),
    "Newton-Raphson finding another root": ("newton-another-root", []),
}


@pytest.mark.parametrize("title", CASES)
def test_a_shown_output_is_what_is_printed(title: str, tmp_path: Path) -> None:
    (shown,) = [text for text in SHOWN if text.startswith(title)]
    name, options = CASES[title]
    path = tmp_path / "mechanism.toml"
    mechanism = lw.example(name) if name else four_bar(40, 30, 40, 100)
    if not name:
        mechanism = mechanism.changed(name=title)
    mechanism.save(path)
    printed = CliRunner().invoke(linkwork, ["solve", str(path), *options]).output
    assert printed.startswith(shown)
