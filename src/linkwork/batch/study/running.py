"""Run a study chunk by chunk into its store, with any number of workers."""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterable
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from time import monotonic

from linkwork.batch.study.cluster import cluster_crew
from linkwork.batch.study.job import Part
from linkwork.batch.study.plan_file import read_plan
from linkwork.batch.study.store import open_store
from linkwork.batch.study.study import Study
from linkwork.batch.study.summary import Summary, summary_of
from linkwork.batch.study.workers import Task, local_crew, one_after_the_other
from linkwork.batch.study.zarr_files import check_packages
from linkwork.foundation.plain_numbers import whole_number
from linkwork.foundation.sharing import cores
from linkwork.kernels.gpu.compiling import graphics_card

__all__ = ["Progress", "run_study"]


@dataclass(frozen=True, kw_only=True)
class Progress:
    """How far a run is.

    Parameters
    ----------
    total : int
        Designs of the study.
    done : int
        Designs that are stored.
    before : int
        Those of them that were stored before this run began.
    seconds : float
        Since it began.
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
        """Seconds that are left at this rate, if it is known."""
        return (self.total - self.done) / self.rate if self.rate else None


def run_study(
    plan: Study | Path | str,
    store: Path | str,
    *,
    workers: int | None = None,
    scheduler: str | None = None,
    fresh: bool = False,
    progress: Callable[[Progress], None] | None = None,
) -> Summary:
    """Compute the designs of a plan into a Zarr store that ``xarray.open_zarr`` reads.

    Parameters
    ----------
    plan : Study or path
        A plan that was read, or its file.
    store : path
        A folder, by custom ``….zarr``. One that holds a part of the same study is gone on with.
    workers : int, optional
        Processes on this machine; all of its cores unless given, one for a graphics card. With
        one there are no others.
    scheduler : str, optional
        Address of a Dask scheduler, ``tcp://host:8786``, whose workers compute instead.
    fresh : bool
        Take away the study that is in the store, and begin again.
    progress : callable, optional
        Told how far the run is, at its beginning and after each chunk.

    Raises
    ------
    InputError
        For a plan that cannot be understood, or a store of another study: with what differs.
    MissingPackageError
        Without zarr and xarray, or dask.distributed for a cluster.

    Notes
    -----
    What is stored depends on the plan alone, not on who computed it in which order. The store can
    be read at any moment; chunks that are not there yet read as missing. Only this process
    writes to it: a chunk's files, each renamed when it is whole, then its entry in the ledger with
    their checksums. A run that was killed computes the chunk again that it was writing.
    """
    check_packages()
    if workers is not None:
        workers = whole_number("workers", workers, least=1)
    study = plan if isinstance(plan, Study) else read_plan(plan)
    if study.job.device == "gpu" and scheduler is None:
        graphics_card()  # or the reason why there is none, before a store is begun
    with open_store(study, Path(store), fresh=fresh) as target:
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
    return summary_of(store)


def _crew(
    study: Study,
    tasks: Iterable[Task],
    chunks: int,
    workers: int | None,
    scheduler: str | None,
) -> Generator[tuple[int, Part]]:
    """The parts of all tasks by whoever is to compute them."""
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
    """Tells ``progress`` how far the chunks in ``done`` have got."""
    began = monotonic()

    def designs() -> int:
        return sum(len(study.designs_of(k)) for k in done)

    # designs of an earlier run do not count in the rate
    before = designs()

    def tell() -> None:
        if progress is not None:
            progress(
                Progress(
                    total=study.plan.count,
                    done=designs(),
                    before=before,
                    seconds=monotonic() - began,
                )
            )

    return tell
