"""Mechanism files that are right: one of each form, and one with every table."""

from __future__ import annotations

__all__ = ["SAMPLES"]

FOUR_BAR = """\
format = 1
name = "Four-bar"
length = "mm"
angle = "deg"

[points]
O2 = [0, 0]
A = [35, 20]
B = [146, 66]
O4 = [100, 0]

[links]
ground = ["O2", "O4"]
crank = ["O2", "A"]
coupler = ["A", "B"]
rocker = ["O4", "B"]

[lengths]
"O2 A" = 40
"A B" = 120
"O4 B" = 80
"O2 O4" = 100

[input]
link = "crank"
from = 0
to = 360
step = 1
"""

QUICK_RETURN = """\
format = 1
name = "Shaper with everything"
angle = "deg"
source = "drawn for the tests"

[dimensions]
a = 40
b = "2*a + 10"   # a formula

[points]
O2 = [0, 100]
O4 = [0, 0]
A = ["a", 100]
P = [20, 150]
Q = ["a", 300]
D = [0, "b"]
S = [-50, 300]
T = [200, 300]
K = [300, 0]

[links]
ground = ["O2", "O4", "S", "T", "K"]
crank = ["O2", "A"]
rocker = ["O4", "P", "D"]
ram = ["Q"]

[lengths]
"O2 A" = "a"
"O4 P" = 151.3

[angles]
"P O4 D" = 7.5

[[slots]]
name = "d"
point = "A"
on = "rocker"
line = ["O4", "P"]

[[sliders]]
name = "s16"
link = "ram"
points = ["Q"]
on = "ground"
line = ["S", "T"]
offset = 0
angle = 0

[[cylinders]]
name = "boom_cylinder"
between = ["K", "Q"]

[[input]]
link = "crank"
relative_to = "ground"
from = 0
to = 90
step = 1
speed = "300 rpm"

[[input]]
cylinder = "boom_cylinder"
from = "a"
to = 85
step = 0.5
speed = 50

[trace]
points = ["P"]

[outputs]
mu = "rocker - crank"

[[springs]]
name = "return"
between = ["K", "D"]
"""

RAPIER = """\
format = 1
name = "Rapier drive of a loom"
length = "mm"
angle = "deg"

[dimensions]
a1 = 340
a2 = 250
a3 = "a1 + 10"
b1 = 100

[loops]
"A0 A B" = "a2*e^(i*θ12) + a3*e^(i*θ13) = s16 + i*b1"

[guess]
"θ12" = 60
"θ13" = 200
s16 = 400

[input]
variable = "θ12"
from = 0
to = 360
step = 1

[points]
A0 = "0"
A = "a2*e^(i*theta12)"

[links]
crank = ["A0", "A"]

[trace]
points = ["A"]

[outputs]
lift = "s16 - a1"
"""

CUBIC = """\
format = 1
name = "A cubic that makes Newton cycle"

[dimensions]
c = 2

[equations]
f = "x^3 - c*x + c = 0"

[guess]
x = -2
"""

WHEELS = """\
format = 1
name = "Every kind of wheel"

[dimensions]
r = 20

[points]
O = [0, 0]
P = [60, 0]
A = [10, 0]
B = [70, 5]
S = [-50, -20]
T = [50, -20]
R = [0, -20]
C = [200, 30]
D = [200, 50]
E = [150, 0]
F = [250, 0]
G = [0, 90]
H = [0, 100]

[links]
ground = ["O", "P", "S", "T", "E", "F", "G"]
left = ["O", "A"]
right = ["P"]
flag = ["P", "B"]
rack = ["R"]
roller = ["C", "D"]
planet = ["H"]

[[sliders]]
name = "s"
link = "rack"
points = ["R"]
on = "ground"
line = ["S", "T"]

[[welds]]
links = ["flag", "right"]
angle = 15

[[gears]]
name = "mesh"
wheels = ["left", "right"]
centers = ["O", "P"]
radii = ["2*r", "r"]
phase = 45

[[belts]]
name = "belt"
wheels = ["left", "right"]
centers = ["O", "P"]
arm = "ground"
teeth = [20, 30]
crossed = true

[[racks]]
name = "rack_and_pinion"
pinion = "left"
center = "O"
slider = "s"
radius = "r"

[[rolling]]
name = "x"
wheel = "roller"
center = "C"
radius = 30
line = ["E", "F"]

[[rolling]]
name = "around"
wheel = "planet"
center = "H"
radius = 5
on = "ground"
circle = "G"
circle_radius = 15
inside = true

[input]
link = "left"
"""

CAMS = """\
format = 1
name = "Every kind of cam"

[points]
O = [0, 0]
P = [80, 0]
R = [20, 45]
S = [5, 0]
T = [5, 100]
K = [5, 50]
B = [100, 20]

[links]
ground = ["O", "P", "S", "T"]
disc = ["O"]
arm = ["P", "R"]
stem = ["K"]
rod = ["R", "B"]

[lengths]
"P R" = 75

[[sliders]]
name = "s"
link = "stem"
points = ["K"]
on = "ground"
line = ["S", "T"]

[[cams]]
name = "lift"
cam = "disc"
center = "O"
slider = "s"
contact = "roller"
radius = 10
base = 40
start = 15
segments = [
    { law = "dwell", over = 60 },
    { law = "cycloidal", over = 100, lift = 20 },
    { law = "modified sine", over = 200, lift = -20 },
]

[[cams]]
name = "swing"
cam = "disc"
center = "O"
link = "arm"
pivot = "P"
point = "R"
contact = "flat"
profile = [[40, 0], [28, 28], [0, 41], [-30, 30], [-42, 0], [-28, -29], [0, -40], [29, -28]]

[[curves]]
name = "u"
point = "B"
on = "ground"
origin = "O"
through = [[60, 0], [80, 20], [100, 25], [120, 20], [150, 0]]

[[curves]]
name = "ring"
point = "B"
on = "arm"
origin = "P"
through = [[10, 0], [0, 10], [-10, 0], [0, -10]]
closed = true

[input]
link = "disc"
"""

SAMPLES = {
    "four_bar": FOUR_BAR,
    "sketched": FOUR_BAR.replace("\n\n[points]", "\nsketch = true\n\n[points]"),
    "listed": FOUR_BAR.replace("\n\n[points]", '\nfamily = "four-bar"\n\n[points]'),
    "quick_return": QUICK_RETURN,
    "rapier": RAPIER,
    "cubic": CUBIC,
    "wheels": WHEELS,
    "cams": CAMS,
}
