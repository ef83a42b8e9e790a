"""pylinkage: dyads in closed form, compiled by numba; one linkage, or an ensemble of them."""

from __future__ import annotations

from collections.abc import Sequence
from importlib import import_module
from typing import Any

import numpy as np

from benchmarks.peers.dyad_linkage import Array, ComplexArray, DyadLinkage
from benchmarks.peers.peer import DyadPeer, Prepared
from benchmarks.peers.work import Work

__all__ = ["PylinkageEnsemble", "PylinkageStepFast"]


class PylinkageStepFast(DyadPeer):
    """``Linkage.step_fast``: one call for all rows of one linkage."""

    name = "pylinkage step_fast"
    distribution = "pylinkage"
    module = "pylinkage"
    most_members = 200

    def prepare(self, work: Work) -> Prepared:
        built = [_linkage(member, work) for member in work.dyads]
        starts = [linkage.get_coords() for linkage in built]
        which = _index(work.dyads[0])

        def run() -> list[Array]:
            rows = []
            for linkage, start in zip(built, starts, strict=True):
                linkage.set_coords(start)  # a run leaves the linkage at its last row
                rows.append(linkage.step_fast(work.rows))
            return rows

        def read(rows: list[Array]) -> ComplexArray:
            points = np.array([trajectory[:, which] for trajectory in rows])
            positions: ComplexArray = points[..., 0] + 1j * points[..., 1]
            return positions

        return Prepared(run=run, read=read)


class PylinkageEnsemble(DyadPeer):
    """``Ensemble.simulate``: all members of one structure in one call."""

    name = "pylinkage Ensemble"
    distribution = "pylinkage"
    module = "pylinkage"

    def cannot(self, work: Work) -> str:
        return super().cannot(work) or ("" if len(work.members) > 1 else "for families")

    def prepare(self, work: Work) -> Prepared:
        built = [_linkage(member, work) for member in work.dyads]
        ensemble = import_module("pylinkage").Ensemble(
            built[0],
            np.array([linkage.get_constraints() for linkage in built], float),
            np.array([linkage.get_coords() for linkage in built], float),
        )
        which = _index(work.dyads[0])

        def run() -> Array:
            rows: Array = ensemble.simulate(work.rows, store=False)
            return rows

        def read(rows: Array) -> ComplexArray:
            positions: ComplexArray = rows[:, :, which, 0] + 1j * rows[:, :, which, 1]
            return positions

        return Prepared(run=run, read=read)


def _index(member: DyadLinkage) -> int:
    names = [*member.ground, member.pin, *(dyad.point for dyad in member.dyads)]
    return names.index(member.traced)


def _linkage(member: DyadLinkage, work: Work) -> Any:
    """One step before the first row, because every step turns the crank first."""
    pylinkage = import_module("pylinkage")
    first = float(work.inputs[0]) - work.step
    start = member.positions(work.inputs[:1])
    parts: dict[str, Any] = {}
    for name, point in member.ground.items():
        parts[name] = pylinkage.Ground(np.real(point), np.imag(point), name=name)
    parts[member.pin] = pylinkage.Crank(
        anchor=parts[member.pivot],
        radius=member.radius,
        angular_velocity=work.step,
        initial_angle=first,
        name=member.pin,
    )
    for dyad in member.dyads:
        anchors = {"anchor1": parts[dyad.first], "anchor2": parts[dyad.second], "name": dyad.point}
        if dyad.rigid:
            point, one, other = (
                start[name].reshape(-1)[0] for name in (dyad.point, dyad.first, dyad.second)
            )
            parts[dyad.point] = pylinkage.FixedDyad(
                distance=dyad.first_length,
                angle=float(np.angle((point - one) / (other - one))),
                **anchors,
            )
        else:
            place = complex(start[dyad.point].reshape(-1)[0])
            parts[dyad.point] = pylinkage.RRRDyad(
                distance1=dyad.first_length,
                distance2=dyad.second_length,
                x=place.real,
                y=place.imag,
                **anchors,
            )
    components: Sequence[Any] = list(parts.values())
    return pylinkage.Linkage(components)
