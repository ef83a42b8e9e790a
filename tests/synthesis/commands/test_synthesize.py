"""``linkwork synthesize``: counts, files that load back, reasons of refused designs."""

from __future__ import annotations

import json
import re
import shutil
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner

import linkwork as lw
from linkwork.core.commands import terminal as interrupts
from linkwork.core.commands.main import linkwork
from linkwork.synthesis.designs_folder import FolderOptions, task_copy, write_designs

_TASK = Path(__file__).parents[3] / "examples" / "tasks" / "tilt-a-box.toml"


def _run(*arguments: str, code: int = 0, typed: str = "") -> str:
    done = CliRunner().invoke(linkwork, ["synthesize", *arguments], typed)
    assert done.exit_code == code, done.output
    return done.stdout


def test_counts_dyads_and_delivered_designs_are_printed() -> None:
    shown = _run(str(_TASK))
    for line in ("complex                       4 solutions", "proved                        4"):
        assert line in shown
    assert "transmission angle too small  5" in shown
    assert "5 of 12 designs have no defect." in shown
    assert shown.count("proved\n") == 4
    assert max(map(len, shown.splitlines())) <= 80
    # a lower bound is rounded down
    cells = re.findall(r"(?m)^  \d  four-bar +[AB]0 +([\d.]+)", shown)
    delivered = lw.Task.load(_TASK).solve().delivered
    for design, cell in zip(delivered, cells, strict=True):
        assert float(cell) <= design.transmission < float(cell) + 0.001


def test_a_task_to_begin_with_is_solved_by_its_name_unless_a_file_has_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert _run("five-poses", "-o", "designs").startswith("Five poses\n")
    kept = (tmp_path / "designs" / "task.toml").read_text("utf-8")
    assert _run("-", typed=kept) == _run("five-poses")
    Path("five-poses").write_text(_TASK.read_text("utf-8"), "utf-8")
    assert _run("five-poses").startswith("Tilt a box\n")
    runner = CliRunner()
    told = runner.invoke(linkwork, ["synthesize", "four-poses.toml"]).stderr
    assert "linkwork examples four-poses -o four-poses.toml" in told
    for words, what in (("synthesize four-bar", "mechanism"), ("sweep curve", "task")):
        done = runner.invoke(linkwork, words)
        assert done.exit_code == 2
        assert f"this is a {what}: linkwork" in done.stderr


def test_delivered_designs_are_files_that_pass_the_poses(tmp_path: Path) -> None:
    folder, task = tmp_path / "designs", tmp_path / "tilt.toml"
    task.write_text(_TASK.read_text().replace("deliver = 5", "deliver = 2"))
    shown = _run(str(task), "-o", str(folder), "--all", "--draw", "--csv", "--html", "--json")
    data = json.loads(shown)
    assert (data["complex"], data["real"], data["proved"], data["linkages"]) == (4, 4, 4, 6)
    assert data["completeness"] == "PROVED"
    assert [dyad["kind"] for dyad in data["dyads"]] == ["RR"] * 4
    assert (folder / "task.toml").read_text() == task.read_text()
    delivered = [design for design in data["designs"] if design["delivered"]]
    assert len(delivered) == data["delivered"] == 2
    for design in delivered:
        assert design["defects"] == []
        mechanism = lw.load(design["file"])
        motion = mechanism.sweep()
        assert motion.certified.all()
        x, y = (np.asarray(motion[f"P.{axis}"]) for axis in "xy")
        for point in ((0, 0), (40, -40), (100, -80), (170, -110), (260, -140)):
            # rows are a degree apart, and a pose lies between two of them
            assert np.hypot(x - point[0], y - point[1]).min() < 6.0
        assert np.hypot(x[-1] - 260, y[-1] + 140) < 1e-6
        assert Path(design["file"]).with_suffix(".svg").read_text().startswith("<svg")
    refused = [design for design in data["designs"] if design["defects"]]
    assert data["sound"] == 5
    assert len(refused) == len(list((folder / "refused").glob("*.toml"))) == 7
    assert {design["defects"][0]["kind"] for design in refused} == {"transmission", "lengths"}
    table = (folder / "designs.csv").read_text().splitlines()
    assert len(table) == 13
    assert (folder / "index.html").read_text().count("<figure>") == 2


def test_a_forced_synthesis_replaces_its_own_files_alone(tmp_path: Path) -> None:
    home = tmp_path / "home"
    home.mkdir()
    task = home / "task.toml"
    task.write_text(_TASK.read_text())
    mine = {"bracket-2.toml", "photo-2024.svg", "index.html", "tilt-a-box-01.csv", "sweep-01.svg"}
    for name in mine:
        (home / name).write_text("mine")
    refused = CliRunner().invoke(linkwork, ["synthesize", str(task), "-o", str(home)])
    assert refused.exit_code == 2
    told = " ".join(refused.stderr.split())
    assert told.endswith(
        'is not empty: it holds "bracket-2.toml"; name a new folder, or add --force (in Python '
        "force=True), which replaces the files of an earlier synthesis and keeps all others"
    )
    _run(str(task), "-o", str(home), "--force", "--csv", "--draw")
    task.write_text(_TASK.read_text().replace("deliver = 5", "deliver = 2"))
    # the task in the folder is solved again, from there
    _run(str(task), "-o", str(home), "--force")
    designs = {"tilt-a-box-01.toml", "tilt-a-box-02.toml"}
    shown = {path.name for path in home.iterdir()}
    assert shown == mine | designs | {"task.toml", "designs.csv"}
    assert {(home / name).read_text() for name in mine} == {"mine"}


def test_a_synthesis_without_a_delivered_design_keeps_earlier_ones(tmp_path: Path) -> None:
    folder, task = tmp_path / "designs", tmp_path / "tilt.toml"
    task.write_text(_TASK.read_text().replace("least = 30", "least = 85"))
    for force in ((), ("--force",)):  # refused designs alone are replaced
        shown = _run(str(task), "-o", str(folder), "--all", *force, code=1)
        assert f"Wrote 12 designs and task.toml in {folder}" in " ".join(shown.split())
    assert len(list(folder.rglob("*.toml"))) == 13
    _run(str(_TASK), "-o", str(folder), "--force")
    before = {path: path.read_bytes() for path in folder.iterdir()}
    assert len(before) == 6
    for more in ((), ("--all",)):
        shown = _run(str(task), "-o", str(folder), "--force", *more, code=1)
        told = f"Wrote nothing: {folder} keeps its earlier designs and their task."
        assert told in " ".join(shown.split())
        assert {path: path.read_bytes() for path in folder.iterdir()} == before


def test_a_forced_folder_has_no_empty_folder_of_refused_designs(tmp_path: Path) -> None:
    found, folder = lw.Task.load(_TASK).solve(), tmp_path / "designs"
    found.save(folder, refused=True)
    found.save(folder, force=True, refused=True)
    assert (folder / "refused").is_dir()
    found.save(folder, force=True)
    assert not (folder / "refused").exists()


@pytest.mark.parametrize(
    ("name", "stem"),
    [
        ("Größe_2", "größe-2"),
        ("e\u0301tau", "étau"),
        ("機構/設計", "機構-設計"),
        ("…", "design"),
        ("x" * 300, "x" * 160),
        ("\N{CJK UNIFIED IDEOGRAPH-20000}" * 80, "\N{CJK UNIFIED IDEOGRAPH-20000}" * 40),
        ("प्रक्षेपण", "प्रक्षेपण"),
    ],
)
def test_files_keep_the_letters_of_the_task(name: str, stem: str, tmp_path: Path) -> None:
    text = _TASK.read_text().replace('name   = "Tilt a box"', f'name = "{name}"')
    found = lw.Task.loads(text).solve()
    files = write_designs(found, tmp_path / "out", FolderOptions(csv=True, refused=True))
    assert Path(files[0]).name == f"{stem}-01.toml"
    table = (tmp_path / "out" / "designs.csv").read_text(encoding="utf-8").splitlines()
    named = [row.rsplit(",", 1)[1] for row in table[1:]]
    assert all((tmp_path / "out" / name).is_file() for name in named)
    assert f"{stem}-01.toml" in named
    assert f"refused/{stem}-01.toml" in named


@pytest.mark.parametrize(
    ("place", "copied"),
    [
        ("data/foot.csv", "data/foot.csv"),
        ("../foot.csv", "curve/foot.csv"),
        ("{}/foot.csv", "curve/foot.csv"),
        ("designs.csv", "curve/designs.csv"),
        ("refused/foot.csv", "curve/foot.csv"),
        ("Index.html/foot.csv", "curve/foot.csv"),
    ],
)
def test_the_curve_of_a_task_is_copied_into_the_folder_of_its_designs(
    tmp_path: Path, place: str, copied: str
) -> None:
    home = tmp_path / "home"
    home.mkdir()
    file = home / place.format(tmp_path)
    file.parent.mkdir(exist_ok=True)
    file.write_text("0,0\n4,1\n6,4\n3,7\n-1,4\n")
    text = (
        'format = 1\ntask = "path"\nimprove = { starts = 2 }\n'
        f'curve = {{ file = "{place.format(tmp_path)}" }} # mine\n'
    )
    (home / "task.toml").write_text(text)
    before = file.stat().st_mtime_ns
    out = tmp_path / "other" / "out"
    shown = _run(str(home / "task.toml"), "-o", str(out), "--csv")
    assert f"task.toml and {copied} in" in " ".join(shown.split())
    assert file.stat().st_mtime_ns == before
    saved = (out / "task.toml").read_text()
    assert saved == text.replace(place.format(tmp_path), copied)
    moved = out.rename(tmp_path / "moved")
    file.unlink()
    again = lw.Task.load(moved / "task.toml").solve()
    again.save(moved, force=True)
    mine = moved / Path(copied).parent / "mine.csv"
    mine.write_text("1,2\n")
    # another curve: other files stay
    (home / "hand.csv").write_text("0,0\n4,1\n6,5\n3,7\n-1,4\n")
    (home / "task.toml").write_text(text.replace(place.format(tmp_path), "hand.csv"))
    lw.Task.load(home / "task.toml").solve().save(moved, force=True)
    assert (moved / "hand.csv").exists()
    assert mine.exists()


@pytest.mark.parametrize(
    ("place", "copied"),
    [
        ("bar.toml", "bar.toml"),
        ("../bar.toml", "mechanism/bar.toml"),
        ("task-01.toml", "mechanism/task-01.toml"),
    ],
)
def test_the_mechanism_of_a_task_is_copied_into_the_folder_of_its_designs(
    tmp_path: Path, place: str, copied: str
) -> None:
    home = tmp_path / "home"
    home.mkdir()
    (home / place).write_text(lw.example_text("slider-crank"))
    text = (
        f'format = 1\ntask = "improve"\nmechanism = "{place}"\n[improve]\nstarts = 1\n'
        'goals = [{ of = "stroke(d)", target = 70 }]\n'
    )
    (home / "task.toml").write_text(text)
    shown = _run(str(home / "task.toml"), "-o", str(home / "out"))
    assert f"1 design, task.toml and {copied} in" in " ".join(shown.split())
    moved = (home / "out").rename(tmp_path / "moved")
    (home / place).unlink()
    assert (moved / copied).read_text() == lw.example_text("slider-crank")
    assert (moved / "task-01.toml").read_text() != lw.example_text("slider-crank")
    assert lw.Task.load(moved / "task.toml").solve().delivered
    again = _run(str(moved / "task.toml"), "-o", str(tmp_path / "again"))
    assert f"task.toml and {copied} in" in " ".join(again.split())


@pytest.mark.parametrize("table", ["csv_text", "designs_page"])
def test_an_interruption_of_the_tables_leaves_the_designs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, table: str
) -> None:
    def interrupted(*_: Any, **__: Any) -> str:
        raise KeyboardInterrupt

    monkeypatch.setattr(f"linkwork.synthesis.designs_folder.{table}", interrupted)
    found = lw.Task.load(_TASK).solve()
    options = FolderOptions(csv=True, html=True)
    with pytest.raises(KeyboardInterrupt, match=r"after 5 of 5 designs were written in"):
        write_designs(found, tmp_path / "out", options)
    assert len(list((tmp_path / "out").glob("tilt-a-box-*.toml"))) == 5
    assert lw.Task.load(tmp_path / "out" / "task.toml").solve().delivered


def test_a_mechanism_and_a_curve_have_places_of_their_own(tmp_path: Path) -> None:
    home = tmp_path / "home"
    (home / "mechanism").mkdir(parents=True)
    (tmp_path / "m.csv").write_text(lw.example_text("four-bar"))
    (home / "mechanism" / "m.csv").write_text("0,0\n4,1\n6,4\n3,7\n-1,4\n")
    (home / "task.toml").write_text(
        'format = 1\ntask = "improve"\nmechanism = "../m.csv"\n'
        'curve = { file = "mechanism/m.csv" }\nimprove = { point = "B", starts = 1 }\n'
    )
    files = task_copy(lw.Task.load(home / "task.toml").described).files
    assert files["mechanism/m.csv"].startswith("0,0")
    assert files["mechanism/mechanism/m.csv"] == lw.example_text("four-bar")
    assert 'mechanism = "mechanism/mechanism/m.csv"' in files["task.toml"]


def test_an_interruption_of_the_advice_keeps_the_refused_designs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupted() -> str:
        interrupts._came.set()  # as Ctrl-C does
        raise KeyboardInterrupt

    task = tmp_path / "steep.toml"
    task.write_text(_TASK.read_text().replace("least = 30", "least = 89"))
    found = replace(lw.Task.load(task).solve(), what_helps=interrupted)
    assert not found.sound
    monkeypatch.setattr(lw.Task, "solve", lambda *_, **__: found)
    shown = _run(str(task), "-o", str(tmp_path / "out"), "--all", code=1)
    assert not interrupts.was_interrupted()
    assert "No design is free of defects." in shown
    assert len(list((tmp_path / "out" / "refused").glob("tilt-a-box-*.toml"))) == 12


def test_an_interruption_before_there_is_a_design_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupted(*_: Any, **__: Any) -> lw.synthesis.Synthesis:
        raise KeyboardInterrupt

    monkeypatch.setattr(lw.Task, "solve", interrupted)
    done = CliRunner().invoke(linkwork, ["synthesize", str(_TASK)])
    assert done.exit_code == interrupts.INTERRUPTED
    assert "Interrupted before there was a design." in done.output


def test_designs_of_an_interrupted_search_are_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    found = replace(lw.Task.load(_TASK).solve(), interrupted=True)

    def interrupted(*_: Any, **__: Any) -> lw.synthesis.Synthesis:
        interrupts._came.set()  # as Ctrl-C does
        return found

    monkeypatch.setattr(lw.Task, "solve", interrupted)
    try:
        shown = _run(str(_TASK), "-o", str(tmp_path / "designs"))
        assert not interrupts.was_interrupted()
    finally:
        interrupts.answer_interrupt()
    assert "the designs are the best ones so far" in " ".join(shown.split())
    assert len(list((tmp_path / "designs").glob("tilt-a-box-*.toml"))) == 5


def test_an_interruption_leaves_a_new_folder_with_whole_designs_and_an_earlier_one_as_it_was(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    home = tmp_path / "home"
    home.mkdir()
    folder, found, written = home / "designs", lw.Task.load(_TASK).solve(), list[Path]()

    def stop_at_the_fourth(text: str, path: Path) -> None:
        written.append(path)
        if len(written) == 4:
            raise KeyboardInterrupt
        path.write_text(text)

    monkeypatch.setattr("linkwork.synthesis.designs_folder.save_text", stop_at_the_fourth)
    with pytest.raises(KeyboardInterrupt, match="after 1 of 12 designs were written in "):
        write_designs(found, folder, FolderOptions(refused=True, draw=True, csv=True))
    names = sorted(path.name for path in folder.iterdir())
    assert names == [
        "designs.csv",
        "refused",
        "task.toml",
        "tilt-a-box-01.svg",
        "tilt-a-box-01.toml",
    ]
    assert list((folder / "refused").iterdir()) == []
    assert (folder / "designs.csv").read_text().count("tilt-a-box-") == 1
    shutil.rmtree(folder)
    written.clear()
    monkeypatch.undo()
    found.save(folder, refused=True)
    before = {path: path.read_bytes() for path in folder.rglob("*.*")}
    assert len(before) == 13
    monkeypatch.setattr("linkwork.synthesis.designs_folder.save_text", stop_at_the_fourth)
    with pytest.raises(KeyboardInterrupt):
        write_designs(found, folder, FolderOptions(force=True, csv=True))
    assert {path: path.read_bytes() for path in folder.rglob("*.*")} == before
    assert list(home.iterdir()) == [folder]
    monkeypatch.undo()
    write_designs(found, folder, FolderOptions(force=True))
    # the refused designs of the earlier synthesis are gone
    assert len(list(folder.rglob("*.toml"))) == 6


def test_a_folder_that_cannot_be_made_is_refused_before_the_task_is_solved(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    folder = tmp_path / "file" / "designs"
    done = CliRunner().invoke(linkwork, ["synthesize", str(_TASK), "-o", str(folder)])
    assert done.exit_code == 2
    assert 'file" is not a folder; name another folder' in " ".join(done.stderr.split())


def test_without_a_sound_design_the_most_restrictive_requirement_is_named(tmp_path: Path) -> None:
    text = _TASK.read_text().replace("least = 30", "least = 85")
    task = tmp_path / "task.toml"
    task.write_text(text)
    shown = _run(str(task), code=1)
    assert "No design is free of defects." in shown
    # the lines of the terminal are joined: sentences are wrapped
    told = " ".join(shown.split())
    assert (
        "The requirement that rejects the most designs is the least transmission angle: without it"
        in told
    )


def test_wishes_that_cost_most_together_are_named_with_the_designs_they_cost(
    tmp_path: Path,
) -> None:
    text = _TASK.read_text().replace("least = 30", "least = 85")
    path = tmp_path / "task.toml"
    path.write_text(text.replace("most = 1400", "most = 300"))
    found = lw.Task.load(path).solve()
    assert all(len(design.kinds) > 1 for design in found.designs)
    wishes, count = found.most_restrictive or ("", 0)
    assert wishes == "the least transmission angle, together with the bounds of lengths"
    free = text.replace("least = 85", "least = 0").replace("{ most = 1400, ratio = 20 }", "{}")
    path.write_text(free)
    relaxed = lw.Task.load(path).solve()
    assert 0 < count == relaxed.sound


def test_without_a_driven_range_the_range_of_the_positions_counts(tmp_path: Path) -> None:
    """Nothing is sound in the given range; without it some designs fall to other wishes."""
    text, path = _TASK.read_text(), tmp_path / "task.toml"
    path.write_text(text.replace("[wanted]", "[wanted]\ninput = { from = 20, to = 21 }"))
    cost = lw.Task.load(path).solve().most_restrictive
    assert cost == ("the driven range", lw.Task.load(_TASK).solve().sound)


def test_options_of_files_need_a_folder() -> None:
    done = CliRunner().invoke(linkwork, ["synthesize", str(_TASK), "--draw"])
    assert done.exit_code == 2
    assert "add -o FOLDER" in done.output


def test_a_branch_defect_names_its_dead_point() -> None:
    """The dead point is where the four-bar of the message folds, by the cosine rule."""
    poses = [(0, 0, 0), (2, 1, 20), (3, 3, 50), (1, 5, 70), (-2, 6.5, 85)]
    found = lw.Task.motion(poses).solve()
    (defect,) = found.designs[0].defects
    assert defect.kind.name == "BRANCH"
    assert defect.between == (4, 5)
    angle = float(defect.message.split()[-1].rstrip("°"))
    z = found.designs[0].points
    crank = abs(z["A"] - z["A0"]) * np.exp(1j * np.radians(angle))
    reach = abs(z["A0"] + crank - z["B0"])
    coupler, rocker = abs(z["B"] - z["A"]), abs(z["B"] - z["B0"])
    # the angle is printed to a tenth of a degree
    printed = np.radians(0.05) * abs(crank)
    assert min(abs(reach - coupler - rocker), abs(reach - abs(coupler - rocker))) < printed


_POINTS = "".join(
    f"[[positions]]\npoint = [{x}, {y}]\n" for x, y in ((0, 0), (60, 10), (110, 40), (130, 90))
)
_POSES = "".join(
    f"[[positions]]\npoint = [{x}, {y}]\nangle = {angle}\n"
    for x, y, angle in ((0, 0, 0), (60, 10, 20), (110, 40, 50))
)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (f"task = 'path'\n{_POINTS}[[positions]]\npoint = [60, 10]\n",
         "1 problem in task.toml\n"
         "  line 11  positions[5]  is the same as position 2: leave one out"),
        ("task = 'motion'\n[[positions]]\npoint = [0, 0]\nangle = 0\n",
         "1 problem in task.toml\n"
         "  line 3  positions  is only one: a task needs two or more"),
        (f"task = 'motion'\n{_POSES}[wanted]\ninput = 'turns fully'\n"
         "lengths = { least = 50, most = 20 }\ntransmission = { least = 95 }\n"
         "clear_of = [[60, 12, 5]]\n",
         "3 problems in task.toml\n"
         "  line 14  wanted.lengths             least = 50 and most = 20 contradict each\n"
         "                                      other\n"
         "  line 15  wanted.transmission.least  must be at least 0 and below 90, got 95\n"
         "  line 16  wanted.clear_of[1]         contains the point of position 2, so no\n"
         "                                      design can be clear of it"),
        (f"task = 'path'\n{_POINTS}[given]\nfixed_pivots = [[500, 0], [40, 30]]\n[wanted]\n"
         "lengths = { most = 300 }\nclear_of = [[40, 31, 2]]\n"
         "fixed_pivots = { inside = [[0, 0], [100, 0], [100, 100]] }\n",
         "2 problems in task.toml\n"
         "  line 12  given.fixed_pivots[1]  is outside [wanted] fixed_pivots inside\n"
         "  line 14  wanted.lengths         exclude the ground of length 460.977: change\n"
         "                                  them, or [given] fixed_pivots"),
    ],
)  # fmt: skip
def test_a_bad_task_is_refused_with_its_whole_message(
    text: str, message: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "80")
    Path("task.toml").write_text(f"format = 1\n{text}")
    done = CliRunner().invoke(linkwork, ["synthesize", "task.toml"])
    assert done.exit_code == 2
    assert done.stderr == f"Error: {message}\n"


def test_a_task_without_a_sound_design_counts_defects_and_names_the_most_restrictive(
    tmp_path: Path,
) -> None:
    task = tmp_path / "task.toml"
    text = _TASK.read_text().split("[wanted]")[0]
    task.write_text(text + "[wanted]\ntransmission = { least = 80 }\nlengths = { most = 1050 }\n")
    shown = _run(str(task), code=1)
    counts, _, verdict = shown.partition("  dyad")
    assert counts.endswith(
        "  transmission angle too small  12\n"
        "  length out of bounds          6\n"
        "  without defects               0\n"
        "  delivered                     0\n\n"
    )
    assert verdict.partition("\n\n")[2] == (
        "No design is free of defects.\n"
        "The requirement that rejects the most designs is the least transmission angle:\n"
        "without it 6 would be sound.\n"
        "The best least transmission angle is 62.88°.\n"
        "  four-bar driven at A0: transmission angle down to 62.88°, wanted 80°\n"
        "  and 11 more; --json lists all reasons\n"
    )
    found = lw.Task.load(task).solve()
    assert "the least transmission angle: without it 6 would be sound" in repr(found)


@pytest.mark.parametrize("link", [False, True])
@pytest.mark.parametrize("name", ["designs.csv", "task-01.toml"])
def test_files_that_a_task_names_are_not_replaced_by_designs(
    tmp_path: Path, name: str, link: bool
) -> None:
    if name == "designs.csv":
        kept = "0,0\n4,1\n6,4\n3,7\n-1,4\n"
        text = 'task = "path"\nimprove = { starts = 2 }\ncurve = { file = "designs.csv" }\n'
    else:
        kept = lw.example_text("slider-crank")
        goals = '[{ of = "stroke(d)", target = 70 }]'
        text = f'task = "improve"\nmechanism = "{name}"\nimprove = {{ goals = {goals} }}\n'
    home = tmp_path / "home"
    home.mkdir()
    (home / name).write_text(kept)
    (home / "task.toml").write_text(f"format = 1\n{text}")
    out = tmp_path / "linked" if link else home
    if link:
        out.symlink_to(home)
    shown = _run(str(home / "task.toml"), "-o", str(out), "--force", "--csv", code=2)
    assert shown == ""
    if name == "task-01.toml":  # without --csv no table is written
        with pytest.raises(lw.InputError, match=r'holds ".*", which this synthesis reads'):
            lw.Task.load(home / "task.toml").solve().save(out, force=True)
    assert (home / name).read_text() == kept


@pytest.mark.parametrize("name", ["Tilt a box", "Other"])
def test_a_design_that_the_task_improves_is_not_replaced(tmp_path: Path, name: str) -> None:
    """It is a file of the earlier synthesis in the folder, and unchanged."""
    folder = tmp_path / "designs"
    lw.Task.load(_TASK).solve().save(folder)
    kept = folder / "tilt-a-box-01.toml"
    before = kept.read_text()
    task = tmp_path / "improve.toml"
    task.write_text(
        f'format = 1\nname = "{name}"\ntask = "improve"\n'
        'mechanism = "designs/tilt-a-box-01.toml"\n[improve]\nstarts = 1\n'
        'goals = [{ of = "max(P.x)", target = 262 }]\n'
    )
    _run(str(task), "-o", str(folder), "--force", code=2 if name == "Tilt a box" else 0)
    assert kept.read_text() == before
    assert (folder / "other-01.toml").exists() == (name == "Other")
