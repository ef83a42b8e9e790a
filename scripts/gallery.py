"""Writes docs/gallery.md, one drawing for each mechanism of the library, and the figures of
docs/pictures.md.

A mechanism's law is the first docstring line of its test.
"""

from __future__ import annotations

import sys
from importlib import import_module
from io import BytesIO
from pathlib import Path
from typing import Any
from urllib.parse import quote

from PIL import Image  # comes with Matplotlib

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))  # for the register of laws in the tests

import linkwork as lw
from linkwork.core import drawing
from linkwork.core.drawing.scene import LIGHT
from linkwork.core.drawing.vector_files import Inks, inline_svg
from tests.library.laws import LAWS

PICTURES = ROOT / "docs" / "images" / "gallery"
PAGE = ROOT / "docs" / "gallery.md"
FIGURES = ROOT / "docs" / "images" / "pictures"
_LONGEST = 380.0  # longer side of a drawing on the page [pixels]
_DIGITS = 4  # of coordinates: a twentieth of a pixel
_LARGER = 1.4  # names are legible at this size
_COLOURS = 96
_FIGURE_DPI = 80.0
#: Figures of docs/pictures.md: mechanism, theme, and the arguments of its scene.
_SHOWN: dict[str, tuple[str, str, dict[str, Any]]] = {
    "vectors": ("rapier-drive", "light", {"vectors": True}),
    "rates": ("slider-crank", "light", {"velocities": True, "accelerations": True}),
    "speed": ("jansen-leg", "dark", {"speed": True}),
    "centres": ("elliptic-trammel", "light", {"centres": True, "centrodes": ("rod",)}),
    "dimensions": ("four-bar", "light", {"dimensions": True}),
}
_HEAD = """# Gallery

All mechanisms of the library: what each is for, and a law that a test in `tests/library` checks.
`linkwork examples NAME` prints a file with its source. `scripts/gallery` writes this page.
"""


def main() -> None:
    """Write the page and the pictures."""
    PICTURES.mkdir(parents=True, exist_ok=True)
    for old in PICTURES.iterdir():
        old.unlink()
    laws = {name: tests[0] for name, tests in sorted(_laws().items())}
    families: dict[str, list[str]] = {}
    for name in lw.examples():
        families.setdefault(lw.example(name).description.family or "other", []).append(name)
    lines = [_HEAD]
    for family in sorted(families, key=str.casefold):
        lines += [f"## {family[0].upper()}{family[1:]}", ""]
        for name in families[family]:
            lines += _entry(name, laws.get(name, ""))
    PAGE.write_text("\n".join(lines).rstrip() + "\n", encoding="utf-8")
    count = len(list(PICTURES.iterdir())) + _figures()
    sys.stdout.write(f"Wrote {PAGE.relative_to(ROOT)} and {count} pictures.\n")


def _figures() -> int:
    """Write the figures of picture options; returns their number."""
    FIGURES.mkdir(parents=True, exist_ok=True)
    for figure, (name, theme, shown) in _SHOWN.items():
        wanted = dict(shown)
        vectors = wanted.pop("vectors", False)
        scene = lw.example(name).scene(vectors=vectors, options=drawing.SceneOptions(**wanted))
        page = drawing.render(
            scene, "png", dpi=_FIGURE_DPI, theme=drawing.theme_named(theme, drawing.THEMES)
        )
        _write_small(page, FIGURES / f"{figure}.png")
    return len(_SHOWN)


def _laws() -> dict[str, list[str]]:
    """The first lines of the tests that state the laws, by mechanism."""
    for path in sorted((ROOT / "tests" / "library").glob("test_*.py")):
        import_module(f"tests.library.{path.stem}")
    return {name: [_first_line(test) for test in tests] for name, tests in LAWS.items()}


def _first_line(test: object) -> str:
    claim = getattr(test, "__name__", "").removeprefix("test_").replace("_", " ")
    return (test.__doc__ or f"{claim[:1].upper()}{claim[1:]}.").strip().splitlines()[0]


class _LightInks(Inks):
    """Plain colours of the light theme, which every program shows."""

    def of(self, light: str, dark: str) -> str:
        return light or "none"


def _entry(name: str, law: str) -> list[str]:
    mechanism = lw.example(name)
    lines = [f"**{mechanism.name}** (`{name}`)  ", mechanism.description.purpose]
    text = [f"{lines[0]}", f"{lines[1]}  ", f"Law: {law}", ""] if law else [*lines, ""]
    if not getattr(mechanism.description, "points", None):
        return text
    scene = mechanism.scene(options=drawing.SceneOptions(larger=_LARGER))
    drawn = inline_svg(scene, _LightInks(), longest=_LONGEST, digits=_DIGITS)
    head, rest = drawn.split(">", 1)
    x, y, width, height = head.split('viewBox="')[1].split('"')[0].split()
    page = f'{head}><path d="M{x},{y}h{width}v{height}h-{width}z" fill="{LIGHT.background}"/>'
    (PICTURES / f"{name}.svg").write_text(f"{page}{rest}\n", encoding="utf-8")
    source = f"images/gallery/{quote(name)}.svg"
    return [*text, f'<img src="{source}" alt="{mechanism.name}, {scene.caption}">', ""]


def _write_small(png: bytes, path: Path) -> None:
    """Writes a picture with a palette: a quarter of its size."""
    picture = Image.open(BytesIO(png)).convert("RGB").quantize(_COLOURS, dither=Image.Dither.NONE)
    picture.save(path, optimize=True)


if __name__ == "__main__":
    main()
