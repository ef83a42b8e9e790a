"""Progress on a terminal: the label after a while, a bar as soon as a fraction is known."""

from __future__ import annotations

import io
import sys
import time

import pytest

from linkwork.cli import terminal


class _Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


@pytest.fixture
def shown(monkeypatch: pytest.MonkeyPatch) -> _Terminal:
    """The error stream, a terminal, with progress after a hundredth of a second."""
    stream = _Terminal()
    monkeypatch.setattr(sys, "stderr", stream)
    monkeypatch.setattr(terminal, "_PATIENCE", 0.01)
    return stream


def test_a_task_without_fractions_shows_its_label_and_removes_it(shown: _Terminal) -> None:
    with terminal.progress("listing"):
        time.sleep(0.1)
        assert shown.getvalue() == "listing …"
    assert shown.getvalue() == "listing …\r\x1b[K"


def test_a_bar_takes_the_place_of_the_label(shown: _Terminal) -> None:
    with terminal.progress("sweeping") as tell:
        time.sleep(0.1)
        tell(0.5)
    assert shown.getvalue().startswith("sweeping …\r\x1b[K")
    assert "50%" in shown.getvalue()


def test_a_quick_task_shows_nothing(shown: _Terminal, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(terminal, "_PATIENCE", 60.0)
    with terminal.progress("solving") as tell:
        tell(0.5)
    assert shown.getvalue() == ""
