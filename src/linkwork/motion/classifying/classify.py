"""The classification of a mechanism by its points and links."""

from __future__ import annotations

from linkwork.mechanism.chain import Chain
from linkwork.mechanism.chain_names import chain_name, inversion_name
from linkwork.motion.classifying.as_linkage import NotSeen, Seen
from linkwork.motion.classifying.assur import FoundGroup, assur_groups
from linkwork.motion.classifying.four_link_loop import input_loop
from linkwork.motion.classifying.loop_type import loop_type
from linkwork.motion.model import Model
from linkwork.results.classification import AssurGroup, Classification

__all__ = ["block_groups", "classify"]


def classify(seen: Seen) -> Classification:
    """Chain, inversion, type and Assur groups."""
    linkage = seen.linkage
    chain = Chain.of(linkage)
    whole = chain.with_blocks()
    loop = input_loop(linkage, whole)
    groups = assur_groups(linkage, whole)
    found = () if groups is None else tuple(entry.group for entry in groups)
    return Classification(
        chain=chain_name(chain),
        inversion=inversion_name(chain),
        links=len(whole.links),
        blocks=tuple(link for link in whole.links if link in whole.blocks),
        loop=None if loop is None else loop_type(loop, linkage, seen.model.equations.links),
        groups=found,
        class_number=None if groups is None else _class(found),
    )


def _class(groups: tuple[AssurGroup, ...]) -> int | None:
    numbers = [group.class_number for group in groups]
    known = [number for number in numbers if number is not None]
    return max([1, *known]) if len(known) == len(numbers) else None


def block_groups(model: Model, seen: Seen | NotSeen) -> tuple[AssurGroup | None, ...]:
    """For every block of equations the Assur group whose unknowns it determines, if there is one.

    Coordinates of a curve or of a contact belong to the group whose links they are solved with. A
    block of them alone, or one that only turns the driven angle into that of a link, has no group.
    """
    equations, blocks = model.equations, model.compiled.solver.blocks
    groups = None
    if isinstance(seen, Seen):
        groups = assur_groups(seen.linkage, Chain.of(seen.linkage).with_blocks())
    if isinstance(seen, NotSeen) or groups is None:
        return (None,) * len(blocks)
    owner: dict[str, FoundGroup] = {}
    for entry in groups:
        turning = (name for link in entry.links for name in seen.turning.get(link, ()))
        for name in (*turning, *entry.joints):
            owner.setdefault(name, entry)
    found = []
    for block in blocks:
        names = [equations.unknowns[k].name for k in block.unknowns]
        owners = [owner[name] for name in names if name in owner]
        alone = bool(owners) and all(entry is owners[0] for entry in owners)
        found.append(owners[0].group if alone else None)
    return tuple(found)
