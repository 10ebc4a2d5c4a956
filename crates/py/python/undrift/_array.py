"""Records on their way in."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from undrift._errors import ArgumentError, UndriftError

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]


def record(x: npt.ArrayLike, name: str = "the recording") -> Floats:
    """One-dimensional contiguous ``float64``: the array itself where it is that, else a copy.

    Lists, other number types, strides, pandas and polars series are taken; a masked or missing value
    becomes NaN.
    """
    if isinstance(x, np.ma.MaskedArray):
        x = np.ma.filled(x.astype(np.float64), np.nan)
    try:
        array = np.asarray(x)
        if array.dtype.kind not in "biufO":
            raise TypeError(f"{array.dtype} is not a type of real numbers")
        if array.dtype.kind == "O" and hasattr(x, "to_numpy"):
            array = x.to_numpy(dtype=np.float64, na_value=np.nan)
        array = np.require(array, np.float64, ["C", "ALIGNED", "ENSUREARRAY"])
    except (TypeError, ValueError) as error:
        raise ArgumentError(f"{name} is not an array of numbers: {error}") from error
    if array.ndim != 1:
        raise ArgumentError(
            f"{name} has {array.ndim} dimensions where 1 is needed: give one axis at a time"
        )
    return array
