"""Mechanisms as Python objects: make, read, solve and show them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from linkwork.core.foundation.loading import loader

if TYPE_CHECKING:
    from linkwork.api.foreign import Imported as Imported, imported as imported
    from linkwork.api.making import (
        example as example,
        linkage as linkage,
        load as load,
        loads as loads,
        loops as loops,
        plain_equations as plain_equations,
    )
    from linkwork.api.mechanism import Mechanism as Mechanism
    from linkwork.api.presenters import register_presenters as register_presenters
    from linkwork.core.textfile.reader import example_text as example_text, examples as examples
else:
    __getattr__ = loader(__name__)
