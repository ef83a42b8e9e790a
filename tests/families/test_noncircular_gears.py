"""Families of mechanisms with non-circular gears: one law, any lengths."""

from __future__ import annotations

import numpy as np

import linkwork as lw


def test_designs_of_one_law_move_as_each_of_them_does() -> None:
    mechanism, sizes = lw.example("elliptical-gears"), [40.0, 50.0, 65.0]
    motion = mechanism.family({"a": np.array(sizes)}).sweep()
    assert motion.found.all()
    for k, size in enumerate(sizes):
        alone = mechanism.with_dimensions(a=size).sweep()
        np.testing.assert_allclose(
            motion.series("second").value[k], alone["second"], rtol=0, atol=1e-11
        )


def test_a_design_of_another_law_has_another_structure() -> None:
    motion = lw.example("elliptical-gears").family({"ecc": np.array([0.4, 0.3])}).sweep()
    assert motion.found[0].all()
    assert not motion.found[1].any()
