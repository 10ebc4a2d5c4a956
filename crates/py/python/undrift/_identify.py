"""Static records into noise models."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from numbers import Real
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt
from undrift import _undrift
from undrift._arguments import positive, whole
from undrift._array import Floats
from undrift._array import record as array_of
from undrift._errors import ArgumentError
from undrift._model import ModelLike, NoiseModel, compiled
from undrift._progress import Progress, reporter
from undrift._result import Result, axes
from undrift._tables import columns as columns_of
from undrift._tables import index_of, is_table, with_units
from undrift._judged import Judged, judged
from undrift._units import factor

if TYPE_CHECKING:
    import matplotlib.axes

#: Names of the six axes in the order of columns.
AXES = ("gyro_x", "gyro_y", "gyro_z", "accel_x", "accel_y", "accel_z")


@dataclass(frozen=True, eq=False, repr=False)
class Candidate(Result):
    """A model of an axis; "unit" is rad/s or m/s²."""

    name: str
    """Name, such as ``ARMA(1,1)`` or ``white + random walk``."""
    states: int
    """States of its shaping filter, the turn-on constant's included."""
    drift: Mapping[str, float]
    """RMS error of the predicted integral [unit·s] by the horizon in seconds.

    Fitted on one half of the record and scored on the other, both ways."""
    drift_error: Mapping[str, float]
    """Standard errors of these."""
    parameters: Mapping[str, Any] = field(repr=False)
    """All that was found of it, as in :attr:`Identified.data`."""
    compared: bool
    """Whether it is a method of the literature or an order by F tests or AIC: scored for comparison, never recommended."""


@dataclass(frozen=True, eq=False, repr=False)
class AxisIdentified(Result):
    """What was found out about one axis; "unit" is rad/s or m/s²."""

    samples: int
    """Samples."""
    mean: float
    """Their mean [unit]."""
    unit: str
    """rad/s or m/s^2."""
    candidates: tuple[Candidate, ...] = field(repr=False)
    """The candidates, the least drift after the longest time first."""
    recommended: Candidate
    """The simplest of the likeliest candidates that drift as little as the best."""
    reason: str
    """Why it is recommended."""
    stationarity: str
    """The conclusion from ADF, KPSS and Phillips-Perron."""
    taus: Floats
    """Averaging times of the Allan deviation [s]."""
    adev: Floats
    """Overlapping Allan deviation [unit]."""
    adev_lower: Floats
    """Lower end of its confidence interval."""
    adev_upper: Floats
    """Upper end of its confidence interval."""
    adev_fit: Floats
    """Deviation of the terms fitted."""
    tests: Mapping[str, Any] = field(repr=False)
    """The tests by name: adf, kpss, phillips_perron, jarque_bera, ks, lilliefors, ljung_box, pandit_wu, box_jenkins …"""
    warnings: tuple[str, ...]
    """Warnings about the axis."""

    def _unit(self, name: str) -> str | None:
        return "s" if name == "taus" else self.unit if name == "mean" or name.startswith("adev") else None

    @property
    def outside(self) -> npt.NDArray[np.bool_]:
        """Where the terms fitted lie outside of the interval of the Allan deviation."""
        return np.asarray((self.adev_fit < self.adev_lower) | (self.adev_fit > self.adev_upper))

    def plot(
        self,
        ax: matplotlib.axes.Axes | None = None,
        *,
        label: str | None = None,
        unit: str | None = None,
    ) -> matplotlib.axes.Axes:
        """The Allan deviation with its interval, and the fit, with crosses where it is outside of the interval.

        ``label`` names the curve; ``unit``, such as deg/h or mg, is that of the axis. Needs ``undrift[plot]``.
        """
        ax = axes(ax)
        scale = factor(unit)
        (line,) = ax.loglog(self.taus, scale * self.adev, label=label or "Allan deviation")
        ax.fill_between(
            self.taus,
            scale * self.adev_lower,
            scale * self.adev_upper,
            color=line.get_color(),
            alpha=0.2,
        )
        ax.loglog(self.taus, scale * self.adev_fit, "--", label="fit")
        outside = self.outside
        if outside.any():
            ax.loglog(self.taus[outside], scale * self.adev_fit[outside], "rx", label="fit outside")
        ax.set_xlabel("averaging time [s]")
        ax.set_ylabel(f"deviation [{unit or self.unit}]")
        ax.legend()
        return ax

    def _table(self) -> Mapping[str, Any]:
        """The candidates, a row each."""
        horizons = self.recommended.drift
        return {
            "candidate": np.array([c.name for c in self.candidates]),
            "states": np.array([c.states for c in self.candidates]),
            **{
                f"drift_{h}s": np.array([c.drift.get(h, np.nan) for c in self.candidates])
                for h in horizons
            },
        }


@dataclass(frozen=True, eq=False, repr=False)
class Identified(Judged):
    """A static record, identified axis by axis."""

    _UNITS = {"rate": "Hz"}

    axes: Mapping[str, AxisIdentified]
    """What was found, ``gyro_x`` … ``accel_z``."""
    failed: Mapping[str, str]
    """The axes of which no model was found, and why."""
    rate: float
    """Sample rate [Hz]."""
    verdict: str
    """``usable``, ``usable with care`` or ``not usable``, as the terminal prints it; ``warnings`` say why."""
    warnings: tuple[str, ...]
    """Warnings about the recording and its axes."""
    json: str = field(repr=False)
    """The result as ``undrift identify --json -`` prints it."""
    _found: _undrift.Identified | None = field(repr=False, compare=False)
    _model: str = field(default="", repr=False, compare=False)

    @property
    def recommended(self) -> dict[str, str]:
        """Name of the candidate that is recommended for each axis."""
        return {name: axis.recommended.name for name, axis in self.axes.items()}

    def model(self, base: ModelLike | None = None) -> NoiseModel:
        """The noise model: the recommended candidate of each axis.

        ``base``, a preset or data sheet, gives the axes that the record does not have and the standard
        deviations of the turn-on constants. Without it they are the largest that the record does not
        contradict (95 %): one record bounds them only from below.
        """
        if self._found is None:
            if base is not None:
                raise _undrift.UndriftError(
                    "an unpickled result has its model without base only: call model(base) before it is pickled"
                )
            return NoiseModel.from_toml(self._model, "<model>")
        return NoiseModel(self._found.model(None if base is None else compiled(base)))

    def __copy__(self) -> Identified:
        return self

    def __deepcopy__(self, memo: object) -> Identified:
        return self

    def __getstate__(self) -> dict[str, Any]:
        return {**self.__dict__, "_found": None, "_model": self.model().to_toml()}

    def plot(
        self, ax: matplotlib.axes.Axes | None = None, *, label: str | None = None
    ) -> matplotlib.axes.Axes:
        """The Allan deviations of all axes; ``label`` precedes their names. Needs ``undrift[plot]``."""
        ax = axes(ax)
        for name, axis in self.axes.items():
            name = name if label is None else f"{label}, {name}"
            ax.loglog(axis.taus, axis.adev, label=f"{name} [{axis.unit}]")
        ax.set_xlabel("averaging time [s]")
        ax.set_ylabel("Allan deviation")
        ax.legend()
        return ax

    def _table(self) -> Mapping[str, Any]:
        """The axes, a row each."""
        found = list(self.axes.values())
        horizons = found[0].recommended.drift if found else {}
        return {
            "axis": np.array(list(self.axes)),
            "recommended": np.array([axis.recommended.name for axis in found]),
            **{
                f"drift_{h}s": np.array([axis.recommended.drift.get(h, np.nan) for axis in found])
                for h in horizons
            },
        }


def identify(
    record: Any,
    *,
    rate: float | None = None,
    columns: Iterable[str | int] = (),
    axis: str | None = None,
    units: str | tuple[str, str] | None = None,
    time: str | int | tuple[str | int, str] | None = None,
    topic: str | None = None,
    n_max: int = 2,
    detrend: str = "temperature",
    force: bool = False,
    strict: bool | None = None,
    progress: Progress = False,
) -> Identified:
    """Identifies how a sensor errs from a record of it at rest.

    ``record`` is a file; a table in memory (data frame, Arrow table, structured array, dict of
    arrays, :class:`ImuLog`); or an array, a list or a series, of one axis (then ``axis`` names it) or, of arrays, of
    n × 6 columns in the order of gyro x, y, z, accelerometer x, y, z, in SI units. ``columns`` and ``units``, ``"deg/s,g"``, are
    found from the names of columns where possible; ``rate`` [Hz] by the time stamps, if there are any.
    ``detrend`` is constant, linear or temperature (the bias over temperature, where the record has a column of it); ``n_max`` the largest n of ARMA(2n, 2n−1) in the
    Pandit-Wu table. What is no static recording is refused; ``force`` identifies it anyway.
    docs/identify.md has the steps.

    A list or tuple of records, one for each time that a sensor was switched on, makes one model: ``data["pool"]`` has
    the spread of the turn-on constants and the records that differ.

    Parameters
    ----------
    record : str, path, table, array_like or list of such
        A static recording, or several of one sensor.
    rate : float, optional
        Sample rate [Hz]; by the time stamps without one.
    columns : iterable of str or int
        Columns of the six axes, by name or number from 1.
    axis : str, optional
        Axis of a recording of one, ``gyro_x`` … ``accel_z``.
    units : str or tuple of str, optional
        Units of gyros and accelerometers, ``"deg/s,g"``.
    time : str, int or tuple, optional
        Column of times by name or number from 1, or that with its unit, ``("ticks", "LSB/32768 s")``.
    topic : str, optional
        Topic of a bag.
    n_max : int
        Largest n of ARMA(2n, 2n−1) in the Pandit-Wu table.
    detrend : {"constant", "linear", "temperature"}
        What is taken out first.
    force : bool
        Whether to identify what is no static recording.
    strict : bool, optional
        True: what is usable with care raises, too; False: what is not usable warns, too.
    progress : bool or callable
        True for a bar; or ``tqdm``, or what is called like it.

    Returns
    -------
    Identified
        Candidates, tests and the recommended model of each axis.

    Raises
    ------
    UndriftError
        For a recording that cannot be read or is not static; :class:`ArgumentError` for a wrong type.
    VerdictError
        For a result that is not usable, unless ``strict`` is False; it has the ``result``.

    Examples
    --------
    >>> x = undrift.NoiseModel.load("adis16405").simulate(3000, 50.0, seed=1)["gyro_z"]
    >>> found = undrift.identify(x, axis="gyro_z", rate=50.0)
    >>> found.axes["gyro_z"].samples
    3000
    """
    if isinstance(units, str):
        parts = [part.strip() for part in units.split(",")]
        if len(parts) > 2:
            raise _undrift.UndriftError(
                'units takes the gyros\' and the accelerometers\' unit, for instance "deg/s,g"'
            )
        units = (parts[0], parts[-1])
    of_numbers = isinstance(record, (list, tuple)) and record and isinstance(record[0], Real)
    several = record if isinstance(record, (list, tuple)) and not of_numbers else [record]
    columns = [one if isinstance(one, str) else whole(one, "columns") for one in columns]
    rate = None if rate is None else positive(rate, "rate")
    times = time if time is None or isinstance(time, tuple) else (time, None)
    if not several:
        raise _undrift.UndriftError("no record to identify")
    records: list[tuple[str | os.PathLike[str], list[tuple[str, Floats]] | None]] = []
    for number, one in enumerate(several, 1):
        name = "<record>" if len(several) == 1 else f"<record {number}>"
        if isinstance(one, (str, os.PathLike)):
            records.append((one, None))
        elif isinstance(one, np.ndarray) and one.dtype.names is None:
            records.append((name, _bare(one, axis)))
            units = units or ("rad/s", "m/s^2")
        elif is_table(one):
            records.append((name, with_units(one)))
        else:
            column, in_si = _column(one, axis)
            records.append((name, column))
            units = units or (("rad/s", "m/s^2") if in_si else None)
    with reporter(progress, "identify") as report:
        found = _undrift.identify(
            records, columns, axis, units, times, topic, rate, whole(n_max, "n_max"), detrend, force, report
        )
    text, (verdict, line) = found.result()
    decoded = json.loads(text)
    done, failed = {}, {}
    for name in (name for name in AXES if name in decoded["axes"]):
        of_axis = decoded["axes"][name]
        if "error" in of_axis:
            failed[name] = of_axis["error"]
        else:
            done[name] = _axis(of_axis)
    pool = decoded.get("pool") or {"axes": {}}
    said = [f"{name}: {why}" for name, why in failed.items()]
    said += [
        f"{differing['record']}: {name} differs from the other records"
        for name, one in pool["axes"].items()
        for differing in one["differing"]
    ]
    said += [f"{name}: {warning}" for name, one in done.items() for warning in one.warnings]
    result = Identified(
        axes=done,
        failed=failed,
        rate=decoded["rate_hz"],
        verdict=verdict,
        warnings=tuple(map(_undrift.in_python, (*found.warnings, *said))),
        json=text,
        _found=found,
    )
    return judged(result, line, strict)


def _bare(record: npt.NDArray[Any], axis: str | None) -> list[tuple[str, Floats]]:
    """The columns of an array without names."""
    if record.ndim == 1:
        if axis is None:
            raise ArgumentError(f"specify the axis of the recording: axis={AXES[0]!r} … {AXES[-1]!r}")
        return [(axis, np.asarray(record, dtype=np.float64))]
    if record.ndim == 2 and record.shape[1] == len(AXES):
        return [
            (name, np.asarray(column, dtype=np.float64))
            for name, column in zip(AXES, record.T, strict=True)
        ]
    shape = " x ".join(map(str, record.shape))
    raise ArgumentError(f"a record of one axis or of n x 6 columns is needed, not {shape}")


def _column(record: Any, axis: str | None) -> tuple[list[tuple[str, Floats]], bool]:
    """The columns of a list, or of a series of pandas or polars with its index; whether they are of an axis
    without a unit.
    """
    values = array_of(record)
    own = getattr(record, "name", None)
    name = axis if axis is not None or own is None else str(own)
    if name is None:
        raise ArgumentError(f"specify the axis of the recording: axis={AXES[0]!r} … {AXES[-1]!r}")
    times = [found for one in index_of(record) for found in columns_of(dict([one]))]
    return [(name, values), *times], axis is not None


def _axis(decoded: dict[str, Any]) -> AxisIdentified:
    candidates = {c["name"]: _candidate(c) for c in decoded["candidates"]}
    allan = decoded["allan"]
    tests = (
        "adf",
        "kpss",
        "phillips_perron",
        "jarque_bera",
        "ks",
        "lilliefors",
        "ljung_box",
        "pandit_wu",
        "box_jenkins",
        "allan_terms",
        "scales",
    )
    array = np.array
    return AxisIdentified(
        samples=decoded["samples"],
        mean=decoded["mean"],
        unit=decoded["unit"],
        candidates=tuple(candidates[name] for name in decoded["ranking"]),
        recommended=candidates[decoded["chosen"]["name"]],
        reason=decoded["chosen"]["reason"],
        stationarity=decoded["stationarity"],
        taus=array(allan["tau_s"], dtype=np.float64),
        adev=array(allan["adev"], dtype=np.float64),
        adev_lower=array(allan["lower"], dtype=np.float64),
        adev_upper=array(allan["upper"], dtype=np.float64),
        adev_fit=array(allan["fit"], dtype=np.float64),
        tests={name: decoded[name] for name in tests},
        warnings=tuple(decoded["warnings"]),
    )


def _candidate(decoded: dict[str, Any]) -> Candidate:
    return Candidate(
        name=decoded["name"],
        states=decoded["states"],
        drift=decoded["drift_score"],
        drift_error=decoded["drift_score_error"],
        parameters=decoded,
        compared=decoded["compared"],
    )
