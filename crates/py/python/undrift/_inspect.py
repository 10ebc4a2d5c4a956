"""Logs into drives."""

from __future__ import annotations

import os
from typing import Any

from undrift import _undrift
from undrift._array import Floats
from undrift._drive import Drive
from undrift._errors import ArgumentError
from undrift._model import ModelLike
from undrift._tables import is_table, with_units


def inspect(*logs: Any, vehicle: str | None = None, model: ModelLike | None = None) -> Drive:
    """Describes logs as ``undrift inspect`` does, and makes a drive of them.

    A log is a file of any format, or a table in memory as :class:`Drive` takes it. ``drive.description`` is what was
    found, with how each value is known; ``drive.toml`` is the drive file, in which what is guessed is marked.

    Parameters
    ----------
    *logs : str, path or table
        Logs of an IMU and of GNSS, or of poses, or one that has both; of a reference, if there is one.
    vehicle : str, optional
        Profile of the vehicle, such as car.
    model : str, path or NoiseModel, optional
        Noise model of the IMU, instead of one that is guessed.

    Returns
    -------
    Drive
        The drive, for :func:`navigate`, :func:`outages` and :func:`tune`.

    Raises
    ------
    UndriftError
        For a log that cannot be read, and for logs without inertial samples or positions.

    Examples
    --------
    >>> sim = undrift.simulate("car", 150.0, 50.0)
    >>> drive = undrift.inspect(sim.imu, sim.gnss)
    >>> print(drive.description.splitlines()[1])
      [imu] 7500 records at 50 Hz, 0.020 s to 150.000 s; no gaps
    """
    if not logs:
        raise ArgumentError("inspect needs a log")
    found: list[tuple[str | os.PathLike[str], list[tuple[str, Floats]] | None]] = []
    for number, log in enumerate(logs, 1):
        if isinstance(log, (str, os.PathLike)):
            found.append((log, None))
        elif is_table(log):
            found.append((f"<log {number}>", with_units(log)))
        else:
            raise ArgumentError(f"a {type(log).__name__} is neither a file nor a table")
    return Drive._inspected(*_undrift.inspect(found, vehicle), model)
