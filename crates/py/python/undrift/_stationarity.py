"""Is a record stationary?"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy.typing as npt
from undrift import _undrift
from undrift._arguments import rule, whole
from undrift._array import record
from undrift._result import Result

Regression = Literal["n", "c", "ct"]


@dataclass(frozen=True, eq=False, repr=False)
class Adf(Result):
    """Augmented Dickey-Fuller test: a statistic below the critical value rejects a unit root."""

    statistic: float
    """t of the level."""
    p_value: float
    """MacKinnon (1994), asymptotic."""
    lags: int
    """Lagged differences used."""
    observations: int
    """Rows of the regression."""
    critical: dict[str, float]
    """Critical values at 1%, 5% and 10% by MacKinnon (2010)."""
    criterion: float | None
    """AIC, BIC or |t| of the lag chosen; None where the lags were specified."""


@dataclass(frozen=True, eq=False, repr=False)
class Kpss(Result):
    """KPSS test: a statistic above the critical value rejects stationarity."""

    statistic: float
    """η."""
    p_value: float
    """Interpolated between 0.01 and 0.1."""
    p_is_bound: bool
    """The p-value is one of those two ends: the true one lies beyond."""
    lags: int
    """Lags of the long-run variance."""
    critical: dict[str, float]
    """Critical values at 1%, 5% and 10%."""


@dataclass(frozen=True, eq=False, repr=False)
class PhillipsPerron(Result):
    """Phillips-Perron test: a statistic below the critical value rejects a unit root."""

    statistic: float
    """Z-tau."""
    p_value: float
    """p of Z-tau by MacKinnon (1994)."""
    rho_statistic: float
    """Z-rho."""
    lags: int
    """Lags of the long-run variance."""
    observations: int
    """Rows of the regression."""
    critical: dict[str, float]
    """Critical values of Z-tau at 1%, 5% and 10%."""


@dataclass(frozen=True, eq=False, repr=False)
class Stationarity(Result):
    """The three tests weighed at 5 %."""

    conclusion: str
    """stationary, unit root, conflict, undecided, no slow part detected or slow part detected."""
    sentence: str
    """The reasoning."""
    adf: Adf
    """Augmented Dickey-Fuller, constant."""
    kpss: Kpss
    """KPSS about a level."""
    phillips_perron: PhillipsPerron
    """Phillips-Perron, constant."""


def adf(
    x: npt.ArrayLike,
    *,
    regression: Regression = "c",
    lags: int | Literal["aic", "bic", "t-stat"] = "aic",
    max_lags: int | None = None,
) -> Adf:
    """Augmented Dickey-Fuller test of a unit root.

    ``regression``: n (nothing), c (a constant) or ct (a constant and a trend). ``lags``: lagged
    differences, or the rule that chooses them up to ``max_lags`` (by default ⌈12 (n/100)^¼⌉).

    Parameters
    ----------
    x : array_like, shape (n,)
        Recording of one axis [u], u any unit; rad/s or m/s² for a sensor.
    regression : {"n", "c", "ct"}
        Nothing, a constant, a constant and a trend.
    lags : int or {"aic", "bic", "t-stat"}
        Lagged differences, or the rule that chooses them.
    max_lags : int, optional
        Most that the rule may choose.

    Returns
    -------
    Adf
        Statistic, p-value and critical values.

    Raises
    ------
    UndriftError
        For a recording or argument that cannot be; :class:`ArgumentError` for a wrong type.

    Examples
    --------
    >>> x = undrift.arma.simulate(5000, [0.9], [], 1.0)
    >>> undrift.adf(x).p_value < 0.01  # no unit root
    True
    """
    return Adf(
        **_undrift.adf(
            record(x),
            regression,
            rule(lags, "lags"),
            None if max_lags is None else whole(max_lags, "max_lags"),
        )
    )


def kpss(
    x: npt.ArrayLike,
    *,
    regression: Literal["c", "ct"] = "c",
    lags: int | Literal["auto", "legacy", "long", "short"] = "auto",
) -> Kpss:
    """KPSS test of stationarity about a level (c) or a trend (ct).

    ``lags`` of the long-run variance: a number, auto (Hobijn, Franses & Ooms 2004), legacy
    (⌈12 (n/100)^¼⌉), long (the floor of that) or short (⌊4 (n/100)^¼⌋).

    Parameters
    ----------
    x : array_like, shape (n,)
        Recording of one axis [u], u any unit; rad/s or m/s² for a sensor.
    regression : {"c", "ct"}
        Stationary about a level or a trend.
    lags : int or {"auto", "legacy", "long", "short"}
        Lags of the long-run variance, or the rule that chooses them.

    Returns
    -------
    Kpss
        Statistic, p-value and critical values.

    Raises
    ------
    UndriftError
        For a recording or argument that cannot be; :class:`ArgumentError` for a wrong type.

    Examples
    --------
    >>> import numpy as np
    >>> x = undrift.arma.simulate(2000, [], [], 1.0)  # white noise
    >>> undrift.kpss(np.cumsum(x)).p_value <= 0.01  # a random walk
    True
    """
    return Kpss(**_undrift.kpss(record(x), regression, rule(lags, "lags")))


def phillips_perron(
    x: npt.ArrayLike, *, regression: Regression = "c", lags: int | None = None
) -> PhillipsPerron:
    """Phillips-Perron test of a unit root, with ⌈12 (n/100)^¼⌉ lags by default.

    Parameters
    ----------
    x : array_like, shape (n,)
        Recording of one axis [u], u any unit; rad/s or m/s² for a sensor.
    regression : {"n", "c", "ct"}
        Nothing, a constant, a constant and a trend.
    lags : int, optional
        Lags of the long-run variance.

    Returns
    -------
    PhillipsPerron
        Z-tau and Z-rho with p-values.

    Raises
    ------
    UndriftError
        For a recording or argument that cannot be; :class:`ArgumentError` for a wrong type.

    Examples
    --------
    >>> x = undrift.arma.simulate(5000, [0.9], [], 1.0)
    >>> undrift.phillips_perron(x).p_value < 0.01
    True
    """
    given = None if lags is None else whole(lags, "lags")
    return PhillipsPerron(**_undrift.phillips_perron(record(x), regression, given))


def stationarity(
    x: npt.ArrayLike, *, lags: int = 20, ma_root: float | None = None
) -> Stationarity:
    """The three tests and their joint conclusion at 5 %.

    ``lags`` of the Dickey-Fuller test. ``ma_root``: the largest inverse moving-average root of a fitted
    model (θ of an ARMA(1,1)); near 1 it makes the two unit-root tests uninformative, as the sentence then states.

    Parameters
    ----------
    x : array_like, shape (n,)
        Recording of one axis [u], u any unit; rad/s or m/s² for a sensor.
    lags : int
        Lagged differences of the Dickey-Fuller test.
    ma_root : float, optional
        Largest inverse moving-average root of a fitted model.

    Returns
    -------
    Stationarity
        The tests, a conclusion and a sentence.

    Raises
    ------
    UndriftError
        For a recording or argument that cannot be; :class:`ArgumentError` for a wrong type.

    Examples
    --------
    >>> walk = undrift.arma.simulate(5000, [1.0], [], 1.0)
    >>> undrift.stationarity(walk).conclusion
    'unit root'
    """
    found = _undrift.verdict(record(x), whole(lags, "lags"), ma_root)
    return Stationarity(
        conclusion=found["conclusion"],
        sentence=found["sentence"],
        adf=Adf(**found["adf"]),
        kpss=Kpss(**found["kpss"]),
        phillips_perron=PhillipsPerron(**found["phillips_perron"]),
    )
