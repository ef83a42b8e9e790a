"""A crank that cannot turn fully: rows out of reach are kept with their status.

expect: 52
"""

import linkwork as lw

motion = lw.example("rapier-drive-limited").sweep()
print(motion)
print(motion.counts[lw.Status.OUT_OF_REACH])
