"""How a mechanism was read, as sentences: equations, mobility, classification."""

from __future__ import annotations

from collections.abc import Iterator

from linkwork.core.results.check import BlockSummary, CheckReport, Classification, roman
from linkwork.core.results.listing.motion_listing import Column, redundant_lines, significant


def check_fields(report: CheckReport) -> Iterator[tuple[str, str]]:
    """Parts, equations, unknowns, inputs, blocks, mobility, chain and type."""
    yield "written as", report.form
    if report.links:
        read = ", read off the loops" if report.form == "loops" else ""
        yield "parts", f"{_count(report.links, 'link')}, {_count(report.joints, 'joint')}{read}"
    what = "equation" if report.form == "equations" else "loop"
    yield what if len(report.loops) == 1 else f"{what}s", ", ".join(map(_quoted, report.loops))
    yield "unknowns", _with_units(report.unknowns) or "none"
    inputs = _with_units(report.inputs) or "none: solve finds one position, there is no sweep"
    yield "input" if len(report.inputs) < 2 else "inputs", inputs
    if report.rows:
        yield "sweep", _count(report.rows, "position")
    if report.blocks:
        yield "blocks", _blocks_sentence(report)
        if len(report.blocks) > 1:
            for k, block in enumerate(report.blocks, 1):
                together = " and ".join(map(_quoted, block.equations))
                yield "", f"{k}. {', '.join(block.unknowns)} from {together}{_group(block)}"
    if report.form != "equations":
        yield "mobility", _mobility(report)
    yield from redundant_lines({link: gap for link, _, gap in report.redundant})
    if report.classification is not None:
        yield from classification_fields(report.classification)
    else:
        yield "chain", f"not known: {report.unclassified}"


def measured_part_columns(report: CheckReport) -> list[Column]:
    """What the sketch gives of parts: part, quantity and value."""
    parts, quantities, values, units = zip(*report.measured_in_parts, strict=True)
    cells = [significant(value, 7, noise=1e-9) for value in values]
    return [
        Column(header="part", cells=parts),
        Column(header="quantity", cells=quantities),
        Column(header="value", cells=cells, align="point", units=units),
    ]


def _blocks_sentence(report: CheckReport) -> str:
    if len(report.blocks) == 1:
        return f"1, all unknowns are solved together{_group(report.blocks[0])}"
    return f"{len(report.blocks)}, solved one after the other:"


def _group(block: BlockSummary) -> str:
    return "" if block.group is None else f": {block.group.text}"


def _mobility(report: CheckReport) -> str:
    count, rank = report.mobility_count, report.mobility_rank
    by_rank = "not known by rank, which needs a position" if rank is None else f"{rank} by rank"
    if count is None:
        return by_rank
    both = f"{count} by Grübler's count, {by_rank}"
    return f"{both}. They differ: {report.mobility_why}" if report.mobility_why else both


def classification_fields(found: Classification) -> Iterator[tuple[str, str]]:
    """Chain, type and class with their labels."""
    blocks = ", ".join(found.blocks)
    counted = ""
    if found.blocks:
        whose = "pin in slot" if len(found.blocks) == 1 else "pins in slots"
        what = "a block" if len(found.blocks) == 1 else "blocks"
        counted = f"; {whose} {blocks} counted as {what}"
    yield "chain", found.chain + counted
    if found.type:
        yield "type", found.type
    if found.class_number is not None:
        several = ", the highest of its Assur groups" if len(found.groups) > 1 else ""
        yield "class", roman(found.class_number) + several


def _with_units(names: tuple[tuple[str, str], ...]) -> str:
    return ", ".join(f"{name} [{unit}]" if unit else name for name, unit in names)


def _quoted(label: str) -> str:
    return f'"{label}"'


def _count(number: int, noun: str) -> str:
    return f"{number} {noun}" if number == 1 else f"{number} {noun}s"
