"""``linkwork synthesize``: counts, files that load back, reasons of refused designs."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
from click.testing import CliRunner

import linkwork as lw
from linkwork.cli.main import linkwork

_TASK = Path(__file__).parents[2] / "examples" / "tasks" / "tilt-a-box.toml"


def _run(*arguments: str, code: int = 0) -> str:
    done = CliRunner().invoke(linkwork, ["synthesize", *arguments])
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


def test_a_folder_with_other_files_is_left_alone(tmp_path: Path) -> None:
    other = tmp_path / "other"
    other.mkdir()
    (other / "notes.txt").write_text("mine")
    done = CliRunner().invoke(linkwork, ["synthesize", str(_TASK), "-o", str(other), "--fresh"])
    assert done.exit_code == 2
    assert "it holds" in done.output
    assert [path.name for path in other.iterdir()] == ["notes.txt"]
    folder = tmp_path / "designs"
    _run(str(_TASK), "-o", str(folder))
    done = CliRunner().invoke(linkwork, ["synthesize", str(_TASK), "-o", str(folder)])
    assert done.exit_code == 2
    _run(str(_TASK), "-o", str(folder), "--fresh")
    assert len(list(folder.glob("tilt-a-box-*.toml"))) == 5


def test_without_a_sound_design_the_costliest_wish_is_named(tmp_path: Path) -> None:
    text = _TASK.read_text().replace("least = 30", "least = 85")
    task = tmp_path / "task.toml"
    task.write_text(text)
    shown = _run(str(task), code=1)
    assert "No design is free of defects." in shown
    # the lines of the terminal are joined: sentences are wrapped
    told = " ".join(shown.split())
    assert "The wish that costs most is the least transmission angle: without it" in told


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
    z = found.designs[0].design.points
    crank = abs(z["A"] - z["A0"]) * np.exp(1j * np.radians(angle))
    reach = abs(z["A0"] + crank - z["B0"])
    coupler, rocker = abs(z["B"] - z["A"]), abs(z["B"] - z["B0"])
    # the angle is printed to a tenth of a degree
    printed = np.radians(0.05) * abs(crank)
    assert min(abs(reach - coupler - rocker), abs(reach - abs(coupler - rocker))) < printed
