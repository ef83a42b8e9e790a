"""One march along a path of inputs for many mechanisms: programs, loops over lanes, results.

The two loops over lanes are compiled when each is first used.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from linkwork.core.foundation.loading import loader

if TYPE_CHECKING:
    from linkwork.families.march.independent import march as march
    from linkwork.families.march.lockstep import in_step as in_step
else:
    __getattr__ = loader(__name__)
