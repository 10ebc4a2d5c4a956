"""Logs as arrays: samples and fixes."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from undrift._array import Floats
from undrift._solution import Placed, Series


@dataclass(frozen=True, eq=False, repr=False)
class ImuLog(Series):
    """Inertial samples, each the mean over the interval that ends at its time."""

    time: Floats
    """End of the interval [s]."""
    gyro: Floats
    """Angular rate, body axes [rad/s], n × 3."""
    accel: Floats
    """Specific force, body axes [m/s²], n × 3."""


@dataclass(frozen=True, eq=False, repr=False)
class GnssLog(Placed):
    """Fixes of the antenna; NaN where a fix has no position or no velocity."""

    time: Floats
    """Time of the fix [s]."""
    lat: Floats
    """Latitude [rad]."""
    lon: Floats
    """Longitude [rad]."""
    height: Floats
    """Height above the ellipsoid [m]."""
    position_std: Floats
    """Standard deviation of the position, north, east, down [m], n × 3."""
    velocity: Floats
    """Velocity, north, east, down [m/s], n × 3."""
    velocity_std: Floats
    """Its standard deviation [m/s], n × 3."""
    position_cov: Floats | None = field(default=None, repr=False)
    """Covariance of the position [m²], n × 3 × 3, where a log has more than standard deviations."""
    velocity_cov: Floats | None = field(default=None, repr=False)
    """That of the velocity [(m/s)²], n × 3 × 3."""

    def fix(self, k: int) -> dict[str, Any]:
        """The fix ``k`` as :meth:`Filter.update_gnss` takes it: what it has of position and velocity."""
        found: dict[str, Any] = {}
        if np.isfinite(self.lat[k]):
            found["position"] = (self.lat[k], self.lon[k], self.height[k])
            found["position_std"] = self.position_std[k]
            if self.position_cov is not None:
                found["position_cov"] = self.position_cov[k]
        if np.isfinite(self.velocity[k]).all():
            found |= {"velocity": self.velocity[k], "velocity_std": self.velocity_std[k]}
            if self.velocity_cov is not None:
                found["velocity_cov"] = self.velocity_cov[k]
        return found
