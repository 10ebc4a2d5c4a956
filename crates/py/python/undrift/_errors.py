"""The exceptions of the package, and its warning."""

from typing import Any

from undrift._undrift import UndriftError

__all__ = ["ArgumentError", "UndriftError", "VerdictError", "VerdictWarning"]


class ArgumentError(UndriftError, TypeError):
    """An argument of a wrong type or shape: an :class:`UndriftError` that is a ``TypeError`` too."""


class VerdictError(UndriftError):
    """The verdict on a result is ``not usable``; with ``strict=True`` also ``usable with care``."""

    #: The result all the same.
    result: Any

    def __init__(self, message: str, result: Any = None) -> None:
        super().__init__(message)
        self.result = result


class VerdictWarning(UserWarning):
    """The verdict on a result is ``usable with care``; with ``strict=False`` also ``not usable``."""


# As people call them.
for _named in (ArgumentError, VerdictError, VerdictWarning):
    _named.__module__ = "undrift"
