"""Loads: forces on points and torques on links."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from linkwork.expression.grammar import CONSTANTS, parse
from linkwork.expression.real_values import check_real
from linkwork.expression.tree import constants_in
from linkwork.expression.values import value
from linkwork.foundation.errors import ExpressionError, choices
from linkwork.foundation.file_keys import Key, ListOf, Number as NumberKey
from linkwork.foundation.names import GROUND
from linkwork.mechanism.dimensions import LARGEST, Number
from linkwork.mechanism.loaded import LoadedBodies
from linkwork.mechanism.part.part import LINK, POINT, Part, PartChecks

__all__ = ["Load"]


@dataclass(frozen=True, kw_only=True)
class Load(Part):
    """A force on a point, or a torque on a link.

    Where several links share the point, the force acts on the pin itself unless a link is given.
    Formulas may contain the mechanism's quantities, their rates and the time ``t``, and
    comparisons, which are 1 or 0: ``"-500*(t < 0.1)"``. A load on ground moves nothing: with its
    opposite on a piston, as of the gas in an engine, it shakes nothing.

    Parameters
    ----------
    point : str, optional
        The point on which a force acts.
    force : (number, number), optional
        Its components along the axes of the ground, or of the link ``turns_with``.
    turns_with : str, optional
        The link in whose frame the components are given (``with`` in a file).
    link : str, optional
        The link on which a torque acts; for a force on a pin, the link at the pin that takes it.
    torque : number, optional
        Positive counter-clockwise [force · length].

    Examples
    --------
    >>> import linkwork as lw
    >>> lw.Load(point="P", force=(0, "-500*(t < 0.1)")).force
    (0, '-500*(t < 0.1)')
    """

    title = "Load"
    doc = "A force on a point, or a torque on a link"
    keys = (
        Key("point", POINT, "The point on which a force acts"),
        Key("force", ListOf(NumberKey(), "component", 2, 2), "Its components, or formulas of them"),
        Key("with", LINK, "The link with which the force turns", field="turns_with"),
        Key("link", LINK, "The link on which a torque acts, or that takes a force on a pin"),
        Key("torque", NumberKey("length"), "The torque, or a formula; positive counter-clockwise"),
    )

    point: str | None = None
    force: tuple[Number, ...] | None = None
    turns_with: str | None = None
    link: str | None = None
    torque: Number | None = None

    @property
    def acts(self) -> bool:
        return True

    @property
    def label(self) -> str:
        return f"load on {self.point or self.link}"

    def check(self, checks: PartChecks) -> None:
        self.check_in(checks.linkage, checks.add)

    def check_in(self, loaded: LoadedBodies, add: Callable[..., None]) -> None:
        """Report the problems of the load on a mechanism; ``add`` takes a message and a field."""
        if (self.force is None) == (self.torque is None):
            what = "both" if self.force is not None else "neither"
            add(f"needs either a force or a torque, it has {what}")
            return
        on, noun = ("point", "force") if self.torque is None else ("link", "torque")
        for field, given in (("point", self.point), ("with", self.turns_with)):
            if self.torque is not None and given is not None:
                add("is used with force only", field)
        if getattr(self, on) is None:
            add(f"is missing: the {on} on which the {noun} acts", on)
        named = [("point", self.point, loaded.placed)]
        named += [(key, own, loaded.carried) for key, own in
                  (("link", self.link), ("with", self.turns_with))]  # fmt: skip
        for field, name, known in named:
            if name is not None and name not in known:
                what = "point" if field == "point" else "link"
                add(f'{what} "{name}" is not defined {choices(f"{what}s", known, name)}', field)
        # beside a load on a moving link it may be that one's opposite, as of the gas in an engine
        others: tuple[Load, ...] = getattr(loaded, "loads", ())
        if all(load._on_ground(loaded) for load in (self, *others)):
            field, what = ("link", "") if self.link == GROUND else ("point", f"{self.point} ")
            add(f"{what}is fixed: the {noun} has no effect, remove it", field)
        if self.turns_with == GROUND:
            add("does not turn: leave it out, as the axes of ground are the default", "with")
        carried = loaded.carried.get(self.link or "", (self.point,))
        if self.force is not None and self.point not in carried:
            add(f'"{self.link}" does not carry {self.point}', "link")
        if self.force is not None and len(self.force) != 2:
            add(f"needs two components, got {len(self.force)}", "force")
        for key, number in self.formulas:
            if not isinstance(number, str):
                loaded.numbers.check_amount(lambda at, told: add(told, *at), key, number)
                continue
            try:
                tree = parse(number, comparing=True)
                check_real(tree, number, "a load")
                for part in constants_in(tree, loaded.numbers.known.keys() | CONSTANTS.keys()):
                    amount = value(part, loaded.numbers.known, loaded.angle, number)
                    if abs(amount) > LARGEST:
                        add(f"{amount:g} is too large: at most {LARGEST:g}", *key)
            except ExpressionError as error:
                add(str(error), *key)

    def _on_ground(self, loaded: LoadedBodies) -> bool:
        return self.link == GROUND or (
            self.link is None and self.point in loaded.carried.get(GROUND, ())
        )

    @property
    def formulas(self) -> tuple[tuple[tuple[str | int, ...], Number], ...]:
        """The components or the torque with their keys."""
        if self.torque is not None:
            return ((("torque",), self.torque),)
        return tuple((("force", k), number) for k, number in enumerate(self.force or ()))
