"""What the functions take, refuse and give back."""

from __future__ import annotations

import copy
import math
import pickle
from collections.abc import Callable
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

import undrift

Floats = npt.NDArray[np.float64]

# Names that no argument knows, or this one does not.
OTHER: Any = "other"
NOTHING: Any = "n"
# Every function of one record, with what else it needs.
CALLS: dict[str, Callable[[Any], Any]] = {
    "allan": lambda x: undrift.allan(x, 100.0),
    "allan, total": lambda x: undrift.allan(x, 100.0, kind="total", confidence=None),
    "adf": undrift.adf,
    "kpss": undrift.kpss,
    "phillips_perron": undrift.phillips_perron,
    "stationarity": undrift.stationarity,
    "jarque_bera": undrift.jarque_bera,
    "normality": undrift.normality,
    "ljung_box": undrift.ljung_box,
    "acf": lambda x: undrift.acf(x, 10),
    "pacf": lambda x: undrift.pacf(x, 10, method="burg"),
    "psd": lambda x: undrift.psd(x, 100.0),
    "detrend": undrift.detrend,
    "wavelet_variance": lambda x: undrift.wavelet_variance(x, 100.0),
    "arma.fit": lambda x: undrift.arma.fit(x, (1, 1), effort=0.1),
    "arma.log_likelihood": lambda x: undrift.arma.log_likelihood(x, [0.9], [0.5]),
    "arma.select": lambda x: undrift.arma.select(x, (1, 1), effort=0.1),
    "arma.burg": lambda x: undrift.arma.burg(x, 3),
    "arma.yule_walker": lambda x: undrift.arma.yule_walker(x, 3),
    "arma.order_by_aicc": lambda x: undrift.arma.order_by_aicc(x, 3),
    "pandit_wu": lambda x: undrift.pandit_wu(x, 1, effort=0.1),
}
# These say what a constant record has, or leave it to the caller.
CONSTANT = {"allan", "allan, total", "psd", "detrend"}
# Here NaN is a missing sample.
GAPS = {"wavelet_variance", "arma.fit", "arma.log_likelihood", "arma.select", "pandit_wu"}


@pytest.fixture(scope="module")
def short(record: Floats) -> Floats:
    return record[:1000].copy()


@pytest.mark.parametrize("name", CALLS)
def test_any_kind_of_array_gives_the_same(name: str, short: Floats) -> None:
    pandas = pytest.importorskip("pandas")
    call = CALLS[name]
    expected = repr(call(short))
    strided = np.repeat(short, 3)[::3]
    assert not strided.flags.c_contiguous
    frozen = short.copy()
    frozen.flags.writeable = False
    unaligned = np.frombuffer(b"x" + short.tobytes(), np.uint8)[1:].view(np.float64)
    others: list[Any] = [
        strided,
        frozen,
        unaligned,
        short.tolist(),
        short.astype(">f8"),
        pandas.Series(short, index=range(5, 1005)),
        pandas.Series(short, dtype="Float64"),
    ]
    for other in others:
        assert repr(call(other)) == expected
    # The same numbers in a narrower type.
    narrow = short.astype(np.float32)
    assert repr(call(narrow)) == repr(call(narrow.astype(np.float64)))
    whole = np.round(1000 * short).astype(np.int16)
    assert repr(call(whole)) == repr(call(whole.astype(np.float64)))


@pytest.mark.parametrize("name", CALLS)
def test_hostile_records_are_refused_in_the_library_s_words(name: str, short: Floats) -> None:
    call = CALLS[name]

    def message(x: Any) -> str:
        with pytest.raises(undrift.UndriftError) as caught:
            call(x)
        return str(caught.value)

    too_short = ("too short: ", "too few samples", "samples are present", "the recording is constant")
    if name != "detrend":
        assert any(words in message([1.0]) for words in too_short)
    assert message([]).startswith(("too short: 0 samples", "too few samples: 0", "0 samples"))
    broken = short.copy()
    broken[17] = math.inf
    infinite = ("sample 17 (from 0) is not a finite number", "the recording or its mean is not finite")
    assert any(words in message(broken) for words in (*infinite, "the recording has values that are not finite"))
    broken[17] = math.nan
    if name in GAPS:
        call(broken)
    else:
        words = message(broken)
        assert "sample 17 (from 0) is not a finite number" in words or "missing" in words
    if name not in CONSTANT:
        assert message(np.full(1000, 0.1)) == "the recording is constant"
    assert message(short.reshape(2, 500)).startswith("the recording has 2 dimensions where 1 is needed")
    assert message(np.float64(3.0)).startswith("the recording has 0 dimensions")
    assert message(short + 1j).startswith("the recording is not an array of numbers: complex128")
    assert message(["a", "b"]).startswith("the recording is not an array of numbers")
    assert message(None).startswith("the recording has 0 dimensions")
    assert message(np.array(["2026-01-01"], "M8[D]")).startswith("the recording is not an array")


def test_a_mask_is_not_looked_through(short: Floats) -> None:
    masked = np.ma.array(short, mask=np.arange(1000) == 30)
    with pytest.raises(undrift.UndriftError, match=r"^sample 30 \(from 0\) is not a finite"):
        undrift.adf(masked)
    assert undrift.arma.fit(masked, (1, 0)).n == 999


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda x: undrift.allan(x, 0.0), "rate: must be above 0"),
        (lambda x: undrift.allan(x, math.nan), "rate: nan is not finite"),
        (lambda x: undrift.allan(x, 1.0, kind=OTHER), "unknown deviation"),
        (lambda x: undrift.allan(x, 1.0, taus="log"), "unknown grid of averaging times"),
        (lambda x: undrift.allan(x, 1.0, taus=[-1.0]), "averaging times must be positive"),
        (lambda x: undrift.allan(x, 1.0, confidence=1.0), "the confidence level must be"),
        (lambda x: undrift.allan(x, 1.0, kind="total").terms, "overlapping"),
        (lambda x: undrift.adf(x, regression=OTHER), "unknown regression"),
        (lambda x: undrift.adf(x, lags=OTHER), "unknown lag rule"),
        (lambda x: undrift.adf(x, lags=600), "the regression is degenerate"),
        (lambda x: undrift.kpss(x, regression=NOTHING), "KPSS needs a constant or a trend"),
        (lambda x: undrift.kpss(x, lags=OTHER), "unknown lag rule"),
        (lambda x: undrift.phillips_perron(x, lags=5000), "too short"),
        (lambda x: undrift.acf(x, 5000), "too short"),
        (lambda x: undrift.pacf(x, 5, method=OTHER), "unknown method"),
        (lambda x: undrift.psd(x, 1.0, segment=2), "a segment needs at least 4 samples"),
        (lambda x: undrift.detrend(x, OTHER), "unknown trend"),
        (lambda x: undrift.detrend(x, "temperature"), "needs the temperature"),
        (lambda x: undrift.detrend(x, "temperature", temperature=[1, 2, 3]), "one temperature"),
        (lambda x: undrift.wavelet_variance(x, 0.0), "rate: must be above 0"),
        (lambda x: undrift.arma.fit(x, (25, 0)), "orders above 24 are not supported"),
        (lambda x: undrift.arma.fit(x, (1, 1), effort=0.0), "the effort of the search"),
        (lambda x: undrift.arma.fit(x, (0, 1), unit_root=True), "a unit root needs"),
        (lambda x: undrift.arma.fit(x, (1, 0), mean=math.inf), "not finite"),
        (lambda x: undrift.arma.log_likelihood(x, [1.1], []), "not stationary"),
        (lambda x: undrift.arma.log_likelihood(x, [], [1.1]), "not invertible"),
        (lambda x: undrift.pandit_wu(x, 0), "n_max is outside its range"),
        (lambda x: undrift.pandit_wu(x, 1, level=2.0), "the level of the tests"),
        (
            lambda x: undrift.arma.profile_interval(x, undrift.arma.fit(x, (1, 0))),
            "the order for a profile",
        ),
        (
            lambda x: undrift.arma.profile_interval(x[1:], undrift.arma.fit(x, (1, 1), effort=0.1)),
            "the number of samples",
        ),
        (lambda x: undrift.arma.simulate(10, [1.2], [], 1.0), "unstable"),
        (lambda x: undrift.arma.simulate(2**60, [], [], 1.0), "not enough memory"),
        (lambda x: undrift.arma.simulate(10, [], [], -1.0), "not negative"),
    ],
)
def test_bad_arguments(call: Callable[[Floats], Any], words: str, short: Floats) -> None:
    with pytest.raises(undrift.UndriftError, match=words):
        call(short)


def test_wrong_types_are_type_errors(short: Floats) -> None:
    with pytest.raises(TypeError):
        undrift.allan(short, "fast")  # type: ignore[arg-type]
    with pytest.raises(TypeError):
        undrift.arma.fit(short, 1)  # type: ignore[arg-type]
    with pytest.raises(undrift.UndriftError, match="lags: must not be negative"):
        undrift.acf(short, -1)


def test_allan_grids(short: Floats) -> None:
    assert undrift.allan(short, 10.0).m.tolist() == [1, 2, 4, 8, 16, 32, 64, 128, 256]
    decade = undrift.allan(short, 10.0, taus="decade")
    assert decade.m.tolist() == [1, 2, 5, 10, 20, 50, 100, 200, 500]
    assert undrift.allan(short, 10.0, taus="all").m.tolist() == list(range(1, 501))
    # To the nearest sample, once each, growing; too long ones are left out.
    some = undrift.allan(short, 10.0, taus=[3.04, 0.1, 2.96, 1e6])
    assert some.m.tolist() == [1, 30]
    assert some.tau.tolist() == [0.1, 3.0]
    plain = undrift.allan(short, 10.0, confidence=None)
    assert (plain.lower, plain.upper, plain.noise_type, plain.edf) == (None,) * 4
    assert list(plain.to_pandas()) == ["m", "tau", "deviation", "n"]


def test_an_arma_fit_is_used_again(record: Floats) -> None:
    x = record[:4000]
    fit = undrift.arma.fit(x, (1, 1))
    assert fit.order == (1, 1) and fit.sigma**2 == pytest.approx(fit.sigma2, rel=1e-15)
    assert fit.standard_errors is not None and fit.covariance is not None
    # Standard errors are the roots of the diagonal.
    assert fit.standard_errors == pytest.approx(np.sqrt(np.diag(fit.covariance)), rel=1e-12)
    at = undrift.arma.log_likelihood(x, fit.ar, fit.ma)
    # The value at the optimum, from the same function.
    assert float(at) == fit.log_likelihood
    # The sum of squares of standardised errors with the best σ² is their number.
    assert (fit.residuals(x) ** 2).sum() == pytest.approx(x.size, rel=1e-6)
    again = pickle.loads(pickle.dumps(fit))
    interval = undrift.arma.profile_interval(x, again)
    low, high = interval.coefficient
    assert low < fit.ar[0] < high <= 1.0 and fit.ar[0] in interval and 0.5 not in interval
    # A third of a profile's tail on each side of twice the standard error, at worst.
    assert high - low == pytest.approx(4 * fit.standard_errors[0], rel=0.5)
    assert fit.simulate(5, seed=1).shape == (5,)


def test_selection_and_pandit_wu_hold_their_fits(record: Floats) -> None:
    x = record[:2000]
    grid = undrift.arma.select(x, (1, 2), effort=0.1)
    assert [fit.order for fit in grid] == [(p, q) for p in (0, 1) for q in (0, 1, 2)]
    assert grid[1, 1].order == (1, 1)
    assert grid[grid.by_bic].bic == min(fit.bic for fit in grid)
    with pytest.raises(KeyError):
        grid[3, 3]
    table = undrift.pandit_wu(x, 2, effort=0.1)
    assert table.fit.order == table.order == table.by_f
    assert table.to_pandas().shape[0] == len(table.rows)
    # Twice the gain in log-likelihood, 3.57, is about F.
    assert table.rows[1][1] is not None and table.rows[1][1].f == pytest.approx(3.57, rel=0.05)


def results(record: Floats) -> list[Any]:
    made = [call(record[:1000]) for name, call in CALLS.items() if name != "arma.order_by_aicc"]
    allan = undrift.allan(record, 100.0)
    made += [allan.terms, allan.terms.N, allan.gauss_markov, undrift.psd(record, 100.0).lines()]
    fit = undrift.arma.fit(record[:1000], (1, 1))
    made += [undrift.arma.profile_interval(record[:1000], fit)]
    made += [test for _, test in undrift.pandit_wu(record[:1000], 1, effort=0.1).rows if test]
    return made


def test_results_pickle_copy_and_become_tables(record: Floats) -> None:
    pytest.importorskip("pandas")
    pytest.importorskip("pyarrow")
    for result in results(record):
        text = repr(result)
        assert repr(pickle.loads(pickle.dumps(result))) == text
        assert repr(copy.copy(result)) == repr(copy.deepcopy(result)) == text
        frame, table = result.to_pandas(), result.to_arrow()
        assert len(frame) == len(table) and list(frame) == table.column_names
        assert len(frame.columns) > 0
        page = result._repr_html_()
        assert type(result).__name__ in page and page.count("<table>") == page.count("</table>")
        with pytest.raises(AttributeError):
            result.samples = 3


def test_float_where_a_float_is_asked_for(record: Floats) -> None:
    terms = undrift.allan(record, 100.0).terms
    assert float(terms.N) == terms.white.value
    assert [terms.Q, terms.B, terms.K, terms.R] == [
        terms.quantisation,
        terms.bias_instability,
        terms.random_walk,
        terms.ramp,
    ]
    assert np.asarray(undrift.acf(record, 3)).tolist() == undrift.acf(record, 3).value.tolist()
