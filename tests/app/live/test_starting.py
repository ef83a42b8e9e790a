"""The start page: the library and a blank sheet, and what is opened from there."""

from __future__ import annotations

import json
from collections.abc import Callable
from importlib import resources
from pathlib import Path
from typing import Any

import pytest

import linkwork as lw
from linkwork.app.live import events as tell, requests as ask
from linkwork.app.live.file_state import FileState
from linkwork.app.live.opened_file import new_file
from linkwork.app.live.server import LiveServer
from linkwork.app.live.workbench import Workbench
from linkwork.core.foundation.errors import InputError
from scripts.thumbnails import entry

LIBRARY = json.loads(
    resources.files("linkwork.app").joinpath("library.json").read_text(encoding="utf-8")
)


@pytest.fixture
def started(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Workbench:
    """A workbench without a file, in an empty folder."""
    monkeypatch.chdir(tmp_path)
    return Workbench(new_file(), lw.loads, start=True)


def kinds(events: list[tell.Event]) -> list[str]:
    """The kinds of events, in their order."""
    return [type(event).__name__ for event in events]


def test_the_library_is_offered_until_a_mechanism_is_opened(started: Workbench) -> None:
    assert "StartOffered" in kinds(started.opened())
    events = started.handle(ask.OpenExample(name="crank-shaper"))
    assert {"FileState", "MotionFound"} <= set(kinds(events))
    assert started.text == lw.example_text("crank-shaper")
    assert "StartOffered" not in kinds(started.opened())


def test_the_blank_sheet_is_opened_under_a_free_name(started: Workbench, tmp_path: Path) -> None:
    (tmp_path / "untitled.toml").write_text("format = 1\n", encoding="utf-8")
    events = started.handle(ask.OpenExample(name=""))
    state = next(event for event in events if isinstance(event, FileState))
    assert (state.file, state.unsaved) == ("untitled-2.toml", False)
    assert (tmp_path / "untitled.toml").read_text(encoding="utf-8") == "format = 1\n"


def test_what_is_opened_is_saved_in_a_file_of_its_name(started: Workbench, tmp_path: Path) -> None:
    started.handle(ask.OpenExample(name="four-bar"))
    started.handle(ask.Save())
    written = (tmp_path / "four-bar.toml").read_text(encoding="utf-8")
    assert written == lw.example_text("four-bar")


def test_unsaved_changes_are_not_left_without_a_word(started: Workbench) -> None:
    started.handle(ask.OpenExample(name="four-bar"))
    started.handle(ask.SetNumber(name="O2 A", value=41.0))
    kept = started.text
    (refused,) = started.handle(ask.OpenExample(name="jansen-leg"))
    assert isinstance(refused, tell.Refused)
    assert "not saved" in refused.message
    assert started.text == kept
    started.handle(ask.OpenExample(name="jansen-leg", discard=True))
    assert started.text == lw.example_text("jansen-leg")
    assert isinstance(started.handle(ask.Undo())[0], tell.Refused)  # a history of its own


def test_an_unknown_name_changes_nothing(started: Workbench) -> None:
    started.handle(ask.OpenExample(name="four-bar"))
    (refused,) = started.handle(ask.OpenExample(name="../four-bar"))
    assert isinstance(refused, tell.Refused)
    assert started.text == lw.example_text("four-bar")


def test_so_many_names_are_taken_that_a_file_must_be_removed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(Path, "exists", lambda path: True)
    with pytest.raises(InputError, match="remove some of these files"):
        new_file()


def test_the_pictures_show_the_library_as_it_is() -> None:
    names = [name for name in lw.examples() if not name.startswith("newton-")]
    assert [one["name"] for one in LIBRARY] == names
    for one in LIBRARY:
        described = lw.example(one["name"]).description
        expected = (described.name, described.purpose, described.family)
        assert (one["title"], one["purpose"], one["family"]) == expected


@pytest.mark.parametrize("name", ["four-bar", "crank-shaper", "planetary-gear", "jansen-leg"])
def test_a_picture_is_that_of_its_mechanism(name: str) -> None:
    (kept,) = (one["picture"] for one in LIBRARY if one["name"] == name)
    made = entry(name)["picture"]
    assert {key: made[key] for key in made if key not in ("frames", "traces")} == {
        key: kept[key] for key in kept if key not in ("frames", "traces")
    }
    pairs = zip(made["frames"], kept["frames"], strict=True)
    rounded = max(abs(a - b) for new, old in pairs for a, b in zip(new, old, strict=True))
    assert rounded <= 1


def test_a_visitor_begins_with_the_library_and_returns_to_it(
    started: Workbench, serve: Callable[[Workbench], LiveServer], watched: Callable[..., Any]
) -> None:
    server = serve(started)
    page = watched((f"http://127.0.0.1:{server.port}/",))
    page.set_default_timeout(10_000)
    page.goto(server.address)
    page.get_by_role("searchbox").fill("quick return")
    shown = page.locator(".lw-families .lw-card")
    assert {"crank-shaper", "whitworth"} & set(
        shown.evaluate_all("cards => cards.map((card) => card.dataset.example)")
    )
    assert shown.count() < len(LIBRARY) / 4
    page.locator(".lw-families [data-example=crank-shaper]").click()
    page.locator(".lw-bar", has_text="crank-shaper").wait_for()
    page.locator(".lw[data-row]").wait_for()
    assert page.locator(".lw-start").count() == 0
    assert started.text == lw.example_text("crank-shaper")
    page.reload()
    page.locator(".lw[data-row]").wait_for()
    assert page.locator(".lw-start").count() == 0
    page.get_by_role("button", name="New: another mechanism").click()
    page.get_by_role("button", name="Back", exact=True).click()
    assert started.text == lw.example_text("crank-shaper")
    page.get_by_role("button", name="New: another mechanism").click()
    page.locator(".lw-blank").click()
    page.locator(".lw-tools [aria-pressed=true]", has_text="Link").wait_for()
    assert started.text == new_file().text
