"""The quantities of a page: columns over the rows, and numbers of the whole motion."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from linkwork.drawing.captions import printed_name
from linkwork.drawing.charts.columns import lead_of
from linkwork.drawing.charts.labels import rate_label, size_label
from linkwork.foundation.errors import InputError
from linkwork.results.motion import Motion
from linkwork.results.quantities.asked import Asked, Group
from linkwork.results.quantities.path_length import PATH_LENGTH
from linkwork.results.quantities.registry import Call
from linkwork.results.quantities.stroke import STROKE
from linkwork.results.quantities.time_ratio import TIME_RATIO
from linkwork.results.quantities.transmission import RECOMMENDED, TRANSMISSION_ANGLE
from linkwork.results.quantity import Rate
from linkwork.viewer.packing import Pack
from linkwork.viewer.page_data import Column, MotionNumber, ReactionData

__all__ = ["columns_of", "numbers_of", "reactions_of", "usual_columns"]

_MOST_NUMBERED = 5  # quantities with numbers of the motion by default


def columns_of(motion: Motion, pack: Pack, asked: Sequence[str] = ()) -> Iterator[Column]:
    """Inputs, unknowns, outputs and derived quantities, then those asked for by name.

    Names that the mechanism does not have, and numbers of motions, are left out.
    """
    found = motion.found
    for name, values in motion.inputs.items():
        yield Column(
            name=name,
            shown=printed_name(name),
            unit=motion.input_units[name],
            group="input",
            values=pack(values, found),
            first=None,
            first_unit="",
        )
    groups = dict(usual_columns(motion))
    for name, group in groups.items():
        yield _column(motion, motion.quantity(name), group, pack)
    given = {*motion.inputs, *groups}
    for name in dict.fromkeys(asked):
        quantity = _asked_quantity(motion, name)
        if isinstance(quantity, Asked) and quantity.name not in given:
            given.add(quantity.name)
            yield _column(motion, quantity, "asked", pack)


def usual_columns(motion: Motion) -> Iterator[tuple[str, str]]:
    """The columns of every page, and their groups."""
    yield from ((name, "unknown") for name in (*motion.unknowns, *motion.riding))
    yield from ((name, "output") for name in motion.outputs)
    traced = motion.skeleton.traced
    for name, asked in motion.quantities.derived.items():
        if asked.row is not None and (not asked.row.of_path or asked.part in traced):
            yield name, "derived"


def reactions_of(motion: Motion) -> Iterator[ReactionData]:
    """The forces of pins and loads, whose components are columns."""
    numbers = {name: k for k, name in enumerate(motion.points)}
    for name, asked in motion.quantities.derived.items():
        stem, _, axis = name.rpartition(".")
        if asked.row is not None and asked.row.pin and axis == "x":
            point, on, by = asked.row.pin
            if point in numbers:
                x, y = f"{stem}.x", f"{stem}.y"
                yield ReactionData(point=numbers[point], on=on, by=by, x=x, y=y)


def _column(motion: Motion, asked: Asked, group: str, pack: Pack) -> Column:
    found, own, rate = motion.found, asked.own, asked.rate
    bounded = rate is None
    plain = bounded and asked.group is not Group.EVIDENCE
    series = motion.series(asked.name) if plain else None
    values = motion[asked.name].astype(float) if series is None else series.value
    first = None if series is None or asked.needs > 1 else series.first
    band: tuple[float, ...] = ()
    if bounded and asked.row is TRANSMISSION_ANGLE:
        band = tuple(bound / motion.units.angle.radians for bound in RECOMMENDED)
    return Column(
        name=asked.name,
        shown=_label(motion, asked),
        unit=asked.unit,
        group=group,
        values=pack(values, found, rate=not bounded),
        first=None if first is None else pack(first, found, rate=True),
        first_unit=Rate.FIRST.unit(own.kind, motion.units, motion.derivative_unit),
        band=band,
    )


def _label(motion: Motion, asked: Asked) -> str:
    if asked.rate is None:
        return printed_name(asked.name)
    label = size_label if asked.group is Group.POINT else rate_label
    return label(asked.own.name, asked.rate, lead_of(motion))


def _asked_quantity(motion: Motion, name: str) -> Asked | None:
    """A quantity or rate by name; ``None`` if the mechanism or this motion does not have it."""
    try:
        return motion.quantity(name)
    except InputError:
        return None


def numbers_of(motion: Motion, asked: Sequence[str] = ()) -> Iterator[MotionNumber]:
    """Stroke and time ratio of outputs and unknowns, lengths of traced paths, then numbers of the
    motion asked for by name; names that the mechanism does not have are left out.
    """
    moving = [*motion.outputs, *motion.unknowns][:_MOST_NUMBERED]
    usual = [f"{own.word}({name})" for name in moving for own in (*STROKE, *TIME_RATIO)]
    usual += [f"{own.word}({point})" for point in motion.skeleton.traced for own in PATH_LENGTH]
    for name in dict.fromkeys([*usual, *asked]):
        try:
            quantity = motion.quantities.find_of_motion(name)
            value = motion.value(name)
        except InputError:
            continue
        if name in usual and not math.isfinite(value):
            continue  # a stroke that does not return has no time ratio
        call, of_rows = Call.read(name), ", of the rows" if motion.is_of_rows(name) else ""
        yield MotionNumber(
            name=name,
            shown=f"{call.word.replace('_', ' ')} of {printed_name(call.of)}{of_rows}",
            unit=quantity.unit,
            value=value if math.isfinite(value) else None,
        )
