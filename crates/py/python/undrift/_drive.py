"""A drive: which logs it consists of and what their columns mean."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any, TypeAlias

from undrift import _toml, _undrift
from undrift._errors import ArgumentError, UndriftError
from undrift._logs import GnssLog, ImuLog
from undrift._model import ModelLike, NoiseModel, compiled
from undrift._solution import FilterState, filter_state
from undrift._tables import Columns, columns, is_table, stated_names

#: A log: a file, a table in memory, or a table of the drive file whose ``file`` is one of these.
Log: TypeAlias = Any

_VEHICLE_LENGTHS = ("axle", "axle_std", "odometer_wheel")

#: SI units of the keys whose numbers have one, table by table (docs/drive-file.md).
UNITS: dict[str, dict[str, str]] = {
    "imu": {
        "time_offset": "s",
        "rate": "Hz",
        "mounting": "rad",
        "gyro_offset": "rad/s",
        "accel_offset": "m/s^2",
    },
    "gnss": {
        "lever_arm": "m",
        "position_std": "m",
        "velocity_std": "m/s",
        "time_offset": "s",
    },
    "poses": {
        "lever_arm": "m",
        "position_std": "m",
        "attitude_std": "rad",
        "marker": "rad",
        "frame": "rad",
        "interval": "s",
        "time_offset": "s",
    },
    "local": {"latitude": "rad", "gravity": "m/s^2"},
    "odometer": {"time_offset": "s", "speed_std": "m/s"},
    "barometer": {
        "time_offset": "s",
        "std": "m",
        "bias_std": "m",
        "bias_walk": "m/sqrt(s)",
    },
    "heading": {"time_offset": "s", "baseline": "rad", "baseline_std": "rad", "std": "rad"},
    "magnetometer": {
        "time_offset": "s",
        "std": "T",
        "lasting_std": "T",
        "hard_iron_std": "T",
        "hard_iron_walk": "T/sqrt(s)",
    },
    "truth": {"time_offset": "s"},
    "vehicle": {
        "non_holonomic": "m/s",
        "non_holonomic_down": "m/s",
        "side_slip": "s",
        "mounting_std": "rad",
        "zero_velocity": "m/s",
        "zero_angular_rate": "rad/s",
        "course": "rad",
        "course_min_speed": "m/s",
        "air_velocity": "m/s",
        "rotor_drag": "m/s^2",
        "wind_std": "m/s",
        **dict.fromkeys(_VEHICLE_LENGTHS, "m"),
    },
    "states": {
        "misalignment": "rad",
        "lever_arm": "m",
        "time_offset": "s",
        "marker": "rad",
        "frame_tilt": "rad",
    },
    "initial": {
        "attitude": "rad",
        "attitude_std": "rad",
        "velocity": "m/s",
        "velocity_std": "m/s",
        "heading": "rad",
        "heading_std": "rad",
        "min_speed": "m/s",
    },
    "span": {"start": "s", "end": "s"},
}

#: Keys that can be set without their table, and the table.
_SHORT = {
    **dict.fromkeys(
        (
            "rate",
            "gyro",
            "gyro_unit",
            "accel",
            "accel_unit",
            "axes",
            "mounting",
            "gyro_offset",
            "accel_offset",
        ),
        "imu",
    ),
    **dict.fromkeys(
        (
            "lever_arm",
            "use",
            "gate",
            "adapt",
            "position_std",
            "velocity_std",
            "position_std_factor",
            "velocity_std_factor",
        ),
        "gnss",
    ),
    **dict.fromkeys(("marker", "attitude_order", "attitude_std", "interval"), "poses"),
}

#: Those of fixes that poses have, too.
_OF_BOTH = ("lever_arm", "gate", "adapt", "position_std")

#: What a log of columns by name is asked for.
_TRUTH_KEYS = (
    "time",
    "time_unit",
    "position",
    "position_unit",
    "velocity",
    "velocity_axes",
    "attitude",
    "attitude_unit",
)


class Drive:
    """A drive, ready to be navigated.

    ``Drive.load("drive.toml")`` reads a drive file. ``Drive(imu, gnss, model)`` has the logs in files
    or in memory: data frames, Arrow tables, structured arrays or dicts of arrays, in a dict also
    arrays of n × 3. Every key of the drive file (docs/drive-file.md) can be set:

    * a log with its keys is a dict with the log as ``file``:
      ``imu={"file": frame, "gyro": ["gx", "gy", "gz"], "gyro_unit": "deg/s", …}``;
    * the keys that only one table has can stand alone: ``rate``, ``gyro``, ``gyro_unit``, ``accel``,
      ``accel_unit``, ``axes``, ``mounting``, ``gyro_offset``, ``accel_offset`` of the IMU;
      ``lever_arm``, ``use``, ``gate``, ``adapt``, ``position_std``, ``velocity_std`` and their
      factors of GNSS;
    * ``odometer``, ``barometer``, ``heading``, ``magnetometer``, ``truth`` are logs like these; ``vehicle`` is a profile or a dict,
      ``states``, ``initial``, ``local`` and ``span`` are dicts, ``span`` also (start, end);
    * ``poses`` of a camera, tracker or scanner in the place of ``gnss`` are a log with ``position`` (n × 3) and
      ``attitude`` (n × 4, its ``attitude_order`` "x,y,z,w" or "w,x,y,z"); ``lever_arm``, ``gate``, ``adapt``,
      ``position_std`` are then keys of the poses, and ``marker``, ``attitude_std``, ``attitude_order`` and
      ``interval`` can stand alone, too;
    * a number with a dimension is a text with its unit, ``"0.1, 0, -1.2 m"``, or a number or three
      of them in SI units and radians, ``(0.1, 0, -1.2)``.

    Columns of a table in memory that are not specified are found by their names, as
    ``gx_dps``, ``accel_x [m/s^2]``, ``lat_deg``: nothing is guessed by the numbers.

    Examples
    --------
    >>> sim = undrift.simulate("car", 150.0, 50.0)
    >>> drive = undrift.Drive(sim.imu, sim.gnss, "adis16405")
    >>> len(drive.imu.time)
    7500
    """

    #: What :func:`undrift.inspect` found of the logs; empty for a drive that it did not make.
    description: str = ""

    def __init__(
        self,
        imu: Log,
        gnss: Log = None,
        model: ModelLike | Mapping[str, Any] | None = None,
        *,
        poses: Log = None,
        truth: Log = None,
        odometer: Log = None,
        barometer: Log = None,
        heading: Log = None,
        magnetometer: Log = None,
        vehicle: str | Mapping[str, Any] | None = None,
        states: Mapping[str, Any] | None = None,
        initial: Mapping[str, Any] | None = None,
        local: Mapping[str, Any] | None = None,
        span: tuple[float | None, float | None] | Mapping[str, Any] | None = None,
        name: str = "<drive>",
        **keys: Any,
    ) -> None:
        if (gnss is None) == (poses is None):
            raise ArgumentError("a drive needs gnss or poses, and not both")
        logs = {"imu": imu}
        optional = {
            "gnss": gnss,
            "poses": poses,
            "truth": truth,
            "odometer": odometer,
            "barometer": barometer,
            "heading": heading,
            "magnetometer": magnetometer,
        }
        logs.update({table: log for table, log in optional.items() if log is not None})
        short: dict[str, dict[str, Any]] = {"imu": {}, "gnss": {}, "poses": {}}
        for key, item in keys.items():
            if key not in _SHORT:
                known = ", ".join(sorted(_SHORT))
                raise ArgumentError(f"unknown key {key}; without their table there are {known}")
            table = "poses" if key in _OF_BOTH and gnss is None else _SHORT[key]
            if table not in logs:
                raise ArgumentError(f"{key}: a key of {table}, which is not given")
            short[table][key] = item
        memory: list[tuple[str, Columns]] = []
        text = ""
        if isinstance(model, Mapping):
            text += f"model = {_toml.value(model)}\n"
            model = None
        for table, log in logs.items():
            text += _log(table, log, short.get(table, {}), memory)
        if isinstance(vehicle, str):
            vehicle = {"profile": vehicle}
        if span is not None and not isinstance(span, Mapping):
            span = {"start": span[0], "end": span[1]}
        tables = {
            "vehicle": vehicle,
            "states": states,
            "initial": initial,
            "local": local,
            "span": span,
        }
        for table, stated in tables.items():
            if stated is not None:
                text += _toml.table(table, stated, UNITS[table])
        self._text = text
        self._drive = _undrift.Drive.from_toml(text, name, memory)
        if model is not None:
            self._drive = self._drive.with_model(compiled(model))

    @classmethod
    def load(
        cls,
        path: str | os.PathLike[str],
        data: str | os.PathLike[str] | None = None,
        model: ModelLike | None = None,
    ) -> Drive:
        """Reads a drive file; ``data`` is the folder of its logs, if not its own, ``model`` replaces its model."""
        made = cls.__new__(cls)
        made._drive = _undrift.Drive.load(path, data)
        made._text = Path(path).read_text(encoding="utf-8")
        return made.with_model(model) if model is not None else made

    @classmethod
    def _inspected(
        cls, drive: _undrift.Drive, text: str, description: str, model: ModelLike | None
    ) -> Drive:
        """The drive that :func:`undrift.inspect` makes."""
        made = cls.__new__(cls)
        made._drive, made._text, made.description = drive, text, description
        return made if model is None else made.with_model(model)

    def with_model(self, model: ModelLike) -> Drive:
        """The same drive with another noise model."""
        made = Drive.__new__(Drive)
        made._text = self._text
        made.description = self.description
        made._drive = self._drive.with_model(compiled(model))
        return made

    @property
    def model(self) -> NoiseModel | None:
        """The noise model of the IMU, if there is one."""
        model = self._drive.model
        return None if model is None else NoiseModel(model)

    @property
    def imu(self) -> ImuLog:
        """The inertial samples, in body axes and SI units, as arrays: read from the log each time."""
        return ImuLog(**self._drive.imu())

    @property
    def gnss(self) -> GnssLog:
        """The fixes as arrays, with the covariances that the filter is given: read from the log each time."""
        self._needs_fixes("Drive.gnss")
        arrays = self._drive.gnss()
        for name in ("position_cov", "velocity_cov"):
            arrays[name] = arrays[name].reshape(-1, 3, 3)
        return GnssLog(**arrays)

    def align(self, bias_model: str = "arma") -> FilterState:
        """Where :func:`undrift.navigate` begins on this drive: the state at the end of the first sample of the solution."""
        return filter_state(_undrift.Filter.from_drive(self._drive, bias_model)[0])

    def _needs_fixes(self, name: str) -> None:
        """Refuses a drive by poses."""
        if self._drive.by_poses:
            raise UndriftError(f"{name}: the drive has poses, not fixes; navigate, outages and tune take it")

    @property
    def toml(self) -> str:
        """The drive file; of a drive in memory, ``file`` names its tables ``<imu>``, ``<gnss>``."""
        return self._text

    def __repr__(self) -> str:
        return f"Drive({str(self._drive.file)!r})"


def _log(
    table: str, log: Log, short: Mapping[str, Any], memory: list[tuple[str, Columns]]
) -> str:
    """The table of a log in the drive file; its columns are added to ``memory`` if it is in memory."""
    keys: dict[str, Any] = {}
    if isinstance(log, Mapping) and "file" in log:
        keys.update({key: item for key, item in log.items() if key != "file"})
        log = log["file"]
    keys.update(short)
    if isinstance(log, (str, os.PathLike)):
        keys = {"file": os.fspath(log), **keys}
    elif is_table(log):
        name = f"<{table}>"
        held = columns(log)
        memory.append((name, held))
        recognised = _recognised(table, stated_names(log, [column for column, _ in held]))
        if "attitude" in keys or "euler" in keys:
            for key in ("attitude", "attitude_order", "euler", "euler_unit"):
                recognised.pop(key, None)
        elif "attitude_order" in recognised:
            # The columns are named x, y, z, w, whatever their order in the table.
            keys.pop("attitude_order", None)
        missing = {key: item for key, item in recognised.items() if not _stated(key, keys)}
        lines = "".join(f"{key} = {item}\n" for key, item in missing.items())
        keys = {"file": name, "format": "csv", **keys}
        return _toml.table(table, keys, UNITS[table]) + lines
    else:
        raise ArgumentError(f"{table}: a {type(log).__name__} is neither a file nor a table")
    return _toml.table(table, keys, UNITS[table])


def _stated(key: str, keys: Mapping[str, Any]) -> bool:
    """Whether a key, or an equivalent one, is stated."""
    if key == "time" and "rate" in keys and "time" not in keys:
        # A rate may stand beside the stamps.
        return False
    if key == "position" and "baseline" in keys:
        return True
    return key in keys or key.replace("_columns", "") in keys


def _recognised(table: str, names: Mapping[str, str]) -> dict[str, str]:
    """The keys of a drive file's table that follow from the names of columns, by those with units."""
    parts = dict(_undrift.parts_by_names(list(names)))
    if table in parts:
        recognised = dict(parts[table])
    elif table == "truth" and "gnss" in parts:
        # A trajectory without attitude.
        recognised = {key: item for key, item in parts["gnss"] if key in _TRUTH_KEYS}
    else:
        return {}
    for with_unit, name in names.items():
        if with_unit != name:
            recognised = {
                key: item.replace(_toml.value(with_unit), _toml.value(name))
                for key, item in recognised.items()
            }
    return recognised
