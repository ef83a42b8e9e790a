"""What a cam moves, and on which link: the guide of a follower that slides, the frame of both."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from linkwork.mechanism.contacts import Cam
from linkwork.mechanism.parts import Slider, Slot

if TYPE_CHECKING:
    from linkwork.mechanism.linkage import Linkage

__all__ = ["follower_frame", "guide_named", "swinging_frames"]


def guide_named(linkage: Linkage, name: str | None) -> Slider | Slot | None:
    """The slider or slot of that name."""
    guides: Sequence[Slider | Slot] = (*linkage.sliders, *linkage.slots)
    return next((guide for guide in guides if guide.name == name), None)


def follower_frame(linkage: Linkage, cam: Cam) -> str:
    """The link on which a cam's follower slides, or that carries its pivot and the cam's centre."""
    guide = guide_named(linkage, cam.slider)
    return next(swinging_frames(linkage, cam)) if guide is None else guide.on


def swinging_frames(linkage: Linkage, cam: Cam) -> Iterator[str]:
    """Links that carry both a cam's centre and the pivot of its follower."""
    both = {cam.center, cam.pivot}
    for name, points in linkage.links.items():
        if name not in (cam.cam, cam.link) and both <= set(points):
            yield name
