"""A mechanism as free rigid bodies and pins, for programs of multibody dynamics."""

from __future__ import annotations

from dataclasses import dataclass

import linkwork as lw
from linkwork.core.mechanism.linkage import Linkage
from linkwork.core.mechanism.loops import Loops

__all__ = ["Bodies", "Body", "Pin", "Spring", "bodies_of"]


@dataclass(frozen=True, kw_only=True)
class Body:
    """A link: mass, inertia about its centre, and where it starts and how it moves [SI, rad]."""

    mass: float
    inertia: float
    center: complex
    velocity: complex
    rate: float


@dataclass(frozen=True, kw_only=True)
class Pin:
    """A point of two bodies: their numbers, None for the ground, and its place at the start."""

    first: int | None
    second: int
    at: complex


@dataclass(frozen=True, kw_only=True)
class Spring:
    """A spring from a fixed point to a point of a body at the start [N/m, m]."""

    fixed: complex
    body: int
    at: complex
    stiffness: float
    free: float


@dataclass(frozen=True, kw_only=True)
class Bodies:
    """All of them; the first body leads, with a constant torque on it [N·m]."""

    bodies: tuple[Body, ...]
    pins: tuple[Pin, ...]
    weight: float  # m/s², along -y
    torque: float = 0.0
    springs: tuple[Spring, ...] = ()


def bodies_of(mechanism: lw.Mechanism, *, speed: float = 0.0, torque: float = 0.0) -> Bodies:
    """The bodies where they are sketched, ``speed``: of the input [rad/s].

    Links with masses, pins between them and the ground, and gravity are taken over; loads and
    springs are not, because each program has its own forms of them.
    """
    given = mechanism.description
    assert isinstance(given, Linkage | Loops)
    place = mechanism.solve()
    points = {name: complex(place.place(name).v) for name in place.points}
    moving = {name: speed * complex(place.place(name).d1) for name in place.points}
    numbers = {link: k for k, link in enumerate(given.masses)}
    bodies = []
    for link, mass in given.masses.items():
        first, second = given.links[link][:2]
        span, drift = points[second] - points[first], moving[second] - moving[first]
        rate = (drift / span).imag
        if mass.shape is None:
            x, y = (float(number) for number in mass.center or (0.0, 0.0))
            arm, inertia = complex(x, y) * span / abs(span), float(mass.inertia)
        else:
            arm, inertia = 0.5 * span, float(mass.mass) * abs(span) ** 2 / 12.0
        velocity = moving[first] + 1j * rate * arm
        bodies.append(
            Body(
                mass=float(mass.mass), inertia=inertia, center=points[first] + arm,
                velocity=velocity, rate=rate,
            )
        )  # fmt: skip
    pins = []
    for point, at in points.items():
        links = [link for link, own in given.links.items() if point in own]
        first = "ground" if "ground" in links else links[0]
        pins += [
            Pin(first=numbers.get(first), second=numbers[link], at=at)
            for link in links
            if link != first
        ]
    weight = 0.0 if given.gravity is None else 9.81
    return Bodies(bodies=tuple(bodies), pins=tuple(pins), weight=weight, torque=torque)
