"""The model of a mechanism, started in the configuration that its description names."""

from __future__ import annotations

from linkwork import motion  # loads the search for configurations for those that name one only
from linkwork.foundation.errors import InputError, MechanismError, Problem
from linkwork.mechanism.description import Description
from linkwork.motion.model import Model, model_of

__all__ = ["as_described"]


def as_described(description: Description) -> Model:
    """The model of a mechanism, started from the configuration that it names, if it names one.

    Raises
    ------
    MechanismError
        With every problem found.
    """
    model = model_of(description)
    if not description.configuration:
        return model
    try:
        return motion.start_in_configuration(model, description.configuration)
    except InputError as error:
        problem = Problem(key=("configuration",), message=str(error))
        raise MechanismError([problem], f'mechanism "{description.name}"') from None
