"""The workbench in a browser's worker: what the page asks is answered as on a socket."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

import linkwork as lw
from linkwork import example_text
from linkwork.app.live.session import BrowserDesk
from linkwork.core.textfile.link import fragment_of
from linkwork.synthesis.solvers.solving import solve_task
from tests.app.live.conftest import FOUR_BAR


class Page:
    """A page that talks to a desk of its own."""

    def __init__(self, *, pauses: bool = False) -> None:
        self.sent: list[str] = []
        self.later: list[str] = []  # messages that arrive during a pause
        self.told: list[dict[str, Any]] = []
        self.desk = BrowserDesk(
            lw.loads,
            example_text,
            self._tell,
            self._take,
            solve_task,
            self._pause if pauses else None,
        )

    def ask(self, kind: str, **fields: Any) -> list[dict[str, Any]]:
        """The answers to a request."""
        self.sent.append(json.dumps({"kind": kind, **fields}))
        self.told.clear()
        while self.desk.work():
            pass
        return list(self.told)

    @property
    def kinds(self) -> list[str]:
        return [event["kind"] for event in self.told]

    def _tell(self, event: str) -> None:
        told = json.loads(event)
        if told["kind"] != "working":  # a slow machine tells more of them
            self.told.append(told)

    def _take(self) -> list[str]:
        taken, self.sent = self.sent, []
        return taken

    def _pause(self) -> None:
        self.sent, self.later = [*self.sent, *self.later], []


@pytest.fixture
def page(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Page:
    """A page with a four-bar, in a folder that stands for the memory of the browser."""
    monkeypatch.chdir(tmp_path)
    found = Page()
    found.desk.open("four-bar.toml", FOUR_BAR)
    return found


def test_a_page_begins_with_the_file_and_its_cycle(page: Page) -> None:
    assert page.kinds == ["palette_shown", "file_state", "motion_found"]
    assert page.told[1]["file"] == "four-bar.toml"
    assert page.told[1]["text"] == FOUR_BAR
    assert not page.told[1]["unsaved"]


def test_an_address_names_a_task_which_is_solved_here(page: Page) -> None:
    page.told.clear()
    page.desk.begin("#task=five-poses")
    # the task is shown before it is solved
    assert page.kinds == ["task_state", "task_state", "task_solved"]
    assert page.told[0]["file"] == "five-poses.toml"
    answers = page.ask("show_design", design=5, id=3)
    assert [(event["kind"], event["answers"]) for event in answers] == [("design_found", 3)]
    page.desk.begin("#task=nothing")
    assert "refused" in page.kinds


def test_answers_repeat_the_id_of_the_request(page: Page) -> None:
    answers = page.ask("set_number", name="a", value=41, id=7)
    assert [event["answers"] for event in answers] == [7, 7]
    assert [event["kind"] for event in answers] == ["file_state", "motion_found"]


def test_outdated_changes_are_skipped(page: Page) -> None:
    for k in range(5):
        page.sent.append(
            json.dumps({"kind": "set_number", "name": "a", "value": 41 + k, "live": True, "id": k})
        )
    answers = page.ask("set_number", name="a", value=50, live=True, id=9)
    assert [event["answers"] for event in answers] == [9]


def test_bad_messages_are_refused_and_the_page_goes_on(page: Page) -> None:
    page.sent += ["{", '{"kind": "explode", "id": 3}']
    answers = page.ask("undo", id=4)
    assert [event["kind"] for event in answers] == ["refused"] * 3
    assert [event["answers"] for event in answers] == [None, 3, 4]


def test_saving_ends_with_the_saved_text(page: Page) -> None:
    page.ask("set_number", name="a", value=41)
    answers = page.ask("save")
    assert [event["kind"] for event in answers] == ["saved", "file_state"]
    assert "a = 41" in answers[1]["text"]
    assert not answers[1]["unsaved"]


def test_a_newer_change_cancels_a_cycle_that_is_being_solved(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("linkwork.app.live.session._LOOK_FOR_MESSAGES", 0.0)
    page = Page(pauses=True)
    page.desk.open("four-bar.toml", FOUR_BAR)
    page.later = [json.dumps({"kind": "set_number", "name": "a", "value": 42, "id": 2})]
    answers = page.ask("set_number", name="a", value=41, id=1)
    assert [(event["kind"], event["answers"]) for event in answers] == [
        ("file_state", 1),
        ("file_state", 2),
        ("motion_found", 2),
    ]


def test_kept_work_is_unsaved_and_can_be_undone(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    page = Page()
    page.desk.begin("", "mine.toml", FOUR_BAR, FOUR_BAR.replace("a = 40", "a = 45"))
    assert page.told[1]["unsaved"]
    assert "a = 45" in page.told[1]["text"]
    assert page.ask("undo")[0]["text"] == FOUR_BAR


@pytest.mark.parametrize(
    ("fragment", "file"),
    [("#example=", "untitled.toml"), ("#example=jansen-leg", "jansen-leg.toml")],
)
def test_an_address_names_a_mechanism_of_the_library(
    fragment: str, file: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    page = Page()
    page.desk.begin(fragment)
    assert page.told[1]["file"] == file


@pytest.mark.parametrize("fragment", ["", "#"])
def test_a_bare_address_offers_the_library(
    fragment: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    page = Page()
    page.desk.begin(fragment)
    assert page.kinds == ["palette_shown", "start_offered", "file_state", "sketch_shown"]


def test_an_address_contains_a_mechanism(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    page = Page()
    page.desk.begin(fragment_of(FOUR_BAR))
    assert (page.told[1]["file"], page.told[1]["text"]) == ("linked.toml", FOUR_BAR)
    assert page.kinds == ["palette_shown", "file_state", "motion_found"]


@pytest.mark.parametrize("fragment", ["#example=unknown", "#example=../../etc", "#\0<b>", "#lw1=A"])
def test_a_bad_address_is_refused_and_the_library_is_offered(
    fragment: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    page = Page()
    page.desk.begin(fragment)
    assert {"start_offered", "refused"} < set(page.kinds)
    assert page.told[2]["file"] == "untitled.toml"


def test_names_stay_in_the_folder(page: Page, tmp_path: Path) -> None:
    page.told.clear()
    page.desk.open("../../" + "x" * 300 + ".toml", FOUR_BAR)
    assert page.told[1]["file"] == "x" * 95 + ".toml"
    assert page.ask("save")[0]["kind"] == "saved"
    assert (tmp_path / page.told[0]["file"]).read_text() == FOUR_BAR


def test_long_work_gives_signs(page: Page, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("linkwork.app.live.session._PACE", 0.0)
    told: list[dict[str, Any]] = []
    monkeypatch.setattr(page, "_tell", lambda event: told.append(json.loads(event)))
    page.desk._tell = page._tell
    page.ask("set_number", name="a", value=41, id=5)
    signs = [event for event in told if event["kind"] == "working"]
    assert signs
    assert {event["answers"] for event in signs} == {5}
    assert all(0 <= event["fraction"] <= 1 for event in signs)
