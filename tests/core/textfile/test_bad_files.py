"""Every wrong file is refused with its whole message, at its line."""

from __future__ import annotations

from pathlib import Path

import pytest

from linkwork.core.foundation.errors import MechanismError, MechanismFileError, Problem
from linkwork.core.textfile import read_bytes, read_file, read_text
from tests.core.textfile.bad_files import CASES, BadFile
from tests.core.textfile.samples import SAMPLES
from tests.thinned import thinned


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.title.replace(" ", "_"))
def test_a_wrong_file_is_refused_with_its_whole_message(case: BadFile) -> None:
    with pytest.raises(MechanismFileError) as caught:
        read_text(case.text, "bad.toml")
    assert str(caught.value) == case.message


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.title.replace(" ", "_"))
def test_line_ends_and_bom_do_not_move_a_problem(case: BadFile) -> None:
    windows = b"\xef\xbb\xbf" + case.text.encode().replace(b"\n", b"\r\n")
    with pytest.raises(MechanismFileError) as caught:
        read_bytes(windows, "bad.toml")
    assert str(caught.value) == case.message


def test_every_case_has_its_own_title() -> None:
    assert len(CASES) > 45
    assert len({case.title for case in CASES}) == len(CASES)


BAD_BYTES = {
    "10 MB": (b"# comment\n" * 1_000_000, "has 10.0 MB: at most 1 MB is read"),
    "1.2 MB of 600 000 letters": ("é".encode() * 600_000, "has 1.2 MB: at most 1 MB is read"),
    "Latin-1": (
        b'# one\nname = "M\xfcller"\n',
        "byte 15 (0xfc) is not UTF-8: save the file as UTF-8",
    ),
    "UTF-16": ("format = 1".encode("utf-16"), "is UTF-16 text: save it as UTF-8"),
    "NUL": (b"format = 1\n\0", "contains a NUL character: not a text file"),
    "PNG": (b"\x89PNG\r\n\x1a\n\0\0", "byte 0 (0x89) is not UTF-8: save the file as UTF-8"),
    "deep lists": (b"a = " + b"[" * 100_000, "brackets nested deeper than 20 levels"),
    "deep tables": (b"a = " + b"{a=" * 100_000, "brackets nested deeper than 20 levels"),
    "deep key": (b"a." * 400_000 + b"a = 1", "a dotted key of more than 8 parts"),
    "deep header": (b"[" + b"a . " * 200_000 + b"a]", "a dotted key of more than 8 parts"),
    "quoted deep key": (b'"a".' * 200_000 + b"a = 1", "a dotted key of more than 8 parts"),
    "huge number": (
        b"a = " + b"1" * 900_000,
        "a word of 900000 characters: at most 400 are allowed",
    ),
}
LINES = {"Latin-1": 2, "NUL": 2, "10 MB": None, "1.2 MB of 600 000 letters": None}


@pytest.mark.parametrize("title", BAD_BYTES)
def test_hostile_bytes_are_refused_with_a_reason(title: str) -> None:
    data, message = BAD_BYTES[title]
    with pytest.raises(MechanismFileError) as caught:
        read_bytes(data, "bad.toml")
    line = LINES.get(title, 1)
    assert caught.value.problems == (Problem(key=(), message=message, line=line),)


@pytest.mark.parametrize(
    "piece",
    thinned(
        ['"\\"', '"', "'", "a.b ", "'''", '"""\\', "#", '"""', "[[a]]\n", "[a]\n", "a,", "\\"], 6
    ),
)
def test_a_large_file_of_anything_is_refused_in_time(piece: str) -> None:
    # Quadratic reading of 300 kB would take an hour: that this test ends is the assertion.
    with pytest.raises(MechanismFileError):
        read_text(("a = " + piece * 300_000)[:300_000])


def test_a_file_of_ten_megabytes_is_not_read(tmp_path: Path) -> None:
    path = tmp_path / "big.toml"
    path.write_bytes(b"#" * 10_000_000)
    with pytest.raises(MechanismFileError) as caught:
        read_file(path)
    assert str(caught.value) == f"1 problem in {path}\n  has 10.0 MB: at most 1 MB is read"


def test_a_missing_file_names_the_files_that_are_there(tmp_path: Path) -> None:
    (tmp_path / "rocker.toml").write_text("")
    with pytest.raises(MechanismFileError) as caught:
        read_file(tmp_path / "roker.toml")
    assert str(caught.value) == (
        f"1 problem in {tmp_path / 'roker.toml'}\n"
        "  there is no such file (TOML files there: rocker.toml)"
    )


def test_a_folder_is_no_file(tmp_path: Path) -> None:
    with pytest.raises(MechanismFileError) as caught:
        read_file(tmp_path)
    assert str(caught.value) == (
        f"1 problem in {tmp_path}\n"
        "  is a folder: name one file in it (there are no TOML files there)"
    )


def test_a_path_that_cannot_exist_is_refused(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    for path, reason in (
        ("a\0b", "cannot be read: embedded null byte"),
        (tmp_path / "file" / "x.toml", "cannot be read: Not a directory"),
    ):
        with pytest.raises(MechanismFileError) as caught:
            read_file(path)
        assert caught.value.problems[0].message == reason


def test_later_problems_get_the_lines_of_the_file() -> None:
    file = read_text(SAMPLES["rapier"], "rapier.toml")
    problems = [
        Problem(key=("guess", "theta13"), message="is in no loop"),
        Problem(key=("loops", "A0 A B", "left"), message="is wrong"),
        Problem(key=("input", "variable"), message="is known", line=7),
        Problem(key=("nowhere",), message="is nowhere"),
    ]
    error = file.located(MechanismError(problems))
    assert isinstance(error, MechanismFileError)
    assert str(error) == (
        "4 problems in rapier.toml\n"
        "  line 1   nowhere              is nowhere\n"
        "  line 7   input.variable       is known\n"
        '  line 13  loops."A0 A B".left  is wrong\n'
        "  line 17  guess.theta13        is in no loop"
    )
