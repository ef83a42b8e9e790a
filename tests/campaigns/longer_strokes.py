"""A tenth more stroke of the first traced point, or the last moving one, of every mechanism.

The referee sweeps the best design anew and compares the stroke with the goal and with that of the
mechanism: reached, nearer, or not moved. A design that is called sound must be nearer, and one that
is not moved must say so.
"""

from __future__ import annotations

from collections import Counter

import numpy as np

import linkwork as lw
from tests.campaigns.library_defects import MECHANISMS

__all__ = ["stroke_campaign"]

_STARTS, _MORE = 4, 1.1
_STILL = 1e-6  # length units: points that do not move
_REACHED, _NEARER = 1e-6, 1e-3  # of the stroke that is added


def stroke_campaign(part: int) -> tuple[Counter[str], list[str]]:
    """Counts, and false claims, about one mechanism."""
    name = MECHANISMS[part % len(MECHANISMS)]
    mechanism = lw.example(name)
    try:
        motion = mechanism.sweep(certify=False)
        paths = {name: motion.trace(name)[motion.found] for name in motion.points}
        moving = [p for p, path in paths.items() if np.abs(path - path[0]).max() > _STILL]
        names = [*mechanism.description.trace[:1], *reversed(moving)][:1]
        if not names:
            return Counter({"no moving point": 1}), []
        strokes = {of: motion.value(of) for of in (f"stroke({names[0]}.{a})" for a in "xy")}
        # the second of two equal to rounding would be another goal on another processor
        of = max(strokes, key=lambda of: round(strokes[of], 6))
        before = strokes[of]
        goal = {"of": of, "target": _MORE * before}
        found = lw.synthesis.improve(mechanism, goal, starts=_STARTS)
    except lw.LinkworkError as error:
        return Counter({"refused": 1, f"{name}: refused, {error}"[:110]: 1}), []
    sound = [design for design in found if design.sound]
    if not sound:
        why = found[0].message if found else "no design"
        return Counter({"no sound design": 1, f"{name}: {why}"[:200]: 1}), []
    after = lw.Mechanism(sound[0].description).sweep(certify=False).value(of)
    added = (after - before) / ((_MORE - 1.0) * before)
    if abs(added - 1.0) <= _REACHED:
        return Counter({"reached": 1}), []
    if np.isfinite(added) and added > _NEARER:
        return Counter({"nearer": 1, f"{name}: nearer, {added:.3f} of the way": 1}), []
    return Counter({"not moved": 1}), [f"{name}: sound, and {added:.2g} of the way"]
