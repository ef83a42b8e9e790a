"""A worker process: reads parts of a study from its input, writes results to its output.

It ends with the process that started it, so a killed run leaves no processes.
"""

from __future__ import annotations

import os
import pickle
import sys

from linkwork.core.foundation.errors import LinkworkError
from linkwork.families.study.study import Job, Part, compute_part

__all__ = ["Answer", "serve"]

#: A part, or the reason why there is none.
Answer = Part | str


def serve() -> None:
    """Read jobs with values and return the part of each, until the input ends."""
    requests = sys.stdin.buffer
    answers = os.fdopen(os.dup(sys.stdout.fileno()), "wb")
    os.dup2(sys.stderr.fileno(), sys.stdout.fileno())  # printed text must not enter the results
    try:
        while True:
            pickle.dump(_answer(*pickle.load(requests)), answers, pickle.HIGHEST_PROTOCOL)
            answers.flush()
    except (EOFError, BrokenPipeError, pickle.UnpicklingError):
        os._exit(0)  # the main process has ended


def _answer(job: Job, values: dict[str, object]) -> Answer:
    try:
        return compute_part(job, values)  # type: ignore[arg-type]  # types as sent
    except LinkworkError as error:
        return str(error)


if __name__ == "__main__":
    serve()
