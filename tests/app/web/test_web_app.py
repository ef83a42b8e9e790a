"""The static files of the page that solves in a browser: whole, checked, the same every time."""

from __future__ import annotations

import base64
import gzip
import hashlib
import io
import json
import os
import re
import sys
import zipfile
from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from linkwork.app.web import web_app as module
from linkwork.app.web.web_app import (
    PyodideFiles,
    late_files,
    pyodide_files,
    site_packages,
    web_folder,
    web_page,
)
from linkwork.core.commands.main import linkwork
from linkwork.core.foundation.errors import InputError


def _wheel(**files: str) -> bytes:
    content = io.BytesIO()
    with zipfile.ZipFile(content, "w") as archive:
        for name, text in files.items():
            archive.writestr(name.replace("__", "/").replace("_py", ".py"), text)
    return content.getvalue()


CONTENTS = {
    "pyodide.asm.js": b"var core = 1;\n//# sourceMappingURL=core.js.map",
    "pyodide.asm.wasm": b"\0asm" + bytes(2000),
    "pyodide.js": b"var loader = 2;",
    "python_stdlib.zip": b"standard library",
    "pyodide-lock.json": json.dumps({"info": {"python": "3.13.2"}, "packages": {"x": 1}}).encode(),
    "numpy": _wheel(numpy__init_py="a = 1", numpy__tests__test_py="b = 2", numpy__a_pyi="c: int"),
    "tomlkit": _wheel(tomlkit__init_py="d = 3"),
    "platformdirs": _wheel(platformdirs__init_py="e = 4"),
}
SITE = "https://cdn.jsdelivr.net/"


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A folder of small files, with a lock file of its own that names them all."""
    found = tmp_path / "pyodide"
    found.mkdir()
    lock = {}
    for name, content in CONTENTS.items():
        (found / f"{name}.file").write_bytes(content)
        lock[name] = {"file": f"{name}.file", "sha256": hashlib.sha256(content).hexdigest()}
    (found / "lock.json").write_text(json.dumps(lock))
    return found


@pytest.fixture(scope="module")
def small() -> PyodideFiles:
    """Small files, as if they had been checked."""
    return PyodideFiles(contents=CONTENTS, unofficial=())


def run(*arguments: str | Path) -> Result:
    return CliRunner().invoke(linkwork, ["web", *map(str, arguments)])


def test_official_files_are_pinned_by_version_and_hash() -> None:
    locked = module._official()
    assert set(locked) == set(CONTENTS)
    for file in locked.values():
        assert re.fullmatch("[0-9a-f]{64}", file.sha256)
        assert file.url.startswith("https://")
        assert file.url.endswith(f"/{file.file}")
    official = "800c98edc0c864dfa49f07005680c699b4b42b84eae1f8cb19d35b3634e7f05c"
    assert locked["numpy"].sha256 == official  # of Pyodide's own lock file


def test_a_file_with_another_hash_is_refused(folder: Path) -> None:
    (folder / "numpy.file").write_bytes(b"something else")
    with pytest.raises(InputError, match=r'^"numpy\.file" is not the expected file: its SHA-256'):
        pyodide_files(folder)


def test_a_missing_file_is_named_with_its_source(folder: Path) -> None:
    (folder / "lock.json").unlink()
    message = r'^cannot read ".*pyodide\.asm\.js": No such file or directory; get it from https:'
    with pytest.raises(InputError, match=message):
        pyodide_files(folder)


def test_files_of_a_lock_of_its_own_are_called_unofficial(folder: Path) -> None:
    assert set(pyodide_files(folder).unofficial) == set(CONTENTS)


@pytest.mark.parametrize("text", ["[]", "{", '{"numpy": {}}', '{"scipy": 1}', '{"numpy": 1}'])
def test_a_broken_lock_is_refused(folder: Path, text: str) -> None:
    (folder / "lock.json").write_text(text)
    with pytest.raises(InputError, match="is not a lock file"):
        pyodide_files(folder)


def test_a_lock_of_unknown_files_is_refused(folder: Path) -> None:
    (folder / "lock.json").write_text('{"scipy": {"file": "x", "sha256": "y"}}')
    with pytest.raises(InputError, match=r'"scipy" is not one of pyodide\.asm\.js'):
        pyodide_files(folder)


def test_without_a_network_the_way_out_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    def unreachable(*_: object, **__: object) -> object:
        raise OSError("network is unreachable")

    monkeypatch.setattr(module, "urlopen", unreachable)
    with pytest.raises(InputError, match=r"^cannot download https.*--pyodide FOLDER$"):
        pyodide_files()


def test_downloaded_files_are_compared_too(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "urlopen", lambda *_, **__: io.BytesIO(b"<html>not found</html>"))
    with pytest.raises(InputError, match="is not the expected file"):
        pyodide_files()


def test_the_archive_holds_what_runs_and_no_more() -> None:
    wheels = {name: CONTENTS[name] for name in ("numpy", "tomlkit", "platformdirs")}
    with zipfile.ZipFile(io.BytesIO(site_packages(wheels))) as archive:
        names = set(archive.namelist())
    assert {"numpy/init.py", "tomlkit/init.py", "platformdirs/init.py"} <= names
    assert {"linkwork/__init__.py", "linkwork/library/four-bar.toml"} <= names
    assert not any("tests" in name or name.endswith(".pyi") for name in names)
    assert not any(
        name.startswith(("linkwork/core/commands", "linkwork/app/web")) for name in names
    )
    assert {name for name in names if name.endswith("/offline.js")}  # of pages that it exports
    assert not any("__pycache__" in name or ".nbi" in name for name in names)


def test_data_that_few_visits_need_are_files_of_their_own(small: PyodideFiles) -> None:
    folder = web_folder(small)
    late = {name: content for name, content in folder.items() if name.endswith(".npz.bin")}
    assert sum(map(len, late.values())) > 4e6
    wheels = {name: CONTENTS[name] for name in ("numpy", "tomlkit", "platformdirs")}
    with zipfile.ZipFile(io.BytesIO(site_packages(wheels))) as archive:
        assert not [name for name in archive.namelist() if name.endswith(".npz")]
    assert {f"engine/{Path(name).name}.bin" for name in late_files()} == set(late)
    for name, url in _urls(folder, "late").items():
        assert url.partition("?")[0] in late
        assert Path("src", name).read_bytes() == late[url.partition("?")[0]]
    # a page of one file contains them
    assert set(_urls({"index.html": web_page(small)}, "late").values()) == {""}


def test_the_same_files_give_the_same_bytes(small: PyodideFiles) -> None:
    assert web_folder(small) == web_folder(small)


def test_one_page_names_no_other_file(small: PyodideFiles) -> None:
    page = web_page(small).decode()
    markup = re.sub(r"<script[^>]*>.*?</script>|<style>.*?</style>", "", page, flags=re.DOTALL)
    assert not re.search(r"""(src|href)=["'](?!data:)""", markup)
    assert "http" not in markup.replace("http-equiv", "")
    assert '"url": ""' in page
    assert "sourceMappingURL" not in page


def test_the_policy_names_the_scripts_and_styles_of_the_page(small: PyodideFiles) -> None:
    page = web_page(small).decode()
    policy = re.search(r'Content-Security-Policy" content="([^"]*)"', page)
    assert policy is not None
    for kind in ("script", "style"):
        inline = re.findall(rf"<{kind}>(.*?)</{kind}>", page, flags=re.DOTALL)
        assert len(inline) == 1
        digest = base64.b64encode(hashlib.sha256(inline[0].encode()).digest()).decode()
        assert f"{kind}-src 'sha256-{digest}'" in policy[1]
    assert "unsafe-inline" not in policy[1]
    assert "http" not in policy[1]


def test_a_page_contains_its_engine(small: PyodideFiles) -> None:
    page = web_page(small).decode()
    packed = re.search(r'id="linkwork-pyodide.asm.wasm" type="text/plain">([^<]*)<', page)
    assert packed is not None
    assert gzip.decompress(base64.b64decode(packed[1])) == CONTENTS["pyodide.asm.wasm"]


def test_addresses_change_with_their_files(small: PyodideFiles) -> None:
    other = PyodideFiles(contents={**CONTENTS, "pyodide.asm.wasm": b"\0asm"}, unofficial=())
    before, after = web_folder(small), web_folder(other)
    assert before["sw.js"] != after["sw.js"]
    assert _urls(before)["python_stdlib.zip"] == _urls(after)["python_stdlib.zip"]
    assert _urls(before)["pyodide.asm.wasm"] != _urls(after)["pyodide.asm.wasm"]


def _urls(folder: dict[str, bytes], when: str = "files") -> dict[str, str]:
    page = folder["index.html"].decode()
    told = re.search(r'id="linkwork-engine" type="application/json">([^<]*)<', page)
    assert told is not None
    return {file["name"]: file["url"] for file in json.loads(told[1])[when]}


def test_a_page_of_other_files_says_so(small: PyodideFiles) -> None:
    other = PyodideFiles(contents=CONTENTS, unofficial=("numpy",))
    assert b"For tests only: not the official files of numpy." in web_page(other)
    assert b"For tests only" not in web_page(small)


def test_the_command_writes_a_folder_and_tells_of_other_files(folder: Path, tmp_path: Path) -> None:
    out = tmp_path / "public"
    done = run(out, "--pyodide", folder)
    assert done.exit_code == 0
    assert "copy it to any web host" in done.output
    assert "For tests only: not the official files of" in done.output
    written = {str(path.relative_to(out)) for path in out.rglob("*") if path.is_file()}
    assert {"index.html", "linkwork.html", "sw.js"} <= written
    assert not [path for path in tmp_path.iterdir() if path.name.endswith(".part")]


def test_a_second_build_replaces_its_own_files_and_keeps_others(
    folder: Path, tmp_path: Path
) -> None:
    out = tmp_path / "public"
    assert run(out, "--pyodide", folder).exit_code == 0
    (out / "notes.txt").write_text("mine")
    (out / "sw.js").write_text("damaged")
    assert run(out, "--pyodide", folder).exit_code == 0
    assert (out / "notes.txt").read_text() == "mine"
    assert (out / "sw.js").read_text() != "damaged"


def test_a_folder_of_somebody_else_is_left_alone(folder: Path, tmp_path: Path) -> None:
    out = tmp_path / "site"
    out.mkdir()
    (out / "index.html").write_text("my home page")
    done = run(out, "--pyodide", folder)
    assert done.exit_code == 2
    assert "contains files that linkwork web did not write" in done.output
    assert [path.name for path in out.iterdir()] == ["index.html"]


@pytest.mark.skipif(sys.platform == "win32" or os.geteuid() == 0, reason="needs file permissions")
def test_a_folder_that_cannot_be_written_is_named(folder: Path, tmp_path: Path) -> None:
    tmp_path.chmod(0o500)
    done = run(tmp_path / "public", "--pyodide", folder)
    tmp_path.chmod(0o700)
    assert done.exit_code == 2
    assert "Permission denied" in done.output


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["page.txt", "--single"], "a page needs the suffix .html"),
        (["page.html"], "for one HTML file, add --single"),
        (["no/such/folder"], "there is no folder"),
        (["lost"], "is a link that leads to no folder"),
    ],
)
def test_a_wrong_name_is_refused_before_anything_is_read(
    arguments: list[str], message: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(module, "urlopen", pytest.fail)
    Path("lost").symlink_to("nowhere")
    done = run(*arguments)
    assert done.exit_code == 2
    assert message in " ".join(done.output.split())


def test_the_command_writes_one_page(folder: Path, tmp_path: Path) -> None:
    out = tmp_path / "page.html"
    done = run(out, "--single", "--pyodide", folder)
    assert done.exit_code == 0
    assert out.read_bytes() == web_page(pyodide_files(folder))
