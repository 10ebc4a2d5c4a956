"""What every result can do: print itself, become a table, be drawn."""

from __future__ import annotations

import dataclasses
import html
import importlib
from collections.abc import Iterator, Mapping
from types import ModuleType
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from pandas import DataFrame
    from polars import DataFrame as PolarsFrame
    from pyarrow import Table

#: Rows that the table of a notebook shows of a long result: this many at the start and at the end.
_SHOWN = 5


def optional(module: str, extra: str) -> ModuleType:
    """A module of an optional dependency.

    Raises ImportError that states what to install.
    """
    try:
        return importlib.import_module(module)
    except ImportError as error:
        package = module.partition(".")[0]
        raise ImportError(
            f'{package} is needed for this: pip install "undrift[{extra}]"'
        ) from error


def axes(ax: Axes | None) -> Axes:
    """The specified axes, or those of a new figure."""
    pyplot = optional("matplotlib.pyplot", "plot")
    if ax is not None:
        return ax
    made: Axes = pyplot.figure(layout="constrained").add_subplot()
    return made


class Result:
    """Base of all results, which are frozen dataclasses: ``@dataclass(frozen=True, eq=False, repr=False)``.

    A subclass whose table is not simply "its arrays, side by side" overrides :meth:`_table`.
    """

    #: Units of the fields, where they are the same of all results of the class.
    _UNITS: ClassVar[Mapping[str, str]] = {}

    def __post_init__(self) -> None:
        for field in dataclasses.fields(self):  # type: ignore[arg-type]
            value = getattr(self, field.name)
            if isinstance(value, np.ndarray) and value.flags.writeable:
                # A view: an array that was handed in stays its owner's to write to.
                view = value.view()
                view.flags.writeable = False
                object.__setattr__(self, field.name, view)

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state)
        self.__post_init__()

    def __eq__(self, other: object) -> bool:
        """Whether all fields are equal, arrays number by number; NaN equals NaN."""
        if type(other) is not type(self):
            return NotImplemented
        names = [field.name for field in dataclasses.fields(self) if field.compare]  # type: ignore[arg-type]
        return all(_equal(getattr(self, name), getattr(other, name)) for name in names)

    def __hash__(self) -> int:
        parts = (value for _, value in self._fields() if isinstance(value, (int, float, str)))
        return hash((type(self), *parts))

    def _fields(self) -> Iterator[tuple[str, Any]]:
        for field in dataclasses.fields(self):  # type: ignore[arg-type]
            if field.repr and not field.name.startswith("_"):
                yield field.name, getattr(self, field.name)

    def _unit(self, name: str) -> str | None:
        """Unit of a field, if it has one."""
        return self._UNITS.get(name)

    def _stated(self, name: str, value: Any) -> str:
        """A field with its unit."""
        unit = self._unit(name)
        text = _text(value)
        return text if unit is None or value is None else f"{text} {unit}"

    def _table(self) -> Mapping[str, Any]:
        """Columns by name: the one-dimensional arrays as long as the first of them; without any, one row."""
        columns: dict[str, Any] = {}
        for name, value in self._fields():
            if isinstance(value, np.ndarray) and value.ndim == 1:
                if not columns or len(value) == len(next(iter(columns.values()))):
                    columns[name] = value
        if columns:
            return columns
        return {name: [value] for name, value in self._fields() if _is_scalar(value)}

    def to_pandas(self) -> DataFrame:
        """The result as a ``pandas.DataFrame``. Needs ``undrift[tables]``."""
        frame: DataFrame = optional("pandas", "tables").DataFrame(dict(self._table()))
        return frame

    def to_arrow(self) -> Table:
        """The result as a ``pyarrow.Table``. Needs ``undrift[tables]``."""
        table: Table = optional("pyarrow", "tables").table(dict(self._table()))
        return table

    def to_polars(self) -> PolarsFrame:
        """The result as a ``polars.DataFrame``. Needs ``undrift[polars]``."""
        frame: PolarsFrame = optional("polars", "polars").DataFrame(dict(self._table()))
        return frame

    def __repr__(self) -> str:
        parts = (f"{name}={self._stated(name, value)}" for name, value in self._fields())
        return f"{type(self).__name__}({', '.join(parts)})"

    def _short(self) -> str:
        """Short form of the result within another one."""
        name = type(self).__name__
        arrays = [value for _, value in self._fields() if isinstance(value, np.ndarray)]
        if arrays:
            return f"{name}({max(map(len, arrays))} rows)"
        whole = repr(self)
        return whole if len(whole) <= 60 else f"{name}(…)"

    def _repr_html_(self) -> str:
        """What a notebook shows: the single values, then the table, without its middle."""
        title = html.escape(type(self).__name__)
        single = "".join(
            f"<tr><th>{html.escape(name)}</th><td>{html.escape(self._stated(name, value))}</td></tr>"
            for name, value in self._fields()
            if not isinstance(value, np.ndarray)
        )
        columns = {
            name: column
            for name, column in self._table().items()
            if isinstance(column, np.ndarray)
        }
        return (
            f"<div><b>{title}</b>"
            + (f"<table>{single}</table>" if single else "")
            + (_rows(columns) if columns else "")
            + "</div>"
        )


def _rows(columns: Mapping[str, Any]) -> str:
    count = len(next(iter(columns.values())))
    whole = count <= 2 * _SHOWN + 1
    shown = (
        range(count)
        if whole
        else [*range(_SHOWN), None, *range(count - _SHOWN, count)]
    )
    head = "".join(f"<th>{html.escape(name)}</th>" for name in columns)
    body = "".join(
        "<tr>"
        + "".join(
            f"<td>{'…' if row is None else html.escape(_text(column[row]))}</td>"
            for column in columns.values()
        )
        + "</tr>"
        for row in shown
    )
    return f"<table><tr>{head}</tr>{body}</table>"


def _equal(one: Any, other: Any) -> bool:
    if isinstance(one, np.ndarray) or isinstance(other, np.ndarray):
        if np.shape(one) != np.shape(other):
            return False
        numbers = all(np.asarray(x).dtype.kind in "fc" for x in (one, other))
        return bool(np.array_equal(one, other, equal_nan=numbers))
    if isinstance(one, (tuple, list)) and type(one) is type(other):
        return len(one) == len(other) and all(map(_equal, one, other))
    if isinstance(one, Mapping) and isinstance(other, Mapping):
        return one.keys() == other.keys() and all(_equal(one[key], other[key]) for key in one)
    nan = isinstance(one, float) and isinstance(other, float) and one != one and other != other
    return nan or bool(one == other)


def _is_scalar(value: object) -> bool:
    return value is None or isinstance(value, (bool, int, float, str, np.generic))


def _text(value: object) -> str:
    """Short text of a value: eight digits of a number, the first and last of an array."""
    if isinstance(value, (bool, np.bool_)):
        return str(bool(value))
    if isinstance(value, (float, np.floating)):
        return f"{value:.8g}"
    if isinstance(value, np.generic):
        return str(value.item())
    if isinstance(value, np.ndarray):
        if value.ndim != 1:
            return f"<array {'×'.join(map(str, value.shape))}>"
        if len(value) <= 6:
            return f"[{', '.join(map(_text, value))}]"
        return f"[{_text(value[0])}, {_text(value[1])}, …, {_text(value[-1])}; {len(value)}]"
    if isinstance(value, Result):
        return value._short()
    if isinstance(value, tuple) and value and isinstance(value[0], Result):
        return f"<{len(value)} {type(value[0]).__name__}>"
    if isinstance(value, tuple):
        inside = ", ".join(map(_text, value))
        return f"({inside},)" if len(value) == 1 else f"({inside})"
    if isinstance(value, list):
        return f"[{', '.join(map(_text, value))}]"
    if isinstance(value, Mapping) and any(isinstance(one, Result) for one in value.values()):
        return "{" + ", ".join(map(str, value)) + "}"
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{key}: {_text(v)}" for key, v in value.items()) + "}"
    return repr(value)
