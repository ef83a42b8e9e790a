"""A four-bar linkage built in code; the velocity of the rocker at 25 rad/s.

expect: 3.04339609
"""

import linkwork as lw

four_bar = lw.linkage(
    points={"O2": (0, 0), "A": (35, 20), "B": (146, 66), "O4": (100, 0)},
    links={
        "ground": ["O2", "O4"],
        "crank": ["O2", "A"],
        "coupler": ["A", "B"],
        "rocker": ["O4", "B"],
    },
    lengths={"O2 A": 40, "A B": 120, "O4 B": 80},
    inputs=lw.Input(link="crank", speed="25 rad/s"),
)
print(f"{four_bar.solve(at=30).velocity['rocker']:.8f}")
