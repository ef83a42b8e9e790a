"""Builds the site: scripts/docs [OUT] [--app FOLDER]."""

from __future__ import annotations

import argparse
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from scripts.docsite.api_page import api_page
from scripts.docsite.command_page import command_page
from scripts.docsite.file_page import file_page
from scripts.docsite.live_pages import moving_examples, write_library_pages
from scripts.docsite.page_blocks import check_pages
from scripts.docsite.quantity_page import quantity_page
from scripts.docsite.text_files import write_whole

ROOT = Path(__file__).resolve().parents[2]
_PICTURE = re.compile(r'<img src="(images/gallery/([^"]+)\.svg)" alt="([^"]*)">')
#: Pages that are made from the package: the public names, the parser, the schema, the registry.
_GENERATED = {
    "python": api_page,
    "commands": command_page,
    "file-keys": file_page,
    "quantity-list": quantity_page,
}
#: Links of pages to files and folders that are not pages of the site.
_OUTSIDE = {
    "[benchmarks/peers/requirements.txt](../benchmarks/peers/requirements.txt)": (
        "`benchmarks/peers/requirements.txt`"
    ),
    "[examples/notebook.ipynb](../examples/notebook.ipynb)": "`examples/notebook.ipynb`",
}


def main() -> int:
    """Build the site; returns the exit status."""
    parser = argparse.ArgumentParser(prog="scripts/docs", description=__doc__)
    parser.add_argument("out", nargs="?", type=Path, default=ROOT / "build" / "site")
    parser.add_argument("--app", type=Path, help="a folder that `linkwork web` wrote")
    asked = parser.parse_args()
    out = asked.out.resolve()
    if asked.app is not None and not (asked.app / "index.html").is_file():
        parser.error(f"{asked.app} has no index.html: write it with `linkwork web {asked.app}`")
    if _blocks_fail():
        return 1
    moving = moving_examples()
    write_library_pages(out, moving)
    if asked.app is not None:
        shutil.copytree(asked.app, out / "app", dirs_exist_ok=True)
    with tempfile.TemporaryDirectory() as scratch:
        source, doctrees = Path(scratch) / "source", Path(scratch) / "doctrees"
        shutil.copytree(ROOT / "docs", source)
        for name, page in _GENERATED.items():
            (source / f"{name}.md").write_text(page(), encoding="utf-8")
        _adapt(source, set(moving), asked.app is not None)
        for builder, to in (("html", out), ("text", Path(scratch) / "text")):
            done = _sphinx(builder, source, doctrees, to, asked.app is not None)
            if done:
                return done
        write_whole(Path(scratch) / "text", doctrees, out)
    sys.stdout.write(f"Wrote {out / 'index.html'}.\n")
    return 0


def _blocks_fail() -> bool:
    """Run the blocks that pages show; print those that fail."""
    pages = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
    checked = check_pages(pages)
    errors = [error for page in checked for error in page.errors]
    sys.stderr.writelines(f"{error}\n" for error in errors)
    left = sum(len(page.left) for page in checked)
    sys.stdout.write(
        f"{sum(page.run for page in checked)} blocks run, {left} left with a reason.\n"
    )
    return bool(errors)


def _sphinx(builder: str, source: Path, doctrees: Path, to: Path, app: bool) -> int:
    """Run Sphinx; a warning, and a reference without a target, is an error."""
    strict = [sys.executable, "-m", "sphinx", "-n", "-W", "--keep-going", "-q", "-j", "2"]
    settings = ["-D", f"linkwork_app={int(app)}", "-b", builder, "-d", str(doctrees)]
    command = [*strict, *settings, str(source), str(to)]
    return subprocess.run(command, cwd=ROOT, check=False).returncode


def _adapt(source: Path, moving: set[str], app: bool) -> None:
    """Lead links of the copied pages to the site, pictures of the gallery to moving pages."""

    def picture(found: re.Match[str]) -> str:
        path, name, alt = found.groups()
        to = f"app/index.html#example={name}" if app else f"_live/{name}.html"
        target = [f":target: {to}"] if name in moving else []
        return "\n".join(["```{image} " + path, f":alt: {alt}", *target, "```"])

    for page in source.rglob("*.md"):
        text = page.read_text(encoding="utf-8")
        for before, after in _OUTSIDE.items():
            text = text.replace(before, after)
        page.write_text(_PICTURE.sub(picture, text), encoding="utf-8")


if __name__ == "__main__":
    sys.exit(main())
