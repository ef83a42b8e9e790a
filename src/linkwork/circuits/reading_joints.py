"""A loop as a walk along its vectors, with a pin wherever the direction changes.

A sum has no order, a loop has one. Both sides of an equation are paths between the same two points:
the walk follows the left side and returns along the right side. If all terms are on one side, their
written order is used.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import combinations, groupby, permutations

from linkwork.core.equations.model import LoopEquation, Term
from linkwork.core.foundation.arrays import DisjointSets

#: The variable angles of a direction with their weights, ordered by name.
Phase = tuple[tuple[str, float], ...]

#: The direction of fixed vectors.
FRAME: Phase = ()


def phase_of(term: Term) -> Phase:
    """The direction of a vector up to a constant angle."""
    return tuple(sorted(term.phase))


@dataclass(frozen=True)
class Run:
    """Consecutive vectors of the same direction."""

    phase: Phase
    terms: tuple[Term, ...]


@dataclass(frozen=True)
class Walk:
    """A closed walk: its runs in order, adjacent runs with different directions.

    The equation's first point is in the first run, after ``begun`` of its vectors.
    """

    runs: tuple[Run, ...]
    begun: int


def walks(loop: LoopEquation) -> list[Walk]:
    """The possible walks of a loop, beginning with the written one.

    Either both sides are two paths from one point, or all terms are on one side; repeated
    directions may have their vectors merged.
    """
    right = [term.negated() for term in loop.right]
    found: dict[Walk, None] = {}
    for terms in ([*loop.left, *reversed(right)], [*loop.left, *right]):
        walk = _walk(terms)
        found.setdefault(walk)
        phases = [run.phase for run in walk.runs]
        if len(set(phases)) < len(phases):
            found.setdefault(_walk(list(_together(terms))))
    return list(found)


def _together(terms: Sequence[Term]) -> Iterator[Term]:
    for phase in dict.fromkeys(map(phase_of, terms)):
        yield from (term for term in terms if phase_of(term) == phase)


def _walk(terms: Sequence[Term]) -> Walk:
    runs = [Run(phase, tuple(group)) for phase, group in groupby(terms, phase_of)]
    if len(runs) > 1 and runs[0].phase == runs[-1].phase:
        last = runs.pop()
        runs[0] = Run(last.phase, (*last.terms, *runs[0].terms))
        return Walk(tuple(runs), len(last.terms))
    return Walk(tuple(runs), 0)


# ----------------------------------------------------------------------
# Identification of links and pins from the vectors of loops.
#
# Vectors of the same direction are one link, unless a variable length is between them: that is a
# sliding joint, and the same length in another loop is the same joint. Then
#
# 1. bodies that rotate equally and meet at a pin are one link;
# 2. two links with relative rotation share one pin at most;
# 3. two pins at the same position of a link are one pin;
#
# and, if this is ambiguous, loops begin at ground, and links that meet once in each of two loops
# meet at the same pin.


_ALIKE = 1e-9  # relative tolerance of equal positions and directions
_APART = 7.3 + 4.1j  # far from any pin, in a direction of no loop


class NotRead(Exception):
    """The reason why loops cannot be read as links and joints."""


@dataclass(frozen=True, kw_only=True)
class Slide:
    """A sliding joint: the origin of ``after`` is at ``foot + along·s`` in ``before``.

    Positions in a link are complex, relative to the direction of its phase.
    """

    variable: str
    before: int
    after: int
    foot: complex
    along: complex

    def follows(self, other: Slide) -> bool:
        """Whether the length is measured in the same sense as in ``other``.

        Raises
        ------
        NotRead
            If direction or scale differ.
        """
        if abs(other.along - self.along) <= _ALIKE * abs(other.along):
            return True
        if abs(other.along + self.along) <= _ALIKE * abs(other.along):
            return False
        raise NotRead(f'"{self.variable}" is a length in two directions or scales')


@dataclass(frozen=True)
class Corner:
    """A pin: the links that meet there, and its position in each of them."""

    places: dict[int, complex]


@dataclass(frozen=True, kw_only=True)
class Joints:
    """Links by index with their phases, pins, sliding joints; ``ground`` is the fixed link.

    ``origin`` is the start of the first equation in the ground. ``loose``: links on which the
    equations do not determine the distance between pins of different loops.
    """

    phases: dict[int, Phase]
    corners: tuple[Corner, ...]
    slides: tuple[Slide, ...]
    ground: int
    origin: complex
    loose: frozenset[int]

    @property
    def still(self) -> int:
        """The number of links without rotation."""
        return sum(phase == FRAME for phase in self.phases.values())

    @property
    def pins(self) -> int:
        """The number of pins; a pin of k links counts as k - 1."""
        return sum(len(corner.places) - 1 for corner in self.corners)

    @property
    def mobility(self) -> int:
        """Grübler's count."""
        return 3 * (len(self.phases) - 1) - 2 * (self.pins + len(self.slides))


def joints_of(walks: Sequence[Walk], size: float) -> Joints:
    """The links and joints of loops for given walks.

    Parameters
    ----------
    size : float
        A length of the mechanism, the reference of tolerances.

    Raises
    ------
    NotRead
        If no set of links and joints fits the loops, or more than one does.
    """
    found = _Joining(tolerance=_ALIKE * size, apart=_APART * size)
    for loop, walk in enumerate(walks):
        found.add(loop, walk)
    found.join()
    return found.joints()


@dataclass
class _Joining:
    """Pieces of links, corners between them, and the identifications found so far.

    ``link`` groups pieces of one link; ``rigid`` and ``shift`` are their positions in it, as far as
    known: the position z of a piece is z + shift in the first piece of its part. ``apart`` is the
    arbitrary layout of parts of a link at unknown distance.
    """

    tolerance: float
    apart: complex
    phase: list[Phase] = field(default_factory=list)
    link: DisjointSets = field(default_factory=DisjointSets)
    rigid: list[int] = field(default_factory=list)
    shift: list[complex] = field(default_factory=list)
    corner: DisjointSets = field(default_factory=DisjointSets)
    ends: list[tuple[int, int, complex]] = field(default_factory=list)  # corner, piece, place
    loop_of: list[int] = field(default_factory=list)  # of corners
    slides: list[Slide] = field(default_factory=list)
    origins: list[tuple[int, complex]] = field(default_factory=list)

    def add(self, loop: int, walk: Walk) -> None:
        """Add the pieces of a loop, their corners and slides."""
        if len(walk.runs) < 2:
            raise NotRead("all vectors of a loop have one direction, so that it has no pin")
        corners = [self.corner.add() for _ in walk.runs]
        self.loop_of += [loop] * len(corners)
        for k, run in enumerate(walk.runs):
            self._run(run, corners[k], corners[(k + 1) % len(corners)], walk.begun if not k else -1)
        last = walk.runs[-1]
        if not walk.begun and last.phase == FRAME:
            piece, place = self.ends[-1][1:]
            self.origins.append((piece, place))

    def _run(self, run: Run, start: int, end: int, begun: int) -> None:
        piece, place = self._piece(run.phase), 0j
        self.ends.append((start, piece, place))
        for k, term in enumerate(run.terms):
            if k == begun and run.phase == FRAME:
                self.origins.append((piece, place))
            if term.length is None:
                place += term.value
                continue
            after = self._piece(run.phase)
            self.slides.append(
                Slide(variable=term.length, before=piece, after=after, foot=place, along=term.value)
            )
            piece, place = after, 0j
        self.ends.append((end, piece, place))

    def _piece(self, phase: Phase) -> int:
        self.phase.append(phase)
        self.rigid.append(len(self.rigid))
        self.shift.append(0j)
        return self.link.add()

    def join(self) -> None:
        """Merge pieces and corners as far as the rules apply."""
        sliding = {self.phase[slide.before] for slide in self.slides}
        first: dict[Phase, int] = {}
        for piece, phase in enumerate(self.phase):
            if phase not in sliding:
                self.link.unite(first.setdefault(phase, piece), piece)
        self._settle()
        while self._same_vector() or self._begin_at_ground() or self._meet_once():
            self._settle()

    def _settle(self) -> None:
        changed = True
        while changed:
            steps = (self._at_corners, self._same_slides, self._one_pin, self._same_place)
            changed = any(step() for step in steps)

    def _place(self, piece: int, other: int, offset: complex) -> bool:
        """Merge ``other`` with the link of ``piece``, with its origin at ``offset``."""
        known = self.rigid[piece] == self.rigid[other]
        gap = self.shift[piece] + offset - self.shift[other]
        if known:
            if abs(gap) > self.tolerance:
                raise NotRead("two pins would join the same two links, which could not move")
            return False
        self.link.unite(piece, other)
        old, new = self.rigid[other], self.rigid[piece]
        for k, part in enumerate(self.rigid):
            if part == old:
                self.rigid[k], self.shift[k] = new, self.shift[k] + gap
        return True

    def _by_corner(self) -> dict[int, list[tuple[int, complex]]]:
        found: dict[int, list[tuple[int, complex]]] = {}
        for corner, piece, place in self.ends:
            found.setdefault(self.corner.root(corner), []).append((piece, place))
        return found

    def _at_corners(self) -> bool:
        """Merge bodies that rotate equally and meet at a pin."""
        changed = False
        for met in self._by_corner().values():
            first: dict[Phase, tuple[int, complex]] = {}
            for piece, place in met:
                one, there = first.setdefault(self.phase[piece], (piece, place))
                changed |= self._place(one, piece, there - place)
        return changed

    def _same_slides(self) -> bool:
        """Merge the sliding joints of a variable length in all loops."""
        changed = False
        first: dict[str, Slide] = {}
        for slide in self.slides:
            one = first.setdefault(slide.variable, slide)
            if one is slide:
                continue
            before, after, foot = slide.before, slide.after, slide.foot
            if not slide.follows(one):
                before, after, foot = after, before, -foot
            if self.phase[before] != self.phase[one.before]:
                raise NotRead(f'"{slide.variable}" is a length along two links')
            changed |= self.link.unite(one.before, before)
            changed |= self.link.unite(one.after, after)
            if self.rigid[one.before] == self.rigid[before]:
                gap = self.shift[before] - self.shift[one.before]
                changed |= self._place(one.after, after, gap + foot - one.foot)
            elif self.rigid[one.after] == self.rigid[after]:
                gap = self.shift[after] - self.shift[one.after]
                changed |= self._place(one.before, before, gap - foot + one.foot)
        return changed

    def _one_pin(self) -> bool:
        """Merge pins between the same two links."""
        changed = False
        first: dict[Hashable, int] = {}
        for corner, met in self._by_corner().items():
            links = {self.link.root(piece) for piece, _ in met}
            for pair in combinations(sorted(links), 2):
                changed |= self.corner.unite(first.setdefault(pair, corner), corner)
        return changed

    def _same_place(self) -> bool:
        """Merge pins at the same position of a link."""
        changed = False
        on: dict[int, list[tuple[int, complex]]] = {}
        for corner, piece, place in self.ends:
            here = place + self.shift[piece]
            others = on.setdefault(self.rigid[piece], [])
            for other, there in others:
                if abs(here - there) <= self.tolerance:
                    changed |= self.corner.unite(other, corner)
            others.append((corner, here))
        return changed

    def _same_vector(self) -> bool:
        """Merge the end points of a variable length in all loops."""
        first: dict[str, Slide] = {}
        for slide in self.slides:
            one = first.setdefault(slide.variable, slide)
            ends = [(slide.before, slide.foot), (slide.after, 0j)]
            if not slide.follows(one):
                ends.reverse()
            for known, (piece, place) in zip(
                ((one.before, one.foot), (one.after, 0j)), ends, strict=True
            ):
                if self.rigid[known[0]] != self.rigid[piece]:
                    return self._place(known[0], piece, known[1] - place)
        return False

    def _begin_at_ground(self) -> bool:
        """Merge the fixed links at which loops begin."""
        first = self.origins[0][0] if self.origins else 0
        return any(self.link.unite(first, piece) for piece, _ in self.origins[1:])

    def _meet_once(self) -> bool:
        """Merge the corners of pairs that meet once in each of several loops, if possible.

        A pair is a link and a direction, otherwise two directions.
        """
        ends = self._by_corner()
        loops: dict[int, set[int]] = {}
        for k, loop in enumerate(self.loop_of):
            loops.setdefault(self.corner.root(k), set()).add(loop)
        parts = {k: {self.rigid[piece] for piece, _ in ends[k]} for k in ends}
        for corners in (*self._meetings(ends, self.link.root), *self._meetings(ends, None)):
            apart = list(combinations(corners, 2))
            if any(loops[one] & loops[other] for one, other in apart):
                continue
            for one, other in apart:
                if not parts[one] & parts[other]:
                    return self.corner.unite(one, other)
        return False

    def _meetings(
        self, ends: Mapping[int, list[tuple[int, complex]]], link: Callable[[int], int] | None
    ) -> Iterator[list[int]]:
        """The corners at which the same link, or direction, meets the same direction."""
        met: dict[Hashable, list[int]] = {}
        for corner, at in ends.items():
            pairs: dict[Hashable, None] = {}
            for one, other in permutations([piece for piece, _ in at], 2):
                if self.phase[one] != self.phase[other]:
                    own = self.phase[one] if link is None else link(one)
                    pairs.setdefault((own, self.phase[other]))
            for pair in pairs:
                met.setdefault(pair, []).append(corner)
        yield from met.values()

    def joints(self) -> Joints:
        """The resulting joints."""
        links = dict.fromkeys(self.link.root(piece) for piece in range(len(self.phase)))
        loose = self._lay_out()
        corners: dict[int, dict[int, complex]] = {}
        for corner, piece, place in self.ends:
            at = corners.setdefault(self.corner.root(corner), {})
            at[self.link.root(piece)] = place + self.shift[piece]
        slides = {slide.variable: self._slide(slide) for slide in reversed(self.slides)}
        slides = dict(sorted(slides.items(), key=lambda item: item[1].before))
        self._check_slides(list(links), list(slides.values()))
        ground, origin = self._ground()
        return Joints(
            phases={link: self.phase[link] for link in links},
            corners=tuple(Corner(places) for places in corners.values()),
            slides=tuple(slides.values()),
            ground=ground,
            origin=origin,
            loose=loose,
        )

    def _lay_out(self) -> frozenset[int]:
        """Lay out parts of links at unknown distance; returns these links."""
        parts: dict[int, list[int]] = {}
        for k, part in enumerate(self.rigid):
            known = parts.setdefault(self.link.root(k), [])
            if part not in known:
                known.append(part)
            self.shift[k] += known.index(part) * self.apart
        return frozenset(link for link, known in parts.items() if len(known) > 1)

    def _slide(self, slide: Slide) -> Slide:
        """A slide between links instead of pieces."""
        return Slide(
            variable=slide.variable,
            before=self.link.root(slide.before),
            after=self.link.root(slide.after),
            foot=slide.foot + self.shift[slide.before] - self.shift[slide.after],
            along=slide.along,
        )

    def _check_slides(self, links: list[int], slides: list[Slide]) -> None:
        """Check that links of equal rotation are connected by slides, without loops of slides."""
        held = DisjointSets(len(self.phase))
        for slide in slides:
            if not held.unite(slide.before, slide.after):
                raise NotRead(f'"{slide.variable}" slides in a loop of sliding joints')
        groups = {held.root(link) for link in links}
        if len(groups) > len({self.phase[link] for link in groups}):
            raise NotRead("two links stay parallel without a sliding joint between them")

    def _ground(self) -> tuple[int, complex]:
        """The link without rotation at which the equations begin."""
        still = dict.fromkeys(
            self.link.root(k) for k, phase in enumerate(self.phase) if phase == FRAME
        )
        if not still:
            raise NotRead("no vector keeps its direction, so that no link is fixed")
        begun = {
            self.link.root(piece): place + self.shift[piece] for piece, place in self.origins[::-1]
        }
        if len(begun) == 1:
            return next(iter(begun.items()))
        if len(still) > 1:
            raise NotRead(
                "several links keep their direction, and the equations begin at none or at more "
                "than one of them"
            )
        return next(iter(still)), 0j
