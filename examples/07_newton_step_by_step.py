"""The iterates of Newton-Raphson from the textbook's guess: |F| decreases quadratically.

expect: 1.41e-07
"""

import linkwork as lw

position = lw.example("rapier-drive").solve(at=60, from_guess=True, with_steps=True)
for step in position.steps[0].steps:
    print(step.k, f"{step.residual:.2e}")
print(f"{position.steps[0].steps[4].residual:.2e}")
