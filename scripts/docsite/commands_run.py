"""Runs the commands that pages show, as a person in a folder would type them."""

from __future__ import annotations

import os
import shlex
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from click.testing import CliRunner

from linkwork.core.commands.main import linkwork

__all__ = ["Finished", "commands_of", "run_command"]


@dataclass(frozen=True, kw_only=True)
class Finished:
    """A finished command: its output with messages, and its exit code."""

    output: str
    code: int


def commands_of(text: str) -> Iterator[str]:
    """The commands of a block, one a line; a line that ends with a backslash continues."""
    for line in text.replace("\\\n", " ").splitlines():
        command = line.strip()
        if command and not command.startswith("#"):
            yield command


def run_command(command: str, folder: Path) -> Finished:
    """Run one command in a folder; several joined by && until one fails.

    ``linkwork`` runs in this process: a start of Python takes longer than most commands.
    """
    output = ""
    for single in command.split("&&"):
        words = shlex.split(single, comments=True)
        if not words:
            continue
        done = _run_words(words, single, folder)
        output += done.output
        if done.code:
            return Finished(output=output, code=done.code)
    return Finished(output=output, code=0)


def _run_words(words: list[str], single: str, folder: Path) -> Finished:
    if words[0] == "linkwork" and not set("|><") & set(single):
        with _inside(folder):
            done = CliRunner().invoke(linkwork, words[1:], prog_name="linkwork")
        if done.exception is not None and not isinstance(done.exception, SystemExit):
            raise done.exception
        return Finished(output=done.output, code=done.exit_code)
    # other programs, and pipes: by the shell, with this environment's Python first
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    ran = subprocess.run(
        single,
        shell=True,
        executable="/bin/bash",
        cwd=folder,
        capture_output=True,
        text=True,
        check=False,
        env={**os.environ, "PATH": path},
        timeout=120,
    )
    return Finished(output=ran.stdout + ran.stderr, code=ran.returncode)


@contextmanager
def _inside(folder: Path) -> Iterator[None]:
    before = Path.cwd()
    os.chdir(folder)
    try:
        yield
    finally:
        os.chdir(before)
