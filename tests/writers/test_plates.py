"""Plates: holes where the links have them, closed outlines and solids, free layers."""

from __future__ import annotations

import itertools
import random
import xml.etree.ElementTree as Tree
import zipfile
from dataclasses import replace
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest

import linkwork as lw
from linkwork.core.foundation.errors import InputError
from linkwork.core.mechanism.bodies import DiscFigure
from linkwork.core.motion.extremes import boxes_of, variables_of
from linkwork.writers.plates.construction import Construction
from linkwork.writers.plates.files import assembled, box, dxf_of, in_rows, plates_of
from linkwork.writers.plates.outlines import BodyPoses, Outline, circle, rounded
from linkwork.writers.plates.stack import Conflict, find_layers, obstacles, stack_of
from linkwork.writers.plates.wheels import Wheel, involute_outline, touches
from tests.library_mechanisms import read_example
from tests.writers.coarse import coarse
from tests.writers.plate_checks import hole_error, made, overlaps, simple, solid_error

_SUFFIXES = (".dxf", ".svg", ".stl", ".3mf")
_SOME = ("four-bar", "crank-shaper", "rapier-drive-links")


@pytest.mark.parametrize("name", _SOME)
def test_plates_keep_the_dimensions_and_do_not_touch(name: str) -> None:
    mechanism = read_example(name)
    stack, motion = made(mechanism)
    text = dxf_of(stack, assembled(stack))
    assert hole_error(mechanism, stack, text) <= 1e-9  # mm
    assert simple(stack)
    assert not overlaps(mechanism, stack, motion)
    assert stack.proved


def test_rows_without_a_position_are_counted(tmp_path: Path) -> None:
    mechanism = read_example("parallelogram")
    motion = mechanism.sweep(from_=0, to=360, step=30)
    lost = np.count_nonzero(~motion.found)
    stack = mechanism.write(tmp_path / "x.svg", motion=motion, kind="plates")
    assert 0 < lost < len(motion)
    assert f"{lost} of {len(motion)} rows of the table have no position: left out" in stack.notes


def test_plates_forced_into_one_layer_are_seen_to_touch() -> None:
    mechanism = read_example("four-bar")
    stack, motion = made(mechanism)
    stack = replace(stack, layer=dict(stack.layer) | {"coupler": 1})
    assert overlaps(mechanism, stack, motion) == ["crank and coupler", "coupler and rocker"]


@pytest.mark.extended
def test_solids_are_closed_and_have_the_volume_of_their_outlines() -> None:
    stack, _ = made(read_example("slider-crank"), kerf=0.2)
    # arcs are polygons of 256 sides a turn
    assert max(solid_error(stack, item) for item in assembled(stack)) <= 1e-3


def test_areas_are_those_of_circles_and_bars() -> None:
    assert circle(3 + 4j, 2.0).area == pytest.approx(np.pi * 4.0, rel=1e-15)
    bar = rounded([0j, 30 + 40j], 5.0)
    assert bar.area == pytest.approx(np.pi * 25.0 + 500.0, rel=1e-15)
    # Steiner: area + perimeter r + pi r²
    triangle = rounded([0j, 30 + 0j, 40j], 5.0)
    assert triangle.area == pytest.approx(600.0 + 120.0 * 5.0 + np.pi * 25.0, rel=1e-14)
    assert triangle.grown(1.0).area == pytest.approx(600.0 + 120.0 * 6.0 + np.pi * 36.0, rel=1e-14)
    square = Outline(corners=np.array([0, 2, 2 + 2j, 2j]), bulges=np.zeros(4))
    assert square.grown(1.0).area == pytest.approx(16.0, rel=1e-15)


def test_half_the_kerf_goes_outside_outlines_and_inside_holes() -> None:
    stack, _ = made(read_example("four-bar"))
    crank = next(plate for plate in stack.plates if plate.name == "crank")
    outline, hole, *_ = crank.cut(0.5)
    found = hole.as_circle
    assert found is not None
    assert found[1] == pytest.approx(stack.sizes.hole / 2.0 - 0.25, rel=1e-15)
    grown = rounded(crank.core[0], stack.sizes.width / 2.0 + 0.25)
    assert outline.area == pytest.approx(grown.area, rel=1e-14)


def test_boxes_hold_all_positions_between_the_rows() -> None:
    mechanism = read_example("crank-shaper")
    model, motion = mechanism.model, mechanism.sweep(step=4)
    boxes = boxes_of(model, motion, variables_of(model, motion))
    poses = BodyPoses(model, ["ground", "crank", "lever", "link", "ram"], 1.0)
    assert boxes.holds.all()
    fine = mechanism.sweep(step=0.5)
    wanted, spread, middle = (
        poses.of(variables_of(model, fine)),
        poses.spread(boxes),
        poses.of(boxes.v),
    )
    x, fine_x = motion["crank"], fine["crank"]
    for row in range(1, len(x) - 1):
        near = np.abs(fine_x - x[row]) <= 2.0
        for body, (origin, turn) in middle.items():
            moved, turned = spread[body]
            away = np.abs(wanted[body][0][near] - origin[row])
            bent = np.abs(np.angle(wanted[body][1][near] / turn[row]))
            assert away.max() <= moved[row] + 1e-9
            assert bent.max() <= turned[row] + 1e-12
            # bounds, but no more than a few times what moves
            assert moved[row] <= 4.0 * away.max() + 1e-6


def _clear(layers: tuple[int, ...], pins: list[frozenset[int]], conflicts: list[Conflict]) -> bool:
    """The conditions of layers, spelled out."""

    def span(part: int) -> tuple[int, int]:
        if part >= 0:
            return layers[part] - 1, layers[part] + 1
        own = [layers[k] for k in pins[-1 - part]]
        return min(own), max(own)

    def meet(a: int, b: int) -> bool:
        (low, high), (below, above) = span(a), span(b)
        return bool(set(range(low + 1, high)) & set(range(below + 1, above)))

    return not any(meet(a, b) for a, b in conflicts)


def test_the_search_finds_an_order_exactly_where_one_exists() -> None:
    chance = random.Random(5)
    seen = set()
    for _ in range(150):
        plates = chance.randint(2, 5)
        pins = [
            frozenset(chance.sample(range(plates), chance.randint(2, min(3, plates))))
            for _ in range(chance.randint(1, 3))
        ]
        parts = [*range(1, plates), *(-1 - k for k in range(len(pins)))]
        pairs = [
            (a, b) for a, b in itertools.combinations(parts, 2)
            if not (b < 0 <= a and a in pins[-1 - b])
        ]  # fmt: skip
        conflicts = [pair for pair in pairs if chance.random() < 0.7]
        top = plates - 1 if plates > 2 and chance.random() < 0.5 else None
        found = find_layers(plates, pins, conflicts, top=top)
        orders = itertools.product(range(1, plates), repeat=plates - 1)
        exists = any(
            _clear((0, *order), pins, conflicts)
            for order in orders
            if top is None or order[-1] > max(order[:-1])
        )
        assert (found.layers is not None) == exists
        assert found.complete
        seen.add(exists)
        if found.layers is not None:
            assert _clear(found.layers, pins, conflicts)
        elif top is None:
            for conflict in (needed := obstacles(plates, pins, conflicts)):
                fewer = [own for own in needed if own != conflict]
                assert find_layers(plates, pins, fewer).layers is not None
    assert seen == {True, False}


def test_a_bridge_holds_pins_that_cranks_would_run_into() -> None:
    mechanism = read_example("galloway")
    stack, motion = made(mechanism)
    assert stack.layer["ground bridge"] == stack.layers - 1
    spans = {pin.name: stack.span(pin) for pin in stack.pins}
    # one crank turns about a pin of the base, the other one about a pin of the bridge
    assert sorted([spans["O2"][0], spans["O4"][0]])[0] == 0
    assert max(spans["O2"][1], spans["O4"][1]) == stack.layers - 1
    assert sum(span == (0, stack.layers - 1) for span in spans.values()) == 4
    assert stack.proved
    assert not overlaps(mechanism, stack, motion)


def test_columns_that_are_hit_between_the_rows_move_outwards() -> None:
    mechanism = read_example("drag-link")
    motion = mechanism.sweep(from_=254.4, to=334.4, step=80)
    options = lw.writers.PlateOptions(gap=0.0, width=20.0)
    stack = stack_of(mechanism.model, motion, options)
    assert sum(pin.name.startswith("column") for pin in stack.pins) == 4
    assert stack.proved


def test_a_search_with_bridges_is_given_up_after_a_number_of_assignments(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("linkwork.writers.plates.stack._MOST_WITH_BRIDGES", 1)
    with pytest.raises(InputError, match=r"no order of layers was found .* search was given up"):
        made.__wrapped__(read_example("drag-link"))


def test_an_order_that_does_not_exist_is_refused_with_the_parts_in_the_way() -> None:
    with pytest.raises(InputError, match=r"no order .* pin O4 and crank.* crank and driven"):
        made(read_example("drag-link"))


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("rapier-drive", "given by equations: plates need points and links"),
        ("curved-slot", r'"slot" \(curve\) cannot be made of plates'),
        ("excavator", r'"boom_ram" \(cylinder\) cannot be made of plates'),
        ("klann-leg", '"stride" cannot be converted to millimetres'),
        ("scott-russell", r"the openings O and s of plate \"ground\" overlap"),
    ],
)
def test_what_cannot_be_made_is_refused_by_name(name: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        made(read_example(name))


@pytest.mark.parametrize(
    ("sizes", "message"),
    [
        ({"width": 3.0, "pin": 4.0}, "holes of 4.1 mm do not fit into bars of 3 mm"),
        ({"kerf": -0.1}, "kerf must be zero or more, got -0.1"),
        ({"pin": 0.0}, "pin must be positive, got 0"),
        ({"kerf": 40.0}, "a kerf of 40 mm leaves nothing of holes"),
        ({"sheet": 20.0}, "a sheet of 20 mm is too narrow: the widest plate needs"),
    ],
)
def test_sizes_that_do_not_fit_are_refused(sizes: dict[str, float], message: str) -> None:
    with pytest.raises(InputError, match=message):
        in_rows(made(read_example("four-bar"), **sizes)[0])


def test_a_slot_is_as_long_as_the_stroke_and_the_guide_need() -> None:
    mechanism = read_example("slider-crank")
    stack, motion = made(mechanism)
    base = stack.plates[0]
    slot = next(own.outline for own in base.openings if own.name == "d")
    low, high = box([slot])
    stroke = float(np.ptp(motion["d"]))
    sizes = stack.sizes
    wanted = stroke + 2.0 * sizes.width + 2.0 * sizes.play + sizes.hole
    assert (high - low).real == pytest.approx(wanted, rel=1e-9)


def test_sheets_do_not_overlap() -> None:
    stack, _ = made(read_example("jansen-leg"), kerf=0.3)
    boxes = [box(item.curves) for item in in_rows(stack)]
    for (low, high), (below, above) in itertools.combinations(boxes, 2):
        apart = (
            low.real > above.real or high.real < below.real
            or low.imag > above.imag or high.imag < below.imag
        )  # fmt: skip
        assert apart


def test_the_same_plates_are_the_same_bytes(tmp_path: Path) -> None:
    mechanism = read_example("double-pendulum")
    # the second one is not taken from the cache
    stack, again = (f(mechanism)[0] for f in (made, made.__wrapped__))
    for suffix in _SUFFIXES:
        file = tmp_path / f"plates{suffix}"
        once = plates_of(stack, file)
        assert once == plates_of(again, file)
        assert once != plates_of(stack, file, layout=True)


def test_each_assembled_plate_is_a_closed_solid_of_its_file(tmp_path: Path) -> None:
    mechanism = coarse(read_example("four-bar"), 36)
    trimesh = import_module("trimesh")
    stack, _ = made(mechanism)
    wanted = {p.name: stack.sizes.thickness * p.plate.area for p in assembled(stack)}
    for suffix in (".stl", ".3mf"):
        mechanism.write(tmp_path / f"plates{suffix}", kind="plates")
        solids = trimesh.load_scene(tmp_path / f"plates{suffix}").geometry
        assert len(solids) == 4, suffix
        assert all(solid.is_volume for solid in solids.values()), suffix
        # arcs are inscribed polygons
        volumes = sorted(solid.volume for solid in solids.values())
        assert volumes == pytest.approx(sorted(wanted.values()), rel=1e-3), suffix
        assert {name.rpartition("/")[2] for name in solids} == set(wanted), suffix


def test_files_are_read_by_other_programs(tmp_path: Path) -> None:
    mechanism = coarse(read_example("four-bar"), 36)
    options = lw.writers.PlateOptions(labels=True)
    for suffix in _SUFFIXES:
        mechanism.write(tmp_path / f"plates{suffix}", layout=True, options=options, kind="plates")
    trimesh = import_module("trimesh")
    solids = trimesh.load(tmp_path / "plates.stl").split()
    assert len(solids) == 4
    assert all(solid.is_watertight for solid in solids)
    stack, _ = made(mechanism)
    wanted = sorted(stack.sizes.thickness * plate.area for plate in stack.plates)
    assert sorted(solid.volume for solid in solids) == pytest.approx(wanted, rel=1e-3)
    model = zipfile.ZipFile(tmp_path / "plates.3mf").read("3D/3dmodel.model")
    names = {own.get("name") for own in Tree.fromstring(model).iter() if own.tag.endswith("object")}
    assert names == {"0 ground", "1 crank", "2 coupler", "1 rocker"}
    document = import_module("ezdxf").readfile(tmp_path / "plates.dxf")
    assert not document.audit().errors
    assert document.header["$INSUNITS"] == 4
    texts = {text.dxf.text for text in document.modelspace().query("TEXT")}
    assert texts == {"ground", "crank", "coupler", "rocker"}
    root = Tree.parse(tmp_path / "plates.svg").getroot()
    low, width = root.attrib["viewBox"].split()[0::2]
    assert root.attrib["width"] == f"{width}mm"
    assert float(low) < float(width)


def test_a_suffix_without_a_format_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"the suffix of plates is one of \.dxf, \.svg, \.stl"):
        read_example("four-bar").write(tmp_path / "plates.obj", kind="plates")


@pytest.mark.parametrize(
    "name",
    [
        "geared-five-bar",
        *(
            pytest.param(name, marks=pytest.mark.extended)
            for name in ("planetary-gear", "sun-and-planet", "rack-and-pinion", "rack-steering")
        ),
    ],
)
def test_gears_mesh_without_touching_in_all_positions(name: str) -> None:
    mechanism = read_example(name)
    stack, motion = made(mechanism)
    assert simple(stack)
    assert stack.proved
    # teeth in mesh are in one layer, and their outlines apart
    assert not overlaps(mechanism, stack, motion)
    assert max(solid_error(stack, item) for item in assembled(stack)) <= 1e-3


def _wheel(teeth: int, *, ring: bool = False, backlash: float = 0.1) -> Wheel:
    disc = DiscFigure(
        name="m", link="w", center="c", radius=float(teeth), kind="gear", ring=ring, teeth=teeth
    )
    pressure = np.radians(20.0)
    return Wheel(disc=disc, module=2.0, phase=0.0, pressure=pressure, backlash=backlash)


def test_flanks_are_involutes_and_teeth_as_thick_as_their_backlash_leaves() -> None:
    outline = involute_outline(_wheel(40), 0j)
    count = len(outline.corners) // 40
    flank = outline.corners[count // 2 : count]
    middle, step = (flank[1:] + flank[:-1]) / 2.0, np.diff(flank)
    # normals of an involute are tangents of its base circle
    base = np.abs((middle * step.conj()).real / np.abs(step))[:-2]  # the rest is straight
    assert base == pytest.approx(40.0 * np.cos(np.radians(20.0)), rel=2e-4)
    at = np.interp(40.0, np.abs(flank[::-1]), np.angle(flank[::-1]))
    # half of the backlash is taken from each gear of a pair
    # chords of sixteen points are a micrometre inside of the flank
    assert 2.0 * 40.0 * at == pytest.approx(np.pi - 0.05, abs=2e-3)


@pytest.mark.parametrize(
    ("first", "second", "apart", "touching"),
    [
        (_wheel(20), _wheel(40), 60.0, False),
        (_wheel(20), _wheel(40), 59.8, True),  # too near
        (_wheel(20, backlash=0.0), _wheel(40, backlash=0.0), 60.0, True),
        (_wheel(8), _wheel(60), 68.0, True),  # undercut would be needed
        pytest.param(_wheel(20), _wheel(80, ring=True), 60.0, False, marks=pytest.mark.extended),
        (_wheel(30, ring=True), _wheel(27), 3.0, True),  # the tips meet
    ],
)
def test_teeth_that_touch_are_seen(
    first: Wheel, second: Wheel, apart: float, touching: bool
) -> None:
    assert touches(first, second, apart) == touching


def test_gears_without_whole_numbers_are_refused() -> None:
    mechanism = read_example("geared-five-bar").changed(
        gears=[
            lw.Gear(
                name="mesh", wheels=("left", "right"), centers=("O", "P"),
                radii=("110*sqrt(2)/(1 + sqrt(2))", "110/(1 + sqrt(2))"),
            )
        ]
    )  # fmt: skip
    with pytest.raises(InputError, match="have no ratio of whole numbers: give their teeth"):
        made(mechanism)


@pytest.mark.extended
def test_a_cam_touches_its_roller_and_nothing_else() -> None:
    mechanism = read_example("cam-swinging-follower")
    stack, motion = made(mechanism)
    assert stack.contacts == (("cam", "swing roller"),)
    assert stack.verdict.startswith("no two parts touch but cam and swing roller: proved")
    assert stack.layer["cam"] == stack.layer["swing roller"]
    assert not overlaps(mechanism, stack, motion)
    assert simple(stack)


@pytest.mark.extended
@pytest.mark.skipif(find_spec("build123d") is None, reason="build123d is not installed")
def test_step_keeps_arcs(tmp_path: Path) -> None:
    stack, _ = made(read_example("crank-shaper"))
    content = plates_of(stack, tmp_path / "a.step")
    assert content == plates_of(stack, tmp_path / "a.step")
    assert content.count(b"CYLINDRICAL_SURFACE") >= 2 * len(stack.plates)


def test_holes_of_welded_links_are_in_one_plate() -> None:
    mechanism = read_example("boxer-engine")
    motion = mechanism.sweep()
    made_of = Construction.of(mechanism.model, motion, lw.writers.PlateOptions(), 1.0)
    throw = next(plate for plate in made_of.plates if plate.name == "throw1")
    assert {own.name for own in throw.openings} >= {"O", "A1", "A2"}
    assert "throw2" not in {plate.name for plate in made_of.plates}
