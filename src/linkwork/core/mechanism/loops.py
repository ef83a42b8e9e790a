"""Forms B and C: a mechanism described by its loop equations, or by plain equations."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import partial

from linkwork.core.foundation.arrays import FrozenDict
from linkwork.core.foundation.errors import choices, undefined
from linkwork.core.foundation.names import canonical
from linkwork.core.mechanism.description import Description, Key, Problems, check_entries, declared
from linkwork.core.mechanism.dimensions import Number
from linkwork.core.mechanism.machine import LoadedBodies, check_masses
from linkwork.core.mechanism.part.springs import Load


@dataclass(frozen=True, kw_only=True)
class _Equations(Description):
    """The common base of both forms: unknowns with a guess, one or more input variables."""

    guess: Mapping[str, Number] = FrozenDict()

    def _check_guess(self, problems: Problems) -> None:
        for name, number in self.guess.items():
            self.numbers.check_number(problems.add, ("guess", name), number)
        known = {canonical(name) for name in self.guess}
        driven: set[str] = set()
        for k, which in enumerate(self.inputs):
            key = self.input_key(k)
            kind, name = which.drives
            if kind != "variable" or which.relative_to is not None:
                problems.add(key, 'must name only a variable of the equations: variable = "…"')
                continue
            if canonical(name) not in known:
                problems.add(
                    ("guess",),
                    f'has no value for the input "{name}" {choices("guesses", self.guess, name)}',
                )
            elif canonical(name) in driven:
                problems.add((*key, "variable"), f'drives "{name}" a second time')
            driven.add(canonical(name))


@dataclass(frozen=True, kw_only=True)
class Loops(_Equations, LoadedBodies):
    """Vector loop-closure equations in textbook notation.

    Parameters
    ----------
    loops : Mapping[str, str]
        Complex equations by label: ``"a2*e^(i*θ12) + a3*e^(i*θ13) = d + a4*e^(i*θ14)"``.
        Angles are in exponents, variable lengths are factors; other names are dimensions.
    guess : Mapping[str, number]
        Estimates of all unknowns at one input value.
    points : Mapping[str, str], optional
        Points as formulas of the same kind, for drawings.
    links : Mapping[str, sequence of str], optional
        Points drawn as one link; ``ground`` is fixed.
    mass, force, gravity, masses
        Units of masses and forces, gravity, and the masses of links; see
        :class:`~linkwork.core.mechanism.machine.LoadedBodies`.
    loads : tuple of Load
        Forces on points, torques on links.
    """

    loops: Mapping[str, str] = FrozenDict()
    points: Mapping[str, str] = FrozenDict()
    links: Mapping[str, tuple[str, ...]] = FrozenDict()
    loads: tuple[Load, ...] = ()

    def __post_init__(self) -> None:
        super().__post_init__()
        set_ = object.__setattr__
        spelled = {canonical(name): name for name in self.points}

        def same(name: str) -> str:
            return spelled.get(canonical(name), name)

        links = {name: tuple(map(same, points)) for name, points in self.links.items()}
        set_(self, "links", FrozenDict(links))
        set_(self, "masses", self.spelled_masses())
        check_entries("loads", Load, self.loads)
        named = spelled | {canonical(name): name for name in self.links}

        def same_in_loads(name: str) -> str:
            return named.get(canonical(name), name)

        set_(self, "loads", tuple(load.find_spelling(same_in_loads) for load in self.loads))
        set_(self, "trace", tuple(map(same, self.trace)))
        problems = Problems()
        self.check_common(
            problems,
            [
                *declared("points", self.points),
                *declared("links", self.links),
                *declared("guess", self.guess),
            ],
        )
        self._check_guess(problems)
        if not self.loops:
            problems.add(("loops",), "is empty: write at least one loop equation")
        for link, points in self.links.items():
            for point in points:
                if point not in self.points:
                    problems.add(("links", link), undefined("point", point, self.points))
        for k, point in enumerate(self.trace):
            if point not in self.points:
                problems.add(("trace", "points", k), undefined("point", point, self.points))
        check_masses(self, problems)
        for k, load in enumerate(self.loads):
            load.check_in(self, partial(_add, problems, ("loads", k)))
        self._check_turning(problems)
        problems.raise_any(f'mechanism "{self.name}"')

    def _check_turning(self, problems: Problems) -> None:
        """Report what needs the rotation of a link of one point, which loops do not tell."""
        single = {link for link, points in self.links.items() if len(points) == 1}
        remedy = "has only one point, so that its rotation is not known: give it a second one"
        for link, mass in self.masses.items():
            if link in single and mass.inertia != 0:
                problems.add(("masses", link, "inertia"), f'"{link}" {remedy}, or leave it out')
        for k, load in enumerate(self.loads):
            for field, name in (("link", load.link), ("with", load.turns_with)):
                if name in single and (field == "with" or load.torque is not None):
                    problems.add(("loads", k, field), f'"{name}" {remedy}')

    @property
    def carried(self) -> Mapping[str, tuple[str, ...]]:
        return self.links

    @property
    def placed(self) -> Iterable[str]:
        return self.points

    @property
    def loaded(self) -> bool:
        return bool(self.masses or self.loads)


def _add(problems: Problems, key: Key, message: str, *field: str | int) -> None:
    problems.add((*key, *field), message)


@dataclass(frozen=True, kw_only=True)
class PlainEquations(_Equations):
    """Plain real equations in named unknowns: Newton-Raphson for any small system.

    Parameters
    ----------
    equations : Mapping[str, str]
        Real equations by label: ``"x^3 - 2*x + 2 = 0"``.
    guess : Mapping[str, number]
        Estimates of all unknowns, and the value of each input.
    """

    equations: Mapping[str, str] = FrozenDict()

    def __post_init__(self) -> None:
        super().__post_init__()
        problems = Problems()
        self.check_common(problems, declared("guess", self.guess))
        self._check_guess(problems)
        if not self.equations:
            problems.add(("equations",), "is empty: write at least one equation")
        if self.trace:
            problems.add(("trace",), "plain equations have no points to trace")
        problems.raise_any(f'mechanism "{self.name}"')
