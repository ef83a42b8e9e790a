"""One program on one motion, as JSON: ``python -m benchmarks.motions CASE PROGRAM``."""

import json
import sys

from benchmarks.motions.cases import run

print(json.dumps(run(*sys.argv[1:])))
