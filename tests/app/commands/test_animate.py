"""What ``linkwork animate`` writes, says and refuses."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.core.commands.conftest import Run


def test_animate_writes_one_page(run: Run, folder: Path) -> None:
    done = run("animate", "four-bar.toml", "-o", "x.html")
    page = (folder / "x.html").read_text(encoding="utf-8")
    size = round(len(page.encode()) / 1000)
    assert done.exit_code == 0
    assert done.stdout == f"Wrote x.html: 361 positions; open it in a browser, {size} kB.\n"
    assert page.startswith("<!doctype html>")
    assert "default-src 'none'" in page
    assert "http" not in page.replace("http://www.w3.org/2000/svg", "").replace("http-equiv", "")


def test_animate_all_shows_every_circuit(run: Run, folder: Path) -> None:
    done = run("animate", "four-bar.toml", "-o", "x.html", "--all", "--no-certificates")
    assert done.stdout.startswith("Wrote x.html: 2 circuits, 722 positions;")


def test_animate_writes_a_film(run: Run, folder: Path) -> None:
    done = run("animate", "four-bar.toml", "-o", "x.gif", "--rows", "3", "--fps", "10")
    assert done.exit_code == 0
    assert done.stdout.startswith("Wrote x.gif: one cycle, ")
    assert (folder / "x.gif").read_bytes().startswith(b"GIF89a")


def test_animate_goes_on_through_dead_points_where_the_range_is_not_reached(
    run: Run, folder: Path
) -> None:
    done = run("animate", "four-bar.toml", "-o", "x.html", "--set", "a=95")
    assert done.exit_code == 0
    whole = int(done.stdout.removeprefix("Wrote x.html: ").split()[0])
    assert whole > 361


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (
            ("x.avi",),
            'cannot write "x.avi": the suffix of an animation is one of .html, .gif',
        ),
        (
            ("x.gif", "--all"),
            "--all needs a page: use the suffix .html",
        ),
        (("x.html", "--rows", "9"), "--rows is for films only: a page shows all rows"),
        (("x.gif", "--force", "B=1,2"), "--force needs a page: use the suffix .html"),
        (("x.html", "--force", "Q=1,2"), 'there is no point "Q" for a force (points: '),
        (("x.html", "--force", "B=1,2,3 N"), "--force B=1,2,3 N: a force is a point and two "),
        (("x.html", "--force", "B=1"), "--force B=1: a force is a point and two components, "),
        (
            ("x.html", "--all", "--configuration", "open"),
            "--all shows every circuit: leave out --configuration",
        ),
        (("nowhere/x.html",), 'cannot write "nowhere/x.html": there is no folder "nowhere"'),
        (("four-bar.toml",), 'cannot write "four-bar.toml": the suffix of an animation is one of'),
    ],
)
def test_animate_refuses_before_anything_is_computed(
    run: Run, folder: Path, arguments: tuple[str, ...], message: str
) -> None:
    before = sorted(folder.iterdir())
    done = run("animate", "four-bar.toml", "-o", *arguments)
    assert done.exit_code == 2
    assert message in done.stderr
    assert sorted(folder.iterdir()) == before


def test_animate_without_a_position_writes_nothing(run: Run, folder: Path) -> None:
    done = run("animate", "four-bar.toml", "-o", "x.html", "--set", "a=400")
    assert done.exit_code == 1
    assert "Did not write x.html: there is no position to draw." in done.stderr
    assert not (folder / "x.html").exists()
