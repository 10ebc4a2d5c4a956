"""The exceptions of the package."""

from undrift._undrift import UndriftError

__all__ = ["ArgumentError", "UndriftError"]


class ArgumentError(UndriftError, TypeError):
    """An argument of a wrong type or shape: an :class:`UndriftError` that is a ``TypeError`` too."""


# As people call it.
ArgumentError.__module__ = "undrift"
