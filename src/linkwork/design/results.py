"""Results for designers of machines: flywheels, motors, harmonics, counterweights, curvature."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from linkwork import wings
from linkwork.core.foundation.arrays import Array, read_only
from linkwork.core.foundation.errors import internal
from linkwork.core.results.tables import Summary

_NONE = 1e-12  # of a quantity: rounding


@internal("summary")
class Summarized:
    """A result with a summary, for terminals and notebooks."""

    @property
    def summary(self) -> Summary:
        """A title and rows of text."""
        raise NotImplementedError

    def __repr__(self) -> str:
        return str(self.summary)

    def _repr_html_(self) -> str:
        """A short table, for notebooks."""
        return wings.use("app.pages.notebook").summary_html(self.summary)


@dataclass(frozen=True, kw_only=True, repr=False)
class Flywheel(Summarized):
    """The inertia that keeps the speed of an input even.

    Parameters
    ----------
    fluctuation : float
        (ω_max - ω_min) / ω_mean.
    mean : float
        The mean effort [force · length], which the motor gives.
    energy : float
        The largest fluctuation of the energy over a turn [force · length].
    inertia : float
        Of flywheel and motor about the input [mass · length²].
    slowest, fastest : float
        Input values at which the input turns slowest and fastest [file unit].
    units : Mapping[str, str]
        Of ``mean``, ``energy``, ``inertia`` and of the input.

    Examples
    --------
    >>> import linkwork as lw
    >>> wheel = lw.design.flywheel(lw.example("crank-press"), 0.05)
    >>> round(wheel.energy), wheel.units["inertia"]
    (339390, 'kg·mm²')
    """

    fluctuation: float
    mean: float
    energy: float
    inertia: float
    slowest: float
    fastest: float
    units: Mapping[str, str]

    @property
    def summary(self) -> Summary:
        """A title and rows of text."""
        unit = self.units
        rows = (
            ("mean", f"{self.mean:.6g} {unit['mean']}"),
            ("energy", f"{self.energy:.6g} {unit['energy']}"),
            ("inertia", f"{self.inertia:.6g} {unit['inertia']}"),
            ("slowest", f"at {self.slowest:.6g} {unit['input']}"),
            ("fastest", f"at {self.fastest:.6g} {unit['input']}"),
        )
        return Summary(f"Flywheel for a fluctuation of {self.fluctuation:g}", rows)


@dataclass(frozen=True, kw_only=True, repr=False)
class MotorCheck(Summarized):
    """A motor against the effort of an input at constant speed.

    Parameters
    ----------
    peak, rms, mean : float
        Of the effort over a turn, or the whole time of a law; of the peak the size.
    peak_at : float
        The input value of the peak; its time under a law.
    available : float
        What the motor gives at the input's speed there, on the line from ``stall`` to
        ``free_speed``.
    reserve : float
        The least that the motor gives beyond the size of the effort; negative if it is too weak.
    rated : float, optional
        What it gives without end.
    power : float
        The largest power that the input takes.
    units : Mapping[str, str]
        Of effort, power and input.

    Examples
    --------
    >>> import linkwork as lw
    >>> motor = lw.design.motor_check(lw.example("crank-press"), stall=2e6, free_speed="1500 rpm")
    >>> motor.fits, round(motor.available)
    (True, 1840000)
    """

    peak: float
    peak_at: float
    rms: float
    mean: float
    available: float
    reserve: float
    rated: float | None
    power: float
    units: Mapping[str, str]

    @property
    def fits(self) -> bool:
        """Whether the effort is available everywhere, and its root mean square within the rated."""
        enough = self.reserve >= -_NONE * self.peak
        return enough and (self.rated is None or self.rms <= self.rated)

    @property
    def summary(self) -> Summary:
        """A title and rows of text."""
        effort = self.units["effort"]
        rated = [] if self.rated is None else [("rated", f"{self.rated:.6g} {effort}")]
        rows = [
            ("peak", f"{self.peak:.6g} {effort} at {self.peak_at:.6g} {self.units['input']}"),
            ("available", f"{self.available:.6g} {effort} at this speed"),
            ("reserve", f"{self.reserve:.6g} {effort} at least"),
            ("rms", f"{self.rms:.6g} {effort}"),
            *rated,
            ("mean", f"{self.mean:.6g} {effort}"),
            ("power", f"at most {self.power:.6g} {self.units['power']}"),
        ]
        return Summary(f"The motor {'fits' if self.fits else 'is too weak'}", tuple(rows))


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Harmonics(Summarized):
    """The Fourier sum of a quantity over a turn: mean + Σ a_k cos(k (φ - φ_k)).

    Parameters
    ----------
    of, unit : str
        The quantity.
    mean : float
    amplitude : (K,)
        a_k for k = 1, 2, … [unit].
    phase : (K,)
        φ_k, the input value of the first maximum [degrees], from 0 to 360 / k.
    rest : float
        The largest difference of a row from the sum.

    Examples
    --------
    >>> import linkwork as lw
    >>> found = lw.design.harmonics(lw.example("crank-press"), "shaking.y", 2)
    >>> found.amplitude.round(1)
    array([4584.2, 4489.6])
    """

    of: str
    unit: str
    mean: float
    amplitude: Array
    phase: Array
    rest: float

    def __post_init__(self) -> None:
        for name in ("amplitude", "phase"):
            object.__setattr__(self, name, read_only(getattr(self, name)))

    @property
    def summary(self) -> Summary:
        """A title and rows of text."""
        rows = [("mean", f"{self.mean:.6g} {self.unit}")]
        size = abs(self.mean) + float(np.max(self.amplitude, initial=0.0))
        for k, (a, phase) in enumerate(zip(self.amplitude, self.phase, strict=True), start=1):
            # the phase of rounding errors means nothing
            some = f"{a:.6g} {self.unit}, largest at {phase:.5g} deg"
            rows.append((f"order {k}", some if a > _NONE * size else "none"))
        rows.append(("rest", f"at most {self.rest:.3g} {self.unit}"))
        return Summary(f"Harmonics of {self.of}", tuple(rows))


@dataclass(frozen=True, kw_only=True)
class Counterweight:
    """A point mass on a link.

    Parameters
    ----------
    link : str
    product : float
        Mass times distance from the pin on ground [mass · length].
    angle : float
        Its direction from the link's x axis [degrees].
    mass : float
    place : (float, float)
        In the frame of the link [length].

    Examples
    --------
    >>> import linkwork as lw
    >>> bar = lw.example("four-bar").changed(masses={"coupler": lw.Mass(mass=2, shape="rod")})
    >>> [weight.link for weight in lw.design.counterweights(bar, radius=20).weights]
    ['crank', 'rocker']
    """

    link: str
    product: float
    angle: float
    mass: float
    place: tuple[float, float]


@dataclass(frozen=True, kw_only=True, repr=False)
class Counterweights(Summarized):
    """Two counterweights that remove the shaking force of a four-bar.

    Parameters
    ----------
    weights : tuple of Counterweight
    force, moment : (float, float)
        The largest shaking force and moment of the masses over the table, before and after.
    units : Mapping[str, str]
        Of mass, product, force and moment.

    Examples
    --------
    >>> import linkwork as lw
    >>> bar = lw.example("four-bar").changed(masses={"coupler": lw.Mass(mass=2, shape="rod")})
    >>> balanced = lw.design.counterweights(bar, radius=20)
    >>> balanced.force[1] < 1e-12 * balanced.force[0]
    True
    """

    weights: tuple[Counterweight, ...]
    force: tuple[float, float]
    moment: tuple[float, float]
    units: Mapping[str, str]

    @property
    def summary(self) -> Summary:
        """A title and rows of text."""
        mass, product = self.units["mass"], self.units["product"]
        rows = [
            (w.link, f"{w.mass:.6g} {mass} ({w.product:.6g} {product} at {w.angle:.5g} deg)")
            for w in self.weights
        ]
        for name in ("force", "moment"):
            before, after = getattr(self, name)
            rows.append((f"shaking {name}", f"{before:.6g} to {after:.3g} {self.units[name]}"))
        return Summary("Counterweights", tuple(rows))


@dataclass(frozen=True, kw_only=True, repr=False)
class InflectionCircle(Summarized):
    """The points of a link whose paths have no curvature at a position.

    Parameters
    ----------
    link : str
    pole : (float, float)
        The instant centre, on the circle [length].
    inflection_pole : (float, float)
        The opposite point, which has no acceleration at constant angular velocity.
    unit : str

    Examples
    --------
    >>> import linkwork as lw
    >>> circle = lw.design.inflection_circle(lw.example("elliptic-trammel"), at=40)
    >>> round(circle.diameter, 6)  # the length of the rod
    30.0
    """

    link: str
    pole: tuple[float, float]
    inflection_pole: tuple[float, float]
    unit: str

    @property
    def center(self) -> tuple[float, float]:
        """The centre of the circle."""
        (a, b), (c, d) = self.pole, self.inflection_pole
        return (a + c) / 2.0, (b + d) / 2.0

    @property
    def diameter(self) -> float:
        """Its diameter."""
        return float(np.hypot(*np.subtract(self.inflection_pole, self.pole)))

    @property
    def summary(self) -> Summary:
        """A title and rows of text."""
        places = [
            (name, f"{place[0]:.7g}, {place[1]:.7g}")
            for name, place in (
                ("pole", self.pole), ("inflection pole", self.inflection_pole),
                ("center", self.center),
            )
        ]  # fmt: skip
        rows = (*places, ("diameter", f"{self.diameter:.7g} {self.unit}"))
        return Summary(f"Inflection circle of {self.link}", rows)
