"""A navigation solution: over time, and at one instant."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, overload

import numpy as np
from undrift._array import Floats
from undrift._result import Result, axes, optional
from undrift._units import factor

if TYPE_CHECKING:
    import matplotlib.axes
    from pandas import DataFrame
    from polars import DataFrame as PolarsFrame
    from pyarrow import Table
    from undrift import _undrift

#: Mean radius of the Earth [m].
_EARTH = 6_371_000.0

#: Columns of the solution's table that are parts of its arrays.
PARTS = {
    "velocity": ("vn", "ve", "vd"),
    "rpy": ("roll", "pitch", "yaw"),
    "position_std": ("north_std", "east_std", "down_std"),
    "velocity_std": ("vn_std", "ve_std", "vd_std"),
    "attitude_std": ("tilt_north_std", "tilt_east_std", "yaw_std"),
    "gyro": ("gyro_x", "gyro_y", "gyro_z"),
    "accel": ("accel_x", "accel_y", "accel_z"),
    "gyro_error": ("gyro_error_x", "gyro_error_y", "gyro_error_z"),
    "accel_error": ("accel_error_x", "accel_error_y", "accel_error_z"),
    "gyro_error_std": ("gyro_error_std_x", "gyro_error_std_y", "gyro_error_std_z"),
    "accel_error_std": ("accel_error_std_x", "accel_error_std_y", "accel_error_std_z"),
}


#: SI units of the fields, which travel with tables.
UNITS = {
    "time": "s",
    "lat": "rad",
    "lon": "rad",
    "height": "m",
    "velocity": "m/s",
    "rpy": "rad",
    "position_std": "m",
    "velocity_std": "m/s",
    "attitude_std": "rad",
    "gyro": "rad/s",
    "accel": "m/s^2",
    "gyro_error": "rad/s",
    "accel_error": "m/s^2",
    "gyro_error_std": "rad/s",
    "accel_error_std": "m/s^2",
}


class Series(Result):
    """Base of results whose arrays have a row for every time.

    Their tables carry the units of columns: ``frame.attrs["units"]`` of pandas, ``unit`` in the metadata
    of an Arrow field. :func:`undrift.navigate` and :func:`undrift.identify` read them from there.
    """

    _UNITS = UNITS

    def column_units(self) -> dict[str, str]:
        """Unit of each column of the table."""
        units: dict[str, str] = {}
        for name, values in self._fields():
            if isinstance(values, np.ndarray):
                parts = (name,) if values.ndim == 1 else PARTS[name]
                units.update(dict.fromkeys(parts, UNITS[name]))
        return units

    def to_pandas(self, *, units: bool = False) -> DataFrame:
        """The result as a ``pandas.DataFrame``. Needs ``undrift[tables]``.

        With ``units`` the names of columns state them, ``gyro_x [rad/s]``: for files of formats that keep
        nothing but names, such as CSV.
        """
        frame = super().to_pandas()
        known = self.column_units()
        if units:
            return frame.rename(columns={name: f"{name} [{unit}]" for name, unit in known.items()})
        frame.attrs["units"] = known
        return frame

    def to_polars(self, *, units: bool = False) -> PolarsFrame:
        """The result as a ``polars.DataFrame``; with ``units`` the names of columns state them, as no metadata can. Needs
        ``undrift[polars]``.
        """
        frame = super().to_polars()
        if not units:
            return frame
        known = self.column_units()
        return frame.rename({name: f"{name} [{unit}]" for name, unit in known.items()})

    def to_arrow(self) -> Table:
        """The result as a ``pyarrow.Table``, units in the fields' metadata. Needs ``undrift[tables]``."""
        table = super().to_arrow()
        known = self.column_units()
        fields = [field.with_metadata({"unit": known[field.name]}) for field in table.schema]
        made: Table = table.cast(optional("pyarrow", "tables").schema(fields))
        return made

    def _table(self) -> Mapping[str, Any]:
        table: dict[str, Any] = {}
        for name, values in self._fields():
            if not isinstance(values, np.ndarray):
                continue
            if values.ndim == 1:
                table[name] = values
            else:
                table.update(zip(PARTS[name], np.asarray(values).T, strict=True))
        return table


class Placed(Series):
    """Base of results with a latitude and a longitude."""

    lat: Floats
    lon: Floats

    @property
    def lat_deg(self) -> Floats:
        """Latitude [deg]."""
        return np.degrees(self.lat)

    @property
    def lon_deg(self) -> Floats:
        """Longitude [deg]."""
        return np.degrees(self.lon)

    def plot(
        self,
        ax: matplotlib.axes.Axes | None = None,
        *,
        label: str | None = None,
        unit: str = "m",
    ) -> matplotlib.axes.Axes:
        """The ground track, east over north from its first place, in m or km. Needs ``undrift[plot]``."""
        ax = axes(ax)
        if len(self.lat):
            # A sphere's metres do for a figure.
            north = _EARTH * (self.lat - self.lat[0])
            east = _EARTH * np.cos(self.lat[0]) * (self.lon - self.lon[0])
            ax.plot(factor(unit) * east, factor(unit) * north, label=label)
        ax.set_aspect("equal", adjustable="datalim")
        ax.set_xlabel(f"east [{unit}]")
        ax.set_ylabel(f"north [{unit}]")
        if label is not None:
            ax.legend()
        return ax


@dataclass(frozen=True, eq=False, repr=False)
class Solution(Placed):
    """Position, velocity, attitude and sensor errors of the IMU over time, n samples."""

    time: Floats
    """Time [s], in the logs' time base."""
    lat: Floats
    """Latitude [rad]."""
    lon: Floats
    """Longitude [rad]."""
    height: Floats
    """Height above the ellipsoid [m]."""
    velocity: Floats
    """Velocity over ground, north, east, down [m/s], n × 3."""
    rpy: Floats
    """Roll, pitch, yaw [rad], n × 3."""
    position_std: Floats
    """Standard deviation of the position, north, east, down [m], n × 3."""
    velocity_std: Floats
    """Standard deviation of the velocity, north, east, down [m/s], n × 3."""
    attitude_std: Floats
    """Standard deviation of the misalignment about north, east, down [rad], n × 3."""
    gyro_error: Floats
    """Estimated errors of the gyros, body axes [rad/s], n × 3."""
    accel_error: Floats
    """Estimated errors of the accelerometers, body axes [m/s²], n × 3."""
    gyro_error_std: Floats
    """Their standard deviations [rad/s], n × 3."""
    accel_error_std: Floats
    """Their standard deviations [m/s²], n × 3."""

    def __len__(self) -> int:
        return len(self.time)


@dataclass(frozen=True, eq=False, repr=False)
class FilterState(Result):
    """The state of the filter at one instant."""

    _UNITS = UNITS

    time: float
    """Time [s]."""
    lat: float
    """Latitude [rad]."""
    lon: float
    """Longitude [rad]."""
    height: float
    """Height above the ellipsoid [m]."""
    velocity: Floats
    """Velocity over ground, north, east, down [m/s]."""
    rpy: Floats
    """Roll, pitch, yaw [rad]."""
    position_std: Floats
    """Standard deviation of the position, north, east, down [m]."""
    velocity_std: Floats
    """Standard deviation of the velocity, north, east, down [m/s]."""
    attitude_std: Floats
    """Standard deviation of the misalignment about north, east, down [rad]."""
    gyro_error: Floats
    """Estimated errors of the gyros [rad/s]."""
    accel_error: Floats
    """Estimated errors of the accelerometers [m/s²]."""
    gyro_error_std: Floats
    """Their standard deviations [rad/s]."""
    accel_error_std: Floats
    """Their standard deviations [m/s²]."""
    parameters: Mapping[str, tuple[Floats, Floats]]
    """Estimated parameters and their standard deviations, by name."""


@overload
def filter_state(compiled: _undrift.Filter) -> FilterState: ...
@overload
def filter_state(compiled: _undrift.Navigator) -> FilterState | None: ...
def filter_state(compiled: _undrift.Filter | _undrift.Navigator) -> FilterState | None:
    """The state of a filter of the compiled half; None of a navigator without one."""
    fields: dict[str, Any] = {}
    state = compiled.state()
    if state is None:
        return None
    for name, values in state.items():
        fields[name] = values[0] if values.ndim == 2 else float(values[0])
    parameters = {
        name: (np.array(value), np.array(std)) for name, value, std in compiled.parameters()
    }
    return FilterState(**fields, parameters=parameters)
