"""A wing for Linkwork: the speed of points per unit of the input."""

from __future__ import annotations

from linkwork.wings import Wing, Writer

WING = Wing(
    module="linkwork_speeds",
    title="Speeds of points",
    commands={"fastest": "Show where a point moves fastest."},
    quantities=("linkwork_speeds.parts:SPEED",),
    writers={"speeds": Writer("linkwork_speeds.parts:write_speeds")},
)
