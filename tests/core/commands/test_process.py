"""Real processes: pipes, encodings, signals, and what is loaded."""

from __future__ import annotations

import importlib.util
import json
import os
import pty
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from tests.core.commands.conftest import Start
from tests.interruptible import interruptible
from tests.thinned import thinned

#: Nothing is followed when the position asked for is the guess's own.
FOR_MOTION = {
    "linkwork.core.motion.following",
    "linkwork.core.numerics.curve_tracing",
    "linkwork.circuits.failure.failing",
}
HEAVY = {"matplotlib", "networkx", "numba", "pandas", "rich", "scipy", "xarray"}


def test_solve_loads_nothing_heavy(environment: dict[str, str]) -> None:
    program = (
        "import json, sys\n"
        "from linkwork.core.commands.main import linkwork\n"
        "linkwork(['solve', 'four-bar.toml', '--show-steps'], standalone_mode=False)\n"
        "json.dump(list(sys.modules), sys.stderr)\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", program], env=environment, capture_output=True, check=True
    )
    loaded = json.loads(done.stderr)
    assert "numpy" in loaded
    assert not {name.partition(".")[0] for name in loaded} & HEAVY
    assert "linkwork.core.numerics.position_proof" in loaded
    assert not FOR_MOTION & set(loaded)
    assert all(importlib.util.find_spec(name) for name in FOR_MOTION)


def test_a_reader_that_goes_away_is_no_trouble(environment: dict[str, str]) -> None:
    words = [sys.executable, "-m", "linkwork", "sweep", "four-bar.toml", "--step", "0.05"]
    with subprocess.Popen(
        [*words, "--csv", "-"], env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE
    ) as process:
        assert process.stdout is not None
        assert process.stderr is not None
        assert process.stdout.readline().startswith(b"crank,coupler,rocker,")
        process.stdout.close()
        assert process.stderr.read() == b""
        assert process.wait(60) == 141


def test_an_interrupt_is_quiet(environment: dict[str, str]) -> None:
    words = [sys.executable, "-m", "linkwork", "solve", "-"]
    with subprocess.Popen(
        words,
        env=environment,
        stdin=subprocess.PIPE,
        stderr=subprocess.PIPE,
        preexec_fn=interruptible,
    ) as process:
        _wait_until_it_reads(process.pid)
        process.send_signal(signal.SIGINT)
        assert process.stderr is not None
        assert process.stderr.read() == b"\nInterrupted.\n"
        assert process.wait(60) == 130


def test_an_interrupt_while_the_program_is_imported_is_quiet(environment: dict[str, str]) -> None:
    program = (
        "import sys\n"
        "class Interrupted:\n"
        "    def find_spec(self, name, *_):\n"
        "        if name == 'linkwork.core.commands.main': raise KeyboardInterrupt\n"
        "sys.meta_path.insert(0, Interrupted())\n"
        "from linkwork.__main__ import main\n"
        "main()\n"
    )
    words = [sys.executable, "-c", program]
    ended = subprocess.run(words, env=environment, capture_output=True, preexec_fn=interruptible)
    assert (ended.returncode, ended.stderr) == (130, b"\nInterrupted.\n")


def test_an_interrupt_of_executed_text_has_the_exit_code_too(
    environment: dict[str, str], tmp_path: Path
) -> None:
    """Dataclasses are made so while modules are imported; CPython would end by the signal."""
    program = (
        "import sys\n"
        "class Interrupted:\n"
        "    def find_spec(self, name, *_):\n"
        "        if name.endswith('commands.main'): exec('raise KeyboardInterrupt')\n"
        "sys.meta_path.insert(0, Interrupted())\n"
        "from linkwork.__main__ import main\n"
        "main()\n"
    )
    (tmp_path / "interrupted.py").write_text(program)
    words = [sys.executable, "-m", "interrupted"]
    ended = subprocess.run(words, env=environment, cwd=tmp_path, capture_output=True)
    assert (ended.returncode, ended.stderr) == (130, b"\nInterrupted.\n")


def test_an_interrupted_program_does_what_is_registered_for_its_end_and_deletes_nothing(
    environment: dict[str, str],
) -> None:
    """Deleting everything takes longer than most interrupted work once compiled code is loaded."""
    program = (
        "import atexit, sys, types\n"
        "from linkwork.core.commands import terminal as interrupts\n"
        "class Deleted:\n"
        "    def __del__(self): print('deleted')\n"
        "kept = Deleted()\n"
        "atexit.register(print, 'registered')\n"
        "def command():\n"
        "    if sys.argv[1] == 'quiet': sys.exit(130)\n"
        "    try: interrupts._interrupt(2, None)\n"
        "    except KeyboardInterrupt: sys.exit(130)\n"
        "sys.modules['linkwork.core.commands.main'] = types.SimpleNamespace(main=command)\n"
        "from linkwork.__main__ import main\n"
        "main()\n"
    )
    words = [sys.executable, "-c", program]
    ended = subprocess.run([*words, "interrupted"], env=environment, capture_output=True)
    assert (ended.returncode, ended.stdout.split()) == (130, [b"registered"])
    ended = subprocess.run([*words, "quiet"], env=environment, capture_output=True)
    assert (ended.returncode, ended.stdout.split()) == (130, [b"registered", b"deleted"])


def test_an_interrupt_of_a_deletion_is_not_lost(environment: dict[str, str]) -> None:
    program = (
        "import os, signal, sys, time, types\n"
        "class Deleted:\n"
        "    def __del__(self): os.kill(os.getpid(), signal.SIGINT); time.sleep(0)\n"
        "def command():\n"
        "    Deleted()\n"
        "    for _ in range(60): time.sleep(0.1)\n"
        "sys.modules['linkwork.core.commands.main'] = types.SimpleNamespace(main=command)\n"
        "from linkwork.__main__ import main\n"
        "main()\n"
    )
    words = [sys.executable, "-c", program]
    ended = subprocess.run(words, env=environment, capture_output=True, preexec_fn=interruptible)
    assert (ended.returncode, ended.stderr) == (130, b"\nInterrupted.\n")


@pytest.mark.parametrize("loses", ["raise ValueError", "pass"])
def test_an_interrupt_that_a_library_loses_is_one_all_the_same(
    environment: dict[str, str], loses: str
) -> None:
    program = (
        "import os, signal, sys, time\n"
        "import linkwork.families.family as command\n"
        "def compiling(tell):\n"
        "    try:\n"
        "        os.kill(os.getpid(), signal.SIGINT)\n"
        "        time.sleep(60)\n"
        f"    except KeyboardInterrupt: {loses}\n"
        "    tell(0.5)\n"
        "    print('not reached')\n"
        "sys.argv = ['linkwork', 'compile']\n"
        "from linkwork.__main__ import main\n"
        "command.compile_kernels = compiling\n"
        "main()\n"
    )
    words = [sys.executable, "-c", program]
    ended = subprocess.run(words, env=environment, capture_output=True, preexec_fn=interruptible)
    assert (ended.returncode, ended.stdout, ended.stderr) == (130, b"", b"\nInterrupted.\n")


def test_an_interrupt_at_the_very_end_changes_nothing(environment: dict[str, str]) -> None:
    program = (
        "import atexit, os, signal, sys\n"
        "atexit.register(os.kill, os.getpid(), signal.SIGINT)\n"
        "sys.argv = ['linkwork', '--version']\n"
        "from linkwork.__main__ import main\n"
        "main()\n"
    )
    words = [sys.executable, "-c", program]
    ended = subprocess.run(words, env=environment, capture_output=True, preexec_fn=interruptible)
    assert (ended.returncode, ended.stderr) == (0, b"")


def _wait_until_it_reads(pid: int) -> None:
    """Until the process sleeps in a read of its standard input."""
    channel = Path(f"/proc/{pid}/wchan")
    if not channel.exists():
        pytest.skip("needs /proc")
    for _ in range(600):
        if "pipe_read" in channel.read_text(encoding="ascii"):
            return
        time.sleep(0.05)
    pytest.skip("the kernel does not tell what the process waits for")


@pytest.mark.parametrize("encoding", thinned(["ascii", "latin-1", "utf-8"]))
def test_pipes_get_utf8_whatever_the_locale(start: Start, encoding: str) -> None:
    text = start("examples", "rapier-drive").stdout
    for words in (("solve", "-"), ("sweep", "-", "--csv", "-")):
        done = start(*words, stdin=text, PYTHONIOENCODING=encoding)
        assert (done.returncode, done.stderr) == (0, b"")
        assert "θ12" in done.stdout.decode("utf-8")


def _in_terminal(words: list[str], environment: dict[str, str], until: bytes = b"") -> bytes:
    """What a terminal shows of a command, which is interrupted when it has shown ``until``."""
    inside, outside = pty.openpty()
    with subprocess.Popen(
        [sys.executable, "-m", "linkwork", *words],
        env=environment,
        stdout=outside,
        stderr=outside,
        preexec_fn=interruptible,
    ) as process:
        os.close(outside)
        shown = b""
        while True:
            try:
                piece = os.read(inside, 65536)
            except OSError:  # the other side is closed
                break
            if not piece:
                break
            shown += piece
            if until and until in shown:
                process.send_signal(signal.SIGINT)
                until = b""
        process.wait(60)
    os.close(inside)
    return shown.replace(b"\r\n", b"\n")


def test_a_terminal_without_greek_shows_question_marks(
    start: Start, folder: Path, environment: dict[str, str]
) -> None:
    start("examples", "rapier-drive", "-o", "r.toml")
    poor = {**environment, "PYTHONIOENCODING": "latin-1", "NO_COLOR": "1"}
    shown = _in_terminal(["solve", "r.toml"], poor)
    assert shown.startswith(b"Rapier drive of a loom\nPosition found at ?12 = 60 deg\n")


def test_colour_appears_on_a_terminal_only_and_not_if_unwelcome(
    start: Start, environment: dict[str, str]
) -> None:
    welcome = {k: v for k, v in environment.items() if k != "NO_COLOR"} | {"TERM": "xterm"}
    assert b"\x1b[32mPosition found\x1b[0m" in _in_terminal(["solve", "four-bar.toml"], welcome)
    for changes in ({"NO_COLOR": "1"}, {"TERM": "dumb"}):
        shown = _in_terminal(["solve", "four-bar.toml"], welcome | changes)
        assert b"Position found" in shown
        assert b"\x1b" not in shown
    assert b"\x1b" not in start("solve", "four-bar.toml").stdout


NEVER = """\
format = 1
[loops]
L = "4*e^(i*2^0.5*p) + 10*e^(i*p) = s*e^(i*q)"
[guess]
p = 0
q = 0
s = 14
[input]
variable = "p"
"""


def test_progress_is_shown_on_a_terminal_after_a_second_only(
    start: Start, folder: Path, environment: dict[str, str]
) -> None:
    terminal = environment | {"TERM": "xterm"}
    # 9,000 turns of a motion that does not repeat itself take many seconds on any machine
    (folder / "never.toml").write_text(NEVER, encoding="utf-8")
    slow = ["sweep", "never.toml", "--from", "0", "--to", "3.24e6", "--step", "3000"]
    shown = _in_terminal(slow, terminal, until=b"sweeping  [")
    assert b"sweeping  [" in shown
    assert b"sweeping  [" not in shown.split(b"\x1b[?25h")[-1]  # the bar is gone at the end
    assert b"sweeping" not in _in_terminal(["sweep", "four-bar.toml"], terminal)


def test_the_version_is_that_of_the_installed_package(start: Start, folder: Path) -> None:
    metadata = folder / "linkwork-7.8.9.dist-info"
    metadata.mkdir()
    (metadata / "METADATA").write_text("Metadata-Version: 2.1\nName: linkwork\nVersion: 7.8.9\n")
    source = Path(__file__).parents[3] / "src"
    done = start("--version", PYTHONPATH=f"{folder}{os.pathsep}{source}")
    assert done.stdout == b"linkwork 7.8.9\n"


@pytest.mark.parametrize("words", [("schema",), ("solve", "four-bar.toml")])
def test_a_full_disk_is_said_once(words: tuple[str, ...], environment: dict[str, str]) -> None:
    full = Path("/dev/full")
    if not full.exists():
        pytest.skip("needs /dev/full")
    with full.open("wb") as disk:
        done = subprocess.run(
            [sys.executable, "-m", "linkwork", *words],
            env=environment,
            stdout=disk,
            stderr=subprocess.PIPE,
            check=False,
        )
    assert (done.returncode, done.stderr) == (2, b"Error: No space left on device\n")
