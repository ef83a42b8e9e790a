"""Designs of the atlas and improved ones, as a task judges them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import linkwork as lw
from linkwork.core.foundation.errors import InputError
from linkwork.synthesis import suggesting
from linkwork.synthesis.defects.verdicts import DefectKind
from linkwork.synthesis.suggesting import Origin
from linkwork.synthesis.tasks.task import Task


def path_task(angle: str = "deg", wanted: str = "", count: int = 24) -> Task:
    """The task of a path that Hoeken's linkage draws, moved and enlarged."""
    path = lw.example("hoeken").sweep(step=5).trace("P")[:-1]
    z = 3.0 * path[:: max(1, len(path) // count)] * np.exp(0.7j) + (100 - 40j)
    rows = "\n".join(f"[[positions]]\npoint = [{p.real:.4f}, {p.imag:.4f}]" for p in z)
    head = f'format = 1\ntask = "path"\nlength = "in"\nangle = "{angle}"\n'
    return lw.Task.loads(f"{head}{rows}\n[wanted]\n{wanted}").described


def told(_fraction: float) -> None:
    """Nobody listens."""


def test_the_nearest_paths_lie_on_the_positions_in_the_units_of_the_task() -> None:
    for angle, count in (("deg", 3), ("rad", 1)):
        task = path_task(angle)
        found = suggesting.nearest(task, count, told)
        assert [design.origin for design in found] == [Origin.ATLAS] * count
        size = np.ptp([position.point[0] for position in task.positions])
        judged = [design.judged(task, suggesting.wishes(task)) for design in found]
        for design in judged:
            assert design.error < 0.15 * size  # the first three are nearer than 2 % by their shape
            assert design.kinds == ()
            assert design.linkage.length == "in"
            assert design.linkage.angle is task.angle
            motion = lw.Mechanism(design.linkage).sweep()
            lead = np.asarray(next(iter(motion.inputs.values())))
            assert abs(lead[-1] - lead[0]) == pytest.approx(task.angle.turn)
            assert motion.certified.all()
        assert 0 < judged[0].transmission < task.angle.turn / 4


def test_another_task_judges_anew() -> None:
    task = path_task()
    design = suggesting.nearest(task, 1, told)[0]
    before = design.judged(task, suggesting.wishes(task))
    far = replace(task.positions[0], point=(1e4, 0.0))
    moved = replace(task, positions=(far, *task.positions[1:]))
    assert design.judged(moved, suggesting.wishes(moved)).error > 9e3
    strict = replace(task, wanted=replace(task.wanted, transmission=89.0))
    judged = design.judged(strict, suggesting.wishes(strict))
    assert DefectKind.TRANSMISSION in judged.kinds
    assert DefectKind.TRANSMISSION not in before.kinds


def test_designs_without_the_given_lengths_and_pivots_are_refused() -> None:
    task = path_task(count=8)
    found = suggesting.nearest(task, 8, told)
    bar, crank = (
        next(d for d in found if d.mechanism.startswith(kind)) for kind in ("Four-bar", "Slider")
    )
    points = bar.judged(task, suggesting.wishes(task)).points
    length, pivot = abs(points["A"] - points["A0"]), points["A0"]
    own = replace(
        task.given,
        lengths={"A0 A": length, "B0 B": abs(points["B"] - points["B0"])},
        fixed_pivots=((pivot.real, pivot.imag),),
    )
    same = replace(task, given=own)
    assert bar.judged(same, suggesting.wishes(same)).kinds == ()
    messages = [d.message for d in crank.judged(same, suggesting.wishes(same)).defects]
    assert len(messages) == 3
    assert messages[0].startswith("no fixed pivot at (")
    assert messages[2].startswith('no length "B0 B", given as ')
    other = replace(task, given=replace(own, lengths={"A0 A": 1.01 * length}))
    assert [d.message for d in bar.judged(other, suggesting.wishes(other)).defects] == [
        f'the length "A0 A" is {length:.6g} in, given as {1.01 * length:g} in'
    ]


def test_a_stopped_improvement_keeps_a_design_that_meets_the_positions_better() -> None:
    task = path_task(count=8)
    found = suggesting.nearest(task, 8, told)
    begin = next(design for design in found if design.mechanism.startswith("Four-bar"))
    before = begin.judged(task, suggesting.wishes(task)).error
    calls: list[float] = []

    def stop(fraction: float) -> None:
        calls.append(fraction)
        if len(calls) > 20:
            raise KeyboardInterrupt

    linkage = begin.improved.description
    better = suggesting.improved(task, linkage, begin.mechanism, stop)
    judged = better.judged(task, suggesting.wishes(task))
    assert better.origin is Origin.IMPROVED
    assert "interrupted" in better.improved.message
    assert judged.error < before
    assert lw.Mechanism(judged.linkage).sweep().certified.all()


def test_what_cannot_be_suggested_says_why() -> None:
    few = path_task(count=3)
    with pytest.raises(InputError, match="5 positions or more, got 3"):
        suggesting.nearest(replace(few, positions=few.positions[:3]), 1, told)
    long = path_task(count=8)
    long = replace(long, given=replace(long.given, lengths={"A0 A": 40.0}))
    with pytest.raises(InputError, match='"A0 A" is given as 40, which this design does not have'):
        suggesting.improved(long, lw.example("hoeken").description, "hoeken", told)
    poses = lw.Task.motion([(0, 0, 0), (2, 1, 20), (3, 3, 50)]).described
    linkage = lw.example("four-bar").description
    with pytest.raises(InputError, match="towards points"):
        suggesting.improved(poses, linkage, "four-bar", told)
    assert suggesting.starting_design(poses) is None
