"""Programs compute what Linkwork computes, in every language that can be run."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import linkwork as lw
from tests.library_mechanisms import read_example
from tests.writers.running import RUNNERS, columns_of, largest_differences

# the last correction of Newton-Raphson leaves an error below the rounding of a position, which its
# condition multiplies: 14 for the rapier drive, 100 at most for those below; the plate of Kempe's
# translator does not turn
_ROUNDING = 1e-12
_NAMES = (
    "four-bar", "rapier-drive", "dixon-one", "balanced-lamp", "five-bar-robot", "kempe-translator",
)  # fmt: skip

_ODD_NAMES = """
format = 1
name = 'Marks of comments: */ *) *\\\\ /* (* @{name} \"\"\" \\\\ "'
angle = "deg"

[dimensions]
for = 40
J = 120
cos_beta = 80
EOF = 100
top = 1

[loops]
while = "for*e^(i*θ2) + J*e^(i*q) = top*EOF + cos_beta*e^(i*β)"

[guess]
"θ2" = 30
q = 22
"β" = 55

[input]
variable = "θ2"
to = 90
step = 30
"""


def _differences(mechanism: lw.Mechanism, file: Path) -> dict[str, float]:
    motion = mechanism.sweep()
    mechanism.write(file, motion=motion)
    columns, statuses = columns_of(file)
    expected = motion.found[motion.asked]
    assert [status == "found" for status in statuses] == expected.tolist()
    return largest_differences(columns, motion)


@pytest.mark.parametrize("suffix", [".py", ".js", ".c"])
@pytest.mark.parametrize("name", _NAMES)
def test_programs_print_the_table_of_the_sweep(name: str, suffix: str, tmp_path: Path) -> None:
    if suffix not in RUNNERS:
        pytest.skip(f"nothing runs {suffix} files here")
    found = _differences(read_example(name), tmp_path / f"solver{suffix}")
    assert max(found.values()) <= _ROUNDING


@pytest.mark.parametrize("suffix", [".py", ".js", ".c"])
def test_programs_lock_where_the_mechanism_does(suffix: str, tmp_path: Path) -> None:
    if suffix not in RUNNERS:
        pytest.skip(f"nothing runs {suffix} files here")
    bar = read_example("four-bar").changed(
        lengths={"O2 A": 80, "A B": 120, "O4 B": 80, "O2 O4": 100}
    )
    motion = bar.sweep()
    assert 0 < motion.found.sum() < len(motion)  # rows of two branches, and rows without position
    assert max(_differences(bar, tmp_path / f"solver{suffix}").values()) <= _ROUNDING


@pytest.mark.parametrize("suffix", [".py", ".js", ".c"])
def test_names_of_the_file_may_be_words_of_the_language(suffix: str, tmp_path: Path) -> None:
    if suffix not in RUNNERS:
        pytest.skip(f"nothing runs {suffix} files here")
    file = tmp_path / f"solver{suffix}"
    found = _differences(lw.loads(_ODD_NAMES), file)
    assert "const top =" not in file.read_text("utf-8")  # pages have one of their own
    assert set(found) >= {"θ2", "q", "β", "β.d1"}
    assert max(found.values()) <= _ROUNDING


def test_a_program_solves_the_mechanism_with_another_dimension(tmp_path: Path) -> None:
    file = tmp_path / "four_bar.py"
    bar = read_example("four-bar")
    bar.write(file)
    text = file.read_text("utf-8")
    assert text.count("O2_A = 40.0\n") == 1
    file.write_text(text.replace("O2_A = 40.0\n", "O2_A = 42.0\n"), "utf-8")
    columns, _ = columns_of(file)
    motion = bar.changed(lengths={"O2 A": 42, "A B": 120, "O4 B": 80}).sweep()
    assert max(largest_differences(columns, motion).values()) <= _ROUNDING


def test_a_position_is_computed_at_any_input(tmp_path: Path) -> None:
    file = tmp_path / "four_bar.py"
    read_example("four-bar").write(file)
    namespace: dict[str, object] = {"__name__": "four_bar"}
    exec(compile(file.read_text("utf-8"), str(file), "exec"), namespace)  # our own program
    position = namespace["position"]
    assert callable(position)
    found, right = position(-77.5), read_example("four-bar").solve(at=-77.5)
    assert found["rocker"] == pytest.approx(right["rocker"], abs=1e-11)
    assert found["B.x.d1"] == pytest.approx(right["B.x.d1"], abs=1e-10)


def test_structured_text_has_every_column_as_an_output(tmp_path: Path) -> None:
    file = tmp_path / "four_bar.st"
    read_example("four-bar").write(file)
    text = file.read_text("utf-8")
    assert "FUNCTION_BLOCK four_bar\n" in text
    for name in ("coupler", "rocker", "B_x", "mu", "coupler_d1", "B_y_d2"):
        assert text.count(f"\n  {name} := ") == 1
    assert "@{" not in text


def test_what_has_no_formulas_is_refused_with_the_reason(tmp_path: Path) -> None:
    with pytest.raises(lw.InputError) as refused:
        read_example("cam-roller-follower").write(tmp_path / "cam.c")
    assert str(refused.value) == (
        'no program for Disc cam with roller follower: "rise" is a motion law or a curve, given '
        "piece by piece"
    )
    with pytest.raises(lw.InputError) as refused:
        read_example("four-bar").write(tmp_path / "bar.java", kind="program")
    assert "the suffix of a program is one of .py (Python), .m (Octave and MATLAB)" in str(
        refused.value
    )
    assert not list(tmp_path.iterdir())


def test_every_place_of_a_template_is_filled(tmp_path: Path) -> None:
    for suffix in (".py", ".js", ".c", ".m", ".st"):
        file = tmp_path / f"solver{suffix}"
        read_example("dixon-one").write(file)
        text = file.read_text("utf-8")
        assert "@{" not in text
        assert np.char.count(text, "A2").item() > 0


def test_octave_assigns_no_result_that_nobody_takes(tmp_path: Path) -> None:
    read_example("four-bar").write(tmp_path / "bar.m")
    body = (tmp_path / "bar.m").read_text("utf-8").partition("function p = numbers")[0]
    # an assigned first output of a plain call is printed as "ans = [](0x0)" behind the table
    table = body.rpartition("return\n  end\n")[2]
    assert table.count("result = ") == 1
    assert "if nargout > 0\n    result = [];\n  end" in table
