"""Drives into solutions."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from undrift import _undrift
from undrift._drive import Drive, Log
from undrift._errors import ArgumentError
from undrift._model import ModelLike
from undrift._progress import Progress, reporter
from undrift._result import axes
from undrift._simulate import Simulation
from undrift._solution import UNITS, Solution
from undrift._judged import Judged, judged

if TYPE_CHECKING:
    import matplotlib.axes
    import numpy.typing as npt


@dataclass(frozen=True, eq=False, repr=False)
class Navigation(Solution, Judged):
    """A navigated drive: the solution at every sample, with its warnings."""

    _UNITS = {**UNITS, "diverged": "s"}

    bias_model: str
    """Name of the bias model."""
    smooth: bool
    """Whether the solution is the smoothed one."""
    look_ahead: bool
    """Whether it knows more of the log than what came before; else it is that of a run while driving."""
    alignment: str
    """How it began."""
    fixes: int
    """Fixes used."""
    rmse: Mapping[str, float] | None
    """Root-mean-square error against the truth by component: [m], [m/s], [deg]; None without a truth."""
    nis: Mapping[str, float | None]
    """NIS per degree of freedom of ``position`` and ``velocity``, by poses also ``attitude``: 1 if the model is correct."""
    nees: Mapping[str, float | None]
    """NEES per degree of freedom against the truth, once a second: 1 when the covariance is right."""
    diverged: float | None
    """Time at which the solution came to an end [s]; None if it did not."""
    verdict: str
    """``usable``, ``usable with care`` or ``not usable``, as the terminal prints it; ``warnings`` say why."""
    warnings: tuple[str, ...]
    """Warnings about the solution, in sentences."""
    json: str = field(repr=False)
    """The result as ``undrift navigate --json -`` prints it."""

    @property
    def utc(self) -> npt.NDArray[np.datetime64] | None:
        """Times in UTC, ``datetime64[us]``; None where no log has a date."""
        start = json.loads(self.json)["drive"].get("start")
        if start is None:
            return None
        unix: npt.NDArray[np.float64] = self.time + (start["unix_s"] - start["time_s"])
        return np.round(unix * 1e6).astype(np.int64).astype("datetime64[us]")

    def plot_std(self, ax: matplotlib.axes.Axes | None = None) -> matplotlib.axes.Axes:
        """Standard deviation of the position over time. Needs ``undrift[plot]``."""
        ax = axes(ax)
        for name, column in zip(("north", "east", "down"), self.position_std.T, strict=True):
            ax.plot(self.time, column, label=name)
        ax.set_yscale("log")
        ax.set_xlabel("time [s]")
        ax.set_ylabel("standard deviation [m]")
        ax.legend()
        return ax


def drive_of(
    drive: Log | Drive | Simulation,
    gnss: Log,
    model: ModelLike | Mapping[str, Any] | None,
    data: str | os.PathLike[str] | None,
    keys: Mapping[str, Any],
) -> Drive:
    """The drive that is meant by the arguments of ``navigate`` and ``outages``."""
    if gnss is not None or keys.get("poses") is not None:
        if data is not None:
            raise ArgumentError("data goes with a drive file: give the paths of the logs instead")
        return Drive(drive, gnss, model, **keys)
    if keys:
        raise ArgumentError(f"{', '.join(keys)}: needs logs, but gnss is missing (or poses)")
    if isinstance(model, Mapping):
        raise ArgumentError("the model of a drive is a name, a file or a NoiseModel")
    if isinstance(drive, Simulation):
        drive = drive.drive()
    elif isinstance(drive, (str, os.PathLike)):
        drive = Drive.load(drive, data)
    elif not isinstance(drive, Drive):
        raise ArgumentError(f"a {type(drive).__name__} is no drive: gnss is missing beside it (or poses)")
    return drive if model is None else drive.with_model(model)


def navigate(
    drive: Log | Drive | Simulation,
    gnss: Log = None,
    model: ModelLike | Mapping[str, Any] | None = None,
    *,
    data: str | os.PathLike[str] | None = None,
    bias_model: str = "arma",
    smooth: bool = False,
    look_ahead: bool = False,
    output: str | os.PathLike[str] | Iterable[str | os.PathLike[str]] = (),
    format: str | None = None,
    every: float | None = None,
    clock: str | None = None,
    solution: bool = True,
    strict: bool | None = None,
    progress: Progress = False,
    **keys: Any,
) -> Navigation:
    """Navigates a drive: IMU and GNSS into position, velocity and attitude.

    ``navigate("drive.toml")`` takes a drive file, with ``data`` as the folder of its logs if it is
    not its own; or a :class:`Drive`; or a :class:`Simulation`. ``navigate(imu, gnss, model, …)``
    takes the logs themselves, in files or in memory, and all that :class:`Drive` takes; ``poses=`` is then in the
    place of ``gnss``.

    ``bias_model`` is white, paper, gauss-markov, random-walk, ar or arma. With ``smooth`` the
    solution is at every sample the best estimate given the whole log. ``output`` are files to write
    it to, in the ``format`` of the extension or the specified one; ``every`` is the least time between
    rows of the files [s]. Without ``solution`` the arrays are empty: 31 numbers a sample, for long logs.
    ``progress`` is True for a bar, or ``tqdm`` or what is called like it.

    Parameters
    ----------
    drive : str, path, Drive, Simulation or log
        Drive file, drive, or the log of the IMU.
    gnss : log, optional
        Log of GNSS, where ``drive`` is that of the IMU.
    model : str, path or NoiseModel, optional
        Noise model of the IMU.
    data : str or path, optional
        Folder of the logs of a drive file, if not its own.
    bias_model : str
        white, paper, gauss-markov, random-walk, ar or arma.
    smooth : bool
        Whether the solution is the smoothed one.
    look_ahead : bool
        Whether the errors of all fixes are studied and the mounting is found first, else both from the log so far, as while
        driving.
    output : path or iterable of paths
        Files to write the solution to.
    format : str, optional
        Format of the files, if not that of their extension.
    every : float, optional
        Least time between rows of the files [s].
    clock : str, optional
        Whose times the solution has: ``"imu"``, as the samples are stamped, or ``"gnss"``, as the fixes are. By default those
        of the samples, and where the two differ the standard deviations contain it.
    solution : bool
        Whether the arrays are kept.
    strict : bool, optional
        True: what is usable with care raises, too; False: what is not usable warns, too.
    progress : bool or callable
        True for a bar; or ``tqdm``, or what is called like it.
    **keys
        Further keys of :class:`Drive`.

    Returns
    -------
    Navigation
        The solution over time, with statistics and warnings.

    Raises
    ------
    UndriftError
        For a drive that cannot be read or aligned; :class:`ArgumentError` for a wrong type.
    VerdictError
        For a result that is not usable, unless ``strict`` is False; it has the ``result``.

    Examples
    --------
    >>> sim = undrift.simulate("car", 150.0, 50.0)
    >>> nav = undrift.navigate(sim)
    >>> nav.rmse["north_m"] < 1.0
    True
    """
    made = drive_of(drive, gnss, model, data, keys)
    files = [output] if isinstance(output, (str, os.PathLike)) else list(output)
    with reporter(progress, "navigate") as report:
        text, brief, (verdict, line), arrays = _undrift.navigate(
            made._drive,
            bias_model,
            smooth,
            look_ahead,
            files,
            format,
            every,
            clock,
            solution,
            report,
        )
    # Without the series for plots, which take longer to parse than many a drive takes to navigate.
    decoded = json.loads(brief)
    summary = decoded["summary"]
    done = Navigation(
        **arrays,
        json=text,
        bias_model=decoded["bias_model"],
        smooth=decoded["smooth"],
        look_ahead=decoded["look_ahead"],
        alignment=summary["alignment"],
        fixes=summary["fixes"],
        rmse=decoded["rms_error"],
        nis=_nis(decoded),
        nees=decoded["nees_per_dof"],
        diverged=summary["diverged"],
        verdict=verdict,
        warnings=tuple(map(_undrift.in_python, decoded["warnings"])),
    )
    return judged(done, line, strict)


def _nis(decoded: Mapping[str, Any]) -> dict[str, float | None]:
    """The NIS per degree of freedom of what was measured."""
    found = {part: decoded[part]["nis_per_dof"] for part in ("position", "velocity")}
    attitude = decoded["summary"]["attitude"]
    if attitude["dof_sum"]:
        found["attitude"] = attitude["nis_sum"] / attitude["dof_sum"]
    return found
