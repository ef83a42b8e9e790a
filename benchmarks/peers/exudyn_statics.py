"""Exudyn: points with distance constraints, the crank pin prescribed, one static step per row."""

from __future__ import annotations

from dataclasses import dataclass
from importlib import import_module
from typing import Any

import numpy as np

from benchmarks.peers.dyad_linkage import Array, ComplexArray, DyadLinkage
from benchmarks.peers.peer import Peer, Prepared
from benchmarks.peers.rapier import RapierDrive
from benchmarks.peers.work import Member, Work

__all__ = ["ExudynStatics"]


@dataclass(frozen=True, kw_only=True)
class _Model:
    system: Any
    sensor: Any
    kept: list[Any]  # user functions, which must outlive the model


class ExudynStatics(Peer):
    """``mbs.SolveStatic``: the load factor drives the crank, one load step per row."""

    name = "exudyn"
    distribution = "exudyn"
    module = "exudyn"
    most_members = 50

    def cannot(self, work: Work) -> str:
        return "" if work.dyads or work.rapiers else "cannot: not written for it"

    def prepare(self, work: Work) -> Prepared:
        exudyn = import_module("exudyn")
        exudyn.config.printToConsole = False
        models = [_Builder(work.inputs).model(member) for member in work.members]
        settings = _settings(exudyn, work)

        def run() -> list[Array]:
            rows = []
            for model in models:
                model.system.SolveStatic(settings, storeSolver=False)
                rows.append(model.system.GetSensorStoredData(model.sensor))
            return rows

        def read(rows: list[Array]) -> ComplexArray:
            table = np.array(rows)
            positions: ComplexArray = table[..., 1] + 1j * table[..., 2]
            return positions

        return Prepared(run=run, read=read)


def _settings(exudyn: Any, work: Work) -> Any:
    settings = exudyn.SimulationSettings()
    static = settings.staticSolver
    static.numberOfLoadSteps = work.rows - 1
    static.loadStepDuration = 1.0
    static.verboseMode = 0
    static.newton.relativeTolerance = 1e-12
    static.newton.absoluteTolerance = 1e-12
    settings.solution.file.write = False
    settings.solution.sensors.writePeriod = 1e-9  # every load step
    return settings


class _Builder:
    """One model: points as masses, links as distances, and a pin that is moved."""

    def __init__(self, inputs: Array) -> None:
        self.exudyn = import_module("exudyn")
        self.items = import_module("exudyn.itemInterface")
        self.inputs = inputs
        self.system = self.exudyn.SystemContainer().AddSystem()
        self.ground = self.system.AddObject(self.items.ObjectGround())
        node = self.system.AddNode(self.items.NodePointGround())
        self.zero = self.system.AddMarker(
            self.items.MarkerNodeCoordinate(nodeNumber=node, coordinate=0)
        )
        self.kept: list[Any] = []

    def model(self, member: Member) -> _Model:
        if member.dyads is not None:
            traced = self._dyads(member.dyads)
        elif member.rapier is not None:
            traced = self._rapier(member.rapier, member.loops.start)
        else:
            raise ValueError("no chain of dyads and no rapier drive")
        sensor = self.system.AddSensor(
            self.items.SensorNode(
                nodeNumber=traced,
                storeInternal=True,
                writeToFile=False,
                outputVariableType=self.exudyn.OutputVariableType.Position,
            )
        )
        self.system.Assemble()
        return _Model(system=self.system, sensor=sensor, kept=self.kept)

    def _dyads(self, linkage: DyadLinkage) -> Any:
        at = {
            name: complex(p.reshape(-1)[0])
            for name, p in linkage.positions(self.inputs[:1]).items()
        }
        markers = {name: self._fixed(at[name]) for name in linkage.ground}
        nodes = {linkage.pin: self._pin(at[linkage.pivot], float(linkage.radius))}
        markers[linkage.pin] = self._marker(nodes[linkage.pin])
        for dyad in linkage.dyads:
            nodes[dyad.point] = self._point(at[dyad.point])
            markers[dyad.point] = self._marker(nodes[dyad.point])
            self._distance(markers[dyad.first], markers[dyad.point], dyad.first_length)
            self._distance(markers[dyad.second], markers[dyad.point], dyad.second_length)
        return nodes[linkage.traced]

    def _rapier(self, drive: RapierDrive, start: Array) -> Any:
        """The lever is a rigid body whose reference point is D."""
        lever = float(start[1])
        place = complex(start[3], drive.slide)
        node = self.system.AddNode(
            self.items.NodeRigidBody2D(referenceCoordinates=[place.real, place.imag, lever])
        )
        body = self.system.AddObject(
            self.items.ObjectRigidBody2D(mass=1.0, inertia=1.0, nodeNumber=node)
        )
        at_c, at_b = (
            self.system.AddMarker(
                self.items.MarkerBodyPosition(bodyNumber=body, localPosition=[along, 0.0, 0.0])
            )
            for along in (drive.to_slide, drive.to_slide + drive.to_rod)
        )
        height = self.system.AddMarker(
            self.items.MarkerNodeCoordinate(nodeNumber=node, coordinate=1)
        )
        self.system.AddObject(
            self.items.ObjectConnectorCoordinate(markerNumbers=[self.zero, height])
        )
        pin = self._marker(self._pin(0.0, drive.crank))
        self._distance(pin, at_b, drive.rod)
        self._distance(self._fixed(drive.pivot), at_c, drive.rocker)
        return node

    def _fixed(self, place: complex) -> Any:
        return self.system.AddMarker(
            self.items.MarkerBodyPosition(
                bodyNumber=self.ground, localPosition=[place.real, place.imag, 0.0]
            )
        )

    def _marker(self, node: Any) -> Any:
        return self.system.AddMarker(self.items.MarkerNodePosition(nodeNumber=node))

    def _point(self, place: complex) -> Any:
        node = self.system.AddNode(
            self.items.NodePoint2D(referenceCoordinates=[place.real, place.imag])
        )
        self.system.AddObject(self.items.ObjectMassPoint2D(mass=1.0, nodeNumber=node))
        return node

    def _distance(self, one: Any, other: Any, length: Any) -> None:
        self.system.AddObject(
            self.items.ObjectConnectorDistance(markerNumbers=[one, other], distance=float(length))
        )

    def _pin(self, pivot: complex, radius: float) -> Any:
        """The crank's pin, its displacement a function of the load factor t from 0 to 1."""
        first, turn = float(self.inputs[0]), float(self.inputs[-1] - self.inputs[0])
        start = pivot + radius * np.exp(1j * first)
        node = self._point(complex(start))
        away = complex(start - pivot)
        symbolic = self.exudyn.symbolic

        def along_x(mbs: Any, t: Any, itemNumber: Any, lOffset: Any) -> Any:
            return radius * symbolic.cos(first + turn * t) - away.real

        def along_y(mbs: Any, t: Any, itemNumber: Any, lOffset: Any) -> Any:
            return radius * symbolic.sin(first + turn * t) - away.imag

        create = import_module("exudyn.advancedUtilities").CreateSymbolicUserFunction
        for coordinate, offset in enumerate((along_x, along_y)):
            marker = self.system.AddMarker(
                self.items.MarkerNodeCoordinate(nodeNumber=node, coordinate=coordinate)
            )
            item = self.system.AddObject(
                self.items.ObjectConnectorCoordinate(markerNumbers=[self.zero, marker])
            )
            function = create(self.system, offset, "offsetUserFunction", item)
            self.system.SetObjectParameter(item, "offsetUserFunction", function)
            self.kept.append(function)
        return node
