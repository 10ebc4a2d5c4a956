"""Simulated drives."""

from __future__ import annotations

import os
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from undrift import _toml, _undrift
from undrift._arguments import number, positive, three, whole
from undrift._array import Floats
from undrift._drive import UNITS, Drive
from undrift._logs import GnssLog, ImuLog
from undrift._model import ModelLike, NoiseModel, compiled
from undrift._result import Result
from undrift._solution import Placed

if TYPE_CHECKING:
    import matplotlib.axes

Three = tuple[float, float, float]


@dataclass(frozen=True)
class GnssReceiver:
    """What a simulated receiver reports, when, and how well; by default a carrier-phase receiver.

    Examples
    --------
    >>> receiver = undrift.GnssReceiver(position_std=(1.0, 1.0, 2.0), rate=5.0)
    >>> len(undrift.simulate("rest", 10.0, 50.0, gnss=receiver).gnss.time)
    46
    """

    position_std: Three = (0.02, 0.02, 0.04)
    """Standard deviation of the position, north, east, down [m]."""
    velocity_std: Three = (0.03, 0.03, 0.03)
    """Standard deviation of the velocity, north, east, down [m/s]."""
    rate: float = 1.0
    """Fixes a second [Hz]."""
    start: float = 1.0
    """Time of the first fix [s], before ``time_offset``."""
    time_offset: float = 0.0
    """Offset of every fix [s]; those before 0 are omitted."""
    lever_arm: Three = (0.0, 0.0, 0.0)
    """From the IMU to the antenna, body axes [m]."""
    position: bool = True
    """Whether fixes have a position."""
    velocity: bool = True
    """Whether fixes have a velocity."""
    noise_scale: float = 1.0
    """Factor on the noise that is drawn, not on the standard deviations that are reported."""


@dataclass(frozen=True, eq=False, repr=False)
class Truth(Placed):
    """What the IMU did: at time 0, then at the end of each inertial sample."""

    time: Floats
    """Time [s]."""
    lat: Floats
    """Latitude [rad]."""
    lon: Floats
    """Longitude [rad]."""
    height: Floats
    """Height above the ellipsoid [m]."""
    velocity: Floats
    """Velocity, north, east, down [m/s], n × 3."""
    rpy: Floats
    """Roll, pitch, yaw [rad], n × 3."""


@dataclass(frozen=True, eq=False, repr=False)
class Simulation(Result):
    """A simulated drive: what the sensors report, and the truth."""

    _UNITS = {"rate": "Hz"}

    imu: ImuLog
    """Inertial samples."""
    gnss: GnssLog
    """Fixes."""
    truth: Truth
    """The truth at the IMU."""
    receiver: GnssReceiver
    """The receiver."""
    rate: float
    """Rate of the inertial samples [Hz]."""
    seed: int
    """Seed of the trajectory and of all noise."""
    model: NoiseModel | None = field(repr=False)
    """The noise model of the IMU; None if it is free of errors."""

    def drive(self, *, truth: bool = True, **keys: Any) -> Drive:
        """The drive in memory; ``keys`` are further ones of :class:`Drive`."""
        logs = {table: {"file": dict(log[0]), **log[1]} for table, log in self._logs(truth).items()}
        reference = {"truth": logs["truth"]} if truth else {}
        return Drive(logs["imu"], logs["gnss"], self.model, **reference, name="<simulation>", **keys)

    def poses(
        self,
        rate: float = 50.0,
        *,
        position_std: float = 1e-3,
        attitude_std: float = 1.75e-3,
        marker: Three = (0.0, 0.0, 0.0),
        lever_arm: Three = (0.0, 0.0, 0.0),
        time_offset: float = 0.0,
    ) -> dict[str, Floats]:
        """Poses of a marker at about ``rate`` [Hz], with white noise [m, rad]: a log for ``poses`` of :class:`Drive`.

        ``marker`` are roll, pitch, yaw of its axes in the body [rad], ``lever_arm`` leads from the IMU to it [m],
        ``time_offset`` has to be added to the stamps [s]. The frame begins where the IMU did, x north, z up;
        ``attitude`` is x, y, z, w.
        """
        every = slice(None, None, max(1, round(self.rate / positive(rate, "rate"))))
        at = self.truth
        seen = {
            "position_std": positive(position_std, "position_std"),
            "attitude_std": positive(attitude_std, "attitude_std"),
            "marker": three(marker, "marker"),
            "lever_arm": three(lever_arm, "lever_arm"),
            "time_offset": number(time_offset, "time_offset"),
        }
        places = np.column_stack((at.lat, at.lon, at.height))
        time, place, rpy = (np.ascontiguousarray(part[every]) for part in (at.time, places, at.rpy))
        return _undrift.simulate_poses(time, place, rpy, seen, self.seed)

    def save(self, folder: str | os.PathLike[str]) -> Path:
        """Writes ``imu.csv``, ``gnss.csv``, ``truth.csv``, ``imu.toml`` and ``drive.toml``, which is returned.

        The numbers have all their digits: what is navigated from the files is the same.
        """
        folder = Path(folder)
        folder.mkdir(parents=True, exist_ok=True)
        text = ""
        if self.model is not None:
            self.model.save(folder / "imu.toml")
            text = 'model = "imu.toml"\n\n'
        for table, (columns, keys) in self._logs(True).items():
            _undrift.write_csv(folder / f"{table}.csv", columns)
            text += _toml.table(table, {"file": f"{table}.csv", **keys}, UNITS[table]) + "\n"
        path = folder / "drive.toml"
        path.write_text(text, encoding="utf-8")
        return path

    def _logs(self, truth: bool) -> dict[str, tuple[list[tuple[str, Floats]], dict[str, Any]]]:
        """The logs as a drive file has them: columns by name, and the keys that describe them."""
        imu, gnss, reference = self.imu, self.gnss, self.truth
        rates, forces = ("gx_radps", "gy_radps", "gz_radps"), ("fx_mps2", "fy_mps2", "fz_mps2")
        place, velocity = ("lat_deg", "lon_deg", "height_m"), ("vn_mps", "ve_mps", "vd_mps")
        stds, velocity_stds = ("sn_m", "se_m", "sd_m"), ("svn_mps", "sve_mps", "svd_mps")
        angles = ("roll_deg", "pitch_deg", "yaw_deg")
        of_gnss: dict[str, Any] = {"time": "t_s", "lever_arm": self.receiver.lever_arm}
        columns = [("t_s", gnss.time)]
        if self.receiver.position:
            of_gnss |= {"position": place, "position_std_columns": stds}
            columns += [*_place(place, gnss), *_columns(stds, gnss.position_std)]
        if self.receiver.velocity:
            of_gnss |= {"velocity": velocity, "velocity_std_columns": velocity_stds}
            columns += [
                *_columns(velocity, gnss.velocity),
                *_columns(velocity_stds, gnss.velocity_std),
            ]
        of_imu = {
            "time": "t_s",
            "rate": self.rate,
            "gyro": rates,
            "gyro_unit": "rad/s",
            "accel": forces,
            "accel_unit": "m/s^2",
        }
        logs: dict[str, tuple[list[tuple[str, Floats]], dict[str, Any]]] = {
            "imu": (
                [("t_s", imu.time), *_columns(rates, imu.gyro), *_columns(forces, imu.accel)],
                of_imu,
            ),
            "gnss": (columns, of_gnss),
        }
        if truth:
            logs["truth"] = (
                [
                    ("t_s", reference.time),
                    *_place(place, reference),
                    *_columns(velocity, reference.velocity),
                    *_columns(angles, np.degrees(reference.rpy)),
                ],
                {"time": "t_s", "position": place, "velocity": velocity, "attitude": angles},
            )
        return logs

    def plot(
        self,
        ax: matplotlib.axes.Axes | None = None,
        *,
        label: str | None = None,
        unit: str = "m",
    ) -> matplotlib.axes.Axes:
        """The ground track, east over north from its start, in m or km. Needs ``undrift[plot]``."""
        return self.truth.plot(ax, label=label, unit=unit)


def _columns(names: tuple[str, ...], values: Floats) -> list[tuple[str, Floats]]:
    return list(zip(names, values.T, strict=True))


def _place(names: tuple[str, str, str], log: Any) -> list[tuple[str, Floats]]:
    return list(zip(names, (log.lat_deg, log.lon_deg, log.height), strict=True))


def simulate(
    trajectory: str = "car",
    duration: float = 600.0,
    rate: float = 100.0,
    model: ModelLike | None = "adis16405",
    *,
    gnss: GnssReceiver | None = None,
    bias_model: str = "gauss-markov",
    seed: int = 1,
    speed: float = 10.0,
    course: float = 0.0,
    turn_rate: float = 0.1,
    swing: float = 0.6,
) -> Simulation:
    """Simulates a drive of ``duration`` [s] with an IMU at ``rate`` [Hz].

    ``trajectory`` is ``car``, ``flight`` (drawn from the seed, with a rest before), ``handheld`` (in a room,
    for :meth:`Simulation.poses`; turned by up to ``swing`` [rad]), ``rest``, ``straight`` (``speed`` [m/s], ``course`` [rad]) or ``turn`` (``speed``, ``turn_rate`` [rad/s]).
    The motion is analytic, so the increments are exact. ``model`` draws the sensors' errors, turn-on
    constants included, as its ``bias_model``; None leaves them out. One seed gives the same drive
    everywhere.

    Parameters
    ----------
    trajectory : {"car", "flight", "handheld", "rest", "straight", "turn"}
        What moves how.
    duration : float
        Length [s].
    rate : float
        Rate of the inertial samples [Hz].
    model : str, path, NoiseModel or None
        Noise of the IMU; None for none.
    gnss : GnssReceiver, optional
        The receiver.
    bias_model : str
        How the noise is drawn.
    seed : int
        Seed; one gives the same on every machine.
    speed : float
        Speed of ``straight`` and ``turn`` [m/s].
    course : float
        Course of ``straight`` [rad].
    turn_rate : float
        Turn rate of ``turn`` [rad/s].
    swing : float
        Turns of ``handheld`` [rad].

    Returns
    -------
    Simulation
        Logs of IMU and GNSS, and the truth.

    Raises
    ------
    UndriftError
        For a recording or argument that cannot be; :class:`ArgumentError` for a wrong type.

    Examples
    --------
    >>> sim = undrift.simulate("rest", 10.0, 50.0)
    >>> sim.imu.gyro.shape
    (500, 3)
    """
    receiver = GnssReceiver() if gnss is None else gnss
    noise = None if model is None else model if isinstance(model, NoiseModel) else NoiseModel.load(model)
    motion = {
        "kind": trajectory,
        "duration": number(duration, "duration"),
        "speed": number(speed, "speed"),
        "course": number(course, "course"),
        "turn_rate": number(turn_rate, "turn_rate"),
        "swing": number(swing, "swing"),
    }
    imu, fixes, truth = _undrift.simulate(
        motion,
        positive(rate, "rate"),
        None if noise is None else compiled(noise),
        bias_model,
        asdict(receiver),
        whole(seed, "seed"),
    )
    return Simulation(ImuLog(**imu), GnssLog(**fixes), Truth(**truth), receiver, rate, seed, noise)
