"""The reference page of all quantities, from their registry."""

from __future__ import annotations

from collections.abc import Mapping

from linkwork.core.results.quantities.registry import (
    EVIDENCE,
    MOTION_QUANTITIES,
    RATES,
    ROW_QUANTITIES,
)

__all__ = ["quantity_page"]


def quantity_page() -> str:
    """Quantities of rows and of motions, rates and evidence, as Markdown."""
    parts = [
        "# List of quantities\n",
        "From the registry that Python, files, plots, pages and workbooks share;",
        "[quantities](quantities.md) explains where names can be used.\n",
        "## Of every position\n",
        "In addition to inputs, unknowns, links, sliders, outputs, and coordinates of points:\n",
        "| name | meaning | derivatives |\n|---|---|---|",
    ]
    parts += [
        f"| `….{row.word}` | {row.about} | {max(0, 2 - row.needs)} |" for row in ROW_QUANTITIES
    ]
    parts += _table("Rates", {f".{rate.value}": meaning for rate, meaning in RATES.items()})
    parts += _table("Of a whole motion", {f"{own.word}(…)": own.about for own in MOTION_QUANTITIES})
    parts += _table("Evidence", EVIDENCE)
    parts.append("\n## Of a machine with forces\n")
    parts.append("```{terminal}\nlinkwork quantities compressor\n```\n")
    return "\n".join(parts)


def _table(title: str, rows: Mapping[str, str]) -> list[str]:
    lines = [f"| `{name}` | {meaning} |" for name, meaning in rows.items()]
    return [f"\n## {title}\n", "| name | meaning |\n|---|---|", *lines]
