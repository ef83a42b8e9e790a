"""Questions of designers about a mechanism: which dimension matters, and by how much."""

from __future__ import annotations

from typing import TYPE_CHECKING

from linkwork.core.foundation.loading import loader

if TYPE_CHECKING:
    from linkwork.design.machine import (
        balanced as balanced,
        counterweights as counterweights,
        flywheel as flywheel,
        harmonics as harmonics,
        inflection_circle as inflection_circle,
        motor_check as motor_check,
    )
    from linkwork.design.results import (
        Counterweight as Counterweight,
        Counterweights as Counterweights,
        Flywheel as Flywheel,
        Harmonics as Harmonics,
        InflectionCircle as InflectionCircle,
        MotorCheck as MotorCheck,
    )
    from linkwork.design.sensitivities import gradient as gradient, sensitivity as sensitivity
    from linkwork.design.tolerance_results import (
        Contribution as Contribution,
        Sampled as Sampled,
        Sensitivity as Sensitivity,
        SensitivityStatus as SensitivityStatus,
        Tolerance as Tolerance,
    )
    from linkwork.design.tolerances import tolerance as tolerance
else:
    __getattr__ = loader(__name__)
