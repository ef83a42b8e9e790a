"""Blocks on pages are run, and faults of pages found."""

from __future__ import annotations

from pathlib import Path

import pytest

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
