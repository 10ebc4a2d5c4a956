"""The same numbers as the packages that people come from; docs/python-mapping.md says which call is which."""

from __future__ import annotations

import math
from typing import Any, Literal

import numpy as np
import numpy.typing as npt
import pytest

import undrift

Floats = npt.NDArray[np.float64]
RATE = 100.0
# Sums over 20 000 samples in another order: a few hundred roundings.
ROUNDING = 1e-10


@pytest.mark.parametrize(
    ("kind", "theirs"),
    [
        ("overlapping", "oadev"),
        ("modified", "mdev"),
        ("hadamard", "ohdev"),
        ("total", "totdev"),
    ],
)
@pytest.mark.parametrize("taus", ["octave", "list"])
def test_allan(
    record: Floats,
    kind: Literal["overlapping", "modified", "hadamard", "total"],
    theirs: str,
    taus: str,
) -> None:
    allantools = pytest.importorskip("allantools")
    times: Any = [0.01, 0.03, 0.5, 7.0, 40.0] if taus == "list" else taus
    tau, deviation, _, n = getattr(allantools, theirs)(
        record, rate=RATE, data_type="freq", taus=times
    )
    ours = undrift.allan(record, RATE, kind=kind, taus=times)
    mine = {int(m): (d, k) for m, d, k in zip(ours.m, ours.deviation, ours.n, strict=True)}
    for t, d, k in zip(tau, deviation, n, strict=True):
        m = round(t * RATE)
        assert mine[m][0] == pytest.approx(d, rel=ROUNDING)
        assert mine[m][1] == k


@pytest.mark.filterwarnings("ignore")  # The shape of what theirs gives is about to change.
def test_adf(record: Floats) -> None:
    stattools = pytest.importorskip("statsmodels.tsa.stattools")
    regressions: tuple[Literal["n", "c", "ct"], ...] = ("n", "c", "ct")
    for regression in regressions:
        theirs = stattools.adfuller(record, maxlag=20, regression=regression, autolag=None)
        ours = undrift.adf(record, regression=regression, lags=20)
        assert ours.statistic == pytest.approx(theirs[0], rel=1e-8)
        assert ours.p_value == pytest.approx(theirs[1], abs=1e-6)
        assert (ours.lags, ours.observations) == (theirs[2], theirs[3])
        for level in ("1%", "5%", "10%"):
            assert ours.critical[level] == pytest.approx(theirs[4][level], rel=1e-8)
    rules: dict[str, Literal["aic", "bic", "t-stat"]]
    rules = {"AIC": "aic", "BIC": "bic", "t-stat": "t-stat"}
    for name, rule in rules.items():
        theirs = stattools.adfuller(record[:3000], autolag=name)
        ours = undrift.adf(record[:3000], lags=rule)
        assert ours.lags == theirs[2]
        assert ours.statistic == pytest.approx(theirs[0], rel=1e-8)


@pytest.mark.filterwarnings("ignore")  # The p-value is beyond the table.
def test_kpss(record: Floats) -> None:
    stattools = pytest.importorskip("statsmodels.tsa.stattools")
    regressions: tuple[Literal["c", "ct"], ...] = ("c", "ct")
    rules: tuple[Literal["auto", "legacy"] | int, ...] = ("auto", "legacy", 7)
    for regression in regressions:
        for lags in rules:
            theirs = stattools.kpss(record, regression=regression, nlags=lags)
            ours = undrift.kpss(record, regression=regression, lags=lags)
            assert ours.statistic == pytest.approx(theirs[0], rel=1e-8)
            # Theirs interpolates as ours does, and is cut at the same ends.
            assert ours.p_value == pytest.approx(theirs[1], abs=1e-8)
            assert ours.lags == theirs[2]


def test_phillips_perron(record: Floats) -> None:
    unitroot = pytest.importorskip("arch.unitroot")
    trends: tuple[Literal["n", "c", "ct"], ...] = ("n", "c", "ct")
    for trend in trends:
        theirs = unitroot.PhillipsPerron(record, trend=trend)
        ours = undrift.phillips_perron(record, regression=trend)
        assert ours.statistic == pytest.approx(theirs.stat, rel=1e-8)
        assert ours.p_value == pytest.approx(theirs.pvalue, abs=1e-6)
        assert ours.lags == theirs.lags
        rho = unitroot.PhillipsPerron(record, trend=trend, test_type="rho")
        assert ours.rho_statistic == pytest.approx(rho.stat, rel=1e-8)


def test_normality(record: Floats) -> None:
    stats = pytest.importorskip("scipy.stats")
    theirs, ours = stats.jarque_bera(record), undrift.jarque_bera(record)
    assert ours.statistic == pytest.approx(theirs.statistic, rel=1e-8)
    assert ours.p_value == pytest.approx(theirs.pvalue, rel=1e-8)
    diagnostic = pytest.importorskip("statsmodels.stats.diagnostic")
    distance, _ = diagnostic.lilliefors(record, pvalmethod="approx")
    assert undrift.normality(record).distance == pytest.approx(distance, rel=1e-8)


def test_whiteness_and_correlations(record: Floats) -> None:
    diagnostic = pytest.importorskip("statsmodels.stats.diagnostic")
    stattools = pytest.importorskip("statsmodels.tsa.stattools")
    table = diagnostic.acorr_ljungbox(record[:2000], lags=[5, 20], boxpierce=True, model_df=2)
    ours = undrift.ljung_box(record[:2000], [5, 20], fitted=2)
    for mine, theirs in (
        (ours.statistic, "lb_stat"),
        (ours.p_value, "lb_pvalue"),
        (ours.box_pierce, "bp_stat"),
        (ours.box_pierce_p, "bp_pvalue"),
    ):
        assert mine == pytest.approx(table[theirs].to_numpy(), rel=1e-8)
    # Correlations are near 0: absolute.
    correlations = stattools.acf(record, nlags=60, fft=True)
    assert undrift.acf(record, 60).value == pytest.approx(correlations, abs=1e-12)
    methods: dict[str, Literal["yule-walker", "yule-walker-adjusted", "burg"]]
    methods = {"ywm": "yule-walker", "yw": "yule-walker-adjusted", "burg": "burg"}
    for name, method in methods.items():
        partial = stattools.pacf(record, nlags=30, method=name)
        value = undrift.pacf(record, 30, method=method).value
        assert value == pytest.approx(partial, abs=1e-10)


def test_psd(record: Floats) -> None:
    signal = pytest.importorskip("scipy.signal")
    frequency, density = signal.welch(record, fs=RATE, nperseg=1024)
    ours = undrift.psd(record, RATE, segment=1024)
    assert ours.frequency == pytest.approx(frequency, rel=1e-14)
    assert ours.density == pytest.approx(density, rel=1e-10)
    line = 0.02 * np.sin(2 * math.pi * 12.0 * np.arange(record.size) / RATE)
    lines = undrift.psd(record + line, RATE, segment=1024).lines()
    # Noise moves the weighted mean of the peak by less than a tenth of a bin.
    assert lines.frequency[0] == pytest.approx(12.0, abs=0.01)
    assert lines.amplitude[0] == pytest.approx(0.02, rel=0.1)


def test_detrend(record: Floats) -> None:
    signal = pytest.importorskip("scipy.signal")
    sloped = record + 1e-6 * np.arange(record.size)
    kinds: tuple[Literal["constant", "linear"], ...] = ("constant", "linear")
    for kind in kinds:
        theirs = signal.detrend(sloped, type=kind)
        ours = undrift.detrend(sloped, kind)
        assert ours.residuals == pytest.approx(theirs, abs=1e-14)
    temperature = 25 + np.cos(np.arange(record.size) / 3000)
    found = undrift.detrend(record + 0.1 * temperature, "temperature", temperature=temperature)
    # The slow part of the record itself takes part in the slope.
    assert found.slope == pytest.approx(0.1, abs=2e-3)


def test_wavelet_variance_is_half_the_allan_variance(record: Floats) -> None:
    ours = undrift.wavelet_variance(record, RATE)
    allan = undrift.allan(record, RATE)
    shared = ours.m <= 32  # Above, one coefficient in m/32 is taken.
    assert ours.variance[shared] == pytest.approx(
        0.5 * allan.deviation[: shared.sum()] ** 2, rel=ROUNDING
    )


def test_arma_likelihood_and_fit(record: Floats) -> None:
    innovations = pytest.importorskip("statsmodels.tsa.innovations.arma_innovations")
    estimators = pytest.importorskip("statsmodels.tsa.arima.estimators.innovations")
    short = record[:3000]
    ar, ma = [0.9, 0.05], [0.7]
    ours = undrift.arma.log_likelihood(short, ar, ma, mean=0.0)
    # Theirs adds the MA coefficients: the sign is turned.
    theirs = innovations.arma_loglike(
        short, ar_params=ar, ma_params=[-c for c in ma], sigma2=ours.sigma2
    )
    assert float(ours) == pytest.approx(theirs, rel=1e-10)
    result = estimators.innovations_mle(short, order=(1, 0, 1), demean=False)
    fit = undrift.arma.fit(short, (1, 1), mean=0.0)
    # A search that stops a little below the optimum, in a flat direction.
    assert fit.log_likelihood >= -result.other_results.minimize_results.fun - 1e-6
    assert fit.ar == pytest.approx(result.parameters.ar_params, abs=1e-3)
    assert fit.ma == pytest.approx(-result.parameters.ma_params, abs=3e-3)
    assert fit.sigma2 == pytest.approx(result.parameters.sigma2, rel=1e-3)


def test_arima_agrees(record: Floats) -> None:
    arima = pytest.importorskip("statsmodels.tsa.arima.model")
    short = record[:1000].copy()
    short[[100, 101, 500]] = np.nan
    fit = undrift.arma.fit(short, (1, 1))
    model = arima.ARIMA(short, order=(1, 0, 1), trend="c")
    # Theirs at our coefficients: mean, φ, -θ, σ². The Kalman filter of either is exact.
    at = [fit.mean, fit.ar[0], -fit.ma[0], fit.sigma2]
    assert model.loglike(at) == pytest.approx(fit.log_likelihood, rel=1e-9)
    residuals = fit.residuals(short)
    assert np.isnan(residuals).sum() == 3
    theirs = model.filter(at).standardized_forecasts_error[0]
    present = ~np.isnan(short)
    # Theirs stops iterating its covariance when it changes by less than 1e-9 or so.
    assert residuals[present] == pytest.approx(theirs[present], abs=1e-6)


@pytest.mark.filterwarnings("ignore")  # As above.
def test_autoregressions(record: Floats) -> None:
    linear = pytest.importorskip("statsmodels.regression.linear_model")
    rho, sigma2 = linear.burg(record, order=3, demean=True)
    ours = undrift.arma.burg(record, 3)
    assert ours.ar == pytest.approx(rho, rel=1e-9)
    # Theirs is of the samples after the first three, ours starts from the variance of all.
    assert ours.sigma2 == pytest.approx(sigma2, rel=1e-3)
    rho = linear.yule_walker(record, order=3, method="mle")[0]
    assert undrift.arma.yule_walker(record, 3).ar == pytest.approx(rho, rel=1e-9)


def test_simulation_is_the_process_asked_for() -> None:
    ar, ma, sigma = [0.9, -0.5], [0.4], 0.3
    x = undrift.arma.simulate(1_000_000, ar, ma, sigma, mean=2.0, seed=7)
    process = pytest.importorskip("statsmodels.tsa.arima_process")
    expected = process.arma_acovf([1, -0.9, 0.5], [1, -0.4], nobs=4, sigma2=sigma**2)
    centred = x - 2.0
    measured = [centred[: x.size - k] @ centred[k:] / x.size for k in range(4)]
    # Errors of a million samples are about a thousandth of the variance; five of them.
    assert measured == pytest.approx(expected, abs=5e-3 * expected[0])
    again = undrift.arma.simulate(1_000_000, ar, ma, sigma, mean=2.0, seed=7)
    assert (x == again).all()
    assert (x != undrift.arma.simulate(1_000_000, ar, ma, sigma, mean=2.0, seed=8)).any()
