"""The referee of sweeps: whole cycles of random mechanisms against closed forms.

Dyads are circles that meet, so four-bars, slider-cranks, inverted slider-cranks and the six-bars
built of dyads have a closed form on every branch. Triads are compared with a certified track with
another start and four times finer.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

import linkwork as lw
from linkwork.core.foundation.statuses import Status
from linkwork.core.numerics.newton import NewtonOptions
from linkwork.core.results.quantity import Kind

__all__ = [
    "FAMILIES",
    "Case",
    "Tally",
    "changed_branch",
    "random_case",
    "random_mechanism",
    "sweep_campaign",
]

Array = npt.NDArray[np.float64]
Complex = npt.NDArray[np.complex128]
#: Joints (rows, joints) at input angles (rows,), for the signs of the dyads.
ClosedForm = Callable[[Array, tuple[int, ...]], Complex]
FAMILIES = ("four-bar", "slider-crank", "inverted", "Stephenson", "Watt", "triad")
STEPS = (1, 10, 60)
_APART = 1e-7  # two branches nearer than this are not told apart by their positions


@dataclass
class Tally:
    """Counts, and what went wrong with the mechanism's number."""

    counts: Counter[str] = field(default_factory=Counter)
    wrong: list[str] = field(default_factory=list)

    def add(self, other: Tally) -> None:
        """Both together."""
        self.counts += other.counts
        self.wrong += other.wrong


@dataclass(frozen=True)
class Case:
    """A mechanism with its closed form; ``turns``: every row can be reached on its branch."""

    mechanism: lw.Mechanism
    joints: Callable[[dict[str, Array], Array], Complex]
    exact: ClosedForm | None
    signs: tuple[int, ...]
    turns: bool


def sweep_campaign(numbers: range, plain: bool = True) -> Tally:
    """Sweep the mechanisms with these numbers; a tenth of them is close to a change point.

    Plain Newton-Raphson, row by row, is compared where it is asked for.
    """
    tally = Tally()
    for number in numbers:
        family = FAMILIES[number % len(FAMILIES)]
        step = STEPS[number // len(FAMILIES) % len(STEPS)]
        rng = np.random.default_rng([11, number])
        near = 10 ** rng.uniform(-9, -3) if rng.random() < 0.12 and family != "triad" else None
        case = random_case(rng, family, near, step)
        _judge(case, tally, f"{family}, {step} degrees, number {number}: ", step, near, plain)
    return tally


def random_mechanism(family: str, rng: np.random.Generator) -> lw.Mechanism:
    """One of a family, a tenth of them close to a change point."""
    near = 10 ** rng.uniform(-9, -3) if rng.random() < 0.12 and family != "triad" else None
    return random_case(rng, family, near, 10).mechanism


def _judge(
    case: Case, tally: Tally, where: str, step: int, near: float | None, plain: bool
) -> None:
    motion = case.mechanism.sweep()
    counts = tally.counts
    counts["mechanisms"] += 1
    counts["near a change point"] += near is not None
    counts["rows"] += len(motion)
    counts["rows found"] += int(motion.found.sum())
    for reason in motion.certification:
        counts[f"row {reason.name}"] += 1
    limit = np.array(motion.limit) != ""
    counts["limit rows"] += int(limit.sum())
    far = _off_at_limits(case, motion, limit)
    if far:
        tally.wrong.append(f"{where}{far} limit rows are no limits")
    asked, found, certified = motion.asked, motion.found[motion.asked], motion.certified
    theta = np.radians(motion["t"][asked])
    joints = _joints(case, motion, asked)
    finer = joints if case.exact else _finer(case, step, motion)
    changed = changed_branch(case, theta, joints, finer) & ~limit[asked]
    counts["branch changes"] += int((changed & found).sum())
    if (changed & certified[asked]).any():
        wrong = int((changed & certified[asked]).sum())
        tally.wrong.append(f"{where}{wrong} certified on another branch")
    elif (changed & found).any():
        tally.wrong.append(f"{where}{int(changed.sum())} rows on another branch, not certified")
    if case.turns and not found.all():
        counts["rows lost that can be reached"] += int((~found).sum())
        if near is None:
            tally.wrong.append(f"{where}{int((~found).sum())} reachable rows are lost")
    if plain:
        jumped = (
            changed_branch(case, theta, case.joints(*_plain_newton(case, theta)), finer) & found
        )
        counts["plain Newton: mechanisms that change branch"] += bool(jumped.any())


def _joints(case: Case, motion: lw.Motion, rows: npt.NDArray[np.bool_]) -> Complex:
    values = {name: motion[name][rows] for name in motion.unknowns}
    return case.joints(values, np.radians(motion["t"][rows]))


_STEP_INSIDE = 1e-10  # rad: the branch is its square root away, times a curvature


def _off_at_limits(case: Case, motion: lw.Motion, limit: npt.NDArray[np.bool_]) -> int:
    """How many limit rows are not where the own branch is, just before it ends or crosses."""
    if case.exact is None or not limit.any():
        return 0
    joints, theta = _joints(case, motion, limit), np.radians(motion["t"][limit])
    off = [
        np.abs(joints - case.exact(theta + inside, case.signs)).max(axis=1)
        for inside in (-_STEP_INSIDE, _STEP_INSIDE)
    ]
    return int((~(np.fmin(*off) < 1e-3)).sum())


def changed_branch(
    case: Case, theta: Array, joints: Complex, finer: Complex
) -> npt.NDArray[np.bool_]:
    """Rows nearer to another branch than to the own one."""
    if case.exact is None:
        off = np.abs(joints - finer).max(axis=2)  # of three turns
        known = np.isfinite(off).any(axis=0)
        return np.asarray(known & (np.where(np.isfinite(off), off, np.inf).min(axis=0) > 1e-6))
    own = np.abs(joints - case.exact(theta, case.signs)).max(axis=1)
    nearest = np.full(len(theta), np.inf)
    for bits in range(2 ** len(case.signs)):
        signs = tuple(1 if bits >> k & 1 else -1 for k in range(len(case.signs)))
        if signs != case.signs:
            other = np.abs(joints - case.exact(theta, signs)).max(axis=1)
            nearest = np.fmin(nearest, other)
    # a row that no branch explains counts as changed, too
    with np.errstate(invalid="ignore"):
        return np.asarray((own > _APART) & ((nearest < own) | (own > 1e-4)))


def _finer(case: Case, step: int, motion: lw.Motion) -> Complex:
    """The joints from a certified sweep with another start, four steps for one.

    A branch may turn the input by more than a whole turn and then has two positions at one angle:
    the rows of three turns are given, (3, rows, joints).
    """
    fine_step = min(step, 10) / 4
    certified = np.flatnonzero(motion.certified & motion.asked)
    k = int(certified[len(certified) // 3])
    guess = {name: float(motion[name][k]) for name in motion.unknowns}
    other = case.mechanism.changed(guess=guess | {"t": float(motion["t"][k])})
    fine = other.sweep(from_=-360, to=720, step=fine_step)
    joints = _joints(case, fine, fine.asked)
    joints[~fine.certified[fine.asked]] = np.nan
    every, turn = round(step / fine_step), round(360 / fine_step)
    return np.stack([joints[k * turn : (k + 1) * turn + 1 : every] for k in range(3)])


def _plain_newton(case: Case, theta: Array) -> tuple[dict[str, Array], Array]:
    """Each row from the one before, without a look at where it comes from."""
    model = case.mechanism.model
    solver = model.compiled.solver
    options = NewtonOptions(largest_turn=math.inf)
    start = solver.solve(model.equations.start[None, :], options).v[0]
    found = np.full((len(theta), solver.variables), np.nan)
    begin = int(np.argmin(np.abs(theta - start[-1])))
    for direction in (range(begin, len(theta)), range(begin - 1, -1, -1)):
        here = start.copy()
        for k in direction:
            here[-1] = theta[k]
            done = solver.solve(here[None, :], options)
            if done.status[0] != Status.CONVERGED.code:
                break
            here = done.v[0].copy()
            found[k] = here
    names = [(v.name, model.units.scale(Kind(v.kind))) for v in model.equations.unknowns]
    return {name: found[:, k] / scale for k, (name, scale) in enumerate(names)}, theta


# ------------------------------------------------------------------ families


def _meet(a: Complex, b: Complex, to_a: float, to_b: float, side: int) -> Complex:
    """The point at given distances, left (+1) or right of the line from a to b."""
    span = b - a
    d = np.abs(span)
    with np.errstate(invalid="ignore", divide="ignore"):
        x = (d + (to_a - to_b) * (to_a + to_b) / d) / 2
        h = np.sqrt((to_a - x) * (to_a + x))
        return np.asarray(a + span / d * (x + 1j * side * h))


def _cis(degrees: Array) -> Complex:
    return np.asarray(np.exp(1j * np.radians(degrees)))


def _degrees(z: complex) -> float:
    return math.degrees(math.atan2(z.imag, z.real))


def random_case(rng: np.random.Generator, family: str, near: float | None, step: int) -> Case:
    make = {
        "four-bar": _four_bar,
        "slider-crank": _slider_crank,
        "inverted": _inverted,
        "Stephenson": _stephenson,
        "Watt": _watt,
        "triad": _triad,
    }[family]
    while True:
        case = make(rng, near, step)
        if case is not None:
            return case


def _bars(rng: np.random.Generator, near: float | None) -> tuple[float, float, float, float]:
    """Ground, crank, coupler, rocker: three in four turn fully; ``near`` a change point."""
    r = rng.uniform(0.3, 3.0, 4)
    if near is None and rng.random() < 0.25:
        return float(r[0]), float(r[1]), float(r[2]), float(r[3])
    r.sort()
    crank, others = float(r[0]), [float(x) for x in r[1:]]
    gap = near if near is not None else float(rng.uniform(0.05, 0.5))
    others[2] = others[0] + others[1] - crank - gap  # shortest + longest = the others - gap
    rng.shuffle(others)
    return others[0], crank, others[1], others[2]


_TEXT_FOUR_BAR = "b*e^(i*t) + c*e^(i*p) = a + d*e^(i*q)"


def _built(
    rng: np.random.Generator,
    loops: dict[str, str],
    dimensions: dict[str, float],
    exact: ClosedForm,
    dyads: int,
    unknowns: Callable[[Complex, float], dict[str, float]],
    joints: Callable[[dict[str, Array], Array], Complex],
    step: int,
    near: float | None = None,
) -> Case | None:
    """A mechanism that starts at a random angle on random branches, if there is a position."""
    theta = float(rng.uniform(0, 2 * math.pi))
    signs = tuple(int(s) for s in rng.choice([-1, 1], dyads))
    place = exact(np.array([theta]), signs)[0]
    if not np.isfinite(place).all():
        return None
    # starts are not themselves at a singular position
    for k in range(dyads):
        flipped = tuple(-s if j == k else s for j, s in enumerate(signs))
        if not np.abs(exact(np.array([theta]), flipped)[0] - place).max() > 0.05:
            return None
    guess = {"t": math.degrees(theta)} | unknowns(place, theta)
    mechanism = lw.loops(
        loops=loops,
        dimensions=dimensions,
        guess=guess,
        inputs=lw.Input(variable="t", from_=0, to=360, step=step),
    )
    dense = exact(np.linspace(0, 2 * math.pi, 7201), signs)
    return Case(mechanism, joints, exact, signs, bool(np.isfinite(dense).all()))


def _four_bar(rng: np.random.Generator, near: float | None, step: int) -> Case | None:
    a, b, c, d = _bars(rng, near)

    def exact(theta: Array, signs: tuple[int, ...]) -> Complex:
        return _meet(b * np.exp(1j * theta), np.full(len(theta), a + 0j), c, d, signs[0])[:, None]

    def unknowns(place: Complex, theta: float) -> dict[str, float]:
        tip = complex(place[0])
        return {"p": _degrees(tip - b * np.exp(1j * theta)), "q": _degrees(tip - a)}

    def joints(values: dict[str, Array], theta: Array) -> Complex:
        return np.asarray((b * np.exp(1j * theta) + c * _cis(values["p"]))[:, None])

    return _built(
        rng,
        {"1": _TEXT_FOUR_BAR},
        {"a": a, "b": b, "c": c, "d": d},
        exact,
        1,
        unknowns,
        joints,
        step,
    )


def _slider_crank(rng: np.random.Generator, near: float | None, step: int) -> Case | None:
    b, e = float(rng.uniform(0.3, 2)), float(rng.uniform(-1, 1))
    extra = near if near is not None else float(rng.uniform(-0.5, 1.5))
    c = b + abs(e) + extra  # the rod just reaches for all angles where extra is positive
    if c < 0.2:
        return None

    def exact(theta: Array, signs: tuple[int, ...]) -> Complex:
        a = b * np.exp(1j * theta)
        up = e - a.imag
        with np.errstate(invalid="ignore"):
            along = np.sqrt((c - up) * (c + up))
        return np.asarray(a.real + signs[0] * along + 1j * e)[:, None]

    def unknowns(place: Complex, theta: float) -> dict[str, float]:
        tip = complex(place[0])
        return {"p": _degrees(tip - b * np.exp(1j * theta)), "s": tip.real}

    def joints(values: dict[str, Array], theta: Array) -> Complex:
        return np.asarray(values["s"] + 1j * e)[:, None]

    loops = {"1": "b*e^(i*t) + c*e^(i*p) = s + i*h"}
    return _built(rng, loops, {"b": b, "c": c, "h": e}, exact, 1, unknowns, joints, step)


def _inverted(rng: np.random.Generator, near: float | None, step: int) -> Case | None:
    """A slotted lever with an offset k: b e^(it) = a + (s + i k) e^(ip)."""
    b, k = float(rng.uniform(0.3, 2)), float(rng.uniform(-0.5, 0.5))
    extra = near if near is not None else float(rng.uniform(-0.3, 1.5))
    a = b + abs(k) + extra
    if a < 0.1:
        return None

    def exact(theta: Array, signs: tuple[int, ...]) -> Complex:
        arm = b * np.exp(1j * theta) - a
        with np.errstate(invalid="ignore"):
            s = signs[0] * np.sqrt((np.abs(arm) - k) * (np.abs(arm) + k))
            return np.stack([s + 0j, arm / (s + 1j * k)], axis=1)

    def unknowns(place: Complex, theta: float) -> dict[str, float]:
        return {"s": float(place[0].real), "p": _degrees(complex(place[1]))}

    def joints(values: dict[str, Array], theta: Array) -> Complex:
        return np.stack([values["s"] + 0j, _cis(values["p"])], axis=1)

    loops = {"1": "b*e^(i*t) = a + (s + i*k)*e^(i*p)"}
    return _built(rng, loops, {"a": a, "b": b, "k": k}, exact, 1, unknowns, joints, step)


def _second_dyad(
    rng: np.random.Generator, near: float | None, step: int, rider: str, text: str
) -> Case | None:
    """A four-bar and a dyad from a point of its link ``rider`` (p coupler, q rocker) to ground."""
    a, b, c, d = _bars(rng, near)
    u, v = rng.normal(size=2)
    ground = complex(*(2.5 * rng.normal(size=2)))
    m, n = (float(x) for x in rng.uniform(1.0, 4.0, 2))

    def exact(theta: Array, signs: tuple[int, ...]) -> Complex:
        crank = b * np.exp(1j * theta)
        tip = _meet(crank, np.full(len(theta), a + 0j), c, d, signs[0])
        own = (tip - crank) / c if rider == "p" else (tip - a) / d
        point = (crank if rider == "p" else a) + (u + 1j * v) * own
        last = _meet(point, np.full(len(theta), ground), m, n, signs[1])
        return np.stack([tip, last], axis=1)

    def unknowns(place: Complex, theta: float) -> dict[str, float]:
        crank, tip, last = b * np.exp(1j * theta), complex(place[0]), complex(place[1])
        own = (tip - crank) / c if rider == "p" else (tip - a) / d
        point = (crank if rider == "p" else a) + (u + 1j * v) * own
        return {
            "p": _degrees(tip - crank),
            "q": _degrees(tip - a),
            "x": _degrees(last - point),
            "y": _degrees(last - ground),
        }

    def joints(values: dict[str, Array], theta: Array) -> Complex:
        return np.stack(
            [a + d * _cis(values["q"]), ground + n * _cis(values["y"])],
            axis=1,
        )

    numbers = {"a": a, "b": b, "c": c, "d": d, "u": float(u), "v": float(v), "m": m, "n": n}
    numbers |= {"gx": ground.real, "gy": ground.imag}
    return _built(rng, {"1": _TEXT_FOUR_BAR, "2": text}, numbers, exact, 2, unknowns, joints, step)


def _stephenson(rng: np.random.Generator, near: float | None, step: int) -> Case | None:
    text = "b*e^(i*t) + (u + i*v)*e^(i*p) + m*e^(i*x) = gx + i*gy + n*e^(i*y)"
    return _second_dyad(rng, near, step, "p", text)


def _watt(rng: np.random.Generator, near: float | None, step: int) -> Case | None:
    text = "a + (u + i*v)*e^(i*q) + m*e^(i*x) = gx + i*gy + n*e^(i*y)"
    return _second_dyad(rng, near, step, "q", text)


def _triad(rng: np.random.Generator, near: float | None, step: int) -> Case | None:
    """A ternary link on three legs, one of them the crank's: four unknowns at once."""
    z = rng.normal(size=(6, 2)) @ np.array([1, 1j])
    theta = rng.uniform(0, 2 * math.pi)
    angle = rng.uniform(-math.pi, math.pi, 4)
    e, crank = np.exp(1j * angle), 0.25 * np.exp(1j * theta)
    # crank + w e0 = g + z0 e1,  crank + w e0 + z1 e2 = h + z2 e3, e0 turns with the ternary link
    first = crank + abs(z[0]) * e[0] + 2 * z[1] * e[2]
    second = crank + abs(z[0]) * e[0] + 2 * z[2] * e[2]
    g, h = first - 2 * e[1], second - 2 * e[3]
    numbers = {"r": 0.25, "w": float(abs(z[0]))}
    for name, value in (("j", 2 * z[1]), ("k", 2 * z[2]), ("g", g), ("h", h)):
        numbers |= {f"{name}1": float(value.real), f"{name}2": float(value.imag)}
    start = "r*e^(i*t) + w*e^(i*p)"
    names = ("p", "q", "x", "y")
    mechanism = lw.loops(
        loops={
            "1": f"{start} + (j1 + i*j2)*e^(i*x) = g1 + i*g2 + 2*e^(i*q)",
            "2": f"{start} + (k1 + i*k2)*e^(i*x) = h1 + i*h2 + 2*e^(i*y)",
        },
        dimensions=numbers,
        guess={"t": math.degrees(theta)}
        | dict(zip(names, np.degrees(angle).tolist(), strict=True)),
        inputs=lw.Input(variable="t", from_=0, to=360, step=step),
    )

    def joints(values: dict[str, Array], theta: Array) -> Complex:
        return np.stack([_cis(values[name]) for name in names], axis=1)

    case = Case(mechanism, joints, None, (), False)
    motion = mechanism.sweep()
    return case if (motion.certified & motion.asked).any() else None
