"""ARMA models of one order: fits, likelihood, simulation."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
import numpy.typing as npt
from undrift import _undrift
from undrift._arguments import number, pair, whole
from undrift._array import Floats, record
from undrift._number import Number
from undrift._result import Result

Order = tuple[int, int]


@dataclass(frozen=True, eq=False, repr=False)
class ArmaFit(Result):
    """An ARMA model fitted to a record, u the record's unit."""

    ar: Floats
    """φ1 … φp; with a unit root the factor (1 - B) is multiplied in."""
    ma: Floats
    """θ1 … θq, subtracted: minus those of statsmodels."""
    sigma: float
    """Standard deviation of the innovations [u]."""
    sigma2: float
    """Their variance [u²]."""
    mean: float
    """Mean of the record, or the starting level with a unit root [u]."""
    mean_standard_error: float
    """Standard error of an estimated mean [u]; 0 of a known one."""
    log_likelihood: float
    """Exact Gaussian log-likelihood, constants included; with a unit root the diffuse one."""
    residual_sum_of_squares: float
    """Σ v²/V over the one-step prediction errors [u²]."""
    parameters: int
    """Parameters counted by the criteria: φ without the unit root, θ, σ², an estimated mean."""
    aic: float
    """Akaike's criterion."""
    aicc: float
    """AIC with the small-sample term."""
    bic: float
    """Bayes' criterion."""
    standard_errors: Floats | None
    """Standard errors of φ1 … φp, θ1 … θq; None where the likelihood is singular at its best."""
    covariance: Floats | None
    """Covariance of φ1 … φp, θ1 … θq, a matrix, where the standard errors exist."""
    n: int
    """Samples present, less one with a unit root."""
    has_unit_root: bool
    """One AR root was fixed at exactly 1."""
    local_optima: int
    """Distinct local optima that the search ended in."""
    converged: bool
    """The search met its tolerance."""
    pair_likelihood_ratio: float | None
    """2 (log L - log L') with L' the best likelihood of ARMA(p-1, q-1)."""
    near_cancelling: bool
    """An AR and an MA root are not distinguishable."""
    flat_likelihood: bool
    """Some direction of the parameters is hardly determined."""
    unit_root: bool
    """An AR root is indistinguishable from 1."""
    warnings: tuple[str, ...]
    """Warnings about the result."""

    @property
    def order(self) -> Order:
        """(p, q)."""
        return len(self.ar), len(self.ma)

    def residuals(self, x: npt.ArrayLike) -> Floats:
        """Exact one-step prediction errors of ``x`` over their standard deviations; NaN where a sample is missing.

        Independent N(0, 1) where the model is right.
        """
        return _undrift.arma_residuals(self, record(x))

    def simulate(self, n: int, *, seed: int = 0) -> Floats:
        """``n`` samples of the model about its mean [u]."""
        return simulate(n, self.ar, self.ma, self.sigma, mean=self.mean, seed=seed)

    def _table(self) -> Mapping[str, Any]:
        p, q = self.order
        errors = np.full(p + q, np.nan) if self.standard_errors is None else self.standard_errors
        names = [f"ar{k + 1}" for k in range(p)] + [f"ma{k + 1}" for k in range(q)]
        return {
            "coefficient": np.array(names),
            "value": np.concatenate([self.ar, self.ma]),
            "standard_error": errors,
        }


def fit_of(found: dict[str, Any]) -> ArmaFit:
    if found["covariance"] is not None:
        size = len(found["ar"]) + len(found["ma"])
        found["covariance"] = found["covariance"].reshape(size, size)
    found["warnings"] = tuple(found["warnings"])
    return ArmaFit(**found)


def fit(
    x: npt.ArrayLike,
    order: Order,
    *,
    mean: float | None = None,
    unit_root: bool = False,
    effort: float = 1.0,
    starts: Sequence[tuple[npt.ArrayLike, npt.ArrayLike]] = (),
) -> ArmaFit:
    """Fits ARMA(p, q), ``order`` = (p, q), by exact maximum likelihood: many starts, the best optimum.

    ``mean``: known [u], or None to estimate it with the rest. ``unit_root`` fixes one AR root at
    exactly 1, with a diffuse level. ``effort``: how hard to search, 0.001 to 1000; 1 is thorough.
    ``starts``: further coefficients (φ, θ) to start from, of any order up to ``order``.

    Parameters
    ----------
    x : array_like, shape (n,)
        Recording of one axis [u], u any unit; rad/s or m/s² for a sensor. NaN is a missing sample.
    order : tuple of int
        (p, q).
    mean : float, optional
        Known mean [u]; estimated without one.
    unit_root : bool
        Whether one AR root is fixed at exactly 1.
    effort : float
        How hard to search, 0.001 to 1000; 1 is thorough.
    starts : sequence of (array_like, array_like)
        Further coefficients (φ, θ) to start from.

    Returns
    -------
    ArmaFit
        Coefficients, σ, standard errors, criteria, warnings.

    Raises
    ------
    UndriftError
        For a recording or argument that cannot be; :class:`ArgumentError` for a wrong type.

    Examples
    --------
    >>> x = undrift.arma.simulate(5000, [0.9], [], 1.0)
    >>> fit = undrift.arma.fit(x, (1, 0), effort=0.1)
    >>> f"{fit.ar[0]:.2f} {fit.sigma:.1f}"
    '0.90 1.0'
    """
    known = [(record(ar, "φ").tolist(), record(ma, "θ").tolist()) for ar, ma in starts]
    return fit_of(_undrift.arma_fit(record(x), pair(order, "order"), mean, unit_root, effort, known))


@dataclass(frozen=True, eq=False, repr=False)
class Likelihood(Number, Result):
    """The exact likelihood at given coefficients, σ² at its best for them."""

    log_likelihood: float
    """Exact Gaussian log-likelihood, constants included."""
    sum_of_squares: float
    """Σ v²/V over the one-step prediction errors [u²]."""
    sigma2: float
    """Sum of squares over the number of samples [u²]."""
    mean: float
    """Mean, specified or estimated [u]."""
    mean_standard_error: float
    """Standard error of an estimated mean [u]; 0 of a specified one."""
    n: int
    """Samples that count."""

    def __float__(self) -> float:
        return self.log_likelihood


def log_likelihood(
    x: npt.ArrayLike,
    ar: npt.ArrayLike,
    ma: npt.ArrayLike,
    *,
    mean: float | None = None,
    unit_root: bool = False,
) -> Likelihood:
    """Exact log-likelihood at φ and θ (θ subtracted); a ``float`` where one is asked for.

    ``mean``: known [u], or None for its best value. With ``unit_root``, φ must hold a root at 1.

    Parameters
    ----------
    x : array_like, shape (n,)
        Recording of one axis [u], u any unit; rad/s or m/s² for a sensor. NaN is a missing sample.
    ar, ma : array_like
        Coefficients φ and θ, θ subtracted.
    mean : float, optional
        Known mean [u]; estimated without one.
    unit_root : bool
        Whether φ holds a root at 1.

    Returns
    -------
    Likelihood
        A number, with σ² and the mean at their best.

    Raises
    ------
    UndriftError
        For a recording or argument that cannot be; :class:`ArgumentError` for a wrong type.

    Examples
    --------
    >>> x = undrift.arma.simulate(5000, [0.9], [], 1.0)
    >>> undrift.arma.log_likelihood(x, [0.9], []) > undrift.arma.log_likelihood(x, [0.5], [])
    True
    """
    return Likelihood(
        **_undrift.arma_log_likelihood(
            record(x), record(ar, "φ").tolist(), record(ma, "θ").tolist(), mean, unit_root
        )
    )


@dataclass(frozen=True, eq=False, repr=False)
class ProfileInterval(Result):
    """Profile-likelihood interval of ``log(1 - c)``, c = φ or θ of an ARMA(1,1)."""

    estimate: float
    """At the optimum."""
    low: float
    """Lower end; minus infinity where c = 1 is not contradicted."""
    high: float
    """Upper end; log 2 where c = -1 is not contradicted."""

    @property
    def coefficient(self) -> tuple[float, float]:
        """The interval of c itself."""
        return float(-np.expm1(self.high)), float(-np.expm1(self.low))

    def __contains__(self, c: float) -> bool:
        low, high = self.coefficient
        return low <= c <= high


def profile_interval(
    x: npt.ArrayLike,
    fit: ArmaFit,
    root: Literal["ar", "ma"] = "ar",
    *,
    level: float = 0.95,
) -> ProfileInterval:
    """What the record ``x`` leaves open about φ (ar) or θ (ma) of its ARMA(1,1) ``fit``.

    Parameters
    ----------
    x : array_like, shape (n,)
        Recording of one axis [u], u any unit; rad/s or m/s² for a sensor. NaN is a missing sample.
    fit : ArmaFit
        Its ARMA(1,1).
    root : {"ar", "ma"}
        Of φ or θ.
    level : float
        Probability.

    Returns
    -------
    ProfileInterval
        Ends of log(1 - c); ``.coefficient`` has those of c.

    Raises
    ------
    UndriftError
        For a recording or argument that cannot be; :class:`ArgumentError` for a wrong type.

    Examples
    --------
    >>> x = undrift.arma.simulate(5000, [0.99], [0.9], 1.0)
    >>> fit = undrift.arma.fit(x, (1, 1), effort=0.1)
    >>> fit.ar[0] in undrift.arma.profile_interval(x, fit)
    True
    """
    return ProfileInterval(**_undrift.arma_profile_interval(record(x), fit, root, level))


@dataclass(frozen=True, eq=False, repr=False)
class ArFit(Result):
    """An autoregression about a mean, u the record's unit."""

    ar: Floats
    """φ1 … φp; stationary."""
    sigma2: float
    """Variance of the innovations [u²]."""
    mean: float
    """Sample mean that was removed [u]."""
    partial_autocorrelations: Floats
    """At lags 1 … p."""
    sigma2_by_order: Floats
    """Variance of the innovations at orders 0 … p [u²]."""


def burg(x: npt.ArrayLike, p: int) -> ArFit:
    """AR(p) by Burg's method: least biased of the direct methods for a slow pole.

    Parameters
    ----------
    x : array_like, shape (n,)
        Recording of one axis [u], u any unit; rad/s or m/s² for a sensor.
    p : int
        Order.

    Returns
    -------
    ArFit
        Coefficients and variances.

    Raises
    ------
    UndriftError
        For a recording or argument that cannot be; :class:`ArgumentError` for a wrong type.

    Examples
    --------
    >>> x = undrift.arma.simulate(5000, [0.9], [], 1.0)
    >>> f"{undrift.arma.burg(x, 1).ar[0]:.2f}"
    '0.90'
    """
    return ArFit(**_undrift.ar_burg(record(x), whole(p, "p")))


def yule_walker(x: npt.ArrayLike, p: int) -> ArFit:
    """AR(p) by the Yule-Walker equations (divisor n): strongly biased towards 0 for a slow pole.

    Parameters
    ----------
    x : array_like, shape (n,)
        Recording of one axis [u], u any unit; rad/s or m/s² for a sensor.
    p : int
        Order.

    Returns
    -------
    ArFit
        Coefficients and variances.

    Raises
    ------
    UndriftError
        For a recording or argument that cannot be; :class:`ArgumentError` for a wrong type.

    Examples
    --------
    >>> x = undrift.arma.simulate(5000, [0.9], [], 1.0)
    >>> f"{undrift.arma.yule_walker(x, 1).ar[0]:.2f}"
    '0.90'
    """
    return ArFit(**_undrift.ar_yule_walker(record(x), whole(p, "p")))


def order_by_aicc(x: npt.ArrayLike, max_p: int) -> int:
    """The order up to ``max_p`` of least AICc by Burg's variances.

    Parameters
    ----------
    x : array_like, shape (n,)
        Recording of one axis [u], u any unit; rad/s or m/s² for a sensor.
    max_p : int
        Largest order.

    Returns
    -------
    int
        The order.

    Raises
    ------
    UndriftError
        For a recording or argument that cannot be; :class:`ArgumentError` for a wrong type.

    Examples
    --------
    >>> x = undrift.arma.simulate(5000, [0.9], [], 1.0)
    >>> undrift.arma.order_by_aicc(x, 5) >= 1
    True
    """
    return _undrift.ar_order(record(x), whole(max_p, "max_p"))


def simulate(
    n: int,
    ar: npt.ArrayLike,
    ma: npt.ArrayLike,
    sigma: float,
    *,
    mean: float = 0.0,
    seed: int = 0,
) -> Floats:
    """``n`` samples of an ARMA (θ subtracted) with innovations of deviation ``sigma`` [u], stationary from the first.

    A seed gives the same samples on every machine. One root of φ may be exactly 1: a random walk
    that starts at 0.

    Parameters
    ----------
    n : int
        Samples.
    ar, ma : array_like
        Coefficients φ and θ, θ subtracted.
    sigma : float
        Standard deviation of the innovations [u].
    mean : float
        Mean [u].
    seed : int
        Seed; one gives the same on every machine.

    Returns
    -------
    ndarray, shape (n,)
        Samples [u].

    Raises
    ------
    UndriftError
        For a recording or argument that cannot be; :class:`ArgumentError` for a wrong type.

    Examples
    --------
    >>> undrift.arma.simulate(3, [0.9], [], 1.0, seed=1).shape
    (3,)
    """
    return _undrift.arma_simulate(
        whole(n, "n"),
        record(ar, "φ").tolist(),
        record(ma, "θ").tolist(),
        number(sigma, "sigma"),
        number(mean, "mean"),
        whole(seed, "seed"),
    )
