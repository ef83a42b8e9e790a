"""``python -m benchmarks before-after TREE``: compare the speed of this tree with another checkout.

Two processes, one for each tree, run the same entry in turn, A B A B …; every pair gives a ratio
of processor times, ours over theirs. An entry is slower if the lower 95 % bound of its median
ratio exceeds 1.03.
"""

from __future__ import annotations

import argparse
import math
import os
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from itertools import cycle, product
from pathlib import Path

from benchmarks.single_thread import environment

__all__ = ["LIMIT", "interval_of_median", "main"]

LIMIT = 1.03
_LEAST = 0.03  # minimum duration of a measured run [s]: shorter entries are repeated
_HERE = Path(__file__).resolve().parents[1]

Run = Callable[[], object]


def interval_of_median(ratios: Sequence[float]) -> tuple[float, float]:
    """The 95 % interval of the median by order statistics, independent of the distribution."""
    n, ordered = len(ratios), sorted(ratios)
    tail, k = 0.0, 0
    while tail + math.comb(n, k) / 2.0**n <= 0.025:
        tail += math.comb(n, k) / 2.0**n
        k += 1
    return (ordered[k - 1], ordered[n - k]) if k else (-math.inf, math.inf)


# ---------------------------------------------------------------- in a process of each tree


def _entries(groups: Sequence[str]) -> Iterator[tuple[str, Callable[[], Run]]]:
    """Names and setup functions of entries, from the tree in ``PYTHONPATH``."""
    sources = {
        "cycle": _cycles,
        "configurations": _configurations,
        "families": _families,
        "peers": _peers,
    }
    for group in groups:
        for name, prepare in sources[group]():
            yield f"{group}: {name}", prepare


def _cycles() -> Iterator[tuple[str, Callable[[], Run]]]:
    import linkwork as lw
    from benchmarks.cycle_time import CYCLES

    for name, certify in product(CYCLES, (True, False)):
        mechanism = lw.example(name)
        text = name if certify else f"{name}, uncertified"
        yield text, lambda m=mechanism, c=certify: partial(m.sweep, certify=c)  # type: ignore[misc]


def _configurations() -> Iterator[tuple[str, Callable[[], Run]]]:
    import numpy as np

    from benchmarks import configuration_time

    for loops, pins, _ in configuration_time.TRUSSES:

        def prepare(pins: tuple[tuple[int, int], ...] = pins) -> Run:
            rng = np.random.default_rng(8)
            trusses = [configuration_time._truss(pins, rng) for _ in range(8)]
            solved = cycle(trusses)
            return lambda: next(solved).configurations()

        yield f"{loops} loops", prepare


def _families() -> Iterator[tuple[str, Callable[[], Run]]]:
    from benchmarks.family_time import rapier_family
    from benchmarks.peers.linkwork_sweep import family_of
    from benchmarks.peers.work import four_bar_family

    families = {
        "four-bars": family_of(four_bar_family(2_000, 200)),
        "rapier drives": rapier_family(2_000, 200),
    }
    for (name, family), certify, compiled in product(
        families.items(), (False, True), (False, True)
    ):
        text = f"{name}{', compiled' * compiled}{', certified' * certify}"
        run = partial(family.sweep, certify=certify, specialised=compiled, threads=1)
        yield text, lambda run=run: run  # type: ignore[misc]


def _peers() -> Iterator[tuple[str, Callable[[], Run]]]:
    from benchmarks.peers.registry import chosen
    from benchmarks.peers.work import works

    for work in works():
        for peer in chosen([]):
            if peer.distribution == "linkwork" and not peer.cannot(work):
                yield (
                    f"{work.name}, {peer.name}",
                    lambda p=peer, w=work: p.prepare(w).run,  # type: ignore[misc]
                )


def _serve(groups: Sequence[str]) -> None:
    """Write to standard output: the names, then the seconds of every requested run."""
    answer = os.fdopen(os.dup(1), "w", buffering=1)
    os.dup2(2, 1)
    entries = dict(_entries(groups))
    print("\t".join(entries), file=answer)
    runs: dict[str, tuple[Run, int]] = {}
    for line in sys.stdin:
        name = line.rstrip("\n")
        if name not in runs:
            run = entries[name]()
            run()
            runs[name] = run, max(1, math.ceil(_LEAST / max(_seconds(run, 1), 1e-9)))
        print(_seconds(*runs[name]), file=answer)


def _seconds(run: Run, times: int) -> float:
    begin = time.process_time()
    for _ in range(times):
        run()
    return (time.process_time() - begin) / times


# ---------------------------------------------------------------- in the process that compares


class _Tree:
    """A checkout and its measuring process."""

    def __init__(self, root: Path, groups: Sequence[str]) -> None:
        path = os.pathsep.join([str(root / "src"), str(root)])
        self.environment = {**environment(), "PYTHONPATH": path}
        self.process = subprocess.Popen(
            [sys.executable, __file__, "--serve", *groups],
            env=self.environment,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
            cwd=root,
        )
        self.names = self._read().split("\t")

    def _read(self) -> str:
        assert self.process.stdout is not None
        line = self.process.stdout.readline()
        if not line:
            raise SystemExit(f"the process of {self.environment['PYTHONPATH']} has ended")
        return line.rstrip("\n")

    def seconds(self, name: str) -> float:
        """Processor time of one run of an entry."""
        assert self.process.stdin is not None
        self.process.stdin.write(name + "\n")
        self.process.stdin.flush()
        return float(self._read())

    def cold(self, *arguments: str) -> float:
        """Processor time of a whole Python process."""
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        command = [sys.executable, *arguments]
        subprocess.run(command, env=self.environment, check=True, stdout=subprocess.DEVNULL)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime

    def __enter__(self) -> _Tree:
        return self

    def __exit__(self, *_: object) -> None:
        self.process.communicate()


def main(arguments: Sequence[str]) -> int:
    """Print a line for each entry; returns 1 if any is slower than before."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks before-after", description=__doc__)
    parser.add_argument("tree", type=Path, help="the other checkout")
    parser.add_argument(
        "group",
        nargs="*",
        default=["start", "cycle", "configurations", "families", "peers"],
        help="start, cycle, configurations, families, peers; default all",
    )
    parser.add_argument("--pairs", type=int, default=15)
    options = parser.parse_args(arguments)
    groups = [group for group in options.group if group != "start"]
    slower = 0
    with _Tree(_HERE, groups) as ours, _Tree(options.tree.resolve(), groups) as theirs:
        if "start" in options.group:
            with tempfile.TemporaryDirectory() as folder:
                slower += _starts(ours, theirs, Path(folder), options.pairs)
        for name in [name for name in ours.names if name and name in theirs.names]:
            pairs = [(ours.seconds(name), theirs.seconds(name)) for _ in range(options.pairs + 1)]
            slower += _told(name, pairs[1:])  # the first one warms up
    print(f"{slower} slower than {LIMIT:g} times")
    return int(slower > 0)


def _starts(ours: _Tree, theirs: _Tree, folder: Path, count: int) -> int:
    import linkwork as lw

    path = folder / "rapier.toml"
    path.write_text(lw.example_text("rapier-drive"), encoding="utf-8")
    entries = {"import": ("-c", "import linkwork"), "solve": ("-m", "linkwork", "solve", str(path))}
    slower = 0
    for name, arguments in entries.items():
        pairs = [(ours.cold(*arguments), theirs.cold(*arguments)) for _ in range(count + 1)]
        slower += _told(f"start: {name}", pairs[1:])
    return slower


def _told(name: str, pairs: Sequence[tuple[float, float]]) -> int:
    """Print the line of an entry; returns whether it is slower."""
    ratios = [a / b for a, b in pairs]
    low, high = interval_of_median(ratios)
    slower = low > LIMIT
    print(
        f"{name:<60}{statistics.median(ratios):7.3f}  ({low:.3f} … {high:.3f})"
        f"{'  SLOWER' if slower else ''}",
        flush=True,
    )
    return int(slower)


if __name__ == "__main__":
    if sys.argv[1:2] == ["--serve"]:
        _serve(sys.argv[2:])
    else:
        sys.exit(main(sys.argv[1:]))
