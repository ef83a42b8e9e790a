"""A worker process: reads parts of a study from its input, writes results to its output.

It ends when whoever started it is gone, so that a run that was killed leaves no process behind.
"""

from __future__ import annotations

import os
import pickle
import sys

from linkwork.batch.study.job import Job, Part, compute_part
from linkwork.foundation.errors import LinkworkError

__all__ = ["Answer", "serve"]

#: A part, or why there is none.
Answer = Part | str


def serve() -> None:
    """Read jobs with values and answer each with its part, until the input ends."""
    requests = sys.stdin.buffer
    answers = os.fdopen(os.dup(sys.stdout.fileno()), "wb")
    os.dup2(sys.stderr.fileno(), sys.stdout.fileno())  # whatever prints must not answer
    try:
        while True:
            pickle.dump(_answer(*pickle.load(requests)), answers, pickle.HIGHEST_PROTOCOL)
            answers.flush()
    except (EOFError, BrokenPipeError, pickle.UnpicklingError):
        os._exit(0)  # nobody is there to be told anything else


def _answer(job: Job, values: dict[str, object]) -> Answer:
    try:
        return compute_part(job, values)  # type: ignore[arg-type]  # as they were sent
    except LinkworkError as error:
        return str(error)


if __name__ == "__main__":
    serve()
