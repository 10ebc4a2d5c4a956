"""Units of figures."""

from __future__ import annotations

import math

from undrift._undrift import UndriftError

#: What a number in SI, rad/s or m/s², is multiplied by.
_FACTORS = {
    "rad/s": 1.0,
    "mrad/s": 1e3,
    "deg/s": math.degrees(1.0),
    "mdeg/s": 1e3 * math.degrees(1.0),
    "deg/h": 3600.0 * math.degrees(1.0),
    "m/s^2": 1.0,
    "m/s²": 1.0,
    "mm/s^2": 1e3,
    "g": 1.0 / 9.80665,
    "mg": 1e3 / 9.80665,
    "ug": 1e6 / 9.80665,
    "µg": 1e6 / 9.80665,
    "m": 1.0,
    "km": 1e-3,
    "cm": 1e2,
    "s": 1.0,
    "min": 1.0 / 60.0,
}


def factor(unit: str | None) -> float:
    """What numbers in SI are multiplied by to be in ``unit``; 1 without one."""
    if unit is None:
        return 1.0
    if unit not in _FACTORS:
        raise UndriftError(f"unknown unit {unit!r}; available: {', '.join(_FACTORS)}")
    return _FACTORS[unit]


def label_of(unit: str | None) -> str:
    """What an axis says of the unit of samples."""
    return "unit of the samples" if unit is None else unit
