"""A loop of four links with their lengths between pins, from which its type follows."""

from __future__ import annotations

import cmath
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

from linkwork.circuits.chain import Chain, chain_name, contours, inversion_name
from linkwork.circuits.reading_joints import NotRead
from linkwork.circuits.reading_loops import Seen, read_linkage
from linkwork.core.equations.model import LinkAngle
from linkwork.core.foundation.names import GROUND
from linkwork.core.mechanism.linkage import Linkage
from linkwork.core.mechanism.loops import Loops
from linkwork.core.mechanism.part.guides import GuidePart, Slider
from linkwork.core.mechanism.part.part import Joint, JointKind
from linkwork.core.motion.model import Model
from linkwork.core.numerics.decomposition import block_form
from linkwork.core.results.check import AssurGroup, Classification, LoopType


@dataclass(frozen=True, kw_only=True)
class FourLinkLoop:
    """Links around a loop, ground first, and the joints between each and the next one.

    ``driven``: the joint of the loop that the input drives, if there is one.
    """

    links: tuple[str, ...]
    joints: tuple[Joint, ...]
    driven: Joint | None

    @property
    def letters(self) -> str:
        """The kinds of joints, ``RRRP``, beginning at ground."""
        return "".join(joint.kind.letter for joint in self.joints)

    def ends(self, link: str) -> tuple[Joint, Joint]:
        """The joint before a link and the joint after it."""
        k = self.links.index(link)
        return self.joints[k - 1], self.joints[k]

    def carries_its_pins(self, linkage: Linkage, link: str) -> bool:
        """Whether both joints of a link are pins of its own, not of links welded to it."""
        return all(
            joint.kind is JointKind.REVOLUTE and joint.name in linkage.links[link]
            for joint in self.ends(link)
        )

    def length(self, linkage: Linkage, link: str) -> float:
        """The distance between the two pins of a link."""
        before, after = self.ends(link)
        local = linkage.shapes.local[link]
        return abs(local[after.name] - local[before.name])

    def offset(self, linkage: Linkage, angles: Mapping[str, LinkAngle]) -> float:
        """The distance of the two pins next to the only sliding joint, across its direction."""
        slide, guide = self._slide(linkage)
        if guide is None:  # a cylinder pulls along the line of its pins
            return 0.0
        on = linkage.shapes.local[guide.on]
        foot, end = (on[p] for p in guide.line)
        along = (end - foot) / abs(end - foot)
        pin = next(j.name for j in self.ends(guide.on) if j is not slide)
        across = ((on[pin] - foot) * along.conjugate()).imag
        if not isinstance(guide, Slider):  # a pin on the line itself
            return abs(across)
        own = linkage.shapes.local[guide.link]
        own_pin = next(j.name for j in self.ends(guide.link) if j is not slide)
        turn = cmath.exp(1j * (_constant(angles, guide.link) - _constant(angles, guide.on)))
        aside = ((own[own_pin] - own[guide.points[0]]) * turn * along.conjugate()).imag
        return abs(linkage.numbers(guide.offset) + aside - across)

    def guide(self, linkage: Linkage) -> str | None:
        """The link with the line of the only sliding joint; a cylinder has none."""
        _, guide = self._slide(linkage)
        return None if guide is None else guide.on

    def _slide(self, linkage: Linkage) -> tuple[Joint, GuidePart | None]:
        """The only sliding joint, and the slider or slot that it is."""
        slide = next(j for j in self.joints if j.kind is JointKind.PRISMATIC)
        guides = linkage.of(GuidePart)
        return slide, next((guide for guide in guides if guide.name == slide.name), None)


def _constant(angles: Mapping[str, LinkAngle], link: str) -> float:
    return 0.0 if link == GROUND else angles[link].constant


def driven_joints(linkage: Linkage, chain: Chain) -> list[Joint | None]:
    """For every input the joint of ``chain`` that it drives, if it drives one directly."""
    found: list[Joint | None] = []
    for which in linkage.inputs:
        kind, name = which.drives
        if kind in ("slider", "cylinder"):
            found.append(next(joint for joint in chain.joints if joint.name == name))
            continue
        pair = (name, which.relative_to or GROUND)
        if kind == "joint":
            first, second = linkage.bodies_at(name)
            pair = (first, second)
        ends = {chain.called(link) for link in pair}
        pins = (j for j in chain.joints if j.kind is JointKind.REVOLUTE and ends <= {*j.links})
        found.append(next(pins, None))
    return found


def input_loop(linkage: Linkage, chain: Chain) -> FourLinkLoop | None:
    """The loop of four links from ground over the driven joint, or around a four-link chain.

    ``None`` if there is no such loop of lower pairs, or more than one, or if a length of it leads
    across a weld.
    """
    driven = driven_joints(linkage, chain)
    lead = driven[0] if len(driven) == 1 else None
    start = lead if lead is not None and chain.ground in lead.links else None
    if start is None:
        if len(chain.links) != 4:
            return None
        start = chain.at(chain.ground)[0]
    loops = [
        (second, joints)
        for second in start.across(chain.ground)
        for joints in chain.loop_through(start, chain.ground, second)
        if all(joint.kind.lower for joint in joints)
        and sum(joint.kind is JointKind.PRISMATIC for joint in joints) <= 1
    ]
    if len(loops) != 1:
        return None
    ((second, joints),) = loops
    links = [chain.ground, second]
    for joint, onward in pairwise(joints[1:]):
        links.append(next(c for c in joint.across(links[-1]) if c in onward.links))
    loop = FourLinkLoop(links=tuple(links), joints=joints, driven=lead if lead in joints else None)
    welded = (link for link in links if len(chain.members(link)) > 1)
    return loop if all(loop.carries_its_pins(linkage, link) for link in welded) else None


# ----------------------------------------------------------------------
# The type of a four-link loop by Grashof's condition or that of the slider-crank.


#: Margins below this part of the longest length count as zero: the lengths are rounded more.
CHANGE_POINT = 1e-12

#: By the place of the shortest link: ground, driven link, coupler, output.
_GRASHOF = (
    ("double-crank", "GCCC"),
    ("crank-rocker", "GCRR"),
    ("double-rocker", "GRCR"),
    ("rocker-crank", "GRRC"),
)
_PARALLELOGRAM_OR_ANTI = "parallelogram or antiparallelogram"
_FLAT = 1e-3  # sine of the angle of ground and driven link below which a sketch decides nothing
_AT_CHANGE_POINT = ("SCCC", "SCRR", "SRCR", "SRRC")


def loop_type(loop: FourLinkLoop, linkage: Linkage, angles: Mapping[str, LinkAngle]) -> LoopType:
    """The type of a loop of four revolutes, or of three and one sliding joint."""
    if "P" in loop.letters:
        return _slider_crank(loop, linkage, angles)
    return _four_bar(loop, linkage)


def _four_bar(loop: FourLinkLoop, linkage: Linkage) -> LoopType:
    """A four-bar with s + l against p + q.

    References
    ----------
    F. Grashof, Theoretische Maschinenlehre, vol. 2, 1883
    C. R. Barker, A complete classification of planar four-bar linkages, Mechanism and Machine
    Theory 20 (1985) 535-554; R. L. Norton, Design of Machinery, table 2-4.
    """
    lengths = [loop.length(linkage, link) for link in loop.links]
    shortest, second, third, longest = sorted(lengths)
    if longest > shortest + second + third:
        told = (
            f"{loop.links[lengths.index(longest)]} is {longest - (shortest + second + third):.6g} "
            f"{linkage.length} longer than the sum of the other three"
        )
        return _no_loop(loop, told, (second + third) - (shortest + longest), longest)
    margin = (second + third) - (shortest + longest)
    small = CHANGE_POINT * longest
    at_shortest = lengths.index(shortest)
    at_ground = loop.driven is loop.joints[0]
    if not at_ground and at_shortest == 3:
        at_shortest = 1  # the side links are alike where neither is driven
    turning: bool | None = margin > 0
    if abs(margin) <= small:
        turning = None
        name, code = _change_point(lengths, at_shortest, small)
        if name == _PARALLELOGRAM_OR_ANTI:
            name = _parallelogram_as_sketched(loop, linkage)
    elif margin > 0:
        name, code = _GRASHOF[at_shortest]
    else:
        at = lengths.index(longest)
        name, code = "triple-rocker", f"RRR{at + 1}"
    full: bool | None = None
    if turning is not None and loop.driven is not None:
        full = turning and loop.links[lengths.index(shortest)] in loop.driven.links
    if not at_ground:
        code = ""  # the letter names the driven link
    return LoopType(
        links=loop.links,
        name=name,
        barker=code,
        grashof=turning,
        margin=margin,
        relative_margin=margin / longest,
        turns_fully=full,
        condition=_condition(
            ("Grashof", "not Grashof"), "s + l", "p + q", margin, small, linkage.length
        ),
    )


def _change_point(lengths: list[float], at_shortest: int, small: float) -> tuple[str, str]:
    """The name and Barker's code of a four-bar whose links can all lie on one line."""
    ground, driven, coupler, output = lengths

    def alike(one: float, other: float) -> bool:
        return abs(one - other) <= small

    if alike(ground, coupler) and alike(driven, output):
        if alike(ground, driven):
            return "rhombus", "S3X"
        return _PARALLELOGRAM_OR_ANTI, "S2X"
    if (alike(ground, driven) and alike(coupler, output)) or (
        alike(ground, output) and alike(driven, coupler)
    ):
        return "deltoid", "S2X"
    return f"change-point {_GRASHOF[at_shortest][0]}", _AT_CHANGE_POINT[at_shortest]


def _parallelogram_as_sketched(loop: FourLinkLoop, linkage: Linkage) -> str:
    """Which of two loops equal opposite sides make, from the area that they enclose.

    With signs it is that of the parallelogram on ground and driven link, or none where two sides
    cross each other. A configuration asked for by name may be the other one.
    """
    # the start is another configuration than the sketch, perhaps
    if linkage.configuration:
        return _PARALLELOGRAM_OR_ANTI
    before, behind, far, near = (linkage.sketched(joint.name) for joint in loop.joints)
    whole = abs(((near - before).conjugate() * (behind - before)).imag)
    enclosed = abs(((far - before).conjugate() * (near - behind)).imag) / 2.0
    if whole <= _FLAT * loop.length(linkage, loop.links[0]) * loop.length(linkage, loop.links[1]):
        return _PARALLELOGRAM_OR_ANTI
    return "parallelogram" if enclosed > whole / 2.0 else "antiparallelogram"


def _slider_crank(
    loop: FourLinkLoop, linkage: Linkage, angles: Mapping[str, LinkAngle]
) -> LoopType:
    """A slider-crank or an inversion of it, with s + e against l.

    s and l are the shorter and the longer of the two links with two pins, e the distance of the
    pins next to the slide, across it. It is a four-bar two of whose links are infinitely long.

    References
    ----------
    K. H. Hunt, Kinematic Geometry of Mechanisms, 1978; F. Reuleaux, Theoretische Kinematik, 1875
    (the chain's inversions)
    """
    arms = [
        link
        for link in loop.links
        if all(joint.kind is JointKind.REVOLUTE for joint in loop.ends(link))
    ]
    lengths = [loop.length(linkage, link) for link in arms]
    short, long = sorted(lengths)
    offset = loop.offset(linkage, angles)
    margin = long - short - offset
    if offset > long + short:
        told = (
            f"the offset pins are {offset - (long + short):.6g} {linkage.length} "
            f"further apart than {' and '.join(arms)} reach"
        )
        return _no_loop(loop, told, margin, offset)
    small = CHANGE_POINT * max(long, offset)
    turning: bool | None = None if abs(margin) <= small else margin > 0
    shorter = arms[lengths.index(short)]
    full: bool | None = None
    if turning is not None and loop.driven and loop.driven.kind is JointKind.REVOLUTE:
        full = turning and shorter in loop.driven.links
    swinging = loop.guide(linkage) not in (loop.links[1], loop.links[3])
    return LoopType(
        links=loop.links,
        name=_slider_crank_name(loop, arms, shorter, turning, long - short <= small, swinging),
        grashof=turning,
        margin=margin,
        relative_margin=margin / max(long, offset),
        turns_fully=full,
        condition=_condition(
            _turning_words(full),
            "s + e",
            "l",
            margin,
            small,
            linkage.length,
        ),
    )


def _no_loop(loop: FourLinkLoop, why: str, margin: float, longest: float) -> LoopType:
    """The result for lengths that cannot be assembled."""
    return LoopType(
        links=loop.links,
        name="no closed loop",
        grashof=False,
        margin=margin,
        relative_margin=margin / longest,
        turns_fully=None,
        condition=why,
    )


def _turning_words(full: bool | None) -> tuple[str, str]:
    """The turning that the lengths allow, of the driven joint if one of the pins is driven."""
    if full is None:
        return "a link turns fully", "no link turns fully"
    if full:
        return "the driven link turns fully", ""
    return "the driven link cannot turn fully", "the driven link cannot turn fully"


def _slider_crank_name(
    loop: FourLinkLoop,
    arms: list[str],
    shorter: str,
    turning: bool | None,
    isosceles: bool,
    swinging: bool,
) -> str:
    """``swinging``: the block or the cylinder, not the slotted link, is pinned to ground."""
    ground = loop.links[0]
    equal = "isosceles " if isosceles else ""
    if ground not in arms:
        at_ground = next(link for link in (loop.links[1], loop.links[3]) if link in arms)
        if isosceles or (at_ground == shorter and turning is not False):
            return f"{equal}slider-crank"
        return "slider-rocker" if turning is False else "slider-rocker (hand pump)"
    if isosceles or turning is False:
        return f"{equal}inverted slider-crank"
    if ground == shorter:
        return "rotary cylinder" if swinging else "Whitworth quick return"
    return "oscillating cylinder" if swinging else "crank shaper"


def _condition(
    words: tuple[str, str], left: str, right: str, margin: float, small: float, unit: str
) -> str:
    if abs(margin) <= small:
        return f"change point, {left} = {right} (margin {margin:.3g} {unit})"
    sign = "<" if margin > 0 else ">"
    return f"{words[margin < 0]}, {left} {sign} {right} by {abs(margin):.6g} {unit}".rstrip()


# ----------------------------------------------------------------------
# Every mechanism as points and links, for its classification.


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
