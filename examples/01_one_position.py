"""One position of a mechanism given by its loop equations, from a guess.

expect: 216.940343
"""

import linkwork as lw

rapier = lw.example("rapier-drive")
position = rapier.solve(at=60)
print(position)
print(f"{position['s16']:.6f}")
