"""python-solvespace: a sketch of points and distances, its crank pin dragged from row to row."""

from __future__ import annotations

from dataclasses import dataclass
from importlib import import_module
from typing import Any

import numpy as np

from benchmarks.peers.dyad_linkage import Array, ComplexArray, DyadLinkage
from benchmarks.peers.peer import Peer, Prepared
from benchmarks.peers.rapier import RapierDrive
from benchmarks.peers.work import Member, Work

__all__ = ["Solvespace"]

GIVEN, SOLVED = 1, 2  # groups of the sketch


@dataclass(frozen=True, kw_only=True)
class _Sketch:
    system: Any
    pin: Any
    traced: Any
    pivot: complex
    radius: float
    start: list[tuple[Any, list[float]]]


class Solvespace(Peer):
    """The constraint solver of SolveSpace."""

    name = "python-solvespace"
    distribution = "python-solvespace"
    module = "python_solvespace"
    most_members = 20

    def cannot(self, work: Work) -> str:
        return "" if work.dyads or work.rapiers else "cannot: not written for it"

    def prepare(self, work: Work) -> Prepared:
        okay = import_module("python_solvespace").ResultFlag.OKAY
        sketches = [_sketch(member, work) for member in work.members]

        def run() -> ComplexArray:
            return np.array([_rows(sketch, work.inputs, okay) for sketch in sketches])

        return Prepared(run=run, read=lambda positions: positions)


def _rows(sketch: _Sketch, inputs: Array, okay: int) -> ComplexArray:
    system = sketch.system
    for params, values in sketch.start:
        system.set_params(params, values)
    rows = np.full(len(inputs), np.nan, complex)
    for row, pin in enumerate((sketch.pivot + sketch.radius * np.exp(1j * inputs)).tolist()):
        system.set_params(sketch.pin.params, [pin.real, pin.imag])
        if system.solve() == okay:
            rows[row] = complex(*system.params(sketch.traced.params))
    return rows


def _sketch(member: Member, work: Work) -> _Sketch:
    system = import_module("python_solvespace").SolverSystem()
    plane = system.create_2d_base()
    if member.dyads is not None:
        return _of_dyads(system, plane, member.dyads, work.inputs)
    if member.rapier is not None:
        return _of_rapier(system, plane, member.rapier, member, float(work.inputs[0]))
    raise ValueError(f"{work.name} is no chain of dyads and no rapier drive")


def _of_dyads(system: Any, plane: Any, linkage: DyadLinkage, inputs: Array) -> _Sketch:
    at = {name: complex(p.reshape(-1)[0]) for name, p in linkage.positions(inputs[:1]).items()}
    points = {}
    system.set_group(GIVEN)
    for name in (*linkage.ground, linkage.pin):
        points[name] = system.add_point_2d(at[name].real, at[name].imag, plane)
    system.set_group(SOLVED)
    for dyad in linkage.dyads:
        place = at[dyad.point]
        point = points[dyad.point] = system.add_point_2d(place.real, place.imag, plane)
        system.distance(points[dyad.first], point, dyad.first_length, plane)
        system.distance(points[dyad.second], point, dyad.second_length, plane)
    return _Sketch(
        system=system,
        pin=points[linkage.pin],
        traced=points[linkage.traced],
        pivot=at[linkage.pivot],
        radius=float(linkage.radius),
        start=[
            (points[dyad.point].params, [at[dyad.point].real, at[dyad.point].imag])
            for dyad in linkage.dyads
        ],
    )


def _of_rapier(system: Any, plane: Any, drive: RapierDrive, member: Member, u: float) -> _Sketch:
    rod, lever, rocker = member.loops.start[:3]
    pin = drive.crank * np.exp(1j * u)
    c = drive.pivot + drive.rocker * np.exp(1j * rocker)
    places = [
        pin + drive.rod * np.exp(1j * rod),
        c,
        c - drive.to_slide * np.exp(1j * lever),
    ]
    system.set_group(GIVEN)
    a = system.add_point_2d(pin.real, pin.imag, plane)
    c0 = system.add_point_2d(drive.pivot.real, drive.pivot.imag, plane)
    ends = [system.add_point_2d(x, drive.slide, plane) for x in (-2000.0, 0.0)]
    line = system.add_line_2d(*ends, plane)
    system.set_group(SOLVED)
    points = [system.add_point_2d(place.real, place.imag, plane) for place in places]
    b, pivot, d = points
    system.distance(a, b, drive.rod, plane)
    system.distance(c0, pivot, drive.rocker, plane)
    system.distance(b, pivot, drive.to_rod, plane)
    system.distance(b, d, drive.to_rod + drive.to_slide, plane)
    system.coincident(pivot, system.add_line_2d(b, d, plane), plane)
    system.coincident(d, line, plane)
    return _Sketch(
        system=system,
        pin=a,
        traced=d,
        pivot=0.0,
        radius=drive.crank,
        start=[
            (point.params, [place.real, place.imag])
            for point, place in zip(points, places, strict=True)
        ],
    )
