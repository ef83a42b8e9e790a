"""What families are asked: parts, numbers per design, labelled arrays; and what they refuse."""

from __future__ import annotations

import math
import re

import numpy as np
import numpy.typing as npt
import pytest

import linkwork as lw
from linkwork.core.foundation.errors import InputError, UnknownNameError
from linkwork.core.foundation.statuses import Status
from linkwork.core.mechanism.linkage import Linkage
from linkwork.families import Family, FamilyMotion, designs_of
from tests.described import described_as

Array = npt.NDArray[np.float64]
CRANKS = np.array([40.0, 41.0, 110.0, 39.0, math.nan, 42.0])


@pytest.fixture(scope="module")
def family() -> Family:
    """Three whole circles, one with limits, one without a number, one whole circle."""
    return lw.example("four-bar").family({"O2 A": CRANKS})


@pytest.fixture(scope="module")
def motion(family: Family) -> FamilyMotion:
    return family.sweep()


# ------------------------------------------------------------------ numbers per design


def test_reductions_leave_out_rows_without_a_position(family: Family, motion: FamilyMotion) -> None:
    names = [f"{word}(B.x)" for word in ("min", "max", "mean", "stroke")]
    found = family.reduced(names)
    values = motion["B.x"]
    assert np.isnan(values[2]).any()
    for k in range(len(family)):
        there = values[k][~np.isnan(values[k])]
        if not len(there):
            for name in names:
                assert math.isnan(found[name][k])
            continue
        low, high = found["min(B.x)"][k], found["max(B.x)"][k]
        # extremes lie between rows, less than their step squared beyond them
        assert 0.0 <= there.min() - low < 1e-3 * np.ptp(there)
        assert 0.0 <= high - there.max() < 1e-3 * np.ptp(there)
        assert found["stroke(B.x)"][k] == high - low
        assert found["mean(B.x)"][k] == pytest.approx(there.mean(), rel=1e-12)
    np.testing.assert_array_equal(found["found"], motion.found.sum(axis=1))
    np.testing.assert_array_equal(found["certified"], motion.certified.sum(axis=1))
    assert list(found) == [*names, "found", "certified", "limit.lower", "limit.upper"]
    for name in names:
        np.testing.assert_allclose(motion.value(name), found[name], rtol=1e-12)
    np.testing.assert_array_equal(found["limit.lower"], motion.limits.lower)
    np.testing.assert_array_equal(found["limit.upper"], motion.limits.upper)


def test_reductions_may_be_functions_and_stand_alone(family: Family, motion: FamilyMotion) -> None:
    def last(values: Array) -> Array:
        return values[:, -1]

    found = family.reduced(
        {"rocker": last, "coupler": (last, lambda values: values[:, 0])},
        certify=False,
    )
    np.testing.assert_allclose(found["rocker.last"], motion["rocker"][:, -1], rtol=0, atol=1e-9)
    np.testing.assert_allclose(found["coupler.<lambda>"], motion["coupler"][:, 0], atol=1e-9)
    assert not found["certified"].any()


def test_reductions_do_not_depend_on_the_parts(
    family: Family, monkeypatch: pytest.MonkeyPatch
) -> None:
    whole = family.reduced(["min(rocker)", "mean(rocker)"])
    monkeypatch.setattr("linkwork.families.family._PART", 4)
    monkeypatch.setattr(Family.parts, "__defaults__", (4,))
    parted = family.reduced(["min(rocker)", "mean(rocker)"])
    for key, values in whole.items():
        np.testing.assert_allclose(parted[key], values, rtol=0, atol=1e-12, err_msg=key)


def test_reductions_of_no_use_are_refused(family: Family) -> None:
    told = (
        'there is no number "men" of a motion '
        "(nearest: mean, min, max; all: linkwork quantities FILE)"
    )
    with pytest.raises(InputError, match=re.escape(told)):
        family.reduced(["men(rocker)"])
    with pytest.raises(UnknownNameError, match='there is no "rokcer"'):
        family.take(slice(0)).reduced(["max(rokcer)"])
    with pytest.raises(InputError, match=re.escape('(write "stroke(rocker)")')):
        family.reduced("rocker.stroke")
    told = "rocker.<lambda> needs one number per design (6,), got (6, 361)"
    with pytest.raises(InputError, match=re.escape(told)):
        family.reduced({"rocker": lambda values: values})


def test_a_mapping_of_reductions_has_functions(family: Family) -> None:
    with pytest.raises(InputError, match=re.escape('family.reduced(["stroke(rocker)"])')):
        family.reduced({"rocker": "stroke"})


# ------------------------------------------------------------------ parts


def test_parts_are_the_whole_in_order(family: Family, motion: FamilyMotion) -> None:
    parts = list(family.parts(4, threads=1))
    assert [len(part) for part in parts] == [4, 2]
    np.testing.assert_array_equal(np.concatenate([part.status for part in parts]), motion.status)
    np.testing.assert_allclose(
        np.concatenate([part["B.x"] for part in parts]), motion["B.x"], rtol=0, atol=1e-12
    )
    with pytest.raises(InputError, match=r"^designs must be a whole number, 1 or more, got 0$"):
        family.parts(0)


def test_some_designs_are_a_family(family: Family, motion: FamilyMotion) -> None:
    for index in ([5, 0], CRANKS < 41.5, slice(1, 6, 2)):
        some = family.take(index)
        np.testing.assert_array_equal(some.dimensions["O2 A"], CRANKS[index])
        np.testing.assert_allclose(
            some.sweep()["rocker"], motion["rocker"][index], rtol=0, atol=1e-12
        )


def test_no_designs_have_no_motions() -> None:
    none = lw.example("four-bar").family({"O2 A": []})
    assert len(none) == 0
    motion = none.sweep()
    assert motion.status.shape == motion["rocker"].shape == (0, 361)
    assert motion.counts == {}
    assert list(none.parts()) == []
    found = none.reduced(["min(rocker)", "stroke(rocker)"])
    assert {key: values.shape for key, values in found.items()} == dict.fromkeys(
        ("min(rocker)", "stroke(rocker)", "found", "certified", "limit.lower", "limit.upper"), (0,)
    )


def test_what_would_not_fit_into_memory_is_refused(
    family: Family, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("linkwork.families.family._MOST_BYTES", 6 * 361 * 3 * 8 - 1)
    told = "6 designs × 361 rows take 0 GiB: use family.parts() or family.reduced"
    with pytest.raises(InputError, match=re.escape(told)):
        family.sweep()
    monkeypatch.setattr("linkwork.families.family._MOST_BYTES", 6 * 361 * 3 * 8)
    assert len(family.sweep(certify=False)) == 6


# ------------------------------------------------------------------ results


def test_shapes_and_codes(family: Family, motion: FamilyMotion) -> None:
    shape = (6, 361)
    for array in (
        motion.status,
        motion.found,
        motion.certification,
        motion.certified,
        motion.radius,
        motion["rocker"],
        motion["crank"],
        motion.trace("B"),
    ):
        assert array.shape == shape
    assert motion.found.dtype == motion.certified.dtype == bool
    np.testing.assert_array_equal(motion.found, motion.status == Status.CONVERGED.code)
    assert (motion.certified <= motion.found).all()
    np.testing.assert_array_equal(np.isnan(motion["rocker"]), ~motion.found)
    np.testing.assert_array_equal(np.isfinite(motion.radius), motion.certified)
    assert len(motion) == 6
    assert motion.counts[Status.CONVERGED] == motion.found.sum()
    assert "6 designs × 361 inputs" in repr(motion)
    assert "6 designs with varied O2 A" in repr(family)
    assert motion.message(0) == ""
    assert "dead point" in motion.message(2)  # too long to turn around: what a sweep of it says
    assert "must be a finite number, got nan" in motion.message(4)
    np.testing.assert_array_equal(motion.dimensions["O2 A"], CRANKS)


def test_names_are_spelled_as_users_do_and_unknown_ones_are_told(motion: FamilyMotion) -> None:
    turning = lw.loops(
        loops={"1": "r*e^(i*theta) = x + i*y"},
        dimensions={"r": 2.0},
        guess={"theta": 30, "x": 1.0, "y": 1.0},
        inputs=lw.Input(variable="theta", from_=0, to=90, step=30),
    )
    turned = turning.family({"r": [1.0, 2.0]}).sweep()
    np.testing.assert_array_equal(turned["θ"], [[0.0, 30.0, 60.0, 90.0]] * 2)
    with pytest.raises(UnknownNameError, match=re.escape('there is no "B.z"')):
        motion["B.z"]
    with pytest.raises(UnknownNameError, match=re.escape('there is no point "X"')):
        motion.trace("X")


def test_labelled_arrays_hold_the_same_with_units(motion: FamilyMotion) -> None:
    data = motion.to_xarray()
    assert dict(data.sizes) == {"design": 6, "crank": 361}
    for name in ("rocker", "coupler", "B.x"):
        np.testing.assert_array_equal(data[name].values, motion[name])
    assert data["rocker"].attrs["units"] == "deg"
    assert data["crank"].attrs["units"] == "deg"
    np.testing.assert_array_equal(data["O2 A"].values, CRANKS)
    np.testing.assert_array_equal(data["status"].values, motion.status)
    np.testing.assert_array_equal(data["certified"].values, motion.certified)
    assert f"{Status.OUT_OF_REACH.code} OUT_OF_REACH" in data["status"].attrs["meaning"]
    few = motion.to_xarray("B.y")
    limits = {"limit.lower", "limit.upper"}
    assert set(few.data_vars) == {"B.y", "status", "certified", "O2 A"} | limits
    np.testing.assert_array_equal(few["limit.upper"].values, motion.limits.upper)
    assert few["limit.upper"].attrs["units"] == "deg"


def test_outputs_and_angles_of_designs_follow_their_own_numbers() -> None:
    mechanism = lw.loops(
        loops={"1": "r*e^(i*t) = x + i*y"},
        dimensions={"r": 2.0},
        guess={"t": 30, "x": 1.0, "y": 1.0},
        inputs=lw.Input(variable="t", from_=0, to=360, step=30),
        outputs={"double": "2*r + x"},
    )
    radii = np.array([1.0, 2.0, 5.0])
    motion = mechanism.family({"r": radii}).sweep()
    angle = np.radians(np.arange(0, 361, 30))
    expected = radii[:, None] * (2 + np.cos(angle))
    np.testing.assert_allclose(motion["double"], expected, rtol=1e-12)


def test_designs_and_families_are_made_of_the_same() -> None:
    mechanism = lw.example("slider-crank")
    lengths = np.array([39.0, 40.0])
    name = next(iter(described_as(Linkage, mechanism).lengths))
    family, designs = mechanism.family({name: lengths}), designs_of(mechanism, {name: lengths})
    np.testing.assert_array_equal(family.designs.loops, designs.loops)
    with pytest.raises(UnknownNameError):
        mechanism.family({"no such": [1.0]})
