"""Tables in memory: data frames, Arrow tables, dicts of arrays, structured arrays."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt

#: A column and its name.
Columns: TypeAlias = list[tuple[str, npt.NDArray[np.float64]]]

#: What the columns of an array with three of them are called.
_THREE = ("x", "y", "z")


def is_table(data: object) -> bool:
    """Whether this is a table in memory."""
    if isinstance(data, (Mapping, np.ndarray)):
        return True
    return hasattr(data, "column_names") or hasattr(data, "columns")


def columns(data: Any) -> Columns:
    """The columns of a table: numbers as ``float64``, without a copy where they are that already.

    Dates become seconds since 1970. An array of n × 3 in a dict is three columns, ``gyro`` then
    ``gyro_x``, ``gyro_y``, ``gyro_z``.
    """
    return [found for name, column in _named(data) for found in _columns(name, column)]


def _named(data: Any) -> Iterator[tuple[str, Any]]:
    if isinstance(data, Mapping):
        yield from ((str(name), column) for name, column in data.items())
    elif isinstance(data, np.ndarray):
        if data.dtype.names is None:
            raise TypeError("an array needs named fields; or use a dict of arrays")
        yield from ((name, data[name]) for name in data.dtype.names)
    elif hasattr(data, "column_names"):
        for name in data.column_names:
            yield str(name), data[name]
    else:
        yield from ((str(name), data[name]) for name in data.columns)


def _columns(name: str, column: Any) -> Columns:
    array = column if isinstance(column, np.ndarray) else _array(column)
    if isinstance(array, np.ma.MaskedArray):
        array = np.ma.filled(array.astype(np.float64), np.nan)
    if array.ndim == 2 and array.shape[1] == 3:
        parts = zip(_THREE, array.T, strict=True)
        return [(f"{name}_{axis}", _numbers(name, part)) for axis, part in parts]
    if array.ndim != 1:
        shape = " x ".join(map(str, array.shape))
        raise TypeError(f"column {name}: invalid shape {shape}")
    return [(name, _numbers(name, array))]


def _array(column: Any) -> npt.NDArray[Any]:
    """A column of a frame, a missing value as NaN."""
    if not hasattr(column, "to_numpy"):
        return np.asarray(column)
    array: npt.NDArray[Any] = np.asarray(column.to_numpy())
    if array.dtype.kind == "O":
        try:
            array = np.asarray(column.to_numpy(dtype=np.float64, na_value=np.nan))
        except (TypeError, ValueError):
            pass
    return array


def _numbers(name: str, array: npt.NDArray[Any]) -> npt.NDArray[np.float64]:
    if array.dtype.kind == "M":
        nanoseconds = array.astype("datetime64[ns]")
        numbers = nanoseconds.astype(np.int64) / 1e9
        numbers[np.isnat(nanoseconds)] = np.nan
        return numbers
    if array.dtype.kind == "m":
        return array.astype("timedelta64[ns]").astype(np.int64) / 1e9
    try:
        return np.asarray(array, dtype=np.float64)
    except (TypeError, ValueError):
        # Text stands in logs beside the numbers: it is an error where it is asked for.
        return np.full(len(array), np.nan)
