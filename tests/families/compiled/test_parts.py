"""How designs are shared out among threads."""

from __future__ import annotations

import pytest

from linkwork.core.record.recorder import LANES
from linkwork.families.march.sweep_kernel import LEAST_LANES, MOST_DESIGNS, share_of_threads


@pytest.mark.parametrize("threads", [1, 2, 3, 16])
@pytest.mark.parametrize("count", [1, 63, 64, 65, 1000, 10_000, 1_000_003])
def test_every_design_is_in_one_part_of_whole_lanes(count: int, threads: int) -> None:
    parts = share_of_threads(count, threads)
    stops = [part.stop for part in parts]
    assert [part.start for part in parts] == [0, *stops[:-1]]
    assert stops[-1] == count
    sizes = [part.stop - part.start for part in parts]
    assert all(0 < size <= MOST_DESIGNS for size in sizes)
    assert all(size % LANES == 0 for size in sizes[:-1])
    if threads == 1:
        assert set(sizes[:-1]) <= {MOST_DESIGNS}


@pytest.mark.parametrize("threads", [2, 3, 16])
def test_the_last_parts_are_small_and_the_first_no_more_than_half_a_share(threads: int) -> None:
    count = 10_000
    sizes = [part.stop - part.start for part in share_of_threads(count, threads)]
    assert sizes[0] <= count / (2 * threads) + LANES
    assert sizes == sorted(sizes, reverse=True)
    assert sizes[-1] <= LEAST_LANES * LANES
    assert len(sizes) <= 10 * threads
