"""The atlas of paths: shapes that keep only the form, and the nearest ones without exception."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

import linkwork as lw
from linkwork.core.commands.main import linkwork
from linkwork.core.foundation.arrays import Array, ComplexArray
from linkwork.core.textfile.reader import example_text
from linkwork.families.study import read_plan_text, run_study
from linkwork.synthesis.atlas import (
    SHIPPED,
    AtlasFamily,
    NearPath,
    PathAtlas,
    atlas_of_stores,
    coefficients,
    distances,
    in_ways,
    placed_on_curve,
)

_PLANS = Path(__file__).parents[3] / "examples" / "atlas"
_ANGLES = np.linspace(0.0, 2.0 * np.pi, 180, endpoint=False)


def _curve(seed: int) -> ComplexArray:
    rng = np.random.default_rng(seed)
    k = np.array([1, 2, 3, -1, -2, -3])
    c = rng.normal(size=(6, 2)) @ np.array([1.0, 1.0j]) / np.abs(k) ** 1.7
    return np.asarray(c @ np.exp(1j * np.outer(k, _ANGLES)))


def _least(shapes: ComplexArray, curve: ComplexArray) -> Array:
    wanted = in_ways(coefficients(curve[None])[0][0])
    return np.asarray(np.min([distances(shapes, own)[0] for own in wanted], axis=0))


def test_place_size_direction_sense_and_mirroring_leave_the_shape() -> None:
    z = _curve(3)
    (shape,), _, _ = coefficients(z[None])
    for other in (z * 3j + 5.0, z[::-1], z.conj(), (z[::-1] * (2.0 - 1j)).conj(), np.roll(z, 41)):
        # a shifted first point samples other points of the polygon
        assert _least(coefficients(other[None])[0], z)[0] < 2e-3
    assert _least(shape[None], _curve(4))[0] > 0.1


def test_the_nearest_paths_are_those_of_all_comparisons() -> None:
    families = tuple(
        replace(family, numbers=family.numbers[:900], shapes=family.shapes[:900])
        for family in PathAtlas.shipped().families
    )
    # more than are compared at first
    joined = replace(
        families[0],
        shapes=np.concatenate([family.shapes for family in families]),
        numbers=np.zeros((2700, 5)),
    )
    for seed in range(2):
        found = PathAtlas(families=(joined,)).nearest(_curve(seed), 40)
        every = np.concatenate([_least(f.shapes_of(np.arange(len(f))), _curve(seed))
                                for f in families])  # fmt: skip
        assert [near.distance for near in found] == pytest.approx(np.sort(every)[:40], abs=1e-12)


@pytest.mark.parametrize("place", [1, 2])
def test_a_path_of_the_atlas_is_found_again_and_drawn(place: int) -> None:
    family = PathAtlas.shipped().families[place]
    numbers = dict(zip(family.names, family.numbers[7].tolist(), strict=True))
    original = lw.loads(family.mechanism)
    path = original.family({k: np.array([v]) for k, v in numbers.items()}).sweep().trace("P")[0]
    wanted = np.roll(((2.0 - 1.0j) * path[:-1] + 300.0).conj(), 20)
    near = lw.synthesis.PathAtlas.shipped().nearest(wanted, 2)[0]
    assert near.is_mirrored
    assert near.numbers == numbers
    assert near.distance < 2e-3
    motion = near.mechanism.sweep()
    assert motion.certified.all()
    gaps = np.abs(motion.trace("P")[:, None] - wanted).min(axis=0)
    # the shape has eight harmonics and half precision
    assert gaps.max() < 0.02 * np.abs(wanted - wanted.mean()).max()


def test_offsets_of_sliders_are_placed_with_the_mechanism() -> None:
    text = (_PLANS / "slider-crank-path.toml").read_text()
    text = text.replace('line   = ["S", "T"]', 'line = ["S", "T"]\noffset = 15')
    assert "offset" in text
    original = lw.loads(text)
    path = original.sweep().trace("P")
    shape = coefficients(path[None, :-1])[0]
    family = AtlasFamily(
        title="offset",
        mechanism=text,
        point="P",
        names=(),
        numbers=np.zeros((1, 0), dtype=np.float32),
        shapes=np.ascontiguousarray(shape).view(float).astype(np.float16),
    )
    wanted = ((3.0 - 2.0j) * path[:-1] + 40.0).conj()
    near = PathAtlas(families=(family,)).nearest(wanted, 1)[0]
    assert near.is_mirrored
    placed, gap = placed_on_curve(near, "placed")
    assert gap < 1e-9 * np.abs(wanted).max()
    motion = lw.Mechanism(placed).sweep()
    assert np.abs(motion.trace("P")[:, None] - wanted).min(axis=0).max() < 1e-6


def test_mechanisms_with_other_parts_than_sliders_are_not_placed() -> None:
    family = AtlasFamily(
        title="gears",
        mechanism=example_text("elliptical-gears"),
        point="A",
        names=(),
        numbers=np.zeros((1, 0), dtype=np.float32),
        shapes=np.zeros((1, 32), dtype=np.float16),
    )
    circle = np.exp(1j * np.arange(9))
    near = NearPath(number=1, distance=0.0, designs=family, index=0, way=0, curve=circle)
    with pytest.raises(lw.InputError, match="of links and sliders only"):
        placed_on_curve(near, "placed")


def test_an_atlas_is_made_of_the_stores_of_studies(tmp_path: Path) -> None:
    plan = (_PLANS / "slider-crank.toml").read_text()
    few = plan.replace("1_000_000", "60")
    store, file = tmp_path / "few.zarr", tmp_path / "few.npz"
    run_study(read_plan_text(few, folder=_PLANS), store, workers=1)
    twice = [str(store), f"{store.parent / 'other' / '..' / store.name}/"]
    (tmp_path / "other").mkdir()
    done = CliRunner().invoke(linkwork, ["atlas", "--index", *twice, "-o", str(file)])
    assert done.exit_code == 0, done.output
    assert "paths of 1 store to" in " ".join(done.stdout.split())
    (made,), shipped = PathAtlas.load(file).families, PathAtlas.shipped().families[1]
    assert 40 < len(made) < 60
    assert made.mechanism == shipped.mechanism
    assert np.array_equal(made.numbers, shipped.numbers[: len(made)])
    assert made.shapes == pytest.approx(shipped.shapes[: len(made)], abs=1e-2)
    lost = tmp_path / "lost.zarr"
    run_study(read_plan_text(few.replace(', "P.y"', ""), folder=_PLANS), lost, workers=1)
    with pytest.raises(lw.InputError, match="keeps the paths of 0 points: an atlas needs one"):
        atlas_of_stores([lost])
    half = tmp_path / "half.zarr"
    run_study(read_plan_text(few.replace("360", "180"), folder=_PLANS), half, workers=1)
    with pytest.raises(lw.InputError, match="has no closed path"):
        atlas_of_stores([half])


def test_a_constant_of_a_plan_is_a_number_of_its_mechanisms(tmp_path: Path) -> None:
    plan = (_PLANS / "slider-crank.toml").read_text().replace("1_000_000", "60")
    plan = plan.replace('"A B"   = { from = 110, to = 400 }', '"A B" = 150')
    run_study(read_plan_text(plan, folder=_PLANS), tmp_path / "few.zarr", workers=1)
    (family,) = atlas_of_stores([tmp_path / "few.zarr"]).families
    numbers = dict(zip(family.names, family.numbers.T, strict=True))
    assert set(numbers) == {"A B", "A0.y", "A P", "B A P"}
    assert len(family) > 20
    assert set(numbers["A B"]) == {150}


def test_stores_that_are_unfinished_damaged_or_gone_are_named(tmp_path: Path) -> None:
    plan = (_PLANS / "slider-crank.toml").read_text()
    few = plan.replace("1_000_000", "60").replace("seed      = 1", "seed = 1\nchunk = 20")
    store, file = tmp_path / "few.zarr", tmp_path / "few.npz"
    run_study(read_plan_text(few, folder=_PLANS), store, workers=1)
    whole = len(atlas_of_stores([store]).families[0])
    (store / "ledger/chunks/c/1").unlink()
    told: list[float] = []
    made = atlas_of_stores([store], told.append)
    assert told == [0.5, 1.0]
    assert 20 < len(made.families[0]) < whole
    assert made.unfinished == (f'"{store}" has 40 of 60 designs: its study is unfinished',)
    done = CliRunner().invoke(linkwork, ["atlas", "--index", str(store), "-o", str(file)])
    assert "unfinished. Finish it and repeat this command" in " ".join(done.stdout.split())
    # the study is resumed, and the atlas is whole
    run_study(read_plan_text(few, folder=_PLANS), store, workers=1)
    again = atlas_of_stores([store])
    assert (len(again.families[0]), again.unfinished) == (whole, ())
    changed = next((store / "P.x").rglob("c/0/*"))
    changed.write_bytes(changed.read_bytes()[:-1])
    with pytest.raises(
        lw.InputError, match=r'damaged chunks of ".*few.zarr": 1; repeat the command of'
    ):
        atlas_of_stores([store])
    with pytest.raises(lw.InputError, match=r'there is no ".*gone.zarr"'):
        atlas_of_stores([tmp_path / "gone.zarr"])


def test_the_command_writes_mechanisms_placed_on_the_curve(tmp_path: Path) -> None:
    curve, folder = tmp_path / "curve.csv", tmp_path / "near"
    z = 50.0 * np.cos(_ANGLES) + 1j * (20.0 * np.sin(_ANGLES) + 8.0 * np.cos(2.0 * _ANGLES))
    curve.write_text("x,y\n" + "".join(f"{p.real},{p.imag}\n" for p in z))
    arguments = ["atlas", str(curve), "--count", "3", "-o", str(folder), "--json"]
    done = CliRunner().invoke(linkwork, arguments)
    assert done.exit_code == 0, done.output
    data = json.loads(done.stdout)
    assert data["paths"] == len(PathAtlas.shipped())
    assert [near["distance"] for near in data["nearest"]] == sorted(
        near["distance"] for near in data["nearest"]
    )
    for near in data["nearest"]:
        path = lw.load(near["file"]).sweep(certify=False).trace("P")
        assert np.abs(path[:, None] - z).min(axis=1).max() < 5.0
    again = CliRunner().invoke(linkwork, arguments)
    assert again.exit_code == 2
    assert 'it holds "near-1.toml"' in " ".join(again.stderr.split())
    fewer = [*arguments[:3], "2", *arguments[4:], "--force"]
    assert CliRunner().invoke(linkwork, fewer).exit_code == 0
    (folder / "notes.txt").write_text("mine")
    assert CliRunner().invoke(linkwork, fewer).exit_code == 0
    assert sorted(path.name for path in folder.glob("[!.]*")) == [
        "near-1.toml",
        "near-2.toml",
        "notes.txt",
    ]
    shown = CliRunner().invoke(linkwork, ["atlas", str(curve), "--count", "21"])
    assert "\n  20 " in shown.stdout
    assert "and 1 more" in shown.stdout


@pytest.mark.parametrize(
    ("more", "told"), [((), "it is a folder"), (("--count", "3"), "leave out --atlas, --count")]
)
def test_an_index_is_refused_before_stores_are_read(
    tmp_path: Path, more: tuple[str, ...], told: str
) -> None:
    done = CliRunner().invoke(
        linkwork, ["atlas", "--index", "gone.zarr", "-o", str(tmp_path), *more]
    )
    assert done.exit_code == 2
    assert told in " ".join(done.stderr.split())


def test_curves_and_files_that_are_none_are_refused(tmp_path: Path) -> None:
    atlas = lw.synthesis.PathAtlas.shipped()
    with pytest.raises(lw.InputError, match="needs 5 points or more"):
        atlas.nearest([(0, 0), (1, 0), (1, 1), (0, 1), (0, 0)])
    with pytest.raises(lw.InputError, match="the curve is one point"):
        atlas.nearest([(1, 1)] * 8)
    square: ComplexArray = np.array([0.0, 1.0, 2.0, 2.0 + 2.0j, 2.0j])
    for curve in (
        *([], "abc", range(9), np.zeros((4, 3)), np.ones((9, 2), dtype=complex), [(0, 0), (1,)]),
        *([("0", "0")] * 9, [None] * 9),
    ):
        with pytest.raises(lw.InputError, match=r"a curve is a list of points \(x, y\) or complex"):
            atlas.nearest(curve)  # type: ignore[arg-type]
    for count in (0, 2.5, "3", True):
        with pytest.raises(lw.InputError, match="count must be a whole number, 1 or more, got"):
            atlas.nearest(square, count)  # type: ignore[arg-type]
    for factor, told in ((1e200, "beyond"), (1e150, "beyond"), (1e-199, "in size, less than")):
        with pytest.raises(lw.InputError, match=f"the curve .* {told}"):
            atlas.nearest(factor * square)
    for factor in (4e11, 1e-11):
        assert atlas.nearest(factor * square, 1)[0].mechanism.sweep().found.all()
    broken = tmp_path / "broken.npz"
    broken.write_bytes(SHIPPED.read_bytes()[:1000])
    with pytest.raises(lw.InputError, match="is no atlas of paths"):
        lw.synthesis.PathAtlas.load(broken)
    with pytest.raises(lw.InputError, match="there is no atlas"):
        lw.synthesis.PathAtlas.load(tmp_path / "missing.npz")
    assert isinstance(PathAtlas.shipped().families[0], AtlasFamily)
    assert SHIPPED.stat().st_size < 5e6


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("1,2\n3,4\n", "has 2 points: a curve needs 5 to 2000"),
        ("0,0\n1e200,0\n1e200,1\n0,1\n0,0.5\n", "goes to 1e+200, beyond ±1e+12"),
        ("0,0\n1e-199,0\n1e-199,1e-199\n0,1e-199\n0,5e-200\n", "is 1e-199 in size, less than"),
    ],
)
def test_a_bad_curve_is_the_problem_of_its_file(text: str, told: str, tmp_path: Path) -> None:
    path = tmp_path / "c.csv"
    path.write_text(text)
    done = CliRunner().invoke(linkwork, ["atlas", str(path)])
    assert done.exit_code == 2
    shown = " ".join(done.stderr.split())
    assert shown.startswith("Error: ")
    assert told in shown
    assert "the task" not in shown
    with pytest.raises(lw.MechanismError, match=re.escape(told)) as found:
        lw.Task.loads(f'format = 1\ntask = "path"\n[curve]\nfile = "{path.as_posix()}"\n')
    assert found.value.problems[0].key == ("curve", "file")
