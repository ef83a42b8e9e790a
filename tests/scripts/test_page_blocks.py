"""Blocks on pages are run, and faults of pages found."""

from __future__ import annotations

from pathlib import Path

import pytest

from scripts.docsite.app_check import app_links, check_app
from scripts.docsite.page_blocks import check_page
from scripts.docsite.site_check import Site, check_site


def test_blocks_share_names_and_broken_ones_are_reported(tmp_path: Path) -> None:
    page = tmp_path / "page.md"
    page.write_text(
        "```python\nx = 1\n```\n\n```python\nx + y\n```\n\n```sh\nlinkwork check no-such\n```\n\n"
        "<!-- before: y = 2 -->\n```python\nassert x + y == 3\n```\n\n"
        "<!-- not run: it takes a day -->\n```sh\nlinkwork sweep no-such\n```\n\n"
        "```toml\na = 1 +\n```\n\n```sh\nlinkwork check four-bar.toml\n```\n\n"
        "```text\nlinkwork\n```\n\n```\nlinkwork check no-such\n```\n"
    )
    checked = check_page(page)
    assert checked.run == 3
    assert checked.left == ("page.md:19: it takes a day",)
    places = [error.split(": ")[0] for error in checked.errors]
    assert places == ["page.md:35", "page.md:5", "page.md:9", "page.md:23"]


def test_a_command_whose_program_is_missing_is_left_out_by_name(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("shutil.which", lambda name: None)
    page = tmp_path / "page.md"
    page.write_text("```sh\ntrue && octave --eval four_bar\nno-such-program\n```\n")
    checked = check_page(page)
    assert "'no-such-program' ended with 127" in checked.errors[0]
    page.write_text("```sh\ntrue && octave --eval four_bar\n```\n")
    assert check_page(page).left == (
        "page.md:1: true && octave --eval four_bar (octave is not installed)",
    )


@pytest.mark.extended
def test_faults_of_a_page_are_found(tmp_path: Path) -> None:
    (tmp_path / "index.html").write_text(
        '<!doctype html><html lang="en"><title>T</title><img src="no.png" alt="none">'
        '<img src="https://example.org/x.png" alt="x"><div style="width: 600px">wide</div></html>'
    )
    faults = check_site(Site(folder=tmp_path))
    assert any("404" in fault for fault in faults)
    assert any("foreign: https://example.org/x.png" in fault for fault in faults)
    assert any("broken image: no.png" in fault for fault in faults)
    wide = [fault for fault in faults if "wider than the window" in fault]
    assert wide == ["index.html at 390: 218 px wider than the window"]


@pytest.mark.extended
def test_links_to_an_app_have_to_move_and_to_be_editable(tmp_path: Path) -> None:
    (tmp_path / "app").mkdir()
    (tmp_path / "app/index.html").write_text(
        '<!doctype html><title>T</title><div class="lw" data-row="0">shown</div><script>'
        'const [shown] = document.getElementsByClassName("lw");'
        'if (location.hash !== "#example=still") setInterval(() => shown.dataset.row++, 10);'
        'if (location.hash === "#example=a&b=1")'
        ' shown.innerHTML = "<div data-number=l><input></div>";</script>'
    )
    (tmp_path / "deep").mkdir()
    (tmp_path / "deep/page.html").write_text(
        '<a href="../app/index.html#example=still">still</a>'
        '<a href="../app/index.html#example=fixed">no numbers</a>'
        '<a href="../app/index.html#example=a&amp;b=1">moves</a>'
    )
    links = [f"app/index.html#example={name}" for name in ("a&b=1", "fixed", "still")]
    assert app_links(tmp_path) == links
    fixed, still = check_app(tmp_path, patience=6000)  # a busy machine opens a page in seconds
    assert fixed == f"{links[1]}: no number can be changed"
    assert still == f"{links[2]}: Page.wait_for_function: Timeout 6000ms exceeded."
