"""What every drawing tool of a part lets a person pick, in order, with a prompt for each pick."""

from __future__ import annotations

from collections.abc import Mapping

from linkwork.viewer.live.file_state import Pick

__all__ = ["PICKS"]

_PIN, _BODY, _PLACE = "point", "link", "place"


def _pick(prompt: str, *takes: str, sized: bool = False, repeated: bool = False) -> Pick:
    return Pick(prompt=prompt, takes=takes, sized=sized, repeated=repeated)


def _wheel(prompt: str) -> Pick:
    return _pick(prompt, _PIN, _BODY, _PLACE, sized=True)


def _end(prompt: str) -> Pick:
    return _pick(prompt, _PIN, _BODY, _PLACE)


#: The picks of the kinds of parts by table; sliders have a tool of their own.
PICKS: Mapping[str, tuple[Pick, ...]] = {
    "slots": (
        _pick("Click the pin that runs in the slot.", _PIN),
        _end("Click the link with the slot; or drag from the pin along a fixed slot."),
    ),
    "cylinders": (
        _end("Drag from one end of the cylinder to the other."),
        _end("Click the other end of the cylinder."),
    ),
    "welds": (
        _pick("Click the first link; a fixed pin is the ground.", _PIN, _BODY),
        _pick("Click the link that is welded to it.", _PIN, _BODY),
    ),
    "gears": (
        _wheel("Click the first gear's centre, or the link that is the gear."),
        _wheel("Click the second gear's centre or link; drag from it to set its radius."),
    ),
    "noncircular_gears": (
        _wheel("Click the first gear's centre, or the link that is the gear."),
        _wheel("Click the second gear's centre or link."),
    ),
    "belts": (
        _wheel("Click the first pulley's centre or link; drag from it to set its radius."),
        _wheel("Click the second pulley's centre or link; drag from it to set its radius."),
    ),
    "racks": (
        _end("Click the pinion's centre, or the link that is the pinion."),
        _pick("Click the block that is the rack, or where the rack runs.", _PIN, _PLACE),
    ),
    "rolling": (
        _end("Click the wheel's centre, or the link that is the wheel."),
        _end("Click the link on which it rolls, the centre of a circle, or a place of the ground."),
    ),
    "cams": (
        _end("Click the cam's centre, or the link that is the cam."),
        _pick("Click the follower: a block, the end of a link, or a place.", _PIN, _PLACE),
    ),
    "curves": (
        _pick("Click the pin that runs along the curve.", _PIN),
        _pick(
            "Click places along the curve; Enter, or a click on the last place, ends it.",
            _PIN,
            _BODY,
            _PLACE,
            repeated=True,
        ),
    ),
    "springs": (
        _end("Drag from one end of the spring to the other."),
        _end("Click the other end of the spring."),
    ),
}
