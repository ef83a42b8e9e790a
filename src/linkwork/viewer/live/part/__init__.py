"""Drawing of parts: one module for each, named as its part in ``mechanism.part``."""
