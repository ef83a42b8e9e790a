"""Settings of the whole test run: Hypothesis profiles and a picture backend without a screen."""

from __future__ import annotations

import os

from hypothesis import settings

# No profile has a deadline: the first example of a test pays for imports, and the
# workers of a parallel run share their cores.
settings.register_profile("ci", derandomize=True, deadline=None, print_blob=True)
settings.register_profile("dev", deadline=None)
settings.load_profile("ci" if os.environ.get("CI") else "dev")

os.environ.setdefault("MPLBACKEND", "Agg")  # inherited by the commands that tests start
