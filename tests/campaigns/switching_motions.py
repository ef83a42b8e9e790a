"""The referee of simulations: random motions with stops, kinks and switches against DOP853.

Blocks, pendulums, slider-cranks and four-bars have closed forms of A(q) in A q̈ + ½A' q̇² = Q; their
equations are integrated piece by piece between events, which SciPy locates by itself.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt
from scipy.integrate import solve_ivp

import linkwork as lw

__all__ = ["FAMILIES", "switching_campaign"]

Array = npt.NDArray[np.float64]
#: Of the coordinate: A, ½A', and the loaded coordinate u with its derivative.
Geometry = Callable[[float], tuple[float, float, float, float]]
FAMILIES = ("block", "pendulum", "slider-crank", "four-bar")
_PERTURBED = 1e-9  # of the start speed: how the sensitivity is measured
_BOUND = 1e-9  # times the sensitivity
_GRAZES = 1e-2  # speed at an event over the fastest one: below, rounding decides what happens
_MOST_EVENTS = 20
_SAME_PLACE = 1e-10
_LONGEST, _SHORT = 0.02, 5e-4  # steps: SciPy compares signs at their ends only
_UNTIL = 2.0
_ENERGY = 1e-10  # of the largest kinetic energy


@dataclass(frozen=True)
class Load:
    """A force along u: as a formula of the file, as a function, and where it switches.

    ``force`` takes u, its rate, the time and the held signs of ``switches`` of the same numbers.
    """

    formula: str
    force: Callable[[float, float, float, float], float]
    switch: Callable[[float, float, float], float] | None = None


@dataclass
class Case:
    """A mechanism, and its equation of motion."""

    mechanism: lw.Mechanism
    name: str
    q: str
    start: float
    speed: float
    geometry: Geometry
    weight: Callable[[float], float]
    loads: list[Load]
    stop: tuple[float, float, float] | None  # side, value of q, restitution
    conserves: bool = False


@dataclass
class Path:
    """What the integrator found: states at times, the number of events, whether one grazes."""

    t: list[float] = field(default_factory=list)
    q: list[float] = field(default_factory=list)
    events: int = 0
    grazes: bool = False
    end: float = _UNTIL


def _menu(rng: np.random.Generator, u: str, about: float, size: float, force: float) -> Load:
    """A random load on a coordinate near a value, of a size."""
    # where a motion starts the curve of positions begins
    a = float(about + size * rng.uniform(-0.5, 0.5) * (rng.random() < 0.8))
    f = float(force * rng.uniform(0.2, 1.0) * rng.choice([-1.0, 1.0]))
    k = abs(f) / size
    at = rng.uniform(0.2, 1.5)
    w = rng.uniform(1.0, 8.0)

    def holds(sign: float) -> float:
        return float(sign > 0.0)

    kinds = [
        Load(f"-{k!r}*({u} - {a!r})", lambda x, v, t, s: -k * (x - a)),
        Load(f"{f!r}*sin({w!r}*t)", lambda x, v, t, s: f * math.sin(w * t)),
        Load(
            f"-{10 * k!r}*max(0, {u} - {a!r})", lambda x, v, t, s: -10 * k * (x - a) * holds(s),
            lambda x, v, t: x - a,
        ),
        Load(
            f"-{10 * k!r}*min({u}, {a!r})", lambda x, v, t, s: -10 * k * (a if s > 0 else x),
            lambda x, v, t: x - a,
        ),
        Load(
            f"{f!r}*abs({u} - {a!r})/{size!r}",
            lambda x, v, t, s: f * (x - a) * math.copysign(1.0, s) / size, lambda x, v, t: x - a,
        ),
        Load(f"{f!r}*(t > {at!r})", lambda x, v, t, s: f * holds(s), lambda x, v, t: t - at),
        Load(
            f"{f!r}*({u} > {a!r})", lambda x, v, t, s: f * holds(s), lambda x, v, t: x - a
        ),
        Load(
            f"-{0.1 * k!r}*{u}.velocity*abs({u}.velocity)",
            lambda x, v, t, s: -0.1 * k * v * v * math.copysign(1.0, s), lambda x, v, t: v,
        ),
    ]  # fmt: skip
    return kinds[int(rng.integers(len(kinds)))]


def _built(**given: Any) -> lw.Mechanism:
    return lw.linkage(length="m", angle="rad", gravity=lw.Gravity(size="9.81 m/s^2"), **given)


def random_case(number: int) -> Case:
    """A mechanism with loads and perhaps a stop."""
    rng = np.random.default_rng([40, number])
    family = FAMILIES[number % len(FAMILIES)]
    case = {
        "block": _block, "pendulum": _pendulum, "slider-crank": _slider_crank, "four-bar": _four_bar
    }[family](rng)  # fmt: skip
    case.name = f"{family} {number}"
    if case.stop is not None and case.stop[1] == case.start:
        case.speed = math.copysign(case.speed, case.stop[0])
    return case


def _stop(
    rng: np.random.Generator, q: str, start: float, size: float
) -> tuple[list[lw.Stop], tuple[float, float, float] | None]:
    if rng.random() < 0.3:
        return [], None
    side = float(rng.choice([-1.0, 1.0]))
    value = start - side * size * rng.uniform(0.1, 0.6) * (rng.random() < 0.8)
    bounce = float(rng.choice([0.0, 0.3, 0.7, 1.0]))
    key = "start" if side > 0 else "stop"
    return [lw.Stop(of=q, restitution=bounce, **{key: value})], (side, value, bounce)


def _block(rng: np.random.Generator) -> Case:
    mass, start = rng.uniform(0.5, 3.0), rng.uniform(-1.0, 1.0)
    loads = [_menu(rng, "d", start, 1.0, 20.0) for _ in range(rng.integers(1, 4))]
    loads.append(Load(f"-{5.0!r}*d", lambda x, v, t, s: -5.0 * x))
    stops, stop = _stop(rng, "d", start, 1.0)
    mechanism = _built(
        points={"S": (0, 0), "T": (1, 0), "B": (start, 0)},
        links={"ground": ["S", "T"], "block": ["B"]}, masses={"block": lw.Mass(mass=mass)},
        sliders=[
            lw.Slider(name="d", link="block", points=("B",), on="ground", line=("S", "T"))
        ],
        inputs=lw.Input(slider="d", from_=-50, to=50, step=1), stops=stops,
        loads=[lw.Load(point="B", link="block", force=(load.formula, 0)) for load in loads],
    )  # fmt: skip
    return Case(
        mechanism, "", "d", start, rng.uniform(-3, 3), lambda q: (mass, 0.0, q, 1.0),
        lambda q: 0.0, loads, stop,
    )  # fmt: skip


def _pendulum(rng: np.random.Generator) -> Case:
    mass, length, start = rng.uniform(0.5, 3.0), rng.uniform(0.3, 1.5), rng.uniform(-2.5, -0.5)
    loads = [_menu(rng, "bar", start, 1.0, 5.0) for _ in range(rng.integers(0, 3))]
    stops, stop = _stop(rng, "bar", start, 1.0)
    mechanism = _built(
        links={"ground": ["O"], "bar": ["O", "P"]},
        points={"O": (0, 0), "P": (length * math.cos(start), length * math.sin(start))},
        masses={"bar": lw.Mass(mass=mass, center=(length / 2, 0), inertia=mass * length**2 / 12)},
        inputs=lw.Input(link="bar"), stops=stops,
        loads=[lw.Load(link="bar", torque=load.formula) for load in loads],
    )  # fmt: skip
    a = mass * length**2 / 3
    pull = 0.5 * mass * 9.81 * length
    loss = stop is None or stop[2] == 1.0
    return Case(
        mechanism, "", "bar", start, rng.uniform(-3, 3), lambda q: (a, 0.0, q, 1.0),
        lambda q: -pull * math.cos(q), loads, stop, conserves=not loads and loss,
    )  # fmt: skip


def _slider_crank(rng: np.random.Generator) -> Case:
    r, inertia, mass = rng.uniform(0.2, 0.5), rng.uniform(0.02, 0.2), rng.uniform(0.5, 3.0)
    rod, start = r * rng.uniform(2.0, 5.0), rng.uniform(0.5, 2.5)

    def geometry(q: float) -> tuple[float, float, float, float]:
        s, c = math.sin(q), math.cos(q)
        root = math.sqrt(rod**2 - (r * s) ** 2)
        first = -r * s - r * r * s * c / root
        second = -r * c - r * r * (c * c - s * s) / root - (r * r * s * c) ** 2 / root**3
        return inertia + mass * first**2, mass * first * second, r * c + root, first

    loads = [_menu(rng, "d", rod, r, 20.0) for _ in range(rng.integers(0, 3))]
    stops, stop = _stop(rng, "crank", start, 1.0)
    pin = r * complex(math.cos(start), math.sin(start))
    mechanism = _built(
        points={"O": (0, 0), "T": (1, 0), "A": (pin.real, pin.imag), "B": (geometry(start)[2], 0)},
        links={"ground": ["O", "T"], "crank": ["O", "A"], "rod": ["A", "B"], "block": ["B"]},
        lengths={"O A": r, "A B": rod}, inputs=lw.Input(link="crank"), stops=stops,
        masses={
            "crank": lw.Mass(mass=1, center=(0, 0), inertia=inertia), "block": lw.Mass(mass=mass)
        },
        sliders=[
            lw.Slider(name="d", link="block", points=("B",), on="ground", line=("O", "T"))
        ],
        loads=[lw.Load(point="B", link="block", force=(load.formula, 0)) for load in loads],
    )  # fmt: skip
    loss = stop is None or stop[2] == 1.0
    return Case(
        mechanism, "", "crank", start, rng.uniform(-8, 8), geometry, lambda q: 0.0, loads, stop,
        conserves=not loads and loss,
    )  # fmt: skip


def _four_bar(rng: np.random.Generator) -> Case:
    ground, r, rocker = 1.0, rng.uniform(0.15, 0.3), rng.uniform(0.6, 0.9)
    coupler = rng.uniform(0.9, 1.1)
    inertia, other, start = rng.uniform(0.02, 0.2), rng.uniform(0.05, 0.5), rng.uniform(0.5, 2.5)

    def places(q: float) -> tuple[complex, complex]:
        a = r * complex(math.cos(q), math.sin(q))
        span = ground - a
        size = abs(span)
        along = (coupler**2 - rocker**2 + size**2) / (2.0 * size)
        unit = span / size
        return a, a + unit * (along + 1j * math.sqrt(coupler**2 - along**2))

    def geometry(q: float) -> tuple[float, float, float, float]:
        a, c = places(q)
        bar, arm = c - a, c - ground
        # rates of the rocker's angle from the length of the coupler: Re(conj(bar) d(bar)) = 0
        across = (bar.conjugate() * 1j * arm).real
        rate = (bar.conjugate() * 1j * a).real / across
        moved = 1j * arm * rate - 1j * a
        bent = -arm * rate**2 + a
        second = -(abs(moved) ** 2 + (bar.conjugate() * bent).real) / across
        angle = math.atan2(arm.imag, arm.real)
        return inertia + other * rate**2, other * rate * second, angle, rate

    about = geometry(start)[2]
    loads = [_menu(rng, "rocker", about, 0.3, 5.0) for _ in range(rng.integers(0, 3))]
    stops, stop = _stop(rng, "crank", start, 1.0)
    a, c = places(start)
    mechanism = _built(
        points={"O": (0, 0), "T": (1, 0), "A": (a.real, a.imag), "B": (c.real, c.imag)},
        links={
            "ground": ["O", "T"], "crank": ["O", "A"], "coupler": ["A", "B"], "rocker": ["T", "B"]
        },
        lengths={"O A": r, "A B": coupler, "T B": rocker}, inputs=lw.Input(link="crank"),
        masses={
            "crank": lw.Mass(mass=1, center=(0, 0), inertia=inertia),
            "rocker": lw.Mass(mass=1, center=(0, 0), inertia=other),
        },
        stops=stops, loads=[lw.Load(link="rocker", torque=load.formula) for load in loads],
    )  # fmt: skip
    loss = stop is None or stop[2] == 1.0
    return Case(
        mechanism, "", "crank", start, rng.uniform(-8, 8), geometry, lambda q: 0.0, loads, stop,
        conserves=not loads and loss,
    )  # fmt: skip


def integrate(case: Case, speed: float, times: Array, longest: float = _LONGEST) -> Path:
    """The motion up to ``_UNTIL`` or so many events, by DOP853 from event to event."""
    path, t, q, v = Path(), 0.0, case.start, speed
    fastest = abs(speed) + 0.1

    def drive(t: float, q: float, v: float, held: list[float]) -> float:
        a, half, u, du = case.geometry(q)
        total = case.weight(q) - half * v * v
        for load, sign in zip(case.loads, held, strict=True):
            total += load.force(u, du * v, t, sign) * du
        return total / a

    def margin(load: Load, t: float, q: float, v: float) -> float:
        if load.switch is None:
            return 1.0
        _, _, u, du = case.geometry(q)
        return load.switch(u, du * v, t)

    def signs(t: float, q: float, v: float) -> list[float]:
        ahead = 1e-9
        return [
            1.0 if margin(load, t + ahead, q + v * ahead, v + ahead * 0.0) > 0.0 else -1.0
            for load in case.loads
        ]

    held = signs(t, q, v)
    known = iter(times)
    at = next(known, math.inf)
    while t < _UNTIL and path.events < _MOST_EVENTS:
        watched: list[Callable[..., float]] = []
        owners: list[int] = []
        for k, load in enumerate(case.loads):
            if load.switch is not None:
                watched.append(lambda t, y, load=load: margin(load, t, y[0], y[1]))
                owners.append(k)
        if case.stop is not None:
            side, value, _ = case.stop
            watched.append(lambda t, y, side=side, value=value: side * (y[0] - value))
            owners.append(-1)
        for each in watched:
            each.terminal = True  # type: ignore[attr-defined]
        if case.stop is not None:
            watched[-1].direction = -1.0  # type: ignore[attr-defined]
        # SciPy passes a stop that the motion reaches just so
        watched.append(lambda t, y: y[1])
        # an event is left before it is watched again
        skip = 1e-12

        def rates(t: float, y: Array, held: list[float] = held) -> tuple[float, float]:
            return y[1], drive(t, y[0], y[1], held)

        fine: dict[str, Any] = {"method": "DOP853", "rtol": 1e-13, "atol": 1e-15}
        first = solve_ivp(rates, (t, t + skip), (q, v), **fine)
        found = solve_ivp(
            rates, (t + skip, _UNTIL), first.y[:, -1], events=watched, dense_output=True,
            max_step=longest, **fine,
        )  # fmt: skip
        last = float(found.t[-1])
        while at <= last:
            path.t.append(float(at))
            path.q.append(float(found.sol(at)[0]) if at > t + skip else q)
            at = next(known, math.inf)
        turns = found.y_events.pop()
        if case.stop is not None and len(turns):
            path.grazes |= bool((case.stop[0] * (turns[:, 0] - case.stop[1])).min() < 0.0)
        found.t_events.pop()
        t, q, v = last, float(found.y[0, -1]), float(found.y[1, -1])
        fastest = max(fastest, float(np.abs(found.y[1]).max()))
        if found.status != 1:
            break
        path.events += 1
        which = next(k for k, own in zip(owners, found.t_events, strict=True) if len(own))
        if case.stop is not None and case.stop[0] * v < 0.0:
            # a switch at the value of the stop is not passed
            which = -1 if case.stop[0] * (q - case.stop[1]) < _SAME_PLACE else which
        if which >= 0:
            rate = (
                abs(
                    margin(case.loads[which], t + 1e-6, q + 1e-6 * v, v)
                    - margin(case.loads[which], t - 1e-6, q - 1e-6 * v, v)
                )
                / 2e-6
            )
            bends = abs(drive(t, q, v, held))
            slow = rate < _GRAZES * fastest and not (abs(v) < 1e-9 and bends > _GRAZES)
            path.grazes |= slow
            # loads of the rate switch together, and those with one place
            turned = ".velocity" in case.loads[which].formula
            held = [
                -sign
                if k == which
                or (turned and ".velocity" in load.formula)
                or abs(margin(load, t, q, v)) < _SAME_PLACE
                else sign
                for k, (load, sign) in enumerate(zip(case.loads, held, strict=True))
            ]
            continue
        assert case.stop is not None
        side, value, bounce = case.stop
        path.grazes |= abs(v) < _GRAZES * fastest
        q, v = value, -bounce * v
        along = math.copysign(1.0, case.geometry(q)[3] * (v or side))
        held = [
            along if ".velocity" in load.formula else sign
            for load, sign in zip(case.loads, held, strict=True)
        ]
        pull = side * drive(t, q, 0.0, held)
        if bounce and (abs(v) < 1e-3 * fastest):
            path.grazes = True  # bounces without end: how many are seen depends on rounding
            break
        if bounce == 0.0 and pull < 0.0:
            t, at, held = _wait(case, t, q, drive, signs, path, times, at)
            known = iter(times[times > t])
            v = 0.0
            at = next(known, math.inf)
    path.end = min(t, _UNTIL)
    return path


def _wait(
    case: Case, t: float, q: float, drive: Callable[..., float], signs: Callable[..., list[float]],
    path: Path, times: Array, at: float,
) -> tuple[float, float, list[float]]:  # fmt: skip
    """Rest at the stop until the loads pull away from it, found by bisection."""
    assert case.stop is not None
    side = case.stop[0]

    def leaves(x: float) -> bool:
        return side * drive(x, q, 0.0, signs(x, q, 0.0)) > 0.0

    looks = np.linspace(t, _UNTIL, 20001)
    after = next((float(x) for x in looks[1:] if leaves(float(x))), None)
    end = _UNTIL
    if after is not None:
        low, end = after - float(looks[1] - looks[0]), after
        for _ in range(60):
            middle = 0.5 * (low + end)
            low, end = (low, middle) if leaves(middle) else (middle, end)
        path.events += 1
    for x in times[(times >= at) & (times <= end)]:
        path.t.append(float(x))
        path.q.append(q)
    return end, at, signs(end, q, 1e-12 * side)


def switching_campaign(part: int, count: int) -> tuple[Counter[str], list[str]]:
    """Judge the motions with the numbers of one part."""
    counts: Counter[str] = Counter()
    wrong: list[str] = []
    for number in range(part * count, (part + 1) * count):
        case = random_case(number)
        times = np.linspace(0.0, _UNTIL, 21)[1:]
        counts["motions"] += 1
        one, other = _both(case, times, _LONGEST)
        if one.grazes or other.grazes or one.events != other.events or case.speed == 0.0:
            counts["left out: grazing, or bounces without end"] += 1
            continue
        motion = case.mechanism.simulate(
            until=_UNTIL, step=0.1, at=case.start, start_speed=case.speed
        )
        said = _judge(case, motion, one, other, counts)
        if said:
            one, other = _both(case, times, _SHORT)
            grazes = one.grazes or other.grazes
            said = [] if grazes else _judge(case, motion, one, other, Counter())
        wrong += said
    return counts, wrong


def _both(case: Case, times: Array, longest: float) -> tuple[Path, Path]:
    """The motion, and one from a slightly different speed."""
    one, other = (
        integrate(case, case.speed * (1.0 + change), times, longest) for change in (0.0, _PERTURBED)
    )
    return one, other


def _judge(
    case: Case, motion: lw.Motion, one: Path, other: Path, counts: Counter[str]
) -> list[str]:
    wrong = []
    counts["events"] += one.events
    keep = [k for k, t in enumerate(one.t[: len(other.t)]) if t < one.end - 1e-6]
    t = np.array(one.t)[keep]
    rows = [int(np.argmin(np.abs(motion["t"] - x) + 1.0 * motion.added)) for x in t]
    mine, exact = motion[case.q][rows], np.array(one.q)[keep]
    sensitivity = np.maximum.accumulate(np.abs(np.array(other.q)[keep] - exact)) / _PERTURBED
    size = 1.0 + np.abs(exact)
    error = np.abs(mine - exact) / (size + sensitivity)
    counts["rows"] += len(t)
    if len(t) and not error.max() <= _BOUND:
        worst = int(np.argmax(np.where(np.isfinite(error), error, np.inf)))
        wrong.append(
            f"{case.name}: {mine[worst]:.12g} for {exact[worst]:.12g} at t = {t[worst]:g}, "
            f"{motion.message}"
        )
    if case.conserves:
        counts["conservative"] += 1
        energy = motion["kinetic_energy"] + motion["stored_energy"]
        if not np.ptp(energy) <= _ENERGY * motion["kinetic_energy"].max():
            wrong.append(f"{case.name}: the energy drifts by {np.ptp(energy):.1e}")
    return wrong
