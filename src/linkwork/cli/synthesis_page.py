"""A synthesis as a page of text: counts, defects by kind, dyads and delivered designs."""

from __future__ import annotations

from collections.abc import Iterator

from linkwork.cli.terminal import bad, fields, good, sentence, title_lines, wrapped
from linkwork.cli.text_table import table_lines
from linkwork.design.defects.judged_design import JudgedDesign
from linkwork.design.defects.verdicts import DefectKind
from linkwork.design.synthesis.advice import advice_of, remarks_on
from linkwork.design.synthesis.designs_table import front_of, goal_misses
from linkwork.design.synthesis.result import Synthesis
from linkwork.results.listing.column import Column
from linkwork.results.listing.number_text import rounded_down, significant

__all__ = ["synthesis_lines"]

_DIGITS = 5
_MOST_DYADS = 8
_MOST_REASONS = 5


def synthesis_lines(found: Synthesis) -> list[str]:
    """The page of a synthesis."""
    lines = [*title_lines(found.task.name), *fields(_counts(found))]
    if found.dyads and len(found.dyads) <= _MOST_DYADS:
        lines += ["", *_dyad_lines(found)]
    if found.delivered:
        lines += ["", *_design_lines(found)]
    lines += ["", *_verdict(found)]
    return lines


def _counts(found: Synthesis) -> Iterator[tuple[str, str]]:
    if found.starts:
        yield "starts", str(found.starts)
        if not (found.task.improvement and found.task.improvement.front):
            yield "fits", f"{found.real}, different ones"
    else:
        yield "complex", f"{found.complex} solution{'' if found.complex == 1 else 's'}"
        yield "real", str(found.real)
        yield "proved", str(found.proved)
    if found.triples:
        yield "triples", str(found.triples)
    yield "completeness", found.message
    if found.interrupted:
        yield "interrupted", "the designs are the best found until then"
    driven = len(found.designs)
    yield "mechanisms", str(found.linkages)
    each = "one for each link that can be driven"
    if found.starts:
        each = f"driven at {found.designs[0].driven}" if found.designs else "none found"
    yield "designs", f"{driven}, {each}"
    for kind, count in found.defects.items():
        yield kind.value, f"{count}"
    yield "without defects", str(found.sound)
    yield "delivered", str(len(found.delivered))


def _dyad_lines(found: Synthesis) -> list[str]:
    """The dyads: kind, pivots, proof."""
    dyads, unit = found.dyads, found.task.length

    def column(header: str, values: list[float]) -> Column:
        return Column(
            header=header, cells=[significant(v, _DIGITS + 1) for v in values], align="point"
        )

    return table_lines(
        [
            Column(header="dyad", cells=[dyad.kind for dyad in dyads]),
            column(f"moving x [{unit}]", [dyad.moving[0] for dyad in dyads]),
            column("y", [dyad.moving[1] for dyad in dyads]),
            column(f"fixed x [{unit}]", [dyad.fixed[0] for dyad in dyads]),
            column("y", [dyad.fixed[1] for dyad in dyads]),
            Column(header="", cells=["proved" if dyad.proved else "not proved" for dyad in dyads]),
        ]
    )


def _design_lines(found: Synthesis) -> list[str]:
    """The delivered designs, best first."""
    designs, task = found.delivered, found.task
    front = front_of(found)

    def column(header: str, values: list[float]) -> Column:
        return Column(header=header, cells=[significant(v, _DIGITS) for v in values], align="point")

    columns = [
        Column(header="", cells=[str(design.number) for design in designs], align="right"),
        *(column(f"goal {k}", misses) for k, misses in enumerate(front.values(), start=1)),
    ]
    if not front:
        columns.append(Column(header="mechanism", cells=[d.mechanism for d in designs]))
        if not found.starts:  # fits are all driven at one link
            columns.append(Column(header="driven at", cells=[d.driven for d in designs]))
    least = [rounded_down(design.transmission, _DIGITS) for design in designs]
    columns += [
        column(f"transmission [{task.angle.value}]", least),
        column(f"size [{task.length}]", [design.size for design in designs]),
    ]
    if front:
        told = [f"goal {k}: the miss of {name}" for k, name in enumerate(front, start=1)]
        return [*table_lines(columns), "", *(line for text in told for line in wrapped(text))]
    if any(design.error for design in designs):
        columns.append(column(_error(found), [d.error for d in designs]))
    columns.append(column("score", [design.score for design in designs]))
    return [*table_lines(columns), *_miss_lines(found)]


def _miss_lines(found: Synthesis) -> list[str]:
    """How far the best design misses each goal, if there are several."""
    misses = goal_misses(found.delivered[:1])
    if len(misses) < 2:
        return []
    rows = [(name, significant(values[0], _DIGITS)) for name, values in misses.items()]
    return ["", *wrapped("Design 1 misses its goals by"), *fields(rows)]


def _error(found: Synthesis) -> str:
    return f"error [{found.error_unit}]" if found.error_unit else "error"


def _verdict(found: Synthesis) -> list[str]:
    """Whether there is a sound design; if not, the commonest reasons and the costliest wish."""
    if found.delivered:
        have = "has" if found.sound == 1 else "have"
        lines = sentence(good, f"{found.sound} of {len(found.designs)} designs {have} no defect.")
        return [*lines, *(line for text in remarks_on(found) for line in wrapped(text))]
    told = advice_of(found)
    advice = wrapped(told) if told else []
    if not found.designs:
        head = "No mechanism of the wanted kinds solves the task."
        if found.task.kind == "improve":
            head = "No start leads to a design."
        return [*sentence(bad, head), *advice]
    lines = sentence(bad, "No design is free of defects.")
    cost = found.costliest
    if cost is not None:
        wish, count = cost
        told = f"The wish that costs most is {wish}: without it {count} would be sound."
        lines += wrapped(told)
    lines += advice
    shown = _examples(found)
    for design in shown:
        reason = f"{design.mechanism} driven at {design.driven}: "
        lines += wrapped(reason + design.defects[0].message, "  ", "    ")
    more = len(found.refused) - len(shown)
    if more > 0:
        lines += wrapped(f"and {more} more; --json lists all reasons", "  ")
    return lines


def _examples(found: Synthesis) -> list[JudgedDesign]:
    """All refused designs if they are few, else one for each kind of first defect."""
    if len(found.refused) <= _MOST_REASONS:
        return list(found.refused)
    first: dict[DefectKind, JudgedDesign] = {}
    for design in found.refused:
        first.setdefault(design.kinds[0], design)
    return list(first.values())
