"""Noise models of low-cost inertial sensors, carried exactly into a GNSS/INS filter."""

from undrift._undrift import __version__

__all__ = ["__version__"]
