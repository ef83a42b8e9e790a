"""Draws the pictures of docs/plots.md with the commands on the page.

Every command ``linkwork plot NAME.toml -o FILE.png …`` is run for the mechanism NAME of the
library, and its picture is stored next to the page.
"""

from __future__ import annotations

import shlex
import sys
import tempfile
from io import BytesIO
from pathlib import Path

from click.testing import CliRunner
from PIL import Image  # comes with Matplotlib

import linkwork as lw
from linkwork.core.commands.main import linkwork

ROOT = Path(__file__).resolve().parents[1]
PAGE = ROOT / "docs" / "plots.md"
PICTURES = ROOT / "docs" / "images" / "plots"
_COMMAND = "linkwork plot "
_COLOURS = 256
_WIDTH = 695  # pixels


def main() -> None:
    """Run every command of the page."""
    lines = PAGE.read_text(encoding="utf-8").splitlines()
    commands = dict.fromkeys(line for line in lines if line.startswith(_COMMAND))
    PICTURES.mkdir(parents=True, exist_ok=True)
    for old in PICTURES.glob("*.png"):
        old.unlink()
    for command in commands:
        _draw(command)
    sys.stdout.write(f"Drew {len(commands)} pictures of {PAGE.relative_to(ROOT)}.\n")


def _draw(command: str) -> None:
    words = shlex.split(command)[1:]
    name, picture = words[1].removesuffix(".toml"), words[words.index("-o") + 1]
    with tempfile.TemporaryDirectory() as folder:
        file, drawn = Path(folder, words[1]), Path(folder, picture)
        file.write_text(lw.example_text(name), encoding="utf-8")
        asked = [{words[1]: str(file), picture: str(drawn)}.get(word, word) for word in words]
        done = CliRunner().invoke(linkwork, asked)
        if not drawn.exists():
            raise SystemExit(f"{command}\n{done.output}")
        _write_small(drawn.read_bytes(), PICTURES / picture)


def _write_small(png: bytes, path: Path) -> None:
    """Writes a picture with a palette: a quarter of its size."""
    picture = Image.open(BytesIO(png)).convert("RGB")
    height = round(picture.height * _WIDTH / picture.width)
    small = picture.resize((_WIDTH, height), Image.Resampling.LANCZOS)
    small.quantize(_COLOURS, Image.Quantize.MAXCOVERAGE, dither=Image.Dither.NONE).save(
        path, optimize=True
    )


if __name__ == "__main__":
    main()
