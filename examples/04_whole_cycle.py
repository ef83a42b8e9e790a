"""The foot of the Jansen leg over the whole cycle: its step length.

expect: 67.908
"""

import linkwork as lw

motion = lw.example("jansen-leg").sweep()
print(motion)
foot = motion["F.x"]
print(f"{foot.max() - foot.min():.3f}")
