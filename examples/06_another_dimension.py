"""A changed dimension gives a new mechanism; here the stroke of an offset slider-crank.

expect: 95.408944
"""

import linkwork as lw

for crank in (20, 30, 40):
    motion = lw.example("crank-slider").with_dimensions(a=crank, c=-60).sweep(step=0.1)
    stroke = motion["d"].max() - motion["d"].min()
    print(f"crank {crank} mm: stroke {stroke:.6f} mm")
# the stroke's closed form is sqrt((b + a)² - c²) - sqrt((b - a)² - c²)
print(f"{(160**2 - 60**2) ** 0.5 - (80**2 - 60**2) ** 0.5:.6f}")
