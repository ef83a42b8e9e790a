"""A mechanism as a machine: its flywheel, motor, counterweights and vibrations."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Self

from linkwork import design
from linkwork.api.loaded import LoadedMechanism
from linkwork.core.foundation.errors import InputError
from linkwork.core.mechanism.linkage import Linkage

if TYPE_CHECKING:
    from linkwork.core.mechanism.dimensions import Number
    from linkwork.core.mechanism.inputs import Motor
    from linkwork.core.results.motion import Motion
    from linkwork.design.results import (
        Counterweights,
        Flywheel,
        Harmonics,
        InflectionCircle,
        MotorCheck,
    )

__all__ = ["DynamicMechanism"]


class DynamicMechanism(LoadedMechanism):
    """The part of :class:`~linkwork.api.mechanism.Mechanism` for designers of machines.

    Methods with ``motion`` take a motion over a whole turn that is solved already, instead of the
    input's table.
    """

    def flywheel(self, fluctuation: float, *, motion: Motion | None = None) -> Flywheel:
        """The inertia at the input for a fluctuation of its speed; see
        :func:`linkwork.design.machine`.

        Parameters
        ----------
        fluctuation : float
            (ω_max - ω_min) / ω_mean.
        motion : Motion, optional
            As above.

        Raises
        ------
        InputError
            Without a speed or a whole turn.

        Examples
        --------
        >>> import linkwork as lw
        >>> round(lw.example("crank-press").flywheel(0.05).inertia / 1e6, 1)  # kg m²
        43.0
        """
        return design.flywheel(self.model, self._turn(motion), fluctuation)

    def motor_check(
        self,
        *,
        motor: Motor | None = None,
        stall: float | None = None,
        free_speed: Number | None = None,
        rated: float | None = None,
        motion: Motion | None = None,
    ) -> MotorCheck:
        """Peak and root mean square of the effort against a motor, by default that of the input.

        Parameters
        ----------
        motor : Motor, optional
            A motor, which may be a table of torques over speeds.
        stall : float, optional
            Instead: torque at rest [force · length].
        free_speed : number or str, optional
            Speed without torque: ``"1500 rpm"``; the torque falls linearly to it.
        rated : float, optional
            Torque that the motor gives without end, for the root mean square.
        motion : Motion, optional
            As above.

        Raises
        ------
        InputError
            Without a motor, a speed or a whole turn, and beyond the motor's table.

        Examples
        --------
        >>> import linkwork as lw
        >>> press = lw.example("crank-press")
        >>> press.motor_check(stall=9e5, free_speed="3000 rpm").fits
        False
        """
        return design.motor_check(
            self.model,
            self._turn(motion),
            motor=motor,
            stall=stall,
            free_speed=free_speed,
            rated=rated,
        )

    def harmonics(self, of: str, count: int = 8, *, motion: Motion | None = None) -> Harmonics:
        """The Fourier sum of a quantity over a turn of the input.

        Parameters
        ----------
        of : str
            A quantity: ``crank.effort``, ``shaking.x``, …
        count : int
            The number of harmonics.
        motion : Motion, optional
            As above.

        Raises
        ------
        UnknownNameError, InputError
            If there is no such quantity, or no whole turn.

        Examples
        --------
        >>> import linkwork as lw
        >>> lw.example("crank-press").harmonics("height", 3).amplitude.round(3)
        array([60.   ,  2.263,  0.   ])
        """
        return design.harmonics(self.model, self._turn(motion), of, count)

    def counterweights(self, radius: float | Mapping[str, float]) -> Counterweights:
        """The counterweights that remove the shaking force of a four-bar.

        The masses alone shake, at the speed of the input or at 1 rad/s: loads, springs and gravity
        are left out.

        Parameters
        ----------
        radius : number or Mapping[str, number]
            Their distance from the pins on ground [length], by link or for both.

        Raises
        ------
        InputError
            If it is no four-bar with pins and masses.

        Examples
        --------
        >>> import linkwork as lw
        >>> bar = lw.example("four-bar").changed(masses={"coupler": lw.Mass(mass=2, shape="rod")})
        >>> [weight.link for weight in bar.counterweights(radius=20).weights]
        ['crank', 'rocker']
        """
        return design.counterweights(self._linkage, radius)

    def balanced(self, radius: float | Mapping[str, float]) -> Self:
        """A copy whose masses contain the counterweights of :meth:`counterweights`.

        Parameters
        ----------
        radius : number or Mapping[str, number]
            As there.

        Raises
        ------
        InputError
            As there.

        Examples
        --------
        >>> import linkwork as lw
        >>> bar = lw.example("four-bar").changed(masses={"coupler": lw.Mass(mass=2, shape="rod")})
        >>> sorted(bar.balanced(radius=20).description.masses)
        ['coupler', 'crank', 'rocker']
        """
        weights = design.counterweights(self._linkage, radius).weights
        return type(self)(design.balanced(self._linkage, weights))

    def inflection_circle(
        self,
        link: str | None = None,
        at: float | Mapping[str, float] | None = None,
        *,
        configuration: str | None = None,
    ) -> InflectionCircle:
        """The points of a link whose paths are straight to the second order at a position.

        Parameters
        ----------
        link : str, optional
            By default the only link that ground does not carry.
        at : number or Mapping[str, number], optional
            Input value(s) in file units.
        configuration : str, optional
            As in :meth:`solve`.

        Raises
        ------
        UnknownNameError, InputError
            If there is no such link, or it does not turn there.

        Examples
        --------
        >>> import linkwork as lw
        >>> circle = lw.example("rolling-wheel").inflection_circle("wheel", at=-120)
        >>> round(circle.diameter, 9)
        40.0
        """
        position = self.solve(at, configuration=configuration)
        return design.inflection_circle(self.model, position, link)

    @property
    def _linkage(self) -> Linkage:
        if not isinstance(self.description, Linkage):
            raise InputError("counterweights need a mechanism with points and links")
        return self.description

    def _turn(self, motion: Motion | None) -> Motion:
        return self.sweep() if motion is None else motion
