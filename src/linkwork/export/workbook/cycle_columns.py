"""The columns of the sheet of positions."""

from __future__ import annotations

from dataclasses import dataclass

from linkwork.equations.compiling import coordinate_name
from linkwork.export.workbook.book import CYCLE, Book, column_name
from linkwork.foundation.names import canonical

__all__ = ["CycleColumns", "planned_cycle"]


@dataclass(frozen=True, kw_only=True)
class CycleColumns:
    """The columns of the sheet; ``largest`` is the column of differences."""

    of: dict[str, int]
    equations: tuple[int, ...]
    squares: int
    as_solved: int
    largest: int
    closes: int
    status: int
    groups: tuple[tuple[str, int, int], ...]


def planned_cycle(book: Book) -> CycleColumns:
    """Number the columns and name them."""
    of: dict[str, int] = {}
    groups: list[tuple[str, int, int]] = []
    place = 1

    def group(title: str, keys: list[str]) -> None:
        nonlocal place
        for key in keys:
            of[key] = place
            place += 1
        if keys:
            groups.append((title, place - len(keys), place - 1))

    equations = book.model.equations
    group("Input", [v.symbol for v in equations.inputs])
    group("Unknowns", [v.symbol for v in equations.unknowns])
    rows = sorted(
        (row.name for block in book.closure.blocks for row in block.rows),
        key=lambda name: int(name[1:]),
    )
    group("Equations, 0 where they close", [f"row {name}" for name in rows])
    squares, place = place, place + (1 if rows else 0)
    group("Links that turn with another link", [canonical(link) for link in book.closure.links])
    group("Outputs", [f"output {name}" for name in book.closure.outputs])
    points = book.closure.points
    group("Points", [coordinate_name(point, axis) for point in points for axis in "xy"])
    groups.append(("Check", place, place + 3))
    book.names.claim("as_solved", "as_solved")
    of["as_solved"] = place
    for key, column in of.items():
        if key in book.names.cells:
            book.define(key, CYCLE, f"${column_name(column)}1")
    return CycleColumns(
        of=of,
        equations=tuple(of[f"row {name}"] for name in rows),
        squares=squares if rows else -1,
        as_solved=place,
        largest=place + 1,
        closes=place + 2,
        status=place + 3,
        groups=tuple(groups),
    )
