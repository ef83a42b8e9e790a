"""The pictures of the README: the moving rapier drive, and the card for links to the project.

python scripts/readme_pictures.py  writes docs/images/rapier-drive.webp and docs/images/card.png
"""

from __future__ import annotations

import sys
from io import BytesIO
from pathlib import Path

from PIL import Image, ImageDraw, ImageFont

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT / "src")]

import matplotlib as mpl

import linkwork as lw

IMAGES = ROOT / "docs" / "images"
_FONTS = Path(mpl.get_data_path()) / "fonts" / "ttf"
_CARD = (1280, 640)  # pixels that sites show of a link
_INK, _PAPER, _PALE = "#14212b", "#ffffff", "#4a5a66"


def moving_picture() -> None:
    """The rapier drive over one turn of its crank."""
    drive = lw.example("rapier-drive")
    options = lw.app.FilmOptions(fps=24, rows=72, dpi=120)
    drive.animate(IMAGES / "rapier-drive.webp", options=options)


def card() -> None:
    """Name, one sentence and a mechanism."""
    buffer = BytesIO()
    path = IMAGES / "card.png"
    lw.example("jansen-leg").draw(path, options=lw.SceneOptions(title="", further=12))
    drawn = Image.open(path).convert("RGB")
    drawn.thumbnail((600, 560))
    picture = Image.new("RGB", _CARD, _PAPER)
    picture.paste(drawn, (_CARD[0] - drawn.width - 40, (_CARD[1] - drawn.height) // 2))
    pen = ImageDraw.Draw(picture)
    pen.text((60, 150), "Linkwork", _INK, ImageFont.truetype(_FONTS / "DejaVuSans-Bold.ttf", 92))
    words = "Planar mechanisms,\nsolved from their\nloop equations,\nevery position proved."
    pen.multiline_text(
        (64, 290), words, _PALE, ImageFont.truetype(_FONTS / "DejaVuSans.ttf", 42), spacing=14
    )
    picture.save(buffer, "PNG", optimize=True)
    path.write_bytes(buffer.getvalue())


if __name__ == "__main__":
    moving_picture()
    card()
