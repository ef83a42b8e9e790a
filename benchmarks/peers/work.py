"""What all are asked to do: mechanisms and input values."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from benchmarks.peers.dyad_linkage import Array, Dyad, DyadLinkage
from benchmarks.peers.loop_system import LoopSystem, loops_of
from benchmarks.peers.rapier import RapierDrive

__all__ = [
    "Member",
    "Work",
    "dyad_work",
    "four_bar",
    "four_bar_family",
    "full_turn",
    "jansen_leg",
    "rapier_drive",
    "works",
]


@dataclass(frozen=True, kw_only=True, eq=False)
class Member:
    """One mechanism: its loop equations, and what else is known of its structure.

    Parameters
    ----------
    dyads : DyadLinkage, optional
        Where closed forms can solve it.
    rapier : RapierDrive, optional
        Where it is this one: some peers are told of its links and its slide.
    """

    loops: LoopSystem
    dyads: DyadLinkage | None = None
    rapier: RapierDrive | None = None


@dataclass(frozen=True, kw_only=True, eq=False)
class Work:
    """One or many mechanisms of one structure, over one table of input values.

    Parameters
    ----------
    inputs : array (rows,)
        Crank angles [rad], evenly spaced.
    """

    name: str
    members: Sequence[Member]
    inputs: Array

    @property
    def rows(self) -> int:
        """Input values of every member."""
        return len(self.inputs)

    @property
    def step(self) -> float:
        """From one input value to the next [rad]."""
        return float(self.inputs[1] - self.inputs[0])

    @property
    def positions(self) -> int:
        """Members times rows."""
        return len(self.members) * self.rows

    @property
    def dyads(self) -> list[DyadLinkage]:
        """The dyads of all members; empty where closed forms cannot solve them."""
        return [member.dyads for member in self.members if member.dyads is not None]

    @property
    def rapiers(self) -> list[RapierDrive]:
        """The members that are rapier drives."""
        return [member.rapier for member in self.members if member.rapier is not None]

    def sample(self, members: int) -> Work:
        """The same work for the first members only."""
        return replace(self, members=self.members[:members])


def full_turn(rows: int) -> Array:
    """0 to 360 degrees, both inclusive [rad]."""
    return np.linspace(0.0, 2.0 * np.pi, rows)


def dyad_work(name: str, linkages: Sequence[DyadLinkage], inputs: Array) -> Work:
    """Work on mechanisms of dyads, their loop equations written for them."""
    members = [
        Member(dyads=linkage, loops=loops_of(linkage, float(inputs[0]))) for linkage in linkages
    ]
    return Work(name=name, members=members, inputs=inputs)


def four_bar(rows: int) -> Work:
    """The crank-rocker of Norton, Design of Machinery, example 4-1, open."""
    linkage = _four_bar(ground=100.0, crank=40.0, coupler=120.0, rocker=80.0)
    return dyad_work(f"four-bar, {rows:,} rows", [linkage], full_turn(rows))


def four_bar_family(members: int = 10_000, rows: int = 200) -> Work:
    """Random crank-rockers whose shortest transmission angle stays above about 15 degrees."""
    rng = np.random.default_rng(200)
    linkages: list[DyadLinkage] = []
    while len(linkages) < members:
        crank = rng.uniform(0.2, 0.5)
        ground, coupler, rocker = rng.uniform(0.8, 1.6, 3)
        nearest, farthest = ground - crank, ground + crank
        if _far_from_line(nearest, coupler, rocker) and _far_from_line(farthest, coupler, rocker):
            linkages.append(_four_bar(ground, crank, coupler, rocker))
    inputs = np.linspace(0.0, 2.0 * np.pi, rows, endpoint=False)
    return dyad_work(f"{members:,} four-bars, {rows} inputs each", linkages, inputs)


def _far_from_line(diagonal: float, coupler: float, rocker: float) -> bool:
    cosine = (coupler**2 + rocker**2 - diagonal**2) / (2.0 * coupler * rocker)
    return bool(abs(cosine) < np.cos(np.radians(15.0)))


def _four_bar(ground: float, crank: float, coupler: float, rocker: float) -> DyadLinkage:
    dyad = Dyad(
        point="B", first="A", first_length=coupler, second="O4", second_length=rocker, left=True
    )
    return DyadLinkage(
        ground={"O2": 0.0, "O4": complex(ground)},
        pivot="O2",
        pin="A",
        radius=crank,
        dyads=[dyad],
        traced="B",
    )


def jansen_leg(rows: int) -> Work:
    """The leg of Theo Jansen's eleven holy numbers; the foot is compared."""
    return dyad_work(f"Jansen leg, {rows:,} rows", [_jansen_leg()], full_turn(rows))


def _jansen_leg() -> DyadLinkage:
    def dyad(
        point: str,
        first: tuple[str, float],
        second: tuple[str, float],
        *,
        left: bool,
        rigid: bool = False,
    ) -> Dyad:
        return Dyad(
            point=point,
            first=first[0],
            first_length=first[1],
            second=second[0],
            second_length=second[1],
            left=left,
            rigid=rigid,
        )

    return DyadLinkage(
        ground={"O": 0.0, "P": -38.0 - 7.8j},
        pivot="O",
        pin="A",
        radius=15.0,
        dyads=[
            dyad("B", ("A", 50.0), ("P", 41.5), left=False),
            dyad("C", ("A", 61.9), ("P", 39.3), left=True),
            dyad("D", ("P", 40.1), ("B", 55.8), left=True, rigid=True),
            dyad("E", ("D", 39.4), ("C", 36.7), left=False),
            dyad("F", ("C", 49.0), ("E", 65.7), left=True, rigid=True),
        ],
        traced="F",
    )


def rapier_drive(rows: int) -> Work:
    """The rapier drive of a loom: four coupled equations, so no dyads; D is compared."""
    inputs = full_turn(rows)
    drive = RapierDrive()
    member = Member(loops=drive.loops(float(inputs[0])), rapier=drive)
    return Work(name=f"rapier drive, {rows:,} rows", members=[member], inputs=inputs)


def works() -> list[Work]:
    """All comparisons, in the order of the report."""
    return [
        four_bar(361),
        four_bar(3601),
        jansen_leg(361),
        jansen_leg(3601),
        rapier_drive(361),
        rapier_drive(3601),
        four_bar_family(),
    ]
