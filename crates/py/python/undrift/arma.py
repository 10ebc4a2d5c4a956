"""ARMA models of a record by exact Gaussian maximum likelihood.

Sign convention: ``x_t - φ1 x_{t-1} - … - φp x_{t-p} = a_t - θ1 a_{t-1} - … - θq a_{t-q}``, x about
its mean, ``a_t ~ N(0, σ²)``. θ is subtracted: the MA coefficients are minus those of statsmodels.
NaN marks a missing sample, which is exactly accounted for.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from undrift import _undrift
from undrift._array import Floats, record
from undrift._result import Result

__all__ = [
    "ArFit",
    "ArmaFit",
    "Likelihood",
    "OrderTest",
    "PanditWu",
    "ProfileInterval",
    "Selection",
    "burg",
    "fit",
    "log_likelihood",
    "order_by_aicc",
    "pandit_wu",
    "profile_interval",
    "select",
    "simulate",
    "yule_walker",
]

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
    """An AR root is 1 as far as the record can tell."""
    warnings: tuple[str, ...]
    """All that should be said with the result."""

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


def _fit_of(found: dict[str, Any]) -> ArmaFit:
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
    """
    known = [(record(ar, "φ").tolist(), record(ma, "θ").tolist()) for ar, ma in starts]
    return _fit_of(_undrift.arma_fit(record(x), order, mean, unit_root, effort, known))


@dataclass(frozen=True, eq=False, repr=False)
class Likelihood(Result):
    """The exact likelihood at given coefficients, σ² at its best for them."""

    log_likelihood: float
    """Exact Gaussian log-likelihood, constants included."""
    sum_of_squares: float
    """Σ v²/V over the one-step prediction errors [u²]."""
    sigma2: float
    """Sum of squares over the number of samples [u²]."""
    mean: float
    """Mean, given or estimated [u]."""
    mean_standard_error: float
    """Standard error of an estimated mean [u]; 0 of a given one."""
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
    """
    return Likelihood(
        **_undrift.arma_log_likelihood(
            record(x), record(ar, "φ").tolist(), record(ma, "θ").tolist(), mean, unit_root
        )
    )


class _Fits(Result):
    """Several fits, one row each in the table."""

    fits: tuple[ArmaFit, ...]

    def __getitem__(self, order: Order) -> ArmaFit:
        """The fit of an order (p, q); KeyError where it was not made."""
        for one in self.fits:
            if one.order == tuple(order):
                return one
        raise KeyError(order)

    def __iter__(self) -> Iterator[ArmaFit]:
        return iter(self.fits)

    def _table(self) -> Mapping[str, Any]:
        names = ["log_likelihood", "residual_sum_of_squares", "aic", "aicc", "bic"]
        orders = {
            "p": np.array([one.order[0] for one in self.fits]),
            "q": np.array([one.order[1] for one in self.fits]),
        }
        return orders | {
            name: np.array([getattr(one, name) for one in self.fits]) for name in names
        }


@dataclass(frozen=True, eq=False, repr=False)
class Selection(_Fits):
    """The fits of a grid of orders and the orders that the criteria choose. ``selection[p, q]`` is a fit."""

    fits: tuple[ArmaFit, ...]
    """By p, then q; an order that the record is too short for is left out."""
    by_aic: Order
    """Order of least AIC."""
    by_aicc: Order
    """Order of least AICc."""
    by_bic: Order
    """Order of least BIC."""


def select(
    x: npt.ArrayLike,
    max_order: Order,
    *,
    mean: float | None = None,
    unit_root: bool = False,
    effort: float = 1.0,
) -> Selection:
    """Fits every ARMA(p, q) up to ``max_order`` (with a unit root, p from 1) and compares AIC, AICc and BIC."""
    found = _undrift.arma_select(record(x), max_order, mean, unit_root, effort)
    fits = tuple(map(_fit_of, found["fits"]))
    return Selection(
        fits=fits,
        by_aic=fits[found["index_aic"]].order,
        by_aicc=fits[found["index_aicc"]].order,
        by_bic=fits[found["index_bic"]].order,
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
    """What the record ``x`` leaves open about φ (ar) or θ (ma) of its ARMA(1,1) ``fit``."""
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
    """AR(p) by Burg's method: least biased of the direct methods for a slow pole."""
    return ArFit(**_undrift.ar_burg(record(x), p))


def yule_walker(x: npt.ArrayLike, p: int) -> ArFit:
    """AR(p) by the Yule-Walker equations (divisor n): strongly biased towards 0 for a slow pole."""
    return ArFit(**_undrift.ar_yule_walker(record(x), p))


def order_by_aicc(x: npt.ArrayLike, max_p: int) -> int:
    """The order up to ``max_p`` of least AICc by Burg's variances."""
    return _undrift.ar_order(record(x), max_p)


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
    """
    return _undrift.arma_simulate(
        n, record(ar, "φ").tolist(), record(ma, "θ").tolist(), sigma, mean, seed
    )


@dataclass(frozen=True, eq=False, repr=False)
class OrderTest(Result):
    """One F test between two nested orders."""

    smaller: Order
    """The smaller order (p, q)."""
    larger: Order
    """The larger one."""
    sum_smaller: float
    """Sum of squares of the smaller model [u²]."""
    sum_larger: float
    """Sum of squares of the larger model [u²]."""
    f: float
    """F statistic."""
    added: int
    """Parameters added."""
    remaining: int
    """Degrees of freedom of the denominator."""
    critical: float
    """Critical value at the level asked for."""
    p_value: float
    """Probability of a larger F, were it F-distributed."""
    significant: bool
    """F exceeds the critical value: the larger model is needed."""
    significant_in_paper: bool
    """F exceeds the value that the source paper compares with."""


@dataclass(frozen=True, eq=False, repr=False)
class PanditWu(_Fits):
    """Pandit and Wu's choice of an order. ``result[p, q]`` is a fit."""

    n: int
    """n of the last significant ARMA(2n, 2n-1)."""
    adequate: bool
    """The loop ended because a test was not significant, not because n_max was reached."""
    by_f: Order
    """Order chosen by the F tests, after stepping down."""
    by_bic_step_down: Order
    """Order of least BIC on the way down."""
    by_aic: Order
    """Order of least AIC among the fits."""
    by_bic: Order
    """Order of least BIC among the fits."""
    paper_critical: float
    """The critical value that the source paper takes at every step."""
    rows: tuple[tuple[Order, OrderTest | None], ...]
    """AR(1), then ARMA(2n, 2n-1), each with its test against the one before."""
    step_down: tuple[OrderTest, ...]
    """The tests of stepping down from (2n, 2n-1)."""
    neighbours: tuple[OrderTest, ...]
    """The neighbours (1,1), (2,1), (3,2), each tested against the next larger."""
    fits: tuple[ArmaFit, ...]
    """All fits made."""

    @property
    def order(self) -> Order:
        """The order that the paper's procedure chooses, :attr:`by_f`."""
        return self.by_f

    @property
    def fit(self) -> ArmaFit:
        """The fit of that order."""
        return self[self.by_f]

    def _table(self) -> Mapping[str, Any]:
        fits = [self[order] for order, _ in self.rows]
        tests = [test for _, test in self.rows]
        return {
            "p": np.array([one.order[0] for one in fits]),
            "q": np.array([one.order[1] for one in fits]),
            "residual_sum_of_squares": np.array([one.residual_sum_of_squares for one in fits]),
            "aic": np.array([one.aic for one in fits]),
            "bic": np.array([one.bic for one in fits]),
            "f": np.array([np.nan if test is None else test.f for test in tests]),
            "f_critical": np.array([np.nan if test is None else test.critical for test in tests]),
            "significant": np.array([test is not None and test.significant for test in tests]),
        }


def pandit_wu(
    x: npt.ArrayLike,
    n_max: int = 3,
    *,
    level: float = 0.05,
    mean: float | None = None,
    unit_root: bool = False,
    effort: float = 1.0,
) -> PanditWu:
    """Fits ARMA(2n, 2n-1) for n = 1, 2, … ``n_max`` until F tests see nothing more, then steps down.

    The F test leads to orders that are too high more often than its ``level`` says: weigh
    ``by_bic_step_down`` beside it. Pandit & Wu (1983), sections 4.4 and 4.5.
    """
    found = _undrift.arma_pandit_wu(record(x), n_max, level, mean, unit_root, effort)
    found["rows"] = tuple(
        (row["order"], None if row["test"] is None else OrderTest(**row["test"]))
        for row in found["rows"]
    )
    for name in ("step_down", "neighbours"):
        found[name] = tuple(OrderTest(**test) for test in found[name])
    found["fits"] = tuple(map(_fit_of, found["fits"]))
    return PanditWu(**found)
