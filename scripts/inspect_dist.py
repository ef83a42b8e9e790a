"""Checks the output of scripts/build: python scripts/inspect_dist.py dist

The wheel contains all files of src/linkwork, including data; the sdist contains
everything needed for tests and builds.
"""

from __future__ import annotations

import sys
import tarfile
import zipfile
from pathlib import Path

TREE = Path(__file__).resolve().parent.parent
PACKAGE_DATA = (
    "linkwork/py.typed",
    "linkwork/library/*.toml",
    "linkwork/circuits/*.toml",
    "linkwork/core/textfile/*.json",
    "linkwork/app/static/*.css",
    "linkwork/app/static/*.js",
)
SDIST_PARTS = ("LICENSE", "README.md", "docs", "examples", "pyproject.toml", "src", "tests")


def wheel_problems(wheel: Path) -> list[str]:
    """Problems of the wheel, one sentence each."""
    with zipfile.ZipFile(wheel) as archive:
        inside = {Path(name) for name in archive.namelist()}
    package = TREE / "src" / "linkwork"
    wanted = {
        path.relative_to(package.parent)
        for path in package.rglob("*")
        if path.is_file() and "__pycache__" not in path.parts
    }
    problems = [f"{wheel.name} lacks {path}" for path in sorted(wanted - inside)]
    problems += [
        f"{wheel.name} has no {pattern}"
        for pattern in PACKAGE_DATA
        if not any(path.match(pattern) for path in inside)
    ]
    if not wheel.name.endswith("-py3-none-any.whl"):
        problems.append(f"{wheel.name} is not a pure-Python wheel (py3-none-any)")
    return problems


def sdist_problems(sdist: Path) -> list[str]:
    """Problems of the sdist, one sentence each."""
    with tarfile.open(sdist) as archive:
        parts = {Path(name).parts[1] for name in archive.getnames() if "/" in name}
    return [f"{sdist.name} lacks {part}" for part in SDIST_PARTS if part not in parts]


def main(folder: Path) -> int:
    """Exit status: 0 if both distributions are there and complete."""
    wheels = list(folder.glob("linkwork-*.whl"))
    sdists = list(folder.glob("linkwork-*.tar.gz"))
    if len(wheels) != 1 or len(sdists) != 1:
        found = ", ".join(sorted(path.name for path in folder.iterdir())) or "nothing"
        sys.stderr.write(f"{folder}: expected one wheel and one sdist, found {found}\n")
        return 1
    problems = wheel_problems(wheels[0]) + sdist_problems(sdists[0])
    sys.stderr.writelines(problem + "\n" for problem in problems)
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1])))
