"""Masses, gravity and units of force of a mechanism with links."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass

from linkwork.core.foundation.containers import FrozenDict
from linkwork.core.foundation.errors import ExpressionError, InputError, undefined
from linkwork.core.foundation.names import GROUND, canonical
from linkwork.core.foundation.units import FORCES, LENGTHS, MASSES
from linkwork.core.foundation.values import as_told
from linkwork.core.mechanism.description import Description, Problems, check_entries
from linkwork.core.mechanism.dimensions import LARGEST
from linkwork.core.mechanism.machine import Gravity, Mass, Stop


@dataclass(frozen=True, kw_only=True)
class LoadedBodies(Description):
    """A description whose links may have masses.

    Parameters
    ----------
    mass, force : str
        Units of masses and forces: kg, g, t, lb, slug; N, kN, lbf.
    gravity : Gravity, optional
        None unless given.
    masses : Mapping[str, Mass]
        By link.
    stops : tuple of Stop
        Bounds of quantities in simulations.
    """

    mass: str = "kg"
    force: str = "N"
    gravity: Gravity | None = None
    masses: Mapping[str, Mass] = FrozenDict()
    stops: tuple[Stop, ...] = ()

    def __post_init__(self) -> None:
        super().__post_init__()
        given: object = self.gravity
        if given is not None and not isinstance(given, Gravity):
            raise InputError(f"gravity must be lw.Gravity(…), got {as_told(given)}")
        check_entries("masses", Mass, self.masses.values())
        check_entries("stops", Stop, self.stops)

    @property
    def carried(self) -> Mapping[str, tuple[str, ...]]:
        """The points of every link."""
        raise NotImplementedError

    @property
    def placed(self) -> Iterable[str]:
        """The names of all points."""
        raise NotImplementedError

    @property
    def turning_on_one_point(self) -> frozenset[str]:
        """Links of one point that have a direction all the same."""
        return frozenset()

    @property
    def loaded(self) -> bool:
        """Whether anything loads the mechanism."""
        return bool(self.masses)

    def spelled_masses(self) -> FrozenDict[str, Mass]:
        """The masses under the names of the links."""
        spelled = {canonical(link): link for link in self.carried}
        return FrozenDict(
            {spelled.get(canonical(link), link): mass for link, mass in self.masses.items()}
        )


def check_masses(loaded: LoadedBodies, problems: Problems) -> None:
    """Report unknown units, masses of what is no link, and wrong numbers."""
    for name, unit, known in (("mass", loaded.mass, MASSES), ("force", loaded.force, FORCES)):
        if unit not in known:
            problems.add((name,), f'"{unit}" is not a known unit ({", ".join(known)})')
    if loaded.masses and loaded.length not in LENGTHS:
        message = f"masses need a known unit of length ({', '.join(LENGTHS)})"
        problems.add(("length",), f'"{loaded.length}" cannot be converted: {message}')
    _check_gravity(loaded, problems)
    for k, stop in enumerate(loaded.stops):
        for field, message in stop.mistakes(loaded.numbers):
            problems.add(("stops", k, field), message)
    for link, mass in loaded.masses.items():
        key = ("masses", link)
        if link not in loaded.carried:
            known_links = [name for name in loaded.carried if name != GROUND]
            problems.add(key, undefined("link", link, known_links))
            continue
        if link == GROUND:
            problems.add(key, "is fixed: its mass has no effect, remove it")
        for field, message in _mistakes(loaded, link, mass):
            problems.add((*key, field), message)
        for field in ("mass", "inertia"):
            amount = loaded.numbers.check_amount(problems.add, (*key, field), getattr(mass, field))
            if amount < 0:
                problems.add((*key, field), f"must not be negative, got {amount:g}")
        for k, number in enumerate(mass.center or ()):
            loaded.numbers.check_amount(problems.add, (*key, "center", k), number)


def _check_gravity(loaded: LoadedBodies, problems: Problems) -> None:
    if loaded.gravity is None:
        return
    try:
        size = loaded.gravity.acceleration(loaded.numbers, loaded.length)
        if abs(size) > LARGEST:
            problems.add(("gravity", "size"), f"{size:g} is too large: at most {LARGEST:g}")
    except ExpressionError as error:
        problems.add(("gravity", "size"), error.message)
    if loaded.gravity.angle is not None:
        loaded.numbers.check_number(problems.add, ("gravity", "angle"), loaded.gravity.angle)


def _mistakes(loaded: LoadedBodies, link: str, mass: Mass) -> Iterator[tuple[str, str]]:
    """Keys that contradict each other or are missing."""
    count = len(loaded.carried[link])
    if mass.shape is not None:
        if mass.shape != "rod":
            yield "shape", f'must be "rod", got "{mass.shape}"'
        if mass.center is not None or mass.inertia != 0:
            yield "shape", "gives centre and inertia: leave them out, or the shape"
        if count < 2:
            yield "shape", f'a rod needs two points, "{link}" has only {count}'
    elif mass.center is None and count != 1:
        yield "center", 'is missing: write center = [x, y], or shape = "rod"'
    elif mass.center in (None, (0, 0)) or count > 1:
        return
    elif link not in loaded.turning_on_one_point:
        yield "center", f'"{link}" has only one point and no direction: leave the centre there'
