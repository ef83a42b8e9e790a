"""One design's rows, prepared once and computed again and again."""

from __future__ import annotations

import numpy as np
import pytest

import linkwork as lw
from linkwork.batch.lane_rows import March, Path
from linkwork.kernels.lanes.gear import Gear


def _march(family: object, certify: bool) -> tuple[March, np.ndarray]:
    designs = family.designs  # type: ignore[attr-defined]
    path = Path.of(designs.base)
    assert path is not None
    t = designs.base.rows[:, path.lead]
    return path.march(designs, certify, 1, Gear()), np.ascontiguousarray(t)


@pytest.mark.parametrize("certify", [False, True])
@pytest.mark.parametrize("name", ["four-bar", "jansen-leg", "crank-slider"])
def test_they_are_those_of_the_sweep_every_time(name: str, certify: bool) -> None:
    mechanism = lw.example(name)
    table = mechanism.description.lengths if name != "crank-slider" else {"a": 40.0}
    length, value = next(iter(table.items()))
    family = mechanism.family({length: [value]})
    march, t = _march(family, certify)
    one = march.of_one(t)
    motion = mechanism.sweep()
    q = np.stack([motion[u.name] for u in mechanism.model.equations.unknowns])
    unit = np.array(
        [np.pi / 180 if u.kind == "angle" else 1.0 for u in mechanism.model.equations.unknowns]
    )
    for _ in range(2):
        found = one.run()
        assert found is not None
        v, radius = found
        assert v[:, :, 0] == pytest.approx(q * unit[:, None], rel=1e-12, abs=1e-12)
        assert radius.shape == (len(t) if certify else 0, 1)
        assert (radius > 0).all()
        assert (radius < 1e-9).all()


@pytest.mark.parametrize("certify", [False, True])
def test_a_table_that_is_not_reached_is_left_to_the_march(certify: bool) -> None:
    mechanism = lw.example("four-bar")
    march, t = _march(mechanism.family({"O2 A": [95.0]}), certify)
    assert march.of_one(t).run() is None
