"""Equations of a rolling wheel: its angle against its path on a line or around a circle."""

from __future__ import annotations

from linkwork.equations.part.wheel_pair import ratio
from linkwork.equations.part_rows import PartRows
from linkwork.mechanism.description import Key
from linkwork.mechanism.part.rolling import Rolling

__all__ = ["write"]


def write(rolling: Rolling, key: Key, rows: PartRows) -> None:
    """Write the equations for a line or a circle."""
    if rolling.line is not None:
        _roll_on_line(rolling, key, rows)
    else:
        _roll_on_circle(rolling, rows)


def _roll_on_line(rolling: Rolling, key: Key, rows: PartRows) -> None:
    assert rolling.line is not None
    frames, linkage = rows.frames, rows.frames.linkage
    side = rows.side(rolling.on, rolling.line, rolling.center, (*key, "center"))
    radius = linkage.numbers.precise(rolling.radius) * side
    name = f"{rolling.name}_radius"
    frames.add_guide((rolling.name, rolling.on, rolling.line), rolling.center, radius, name)
    turns = [(rolling.wheel, radius.high), (rolling.on, -radius.high)]
    measured = (f"{rolling.name} at {rolling.wheel} = 0", 1.0)
    rows.tie(rolling.name, turns, length=(rolling.name, 1.0), measured=measured)


def _roll_on_circle(rolling: Rolling, rows: PartRows) -> None:
    """Join the centres by a rod; wheel and circle mesh as gears on it."""
    assert rolling.circle is not None
    assert rolling.circle_radius is not None
    frames, numbers = rows.frames, rows.frames.linkage.numbers
    small, large = numbers.precise(rolling.radius), numbers.precise(rolling.circle_radius)
    length = abs(large - small) if rolling.inside else large + small
    a, b = rolling.circle, rolling.center
    frames.add_rod(rolling.name, (a, b), length)
    p, q = ratio(large, small)
    p = -p if rolling.inside else p
    turns = [(rolling.wheel, q), (rolling.on, p), (rolling.name, -p - q)]
    rows.tie(rolling.name, turns, measured=(f"{rolling.wheel} at {rolling.name} = 0", q))
