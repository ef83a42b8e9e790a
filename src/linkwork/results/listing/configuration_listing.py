"""Configurations as columns and sentences."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from linkwork.foundation.certification import Certification
from linkwork.results.configurations import Configurations, PathCount, solution_counts
from linkwork.results.listing.column import Column
from linkwork.results.listing.position_listing import Row, value_cells
from linkwork.results.position import Certificate
from linkwork.results.quantity import Kind

__all__ = ["completeness_fields", "configuration_columns", "path_sentence"]


def configuration_columns(
    found: Configurations, kinds: Mapping[str, Kind], decimals: int = 6
) -> list[Column]:
    """A row for every configuration; ``kinds`` of the unknowns in order."""
    columns = [Column(header="name", cells=found.names)]
    for name, kind in kinds.items():
        if name not in found.positions[0].unknowns:
            continue  # a redundant link's length
        unit = found.positions[0].units.of(kind)
        rows = [Row(name=name, kind=kind, value=position.unknowns[name]) for position in found]
        header = f"{name} [{unit}]" if unit else name
        columns.append(Column(header=header, cells=value_cells(rows, decimals), align="point"))
    certified = [_certified(p.certificate) for p in found]
    columns.append(Column(header="certified", cells=certified))
    return columns


def completeness_fields(found: Configurations) -> Iterator[tuple[str, str]]:
    """Whether the list is complete, and the counts of solutions behind it."""
    yield "complete", found.message
    label = "paths"
    for count in found.paths:
        yield label, path_sentence(count, several=len(found.paths) > 1)
        label = ""


def path_sentence(count: PathCount, *, several: bool) -> str:
    """The counts of solutions of one block in words."""
    block = f"{', '.join(count.unknowns)}: " if several else ""
    if not count.paths:
        return f"{block}follow from the others"
    text = solution_counts(count)
    text += f", {count.multiple} multiple" if count.multiple else ""
    text += f", for {count.solved} positions of earlier blocks" if count.solved > 1 else ""
    others = [
        f"{number} {end}"
        for number, end in ((count.at_infinity, "to infinity"), (count.failed, "lost"))
        if number
    ]
    return f"{block}{text}" + (f"; {count.paths} paths: {', '.join(others)}" if others else "")


def _certified(certificate: Certificate) -> str:
    if certificate.certification is Certification.SUBSET_CERTIFIED:
        return "partly"
    return "yes" if certificate.certified else "no"
