"""The filter, step by step."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt
from undrift import _undrift
from undrift._arguments import (
    Vector,
    covariance,
    deviations,
    limits,
    number,
    place,
    positive,
    three,
)
from undrift._array import Floats, record
from undrift._model import ModelLike, compiled
from undrift._result import Result
from undrift._solution import FilterState, Solution, filter_state

if TYPE_CHECKING:
    from undrift._drive import Drive


@dataclass(frozen=True, eq=False, repr=False)
class Innovation(Result):
    """What an update did."""

    kind: str
    """Kind of measurement."""
    innovation: Floats
    """Predicted less measured, in the measurement's units."""
    nis: float
    """Normalised innovation squared: chi-squared with ``dof`` degrees of freedom when the model is right."""
    dof: int
    """Numbers measured."""
    whitened: Floats
    """Innovation over its standard deviation: independent and standard normal when the model is right."""
    outcome: str
    """``used``, ``weakened`` or ``rejected``."""
    factor: float
    """Factor on the measurement's covariance: 1 if used as it was, above 1 if weakened, infinite if rejected."""


class Filter:
    """The error-state Kalman filter that ``navigate`` runs, one step after the other.

    It starts at ``position`` (latitude, longitude [rad], height [m]), ``velocity`` north, east, down
    [m/s] and ``rpy`` [rad] at ``time`` [s], with standard deviations or, of position and velocity,
    covariances. ``model`` at ``rate`` [Hz] gives the sensors' noise. ``lever_arm`` [m], body axes, is
    the antenna's. ``parameters`` are constants to estimate with their standard deviation, or (standard
    deviation, random walk [unit/√s]): gyro_scale, accel_scale, gyro_misalignment,
    accel_misalignment, lever_arm, time_offset, mounting, axle, odometer_scale, barometer_bias,
    velocity_time_offset, clock_rate, accel_delay, heading_offset, hard_iron.

    Every update returns an :class:`Innovation`; ``gate`` = (weaken, reject) are limits of its NIS:
    above the first the measurement's covariance grows, above the second it is rejected.

    Examples
    --------
    >>> f = undrift.Filter("adis16405", rate=100.0, position=(0.8, 0.1, 300.0))
    >>> f.predict((0.0, 0.0, 0.0), (0.0, 0.0, -9.81))
    >>> f.update_zero_velocity().outcome
    'used'
    >>> f.time
    0.01
    """

    def __init__(
        self,
        model: ModelLike,
        bias_model: str = "arma",
        rate: float = 100.0,
        *,
        position: Vector,
        velocity: Vector = (0.0, 0.0, 0.0),
        rpy: Vector = (0.0, 0.0, 0.0),
        time: float = 0.0,
        position_std: float | Vector = 1.0,
        velocity_std: float | Vector = 0.1,
        attitude_std: float | Vector = 0.02,
        position_cov: npt.ArrayLike | None = None,
        velocity_cov: npt.ArrayLike | None = None,
        lever_arm: Vector = (0.0, 0.0, 0.0),
        parameters: Mapping[str, float | tuple[float, float]] | None = None,
    ) -> None:
        start = {
            "time": number(time, "time"),
            "position": place(position, "position"),
            "velocity": three(velocity, "velocity"),
            "rpy": three(rpy, "rpy"),
            "position_cov": covariance(position_std, position_cov, "position"),
            "velocity_cov": covariance(velocity_std, velocity_cov, "velocity"),
            "attitude_std": deviations(attitude_std, "attitude_std"),
        }
        asked = []
        for name, prior in (parameters or {}).items():
            std, walk = prior if isinstance(prior, tuple) else (prior, 0.0)
            asked.append((name, positive(std, name), number(walk, name)))
        self._interval = 1.0 / positive(rate, "rate")
        self._lever_arm = three(lever_arm, "lever_arm")
        self._filter = _undrift.Filter(compiled(model), bias_model, float(rate), start, asked)
        self._innovation: Innovation | None = None

    @classmethod
    def from_drive(cls, drive: Drive, bias_model: str = "arma") -> Filter:
        """The filter as :func:`undrift.navigate` begins it on a drive, for a loop over :attr:`Drive.imu` and :attr:`Drive.gnss`.

        It is at the end of the sample in which the alignment was complete, with all that the drive asks it to
        estimate, the antenna's lever arm, and what the fixes are known to be wrong by.
        """
        drive._needs_fixes("Filter")
        made = cls.__new__(cls)
        made._filter, made._lever_arm, made._interval = _undrift.Filter.from_drive(
            drive._drive, bias_model
        )
        made._innovation = None
        return made

    # Time

    def predict(
        self,
        gyro: Vector,
        accel: Vector,
        dt: float | None = None,
        *,
        time: float | None = None,
        increments: bool = False,
    ) -> None:
        """Carries the filter over a sample: mean angular rate [rad/s] and specific force [m/s²], body axes.

        ``dt`` [s] is its interval, by default 1/rate, at most 10 s; ``time`` [s] its end, by default the
        present time and ``dt``. With ``increments`` they are angles [rad] and velocities [m/s] gathered
        over it. A sample must begin at the filter's time, to half of ``dt``: across a gap of a few
        samples, pass ``dt`` of the whole gap.

        Raises UndriftError for time that goes backwards, a gap, or values after which there is no
        solution; the filter is then as before.
        """
        self._sample(self._filter.predict, gyro, accel, dt, time, increments)

    def begin(
        self,
        gyro: Vector,
        accel: Vector,
        dt: float | None = None,
        *,
        time: float | None = None,
        increments: bool = False,
    ) -> None:
        """Takes up a sample without moving yet, as :meth:`predict`: for fixes inside of its interval.

        What is left of the sample before is done first.
        """
        self._sample(self._filter.begin, gyro, accel, dt, time, increments)

    def _sample(
        self,
        take: Callable[[float | None, float, list[float], list[float], bool], None],
        gyro: Vector,
        accel: Vector,
        dt: float | None,
        time: float | None,
        increments: bool,
    ) -> None:
        dt = self._interval if dt is None else number(dt, "dt")
        end = None if time is None else number(time, "time")
        take(end, dt, three(gyro, "gyro"), three(accel, "accel"), increments)

    def advance(self, time: float | None = None) -> None:
        """Moves to ``time`` [s] within the sample taken up, or to its end."""
        self._filter.advance(None if time is None else number(time, "time"))

    def predict_many(
        self,
        gyro: npt.ArrayLike,
        accel: npt.ArrayLike,
        dt: float | None = None,
        *,
        time: npt.ArrayLike | None = None,
        increments: bool = False,
    ) -> Solution:
        """As :meth:`predict` over n samples, n × 3 each; the solution after every one of them.

        ``time`` are the ends of the intervals [s]; the first interval is ``dt``, by default 1/rate.
        Without it all are ``dt``. After an error the filter is as before the first of them.
        """
        rates, forces = np.asarray(gyro, np.float64), np.asarray(accel, np.float64)
        dt = self._interval if dt is None else number(dt, "dt")
        ends = None if time is None else record(time, "time")
        arrays = self._filter.predict_many(ends, dt, rates, forces, increments)
        return Solution(**arrays)

    # Measurements

    def update_gnss(
        self,
        *,
        position: Vector | None = None,
        position_std: float | Vector = 1.0,
        position_cov: npt.ArrayLike | None = None,
        velocity: Vector | None = None,
        velocity_std: float | Vector = 0.1,
        velocity_cov: npt.ArrayLike | None = None,
        lever_arm: Vector | None = None,
        gate: tuple[float, float] | None = None,
    ) -> tuple[Innovation, ...]:
        """Updates with the antenna's position (latitude, longitude [rad], height [m]), then its velocity [m/s].

        Standard deviations, or covariances, are north, east, down. Both are used or, after an error, none.
        """
        lever = self._lever_arm if lever_arm is None else three(lever_arm, "lever_arm")
        measured = []
        if position is not None:
            cov = covariance(position_std, position_cov, "position")
            measured.append(_measured("position", place(position, "position"), lever, cov=cov))
        if velocity is not None:
            cov = covariance(velocity_std, velocity_cov, "velocity")
            measured.append(_measured("velocity", three(velocity, "velocity"), lever, cov=cov))
        return self._update(measured, gate)

    def update_zero_velocity(
        self, std: float = 0.02, gate: tuple[float, float] | None = None
    ) -> Innovation | None:
        """Updates with rest: no velocity, ``std`` [m/s]."""
        return self._one(_measured("zero velocity", std=positive(std, "std")), gate)

    def update_earth_rate(
        self, gyro: Vector, std: float, gate: tuple[float, float] | None = None
    ) -> Innovation | None:
        """Updates with a mean angular rate at rest [rad/s]: what it is beyond the Earth's is the gyros' error."""
        value = three(gyro, "gyro")
        return self._one(_measured("earth rate", value, std=positive(std, "std")), gate)

    def update_level(
        self, accel: Vector, std: float, gate: tuple[float, float] | None = None
    ) -> Innovation | None:
        """Updates with a mean specific force at rest [m/s²], which points up."""
        value = three(accel, "accel")
        return self._one(_measured("level", value, std=positive(std, "std")), gate)

    def update_non_holonomic(
        self,
        right_std: float = 0.2,
        down_std: float = 0.4,
        axle: Vector = (0.0, 0.0, 0.0),
        gate: tuple[float, float] | None = None,
    ) -> Innovation | None:
        """Updates with that the axle that does not steer, at ``axle`` from the IMU [m], does not slide: [m/s]."""
        value = [positive(right_std, "right_std"), positive(down_std, "down_std"), 0.0]
        return self._one(_measured("non-holonomic", value, three(axle, "axle")), gate)

    def update_odometer(
        self,
        speed: float,
        std: float = 0.1,
        wheel: Vector = (0.0, 0.0, 0.0),
        gate: tuple[float, float] | None = None,
    ) -> Innovation | None:
        """Updates with the speed of the wheel at ``wheel`` from the IMU [m], forward positive [m/s]."""
        value, lever = [number(speed, "speed"), 0.0, 0.0], three(wheel, "wheel")
        return self._one(_measured("odometer", value, lever, std=positive(std, "std")), gate)

    def update_barometer(
        self, height: float, std: float = 1.0, gate: tuple[float, float] | None = None
    ) -> Innovation | None:
        """Updates with a barometric height [m]; its constant error is the parameter barometer_bias."""
        value = [number(height, "height"), 0.0, 0.0]
        return self._one(_measured("barometer", value, std=positive(std, "std")), gate)

    def update_magnetometer(
        self,
        field: Vector,
        std: float,
        earth: Vector,
        gate: tuple[float, float] | None = None,
    ) -> Innovation | None:
        """Updates with a magnetic field, body axes, where ``earth`` is the Earth's north, east, down, both [T]; the hard iron is the
        parameter hard_iron."""
        value, field_n = three(field, "field"), three(earth, "earth")
        std = positive(std, "std")
        return self._one(_measured("magnetometer", value, field_n, std=std), gate)

    def update_heading(
        self, heading: float, std: float, gate: tuple[float, float] | None = None
    ) -> Innovation | None:
        """Updates with the azimuth of a second antenna ahead of the first [rad]; where else it is, is the parameter heading_offset."""
        value = [number(heading, "heading"), 0.0, 0.0]
        return self._one(_measured("heading", value, std=positive(std, "std")), gate)

    def update_course(
        self, course: float, std: float, gate: tuple[float, float] | None = None
    ) -> Innovation | None:
        """Updates the heading with a course over ground [rad]; None while the vehicle points up or down."""
        value = [number(course, "course"), 0.0, 0.0]
        return self._one(_measured("course", value, std=positive(std, "std")), gate)

    def _one(
        self, measured: dict[str, Any], gate: tuple[float, float] | None
    ) -> Innovation | None:
        done = self._update([measured], gate)
        return done[0] if done else None

    def _update(
        self, measured: list[dict[str, Any]], gate: tuple[float, float] | None
    ) -> tuple[Innovation, ...]:
        """Updates with all or, after an error, with none."""
        updates = tuple(
            Innovation(kind, np.array(innovation), nis, dof, np.array(whitened), outcome, factor)
            for kind, innovation, nis, dof, whitened, outcome, factor in self._filter.update(
                measured, limits(gate)
            )
        )
        if updates:
            self._innovation = updates[-1]
        return updates

    # What it knows

    @property
    def time(self) -> float:
        """Time that it has reached [s]."""
        return self._filter.time

    @property
    def innovation(self) -> Innovation | None:
        """Of the last update."""
        return self._innovation

    @property
    def state(self) -> FilterState:
        """Position, velocity, attitude, sensor errors and parameters with their standard deviations."""
        return filter_state(self._filter)

    @property
    def covariance(self) -> Floats:
        """Covariance of the error state, n × n, a copy: position error north, east, down [m], velocity
        error [m/s], misalignment [rad], then the states of the six sensor axes, then parameters.
        """
        return self._filter.covariance()

    def __copy__(self) -> Filter:
        made = Filter.__new__(Filter)
        made.__dict__.update(self.__dict__)
        made._filter = self._filter.copy()
        return made

    def __deepcopy__(self, memo: object) -> Filter:
        return self.__copy__()

    def __getstate__(self) -> dict[str, Any]:
        return {**self.__dict__, "_filter": self._filter.numbers()}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state)
        self._filter = _undrift.Filter.from_numbers(state["_filter"])

    def __repr__(self) -> str:
        return f"Filter(time={self.time:.6g}, states={len(self.covariance)})"


def _measured(
    kind: str,
    value: list[float] | None = None,
    lever: list[float] | None = None,
    *,
    std: float = 0.0,
    cov: list[list[float]] | None = None,
) -> dict[str, Any]:
    """A measurement as the compiled half takes it."""
    zero = [0.0, 0.0, 0.0]
    return {
        "kind": kind,
        "value": value or zero,
        "std": std,
        "lever_arm": lever or zero,
        "covariance": cov,
    }
