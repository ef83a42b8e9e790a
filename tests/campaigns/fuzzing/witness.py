"""The outcome of calls on random inputs: answered, refused with a message, or an error found."""

from __future__ import annotations

import re
import traceback
from collections import Counter
from collections.abc import Callable
from time import process_time
from typing import TypeVar

from linkwork.core.foundation.errors import LinkworkError

__all__ = ["LIMIT", "SHOWS_PROGRESS", "TooLongError", "Witness"]

LIMIT = 2.0  # seconds of processor time of one call
#: Seconds of calls that may take longer because they show progress.
SHOWS_PROGRESS = 30.0
#: What no message may contain: paths of the package, and Python's own words.
_INTERNAL = re.compile(
    r"src/linkwork/|site-packages|Traceback|RuntimeWarning|"
    r"\w+\(\) (got|takes|missing)|has no attribute|not subscriptable|dtype"
)

T = TypeVar("T")


class TooLongError(BaseException):
    """A call was stopped; no ``except Exception`` may catch this."""


class Witness:
    """Counts the outcomes of one input, and keeps what is false."""

    def __init__(self) -> None:
        self.counts: Counter[str] = Counter()
        self.false: list[str] = []

    def call(self, what: str, function: Callable[[], T], limit: float = LIMIT) -> T | None:
        """The answer of a call; ``None`` if it was refused or went wrong."""
        begin = process_time()
        answer = None
        try:
            answer = function()
            self.counts["calls answered"] += 1
        except LinkworkError as error:
            self.counts["calls refused with a message"] += 1
            self.judge_message(what, str(error))
        except TooLongError:
            self.counts["calls stopped"] += 1
        except Exception as error:
            name, kind = type(error).__name__, "foreign exceptions"
            self.counts["warnings" if name.endswith("Warning") else kind] += 1
            self.false.append(f"{what}: {name}: {str(error)[:200]} at {_place(error)}")
        spent = process_time() - begin
        if spent > LIMIT:
            shown = "" if limit == LIMIT else " that show progress"
            self.counts[f"calls over 2 s{shown}"] += 1
        if spent > limit:
            self.false.append(f"{what}: {spent:.1f} s")
        return answer

    def judge_message(self, what: str, message: str) -> None:
        found = _INTERNAL.search(message)
        if not message.strip() or found:
            self.counts["messages with internal words"] += 1
            self.false.append(f"{what}: message {found and found.group()!r}: {message[:300]!r}")


def _place(error: BaseException) -> str:
    frames = traceback.extract_tb(error.__traceback__)
    own = [f for f in frames if "/linkwork/" in f.filename]
    return " < ".join(
        f"{f.filename.rpartition('/linkwork/')[2]}:{f.lineno}" for f in reversed(own[-4:])
    )
