"""The package gives what the terminal gives, to the last digit."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

import undrift

RATE = 100.0
# What `identify` sets in its search over orders (crates/noise/src/identify/candidates.rs).
SEARCH_EFFORT, REFINE_EFFORT, GRID_EFFORT = 0.2, 0.2, 0.03


@pytest.fixture(scope="module")
def found(
    terminal_json: Callable[..., Any],
    record: npt.NDArray[np.float64],
    tmp_path_factory: pytest.TempPathFactory,
) -> Any:
    """What `undrift identify --json` says of the record as a gyro's."""
    path: Path = tmp_path_factory.mktemp("record") / "static.csv"
    path.write_text("gyro_z\n" + "\n".join(map(repr, record.tolist())) + "\n")
    units = ("--columns", 1, "--axis", "gyro_z", "--units", "rad/s,m/s^2")
    axis = terminal_json("identify", path, "--rate", RATE, *units)["axes"]["gyro_z"]
    # Nothing was left out: the statistics are those of the record less its mean.
    assert axis["outliers"] == []
    return axis


@pytest.fixture(scope="module")
def plain(record: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    return undrift.detrend(record).residuals


def null(value: float) -> float | None:
    """A number as in JSON."""
    return value if math.isfinite(value) else None


def test_mean(found: Any, record: npt.NDArray[np.float64]) -> None:
    assert undrift.detrend(record).mean == found["mean"]


def test_adf(found: Any, plain: npt.NDArray[np.float64]) -> None:
    rules = {"aic": "aic", "bic": "bic", "last_significant": "t-stat"}
    tests: list[tuple[undrift.statistics.Adf, Any]] = [
        (undrift.adf(plain, lags=20), found["adf"])
    ]
    for name, rule in rules.items():
        test = undrift.adf(plain, lags=rule, max_lags=20)  # type: ignore[arg-type]
        tests.append((test, found["adf"]["by_rule"][name]))
    for ours, theirs in tests:
        assert ours.statistic == theirs["statistic"]
        assert ours.p_value == theirs["p_value"]
        assert ours.lags == theirs["lags"]
        assert ours.critical == theirs["critical"]
        assert ours.criterion == theirs["criterion"]


def test_kpss_and_phillips_perron(found: Any, plain: npt.NDArray[np.float64]) -> None:
    kpss, theirs = undrift.kpss(plain, lags="legacy"), found["kpss"]
    for name in ("statistic", "p_value", "p_is_bound", "lags", "critical"):
        assert getattr(kpss, name) == theirs[name]
    test, theirs = undrift.phillips_perron(plain), found["phillips_perron"]
    for name in ("statistic", "p_value", "lags", "critical"):
        assert getattr(test, name) == theirs[name]


def test_verdict(found: Any, plain: npt.NDArray[np.float64]) -> None:
    (fit,) = (c for c in found["candidates"] if c["name"] == "ARMA(1,1)")
    verdict = undrift.stationarity(plain, ma_root=fit["ma"][0])
    assert verdict.sentence == found["stationarity"]
    assert verdict.adf.statistic == found["adf"]["statistic"]


def test_normality(found: Any, plain: npt.NDArray[np.float64]) -> None:
    test, alone = undrift.normality(plain), undrift.jarque_bera(plain)
    assert test.jarque_bera == alone.statistic == found["jarque_bera"]["statistic"]
    assert test.jarque_bera_p == alone.p_value == found["jarque_bera"]["p_value"]
    assert test.distance == found["ks"]["statistic"]
    assert test.plain_critical_5 == found["ks"]["critical_5"]
    assert test.plain_p == found["ks"]["p_value"]
    assert test.lilliefors_critical_5 == found["lilliefors"]["critical_5"]
    assert test.lilliefors_p == found["lilliefors"]["p_value"]
    assert test.skewness == alone.skewness == found["skewness"]
    assert test.kurtosis_excess == alone.kurtosis_excess == found["kurtosis_excess"]
    assert test.quantisation_step == found["quantisation_step"]


def test_correlations(found: Any, plain: npt.NDArray[np.float64]) -> None:
    assert undrift.acf(plain).value.tolist() == found["acf"]
    assert undrift.pacf(plain).value.tolist() == found["pacf"]
    test = undrift.ljung_box(plain)
    assert test.lags.tolist() == [found["ljung_box"]["lags"]]
    assert test.statistic.tolist() == [found["ljung_box"]["statistic"]]
    assert test.p_value.tolist() == [found["ljung_box"]["p_value"]]


def test_spectral_lines(found: Any, plain: npt.NDArray[np.float64]) -> None:
    # White noise and a walk: neither peaks of the density nor lines.
    assert undrift.psd(plain, RATE).lines().frequency.size == len(found["lines"]) == 0


def test_allan(found: Any, plain: npt.NDArray[np.float64]) -> None:
    ours, theirs = undrift.allan(plain, RATE), found["allan"]
    assert ours.lower is not None and ours.upper is not None
    assert ours.tau.tolist() == theirs["tau_s"]
    assert ours.deviation.tolist() == theirs["adev"]
    assert ours.lower.tolist() == theirs["lower"]
    assert ours.upper.tolist() == theirs["upper"]
    assert ours.terms.deviation(ours.tau).tolist() == theirs["fit"]
    assert ours.terms.shortest_tau == theirs["fit_from_s"]
    for name, term in found["allan_terms"].items():
        mine = getattr(ours.terms, name)
        if name == "white_variance":
            assert mine == term
            continue
        assert mine.value == term["value"]
        assert null(mine.standard_error) == term["standard_error"]
        assert mine.upper_95 == term["upper_95"]
        assert mine.seen == term["seen"]


def test_pandit_wu_and_the_fit_that_follows(
    found: Any, plain: npt.NDArray[np.float64]
) -> None:
    table = undrift.pandit_wu(plain, 2, effort=SEARCH_EFFORT)
    # The result's table goes on to (8,7).
    rows = found["pandit_wu"][: len(table.rows)]
    for (order, test), theirs in zip(table.rows, rows, strict=True):
        fit = table[order]
        assert order == (theirs["p"], theirs["q"])
        assert fit.residual_sum_of_squares == theirs["rss"]
        assert (fit.aic, fit.bic) == (theirs["aic"], theirs["bic"])
        assert fit.ar.tolist() == theirs["ar"]
        assert fit.ma.tolist() == theirs["ma"]
        assert (test and test.f) == theirs["f"]
        assert (test and test.critical) == theirs["f_critical"]
        assert table.paper_critical == theirs["f_paper"]
    for order in {(1, 1), (2, 1), table.by_f, table.by_aic, table.by_bic}:
        (theirs,) = (
            c for c in found["candidates"] if c["name"] == f"ARMA({order[0]},{order[1]})"
        )
        # The search has seen the whole record: its fit is the candidate's.
        same_fit(table[order], theirs)


def test_unit_root_fit(found: Any, plain: npt.NDArray[np.float64]) -> None:
    (theirs,) = (c for c in found["candidates"] if c["name"] == "ARMA(1,1), unit root")
    same_fit(undrift.arma.fit(plain, (1, 1), effort=REFINE_EFFORT, unit_root=True), theirs)


def same_fit(fit: undrift.arma.ArmaFit, theirs: Any) -> None:
    assert fit.ar.tolist() == theirs["ar"]
    assert fit.ma.tolist() == theirs["ma"]
    assert fit.sigma == theirs["sigma"]
    assert fit.log_likelihood == theirs["log_likelihood"]
    assert (fit.aic, fit.bic) == (theirs["aic"], theirs["bic"])
    errors = None if fit.standard_errors is None else fit.standard_errors.tolist()
    assert errors == theirs["standard_errors"]
    for name in ("near_cancelling", "flat_likelihood", "unit_root"):
        assert getattr(fit, name) == theirs[name]
    # The terminal says no word on a root that was held; else the same words.
    if not fit.has_unit_root:
        assert list(fit.warnings) == theirs["warnings"]


def test_grid_of_orders(found: Any, plain: npt.NDArray[np.float64]) -> None:
    grid, theirs = undrift.arma.select(plain, (3, 3), effort=GRID_EFFORT), found["box_jenkins"]
    for name in ("by_aic", "by_aicc", "by_bic"):
        assert getattr(grid, name) == (theirs[name]["p"], theirs[name]["q"])
    for fit, one in zip(grid.fits, theirs["grid"], strict=True):
        assert fit.order == (one["p"], one["q"])
        # In the result the fits of the table of orders stand in the grid, and its other searches begin at them: the
        # same optima, to what a search of little effort leaves.
        assert fit.log_likelihood == pytest.approx(one["log_likelihood"], abs=1e-3)
        assert (fit.aic, fit.aicc, fit.bic) == pytest.approx(
            (one["aic"], one["aicc"], one["bic"]), abs=2e-3
        )


def test_burg(found: Any, plain: npt.NDArray[np.float64]) -> None:
    order = max(undrift.arma.order_by_aicc(plain, 5), 1)
    (theirs,) = (c for c in found["candidates"] if c["name"] == f"AR({order}), Burg")
    fit = undrift.arma.burg(plain, order)
    assert fit.ar.tolist() == theirs["ar"]
    assert math.sqrt(fit.sigma2) == theirs["sigma"]
