"""Drives with their GNSS cut."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from undrift import _undrift
from undrift._array import Floats
from undrift._drive import Drive, Log
from undrift._errors import ArgumentError
from undrift._model import ModelLike, NoiseModel, compiled
from undrift._navigate import drive_of
from undrift._progress import Progress, reporter
from undrift._result import Result, axes, optional
from undrift._simulate import Simulation
from undrift._judged import Judged, judged
from undrift._units import factor

if TYPE_CHECKING:
    import matplotlib.axes
    from pandas import DataFrame
    from polars import DataFrame as PolarsFrame

#: Names of the bias models in the order of tables.
BIAS_MODELS = ("white", "paper", "gauss-markov", "random-walk", "ar", "arma")
#: Those that are compared where nothing is asked for.
USUAL_MODELS = ("gauss-markov", "random-walk", "ar", "arma")


@dataclass(frozen=True, eq=False, repr=False)
class Drift(Result):
    """The horizontal error in one outage over the time since GNSS was cut."""

    _UNITS = {"start": "s", "since": "s", "horizontal": "m"}

    start: float
    """Start of the outage [s], in the logs' time base."""
    since: Floats
    """Time since then [s], at most about ten a second."""
    horizontal: Floats
    """Horizontal error [m]."""


@dataclass(frozen=True, eq=False, repr=False)
class ModelErrors(Result):
    """What the outages did to one model; errors by component: [m], [m/s], [deg]."""

    max: Mapping[str, float | None]
    """Largest magnitude over all samples inside the outages."""
    rms: Mapping[str, float | None]
    """RMS over the outages of the largest error of each."""
    median: Mapping[str, float | None]
    """Median over the outages of the largest error of each."""
    end_rms: Mapping[str, float | None]
    """RMS over the outages of the error at the end."""
    outages: tuple[Drift, ...] = field(repr=False)
    """Outage by outage."""
    mean_drift: Drift
    """RMS over the outages of the horizontal error; ``start`` is 0."""
    warning: str | None
    """Why the numbers cannot be trusted, if so."""


@dataclass(frozen=True, eq=False, repr=False)
class Outages(Judged):
    """How far each model drifts when GNSS is cut."""

    _UNITS = {"cuts": "s"}

    models: Mapping[str, ModelErrors]
    """The models that were run, by name."""
    failed: Mapping[str, str]
    """Those that could not be, and why."""
    cuts: Floats
    """Start and length of every outage [s], n × 2."""
    left_out: tuple[Mapping[str, Any], ...]
    """Outages that were asked for and excluded: ``start_s``, ``length_s``, ``why``."""
    reference: str
    """What the errors are measured against: ``truth``, or ``gnss`` for the withheld fixes."""
    withheld: int
    """Positions withheld by the outages, where they are the reference."""
    rejected: int
    """Those of them that the run without outages rejects: they are no reference."""
    smooth: bool
    """Whether the errors are those of the smoothed solutions."""
    look_ahead: bool
    """Whether the solutions know more of the log than what came before; else they are those of a run while driving."""
    verdict: str
    """``usable``, ``usable with care`` or ``not usable``, as the terminal prints it; ``warnings`` say why."""
    warnings: tuple[str, ...]
    """Warnings about the logs and the models."""
    table: str = field(repr=False)
    """The table that the terminal prints."""
    json: str = field(repr=False)
    """The result as ``undrift outages --json -`` prints it."""

    def _table(self) -> Mapping[str, Any]:
        """Rows of models and statistics, columns of components."""
        rows = [
            (name, statistic, getattr(model, statistic))
            for name, model in self.models.items()
            for statistic in ("max", "rms", "median", "end_rms")
        ]
        table: dict[str, Any] = {
            "model": np.array([name for name, *_ in rows]),
            "statistic": np.array([statistic for _, statistic, _ in rows]),
        }
        for component in _ordered(rows[0][2]) if rows else ():
            values = [np.nan if v is None else v for v in (errors[component] for *_, errors in rows)]
            table[component] = np.array(values)
        return table

    def to_pandas(self, rows: Literal["statistics", "each"] = "statistics") -> DataFrame:
        """The result as a ``pandas.DataFrame``: a row for each model and statistic, or for ``each`` model and outage.

        Of each outage there are the largest error of every component, ``north_m`` …, and the one at its end,
        ``end_north_m`` …. Needs ``undrift[tables]``.
        """
        frame: DataFrame = optional("pandas", "tables").DataFrame(self._rows(rows))
        return frame

    def to_polars(self, rows: Literal["statistics", "each"] = "statistics") -> PolarsFrame:
        """:meth:`to_pandas` as a ``polars.DataFrame``. Needs ``undrift[polars]``."""
        frame: PolarsFrame = optional("polars", "polars").DataFrame(self._rows(rows))
        return frame

    def _rows(self, rows: Literal["statistics", "each"]) -> dict[str, Any]:
        if rows == "statistics":
            return dict(self._table())
        if rows != "each":
            raise _undrift.UndriftError(f'rows: "statistics" or "each", not {rows!r}')
        return self._each()

    def _each(self) -> dict[str, Any]:
        decoded = self.data
        lengths = {cut["start_s"]: cut["length_s"] for cut in decoded["outages"]}
        table: dict[str, list[Any]] = {"model": [], "start_s": [], "length_s": []}
        for name in self.models:
            for one in decoded["models"][name]["per_outage"]:
                table["model"].append(name)
                table["start_s"].append(one["start_s"])
                table["length_s"].append(lengths.get(one["start_s"], np.nan))
                for prefix, errors in (("", one["max"]), ("end_", one["end"])):
                    for component in _ordered(errors):
                        value = errors[component]
                        column = table.setdefault(prefix + component, [])
                        column.append(np.nan if value is None else value)
        return table

    def plot(
        self,
        ax: matplotlib.axes.Axes | None = None,
        *,
        label: str | None = None,
        unit: str = "m",
    ) -> matplotlib.axes.Axes:
        """Horizontal drift since the cut, RMS over the outages, of each model; logarithmic where models differ by 10.

        ``label`` precedes the models' names, ``unit`` is m, cm or km. Needs ``undrift[plot]``.
        """
        ax = axes(ax)
        largest = []
        for name, model in self.models.items():
            drift = factor(unit) * model.mean_drift.horizontal
            name = name if label is None else f"{label}, {name}"
            ax.plot(model.mean_drift.since, drift, label=name)
            largest.append(np.nanmax(drift, initial=0.0))
        if largest and max(largest) > 10.0 * min(largest) > 0.0:
            ax.set_yscale("log")
        ax.set_xlabel("time since GNSS was cut [s]")
        ax.set_ylabel(f"horizontal error, RMS [{unit}]")
        ax.legend()
        return ax


def _named(
    models: Mapping[str, ModelLike] | Iterable[ModelLike],
) -> list[tuple[str, _undrift.NoiseModel]]:
    """The noise models to compare, by their names."""
    if isinstance(models, (str, os.PathLike, NoiseModel)):
        raise ArgumentError("models: a mapping or a list is needed; one model is model=")
    if isinstance(models, Mapping):
        return [(str(name), compiled(model)) for name, model in models.items()]
    return [(_name(model), compiled(model)) for model in models]


def _name(model: ModelLike) -> str:
    return model.name or "model" if isinstance(model, NoiseModel) else Path(model).stem


def _kinds(bias_models: str | Iterable[str] | None, one: bool) -> list[str]:
    """The bias models to run: ``one`` where noise models are compared."""
    if bias_models is None:
        return ["arma"] if one else list(USUAL_MODELS)
    kinds = [bias_models] if isinstance(bias_models, str) else list(bias_models)
    if one and len(kinds) != 1:
        raise ArgumentError(
            f"models are compared as one bias model, but bias_models has {len(kinds)}: specify one of them, or no models"
        )
    return kinds


#: Components of an error in the order of tables.
_COMPONENTS = (
    "north_m",
    "east_m",
    "down_m",
    "horizontal_m",
    "vn_mps",
    "ve_mps",
    "vd_mps",
    "roll_deg",
    "pitch_deg",
    "yaw_deg",
)


def _ordered(errors: Mapping[str, Any]) -> dict[str, Any]:
    """Errors by component, north, east, down."""
    order = {name: k for k, name in enumerate(_COMPONENTS)}
    return dict(sorted(errors.items(), key=lambda item: order.get(item[0], len(order))))


def outages(
    drive: Log | Drive | Simulation,
    gnss: Log = None,
    model: ModelLike | Mapping[str, Any] | None = None,
    *,
    data: str | os.PathLike[str] | None = None,
    bias_models: str | Iterable[str] | None = None,
    models: Mapping[str, ModelLike] | Iterable[ModelLike] = (),
    length: float = 10.0,
    count: int | None = None,
    every: float | None = None,
    start: float | None = None,
    at: Iterable[float] | None = None,
    smooth: bool = False,
    look_ahead: bool = False,
    strict: bool | None = None,
    progress: Progress = False,
    **keys: Any,
) -> Outages:
    """Cuts GNSS again and again on a drive and measures how far each model drifts.

    Bias models of one noise model are compared; or ``models``, noise models of the IMU, all run as one bias model in the same
    outages.

    ``drive``, ``gnss``, ``model``, ``data`` and further keys are those of :func:`navigate`. An
    outage lasts ``length`` [s]; the first starts ``start`` [s] after the first fix. ``count`` of them
    are spread evenly, or start ``every`` seconds; ``at`` are starts in
    the logs' time base instead. Without these as many as fit, a third of the time without GNSS. With ``smooth`` the errors are those that are left when the fixes
    after an outage are known too. ``progress`` is that of :func:`navigate`.

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
    bias_models : str or iterable of str, optional
        The models that are compared, of white, paper, gauss-markov, random-walk, ar and arma; gauss-markov, random-walk, ar
        and arma without it, the last also without each constraint and sensor beside GNSS (printed, and ``without`` of the
        JSON). One, arma without it, where ``models`` are compared.
    models : mapping of str to model, or iterable of models
        Noise models to compare, each a file, a preset or a :class:`NoiseModel`, by their names or named as their files. The
        first is the one of the run without outages, which decides what fixes are a reference.
    length : float
        Length of an outage [s].
    count : int, optional
        Outages, spread evenly.
    every : float, optional
        Time from one start to the next [s].
    start : float, optional
        First start after the first fix [s]; 60, sooner in a log of less than 180 s.
    at : iterable of float, optional
        Starts in the logs' time base [s].
    smooth : bool
        Whether the solutions are smoothed.
    look_ahead : bool
        Whether the errors of all fixes are studied and the mounting is found first, else both from the log so far, as while
        driving.
    strict : bool, optional
        True: what is usable with care raises, too; False: what is not usable warns, too.
    progress : bool or callable
        True for a bar; or ``tqdm``, or what is called like it.
    **keys
        Further keys of :class:`Drive`.

    Returns
    -------
    Outages
        Errors of each model and outage.

    Raises
    ------
    UndriftError
        For outages that lie outside of the drive, and as :func:`navigate`.
    VerdictError
        For a result that is not usable, unless ``strict`` is False; it has the ``result``.

    Examples
    --------
    >>> sim = undrift.simulate("car", 150.0, 50.0)
    >>> cut = undrift.outages(sim, length=5, count=2, start=80, bias_models=["white", "arma"])
    >>> cut.models["white"].rms["horizontal_m"] > cut.models["arma"].rms["horizontal_m"]
    True
    """
    named = _named(models)
    if named and model is not None:
        raise ArgumentError("model and models: specify one of them")
    kinds = _kinds(bias_models, bool(named))
    made = drive_of(drive, gnss, NoiseModel(named[0][1]) if named else model, data, keys)
    with reporter(progress, "outages") as report:
        text, table, (verdict, line), curves = _undrift.outages(
            made._drive,
            kinds,
            named,
            bias_models is None and not named,
            length,
            count,
            every,
            start,
            None if at is None else [float(time) for time in at],
            smooth,
            look_ahead,
            report,
        )
    decoded = json.loads(text)
    drift = decoded["series"]["drift"]
    done_by: dict[str, ModelErrors] = {}
    for name, of_model in curves:
        errors, mean = decoded["models"][name], drift[name]
        done_by[name] = ModelErrors(
            max=_ordered(errors["max"]),
            rms=_ordered(errors["rms"]),
            median=_ordered(errors["median"]),
            end_rms=_ordered(errors["end_rms"]),
            outages=tuple(Drift(*curve) for curve in of_model),
            mean_drift=Drift(
                0.0, np.array(mean["since_cut_s"]), np.array(mean["horizontal_rms_m"])
            ),
            warning=errors.get("warning"),
        )
    cuts = [(cut["start_s"], cut["length_s"]) for cut in decoded["outages"]]
    done = Outages(
        models=done_by,
        failed=decoded["failed"],
        cuts=np.array(cuts).reshape(-1, 2),
        left_out=tuple(decoded.get("left_out", ())),
        reference=decoded["reference"],
        withheld=decoded["withheld"],
        rejected=decoded["rejected"],
        smooth=decoded["smooth"],
        look_ahead=decoded["look_ahead"],
        verdict=verdict,
        warnings=tuple(map(_undrift.in_python, decoded["warnings"])),
        table=table,
        json=text,
    )
    return judged(done, line, strict)
