"""The loop equations derived from points and links, with the Jacobian.

expect: 2
"""

import linkwork as lw

leg = lw.example("rapier-drive-links")
sheet = leg.equations()
print(sheet.text())
print(len(sheet.equations.loops))
