"""The classification of a mechanism that is given by its points and links."""

from __future__ import annotations

from linkwork.mechanism.chain import Chain, cylinder_ends
from linkwork.mechanism.chain_names import chain_name, inversion_name
from linkwork.mechanism.linkage import Linkage
from linkwork.motion.classifying.assur import FoundGroup, assur_groups
from linkwork.motion.classifying.four_link_loop import input_loop
from linkwork.motion.classifying.loop_type import loop_type
from linkwork.motion.model import Model
from linkwork.results.classification import AssurGroup, Classification

__all__ = ["block_groups", "classify"]


def classify(model: Model) -> Classification | None:
    """Chain, inversion, type and Assur groups; ``None`` for a mechanism given by equations."""
    linkage = model.description
    if not isinstance(linkage, Linkage):
        return None
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
        loop=None if loop is None else loop_type(loop, linkage, model.equations.links),
        groups=found,
        class_number=None if groups is None else _class(found),
    )


def _class(groups: tuple[AssurGroup, ...]) -> int | None:
    numbers = [group.class_number for group in groups]
    known = [number for number in numbers if number is not None]
    return max([1, *known]) if len(known) == len(numbers) else None


def block_groups(model: Model) -> tuple[AssurGroup | None, ...]:
    """For every block of equations the Assur group whose unknowns it determines, if there is one.

    Coordinates of a curve or of a contact belong to the group whose links they are solved with. A
    block of them alone, or one that only turns the driven angle into that of a link, has no group.
    """
    linkage, equations = model.description, model.equations
    blocks = model.compiled.solver.blocks
    groups = None
    if isinstance(linkage, Linkage):
        groups = assur_groups(linkage, Chain.of(linkage).with_blocks())
    if not isinstance(linkage, Linkage) or groups is None:
        return (None,) * len(blocks)
    angles = {link: angle.variable for link, angle in equations.links.items()}
    for cylinder in linkage.cylinders:
        angles |= dict.fromkeys(cylinder_ends(cylinder.name), cylinder.angle_name)
    owner: dict[str, FoundGroup] = {}
    for entry in groups:
        turning = (angles.get(link) for link in entry.links)
        sliding = (equations.sliders.get(joint) for joint in entry.joints)
        for name in (*turning, *sliding, *entry.joints):
            if name is not None:
                owner.setdefault(name, entry)
    found = []
    for block in blocks:
        names = [equations.unknowns[k].name for k in block.unknowns]
        owners = [owner[name] for name in names if name in owner]
        alone = bool(owners) and all(entry is owners[0] for entry in owners)
        found.append(owners[0].group if alone else None)
    return tuple(found)
