"""Run a study chunk by chunk into its store, with any number of workers."""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterable
from contextlib import closing
from dataclasses import dataclass, replace
from pathlib import Path
from time import monotonic

from linkwork.batch.study.cluster import cluster_crew
from linkwork.batch.study.job import Part
from linkwork.batch.study.plan_file import read_plan
from linkwork.batch.study.store import open_store
from linkwork.batch.study.store_packages import check_packages
from linkwork.batch.study.study import Study
from linkwork.batch.study.summary import Summary, summary_of
from linkwork.batch.study.workers import Task, local_crew, one_after_the_other
from linkwork.foundation.paths import as_path
from linkwork.foundation.plain_numbers import whole_number
from linkwork.foundation.sharing import cores
from linkwork.kernels.gpu.compiling import graphics_card

__all__ = ["Progress", "run_study"]


@dataclass(frozen=True, kw_only=True)
class Progress:
    """Progress of a run.

    Parameters
    ----------
    total : int
        Designs of the study.
    done : int
        Designs stored.
    before : int
        Designs stored before this run.
    seconds : float
        Time since the start of the run [s].
    """

    total: int
    done: int
    before: int
    seconds: float

    @property
    def rate(self) -> float:
        """Designs per second of this run."""
        return (self.done - self.before) / self.seconds if self.seconds > 0 else 0.0

    @property
    def left(self) -> float | None:
        """Remaining time at this rate [s], if known."""
        return (self.total - self.done) / self.rate if self.rate else None


def run_study(
    plan: Study | Path | str,
    store: Path | str,
    *,
    workers: int | None = None,
    scheduler: str | None = None,
    force: bool = False,
    progress: Callable[[Progress], None] | None = None,
) -> Summary:
    """Compute the designs of a plan into a Zarr store that ``xarray.open_zarr`` reads.

    Parameters
    ----------
    plan : Study or path
        A plan, or its file.
    store : path
        A folder, usually ``….zarr``. A store of the same study is resumed.
    workers : int, optional
        Processes on this machine; by default one per core, or one with a graphics card. With one,
        the calling process computes.
    scheduler : str, optional
        Address of a Dask scheduler, ``tcp://host:8786``, whose workers compute instead.
    force : bool
        Delete the study in the store and start over.
    progress : callable, optional
        Called with the progress at the beginning and after each chunk.

    Raises
    ------
    InputError
        If the plan is invalid, or the store belongs to another study (lists the differences).
    MissingPackageError
        If zarr or xarray, or dask.distributed for a cluster, is not installed.

    Notes
    -----
    The stored data depend on the plan only, not on the workers or their order. The store can be
    read at any moment; missing chunks read as missing values. Only this process writes to it: a
    chunk's files, each renamed when it is complete, then the ledger entry with their checksums.
    After a killed run, unfinished chunks are computed again, and so are damaged ones.
    """
    check_packages()
    if workers is not None:
        workers = whole_number("workers", workers, least=1)
    study = plan if isinstance(plan, Study) else read_plan(plan)
    if study.job.device == "gpu" and scheduler is None:
        graphics_card()  # raises an error before a store is created
    with open_store(study, as_path(store), force=force) as target:
        tell = _teller(study, target.done, progress)
        tell()
        left = [k for k in range(study.chunks) if k not in target.done]
        tasks = ((k, study.values(k)) for k in left)
        if left:
            # closing ends the workers also when the store fails
            with closing(_crew(study, tasks, len(left), workers, scheduler)) as parts:
                for k, part in parts:
                    target.write(k, part)
                    tell()
        repaired: tuple[int | str, ...] = (*target.repaired, *target.damaged)
    return replace(summary_of(store), repaired=repaired)


def _crew(
    study: Study,
    tasks: Iterable[Task],
    chunks: int,
    workers: int | None,
    scheduler: str | None,
) -> Generator[tuple[int, Part]]:
    """The parts of all tasks, from the selected kind of workers."""
    if workers is None:
        workers = 1 if study.job.device == "gpu" else cores()
    # more processes than chunks would only load Linkwork
    count = min(workers, chunks)
    if scheduler is not None:
        yield from cluster_crew(study.job, tasks, scheduler)
    elif count == 1:
        yield from one_after_the_other(study.job, tasks)
    else:
        yield from local_crew(study.job, tasks, count)


def _teller(
    study: Study, done: set[int], progress: Callable[[Progress], None] | None
) -> Callable[[], None]:
    """A function that reports the chunks in ``done`` to ``progress``."""
    began = monotonic()

    # designs of an earlier run do not count in the rate
    before = study.count_in(done)

    def tell() -> None:
        if progress is not None:
            progress(
                Progress(
                    total=study.plan.count,
                    done=study.count_in(done),
                    before=before,
                    seconds=monotonic() - began,
                )
            )

    return tell
