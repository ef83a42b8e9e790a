"""Measures how much a maintainer has to read: scripts/house

A measure has a goal and a ceiling. Exit status 1 if one is above its ceiling; ceilings only fall.
"""

from __future__ import annotations

import ast
import io
import subprocess
import sys
import tempfile
import tokenize
from collections import Counter
from collections.abc import Callable, Iterator
from pathlib import Path

SOURCE = Path(__file__).resolve().parents[1] / "src" / "linkwork"
#: Each measure with its goal and its ceiling.
BOUNDS = {
    "code lines": (84_000, 90_010),
    "code lines of the core": (27_000, 30_630),
    "files": (380, 383),
    "files of the core": (130, 127),
    "lines that import or list names": (7_000, 8_190),
    "arrows between rooms": (70, 35),
    "imports of wings in the core": (0, 0),
    "names at the root": (60, 60),
    "methods of Mechanism": (24, 24),
    "modules entered by a warm solve": (40, 22),
    "modules entered by a warm sweep to CSV": (45, 52),
    "modules entered by warm forces": (60, 49),
    "modules entered by a frame of a drag": (60, 74),
    "modules loaded by linkwork solve": (110, 106),
    "modules loaded by linkwork sweep --csv": (130, 116),
}
#: Tokens that are not code.
_LAYOUT = {
    tokenize.COMMENT, tokenize.NL, tokenize.NEWLINE, tokenize.INDENT, tokenize.DEDENT,
    tokenize.ENDMARKER,
}  # fmt: skip
_DOCUMENTED = ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef


def code_lines(text: str) -> int:
    """Lines with code: without docstrings, comments and blank lines."""
    lines = {
        line
        for token in tokenize.generate_tokens(io.StringIO(text).readline)
        if token.type not in _LAYOUT
        for line in range(token.start[0], token.end[0] + 1)
    }
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, _DOCUMENTED) and ast.get_docstring(node, clean=False) is not None:
            lines.difference_update(_lines(node.body[0]))
    return len(lines)


def import_lines(text: str) -> int:
    """Lines of import statements and of ``__all__``."""
    found: set[int] = set()
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Import | ast.ImportFrom) or (
            isinstance(node, ast.Assign)
            and isinstance(node.targets[0], ast.Name)
            and node.targets[0].id == "__all__"
        ):
            found.update(_lines(node))
    return len(found)


def _lines(node: ast.stmt) -> range:
    return range(node.lineno, (node.end_lineno or node.lineno) + 1)


def arrows(texts: dict[Path, str]) -> Counter[tuple[str, str]]:
    """Imports between rooms (the folders at the top), counted by importing and imported room."""
    found = Counter(
        (path.parts[0], name.split(".")[1])
        for path, text in texts.items()
        if len(path.parts) > 1
        for name in _imported(text)
        if name != "linkwork.wings"
    )
    return Counter({pair: count for pair, count in found.items() if pair[0] != pair[1]})


def _imported(text: str) -> Iterator[str]:
    """Modules that are imported when a file runs, or by a package when a name is first used."""
    tree = ast.parse(text)
    lazy = "__getattr__" in text
    only_types = {
        id(statement)
        for node in ast.walk(tree)
        if isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING" and not lazy
        for statement in node.body
    }
    for node in ast.walk(tree):
        if id(node) in only_types:
            continue
        if isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom) and node.module:
            names = [f"{node.module}.{alias.name}" for alias in node.names]
        else:
            continue
        yield from (name for name in names if name.startswith("linkwork."))


def entered(call: Callable[[], object]) -> int:
    """Modules of Linkwork in which a function runs during the second of two calls."""
    call()
    files: set[str] = set()
    sys.setprofile(lambda frame, event, _: files.add(frame.f_code.co_filename))
    try:
        call()
    finally:
        sys.setprofile(None)
    return sum(Path(file).is_relative_to(SOURCE) for file in files)


def loaded(*words: str) -> int:
    """Modules of Linkwork that a command loads in a new process."""
    script = (
        "import sys\nfrom linkwork.__main__ import main\n"
        f"sys.argv = ['linkwork', *{words!r}]\n"
        "try:\n    main()\nexcept SystemExit:\n    pass\n"
        "sys.stderr.write(str(sum(m.partition('.')[0] == 'linkwork' for m in sys.modules)))"
    )
    ran = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    return int(ran.stderr.rpartition("\n")[2])


def measured() -> dict[str, int]:
    """All measures by name."""
    texts = {p.relative_to(SOURCE): p.read_text("utf-8") for p in sorted(SOURCE.rglob("*.py"))}
    code = {path: code_lines(text) for path, text in texts.items()}
    rooms = arrows(texts)
    core = [path for path in texts if path.parts[0] == "core"]
    return {
        "code lines": sum(code.values()),
        "code lines of the core": sum(code[path] for path in core),
        "files": len(texts),
        "files of the core": len(core),
        "lines that import or list names": sum(import_lines(text) for text in texts.values()),
        "arrows between rooms": len(rooms),
        "imports of wings in the core": sum(n for (room, _), n in rooms.items() if room == "core"),
        **_of_calls(),
        "modules loaded by linkwork solve": loaded("solve", "four-bar"),
        "modules loaded by linkwork sweep --csv": loaded("sweep", "four-bar", "--csv", "-"),
    }


def _of_calls() -> dict[str, int]:
    import linkwork as lw
    from linkwork.app.live.opened_file import MechanismFile, new_file
    from linkwork.app.live.requests import MovePoint
    from linkwork.app.live.workbench import Workbench
    from linkwork.core.results.tables import csv_text

    four_bar = lw.example("four-bar")
    loaded_one = lw.example("compressor")
    with tempfile.TemporaryDirectory() as folder:
        file = MechanismFile(Path(folder) / "four-bar.toml", new_file("four-bar").text)
        bench = Workbench(file, lw.loads)
        frames = iter([30.0, 31.0])
        return {
            "names at the root": len(getattr(lw, "__all__")),  # noqa: B009
            "methods of Mechanism": sum(
                callable(getattr(lw.Mechanism, name))
                for name in dir(lw.Mechanism)
                if name[0] != "_"
            ),
            "modules entered by a warm solve": entered(lambda: four_bar.solve(at=60)),
            "modules entered by a warm sweep to CSV": entered(
                lambda: csv_text(four_bar.sweep(step=10).table())
            ),
            "modules entered by warm forces": entered(lambda: loaded_one.forces(at=60)),
            "modules entered by a frame of a drag": entered(
                lambda: bench.handle(MovePoint(point="A", x=next(frames), y=30, live=True))
            ),
        }


def main() -> int:
    """Print the table; returns the exit status."""
    above = 0
    for name, value in measured().items():
        goal, ceiling = BOUNDS[name]
        state = "ABOVE ITS CEILING" if value > ceiling else "" if value <= goal else "not yet"
        above += value > ceiling
        sys.stdout.write(f"{name:40} {value:>7}   goal {goal:>6}   {state}".rstrip() + "\n")
    return 1 if above else 0


if __name__ == "__main__":
    sys.exit(main())
