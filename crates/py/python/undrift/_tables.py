"""Tables in memory: data frames, Arrow tables, dicts of arrays, structured arrays."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from datetime import datetime, timezone
from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt
from undrift._errors import ArgumentError
from undrift._solution import Series

#: A column and its name.
Columns: TypeAlias = list[tuple[str, npt.NDArray[np.float64]]]

#: What the columns of an array with three or four of them are called: a quaternion may have its w first or last.
_PARTS = {3: ("x", "y", "z"), 4: ("0", "1", "2", "3")}


def is_table(data: object) -> bool:
    """Whether this is a table in memory."""
    if isinstance(data, (Mapping, np.ndarray, Series)):
        return True
    return hasattr(data, "column_names") or hasattr(data, "columns")


def columns(data: Any) -> Columns:
    """The columns of a table: numbers as ``float64``, without a copy where they are that already.

    Dates become seconds since 1970. An array of n × 3 in a dict is three columns, ``gyro`` then
    ``gyro_x``, ``gyro_y``, ``gyro_z``; one of n × 4 four, ``attitude_0`` to ``attitude_3``. Of a data frame, an index of times or with a name is the last column.
    """
    return [found for name, column in _named(data) for found in _columns(name, column)]


def stated_names(data: Any, names: list[str]) -> dict[str, str]:
    """The names of columns, each by itself with the unit that the table states of it: ``gyro_x [rad/s]``."""
    units = _units(data)
    return {f"{name} [{units[name]}]" if name in units else name: name for name in names}


def with_units(data: Any) -> Columns:
    """As :func:`columns`, the units that the table states in the names."""
    held = columns(data)
    names = stated_names(data, [name for name, _ in held])
    return list(zip(names, (column for _, column in held), strict=True))


def _units(data: Any) -> Mapping[str, str]:
    """The units of columns that a table states beside their names."""
    if isinstance(data, Series):
        return data.column_units()
    if hasattr(data, "column_names") and hasattr(data, "schema"):
        fields = ((field.name, field.metadata or {}) for field in data.schema)
        return {name: about[b"unit"].decode() for name, about in fields if b"unit" in about}
    attributes = getattr(data, "attrs", None)
    units = attributes.get("units") if isinstance(attributes, Mapping) else None
    return units if isinstance(units, Mapping) else {}


def _named(data: Any) -> Iterator[tuple[str, Any]]:
    if isinstance(data, Series):
        yield from data._table().items()
    elif isinstance(data, Mapping):
        yield from ((str(name), column) for name, column in data.items())
    elif isinstance(data, np.ndarray):
        if data.dtype.names is None:
            raise ArgumentError("an array needs named fields; or use a dict of arrays")
        yield from ((name, data[name]) for name in data.dtype.names)
    elif hasattr(data, "column_names"):
        for name in data.column_names:
            yield str(name), data[name]
    else:
        yield from ((str(name), data[name]) for name in data.columns)
        yield from index_of(data)


def index_of(data: Any) -> Iterator[tuple[str, Any]]:
    """The index of a data frame or series as a column, where it is one of times or has a name."""
    index: Any = getattr(data, "index", None)
    if not hasattr(index, "dtype"):
        return
    name = getattr(index, "name", None)
    of_times = index.dtype.kind in "mM" or hasattr(index, "tz")
    taken = [str(one) for one in getattr(data, "columns", ())]
    if (of_times or name is not None) and str(name or "time") not in taken:
        yield str(name or "time"), index


def _columns(name: str, column: Any) -> Columns:
    array = column if isinstance(column, np.ndarray) else _array(column)
    if isinstance(array, np.ma.MaskedArray):
        array = np.ma.filled(array.astype(np.float64), np.nan)
    if array.ndim == 2 and array.shape[1] in _PARTS:
        parts = zip(_PARTS[array.shape[1]], array.T, strict=True)
        return [(f"{name}_{part}", _numbers(name, column)) for part, column in parts]
    if array.ndim != 1:
        shape = " x ".join(map(str, array.shape))
        raise ArgumentError(f"column {name}: invalid shape {shape}")
    return [(name, _numbers(name, array))]


def _array(column: Any) -> npt.NDArray[Any]:
    """A column of a frame, a missing value as NaN."""
    if not hasattr(column, "to_numpy"):
        return np.asarray(column)
    if getattr(column.dtype if hasattr(column, "dtype") else None, "tz", None) is not None:
        # Of pandas, with a time zone: the same instants in UTC.
        column = getattr(column, "dt", column).tz_convert(None)
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
    if array.dtype.kind == "O" and any(isinstance(one, datetime) for one in array[:1]):
        return np.array([_seconds(one) for one in array])
    if array.dtype.kind == "m":
        return array.astype("timedelta64[ns]").astype(np.int64) / 1e9
    try:
        return np.asarray(array, dtype=np.float64)
    except (TypeError, ValueError):
        # Logs may hold text beside the numbers: an error only where the column is used.
        return np.full(len(array), np.nan)


def _seconds(date: Any) -> float:
    """Seconds since 1970 of a date; one without a time zone is taken as UTC."""
    if not isinstance(date, datetime):
        return np.nan
    aware = date if date.tzinfo is not None else date.replace(tzinfo=timezone.utc)
    return aware.timestamp()
