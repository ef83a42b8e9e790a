"""Exudyn: rigid bodies and revolute joints, generalised-α of index 3."""

from __future__ import annotations

from importlib import import_module
from typing import Any

from benchmarks.motions.bodies import Bodies, Body

__all__ = ["by_exudyn"]


def by_exudyn(machine: Bodies, until: float, steps: int, newton: tuple[float, float]) -> float:
    """Angle by which the first body turns until a time [rad].

    ``newton``: relative and absolute tolerance of its Newton-Raphson.
    """
    exudyn: Any = import_module("exudyn")
    items: Any = import_module("exudyn.itemInterface")
    exudyn.config.printToConsole = False
    system = exudyn.SystemContainer().AddSystem()
    ground = system.AddObject(items.ObjectGround())
    nodes, objects = [], []
    for body in machine.bodies:
        node, own = _add(system, items, body)
        nodes.append(node)
        objects.append(own)
        weight = system.AddMarker(items.MarkerBodyMass(bodyNumber=own))
        load = [0.0, -machine.weight, 0.0]
        system.AddLoad(items.LoadMassProportional(markerNumber=weight, loadVector=load))

    def marker(body: int | None, at: complex) -> Any:
        arm = at if body is None else at - machine.bodies[body].center
        number = ground if body is None else objects[body]
        place = items.MarkerBodyPosition(bodyNumber=number, localPosition=[arm.real, arm.imag, 0.0])
        return system.AddMarker(place)

    for pin in machine.pins:
        ends = [marker(pin.first, pin.at), marker(pin.second, pin.at)]
        system.AddObject(items.ObjectJointRevolute2D(markerNumbers=ends))
    for spring in machine.springs:
        ends = [marker(None, spring.fixed), marker(spring.body, spring.at)]
        system.AddObject(
            items.ObjectConnectorSpringDamper(
                markerNumbers=ends, referenceLength=spring.free, stiffness=spring.stiffness
            )
        )
    if machine.torque:
        turned = system.AddMarker(items.MarkerNodeCoordinate(nodeNumber=nodes[0], coordinate=2))
        system.AddLoad(items.LoadCoordinate(markerNumber=turned, load=machine.torque))
    system.Assemble()
    system.SolveDynamic(_settings(exudyn, until, steps, newton, len(machine.bodies)))
    coordinates = system.GetNodeOutput(nodes[0], exudyn.OutputVariableType.Coordinates)
    return float(coordinates[2])


def _add(system: Any, items: Any, body: Body) -> tuple[Any, Any]:
    velocity = [body.velocity.real, body.velocity.imag, body.rate]
    node = system.AddNode(
        items.NodeRigidBody2D(
            referenceCoordinates=[body.center.real, body.center.imag, 0.0],
            initialVelocities=velocity,
        )
    )
    own = items.ObjectRigidBody2D(mass=body.mass, inertia=body.inertia, nodeNumber=node)
    return node, system.AddObject(own)


def _settings(
    exudyn: Any, until: float, steps: int, newton: tuple[float, float], bodies: int
) -> Any:
    settings = exudyn.SimulationSettings()
    settings.timeIntegration.numberOfSteps = steps
    settings.timeIntegration.endTime = until
    settings.timeIntegration.verboseMode = 0
    # index 2 (Newmark) ends at a flat position, where constraints are redundant
    settings.timeIntegration.generalizedAlpha.spectralRadius = 0.6
    settings.timeIntegration.newton.relativeTolerance = newton[0]
    settings.timeIntegration.newton.absoluteTolerance = newton[1]
    settings.solutionSettings.writeSolutionToFile = False
    if bodies > 20:
        settings.linearSolverType = exudyn.LinearSolverType.EigenSparse
    return settings
