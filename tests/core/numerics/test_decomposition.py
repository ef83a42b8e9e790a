"""The block form against brute force over all subsets of small patterns."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations

import numpy as np
import pytest

from linkwork.core.numerics.decomposition import BlockForm, block_form

Pattern = list[list[int]]


def random_pattern(seed: int) -> tuple[Pattern, list[int], int]:
    """Up to five equations of one or two rows over up to seven unknowns."""
    rng = np.random.default_rng(seed)
    unknowns = int(rng.integers(1, 8))
    equations = int(rng.integers(1, 6))
    pattern = [
        sorted(int(k) for k in rng.permutation(unknowns)[: rng.integers(0, 4)])
        for _ in range(equations)
    ]
    return pattern, [int(c) for c in rng.integers(1, 3, equations)], unknowns


def square_pattern(seed: int) -> tuple[Pattern, list[int], int]:
    """A pattern with a full matching: a hidden assignment plus random further entries."""
    rng = np.random.default_rng(seed)
    count = [int(c) for c in rng.integers(1, 3, rng.integers(1, 7))]
    unknowns = sum(count)
    order = iter(int(k) for k in rng.permutation(unknowns))
    pattern = []
    for rows in count:
        own = {next(order) for _ in range(rows)}
        own |= {int(k) for k in rng.permutation(unknowns)[: rng.integers(0, 3)]}
        pattern.append(sorted(own))
    return pattern, count, unknowns


def rows_of(pattern: Pattern, count: Sequence[int]) -> list[list[int]]:
    return [used for used, rows in zip(pattern, count, strict=True) for _ in range(rows)]


def matched(rows: Sequence[Sequence[int]], without: int | None = None) -> int:
    """Size of a largest matching of rows to unknowns, by Hall's theorem over all row subsets."""
    worst = 0
    for size in range(1, len(rows) + 1):
        for chosen in combinations(rows, size):
            reached = {k for used in chosen for k in used} - {without}
            worst = max(worst, size - len(reached))
    return len(rows) - worst


def test_random_square_patterns_split_into_irreducible_blocks_in_solving_order() -> None:
    sizes = set()
    for seed in range(1500):
        pattern, count, unknowns = square_pattern(seed)
        form = block_form(pattern, count, unknowns)
        assert form.square, seed
        check_blocks(form, pattern, count, unknowns, seed)
        sizes |= {len(equations) for equations, _ in form.blocks}
    assert sizes >= {1, 2, 3, 4}  # the examples are not all trivial


def check_blocks(
    form: BlockForm, pattern: Pattern, count: list[int], unknowns: int, seed: int
) -> None:
    assert sorted(e for block, _ in form.blocks for e in block) == list(range(len(pattern))), seed
    assert sorted(k for _, block in form.blocks for k in block) == list(range(unknowns)), seed
    solved: set[int] = set()
    for equations, own in form.blocks:
        used = {k for e in equations for k in pattern[e]}
        assert used <= solved | set(own), seed
        assert sum(count[e] for e in equations) == len(own), seed
        for size in range(1, len(equations)):
            for part in combinations(equations, size):
                inside = {k for e in part for k in pattern[e]} & set(own)
                assert len(inside) > sum(count[e] for e in part), seed
        solved |= set(own)


def test_random_patterns_report_what_is_over_and_under_determined() -> None:
    kinds = set()
    for seed in range(1500):
        pattern, count, unknowns = random_pattern(seed)
        form = block_form(pattern, count, unknowns)
        rows = rows_of(pattern, count)
        owner = [e for e, k in enumerate(count) for _ in range(k)]
        best = matched(rows)
        assert form.surplus == len(rows) - best, seed
        assert form.missing == unknowns - best, seed
        assert form.square == (len(rows) == best == unknowns), seed
        # a row lies in the overdetermined part if some largest matching can do without it
        spare = [k for k in range(len(rows)) if matched(rows[:k] + rows[k + 1 :]) == best]
        assert set(form.overdetermined) == {owner[k] for k in spare}, seed
        assert set(form.conflict_unknowns) == {j for k in spare for j in rows[k]}, seed
        loose = {k for k in range(unknowns) if matched(rows, without=k) == best}
        assert set(form.underdetermined) == loose, seed
        kinds.add((bool(form.surplus), bool(form.missing)))
    assert len(kinds) == 4  # square, over-, underdetermined and both at once


@pytest.mark.parametrize("seed", [0, 1])
def test_a_shuffled_chain_of_a_thousand_loops_is_solved_one_by_one(seed: int) -> None:
    rng = np.random.default_rng(seed)
    place = [int(k) for k in rng.permutation(1000)]  # equation number of the k-th loop
    name = [int(k) for k in rng.permutation(2000)]  # unknown number
    pattern: Pattern = [[] for _ in range(1000)]
    for k in range(1000):
        own = [name[2 * k], name[2 * k + 1]]
        pattern[place[k]] = own + ([name[2 * k - 1]] if k else [])
    form = block_form(pattern, [2] * 1000, 2000)
    assert form.square
    assert [equations for equations, _ in form.blocks] == [(place[k],) for k in range(1000)]
    wanted = [tuple(sorted((name[2 * k], name[2 * k + 1]))) for k in range(1000)]
    assert [unknowns for _, unknowns in form.blocks] == wanted


def test_a_ring_of_a_thousand_loops_is_one_block() -> None:
    pattern = [[2 * k, 2 * k + 1, (2 * k + 3) % 2000] for k in range(1000)]
    form = block_form(pattern, [2] * 1000, 2000)
    assert form.square
    assert form.blocks == ((tuple(range(1000)), tuple(range(2000))),)


def test_no_equations_and_no_unknowns_are_square() -> None:
    assert block_form([], [], 0) == BlockForm(blocks=())
