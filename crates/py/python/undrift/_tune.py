"""The noise of a sensor in its vehicle."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields
from typing import Any

import numpy as np
from undrift import _undrift
from undrift._drive import Drive, Log
from undrift._errors import ArgumentError
from undrift._model import ModelLike, NoiseModel, compiled
from undrift._navigate import drive_of
from undrift._progress import Progress, reporter
from undrift._result import Result
from undrift._simulate import Simulation
from undrift._judged import Judged, judged


@dataclass(frozen=True, eq=False, repr=False)
class TunedParameter(Result):
    """One parameter: a density, a standard deviation or a factor on one."""

    name: str
    """What it is."""
    unit: str
    """Its unit, SI; empty for a factor."""
    start: float | None
    """At rest, or as specified; None where that is unknown."""
    prior: float
    """The most likely value before the drives."""
    prior_low: float
    """Lower end of the 95 % interval then."""
    prior_high: float
    """Upper end of it."""
    value: float
    """The most likely value with the drives."""
    low: float
    """Lower end of its 95 % interval."""
    high: float
    """Upper end of it."""
    determined: bool
    """Whether the drives determine it: the interval is less than half as wide as before."""

    def _unit(self, name: str) -> str | None:
        return None if name in ("name", "unit", "determined") else self.unit or None


@dataclass(frozen=True, eq=False, repr=False)
class TunedDrift(Result):
    """Drift over held-out outages of one length."""

    _UNITS = {"length_s": "s", "before_m": "m", "after_m": "m"}

    length_s: float
    """Length of the outages [s]."""
    outages: int
    """How many."""
    before_m: float
    """RMS of the largest horizontal error of each, before: with the noise of model and drive files [m]."""
    after_m: float
    """The same with the noise found [m]."""
    ratio: float | None
    """After over before."""
    ratio_low: float | None
    """Lower end of its 95 % interval, by the bootstrap over outages."""
    ratio_high: float | None
    """Upper end of it."""
    before_within: tuple[float | None, ...]
    """Shares of the position's errors at the ends inside 1, 2 and 3 σ, before."""
    after_within: tuple[float | None, ...]
    """The same with the noise found."""
    nees: tuple[dict[str, Any], ...] = ()
    """Of poses: normalised error squared at the ends per degree of freedom ``of`` position and attitude, mean and 95 % interval,
    ``before`` and ``after``."""


@dataclass(frozen=True, eq=False, repr=False)
class Tuning(Judged):
    """The noise of a sensor in its vehicle, estimated from drives, and the drift before and after."""

    parameters: tuple[TunedParameter, ...]
    """Parameter by parameter: of the axes, of the fixes, of the constraints."""
    drift: tuple[TunedDrift, ...]
    """Drift on held-out outages, by length."""
    model: NoiseModel
    """The sensor in its vehicle, with constant white noise, for :func:`navigate` and :func:`outages`."""
    start: str
    """Name of the sensor at rest that it began from."""
    guessed: bool
    """Whether that is a guess from the quietest seconds of the first drive."""
    unseen: float
    """Share at the end of each drive that the drift was measured on."""
    held_out: bool
    """Whether the noise is that of the rest alone; else of the whole drives, the drift that of a fit of the rest."""
    converged: bool
    """Whether nothing more was to be gained."""
    withheld: int
    """Positions in the unseen parts, where they are the reference."""
    rejected: int
    """Those of them that are rejected before and after: they are no reference."""
    windows: int
    """Windows whose fixes were scored."""
    evaluations: int
    """Evaluations of the objective."""
    verdict: str
    """``usable``, ``usable with care`` or ``not usable``, as the terminal prints it; ``table`` begins with it."""
    warnings: tuple[str, ...]
    """Warnings about the logs and the fit."""
    table: str = field(repr=False)
    """What the terminal prints."""
    json: str = field(repr=False)
    """The result as ``undrift tune --json -`` prints it."""

    def _table(self) -> Mapping[str, Any]:
        """The parameters, a row each."""
        columns = {}
        for column in fields(TunedParameter):
            values = [getattr(parameter, column.name) for parameter in self.parameters]
            columns[column.name] = np.array([np.nan if value is None else value for value in values])
        return columns


def tune(
    drive: Log | Drive | Simulation | Sequence[str | os.PathLike[str] | Drive | Simulation],
    gnss: Log = None,
    model: ModelLike | Mapping[str, Any] | None = None,
    *,
    data: str | os.PathLike[str] | Sequence[str | os.PathLike[str]] | None = None,
    hold_out: float | None = None,
    strict: bool | None = None,
    progress: Progress = False,
    **keys: Any,
) -> Tuning:
    """Identifies the noise of a sensor in its vehicle from drives with GNSS.

    ``drive``, ``gnss``, ``data`` and further keys are those of :func:`navigate`. ``drive`` is also a
    list of drives of one sensor in one vehicle: drive files, :class:`Drive`, :class:`Simulation`;
    ``data`` is then one folder, or one for each. ``model`` is the sensor at rest; without it, it is
    the first drive's own model, else what its quietest seconds show.

    ``hold_out`` is the share at the end of each drive that the fit does not see, 0 to 0.9. Without it
    the drift is measured on the second half after a fit of the first, and the noise is that of the
    whole. docs/tune.md has the method.

    Parameters
    ----------
    drive : str, path, Drive, Simulation, log, or a list of such
        Drives of one sensor in one vehicle.
    gnss : log, optional
        Log of GNSS, where ``drive`` is that of the IMU.
    model : str, path or NoiseModel, optional
        The sensor at rest.
    data : str, path or list of such, optional
        Folder of the logs, one or one for each drive file.
    hold_out : float, optional
        Share of each drive that is withheld, 0 to 0.9.
    strict : bool, optional
        True: what is usable with care raises, too; False: what is not usable warns, too.
    progress : bool or callable
        True for a bar; or ``tqdm``, or what is called like it.
    **keys
        Further keys of :class:`Drive`.

    Returns
    -------
    Tuning
        The noise found, and the drift before and after.

    Raises
    ------
    UndriftError
        For a drive that cannot be read or aligned; :class:`ArgumentError` for a wrong type.
    VerdictError
        For a result that is not usable, unless ``strict`` is False; it has the ``result``.

    Examples
    --------
    >>> tuning = undrift.tune("drive.toml", model="mpu6050")  # doctest: +SKIP
    >>> undrift.tune([])
    Traceback (most recent call last):
        ...
    undrift.UndriftError: no drive specified
    """
    several = list(drive) if isinstance(drive, (list, tuple)) else [drive]
    if not several:
        raise _undrift.UndriftError("no drive specified")
    if gnss is not None and isinstance(drive, (list, tuple)):
        raise ArgumentError("gnss goes with the IMU log of one drive: several are drive files or Drives")
    folders = [data] * len(several) if data is None or isinstance(data, (str, os.PathLike)) else list(data)
    if len(folders) != len(several):
        raise _undrift.UndriftError(
            f"data has {len(folders)} folders for {len(several)} drives: one, or one for each"
        )
    # Of a mapping the drive itself makes a model; another one stays apart from the drives' own.
    described, start = (model, None) if isinstance(model, Mapping) else (None, model)
    made = [
        drive_of(one, gnss, described, folder, keys)
        for one, folder in zip(several, folders, strict=True)
    ]
    at_rest = None if start is None else compiled(start)
    with reporter(progress, "tune") as report:
        text, table, (verdict, line), warnings, tuned = _undrift.tune(
            [one._drive for one in made], at_rest, hold_out, report
        )
    decoded = json.loads(text)
    names = (
        "start",
        "guessed",
        "unseen",
        "held_out",
        "converged",
        "withheld",
        "rejected",
        "windows",
        "evaluations",
    )
    done = Tuning(
        parameters=tuple(TunedParameter(**parameter) for parameter in decoded["parameters"]),
        drift=tuple(_drift(drift) for drift in decoded["drift"]),
        model=NoiseModel(tuned),
        **{name: decoded[name] for name in names},
        verdict=verdict,
        warnings=tuple(map(_undrift.in_python, warnings)),
        table=table,
        json=text,
    )
    return judged(done, line, strict)


def _drift(decoded: dict[str, Any]) -> TunedDrift:
    arrays = {name: tuple(item) for name, item in decoded.items() if isinstance(item, list)}
    return TunedDrift(**{**decoded, **arrays})
