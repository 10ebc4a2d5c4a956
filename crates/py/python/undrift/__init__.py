"""Noise models of low-cost inertial sensors, carried exactly into a GNSS/INS filter.

SI units and radians, unless a name says otherwise; arrays are numpy's, ``float64``.
"""

from undrift._undrift import UndriftError, __version__

__all__ = ["UndriftError", "__version__"]
