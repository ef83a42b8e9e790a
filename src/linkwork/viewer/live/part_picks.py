"""Picks of drawing tools: the things or places that a part needs, each with its prompt."""

from __future__ import annotations

from linkwork.viewer.live.file_state import Pick

__all__ = ["ANYWHERE", "end", "pick", "wheel"]

ANYWHERE = ("point", "link", "place")


def pick(prompt: str, *takes: str, sized: bool = False, repeated: bool = False) -> Pick:
    """A pick of a point, a link or a place."""
    return Pick(prompt=prompt, takes=takes, sized=sized, repeated=repeated)


def end(prompt: str) -> Pick:
    """A point, a place on a link or a free place."""
    return pick(prompt, *ANYWHERE)


def wheel(prompt: str) -> Pick:
    """The centre of a wheel or a link; a drag from it sets its radius."""
    return pick(prompt, *ANYWHERE, sized=True)
