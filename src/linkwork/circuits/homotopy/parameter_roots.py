"""All isolated solutions of a member of a family, by straight paths from those of a random one.

Lost paths, and paths that met, are followed again with more care. What is still missing is looked
for among the mirror images of solutions, if the member is real, and along detours: a path by way
of random parameters leads from the same starts to the same ends in another order.
"""

from __future__ import annotations

import hashlib
import zipfile
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

import numpy as np

from linkwork.circuits.homotopy.dead_points import Topology
from linkwork.circuits.homotopy.monodromy import Family, Member, first_of_each
from linkwork.circuits.homotopy.path_tracking import (
    ARRIVED,
    QUICK,
    SINGULAR,
    SURE,
    Ends,
    ParameterPath,
    PathOptions,
    Tracker,
    polish_ends,
)
from linkwork.core.foundation.arrays import AnyArray, BoolArray, ComplexArray, IndexArray
from linkwork.core.foundation.files import cache_folder, keep_arrays
from linkwork.core.foundation.statuses import Completeness

_FAR = 10.0  # a path whose end is so much larger than at σ = 1e-4 runs to infinity
_VERY_FAR = 1e6
_ROUGH = 1e-3  # relative: how well a singular end is known
_DETOURS = 3
_DETOUR_PAYS = 8  # missing solutions, in small families too
_MANY = 0.4  # of the paths: so many are lost in special tasks only
_FEW = 0.05  # of the paths: more are missing for a reason that a detour does not change


class MirroredFamily(Family, Protocol):
    """A family with real members, whose solutions come in pairs or are their own mirror images."""

    def is_real(self, c: ComplexArray) -> bool:
        """Whether parameters (P,) are those of a real member."""

    def mirrored(self, x: ComplexArray) -> ComplexArray:
        """The mirror images of solutions (B, n) of a real member."""


@dataclass(frozen=True, kw_only=True, eq=False)
class ParameterRoots:
    """Isolated solutions of a member, and the outcome of every path.

    Parameters
    ----------
    x : (R, n)
        Regular finite solutions, one for each that count as one.
    singular : (S, n)
        Ends of paths at singular solutions, as far as they are known.
    paths, at_infinity, lost : int
        Paths followed, those that ran to infinity and those that led nowhere.
    by_mirror, by_detour : int
        Solutions that the straight paths did not find.
    closed : bool, optional
        Of a real member: whether every solution's mirror image is among them.
    """

    x: ComplexArray
    singular: ComplexArray
    paths: int
    at_infinity: int
    lost: int
    by_mirror: int
    by_detour: int
    closed: bool | None

    @property
    def complete(self) -> bool:
        """Whether every path has an end of its own."""
        ends = len(self.x) + len(self.singular) + self.at_infinity
        return ends == self.paths and self.closed is not False

    @property
    def lost_paths(self) -> str:
        """The number of lost paths in words, and whether their ends were found otherwise."""
        found = (
            " but ends found as mirror images or by detours" if self.lost and self.complete else ""
        )
        return f"{self.lost} lost{found}"

    def graded(self, proved: BoolArray) -> Completeness:
        """Whether a list of real solutions, each ``proved`` or not (R,), has all of them."""
        if not self.complete or not proved.all():
            return Completeness.NOT_PROVED
        several = len(self.singular) > 0
        return Completeness.MULTIPLE if several else Completeness.WITH_PROBABILITY_ONE


class _Search:
    """The search for the solutions of one member."""

    def __init__(
        self, family: MirroredFamily, member: Member, goal: ComplexArray, tracker: Tracker
    ) -> None:
        self.family, self.member, self.goal, self.tracker = family, member, goal, tracker

    def run(self, rng: np.random.Generator) -> ParameterRoots:
        ends = self._straight()
        found = ends.x[ends.regular]
        settled = int((ends.infinite | ends.singular).sum())
        by_mirror, closed = 0, None
        if self.family.is_real(self.goal):
            found, by_mirror, closed = self._close(found)
        by_detour = detours = 0
        paths = len(self.member.x)
        while (
            0 < paths - settled - len(found) <= max(_DETOUR_PAYS, _FEW * paths)
            and detours < _DETOURS
        ):
            more = self._new_ones(found, self._by_detour(rng))
            detours += 1
            by_detour += len(more)
            if len(more):
                found = np.concatenate([found, more])
                if closed is not None:
                    found, mirrored, closed = self._close(found)
                    by_mirror += mirrored
            elif settled > paths - settled - len(found):
                # in a special task what is missing creeps to where the other paths ended
                break
        # a mirror image may have shown that an end is regular after all; every path has one end
        singular = self._apart(found, ends.x[ends.singular & (len(found) < paths)])
        return ParameterRoots(
            x=found,
            singular=singular,
            paths=paths,
            at_infinity=int(ends.infinite.sum()),
            lost=int(ends.lost.sum()),
            by_mirror=by_mirror,
            by_detour=by_detour,
            closed=closed,
        )

    def _straight(self) -> Ends:
        """The straight paths; those that were lost or met a second time, with care."""
        ends = self._follow(self.member.parameters, self.member.x, QUICK)
        again = np.flatnonzero(ends.lost | self._meeting(ends))
        if not len(again):
            return ends
        if len(again) > _MANY * len(ends.x):
            # the task is special: care would take long and change little
            ends.regular[again] = False
            return ends
        more = self._follow(self.member.parameters, self.member.x[again], SURE)
        for whole, part in (
            (ends.x, more.x), (ends.regular, more.regular),
            (ends.infinite, more.infinite), (ends.singular, more.singular),
        ):  # fmt: skip
            whole[again] = part
        # of two paths that still meet one has jumped
        first = np.flatnonzero(ends.regular)
        kept = first[self._first_of_each(ends.x[first])]
        ends.regular[:] = False
        ends.regular[kept] = True
        return ends

    def _by_detour(self, rng: np.random.Generator) -> ComplexArray:
        """Ends of the paths by way of random parameters."""
        way = self.family.random_parameters(rng)
        path = ParameterPath(system=self.family, start=self.member.parameters, goal=way)
        paths = self.tracker(path, self.member.x, QUICK)
        ends = self._follow(way, paths.w[paths.state == ARRIVED], QUICK)
        return ends.x[ends.regular]

    def _follow(self, start: ComplexArray, x: ComplexArray, options: PathOptions) -> Ends:
        path = ParameterPath(system=self.family, start=start, goal=self.goal)
        paths = self.tracker(path, x, options)
        arrived = np.flatnonzero(paths.state == ARRIVED)
        w, (regular, multiple) = paths.w.copy(), np.zeros((2, len(x)), dtype=bool)
        polished = polish_ends(path, w[arrived])
        proper = self.family.proper(polished.x, self.goal)
        w[arrived], regular[arrived] = polished.x, polished.regular & proper
        multiple[arrived] = polished.multiple & proper
        size, before = (np.abs(z).max(axis=1, initial=0.0) for z in (paths.w, paths.near))
        ended = paths.state == SINGULAR
        infinite = ended & ((size > _FAR * before) | (size > _VERY_FAR))
        singular = multiple | (ended & ~infinite)
        return Ends(x=w, regular=regular, infinite=infinite, singular=singular)

    def _close(self, found: ComplexArray) -> tuple[ComplexArray, int, bool]:
        """Solutions with their mirror images, how many those are, and whether all are there."""
        path = ParameterPath(system=self.family, start=self.goal, goal=self.goal)
        images = self._new_ones(found, self.family.mirrored(found))
        sharp = polish_ends(path, images)
        new = self._new_ones(found, sharp.x[sharp.regular])
        return np.concatenate([found, new]), len(new), bool(sharp.regular.all())

    def _new_ones(self, found: ComplexArray, more: ComplexArray) -> ComplexArray:
        """Solutions that are not among those found."""
        both = np.concatenate([found, more])
        kept = self._first_of_each(both)
        return both[kept[kept >= len(found)]]

    def _apart(self, found: ComplexArray, ends: ComplexArray) -> ComplexArray:
        """Singular ends that are not near a solution found, each as often as paths lead there."""
        prints, others = (self.family.fingerprint(x, self.goal) for x in (found, ends))
        near = [
            (np.abs(prints - row).max(axis=1) < _ROUGH * (1.0 + np.abs(row).max())).any()
            for row in others
        ]
        apart: ComplexArray = ends[~np.array(near, dtype=bool)]
        return apart

    def _meeting(self, ends: Ends) -> BoolArray:
        """Paths that ended at the same regular solution: one of them has jumped."""
        place = np.flatnonzero(ends.regular)
        prints = self.family.fingerprint(ends.x[place], self.goal)
        met = np.ones(len(place), dtype=bool)
        # alone in both directions
        alone = np.intersect1d(first_of_each(prints), len(place) - 1 - first_of_each(prints[::-1]))
        met[alone] = False
        whole = np.zeros(len(ends.x), dtype=bool)
        whole[place] = met
        return whole

    def _first_of_each(self, x: ComplexArray) -> IndexArray:
        return first_of_each(self.family.fingerprint(x, self.goal))


def roots_at(
    family: MirroredFamily,
    member: Member,
    goal: ComplexArray,
    tracker: Tracker,
    rng: np.random.Generator,
) -> ParameterRoots:
    """All isolated solutions at the parameters ``goal`` (P,)."""
    with np.errstate(all="ignore"):
        return _Search(family, member, goal, tracker).run(rng)


# ----------------------------------------------------------------------
# Solved random members of families of systems, kept on disk: shipped ones, and the user's own.
#
# A random member takes up to a minute to be solved and depends on the topology only. The solutions
# that are read are polished again, so that no file is trusted with a number.


#: The sets of the library and of common topologies; made by ``scripts/start_sets``.
SHIPPED = Path(__file__).with_name("start_sets.npz")
_VERSION = 1  # of the random members and of the data stored of them


@dataclass(frozen=True, kw_only=True, eq=False)
class StartSet:
    """A random member of a topology's family, ``left`` and ``right``, with its solutions ``x``.

    ``sure``: whether these are confirmed to be all.
    """

    topology: Topology
    left: ComplexArray
    right: ComplexArray
    x: ComplexArray
    sure: bool

    def as_arrays(self) -> dict[str, AnyArray]:
        """The set as arrays; the solutions in single precision, because readers polish them."""
        return {
            "topology": np.array(self.topology.as_text()),
            "left": self.left,
            "right": self.right,
            "x": self.x.astype(np.complex64),
            "sure": np.array(self.sure),
        }

    @classmethod
    def of_arrays(cls, arrays: dict[str, AnyArray]) -> StartSet:
        """The set of :meth:`as_arrays`.

        Raises
        ------
        KeyError, TypeError, ValueError
            If these are no arrays of a set.
        """
        left, right, x = (np.asarray(arrays[n], dtype=complex) for n in ("left", "right", "x"))
        topology = Topology.of_text(str(arrays["topology"]))
        shape = len(topology.columns[0]), len(topology.columns)
        width = 2 * (topology.unknowns + topology.own)
        if left.shape != shape or right.shape != shape or (len(x) and x.shape[1:] != (width,)):
            raise ValueError("closures and solutions do not have the shapes of the topology")
        return cls(topology=topology, left=left, right=right, x=x, sure=bool(arrays["sure"]))


def read_sets(topology: Topology) -> Iterator[StartSet]:
    """The sets of families that may be this one in different order; this one's own set first."""
    own, signature = name_of(topology), topology.signature
    for path in (SHIPPED, *own_sets(signature)):
        # a file that cannot be read is no set: it is computed, and written again
        with suppress(OSError, ValueError, KeyError, TypeError, zipfile.BadZipFile):
            with path.open("rb") as file, np.load(file) as stored:
                names = {name.rpartition(".")[0] for name in stored.files}
                near = sorted((n for n in names if n.startswith(signature)), key=own.__ne__)
                found = [
                    {field: stored[f"{name}.{field}"] for field in StartSet.__annotations__}
                    for name in near
                ]
            yield from map(StartSet.of_arrays, found)


def own_sets(signature: str = "") -> list[Path]:
    """The files of the user's cache whose names begin so."""
    return sorted(_folder().glob(f"{signature}*.npz"))


def write_set(kept: StartSet) -> None:
    """Keep a set in the user's cache, whole or not at all; nothing where that is not possible."""
    name = name_of(kept.topology)
    arrays = {f"{name}.{field}": array for field, array in kept.as_arrays().items()}
    keep_arrays(_folder() / f"{name}.npz", arrays)


def name_of(topology: Topology) -> str:
    """The name of a topology's set: its signature, and a digest of the order of its unknowns."""
    digest = hashlib.sha256(f"{_VERSION} {topology.as_text()}".encode()).hexdigest()[:12]
    return f"{topology.signature}-{digest}"


def _folder() -> Path:
    return cache_folder("start_sets")
