"""Checks of friction: where it acts, and the sizes that it needs there."""

from __future__ import annotations

from linkwork.foundation.errors import choices
from linkwork.mechanism.description import Problems
from linkwork.mechanism.part.index import JoinedBodies
from linkwork.mechanism.part.part import PartChecks

__all__ = ["check_friction"]


def check_friction(linkage: JoinedBodies, problems: Problems) -> None:
    """Report friction of what is no joint, and missing or wrong sizes."""
    parts = {part.label: part for part in linkage.parts if part.names}
    for name, friction in linkage.friction.items():
        checks = PartChecks(linkage, problems, ("friction", name))
        if name in linkage.points:
            # cylinders push along their axis only, and have no friction at their pins
            if len(list(linkage.bodies_at(name))) < 2:
                checks.add("is no pin of two links: friction needs a joint that moves")
                continue
            noun = "a pin"
            takes: tuple[str, ...] = ("radius",)
        elif name in parts:
            part = parts[name]
            noun = f"a {part.title[0].lower()}{part.title[1:]}"
            if part.friction_sizes is None:
                checks.add(f"{noun} has no friction of its own: give it to pins and guides")
                continue
            takes = part.friction_sizes
        else:
            checks.add(f"is neither a pin nor a part {choices('names', [*linkage.points, *parts])}")
            continue
        amount = checks.amount(friction.mu, "mu")
        if amount < 0.0:
            checks.add(f"must not be negative, got {amount:g}", "mu")
        for size in ("radius", "length"):
            given = getattr(friction, size)
            if given is not None and size not in takes:
                checks.add(f"the friction of {noun} does not depend on it: leave it out", size)
            elif given is not None:
                checks.positive(given, "length", size)
            elif size == "radius" and size in takes:
                example = f"{name} = {{ mu = 0.1, radius = 5 }}"
                checks.add(f"is missing: the friction of {noun} needs it, as in {example}", size)
