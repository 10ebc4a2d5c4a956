"""A navigation solution over time."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from undrift._array import Floats
from undrift._result import Result

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


class Series(Result):
    """Base of results whose arrays have a row for every time."""

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
