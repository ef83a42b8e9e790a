"""Runs the blocks of code on the pages that Sphinx itself does not run.

Blocks of Python share the names of their page. Commands run in one folder: a file that has the
name of a library mechanism, such as ``four-bar.toml``, is there. A comment before a block prepares
it, in Python, or says why it is not run::

    <!-- before: lw.example("crank-press").save("press.toml") -->
    <!-- not run: it needs a graphics card -->
"""

from __future__ import annotations

import re
import shutil
import signal
import tempfile
import tomllib
import traceback
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from contextlib import chdir, redirect_stdout
from dataclasses import dataclass
from io import StringIO
from pathlib import Path
from typing import Any

import matplotlib as mpl

import linkwork as lw
from scripts.docsite.commands_run import commands_of, run_command

__all__ = ["Checked", "check_page", "check_pages"]

_BLOCK = re.compile(
    r"(?:<!-- (?P<word>before|not run):\s(?P<comment>.*?)-->\n\n?)?"
    r"^```(?P<language>python|sh|bash|toml)\n(?P<code>.*?)^```$",
    re.DOTALL | re.MULTILINE,
)
#: A block of any language, with its end: what a block without one contains is not known.
_FENCED = re.compile(r"^```(?P<language>[^\n]*)\n.*?^```$", re.DOTALL | re.MULTILINE)
_EXAMPLES = Path(__file__).resolve().parents[2] / "examples"
_LONGEST = 300  # seconds that a block may take; the first one of an installation compiles kernels
_INSTALLS = ("pip ", "pipx ", "uvx ", "uv ", "python3 -m venv", "scripts/", "eval ")
_MAY_BE_MISSING = ("octave",)  # programs too large to ask for where pages are checked


@dataclass(frozen=True, kw_only=True)
class Checked:
    """How the blocks of a page ran: their number, those left out with reasons, errors."""

    page: str
    run: int
    left: tuple[str, ...]
    errors: tuple[str, ...]


def check_pages(pages: list[Path]) -> list[Checked]:
    """Run the blocks of all pages, two pages at once."""
    with ProcessPoolExecutor(2) as workers:
        return list(workers.map(check_page, pages))


def check_page(path: Path) -> Checked:
    """Run the blocks of one page."""
    mpl.use("Agg")
    signal.signal(signal.SIGALRM, _too_long)
    text = path.read_text(encoding="utf-8")
    run, left, errors = 0, [], _unnamed(path.name, text)
    names: dict[str, Any] = {"__name__": "__main__"}
    exec("import linkwork as lw", names)  # what every page has said before
    with tempfile.TemporaryDirectory() as folder, chdir(folder):
        Path("examples").symlink_to(_EXAMPLES)
        for block in _BLOCK.finditer(text):
            place = f"{path.name}:{text.count(chr(10), 0, block.start('code'))}"
            if block["word"] == "not run":
                left.append(f"{place}: {' '.join(block['comment'].split())}")
                continue
            signal.alarm(_LONGEST)
            try:
                if block["word"] == "before":
                    exec(block["comment"], names)
                left += [f"{place}: {told}" for told in _run(block, names, Path(folder))]
                run += 1
            except Exception:
                # what the page's author sees: the last line and where the block is
                errors.append(f"{place}: {traceback.format_exc(limit=-1).strip()}")
            finally:
                signal.alarm(0)
    return Checked(page=path.name, run=run, left=tuple(left), errors=tuple(errors))


def _unnamed(page: str, text: str) -> list[str]:
    """Blocks that would not be run for want of a language."""
    told = "name the language of this block; text is not run"
    return [
        f"{page}:{1 + text.count(chr(10), 0, block.start())}: {told}"
        for block in _FENCED.finditer(text)
        if not block["language"].strip()
    ]


def _too_long(_signal: int, _frame: object) -> None:
    raise TimeoutError(f"it takes longer than {_LONGEST} s")


def _write_examples(code: str, folder: Path) -> None:
    """Write the files of library mechanisms that commands read under the name of the library."""
    for name in re.findall(r"([\w-]+)\.toml", code):
        path = folder / f"{name}.toml"
        if name in lw.examples() and f"-o {name}.toml" not in code and not path.exists():
            path.write_text(lw.example_text(name), encoding="utf-8")


def _run(block: re.Match[str], names: dict[str, Any], folder: Path) -> Iterator[str]:
    """Run one block; yields the commands that are left out."""
    code = block["code"]
    if block["language"] == "toml":
        tomllib.loads(code)
    elif block["language"] == "python":
        with redirect_stdout(StringIO()):
            exec(compile(code, "block", "exec"), names)
    else:
        _write_examples(code, folder)
        for command in commands_of(code):
            if command.startswith(_INSTALLS):
                yield f"{command} (installation)"
                continue
            missing = [p for p in _MAY_BE_MISSING if p in command.split() and not shutil.which(p)]
            if missing:
                yield f"{command} ({missing[0]} is not installed)"
                continue
            done = run_command(command, folder)
            if done.code:
                raise RuntimeError(f"{command!r} ended with {done.code}: {done.output.strip()}")
