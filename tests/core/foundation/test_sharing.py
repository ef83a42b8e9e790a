"""Work shared out among threads."""

from __future__ import annotations

import threading

import pytest

from linkwork.core.foundation.loading import share_out


@pytest.mark.parametrize("threads", [1, 2, 5])
def test_everything_is_done_once(threads: int) -> None:
    done: list[int] = []
    share_out(done.append, range(100), threads)
    assert sorted(done) == list(range(100))


def test_who_asks_works_too_and_so_does_another_thread() -> None:
    both = threading.Barrier(2, timeout=20)
    who: set[int] = set()

    def meet(_: int) -> None:
        who.add(threading.get_ident())
        both.wait()  # one thread alone would wait for ever

    share_out(meet, range(2), 2)
    assert len(who) == 2
    assert threading.get_ident() in who


@pytest.mark.parametrize("threads", [1, 3])
def test_what_is_raised_ends_the_work(threads: int) -> None:
    begun: list[int] = []

    def work(item: int) -> None:
        begun.append(item)
        if item == 5:
            raise ValueError(item)

    with pytest.raises(ValueError, match="5"):
        share_out(work, range(10_000), threads)
    assert len(begun) < 10_000
