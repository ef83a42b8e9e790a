"""Numbers of solutions of general members of families, counted without solving anything."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest

import linkwork as lw
from linkwork.circuits.homotopy import counts as module
from linkwork.circuits.homotopy.counts import bound_by_sums, laman_number
from linkwork.circuits.homotopy.isolated_roots import Structure, isolated_roots, structure_of
from linkwork.core.equations.compiling import direction_form
from linkwork.core.numerics.bilinear import Columns, column_ranks, random_closures
from linkwork.core.table.loop_table import LoopTable
from tests.oracles.frameworks import MOST_REALISATIONS, bars_of, bars_of_number, cycle_columns
from tests.oracles.trusses import FIVE_LINKS, NINE_LINKS, SEVEN_LINKS, edges_of, truss
from tests.thinned import thinned


def columns_of_truss(graph: str) -> Columns:
    """The columns of a truss's closures."""
    (block,) = truss(graph, np.random.default_rng(0)).model.compiled.solver.blocks
    assert isinstance(block.system, LoopTable)
    form = direction_form(block.system)
    nothing = np.zeros((1, 0))
    return structure_of(form.system(form.closures(nothing, nothing)[0][0])).columns


@pytest.mark.parametrize(("vertices", "number", "count"), MOST_REALISATIONS)
def test_frameworks_have_their_published_laman_numbers(
    vertices: int, number: int, count: int
) -> None:
    bars = bars_of_number(vertices, number)
    assert len(bars) == 2 * vertices - 3
    assert laman_number(cycle_columns(vertices, bars)) == count


@pytest.mark.parametrize(
    ("vertices", "bars", "count"),
    [
        (3, [(0, 1), (1, 2), (0, 2)], 2),
        (4, [(0, 1), (1, 2), (0, 2), (1, 3), (2, 3)], 4),
        (6, [(a, b) for a in range(3) for b in range(3, 6)], 16),  # K(3,3)
        (4, list(combinations(range(4), 2))[:5], 4),
        (5, [*combinations(range(4), 2), (3, 4)], 0),  # a bar too many, one too few
    ],
)
def test_small_frameworks(vertices: int, bars: list[tuple[int, int]], count: int) -> None:
    assert laman_number(cycle_columns(vertices, bars)) == count


def test_a_pin_on_two_bars_doubles_the_number() -> None:
    rng = np.random.default_rng(3)
    bars, vertices = [(0, 1), (1, 2), (0, 2)], 3
    for count in (4, 8, 16, 32):
        a, b = rng.choice(vertices, 2, replace=False).tolist()
        bars += [(a, vertices), (b, vertices)]
        vertices += 1
        assert laman_number(cycle_columns(vertices, bars)) == count


@pytest.mark.parametrize(("graph", "count"), {**FIVE_LINKS, **SEVEN_LINKS, **NINE_LINKS}.items())
def test_trusses_have_the_numbers_of_the_literature(graph: str, count: int) -> None:
    assert laman_number(columns_of_truss(graph)) == count


@pytest.mark.parametrize(("graph", "count"), {**FIVE_LINKS, **SEVEN_LINKS}.items())
def test_bars_count_mirror_images_of_links_as_well(graph: str, count: int) -> None:
    links, pins = edges_of(graph)
    joints = [sum(link in pair for pair in pins) for link in range(links)]
    mirrors = 2 ** sum(n - 2 for n in joints)
    assert laman_number(cycle_columns(*bars_of(links, pins))) == count * mirrors


@pytest.mark.parametrize("loops", [2, 3, 4, 5])
def test_closures_without_zeros_reach_the_number_of_bezout(loops: int) -> None:
    free = tuple(tuple(int(i == j) for j in range(loops)) for i in range(loops))
    assert laman_number((free,) * (2 * loops + 1)) == {2: 6, 3: 20, 4: 70, 5: 252}[loops]


def test_a_link_that_no_loop_passes_leaves_no_isolated_solution() -> None:
    free, nothing = ((1, 0), (0, 1)), ((), ())
    assert laman_number((free, free, free, nothing, free)) == 0


def test_a_known_crank_is_a_part_of_the_ground() -> None:
    """Stephenson's six-bar driven outside its four-bar loop is the triad, 6; inside it, 4."""
    for name, counts in (("stephenson-far-crank", [6]), ("double-four-bar", [2, 2])):
        found = lw.example(name).configurations()
        assert [paths.bound // paths.solved for paths in found.paths] == counts


@pytest.mark.parametrize("seed", range(10))
def test_ranks_of_columns_are_those_of_random_closures(seed: int) -> None:
    rng = np.random.default_rng(seed)
    columns = random_columns(3, rng, [2] * 5)
    ranks = column_ranks(columns)
    drawn = random_closures(columns, rng)
    for s, rank in enumerate(ranks):
        chosen = [k for k in range(5) if s >> k & 1]
        assert rank == (np.linalg.matrix_rank(drawn[:, chosen]) if chosen else 0)


def random_columns(loops: int, rng: np.random.Generator, widths: list[int]) -> Columns:
    """Columns of zeros and sums with up to so many free coefficients each."""
    found = []
    for width in widths:
        wanted = int(rng.integers(1, width + 1))
        while True:
            column = rng.choice([0, 0, 1, -1], size=(loops, wanted))
            if np.linalg.matrix_rank(column) == wanted:
                break
        found.append(tuple(map(tuple, column.tolist())))
    return tuple(found)


def random_structure(seed: int) -> Structure:
    """Two or three loops, one to three lengths along the ground or a link."""
    rng = np.random.default_rng(seed)
    loops = int(rng.choice([2, 3]))
    sliding = int(rng.integers(1, 4))
    turning = 2 * loops - sliding
    products = [(k, k, 2 * loops, 2 * loops) for k in range(turning)]
    for z in range(turning, 2 * loops):
        a = int(rng.choice([2 * loops, *range(turning)]))
        products.append((z, a, a, z))
    widths = [*[2] * turning, *[1] * sliding, loops]
    while True:
        columns = random_columns(loops, rng, widths)
        if column_ranks(columns)[-1] == loops:
            return Structure(rows=tuple(zip(*products, strict=True)), columns=columns)


def lengths_of(structure: Structure) -> list[tuple[int, int]]:
    return [(z, a) for z, a, _, z1 in zip(*structure.rows, strict=True) if z == z1 and z != a]


@pytest.mark.parametrize("seed", thinned(range(40), 4))
def test_with_lengths_the_number_is_that_of_random_systems(seed: int) -> None:
    structure = random_structure(seed)
    system = structure.random(np.random.default_rng(1))
    bound = bound_by_sums(structure.rows, structure.columns)
    roots = isolated_roots(system, structure)
    assert roots.sure
    assert (0 if bound is None else bound.number) == len(roots.x)


@pytest.mark.parametrize("seed", range(8))
def test_the_exponents_of_the_limit_do_not_matter(
    seed: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    structure = random_structure(seed)
    counts = set()
    for other in (1, 2, 3):
        monkeypatch.setattr(module, "_SEED", other)
        counts.add(laman_number(structure.columns, lengths_of(structure)))
    assert len(counts) == 1


def test_no_number_where_it_takes_too_long_or_exponents_coincide(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    free = ((1, 0), (0, 1))
    columns, lengths = (free,) * 5, [(2, 4), (3, 0)]
    assert laman_number(columns, lengths) == 6
    monkeypatch.setattr(module, "_LARGEST", 2)  # all of them 1
    assert laman_number(columns, lengths) == 0
    monkeypatch.undo()
    monkeypatch.setattr(module, "_MOST_STEPS", 20)
    assert laman_number(columns, lengths) == 0
