"""Files that move: what is in them, and what is refused."""

from __future__ import annotations

import io
import shutil
import sys
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import linkwork as lw
from linkwork.app import FilmOptions
from linkwork.app.pages.animation import animation, check_animation
from linkwork.app.pages.moving_scene import MovingScene
from linkwork.core.drawing import Arc, Role, Scene

_FEW = FilmOptions(rows=6, fps=20, dpi=40)


def frames_of(film: Image.Image) -> int:
    found: int = getattr(film, "n_frames")  # noqa: B009 - films have it only
    return found


@pytest.fixture(scope="module")
def motion() -> lw.Motion:
    return lw.example("four-bar").sweep(certify=False)


@pytest.mark.parametrize("name", ["rapier-drive-limited", "crank-slider"])
def test_arrows_of_inputs_point_the_way_they_run(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    shown: list[tuple[int, bool]] = []
    inner = MovingScene.at

    def at(self: MovingScene, row: int, *, turned: bool = False) -> Scene:
        scene = inner(self, row, turned=turned)
        (arrow,) = scene.select(Arc, Role.INPUT)
        shown.append((row, arrow.sweep > 0))
        return scene

    monkeypatch.setattr(MovingScene, "at", at)
    motion = lw.example(name).cycle()
    animation({"motion": motion}, "gif", options=FilmOptions(rows=30, dpi=20))
    del shown[:-30]  # where names were tried
    values = next(iter(motion.inputs.values()))[[row for row, _ in shown]]
    rises = np.remainder(np.diff(values) + 180, 360) - 180 > 0
    assert [up for _, up in shown[:-1]] == rises.tolist()
    assert set(rises) == ({True, False} if name == "rapier-drive-limited" else {False})


@pytest.mark.parametrize("kind", ["gif", "apng", "webp"])
def test_films_repeat_one_cycle(kind: str, motion: lw.Motion) -> None:
    film = Image.open(io.BytesIO(animation({"motion": motion}, kind, options=_FEW)))
    assert frames_of(film) == 6
    assert film.info["loop"] == 0
    pictures = []
    for frame in range(6):
        film.seek(frame)
        pictures.append(np.asarray(film.convert("RGB"), dtype=int))
        if kind != "webp":
            assert film.info["duration"] == 50
    changed = [(np.abs(a - b).max(axis=2) > 60).mean() for a, b in pairwise(pictures)]
    assert min(changed) > 0.002  # the mechanism moves,
    assert max(changed) < 0.2  # and the page stands still


@pytest.mark.skipif(shutil.which("ffmpeg") is None, reason="ffmpeg is not on the PATH")
def test_mp4_is_written_by_ffmpeg(motion: lw.Motion) -> None:
    content = animation({"motion": motion}, "mp4", options=_FEW)
    assert content[4:8] == b"ftyp"
    assert len(content) > 2000


def test_an_open_motion_is_shown_to_and_fro() -> None:
    part = lw.example("four-bar").sweep(to=90, certify=False)
    film = Image.open(io.BytesIO(animation({"motion": part}, "gif", options=_FEW)))
    assert frames_of(film) == 10  # six there, four back


def test_progress_is_told(motion: lw.Motion) -> None:
    told: list[float] = []
    animation({"motion": motion}, "gif", options=_FEW, progress=told.append)
    assert told == pytest.approx([k / 6 for k in range(1, 7)])


def test_mechanism_writes_any_of_them_by_the_name_of_the_file(tmp_path: Path) -> None:
    four_bar = lw.example("four-bar")
    four_bar.animate(tmp_path / "page.html")
    assert "<!doctype html>" in (tmp_path / "page.html").read_text("utf-8")
    four_bar.animate(tmp_path / "film.GIF", options=_FEW)
    assert (tmp_path / "film.GIF").read_bytes()[:6] == b"GIF89a"


@pytest.mark.parametrize(
    ("name", "options", "message"),
    [
        (
            "x.avi",
            FilmOptions(),
            r"cannot write \"x.avi\": the suffix of an animation is one of .html, .gif",
        ),
        ("x.gif", FilmOptions(fps=0), r"more than 0 and at most 240 frames per second, got 0$"),
        ("x.gif", FilmOptions(fps=60), r"a GIF plays at most 50 frames per second, not 60"),
        ("x.mp4", FilmOptions(rows=1), r"a film needs at least 2 rows, not 1"),
    ],
)
def test_what_makes_no_sense_is_refused(name: str, options: FilmOptions, message: str) -> None:
    with pytest.raises(lw.InputError, match=message):
        check_animation(name, options)


def test_missing_programs_are_named_with_their_remedy(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(shutil, "which", lambda name: None)
    with pytest.raises(lw.MissingPackageError, match="MP4 needs the program ffmpeg"):
        check_animation("x.mp4")
    monkeypatch.setitem(sys.modules, "PIL", None)
    with pytest.raises(lw.MissingPackageError, match=r"pip install \"linkwork\[plot\]\""):
        check_animation("x.gif")


def test_a_mechanism_that_never_closes_has_nothing_to_show(motion: lw.Motion) -> None:
    apart = lw.example("four-bar").changed(lengths={"O2 A": 40, "A B": 10, "O4 B": 10})
    with pytest.raises(lw.InputError, match="no position was found"):
        animation({"motion": apart.sweep()}, "html")
    with pytest.raises(lw.InputError, match="no position was found"):
        animation({"motion": apart.sweep()}, "gif", options=_FEW)
    both = animation({"apart": apart.sweep(), "whole": motion}, "gif", options=_FEW)
    assert frames_of(Image.open(io.BytesIO(both))) == 6


def test_a_motion_writes_itself(tmp_path: Path) -> None:
    motion = lw.example("four-bar").sweep(to=20)
    motion.animate(tmp_path / "part.html")
    motion.animate(str(tmp_path / "part.gif"), options=FilmOptions(rows=3, dpi=20))
    page = (tmp_path / "part.html").read_bytes()
    assert page == animation({"motion": motion}, "html")
    assert (tmp_path / "part.gif").read_bytes().startswith(b"GIF89a")
    with pytest.raises(lw.InputError, match=r"^cannot write \"part\.bmp\": the suffix of an "):
        motion.animate("part.bmp")
