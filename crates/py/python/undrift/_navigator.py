"""The navigator while the vehicle drives: samples and fixes pushed as they come."""

from __future__ import annotations

from collections.abc import AsyncIterable, AsyncIterator, Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt
from undrift import _undrift
from undrift._arguments import Matrix, Vector, covariance, number, place, positive, three
from undrift._array import record
from undrift._drive import Drive
from undrift._errors import ArgumentError
from undrift._logs import GnssLog, ImuLog
from undrift._model import ModelLike
from undrift._solution import FilterState, Solution, filter_state


@dataclass(frozen=True)
class Sample:
    """An inertial sample: mean angular rate [rad/s] and specific force [m/s²], body axes, up to ``time`` [s]."""

    time: float
    gyro: Vector
    accel: Vector
    dt: float | None = None


@dataclass(frozen=True)
class Fix:
    """A fix of the antenna at ``time`` [s]: position (latitude, longitude [rad], height [m]), velocity north, east, down [m/s]."""

    time: float
    position: Vector | None = None
    position_std: float | Vector = 1.0
    velocity: Vector | None = None
    velocity_std: float | Vector = 0.1
    position_cov: npt.ArrayLike | None = None
    velocity_cov: npt.ArrayLike | None = None


@dataclass(frozen=True)
class Scalar:
    """One number at ``time`` [s]: ``kind`` is ``odometer`` [m/s], ``barometer`` [m] or ``heading`` [rad]."""

    kind: str
    time: float
    value: float
    std: float


#: What is pushed.
Pushed: TypeAlias = "Sample | Fix | Scalar"


@dataclass(frozen=True)
class Event:
    """Something that happened in the navigation."""

    time: float
    """When it began or happened [s]."""
    kind: str
    """``started``, ``rejected``, ``sample_fault``, ``heading_off``, ``aligns_again``, ``too_late`` and others."""
    text: str
    """Its sentence."""


class Navigator:
    """The navigator of :func:`navigate`, pushed while the vehicle drives: alignment, gates, faults, late fixes.

    ``model`` at ``rate`` [Hz] is the noise of the IMU. Measurements that come up to ``horizon`` [s] late count as if they had
    come in time. ``keys`` are those of :class:`Drive`: ``lever_arm``, ``vehicle``, ``states``, ``initial``, ``gate``, ``adapt``,
    ``use``, ``mounting="auto"``; samples are pushed in body axes. ``clock`` as of :func:`navigate`.

    A call lasts microseconds, a fix that is late by a second a few milliseconds; the interpreter's lock is free meanwhile, and any
    thread may call. The solution is that at the end of the newest sample but one.

    Examples
    --------
    >>> sim = undrift.simulate("car", 150.0, 50.0)
    >>> nav = undrift.Navigator("adis16465", 50.0)
    >>> for k in range(len(sim.gnss.time)):
    ...     _ = nav.fix(sim.gnss.time[k], **sim.gnss.fix(k))
    >>> solution = nav.imu_many(sim.imu.time, sim.imu.gyro, sim.imu.accel)
    >>> nav.events()[0].kind
    'started'
    """

    def __init__(
        self,
        model: ModelLike,
        rate: float,
        *,
        bias_model: str = "arma",
        horizon: float = 2.0,
        clock: str | None = None,
        vehicle: str | Mapping[str, Any] | None = None,
        states: Mapping[str, Any] | None = None,
        initial: Mapping[str, Any] | None = None,
        **keys: Any,
    ) -> None:
        # Of logs without rows the drive has what is stated of them.
        row, rows = np.zeros(0), np.zeros((0, 3))
        imu = ImuLog(row, rows, rows)
        gnss = GnssLog(row, row, row, row, rows, rows, rows)
        stated: dict[str, Any] = {"vehicle": vehicle, "states": states, "initial": initial, **keys}
        drive = Drive(imu, gnss, model, rate=positive(rate, "rate"), name="<navigator>", **stated)
        self._begin(drive, bias_model, horizon, clock)

    @classmethod
    def from_drive(
        cls,
        drive: Drive,
        bias_model: str = "arma",
        horizon: float = 2.0,
        clock: str | None = None,
    ) -> Navigator:
        """A navigator of a drive's settings, for a vehicle with the same sensors; the logs give the rate alone."""
        drive._needs_fixes("Navigator")
        made = cls.__new__(cls)
        made._begin(drive, bias_model, horizon, clock)
        return made

    def _begin(self, drive: Drive, bias_model: str, horizon: float, clock: str | None) -> None:
        horizon = number(horizon, "horizon")
        self._navigator = _undrift.Navigator(drive._drive, bias_model, horizon, clock)

    # In

    def imu(
        self,
        time: float,
        gyro: Vector,
        accel: Vector,
        dt: float | None = None,
        *,
        increments: bool = False,
    ) -> bool:
        """Pushes a sample that ends at ``time`` [s], in order of time: whether there is a new solution.

        ``dt`` [s] is its length, by default the time since the one before. With ``increments`` they are angles [rad] and velocities
        [m/s] gathered over it. Raises UndriftError for a time that does not go on or numbers that are not finite; the
        navigator then is as before.
        """
        length = None if dt is None else number(dt, "dt")
        rate, force = three(gyro, "gyro"), three(accel, "accel")
        return self._navigator.imu(number(time, "time"), length, rate, force, increments)

    def imu_many(
        self,
        time: npt.ArrayLike,
        gyro: npt.ArrayLike,
        accel: npt.ArrayLike,
        *,
        increments: bool = False,
    ) -> Solution:
        """As :meth:`imu` for n samples, n × 3 each; the solution after each that has one."""
        rates, forces = np.asarray(gyro, np.float64), np.asarray(accel, np.float64)
        arrays = self._navigator.imu_many(record(time, "time"), rates, forces, increments)
        return Solution(**arrays)

    def fix(
        self,
        time: float,
        *,
        position: Vector | None = None,
        position_std: float | Vector = 1.0,
        position_cov: npt.ArrayLike | None = None,
        velocity: Vector | None = None,
        velocity_std: float | Vector = 0.1,
        velocity_cov: npt.ArrayLike | None = None,
    ) -> bool:
        """Pushes a fix of the antenna at ``time`` [s]: whether it came within the horizon.

        ``position`` is latitude, longitude [rad], height above the ellipsoid [m], ``velocity`` north, east, down [m/s]; standard
        deviations or covariances north, east, down.
        """
        placed: tuple[list[float], Matrix] | None = None
        moved: tuple[list[float], Matrix] | None = None
        if position is not None:
            cov = covariance(position_std, position_cov, "position")
            placed = place(position, "position"), cov
        if velocity is not None:
            cov = covariance(velocity_std, velocity_cov, "velocity")
            moved = three(velocity, "velocity"), cov
        return self._navigator.fix(number(time, "time"), placed, moved)

    def odometer(self, time: float, speed: float, std: float = 0.1) -> bool:
        """Pushes the speed of a wheel, forward positive [m/s]: whether it came within the horizon."""
        return self.push(Scalar("odometer", time, speed, std))

    def barometer(self, time: float, height: float, std: float = 1.0) -> bool:
        """Pushes a barometric height [m]: whether it came within the horizon."""
        return self.push(Scalar("barometer", time, height, std))

    def heading(self, time: float, heading: float, std: float) -> bool:
        """Pushes the azimuth of a second antenna as seen from the first [rad]: whether it came within the horizon."""
        return self.push(Scalar("heading", time, heading, std))

    def magnetometer(self, time: float, field: Vector, std: float = 0.5e-6) -> bool:
        """Pushes a magnetic field, body axes [T]: whether it came within the horizon."""
        return self._navigator.magnetometer(
            number(time, "time"), three(field, "field"), positive(std, "std")
        )

    def push(self, item: Pushed) -> bool:
        """Pushes a :class:`Sample`, :class:`Fix` or :class:`Scalar`: what :meth:`imu`, :meth:`fix` and the others return."""
        if isinstance(item, Sample):
            return self.imu(item.time, item.gyro, item.accel, item.dt)
        if isinstance(item, Fix):
            return self.fix(
                item.time,
                position=item.position,
                position_std=item.position_std,
                position_cov=item.position_cov,
                velocity=item.velocity,
                velocity_std=item.velocity_std,
                velocity_cov=item.velocity_cov,
            )
        if isinstance(item, Scalar):
            time, value = number(item.time, "time"), number(item.value, item.kind)
            return self._navigator.scalar(item.kind, time, value, positive(item.std, "std"))
        raise ArgumentError(f"{item!r}: a Sample, Fix or Scalar is needed")

    # Out

    @property
    def state(self) -> FilterState | None:
        """The solution; None before the alignment, and between a restart and the next one."""
        return filter_state(self._navigator)

    def events(self) -> list[Event]:
        """What happened since the last call, in order of time; an event that lasts comes at its start."""
        events = self._navigator.events()
        return [Event(time, kind, _undrift.in_python(text)) for time, kind, text in events]

    @property
    def too_late(self) -> int:
        """Measurements that came later than the horizon and were not used."""
        return self._navigator.too_late

    @property
    def ahead(self) -> float:
        """Time beyond a sample's end up to which fixes may be stamped that hold within it [s]: from a log, push them first."""
        return self._navigator.ahead

    def run(self, items: Iterable[Pushed]) -> Iterator[Event | FilterState]:
        """Pushes all of ``items``: gives each event as it happens and, after each sample, the solution."""
        for item in items:
            yield from self._after(item)

    async def arun(
        self, items: AsyncIterable[Pushed]
    ) -> AsyncIterator[Event | FilterState]:
        """As :meth:`run` of what comes asynchronously, from sockets or queues."""
        async for item in items:
            for given in self._after(item):
                yield given

    def _after(self, item: Pushed) -> Iterator[Event | FilterState]:
        is_new = self.push(item)
        yield from self.events()
        state = self.state if is_new and isinstance(item, Sample) else None
        if state is not None:
            yield state

    def __repr__(self) -> str:
        state = self.state
        return f"Navigator({'not aligned' if state is None else f'time={state.time:.6g}'})"
