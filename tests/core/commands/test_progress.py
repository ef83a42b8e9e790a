"""Progress on a terminal: the label after a while, a bar as soon as a fraction is known."""

from __future__ import annotations

import io
import sys
import time

import pytest

from linkwork.core.commands import terminal


class _Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


def terminal_of(monkeypatch: pytest.MonkeyPatch, patience: float = 0.01) -> _Terminal:
    """The error stream from now on, a terminal, with progress after so many seconds."""
    stream = _Terminal()
    monkeypatch.setattr(sys, "stderr", stream)
    monkeypatch.setattr(terminal, "_PATIENCE", patience)
    return stream


def test_a_task_without_fractions_shows_its_label_and_removes_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    shown = terminal_of(monkeypatch)
    with terminal.progress("listing"):
        time.sleep(0.1)
        assert shown.getvalue() == "listing …"
    assert shown.getvalue() == "listing …\r\x1b[K"


def test_a_bar_takes_the_place_of_the_label(monkeypatch: pytest.MonkeyPatch) -> None:
    shown = terminal_of(monkeypatch)
    with terminal.progress("sweeping") as tell:
        time.sleep(0.1)
        tell(0.5)
    assert shown.getvalue().startswith("sweeping …\r\x1b[K")
    assert "50%" in shown.getvalue()


def test_a_quick_task_shows_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    shown = terminal_of(monkeypatch, 60.0)
    with terminal.progress("solving") as tell:
        tell(0.5)
    assert shown.getvalue() == ""


def test_a_stream_that_is_no_terminal_shows_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    stream = io.StringIO()
    monkeypatch.setattr(sys, "stderr", stream)
    monkeypatch.setattr(terminal, "_PATIENCE", 0.01)
    with terminal.progress("sweeping") as tell:
        time.sleep(0.1)
        tell(0.5)
    assert stream.getvalue() == ""
