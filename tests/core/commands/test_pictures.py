"""What ``draw``, ``sweep --draw``, ``configurations --draw`` and ``circuits --draw`` write."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import linkwork as lw
from linkwork import example_text
from tests.core.commands.conftest import Run


def _svg(folder: Path, name: str) -> str:
    return (folder / name).read_text(encoding="utf-8")


def _library(folder: Path, name: str) -> str:
    (folder / f"{name}.toml").write_text(example_text(name), encoding="utf-8")
    return f"{name}.toml"


# ------------------------------------------------------------------ draw


@pytest.mark.parametrize("suffix", ["png", "svg", "pdf"])
def test_draw_writes_a_picture(run: Run, folder: Path, suffix: str) -> None:
    done = run("draw", "four-bar.toml", "-o", f"x.{suffix}", "--at", "90")
    assert (done.exit_code, done.stdout) == (0, f"Wrote x.{suffix}.\n")
    begin = {"png": b"\x89PNG", "svg": b"<?xml", "pdf": b"%PDF"}[suffix]
    assert (folder / f"x.{suffix}").read_bytes().startswith(begin)


def test_draw_shows_the_position_that_was_asked(run: Run, folder: Path) -> None:
    for name, at in (("a", "90"), ("b", "90"), ("c", "100")):
        assert run("draw", "four-bar.toml", "-o", f"{name}.svg", "--at", at).exit_code == 0
    a, b, c = (_svg(folder, f"{name}.svg") for name in "abc")
    assert a == b
    assert a != c
    assert "<!-- crank = 100° -->" in c


@pytest.mark.parametrize(
    ("option", "role"),
    [
        ("--vectors", "vector:O2A∠θ_crank"),
        ("--velocities", "velocity:A"),
        ("--accelerations", "acceleration:B"),
        ("--force=B=0,-9.81", "force:B"),
        ("--centres", "centre:I₁₂"),
        ("--centrodes=coupler", "moving_centrode:coupler"),
        ("--dimensions", "dimension:rocker"),
        ("--trace=B", "trace:B"),
        ("--trace=B --speed", "speed_trace:B"),
        ("--link-names", "link_name:coupler"),
    ],
)
def test_draw_shows_what_it_is_asked_for(run: Run, folder: Path, option: str, role: str) -> None:
    name = _library(folder, "four-bar")
    plain = run("draw", name, "-o", "plain.svg")
    asked = run("draw", name, "-o", "asked.svg", *option.split())
    assert (plain.exit_code, asked.exit_code) == (0, 0), asked.stderr
    assert f'id="{role}"' not in _svg(folder, "plain.svg")
    assert f'id="{role}"' in _svg(folder, "asked.svg")


def test_draw_dresses_the_page_in_a_theme(run: Run, folder: Path) -> None:
    name = _library(folder, "four-bar")
    for theme in ("light", "dark"):
        assert run("draw", name, "-o", f"{theme}.svg", "--theme", theme).exit_code == 0
    assert "#15191e" in _svg(folder, "dark.svg")
    assert "#15191e" not in _svg(folder, "light.svg")
    refused = run("draw", name, "-o", "x.svg", "--theme", "dusk")
    assert refused.exit_code == 2
    assert "'light', 'dark'" in refused.stderr


def test_draw_refuses_what_the_mechanism_has_not(run: Run, folder: Path) -> None:
    name = _library(folder, "four-bar")
    for words, said in (
        (("--speed",), "there is no path to colour by speed: name the points to trace"),
        (("--centrodes", "arm"), 'there is no link "arm" (links: ground, crank, coupler, rocker)'),
        (("--trace", "Q"), 'there is no point "Q" to trace'),
    ):
        done = run("draw", name, "-o", "x.svg", *words)
        assert done.exit_code == 2
        assert said in " ".join(done.stderr.split())
        assert not (folder / "x.svg").exists()


def test_draw_shows_equations_without_points_as_vectors(run: Run, folder: Path) -> None:
    text = example_text("rapier-drive")
    bare = re.sub(r"^\[(points|links|trace)\]\n(?:(?!\[).*\n?)*", "", text, flags=re.MULTILINE)
    (folder / "bare.toml").write_text(bare, encoding="utf-8")
    assert run("draw", "bare.toml", "-o", "x.svg").exit_code == 2
    done = run("draw", "bare.toml", "-o", "x.svg", "--vectors")
    assert (done.exit_code, done.stdout) == (0, "Wrote x.svg.\n")
    assert 'id="vector:a2∠θ12"' in _svg(folder, "x.svg")


def test_draw_shows_a_configuration_with_its_own_paths(run: Run, folder: Path) -> None:
    """Of the crossed four-bar, P runs below the ground; of the open one, above it."""
    for name in ("open", "crossed"):
        words = ("four-bar.toml", "-o", f"{name}.svg", "--at", "60", "--configuration", name)
        done = run("draw", *words)
        assert (done.exit_code, done.stdout, done.stderr) == (0, f"Wrote {name}.svg.\n", "")
    run("draw", "four-bar.toml", "-o", "plain.svg", "--at", "60")
    ways = {name: _svg(folder, f"{name}.svg") for name in ("open", "crossed", "plain")}
    assert ways["open"] != ways["crossed"]
    # the guess is open: the same position, found in another way
    assert _middle(ways["open"], "pin:B") == pytest.approx(_middle(ways["plain"], "pin:B"))
    for text in ways.values():
        assert "<!-- crank = 60° -->" in text
        _, ground = _middle(text, "pin:O2")
        _, rocker = _middle(text, "pin:B")
        _, path = _middle(text, "trace:P")
        above = text is not ways["crossed"]
        assert (rocker < ground) == above  # an SVG counts downwards
        assert (path < ground) == above


def test_draw_takes_the_name_of_a_branch(run: Run, folder: Path) -> None:
    file = _library(folder, "rapier-drive")
    done = run("draw", file, "-o", "a.svg", "--configuration", "circuit 3 branch 2")
    assert (done.exit_code, done.stdout) == (0, "Wrote a.svg.\n")
    run("draw", file, "-o", "b.svg")
    a, b = (_svg(folder, f"{name}.svg") for name in "ab")
    assert "<!-- θ₁₂ = 60° -->" in a
    assert a != b


@pytest.mark.parametrize(
    ("words", "code", "message"),
    [
        (
            ("four-bar.toml", "--configuration", "cross"),
            2,
            'Error: there is no configuration "cross" of Four-bar at this input\n'
            "  (configurations: crossed, open)\n",
        ),
        (
            ("four-bar.toml", "--configuration", "circuit 4"),
            2,
            'Error: there is no "circuit 4" of Four-bar (branches: circuit 1 branch 1,\n'
            "  circuit 2 branch 1)\n",
        ),
        (
            ("double-rocker.toml", "--configuration", "open", "--at", "0"),
            1,
            'Error: loop "O2 A B O4" cannot be closed at crank = 0°: near the guess a gap of\n'
            '  at least 10 mm remains; the loops just close with a = 60 mm (10 shorter) or "A\n'
            '  B" = 110 mm (10 shorter) or "O4 B" = 90 mm (10 longer); nearest reachable\n'
            "  input: crank = 18.19487234° (dead point); no configuration exists there\n",
        ),
        (
            ("five-bar.toml", "--configuration", "open", "--at", "left=90"),
            2,
            "Error: no value for the input right: give a value to each input of this\n"
            "  mechanism (left, right)\n",
        ),
        (
            ("cubic.toml", "--configuration", "open"),
            2,
            'Error: "A cubic" has no points to draw: add [points] with the coordinates of its\n'
            "  pins\n",
        ),
    ],
)
def test_a_configuration_that_does_not_exist_is_told_as_solve_tells_it(
    run: Run, folder: Path, words: tuple[str, ...], code: int, message: str
) -> None:
    done = run("draw", *words, "-o", "x.svg")
    assert (done.exit_code, done.stdout, done.stderr) == (code, "", message)
    assert not (folder / "x.svg").exists()


# ------------------------------------------------------------------ sweep


def test_a_drawn_sweep_shows_the_motion(run: Run, folder: Path) -> None:
    done = run("sweep", "four-bar.toml", "--csv", "a.csv", "--draw", "a.svg")
    assert done.stdout.endswith(
        "\nWrote a.csv: 361 rows.\nWrote a.svg: the start position, and the motion faintly.\n"
    )
    text = _svg(folder, "a.svg")
    assert text.count('id="link:crank"') == 1
    assert text.count('id="faint-link:crank"') == 4
    assert text.count('id="trace:P"') == 1
    assert "<!-- crank = 30°; faint: 0° to 360° -->" in text
    assert 'id="limit:' not in text
    assert run("draw", "four-bar.toml", "-o", "b.svg").exit_code == 0
    assert "faint" not in _svg(folder, "b.svg")


def test_a_drawn_sweep_marks_its_limits(run: Run, folder: Path) -> None:
    done = run("sweep", "double-rocker.toml", "--draw", "a.svg")
    assert done.exit_code == 1
    assert done.stdout.endswith("\nWrote a.svg: the start position, and the motion faintly.\n")
    text = _svg(folder, "a.svg")
    assert text.count('id="limit:A"') == 2
    assert text.count('id="faint-link:crank"') == 6
    assert "<!-- dead point 18.1949° -->" in text
    assert "<!-- dead point 341.805° -->" in text
    assert "; faint: 18.1949° to 341.805° -->" in text


def test_a_drawn_sweep_shows_the_range_and_the_configuration_that_were_asked(
    run: Run, folder: Path
) -> None:
    options = ("--from", "20", "--to", "80", "--draw")
    run("sweep", "four-bar.toml", *options, "a.svg")
    run("sweep", "four-bar.toml", "--configuration", "crossed", *options, "b.svg")
    a, b = (_svg(folder, f"{name}.svg") for name in "ab")
    assert "<!-- crank = 30°; faint: 20° to 80° -->" in a
    assert _middle(a, "pin:B")[1] < _middle(a, "pin:O2")[1]
    assert _middle(b, "pin:B")[1] > _middle(b, "pin:O2")[1]


def test_a_sweep_out_of_reach_draws_its_start(run: Run, folder: Path) -> None:
    done = run("sweep", "double-rocker.toml", "--from", "0", "--to", "10", "--draw", "a.svg")
    assert done.exit_code == 1
    assert done.stdout.endswith("\nWrote a.svg: the start position.\n")
    assert "faint" not in _svg(folder, "a.svg")


def test_what_cannot_be_drawn_is_refused_before_the_sweep(
    run: Run, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    file = str(folder / "equations.toml")
    lw.example("coupled-six-link").changed(points={}, links={}, trace=()).save(file)
    _refuse(monkeypatch, "sweep", "configurations")
    for words in (
        ("sweep", file, "--draw", "a.svg", "--csv", "a.csv"),
        ("configurations", file, "--draw", "a.svg"),
        ("draw", file, "-o", "a.svg"),
    ):
        done = run(*words)
        assert (done.exit_code, done.stdout) == (2, "")
        assert done.stderr == (
            'Error: "Six-link mechanism with two coupled loops" has no points to draw: add\n'
            "  [points] with the coordinates of its pins\n"
        )
    assert not list(folder.glob("a.*"))


# ------------------------------------------------------------------ configurations


def test_drawn_configurations_stand_side_by_side(run: Run, folder: Path) -> None:
    done = run("configurations", "four-bar.toml", "--at", "60", "--draw", "a.svg")
    assert done.exit_code == 0
    assert done.stdout.endswith("\n\nWrote a.svg.\n")
    text = _svg(folder, "a.svg")
    assert text.count('id="link:crank"') == 2
    for name in ("open", "crossed", "Four-bar", "2 configurations at crank = 60°"):
        assert text.count(f"<!-- {name} -->") == 1


def test_no_configuration_is_not_drawn(run: Run, folder: Path) -> None:
    done = run("configurations", "open.toml", "--draw", "a.svg")
    assert done.exit_code == 1
    assert "\n\nDid not write a.svg: there is nothing to draw.\n" in done.stdout
    assert not (folder / "a.svg").exists()


# ------------------------------------------------------------------ circuits


def test_drawn_circuits_show_the_unknowns_or_what_is_asked(run: Run, folder: Path) -> None:
    done = run("circuits", "double-rocker.toml", "--draw", "a.svg")
    assert done.exit_code == 0
    assert done.stdout.endswith("\n\nWrote a.svg.\n")
    text = _svg(folder, "a.svg")
    for label in ("coupler [deg]", "rocker [deg]", "crank [deg]", "circuit 1", "dead point"):
        assert f"<!-- {label} -->" in text
    run("circuits", "double-rocker.toml", "--draw", "b.svg", "--of", "P.x", "--of", "mu")
    text = _svg(folder, "b.svg")
    assert re.findall(r"<!-- (.*\]) -->", text) == ["P.x [mm]", "crank [deg]", "μ [deg]"]


def test_unknowns_that_are_left_out_are_told(
    run: Run, monkeypatch: pytest.MonkeyPatch, folder: Path
) -> None:
    monkeypatch.setattr("linkwork.writers.charts.lines.MOST_PANELS", 1)
    done = run("circuits", "four-bar.toml", "--draw", "a.svg")
    assert done.stdout.endswith("\nWrote a.svg: the first 1 of 2 unknowns; --of NAME chooses.\n")
    named = run("circuits", "four-bar.toml", "--draw", "a.svg", "--of", "mu")
    assert named.stdout.endswith("\n\nWrote a.svg.\n")


@pytest.mark.parametrize(
    ("name", "message"),
    [
        (
            "roker",
            'Error: there is no "roker" (nearest: rocker, coupler, crank; all: linkwork\n'
            "  quantities FILE)\n",
        ),
        (
            "crank",
            "Error: --of crank: curves are drawn over the input: name an unknown, a link, an\n"
            "  output or the coordinate of a point\n",
        ),
    ],
)
def test_what_cannot_be_drawn_over_the_input_is_refused_before_circuits_are_sought(
    run: Run, folder: Path, monkeypatch: pytest.MonkeyPatch, name: str, message: str
) -> None:
    _refuse(monkeypatch, "circuits")
    done = run("circuits", "four-bar.toml", "--draw", "a.svg", "--of", "rocker", "--of", name)
    assert (done.exit_code, done.stdout, done.stderr) == (2, "", message)
    assert not (folder / "a.svg").exists()


def _refuse(monkeypatch: pytest.MonkeyPatch, *computations: str) -> None:
    """Let nothing be computed."""

    def fail(*_: object, **__: object) -> None:
        raise AssertionError("computed")

    for name in computations:
        monkeypatch.setattr(f"linkwork.core.api.mechanism.Mechanism.{name}", fail)


def _middle(svg: str, group: str) -> tuple[float, float]:
    """The middle of what is drawn in a group of an SVG, in its pixels."""
    [_, text] = svg.split(f'id="{group}"')
    path = re.search(r'<path d="(.*?)"', text, flags=re.DOTALL)
    assert path is not None
    numbers = [float(number) for number in re.findall(r"-?\d+\.?\d*(?:e-?\d+)?", path[1])]
    xs, ys = numbers[0::2], numbers[1::2]
    return (min(xs) + max(xs)) / 2, (min(ys) + max(ys)) / 2
