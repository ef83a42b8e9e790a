"""Cams, rolling wheels and welds that cannot be: each refused with its whole message."""

from __future__ import annotations

import pytest

import linkwork as lw
from tests.core.laws.contacts import xy

CAM = """\
format = 1
[points]
O = [0, 0]
P = [80, 0]
R = [20, 45]
S = [5, 0]
T = [5, 100]
K = [5, 50]
[links]
ground = ["O", "P", "S", "T"]
disc = ["O"]
arm = ["P", "R"]
stem = ["K"]
[[sliders]]
name = "s"
link = "stem"
points = ["K"]
on = "ground"
line = ["S", "T"]
[[cams]]
name = "swing"
cam = "disc"
center = "O"
link = "arm"
pivot = "P"
point = "R"
SWING
[[cams]]
name = "lift"
cam = "disc"
center = "O"
slider = "s"
LIFT
[input]
link = "disc"
"""
#: Shapes of the two cams that are right, one line each.
SWING = (
    'base = 40\nsegments = [{law="cycloidal",over=180,lift=8},{law="cycloidal",over=180,lift=-8}]'
)
LIFT = 'base = 40\nsegments = [{law="harmonic",over=180,lift=8},{law="harmonic",over=180,lift=-8}]'
HOLLOW = "[[40,0],[20,20],[0,41],[-30,30],[-42,0],[-28,-29],[0,-40],[29,-28]]"


def refused(swing: str = SWING, lift: str = LIFT) -> str:
    text = CAM.replace("SWING", swing).replace("LIFT", lift)
    with pytest.raises(lw.MechanismFileError) as caught:
        lw.loads(text).equations()
    return str(caught.value).split("\n", 1)[1].strip()


def program(kind: str, over: float, lift: float, base: float, rest: str = "") -> str:
    back = f'{{law="{kind}",over={360 - over},lift={-lift}}}'
    return f'base = {base}\nsegments = [{{law="{kind}",over={over},lift={lift}}},{back}]\n{rest}'


def test_the_cams_are_right_as_they_stand() -> None:
    mechanism = lw.loads(CAM.replace("SWING", SWING).replace("LIFT", LIFT))
    assert mechanism.sweep().certified.all()


@pytest.mark.parametrize(
    ("lift", "message"),
    [
        (
            program("harmonic", 180, 8, 4),
            "line 34  cams[2].base  is too small: the follower passes the centre at a distance of "
            "5, the base circle reaches only 4",
        ),
        (
            program("harmonic", 180, 8, 3, 'contact = "roller"\nradius = 2'),
            "line 34  cams[2].base  is too small: the follower passes the centre at a distance of "
            "5, the base circle with the roller reaches only 5",
        ),
        (
            program("harmonic", 180, -30, 25),
            "line 34  cams[2].base  is too small: the segments move the follower 30 towards the "
            "cam's centre, which is only 24.4949 away",
        ),
        (
            program("harmonic", 180, -30, 25, 'contact = "flat"'),
            "line 34  cams[2].base  is too small: the segments move the follower 30 towards the "
            "cam's centre, which is only 25 away",
        ),
        (
            program("cycloidal", 40, 12, 30, 'contact = "flat"'),
            "line 35  cams[2].segments  undercut the cam 21.75 deg after their start: its "
            "outline would intersect itself; use a larger base circle",
        ),
        (
            program("cycloidal", 40, 12, 25, 'contact = "roller"\nradius = 15'),
            "line 35  cams[2].segments  undercut the cam 30.5 deg after their start: its outline "
            "would intersect itself; use a larger base circle or a smaller roller",
        ),
        (
            f'profile = {HOLLOW}\ncontact = "flat"',
            "line 34  cams[2].profile  is concave at (20.01, 19.99), where a flat face cannot "
            "follow: make it convex",
        ),
        (
            f'profile = {HOLLOW}\ncontact = "roller"\nradius = 60',
            "line 34  cams[2].profile  is too concave at (20.01, 19.99): its radius of "
            "curvature is 42.1, smaller than that of the roller",
        ),
    ],
)
def test_a_cam_that_cannot_move_its_slider_so_is_refused(lift: str, message: str) -> None:
    assert refused(lift=lift) == message


@pytest.mark.parametrize(
    ("swing", "message"),
    [
        (
            program("cycloidal", 180, 8, 3),
            "line 27  cams[1].base  does not fit: a follower whose arm of 75 swings about a pivot "
            "80 away from the cam's centre cannot touch a circle of 3",
        ),
        (
            program("cycloidal", 180, 8, 80, 'contact = "flat"'),
            "line 27  cams[1].base  does not fit: a follower whose arm of 75 swings about a pivot "
            "80 away from the cam's centre cannot touch a circle of 80",
        ),
        (
            program("cycloidal", 180, -40, 40),
            "line 27  cams[1].base  does not fit: there the arm is at 29.6863 deg from the line "
            "from the pivot to the cam's centre, and the segments swing it across that line",
        ),
        (
            program("harmonic", 20, 20, 40, 'contact = "flat"'),
            "line 28  cams[1].segments  undercut the cam 14 deg after their start: its outline "
            "would intersect itself; use a larger base circle",
        ),
    ],
)
def test_a_cam_that_cannot_swing_its_follower_so_is_refused(swing: str, message: str) -> None:
    assert refused(swing=swing) == message


def test_a_cam_that_is_held_on_its_frame_is_refused() -> None:
    text = CAM.replace("SWING", SWING).replace("LIFT", LIFT)
    text = text.replace('disc = ["O"]', 'disc = ["O", "D"]').replace(
        "[links]", "D = [9, 9]\n[links]"
    )
    text = text.replace('link = "disc"', 'slider = "s"\nfrom = 0\nto = 1\nstep = 1')
    held = text + '[[welds]]\nlinks = ["ground", "disc"]\n'
    with pytest.raises(lw.MechanismFileError) as caught:
        lw.loads(held).equations()
    message = '"disc" cannot turn relative to "ground": a slider or a weld holds its angle'
    assert [problem.message for problem in caught.value.problems] == [message, message]


def test_a_link_that_is_welded_to_what_it_is_driven_against_is_refused() -> None:
    with pytest.raises(lw.MechanismError) as caught:
        lw.linkage(
            points=xy(O=0j, A=1 + 0j, B=2j),
            links={"ground": ("O", "B"), "crank": ("O", "A")},
            welds=(lw.Weld(links=("ground", "crank")),),
            inputs=(lw.Input(link="crank"),),
        ).equations()
    (problem,) = caught.value.problems
    assert problem.message == (
        '"crank" cannot turn relative to "ground": a slider or a weld holds its angle'
    )


def test_welds_around_a_ring_have_to_agree() -> None:
    with pytest.raises(lw.MechanismError) as caught:
        lw.linkage(
            points=xy(O=0j, A=1 + 0j, B=2j, C=-1 + 1j),
            links={"ground": ("O",), "a": ("O", "A"), "b": ("O", "B"), "c": ("O", "C")},
            welds=(
                lw.Weld(links=("a", "b"), angle=90),
                lw.Weld(links=("b", "c"), angle=45),
                lw.Weld(links=("a", "c"), angle=134),
            ),
            inputs=(lw.Input(link="a"),),
        ).equations()
    (problem,) = caught.value.problems
    assert problem.key == ("welds", 2)
    assert problem.message == (
        '"c" cannot keep its angle relative to "a": other joints change it by 1°'
    )


def test_a_pinion_or_a_wheel_sketched_on_its_line_is_asked_for_its_side() -> None:
    def rack(y: float) -> lw.Mechanism:
        return lw.linkage(
            points=xy(O=1j * y, S=-50 + 0j, T=50 + 0j, R=0.5 + 0j),
            links={"ground": ("O", "S", "T"), "pinion": ("O",), "rack": ("R",)},
            sliders=(
                lw.Slider(name="s", link="rack", points=("R",), on="ground", line=("S", "T")),
            ),
            racks=(lw.Rack(name="m", pinion="pinion", center="O", slider="s", radius=20),),
            inputs=(lw.Input(link="pinion", from_=0, to=90, step=90),),
        )

    for y, moved in ((20, 10 * 3.141592653589793), (-20, -10 * 3.141592653589793)):
        motion = rack(y).sweep()
        assert motion["s"][1] - motion["s"][0] == pytest.approx(moved, rel=1e-12)
    with pytest.raises(lw.MechanismError) as caught:
        rack(0).equations()
    (problem,) = caught.value.problems
    assert problem.key == ("racks", 0, "center")
    assert problem.message == (
        "O lies on the line S T of ground: sketch it on the side on which it is"
    )


def test_a_law_that_does_not_exist_is_refused_in_code_as_well() -> None:
    with pytest.raises(lw.MechanismError) as caught:
        lw.linkage(
            points=xy(O=0j, S=1 + 0j, T=1 + 9j, R=1 + 5j),
            links={"ground": ("O", "S", "T"), "cam": ("O",), "stem": ("R",)},
            sliders=(
                lw.Slider(name="s", link="stem", points=("R",), on="ground", line=("S", "T")),
            ),
            cams=(
                lw.Cam(name="c", cam="cam", center="O", slider="s", base=4,
                       segments=[lw.Segment(law="rest", over=360)]),  # type: ignore[arg-type]  # a list
            ),
            inputs=(lw.Input(link="cam"),),
        )  # fmt: skip
    (problem,) = caught.value.problems
    assert problem.message == (
        "must be one of dwell, harmonic, cycloidal, modified sine, modified trapezoid, 3-4-5, "
        "4-5-6-7, got rest"
    )


def test_a_link_between_the_centres_of_a_rolling_wheel_is_one_too_many() -> None:
    with pytest.raises(lw.MechanismError) as caught:
        lw.linkage(
            points=xy(O=0j, C=30 + 0j, P=35 + 0j),
            links={"ground": ("O",), "wheel": ("C", "P"), "arm": ("O", "C")},
            rolling=(
                lw.Rolling(name="way", wheel="wheel", center="C", radius=10, circle="O",
                           circle_radius=20),
            ),
            inputs=(lw.Input(link="wheel"),),
        ).equations()  # fmt: skip
    (problem,) = caught.value.problems
    assert problem.key == ("rolling", 0, "circle")
    assert problem.message == (
        '"arm" carries both centres O and C already: two wheels on an arm are [[gears]]'
    )


NONCIRCULAR = """\
format = 1
[points]
O = [0, 0]
P = [100, 0]
[links]
ground = ["O", "P"]
first = ["O"]
second = ["P"]
[[noncircular_gears]]
name = "mesh"
wheels = ["first", "second"]
centers = ["O", "P"]
LAW
[input]
link = "first"
"""


@pytest.mark.parametrize(
    ("law", "message"),
    [
        ("", "needs one of law, table and pitch_curve, it has none of them"),
        (
            'law = "-phi"\ntable = [[0, 0], [90, -90], [180, -180], [270, -270], [360, -360]]',
            "needs one of law, table and pitch_curve, it has law and table",
        ),
        ('law = "-psi"', 'column 2: "psi" is not defined (dimensions: phi)'),
        ('law = "phi"', "is not decreasing: external gears turn in opposite directions"),
        ('law = "-phi - 10*abs(sin(phi))"', "is not smooth, or changes too fast, near phi = "),
        (
            'law = "-(phi + 2*atan(0.999*sin(phi)/(1 - 0.999*cos(phi))))"',
            "is not smooth, or changes too fast, near phi = ",
        ),
        (
            'law = "-phi*0.7071"',
            "turns the second wheel by -0.7071 of a turn while the first one turns once: "
            "not a ratio of whole numbers up to 12, so the pitch curves do not close",
        ),
        (
            'law = "-2*phi - 20*sin(phi)"',
            "turns the second wheel 2 times while the first one turns 1 times, but each time "
            "differently: its pitch curve does not close",
        ),
        (
            "table = [[0, 0], [90, -90], [180, -180], [270, -270], [350, -360]]",
            "covers 350: one turn of the first wheel is 360",
        ),
        (
            "table = [[0, 0], [90, -90], [80, -180], [270, -270], [360, -360]]",
            "the first angle must increase, the second must decrease",
        ),
        (
            "pitch_curve = [[110, 0], [0, 50], [-50, 0], [0, -50]]",
            "reaches beyond the other centre, 100 away",
        ),
        (
            "pitch_curve = [[50, 0], [40, 0], [30, 10], [35, -5]]",
            "is not star-shaped about its centre",
        ),
    ],
)
def test_non_circular_gears_that_cannot_roll_are_refused(law: str, message: str) -> None:
    with pytest.raises(lw.MechanismError) as caught:
        _ = lw.loads(NONCIRCULAR.replace("LAW", law)).model
    assert any(problem.message.startswith(message) for problem in caught.value.problems)
