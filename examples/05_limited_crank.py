"""A crank that cannot turn fully: the rows that are out of reach are kept and say so.

expect: 52
"""

import linkwork as lw

motion = lw.example("rapier-drive-limited").sweep()
print(motion)
print(motion.counts[lw.Status.OUT_OF_REACH])
