"""Signatures of the compiled half."""

__version__: str

class UndriftError(ValueError): ...
