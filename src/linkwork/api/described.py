"""Described mechanisms: equations, and copies with other numbers or inputs."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Self

from linkwork.core import equations as closure, motion, textfile
from linkwork.core.foundation.errors import InputError, MechanismError, internal
from linkwork.core.foundation.values import as_told
from linkwork.core.mechanism.description import Description, made_of, merged
from linkwork.core.mechanism.dimensions import Number
from linkwork.core.mechanism.inputs import Input
from linkwork.core.mechanism.varied_numbers import numbers_named, with_numbers

if TYPE_CHECKING:
    from linkwork.core.results.check import CheckReport, Inversion

__all__ = ["DescribedMechanism"]


@internal("loop_equations")
class DescribedMechanism:
    """The part of :class:`~linkwork.api.mechanism.Mechanism` that needs no position.

    Raises
    ------
    MechanismError
        If the equations cannot be derived, or do not determine the motion.
    """

    def __init__(self, description: Description, read: textfile.ReadFile | None = None) -> None:
        self.description, self._read = description, read
        try:
            self.model = motion.as_described(description)
        except MechanismError as error:
            if read is None:
                raise
            raise read.located(error) from None

    def __eq__(self, other: object) -> bool:
        return isinstance(other, DescribedMechanism) and self.description == other.description

    def __hash__(self) -> int:
        return hash((type(self.description), self.description.name))

    def __repr__(self) -> str:
        equations = self.model.equations
        inputs = ", ".join(v.name for v in equations.inputs) or "nothing"
        count = len(equations.labels)
        what = "equation" if count == 1 else "equations"
        return (
            f'<Mechanism "{self.description.name}": {count} {what} for '
            f"{', '.join(v.name for v in equations.unknowns)}; driven by {inputs}>"
        )

    @property
    def name(self) -> str:
        """The name of the mechanism."""
        return self.description.name

    @property
    def loop_equations(self) -> closure.LoopEquations:
        """The closure equations as symbols."""
        return self.model.equations

    def with_dimensions(
        self, changes: Mapping[str, Number] | None = None, /, **more: Number
    ) -> Self:
        """A copy with other values of dimensions, lengths and all other numbers of the description.

        Parameters
        ----------
        changes : Mapping[str, number or formula], optional
            New values by name, in the unit of the file: the names that a family varies, as
            ``"O2 A"``, ``"O4.x"`` or ``"s16.offset"``.
        **more : number or formula
            The same, for names that Python can write.

        Raises
        ------
        UnknownNameError
            If there is no such number.
        InputError
            If a number is given twice.

        Examples
        --------
        >>> import linkwork as lw
        >>> lw.example("crank-shaper").with_dimensions(r=50).description.dimensions["r"]
        50
        >>> lw.example("four-bar").with_dimensions({"O2 A": 38}).description.lengths["O2 A"]
        38
        """
        if changes is not None and not isinstance(changes, Mapping):
            raise InputError(
                'dimensions are given by name, as with_dimensions({"O2 A": 38}) or '
                f"with_dimensions(r=50), got {as_told(changes)}"
            )
        numbers = numbers_named(self.description, [*(changes or {}).items(), *more.items()])
        return type(self)(with_numbers(self.description, numbers))

    def changed(self, **parts: Any) -> Self:
        """A copy with other parts of the description.

        Parameters
        ----------
        **parts
            Fields of the description, as in :func:`linkage` or :func:`loops`: ``points``,
            ``lengths``, ``guess``, … Entries of such tables join those that exist, ``None`` removes
            the one of its name, an empty table all; lists replace lists.

        Raises
        ------
        UnknownNameError
            For a field, or an entry to be removed, that does not exist.
        MechanismError
            With every problem found.

        Examples
        --------
        >>> import linkwork as lw
        >>> longer = lw.example("four-bar").changed(lengths={"O2 A": 42})
        >>> dict(longer.description.lengths)
        {'O2 A': 42, 'A B': 120, 'O4 B': 80, 'O2 O4': 100}
        >>> round(longer.solve(at=60)["rocker"], 3)
        63.482
        """
        return type(self)(replace(self.description, **merged(self.description, parts)))

    def inversion(self, link: str, *, input: Input | None = None) -> Self:
        """The same kinematic chain with another link as ground; the old ground becomes ``frame``.

        Parameters
        ----------
        link : str
            The link that becomes the ground.
        input : Input, optional
            The new input; by default the same relative angle or length as before.

        Raises
        ------
        UnknownNameError
            If the link does not exist.
        InputError
            If the link cannot be the ground.

        Examples
        --------
        >>> import linkwork as lw
        >>> lw.example("four-bar").inversion("coupler").name
        'Four-bar linkage, open, coupler fixed'
        """
        return type(self)(motion.inversion(self.model, link, input))

    def inversions(self) -> tuple[Inversion, ...]:
        """All inversions of the chain, each with its type.

        Examples
        --------
        >>> import linkwork as lw
        >>> [inversion.type.split(":")[0] for inversion in lw.example("four-bar").inversions()][:2]
        ['crank-rocker (GCRR)', 'double-crank (GCCC)']
        """
        return motion.inversions(self.model)

    def driven_by(self, **what: Any) -> Self:
        """A copy with another input.

        Parameters
        ----------
        **what
            Fields of :class:`linkwork.Input`: ``link="rocker"``, ``start=0``, …

        Examples
        --------
        >>> import linkwork as lw
        >>> lw.example("four-bar").driven_by(link="rocker")
        <Mechanism "Four-bar linkage, open": 1 equation for crank, coupler; driven by rocker>
        """
        return type(self)(motion.driven_otherwise(self.model, made_of(Input, what)))

    def check(self) -> CheckReport:
        """How the mechanism was read: equations, unknowns, blocks, mobility, start.

        Examples
        --------
        >>> import linkwork as lw
        >>> print(lw.example("four-bar").check().classification.type)
        crank-rocker (GCRR): Grashof, s + l < p + q by 20 mm
        """
        return motion.check(self.model)

    def equations(self) -> closure.EquationSheet:
        """The loop equations and their Jacobian as text, LaTeX or MathML.

        Examples
        --------
        >>> import linkwork as lw
        >>> print(lw.example("four-bar").equations().text().splitlines()[0])
        unknowns  θ_coupler (angle), θ_rocker (angle)
        """
        return closure.EquationSheet(self.model.equations)
