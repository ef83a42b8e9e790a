"""A design as the description of an ordinary mechanism, in file units."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from linkwork.core.foundation.arrays import Array
from linkwork.core.foundation.names import GROUND
from linkwork.core.foundation.units import FULL_TURN, AngleUnit
from linkwork.core.mechanism.inputs import Input
from linkwork.core.mechanism.linkage import Linkage
from linkwork.core.mechanism.part.guides import Slider
from linkwork.core.results.listing.motion_listing import significant
from linkwork.synthesis.loops.candidates import Candidates, Drive, LoopKind
from linkwork.synthesis.loops.limits import cross, dot, meeting
from linkwork.synthesis.tasks.task import Task

_STEP = math.pi / 180.0  # of an angle [rad]
_STEPS = 100  # of a displacement
_ON_LINE = 1e-9  # of a coupler's length: a pivot on its line
_SAME_TURN = 1e-12  # relative: the rounding of a few angles
_GUIDE = "slide"
#: Of each side: moving and fixed pivot, points of a line on ground, names of slider and block.
_SIDES = (("A", "A0", "UV", "slide_a", "block_a"), ("B", "B0", "ST", _GUIDE, "block"))
_GROUND_POINTS = ("A0", "B0", "U", "V", "S", "T")
_MOST_LISTED = 9  # positions whose inputs are listed
_DIGITS = 6


@dataclass(frozen=True, kw_only=True)
class Design:
    """One design at its first position, with its driven range.

    Parameters
    ----------
    kind : LoopKind
    drive : Drive
    points : Mapping[str, complex]
        A0, B0, A, B, P of a four-bar; A0, S, T, A, B, P of a slider-crank, with S, T on the line of
        the slider, S where its displacement is zero; A0, B0, A, B, P of an inverted one, with B on
        the coupler's line, and C, the foot of A, if A is not on it. U, V on the line of a slider at
        A; K, where the lines of an Oldham coupling cross [length].
    inputs : tuple of float
        The input at the positions, unwrapped [rad or length].
    start, stop : float
        The driven range [rad or length].
    backward : tuple of Drive
        Links whose angle is measured from the moving pivot to the fixed one.
    output : float, optional
        What a function has for the output at the first position, if that is not the output of the
        design [rad or length].
    """

    kind: LoopKind
    drive: Drive
    points: dict[str, complex]
    inputs: tuple[float, ...]
    start: float
    stop: float
    backward: tuple[Drive, ...] = ()
    output: float | None = None

    @classmethod
    def of(
        cls,
        candidates: Candidates,
        k: int,
        drive: Drive,
        inputs: Array,
        ends: Array,
        zero: tuple[float, float] | None = None,
    ) -> Design:
        """The k-th of some designs.

        ``inputs`` (N,), ``ends`` (2,): at the positions, and of the driven range; ``zero``: the
        angles of crank and rocker at the first position as a task measures them, opposite to the
        links where a length is negative, or the displacement of a slider [rad or length].
        """
        points = {
            "A0": candidates.fixed_a[k],
            "B0": candidates.fixed_b[k],
            "A": candidates.moving_a[k, 0],
            "B": candidates.moving_b[k, 0],
            "P": candidates.guided[k, 0],
        }
        backward = []
        if zero is not None:
            sides = (Drive.A0, "A", "A0", zero[0]), (Drive.B0, "B", "B0", zero[1])
            pinned = sides if candidates.kind is LoopKind.FOUR_BAR else sides[:1]
            for side, moving, fixed, angle in pinned:
                if ((points[moving] - points[fixed]) * np.exp(-1j * angle)).real < 0:
                    backward.append(side)
        guides = (
            ("B0", "S", "T", candidates.direction[k], candidates.moving_b[k]),
            ("A0", "U", "V", candidates.direction_a[k], candidates.moving_a[k]),
        )
        for name, start, end, direction, moving in guides:
            if name not in candidates.kind.pivots:
                line = points.pop(name)
                along = dot(direction, moving - line)
                reach = max(np.abs(along).max(), abs(points["B"] - points["A"]))
                points |= {start: line, end: line + reach * direction}
        if candidates.kind is LoopKind.OLDHAM:
            axes = (points["A0"], candidates.lines_a[k, 0], points["B0"], candidates.lines[k, 0])
            points["K"] = meeting(*map(np.asarray, axes))
        elif candidates.kind.body_line:
            # the foot of A on the line of the coupler, if A is not on it
            line = candidates.lines[k, 0]
            away = cross(line, points["B"] - points["A"])
            if abs(away) > _ON_LINE * abs(points["B"] - points["A"]):
                points["C"] = points["A"] + 1j * away * line
        if drive.turns:
            # measured as the file measures it, in the first turn to begin with or as the task does
            shift = np.pi if drive in backward else 0.0
            turns = np.floor((ends[0] + shift) / FULL_TURN + _SAME_TURN)
            if zero is not None and drive is Drive.A0:
                turns = np.round((inputs[0] + shift - zero[0]) / FULL_TURN)
            shift -= FULL_TURN * turns
            inputs, ends = inputs + shift, ends + shift
        return cls(
            kind=candidates.kind,
            drive=drive,
            points={name: complex(point) for name, point in points.items()},
            inputs=tuple(inputs.tolist()),
            start=float(ends[0]),
            stop=float(ends[1]),
            backward=tuple(backward),
            output=zero and zero[1],
        )


def linkage_of(design: Design, task: Task, name: str, output: str = "") -> Linkage:
    """The description of a design for a task; of crank and rocker the driven one is the crank.

    ``output``: the name of the output of a function, whose structural error is an output of the
    mechanism.
    """
    z, kind, ground = design.points, design.kind, _ground_names(design)
    guided = next((key for key in ("A", "B") if z[key] == z["P"]), "P")
    corners = ("A", "B") if guided != "P" else ("A", "B", "P")
    feet = tuple(key for key in ("C", "K") if key in z)
    turning = 2 if kind is LoopKind.FOUR_BAR else int(kind.has_crank)
    arms: list[tuple[str, ...]] = [_bar(design, side) for side in (Drive.A0, Drive.B0)[:turning]]
    if design.drive is Drive.B0:
        arms.reverse()
    crank, rocker = [*arms, (), ()][:2]  # none of guided sides
    sliders = []
    way: tuple[str, str]
    for moving, fixed, line, slider, block in _SIDES[turning:]:
        if fixed in kind.pivots:
            way, carried, on = (feet[0] if feet else "A", moving), fixed, "coupler"
        else:
            way, carried, on = (ground[line[0]], ground[line[1]]), moving, GROUND
        sliders.append(Slider(name=slider, link=block, points=(carried,), on=on, line=way))
    grounded = [ground[key] for key in (*kind.pivots, *"UVST") if key in z]
    links = {
        GROUND: tuple(dict.fromkeys(grounded)),
        "crank": crank,
        "coupler": (*corners, *feet),
        "rocker": rocker,
        **{slider.link: slider.points for slider in sliders},
    }
    sides = [*combinations(corners, 2), *((end, key) for key in feet for end in "AB")]
    bars = [bar for bar in (crank, *sides, rocker) if bar]
    formula = _error_formula(design, task, output)
    return Linkage(
        name=name,
        purpose=_purpose(design, task),
        length=task.length,
        angle=task.angle,
        points={
            key: (place.real, place.imag)
            for key, place in z.items()
            # without P where that is a pivot
            if ground.get(key, key) == key and (key != "P" or guided == "P")
        },
        links={link: points for link, points in links.items() if points},
        lengths={f"{one} {other}": abs(z[other] - z[one]) for one, other in bars},
        sliders=tuple(sliders),
        inputs=(_input(design, task.angle),),
        trace=(guided,),
        outputs={"structural_error": formula} if formula else {},
    )


def _ground_names(design: Design) -> dict[str, str]:
    """The name of every ground point: of points at one place, such as a pivot on the line of a
    slider, that of the first.
    """
    z, first = design.points, dict[complex, str]()
    return {key: first.setdefault(z[key], key) for key in _GROUND_POINTS if key in z}


def _error_formula(design: Design, task: Task, output: str) -> str:
    """The structural error of a function, whose start angles the solver may have chosen."""
    goal, unit = task.function, task.angle.from_radians
    if not output or goal is None or design.drive is not Drive.A0:
        return ""
    if goal.free:
        begin = _first_output(design) if design.output is None else design.output
        begin = begin if design.kind is LoopKind.SLIDER_CRANK else unit(begin)
        goal = goal.begun_at(unit(design.inputs[0]), begin)
    return goal.formula("crank", output, task.angle)


def _first_output(design: Design) -> float:
    """The angle of the rocker, or the displacement of the slider [rad or length]."""
    z = design.points
    if design.kind is LoopKind.FOUR_BAR:
        return float(np.angle(z["B"] - z["B0"]))
    line = z["T"] - z["S"]
    return float(dot(np.asarray(line / abs(line)), np.asarray(z["B"] - z["S"])))


def _purpose(design: Design, task: Task) -> str:
    """What it is for; with the inputs at its positions, if they are few."""
    if task.function is not None or len(design.inputs) > _MOST_LISTED:
        return task.purpose
    turns = design.drive.turns
    driven = _input(design, task.angle)
    values = [task.angle.from_radians(v) if turns else v for v in design.inputs]
    listed = ", ".join(significant(value, _DIGITS) for value in values)
    unit = task.angle.value if turns else task.length
    return task.purpose.replace(";", f" at {driven.link or driven.slider} = {listed} {unit};", 1)


def _bar(design: Design, side: Drive) -> tuple[str, str]:
    """The ends of a link, in the direction in which its angle is measured."""
    fixed, moving = ("A0", "A") if side is Drive.A0 else ("B0", "B")
    return (moving, fixed) if side in design.backward else (fixed, moving)


def _input(design: Design, angle: AngleUnit) -> Input:
    span = design.stop - design.start
    if not design.drive.turns:
        step = span / _STEPS
        slider = "slide_a" if design.drive is Drive.SLIDER_A else _GUIDE
        return Input(slider=slider, from_=design.start, to=design.stop, step=step)
    start, stop = angle.from_radians(design.start), angle.from_radians(design.stop)
    count = max(1, math.ceil(abs(span) / _STEP - _SAME_TURN))
    if math.isclose(abs(span), FULL_TURN, rel_tol=_SAME_TURN):
        stop = start + math.copysign(angle.turn, span)
    # so many equal steps that the last row is the last position
    driven = "crank"
    if design.kind.body_line and design.drive is Drive.B0:
        driven = "block"
    elif not design.kind.has_crank:
        driven = "block_a"
    return Input(link=driven, from_=start, to=stop, step=(stop - start) / count)
