"""Forces as a page of text: efforts, reactions, totals, and how far the two ways agree."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Any

from linkwork.cli.motion_page import range_lines
from linkwork.cli.terminal import bad, fields, good, sentence, title_lines
from linkwork.cli.text_table import table_lines
from linkwork.foundation.elementwise import phase
from linkwork.results.listing.column import Column
from linkwork.results.listing.force_listing import (
    finite_forces,
    force_fields,
    force_status_fields,
    undefined_fields,
)
from linkwork.results.listing.motion_listing import limit_fields
from linkwork.results.listing.number_text import fixed, significant
from linkwork.results.listing.position_listing import inputs_text
from linkwork.results.motion import Motion
from linkwork.results.reactions import ForceStatus, Reactions
from linkwork.results.stall import Stall
from linkwork.results.table import Table

__all__ = ["motion_forces_lines", "position_forces_lines", "reactions_data"]

_TOTALS = ("shaking", "power", "kinetic_energy", "stored_energy", "load_power", "energy_rate")
_LOSSES = ("friction_power", "efficiency")
_NONE = (
    ForceStatus.NO_POSITION, ForceStatus.NO_RATES, ForceStatus.SELF_LOCKING, ForceStatus.NO_LOAD,
    ForceStatus.HELD,
)  # fmt: skip


def position_forces_lines(found: Reactions, names: Sequence[str] = ()) -> list[str]:
    """All forces at one position, or those asked for."""
    where = inputs_text(
        {name: float(value) for name, value in found.inputs.items()}, found.input_units
    )
    lines = title_lines(found.mechanism)
    if found.status in _NONE:
        why = [("why", found.status.value), *undefined_fields(found)]
        if found.status is ForceStatus.SELF_LOCKING:
            why.append(("proved", "yes" if found.proved else "no"))
        return [*lines, *sentence(bad, "No forces", where), *fields(why)]
    lines += sentence(good, "Forces", where)
    if names:
        return [*lines, "", *_numbers("quantity", found, names)]
    vectors = [stem for stem in _stems(found) if not stem.startswith("shaking")]
    pairs = {f"{stem}.{axis}" for stem in vectors for axis in "xy"}
    totals = [name for name in found.values if name.partition(".")[0] in (*_TOTALS, *_LOSSES)]
    efforts = [name for name in found.values if ".effort" in name]
    others = [
        name for name in found.values if name not in {*pairs, *totals, *efforts, "disagreement"}
    ]
    for title, listed in (("effort", efforts), ("reaction", others)):
        if listed:
            lines += ["", *_numbers(title, found, listed)]
    if vectors:
        lines += ["", *_vectors(found, vectors)]
    lines += ["", *_numbers("total", found, totals)]
    return _with_checks(lines, found)


def motion_forces_lines(
    found: Reactions, motion: Motion, names: Sequence[str] = (), stalls: Sequence[Stall] = ()
) -> list[str]:
    """The smallest and largest values of all forces over a motion."""
    name = next(iter(found.inputs), "")
    values, unit = found.inputs[name], found.input_units[name]
    head = f"Forces for {name} from {values[0]:g} to {values[-1]:g} {unit}: {len(found)} positions"
    lines = [*title_lines(found.mechanism), *sentence(str, head)]
    ends = [] if motion.found.all() else [*limit_fields(motion)]
    lines += fields([*force_status_fields(found), *ends])
    listed = finite_forces(found, names)
    lines += ["", *range_lines(motion, listed, found.at_switches)] if listed else []
    return _with_checks(lines, found, stalls)


def _with_checks(lines: list[str], found: Reactions, stalls: Sequence[Stall] = ()) -> list[str]:
    """Without a motor or a position there is nothing to compare."""
    checks = list(force_fields(found, stalls))
    return [*lines, "", *fields(checks)] if checks else lines


def reactions_data(found: Reactions, table: Table, stalls: Sequence[Stall] = ()) -> dict[str, Any]:
    """The forces as JSON-ready data."""
    return {
        "mechanism": found.mechanism,
        "status": found.status.name,
        "units": dict(table.units),
        "columns": {name: column.tolist() for name, column in table.columns.items()},
        "undetermined": [name for name, rows in found.undetermined.items() if rows.any()],
        "lifted": [name for name, rows in found.lifted.items() if rows.any()],
        "slipping": [name for name, rows in found.slipping.items() if rows.any()],
        "undefined": [name for name, rows in found.undefined.items() if rows.any()],
        "proved": found.proved.tolist(),
        "stalls": [
            {
                "input": stall.input,
                "value": stall.value,
                "unit": stall.unit,
                "bracket": list(stall.bracket),
                "proved": stall.proved,
            }
            for stall in stalls
        ],
    }


def _stems(found: Reactions) -> Iterator[str]:
    """The names of vectors without their axis."""
    for name in found.values:
        stem, _, axis = name.rpartition(".")
        if axis == "x" and f"{stem}.y" in found.values:
            yield stem


def _numbers(title: str, found: Reactions, names: Sequence[str]) -> list[str]:
    cells = [significant(float(found.values[name])) for name in names]
    return table_lines(
        [
            Column(header=title, cells=list(names)),
            Column(
                header="value", cells=cells, align="point", units=[found.units[n] for n in names]
            ),
        ]
    )


def _vectors(found: Reactions, stems: Sequence[str]) -> list[str]:
    """Forces by components, size and direction."""
    places = [complex(*(float(found.values[f"{stem}.{axis}"]) for axis in "xy")) for stem in stems]
    unit = found.units[f"{stems[0]}.x"]
    parts = {
        f"x [{unit}]": [place.real for place in places],
        f"y [{unit}]": [place.imag for place in places],
        f"size [{unit}]": [math.hypot(place.real, place.imag) for place in places],
    }
    angles = [math.degrees(phase(p)) if abs(p) > 0.0 else math.nan for p in places]
    return table_lines(
        [
            Column(header="force", cells=list(stems)),
            *(
                Column(header=header, cells=[significant(v) for v in values], align="point")
                for header, values in parts.items()
            ),
            Column(header="angle", cells=[fixed(a, 2) for a in angles], align="point"),
            Column(header="on", cells=[_carrier(found.about[f"{stem}.x"]) for stem in stems]),
        ]
    )


def _carrier(about: str) -> str:
    """The body that a force acts on, from its explanation."""
    return about.rpartition(" on ")[2]
