"""Extremes of random four-bars and slider-cranks against closed forms, at steps of 1 to 10 degrees.

The referee evaluates the closed form at 4,000 inputs and closes in on the best of them. Efforts,
forces and accelerations are compared with those of a table sixty times finer.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

import linkwork as lw

__all__ = ["extreme_campaign", "highest"]

Array = npt.NDArray[np.float64]
Form = Callable[[Array], Array]

_EQUAL = 1e-10  # of the range of values
_FINER = 60
_STEPS = (1.0, 2.0, 5.0, 10.0)
_LOADED = ("crank.effort", "A.force.x", "coupler.acceleration")
_POINTS, _PEAKS, _ZOOMS = 4000, 3, 5


def extreme_campaign(part: int, size: int) -> tuple[Counter[str], list[str]]:
    """Some random mechanisms, each in a table of its own."""
    counts: Counter[str] = Counter()
    false = []
    for number in range(part * size, (part + 1) * size):
        rng = np.random.default_rng([40, number])
        step = float(rng.choice(_STEPS))
        start = float(rng.integers(0, 360))
        span = 360.0 if rng.random() < 0.5 else step * int(rng.integers(4, int(340.0 / step)))
        case = (_four_bar if rng.random() < 0.6 else _slider_crank)(
            rng, (start, start + span, step)
        )
        false += [f"number {number}, step {step:g}: {name}" for name in _wrong(case, counts)]
    return counts, false


def highest(form: Form, low: float, high: float) -> float:
    """The largest value of a smooth form between two inputs."""
    every = np.linspace(low, high, _POINTS)
    values, gap = form(every), every[1] - every[0]
    before, after = np.append(-np.inf, values[:-1]), np.append(values[1:], -np.inf)
    peaks = every[(values >= before) & (values >= after)]
    best = -np.inf
    # the highest of the points may be at an end, and the extreme elsewhere
    for peak in peaks[np.argsort(-form(peaks))][:_PEAKS]:
        here, away = peak, gap
        for _ in range(_ZOOMS):
            u = np.linspace(max(low, here - away), min(high, here + away), 101)
            here, away = u[form(u).argmax()], u[1] - u[0]
            best = max(best, float(form(u).max()))
    return best


@dataclass(frozen=True)
class _Case:
    """A mechanism with closed forms of quantities, and a length with its value."""

    mechanism: lw.Mechanism
    forms: Mapping[str, Form]
    table: tuple[float, float, float]
    varied: str
    length: float


def _wrong(case: _Case, counts: Counter[str]) -> list[str]:
    mechanism, forms, (start, stop, step) = case.mechanism, case.forms, case.table
    low, high = np.radians([start, stop]).tolist()
    motion, found = mechanism.sweep(), []
    # three equal designs: a lane has the same values whatever is next to it
    family = mechanism.family({case.varied: [case.length] * 3}).sweep()
    for name, form in forms.items():
        most, least = highest(form, low, high), -highest(lambda u: -form(u), low, high)  # noqa: B023
        expected = {"max": most, "min": least, "stroke": most - least}
        for word, value in expected.items():
            size = _EQUAL * max(most - least, abs(most), abs(least))
            counts["numbers"] += 1
            if not abs(motion.value(f"{word}({name})") - value) <= size:
                found.append(f"{word}({name}) = {motion.value(f'{word}({name})')!r}, not {value!r}")
            counts["numbers of designs"] += 1
            if not abs(family.value(f"{word}({name})")[1] - value) <= size:
                counts["numbers of designs with two extremes between rows"] += 1
    fine = mechanism.driven_by(
        link="crank", from_=start, to=stop, step=step / _FINER, speed="7 rad/s"
    ).sweep(certify=False)
    for name in _LOADED:
        for word in ("max", "min"):
            counts["loaded numbers"] += 1
            ours, other = (each.value(f"{word}({name})") for each in (motion, fine))
            if not abs(ours - other) <= _EQUAL * max(abs(other), np.nanmax(np.abs(fine[name]))):
                found.append(f"{word}({name}) = {ours!r}, not {other!r}")
    return found


def _four_bar(rng: np.random.Generator, table: tuple[float, float, float]) -> _Case:
    """A crank-rocker whose transmission angle stays 8 degrees from 0 and 180."""
    while True:
        a, b, c, d = 10.0, *rng.uniform(12.0, 40.0, 3)
        cosines = [(b**2 + c**2 - (d + s * a) ** 2) / (2.0 * b * c) for s in (-1.0, 1.0)]
        if max(map(abs, cosines)) < np.cos(np.radians(8.0)):
            break
    p = complex(*rng.uniform(-10.0, 40.0, 2))

    def places(u: Array) -> tuple[npt.NDArray[np.complex128], npt.NDArray[np.complex128]]:
        pin = a * np.exp(1j * u)
        away = d - pin
        size = np.abs(away)
        turn = np.arccos((size**2 + b**2 - c**2) / (2.0 * size * b))
        return pin, pin + b * away / size * np.exp(1j * turn)

    def transmission(u: Array) -> Array:
        pin, end = places(u)
        return np.asarray(np.degrees(np.abs(np.angle((pin - end) / (d - end)))))

    def rocker(u: Array) -> Array:
        return np.asarray(np.degrees(np.angle((places(u)[1] - d) / 1j)) + 90.0)

    def point(u: Array) -> npt.NDArray[np.complex128]:
        pin, end = places(u)
        return np.asarray(pin + p * (end - pin) / b)

    def ratio(u: Array) -> Array:
        pin, end = places(u)
        rod, arm = end - pin, end - d
        return np.asarray((1j * pin * rod.conj()).real / (1j * arm * rod.conj()).real)

    u0 = np.radians(np.array([table[0]]))
    pin, end = (complex(x[0]) for x in places(u0))
    mechanism = lw.linkage(
        length="mm",
        points={
            "O2": (0, 0), "A": (pin.real, pin.imag), "B": (end.real, end.imag), "O4": (d, 0),
            "P": (point(u0)[0].real, point(u0)[0].imag),
        },
        links={
            "ground": ["O2", "O4"], "crank": ["O2", "A"], "coupler": ["A", "B", "P"],
            "rocker": ["O4", "B"],
        },
        lengths={"O2 A": a, "A B": b, "O4 B": c},
        masses={"coupler": lw.Mass(mass=2.0, center=(0.4 * b, 3.0), inertia=90.0)},
        inputs=_input(table),
    )  # fmt: skip
    forms: dict[str, Form] = {
        "rocker": rocker, "B.transmission": transmission, "rocker.d1": ratio,
        "P.x": lambda u: point(u).real, "P.y": lambda u: point(u).imag,
    }  # fmt: skip
    return _Case(mechanism, forms, table, "O4 B", c)


def _slider_crank(rng: np.random.Generator, table: tuple[float, float, float]) -> _Case:
    """An offset slider-crank."""
    a, b = 10.0, float(rng.uniform(13.0, 50.0))
    e = float(rng.uniform(-0.8, 0.8)) * (b - a)

    def slide(u: Array) -> Array:
        return np.asarray(a * np.cos(u) + np.sqrt(b**2 - (e - a * np.sin(u)) ** 2))

    def rate(u: Array) -> Array:
        gap = e - a * np.sin(u)
        return np.asarray(-a * np.sin(u) + gap * a * np.cos(u) / np.sqrt(b**2 - gap**2))

    u0 = np.radians(table[0])
    mechanism = lw.linkage(
        length="mm",
        points={
            "O": (0, 0), "A": (a * np.cos(u0), a * np.sin(u0)), "B": (float(slide(u0)), e),
            "S": (0, e), "T": (50, e),
        },
        links={
            "ground": ["O", "S", "T"], "crank": ["O", "A"], "coupler": ["A", "B"], "block": ["B"],
        },
        lengths={"O A": a, "A B": b},
        sliders=[lw.Slider(name="d", link="block", points=("B",), on="ground", line=("S", "T"))],
        masses={"coupler": lw.Mass(mass=2.0, center=(0.4 * b, 1.0), inertia=90.0)},
        inputs=_input(table),
    )  # fmt: skip
    return _Case(mechanism, {"B.x": slide, "B.x.d1": rate}, table, "A B", b)


def _input(table: tuple[float, float, float]) -> lw.Input:
    start, stop, step = table
    return lw.Input(link="crank", from_=start, to=stop, step=step, speed="7 rad/s")
