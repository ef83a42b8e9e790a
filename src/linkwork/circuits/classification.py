"""Every mechanism as points and links, for its classification."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from linkwork.circuits.chain import Chain, chain_name, contours, inversion_name
from linkwork.circuits.loop_type import driven_joints, input_loop, loop_type
from linkwork.circuits.reading_joints import NotRead
from linkwork.circuits.reading_loops import Seen, read_linkage
from linkwork.core.foundation.names import GROUND
from linkwork.core.mechanism.linkage import Linkage
from linkwork.core.mechanism.loops import Loops
from linkwork.core.mechanism.part.part import Joint, JointKind
from linkwork.core.motion.model import Model
from linkwork.core.numerics.decomposition import block_form
from linkwork.core.results.check import AssurGroup, Classification


@dataclass(frozen=True)
class NotSeen:
    """Why a mechanism has no points and links."""

    why: str


def as_linkage(model: Model) -> Seen | NotSeen:
    """The points and links of a mechanism; those of loops are read off its equations.

    Notes
    -----
    They are sketched at the guess, from Newton-Raphson's position there if it finds one.
    """
    description, equations = model.description, model.equations
    if isinstance(description, Linkage):
        turning = {
            link: () if angle.variable is None else (angle.variable,)
            for link, angle in equations.links.items()
        }
        for cylinder in description.cylinders:
            turning |= dict.fromkeys(cylinder.ends, (cylinder.angle_name,))
        return Seen(model=model, linkage=description, turning=turning)
    if not isinstance(description, Loops):
        return NotSeen("plain equations do not determine links and joints")
    done = model.compiled.solver.solve(equations.start[None, :])
    v = equations.start if done.failed_block[0] >= 0 else done.v[0]
    try:
        return read_linkage(description, equations, v)
    except NotRead as error:
        return NotSeen(str(error))


# ----------------------------------------------------------------------
# Assur groups: links that are determined together, and the names of such groups.
#
# Every driven joint is held. The remaining chain has no freedom, and falls apart in one way only
# into parts of no freedom that have no such part themselves: the Assur groups, in the order in
# which they are determined.
#
# References
# ----------
# L. V. Assur, Investigation of plane linkages with lower pairs, 1914-1918
# I. I. Artobolevskii, Theory of mechanisms and machines, 4th ed. 1988 (class, order)
# B. Servatius, O. Shai, W. Whiteley, Combinatorial characterization of the Assur graphs from
# engineering, European Journal of Combinatorics 31 (2010) 1091-1104


Held = tuple[str, str]  # two links whose angle is held though no joint of them is driven


@dataclass(frozen=True, kw_only=True)
class FoundGroup:
    """An Assur group with all its links and joints by their own names."""

    group: AssurGroup
    links: frozenset[str]
    joints: frozenset[str]


def assur_groups(linkage: Linkage, chain: Chain) -> list[FoundGroup] | None:
    """The groups of a chain of lower pairs, or ``None`` if it is not determined joint by joint."""
    if any(part.pushes for part in linkage.parts):
        return None  # lengths of other joints determine a length
    driven = driven_joints(linkage, chain)
    held: list[Held] = []
    welds: list[tuple[str, str]] = []
    for which, joint in zip(linkage.inputs, driven, strict=True):
        pair = (which.link or "", which.relative_to or GROUND)
        if joint is None:
            held.append(pair)
        # the input holds one pair of the links on that pin
        elif which.link is not None:
            welds.append(pair)  # a pin of more links drives only these two
        else:
            welds.append((joint.links[0], joint.links[1]))
    fixed = chain.welded(welds)
    held = [(fixed.called(first), fixed.called(second)) for first, second in held]
    rows = _Rows(fixed, held)
    form = block_form(rows.pattern, rows.count, rows.columns)
    if not form.square:
        return None
    members = {link: [link] for link in fixed.links}
    for link, one in fixed.united.items():
        members[one].append(link)
    found = []
    for equations, columns in form.blocks:
        links = rows.links(columns)
        if not links:
            continue
        joints = rows.joints(equations, columns, links)
        names = tuple(" + ".join(members[link]) for link in links)
        inside = any(equation >= rows.first_held for equation in equations)
        found.append(
            FoundGroup(
                group=_group(names, links, joints, inside),
                links=frozenset(other for link in links for other in members[link]),
                joints=frozenset(joint.name for joint, _ in joints),
            )
        )
    return found


class _Rows:
    """Which links and pins each joint condition ties together.

    A link has three columns, a pin two, a link's place at a pin two rows, a sliding joint two.
    """

    def __init__(self, chain: Chain, held: Sequence[Held]) -> None:
        self.first: dict[str, int] = {}
        self.columns = 0
        for link in chain.links:
            if link != chain.ground:
                self.first[link] = self._more(3)
        self.at_column = {first: link for link, first in self.first.items()}
        self.pattern: list[list[int]] = []
        self.count: list[int] = []
        self.of: list[tuple[Joint, str]] = []  # the joint and the link of every row
        self.pin: dict[str, int] = {}
        for joint in chain.joints:
            if joint.kind is JointKind.REVOLUTE:
                self.pin[joint.name] = self._more(2)
                for link in joint.links:
                    at = self.pin[joint.name]
                    self._row([at, at + 1, *self._link(link)], 2, (joint, link))
            else:
                tied = [column for link in joint.links for column in self._link(link)]
                self._row(tied, 3 - joint.kind.freedom, (joint, ""))
        self.first_held = len(self.pattern)
        for pair in held:
            self.pattern.append([column for link in pair for column in self._link(link)])
            self.count.append(1)

    def _more(self, count: int) -> int:
        self.columns += count
        return self.columns - count

    def _link(self, link: str) -> list[int]:
        first = self.first.get(link)
        return [] if first is None else [first, first + 1, first + 2]

    def _row(self, tied: list[int], count: int, of: tuple[Joint, str]) -> None:
        self.pattern.append(tied)
        self.count.append(count)
        self.of.append(of)

    def links(self, columns: Sequence[int]) -> list[str]:
        """The links to which columns belong, in the file's order."""
        return [self.at_column[column] for column in columns if column in self.at_column]

    def joints(
        self, equations: Sequence[int], columns: Sequence[int], links: Sequence[str]
    ) -> list[tuple[Joint, tuple[str, ...]]]:
        """The simple joints of a block, each with the links of the block that it joins.

        A pin that is known before the block joins each of its links to the known links; a new one
        joins them to one another. A link known before has its condition in an earlier block.
        """
        own = set(links)
        at: dict[str, tuple[Joint, list[str]]] = {}
        found: list[tuple[Joint, tuple[str, ...]]] = []
        for equation in equations:
            if equation >= self.first_held:
                continue
            joint, link = self.of[equation]
            if link:
                at.setdefault(joint.name, (joint, []))[1].append(link)
            else:
                found.append((joint, tuple(end for end in joint.links if end in own)))
        for name, (joint, ends) in at.items():
            if self.pin[name] in columns:
                found += [(joint, (ends[0], other)) for other in ends[1:]]
            else:
                found += [(joint, (end,)) for end in ends]
        return found


def _group(
    names: tuple[str, ...],
    links: Sequence[str],
    joints: Sequence[tuple[Joint, tuple[str, ...]]],
    holds_input: bool,
) -> AssurGroup:
    """Name, class and order of a group.

    A dyad has class II. Otherwise the class is the largest number of joints of a closed contour:
    of a link's own joints, or of a loop of links inside the group. The order is the number of
    joints with which it is attached to known links.
    """

    def told(name: str, class_number: int | None = None, order: int | None = None) -> AssurGroup:
        return AssurGroup(links=names, name=name, class_number=class_number, order=order)

    if holds_input:
        return told("not an Assur group: an input drives the angle of a link away from its pin")
    higher = next((joint for joint, _ in joints if not joint.kind.lower), None)
    if higher is not None:
        return told(f"not an Assur group: it has a {higher.kind.noun}")
    outer = sum(len(ends) == 1 for _, ends in joints)
    if len(links) == 2:
        return told(f"dyad {_dyad(joints)}", 2, outer)
    elements = {link: {j.name for j, ends in joints if link in ends} for link in links}
    inner = [(link, joint.name) for joint, ends in joints if len(ends) == 2 for link in ends]
    moving = contours(dict.fromkeys(inner))
    # Artobolevskii: the largest closed contour gives the class
    number = max([len(own) for own in elements.values()] + moving)
    # a triad has a central link and three legs; four links around a contour are a tetrad
    if len(links) == 4 and not moving:
        return told(f"triad {_triad(links, joints)}", number, outer)
    if len(links) == 4:
        return told("tetrad", number, outer)
    return told(f"group of {len(links)} links", number, outer)


def _dyad(joints: Sequence[tuple[Joint, tuple[str, ...]]]) -> str:
    """Outer, inner, outer joint; a pin before a slide."""
    outer = sorted((j.kind.letter for j, ends in joints if len(ends) == 1), reverse=True)
    inner = next(j.kind.letter for j, ends in joints if len(ends) == 2)
    return f"{outer[0]}{inner}{outer[1]}"


def _triad(links: Sequence[str], joints: Sequence[tuple[Joint, tuple[str, ...]]]) -> str:
    """The three legs, each by its outer and its inner joint; legs of pins first."""
    legs = []
    for link in links:
        own = [(j.kind.letter, len(ends)) for j, ends in joints if link in ends]
        outer = next((letter for letter, count in own if count == 1), None)
        if outer is not None:
            legs.append(outer + next(letter for letter, count in own if count == 2))
    return "-".join(sorted(legs, reverse=True))


# ----------------------------------------------------------------------
# The classification of a mechanism by its points and links.


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
