"""Arguments on their way in: numbers of Python or numpy, checked before anything is changed."""

from __future__ import annotations

import math
from collections.abc import Sequence
from numbers import Integral, Real
from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt
from undrift._array import Floats
from undrift._errors import ArgumentError, UndriftError

#: Three numbers.
Vector: TypeAlias = Sequence[float] | Floats

#: Rows of a 3 x 3 matrix.
Matrix: TypeAlias = list[list[float]]


def number(value: Any, name: str) -> float:
    """A finite real number, of Python or numpy.

    Raises ArgumentError for what is not a number, UndriftError for NaN and infinities.
    """
    if isinstance(value, np.ndarray) and value.ndim == 0:
        value = value[()]
    if isinstance(value, (bool, np.bool_)) or not isinstance(value, Real):
        raise ArgumentError(f"{name}: a number is needed, not {_called(value)}")
    made = float(value)
    if not math.isfinite(made):
        raise UndriftError(f"{name}: {made} is not finite")
    return made


def positive(value: Any, name: str) -> float:
    """A finite number above zero."""
    made = number(value, name)
    if made <= 0.0:
        raise UndriftError(f"{name}: must be above 0, not {made:g}")
    return made


def whole(value: Any, name: str) -> int:
    """A whole number, 0 or more."""
    if isinstance(value, (bool, np.bool_)) or not isinstance(value, Integral):
        raise ArgumentError(f"{name}: a whole number is needed, not {_called(value)}")
    if value < 0:
        raise UndriftError(f"{name}: must not be negative, as {value} is")
    return int(value)


def pair(value: Any, name: str) -> tuple[int, int]:
    """Two whole numbers: an order (p, q)."""
    if isinstance(value, (str, bytes)) or not hasattr(value, "__len__") or len(value) != 2:
        raise ArgumentError(f"{name}: two whole numbers are needed, (p, q), not {value!r}")
    return whole(value[0], name), whole(value[1], name)


def rule(value: Any, name: str) -> int | str:
    """A whole number, or the name of a rule."""
    if isinstance(value, str):
        return value
    return whole(value, name)


def three(value: Any, name: str) -> list[float]:
    """Three finite numbers."""
    if isinstance(value, (str, bytes)) or not hasattr(value, "__len__"):
        raise ArgumentError(f"{name}: three numbers are needed, not {_called(value)}")
    if np.ndim(value) != 1 or len(value) != 3:
        shape = " x ".join(map(str, np.shape(value))) or "one"
        raise ArgumentError(f"{name}: three numbers are needed, not {shape}")
    return [number(one, name) for one in value]


def deviations(value: Any, name: str) -> list[float]:
    """Three standard deviations above zero; one value applies to all of them."""
    several = hasattr(value, "__len__") and np.ndim(value) > 0
    made = three(value, name) if several else [number(value, name)] * 3
    return [positive(one, name) for one in made]


def covariance(std: Any, cov: npt.ArrayLike | None, name: str) -> Matrix:
    """A positive definite covariance of three numbers: ``cov``, or the one of standard deviations."""
    if cov is None:
        rows: Matrix = np.diag(np.square(deviations(std, f"{name}_std"))).tolist()
        return rows
    name = f"{name}_cov"
    try:
        matrix = np.asarray(cov, np.float64)
    except (TypeError, ValueError) as error:
        raise ArgumentError(f"{name}: a 3 x 3 matrix of numbers is needed: {error}") from error
    if matrix.shape != (3, 3):
        raise ArgumentError(f"{name}: a 3 x 3 matrix is needed, not {matrix.shape}")
    if not np.isfinite(matrix).all():
        raise UndriftError(f"{name}: a number is not finite")
    scale = np.sqrt(np.outer(np.abs(np.diag(matrix)), np.abs(np.diag(matrix))))
    if (np.abs(matrix - matrix.T) > 1e-9 * scale).any():
        raise UndriftError(f"{name}: not symmetric, so no covariance")
    matrix = 0.5 * (matrix + matrix.T)
    if np.linalg.eigvalsh(matrix)[0] <= 0.0:
        raise UndriftError(f"{name}: not positive definite, so no covariance")
    checked: Matrix = matrix.tolist()
    return checked


def place(value: Any, name: str) -> list[float]:
    """Latitude, longitude [rad] and height [m]."""
    lat, lon, height = three(value, name)
    if abs(lat) > math.pi / 2 or abs(lon) > 2 * math.pi:
        raise UndriftError(
            f"{name}: latitude {lat:g} and longitude {lon:g} are no place in radians: "
            "convert degrees by numpy.radians"
        )
    if not -20e3 < height < 100e3:
        raise UndriftError(f"{name}: height {height:g} m is outside of -20 to 100 km")
    return [lat, lon, height]


def limits(gate: Any) -> tuple[float, float] | None:
    """A gate: limits of the NIS above which a measurement is weakened and rejected."""
    if gate is None:
        return None
    if isinstance(gate, (str, bytes)) or not hasattr(gate, "__len__") or len(gate) != 2:
        raise ArgumentError("gate: two numbers are needed, (weaken, reject)")
    found = []
    for one in gate:
        endless = isinstance(one, (float, np.floating)) and one == math.inf
        found.append(math.inf if endless else positive(one, "gate"))
    weaken, reject = found
    if weaken > reject:
        raise UndriftError(f"gate: weaken, {weaken:g}, is above reject, {reject:g}")
    return weaken, reject


def _called(value: object) -> str:
    return repr(value) if isinstance(value, str) else f"a {type(value).__name__}"
