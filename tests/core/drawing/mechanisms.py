"""Mechanisms that several pictures are drawn of."""

from __future__ import annotations

import linkwork as lw

__all__ = ["five_bar_of"]


def five_bar_of(left_stop: float) -> lw.Mechanism:
    """Two driven links: the left one from 90 to ``left_stop`` degrees, the right one to 80."""
    return lw.linkage(
        points={"O": (0, 0), "Q": (100, 0), "A": (0, 60), "B": (100, 60), "C": (50, 120)},
        links={
            "ground": ["O", "Q"],
            "left": ["O", "A"],
            "right": ["Q", "B"],
            "a": ["A", "C"],
            "b": ["B", "C"],
        },
        inputs=[
            lw.Input(link="left", from_=90, to=left_stop, step=1),
            lw.Input(link="right", from_=90, to=80, step=-1),
        ],
    )
