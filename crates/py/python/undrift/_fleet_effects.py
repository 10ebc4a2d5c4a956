"""A linear mixed model of the results of a fleet: all causes at once."""

from __future__ import annotations

import dataclasses
import io
import json
import keyword
import math
import os
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import numpy as np

from undrift import _store
from undrift._result import optional

if TYPE_CHECKING:
    from pandas import DataFrame

#: Temperature at which parts are given [°C].
_REFERENCE = 25.0

#: Quantile of the normal distribution that 95 % of magnitudes stay below, as of ``MixedLM``.
_NORMAL = 1.959963984540054

#: A column whose part outside of those before it is smaller than this, relative to itself, is a combination of them.
_ALIASED = 1e-7


@dataclasses.dataclass(frozen=True, eq=False)
class Effects:
    """Result of :func:`undrift.fleet.effects`."""

    #: A row for each fixed effect by its name in the formula: ``times``, the factor on the measure, ``low`` and
    #: ``high``, the ends of its 95 % interval, and ``p``, not adjusted for the number of rows.
    factors: DataFrame
    #: Growth with temperature and its 95 % interval [%/K]: ``percent_per_k``, ``low``, ``high``, ``p``. Empty
    #: without temperatures or with a formula that lacks them.
    temperature: dict[str, float]
    #: Standard deviations of the logarithm: ``unit``, between units, ``log``, between the logs of a unit, ``rest``,
    #: between the parts of a log. ``unit`` or ``log`` is missing where all have only one log or row.
    scatter: dict[str, float]
    #: Logs, units and rows in the model.
    logs: int
    units: int
    rows: int
    #: The ``MixedLMResults`` of statsmodels.
    fit: Any = dataclasses.field(repr=False)


def effects(
    table: Any,
    measure: str = "max_horizontal_m",
    *,
    labels: Iterable[str] = (),
    formula: str | None = None,
) -> Effects:
    """Separates what a measure depends on: sensor, labels, temperature, units and logs, all in one model.

    ``undrift fleet`` compares one cause at a time. Here each is estimated with the others held: the linear mixed model
    ``ln y = part + sensor + labels + slope · (T − 25 °C) + unit + log + rest``, with a row for each log and part, fitted
    by restricted maximum likelihood (``statsmodels`` ``MixedLM``); unit, log and rest are random. Rows with a note or
    a failure are excluded, as by the command. Logs without a unit are units of their own; those without a
    temperature or label have an effect of that, so that they count for the rest.

    The intervals are those of ``MixedLM``, by the normal distribution: with fewer than some twenty units those of
    sensors and labels are too narrow.

    Parameters
    ----------
    table : path, URL, ``pyarrow.Table`` or ``pandas.DataFrame``
        ``results.parquet``, or some of its rows.
    measure : str, default "max_horizontal_m"
        Column of positive numbers in any unit. Several rows of a log and part, such as outages, count by their root
        mean square.
    labels : iterable of str
        Labels of the manifest that are in the model, such as ``["vehicle"]``.
    formula : str, optional
        Right-hand side of the fixed effects instead, in the language of ``patsy``, of the columns ``part``,
        ``sensor``, ``temperature`` [K above 25 °C], ``temperature_known`` (0 or 1) and the labels.

    Returns
    -------
    Effects
        Factors with 95 % intervals, the slope [%/K] and the scatter of units and logs. The first sensor and the first
        value of a label by the alphabet are the reference of the others (``sensor[T.b]`` is ``b`` over ``a``); parts are
        levels, in the unit of the measure, of the reference at 25 °C.

    Raises
    ------
    ValueError
        The table has no such column or label, values of several tasks or too few, or effects go together so that
        they cannot be separated; the message names them.
    ImportError
        A package is missing: ``pip install "undrift[fleet,tables]"``.

    Examples
    --------
    >>> from undrift import fleet
    >>> found = fleet.effects("out/results.parquet", labels=["vehicle"])  # doctest: +SKIP
    >>> found.factors.loc["vehicle[T.van]", ["times", "low", "high"]]  # doctest: +SKIP
    >>> found.temperature["percent_per_k"], found.scatter["unit"]  # doctest: +SKIP
    """
    mixed = optional("statsmodels.formula.api", "fleet")
    patsy = optional("patsy", "fleet")
    names = list(labels)
    frame = _rows(_frame(table), measure, names)
    right = formula if formula is not None else _formula(frame, names)
    for name in names:
        frame[name] = frame[name].fillna("")
    _, design = patsy.dmatrices(f"ln_y ~ {right}", frame, return_type="dataframe")
    _separable(design)
    logs_in_unit = frame.groupby("unit")["log"].nunique()
    has_units = len(logs_in_unit) > 1 and logs_in_unit.max() > 1
    has_rows = frame.groupby("log").size().max() > 1
    if len(frame) <= design.shape[1] or not (has_units or has_rows):
        raise ValueError(f"{measure}: too few logs for the model, {frame['log'].nunique()}")
    model = mixed.mixedlm(
        f"ln_y ~ {right}",
        frame,
        groups="unit" if has_units else "log",
        re_formula="1",
        vc_formula={"log": "0 + C(log)"} if has_units and has_rows else None,
    )
    fit = model.fit(reml=True, method=["lbfgs", "powell"])
    return _result(fit, frame, has_units, has_rows)


def _frame(table: Any) -> DataFrame:
    """The table as a data frame of its own."""
    optional("pandas", "tables")
    if isinstance(table, (str, os.PathLike)):
        parquet = optional("pyarrow.parquet", "tables")
        table = parquet.read_table(io.BytesIO(_store.read(os.fspath(table))))
    frame: DataFrame = table.to_pandas() if hasattr(table, "to_pandas") else table.copy()
    return frame


def _rows(table: DataFrame, measure: str, labels: list[str]) -> DataFrame:
    """A row for each log and part that can be trusted."""
    missing = {"log", "unit", "sensor", "task", "part", "temperature_c", measure} - set(table)
    if missing:
        raise ValueError(f"the table has no column {', '.join(sorted(missing))}")
    table = table[table["part"].notna()]
    key = "fingerprint" if "fingerprint" in table else "log"
    values = table.groupby(["task", key, "part"], sort=False)[measure]
    trusted = values.transform("count") == values.transform("size")
    if "note" in table:
        noted = (table["note"].notna() & (table["task"] != "identify")).groupby(
            [table["task"], table[key], table["part"]]
        )
        trusted &= ~noted.transform("any")
    table = table[trusted & (table[measure] > 0)]
    tasks = sorted(table["task"].unique())
    if len(tasks) > 1:
        raise ValueError(f"{measure} has values of several tasks ({', '.join(tasks)}): hand in the rows of one")
    groups = table.groupby([key, "part"], sort=False)
    frame = groups[["unit", "sensor", "temperature_c"]].first().reset_index()
    frame["ln_y"] = groups[measure].agg(lambda y: 0.5 * math.log((y**2).mean())).to_numpy()
    frame = frame.rename(columns={key: "log"})
    frame["unit"] = frame["unit"].where(frame["unit"].notna(), "log " + frame["log"].astype(str))
    frame["sensor"] = frame["sensor"].fillna("")
    frame["temperature_known"] = frame["temperature_c"].notna().astype(float)
    frame["temperature"] = frame["temperature_c"].fillna(_REFERENCE) - _REFERENCE
    if labels:
        of_row = groups["labels"].first().to_numpy()
        known_labels = [json.loads(text) if isinstance(text, str) else {} for text in of_row]
        for name in labels:
            if name in frame:
                raise ValueError(f"the label {name} is called like a column: name it differently")
            frame[name] = [of.get(name) for of in known_labels]
            if frame[name].isna().all():
                raise ValueError(f"no log has a label {name}")
    return frame


def _formula(frame: DataFrame, labels: list[str]) -> str:
    """The fixed effects of what differs."""
    terms = [name for name in ("part", "sensor") if frame[name].nunique() > 1]
    plain = (name.isidentifier() and not keyword.iskeyword(name) for name in labels)
    terms += [name if is_plain else f"Q({name!r})" for name, is_plain in zip(labels, plain, strict=True)]
    terms += [name for name in ("temperature", "temperature_known") if frame[name].nunique() > 1]
    # A level for each part, where there are several, rather than one and differences.
    return " + ".join((["0"] if terms[:1] == ["part"] else []) + terms) or "1"


def _separable(design: DataFrame) -> None:
    """Refuses effects of which one is a combination of others."""
    kept: list[Any] = []
    for name in design:
        column = design[name].to_numpy(dtype=float)
        rest = column.copy()
        for _ in range(2):
            for direction in kept:
                rest -= direction * (direction @ rest)
        size = float(np.linalg.norm(rest))
        if size <= _ALIASED * max(float(np.linalg.norm(column)), 1e-300):
            raise ValueError(f"{name} cannot be separated from the effects before it: leave out one of them")
        kept.append(rest / size)


def _result(fit: Any, frame: DataFrame, has_units: bool, has_rows: bool) -> Effects:
    """Factors of the coefficients, and the scatter."""
    pandas = optional("pandas", "tables")
    low, high = fit.fe_params - _NORMAL * fit.bse_fe, fit.fe_params + _NORMAL * fit.bse_fe
    factors = pandas.DataFrame(
        {
            "times": np.exp(fit.fe_params),
            "low": np.exp(low),
            "high": np.exp(high),
            "p": fit.pvalues[fit.fe_params.index],
        }
    )
    slope: dict[str, float] = {}
    if "temperature" in factors.index:
        row = factors.loc["temperature"]
        slope = {"percent_per_k": 100 * (float(row["times"]) - 1)}
        slope |= {end: 100 * (float(row[end]) - 1) for end in ("low", "high")}
        slope["p"] = float(row["p"])
    group = math.sqrt(float(fit.cov_re.iloc[0, 0]))
    scatter = {"unit" if has_units else "log": group}
    if has_units and has_rows:
        scatter["log"] = math.sqrt(float(fit.vcomp[0]))
    scatter["rest"] = math.sqrt(float(fit.scale))
    return Effects(
        factors=factors,
        temperature=slope,
        scatter=scatter,
        logs=int(frame["log"].nunique()),
        units=int(frame["unit"].nunique()),
        rows=len(frame),
        fit=fit,
    )
