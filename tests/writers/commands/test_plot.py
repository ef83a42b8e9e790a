"""``linkwork plot`` and ``sweep --plot``."""

from __future__ import annotations

from pathlib import Path

import pytest

from linkwork import example_text
from tests.core.commands.conftest import Run
from tests.core.drawing.pages import svg_texts


def _library(folder: Path, name: str) -> str:
    (folder / f"{name}.toml").write_text(example_text(name), encoding="utf-8")
    return f"{name}.toml"


def _texts(folder: Path, name: str) -> list[str]:
    return svg_texts((folder / name).read_bytes())


@pytest.mark.parametrize("suffix", ["png", "svg", "pdf"])
def test_plot_writes_a_picture(run: Run, folder: Path, suffix: str) -> None:
    done = run("plot", "four-bar.toml", "-o", f"x.{suffix}", "--step", "10")
    assert (done.exit_code, done.stdout) == (0, f"Wrote x.{suffix}.\n")
    assert (folder / f"x.{suffix}").stat().st_size > 1000


@pytest.mark.parametrize(
    ("words", "shown"),
    [
        (("--of", "s", "--of", "s.velocity", "--against", "time"), ["time [s]", "s [mm]"]),
        (("--kind", "polar"), ["s [mm]", "330°"]),
        (("--kind", "path", "--of", "A"), ["x [mm]", "y [mm]", "180°"]),
        (("--kind", "hodograph"), ["velocity of A", "aₓ [mm/s²]", "pole"]),
        (("--kind", "transmission"), ["B: rod, piston", "recommended: 40° to 140°"]),
        (("--kind", "circuits", "--of", "s"), ["2 circuits", "circuit 2"]),
        (("--kind", "branches", "--of", "s"), ["2 branches in 2 circuits", "circuit 2 branch 1"]),
        (("--theme", "dark", "--wrapped"), ["rod [deg]"]),
    ],
)
def test_every_kind_is_plotted(
    run: Run, folder: Path, words: tuple[str, ...], shown: list[str]
) -> None:
    file = _library(folder, "slider-crank-engine")
    done = run("plot", file, "-o", "x.svg", *words)
    assert (done.exit_code, done.stderr) == (0, "")
    texts = _texts(folder, "x.svg")
    assert [text for text in shown if text not in texts] == []


def test_rows_without_a_position_are_counted_beside_the_plot(run: Run, folder: Path) -> None:
    file = _library(folder, "rapier-drive-limited")
    done = run("plot", file, "-o", "x.svg", "--of", "s16")
    assert done.exit_code == 1
    assert done.stdout == "Wrote x.svg.\n"
    assert "52 of 361 positions were not found" in done.stderr
    assert "dead point" in _texts(folder, "x.svg")


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (
            ("--of", "roker"),
            'Error: there is no "roker" (nearest: rocker, coupler, crank; all: linkwork\n'
            "  quantities FILE)\n",
        ),
        (
            ("--kind", "circuits", "--through", "--from", "10"),
            "Error: --kind circuits shows whole circuits: leave out --from, --through\n",
        ),
        (
            ("--kind", "branches", "--against", "time", "--change-points", "turn"),
            "Error: --kind branches shows whole circuits: leave out --against,\n"
            "  --change-points\n",
        ),
    ],
)
def test_what_cannot_be_plotted_is_told(
    run: Run, folder: Path, words: tuple[str, ...], message: str
) -> None:
    done = run("plot", "four-bar.toml", "-o", "x.svg", *words)
    assert (done.exit_code, done.stdout, done.stderr) == (2, "", message)
    assert not (folder / "x.svg").exists()


def test_a_time_without_a_speed_is_told(run: Run, folder: Path) -> None:
    done = run("plot", _library(folder, "klann-leg"), "-o", "x.svg", "--against", "time")
    assert (done.exit_code, done.stdout) == (2, "")
    assert done.stderr == (
        "Error: a plot over time needs the speed of crank: set it in [input], or plot\n"
        "  against crank\n"
    )


def test_the_mechanism_is_not_overwritten(run: Run, folder: Path) -> None:
    done = run("plot", "four-bar.toml", "-o", "four-bar.toml")
    assert done.exit_code == 2
    assert "the suffix of a picture is one of .png," in done.stderr


def test_sweep_plots_unknowns_beside_its_table(run: Run, folder: Path) -> None:
    done = run("sweep", "four-bar.toml", "--plot", "x.svg", "--csv", "x.csv")
    assert done.exit_code == 0
    assert done.stdout.endswith("Wrote x.svg: unknowns and outputs over the input.\n")
    assert "coupler, rocker, μ [deg]" in _texts(folder, "x.svg")


def test_sweep_refuses_a_plot_of_an_unknown_format(run: Run, folder: Path) -> None:
    done = run("sweep", "four-bar.toml", "--plot", "x.gif")
    assert done.exit_code == 2
    assert 'cannot write "x.gif"' in done.stderr
