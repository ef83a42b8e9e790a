"""A motor whose torque goes on straight beyond the corners of its table."""

from __future__ import annotations

import numpy as np

from linkwork.foundation.arrays import Array
from linkwork.motion.model import Model

__all__ = ["HeldMotor", "motors_of"]


class HeldMotor:
    """The motor on the input with a number; ``piece`` counts the corners below its speed."""

    def __init__(self, model: Model, number: int) -> None:
        own, which = model.description, model.description.inputs[number]
        assert which.motor is not None
        kind = "link" if model.equations.inputs[number].kind == "angle" else "slider"
        self.constant = which.motor.constant
        self.scale = float(model.input_scale[number])
        self._curve = which.motor.curve(kind, own.numbers, own.length)
        #: The speeds of its table, (C,); none without.
        self.corners = which.motor.corners(kind, own.numbers, own.length)
        self.piece: int | None = None

    def torque(self, rate: Array) -> Array:
        """Its torque, or force, at rates [rad/s] or [length/s], (B,)."""
        speed = rate / self.scale
        if self.piece is None or not len(self.corners):
            return self._curve(speed)
        ends = np.clip([self.piece - 1, self.piece], 0, len(self.corners) - 1)
        low, high = self.corners[ends]
        first, last = self._curve(self.corners[ends])
        slope = (last - first) / (high - low) if high > low else 0.0
        found: Array = first + slope * (speed - low)
        return found

    def margins(self, rate: Array) -> list[Array]:
        """How far it is above every corner, (B,) each."""
        return [rate / self.scale - corner for corner in self.corners]


def motors_of(model: Model) -> list[HeldMotor | None]:
    """The motors of all inputs."""
    inputs = enumerate(model.description.inputs)
    return [None if which.motor is None else HeldMotor(model, k) for k, which in inputs]
