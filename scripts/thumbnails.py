"""The library as the start page shows it: what every mechanism is for, and a small moving picture.

python scripts/thumbnails.py            writes src/linkwork/app/library.json
python scripts/thumbnails.py --check    checks that it is current
"""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

import numpy as np

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT / "src")]

import linkwork as lw
from linkwork.app.pages.packing import play_order
from linkwork.core.drawing.mechanism_scene import reach_of
from linkwork.core.mechanism.bodies import (
    Contour,
    DiscFigure,
)
from linkwork.core.mechanism.skeleton import Skeleton

TARGET = ROOT / "src" / "linkwork" / "app" / "library.json"
FRAMES = 24
SIZE = 200  # of the larger side of a picture, in whole numbers


def entry(name: str) -> dict[str, Any]:
    """One mechanism: name, title, purpose, family, and its picture if it has points."""
    mechanism = lw.example(name)
    description = mechanism.description
    found: dict[str, Any] = {
        "name": name,
        "title": description.name,
        "purpose": description.purpose,
        "family": description.family,
    }
    picture = thumbnail(mechanism)
    return found | ({"picture": picture} if picture else {})


def thumbnail(mechanism: lw.Mechanism) -> dict[str, Any] | None:
    """Frames of coordinates, and what is drawn between them."""
    if not mechanism.description.inputs:
        position = mechanism.solve()
        if not position.points:
            return None
        places = np.array([[complex(*place) for place in position.points.values()]])
        return picture(position.skeleton, list(position.points), places, closed=False)
    motion = mechanism.sweep(through=True, certify=False)
    if not motion.points or not motion.found.any():
        return None
    order, closed = play_order(motion)
    count = min(FRAMES, len(order))
    rows = order[np.linspace(0, len(order) - 1, count + closed).round().astype(int)[:count]]
    places = np.array([motion.trace(name)[rows] for name in motion.points]).T
    traces = {name: motion.trace(name)[order] for name in motion.skeleton.traced}
    turns = {
        name: np.degrees(angle.value[rows] * motion.units.angle.radians)
        for name, angle in motion.links.items()
    }
    box = reach_of(motion)
    return picture(motion.skeleton, list(motion.points), places, closed, traces, turns, box.edges)


def picture(
    skeleton: Skeleton,
    names: list[str],
    places: Any,
    closed: bool,
    traces: dict[str, Any] | None = None,
    turns: dict[str, Any] | None = None,
    edges: tuple[float, ...] = (),
) -> dict[str, Any]:
    """Coordinates in whole numbers, y down."""
    discs = [figure for figure in skeleton.figures if isinstance(figure, DiscFigure)]
    around = [places.ravel(), *(places[:, names.index(d.center)] + d.radius * 1j**k
                                for d in discs for k in range(4))]  # fmt: skip
    if edges:
        around.append(np.array([complex(edges[0], edges[1]), complex(edges[2], edges[3])]))
    every = np.concatenate(around)
    left, bottom = every.real.min(), every.imag.min()
    size = max(np.ptp(every.real), np.ptp(every.imag)) or 1.0
    high = np.ptp(every.imag) / size * SIZE

    def outline(contour: Contour) -> dict[str, Any]:
        points = np.array(contour.points)[:: max(1, len(contour.points) // 60)] / size * SIZE
        angles = (turns or {}).get(contour.link, np.zeros(len(places)))
        return {
            "center": names.index(contour.center),
            "points": np.round(np.stack([points.real, -points.imag], -1))
            .astype(int)
            .ravel()
            .tolist(),
            "closed": contour.closed,
            "turns": np.round(-angles).astype(int).tolist(),
        }

    def scaled(z: Any) -> list[int]:
        x, y = (z.real - left) / size * SIZE, high - (z.imag - bottom) / size * SIZE
        return np.round(np.stack([x, y], axis=-1)).astype(int).ravel().tolist()

    return {
        "box": [round(np.ptp(every.real) / size * SIZE), round(high)],
        "closed": bool(closed),
        "bars": [[names.index(p) for p in bar.points] for bar in skeleton.bars],
        "fixed": [names.index(p) for p in skeleton.fixed if p in skeleton.pins],
        "pins": [names.index(p) for p in skeleton.pins],
        "blocks": [
            [names.index(g.point), *(names.index(p) for p in g.line)]
            for g in skeleton.guides
            if g.block
        ],
        "discs": [[names.index(d.center), round(d.radius / size * SIZE)] for d in discs],
        "outlines": [outline(one) for one in skeleton.figures if isinstance(one, Contour)],
        "traces": [scaled(path[:: max(1, len(path) // 60)]) for path in (traces or {}).values()],
        "frames": [scaled(row) for row in places],
    }


def written() -> str:
    """The file."""
    entries = [entry(name) for name in lw.examples() if not name.startswith("newton-")]
    lines = ",\n".join(
        json.dumps(one, ensure_ascii=False, separators=(",", ":")) for one in entries
    )
    return f"[\n{lines}\n]\n"


def main(arguments: list[str]) -> int:
    text = written()
    if arguments != ["--check"]:
        TARGET.write_text(text, encoding="utf-8")
        return 0
    if TARGET.exists() and TARGET.read_text(encoding="utf-8") == text:
        return 0
    sys.stderr.write(f"{TARGET.name} is not current: run scripts/thumbnails.py\n")
    return 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
