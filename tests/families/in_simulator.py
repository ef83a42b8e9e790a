"""Families small enough for numba's CUDA simulator: ``python -m tests.families.in_simulator FILE``.

The simulator runs kernels as Python, thread by thread. It has to be asked for before numba is
loaded, so it has a process of its own, which leaves what it found in a file of arrays.
"""

from __future__ import annotations

import os
import sys
from typing import Any

import numpy as np

import linkwork as lw
from benchmarks import gpu
from linkwork.core.foundation.arrays import BoolArray
from linkwork.families import Family
from linkwork.families.family_motion import FamilyMotion
from linkwork.families.gpu import kernel as device_kernel
from linkwork.families.gpu.kernel import Chunk, DeviceKernel
from linkwork.families.march.step_trial import MarchResult

ARRAYS = ("v", "status", "certification", "radius", "turns", "limits", "limit_kinds", "alone")


def five_bar() -> lw.Mechanism:
    """Two cranks in lock-step, with a guess beside the table's path of inputs."""
    return lw.loops(
        angle="rad",
        loops={"1": "r*e^(i*a) + l*e^(i*p) = g + r*e^(i*b) + l*e^(i*q)"},
        dimensions={"r": 1.0, "l": 2.0, "g": 1.5},
        guess={"a": 1.1, "b": 0.3, "p": 0.7, "q": 2.0},
        inputs=(
            lw.Input(variable="a", from_=1.0, to=1.2, step=0.1),
            lw.Input(variable="b", from_=0.1, to=0.3, step=0.1),
        ),
    )


def families() -> dict[str, tuple[Family, bool]]:
    """By name, with whether they are proved."""
    four_bar = lw.example("four-bar").driven_by(link="crank", from_=0, to=360, step=30)
    rocking = lw.example("four-bar").driven_by(link="crank", from_=0, to=360, step=60)
    falling = lw.example("jansen-leg").driven_by(link="crank", from_=90, to=-30, step=-30)
    lengths = np.array([118.0, 300.0, 121.0, 123.0, 116.0])  # the second one cannot be built
    return {
        "four-bar, proved": (four_bar.family({"A B": lengths}), True),
        "four-bar with dead points, proved": (rocking.family({"A B": [58.0, 62.0]}), True),
        "four-bar with dead points": (rocking.family({"A B": [58.0, 62.0]}), False),
        "jansen-leg": (falling.family({"O A": [14.5, 15.5]}), False),
        "two inputs, proved": (five_bar().family({"l": [2.0, 2.1]}), True),
    }


def found(motion: FamilyMotion) -> dict[str, np.ndarray]:
    """What there is to compare."""
    return {name: np.asarray(getattr(motion.rows, name)) for name in ARRAYS}


def main(path: str) -> None:
    """Sweep all families on the simulated card, two designs at a time."""
    assert os.environ["NUMBA_ENABLE_CUDASIM"] == "1"
    arrays: dict[str, np.ndarray] = {}
    sizes: list[int] = []
    marches: list[MarchResult] = []
    chunk, run = DeviceKernel.chunk, DeviceKernel.run

    def noted_chunk(self: DeviceKernel, rows: int, designs: int) -> Chunk:
        sizes.append(designs)
        return chunk(self, rows, designs)

    def noted_run(self: DeviceKernel, *given: Any) -> BoolArray:
        marches.append(given[5])
        return run(self, *given)

    # methods are replaced for this process only, which ends with this function
    DeviceKernel.chunk = noted_chunk  # type: ignore[method-assign]
    DeviceKernel.run = noted_run  # type: ignore[method-assign, assignment]
    device_kernel._STAGED = 2_000
    for name, (family, certify) in families().items():
        marches.clear()
        motion = family.sweep(certify=certify, device="gpu")
        arrays |= {f"{name}/{key}": values for key, values in found(motion).items()}
        arrays |= {f"{name}/end": marches[0].end, f"{name}/last": marches[0].last}
    speed = gpu.kernel_speed(families()["jansen-leg"][0], False, 15)
    everything: dict[str, Any] = {"chunks": sizes, "speed": speed, **arrays}
    np.savez(path, **everything)


if __name__ == "__main__":
    main(sys.argv[1])
